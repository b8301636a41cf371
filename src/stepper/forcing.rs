//! Loads and boundary values of one step.

use nalgebra::SVector;

use crate::error::{SetupError, StepError};
use crate::grid::{Cell, Face, Grid, Side};
use crate::scalar::Scalar;

/// What holds at a face during one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaceCondition<T, const D: usize> {
    /// Nothing.
    Free,
    /// The DOFs on the grid's face move as told, in the components where `held` is true.
    Held {
        /// Components that are told.
        held: [bool; D],
        /// Velocity (m/s) half a step after the step's start, where Euler-Cromer's velocity lives.
        velocity: SVector<T, D>,
        /// Acceleration (m/s2) at the step's start.
        acceleration: SVector<T, D>,
    },
    /// A wall at the grid's face that nothing passes, that does not hold what moves away from it, and along
    /// which material slides with Coulomb's friction. A liquid in the pores does not pass it either and slides
    /// without friction, or passes it freely ([`PoreCondition`]); friction follows the effective stress.
    Frictional {
        /// Coefficient of friction, not negative; 0 is a smooth wall.
        coefficient: T,
        /// Velocity of the wall (m/s). Its place stays the grid's face: a wall may run along itself, or push
        /// by a small part of a cell.
        velocity: SVector<T, D>,
    },
    /// Force per area (Pa) on the bodies' surface that looks towards the face ([`SurfacePoint`]).
    Traction(SVector<T, D>),
}

impl<T: Scalar, const D: usize> FaceCondition<T, D> {
    /// No motion at all.
    pub fn fixed() -> Self {
        Self::moving(SVector::zeros(), SVector::zeros())
    }

    /// No motion along `axis`, free along the others.
    pub fn roller(axis: usize) -> Self {
        Self::Held {
            held: std::array::from_fn(|a| a == axis),
            velocity: SVector::zeros(),
            acceleration: SVector::zeros(),
        }
    }

    /// A wall at rest that nothing passes, that lets go, and along which material slides with this
    /// coefficient of friction.
    pub fn frictional(coefficient: T) -> Self {
        Self::Frictional {
            coefficient,
            velocity: SVector::zeros(),
        }
    }

    /// The given velocity (m/s) and acceleration (m/s2) in every component.
    pub fn moving(velocity: SVector<T, D>, acceleration: SVector<T, D>) -> Self {
        Self::Held {
            held: [true; D],
            velocity,
            acceleration,
        }
    }
}

/// What the liquid in the pores meets at a face, for phases with a liquid that flows; a step of another phase
/// refuses a pressure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PoreCondition<T> {
    /// It does not pass: at a held face it moves as the face does, at a wall that rubs and at a body's surface
    /// as the solid there, along the normal.
    #[default]
    Sealed,
    /// It passes freely; this is the pressure outside (Pa, tension positive), 0 where it drains into the
    /// open.
    Pressure(T),
}

/// What a scalar that diffuses meets at a face of the grid, for phases that diffuse; a step of another phase
/// refuses a value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum DiffusionCondition<T> {
    /// No flux.
    #[default]
    Insulated,
    /// The DOFs on the grid's face have this value (Dirichlet; K of heat).
    Value(T),
}

/// Loads and boundary values of one step, as plain numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forcing<T, const D: usize> {
    /// Force per mass (N/kg) at the step's start.
    pub body_force: SVector<T, D>,
    faces: [[FaceCondition<T, D>; 2]; D],
    pores: [[PoreCondition<T>; 2]; D],
    diffusion: [[DiffusionCondition<T>; 2]; D],
}

impl<T: Scalar, const D: usize> Forcing<T, D> {
    /// No load, every face free.
    pub fn none() -> Self {
        Self {
            body_force: SVector::zeros(),
            faces: [[FaceCondition::Free; 2]; D],
            pores: [[PoreCondition::Sealed; 2]; D],
            diffusion: [[DiffusionCondition::Insulated; 2]; D],
        }
    }

    /// With a body force (N/kg).
    #[must_use]
    pub fn with_body_force(mut self, body_force: SVector<T, D>) -> Self {
        self.body_force = body_force;
        self
    }

    /// With a condition at a face. A face of an axis that does not exist is left out.
    #[must_use]
    pub fn with_face(mut self, face: Face, condition: FaceCondition<T, D>) -> Self {
        self.set_face(face, condition);
        self
    }

    /// With a condition for the liquid at a face. A face of an axis that does not exist is left out.
    #[must_use]
    pub fn with_pores(mut self, face: Face, condition: PoreCondition<T>) -> Self {
        self.set_pores(face, condition);
        self
    }

    /// Sets the condition for the liquid at a face. A face of an axis that does not exist is left out.
    pub fn set_pores(&mut self, face: Face, condition: PoreCondition<T>) {
        if let Some(sides) = self.pores.get_mut(face.axis) {
            sides[face.side as usize] = condition;
        }
    }

    /// The condition for the liquid at a face, [`PoreCondition::Sealed`] for an axis that does not exist.
    pub fn pores(&self, face: Face) -> PoreCondition<T> {
        self.pores
            .get(face.axis)
            .map_or(PoreCondition::Sealed, |sides| sides[face.side as usize])
    }

    /// With a condition for what diffuses at a face. A face of an axis that does not exist is left out.
    #[must_use]
    pub fn with_diffusion(mut self, face: Face, condition: DiffusionCondition<T>) -> Self {
        self.set_diffusion(face, condition);
        self
    }

    /// Sets the condition for what diffuses at a face. A face of an axis that does not exist is left out.
    pub fn set_diffusion(&mut self, face: Face, condition: DiffusionCondition<T>) {
        if let Some(sides) = self.diffusion.get_mut(face.axis) {
            sides[face.side as usize] = condition;
        }
    }

    /// The condition for what diffuses at a face, [`DiffusionCondition::Insulated`] for an axis that does not
    /// exist.
    pub fn diffusion(&self, face: Face) -> DiffusionCondition<T> {
        self.diffusion
            .get(face.axis)
            .map_or(DiffusionCondition::Insulated, |sides| sides[face.side as usize])
    }

    /// Refuses what a phase whose liquid flows or which diffuses, or one that does not, does not look at.
    pub(super) fn suits_phase(&self, [flows, diffuses]: [bool; 2]) -> Result<(), StepError> {
        for face in Face::all::<D>() {
            if let FaceCondition::Frictional {
                coefficient,
                velocity,
            } = self.face(face)
            {
                let sound = *coefficient >= T::zero()
                    && coefficient.is_finite()
                    && velocity.iter().all(|v| v.is_finite());
                if !sound {
                    let coefficient = coefficient.primal();
                    return Err(StepError::Friction { face, coefficient });
                }
                // The face stays where it is: what it touches is looked for there.
                if let Some(&across) = velocity.get(face.axis).filter(|v| !v.is_zero()) {
                    let velocity = across.primal();
                    return Err(StepError::RubbingAcross { face, velocity });
                }
            }
            if !flows && matches!(self.pores(face), PoreCondition::Pressure(_)) {
                return Err(StepError::PressureWithoutFlow { face });
            }
            if let DiffusionCondition::Value(value) = self.diffusion(face) {
                if !diffuses {
                    return Err(StepError::ValueWithoutDiffusion { face });
                }
                if !value.is_finite() {
                    let value = value.primal();
                    return Err(StepError::DiffusingValue { face, value });
                }
            }
        }
        Ok(())
    }

    /// Sets the condition at a face. A face of an axis that does not exist is left out.
    pub fn set_face(&mut self, face: Face, condition: FaceCondition<T, D>) {
        if let Some(sides) = self.faces.get_mut(face.axis) {
            sides[face.side as usize] = condition;
        }
    }

    /// The condition at a face, [`FaceCondition::Free`] for an axis that does not exist.
    pub fn face(&self, face: Face) -> &FaceCondition<T, D> {
        self.faces
            .get(face.axis)
            .map_or(&FaceCondition::Free, |sides| &sides[face.side as usize])
    }
}

/// A particle at a body's surface: it passes tractions and pore pressures on and moves with the material.
///
/// The surface lies `reach` of the particle's current length `volume / area` beyond its position, but within
/// the particle's cell: beyond it no mass would feel a load. Where the basis asks for domains
/// ([`Domain`](crate::basis::Domain)) the particle's length is that of its domain, which mass of the next
/// cell feels too, so loads act where that ends. In one dimension it also cuts the cell that a fit covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint<T> {
    /// Index of the particle.
    pub particle: usize,
    /// Where the surface looks.
    pub face: Face,
    /// Area that the particle holds (1-D: 1, 2-D: m, 3-D: m2), constant.
    pub area: T,
    /// Distance of the surface from the particle in lengths of the particle: 1/2 in a regular layout.
    pub reach: T,
    /// Whether the traction of the face acts here; what the liquid meets there it meets here in any case.
    pub loaded: bool,
}

impl<T: Scalar> SurfacePoint<T> {
    /// The same point in another scalar.
    pub fn cast<U: Scalar>(&self) -> SurfacePoint<U> {
        SurfacePoint {
            particle: self.particle,
            face: self.face,
            area: U::lit(self.area.primal()),
            reach: U::lit(self.reach.primal()),
            loaded: self.loaded,
        }
    }

    pub(super) fn validate<const D: usize>(&self, particles: usize) -> Result<(), SetupError> {
        let refuse = |name, value, allowed| SetupError::Constant { name, value, allowed };
        if self.particle >= particles {
            let value = self.particle as f64;
            return Err(refuse("surface particle", value, "there is no such particle"));
        }
        if self.face.axis >= D {
            let value = self.face.axis as f64;
            return Err(refuse("surface axis", value, "the grid has no such axis"));
        }
        if !self.area.is_finite() || self.area <= T::zero() {
            let value = self.area.primal();
            return Err(refuse("surface area", value, "it must be positive and finite"));
        }
        if !self.reach.is_finite() || self.reach < T::zero() {
            let value = self.reach.primal();
            return Err(refuse(
                "surface reach",
                value,
                "it must be finite and not negative",
            ));
        }
        Ok(())
    }

    /// Where the surface is, given the particle's cell, position and volume.
    pub(super) fn position<const D: usize>(
        &self,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        position: &SVector<T, D>,
        volume: T,
    ) -> SVector<T, D> {
        let axis = self.face.axis;
        let reach = volume / self.area * self.reach;
        let edge = |k: u32| grid.edge(axis, k as usize);
        let mut x = *position;
        x[axis] = match self.face.side {
            Side::Min => (x[axis] - reach).max(edge(cell[axis])),
            Side::Max => (x[axis] + reach).min(edge(cell[axis] + 1)),
        };
        x
    }

    /// The end of a domain that reaches so far to each side, in whatever cell.
    pub(super) fn end_of_domain<const D: usize>(
        &self,
        position: &SVector<T, D>,
        half_length: T,
    ) -> SVector<T, D> {
        let mut x = *position;
        x[self.face.axis] += self.outward() * self.reach * (half_length + half_length);
        x
    }

    /// The outward normal's component along the face's axis: -1 or 1.
    pub(super) fn outward(&self) -> T {
        match self.face.side {
            Side::Min => -T::one(),
            Side::Max => T::one(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::vector;

    /// Half the particle's current length beyond its position, on the side it looks to, and never beyond its
    /// cell.
    #[test]
    fn a_surface_lies_half_a_particle_beyond_it_and_follows_its_length() {
        let grid = Grid::new(vector![0.0, 0.0], vector![1.0, 1.0], [4, 4]).unwrap();
        let at = |side, volume: f64| {
            let point = SurfacePoint {
                particle: 0,
                face: Face { axis: 1, side },
                area: 0.5,
                reach: 0.5,
                loaded: true,
            };
            point.position(&grid, &[2, 2], &vector![0.5, 0.625], volume)
        };
        assert_eq!(at(Side::Max, 0.1), vector![0.5, 0.625 + 0.1]);
        assert_eq!(at(Side::Min, 0.1), vector![0.5, 0.625 - 0.1]);
        assert_eq!(at(Side::Max, 0.4), vector![0.5, 0.75]);
        assert_eq!(at(Side::Min, 0.4), vector![0.5, 0.5]);
    }

    #[test]
    fn a_surface_without_particle_axis_or_area_is_refused() {
        let good = SurfacePoint {
            particle: 1,
            face: Face {
                axis: 0,
                side: Side::Min,
            },
            area: 1.0,
            reach: 0.5,
            loaded: true,
        };
        assert!(good.validate::<1>(2).is_ok());
        assert!(good.validate::<1>(1).is_err());
        let other = Face {
            axis: 1,
            side: Side::Min,
        };
        assert!(SurfacePoint { face: other, ..good }.validate::<1>(2).is_err());
        assert!(
            SurfacePoint {
                area: f64::NAN,
                ..good
            }
            .validate::<1>(2)
            .is_err()
        );
    }
}
