//! Loads and boundary values of one step.

use nalgebra::SVector;

use crate::error::SetupError;
use crate::grid::{Face, Side};
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

    /// The given velocity (m/s) and acceleration (m/s2) in every component.
    pub fn moving(velocity: SVector<T, D>, acceleration: SVector<T, D>) -> Self {
        Self::Held {
            held: [true; D],
            velocity,
            acceleration,
        }
    }
}

/// Loads and boundary values of one step, as plain numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forcing<T, const D: usize> {
    /// Force per mass (N/kg) at the step's start.
    pub body_force: SVector<T, D>,
    faces: [[FaceCondition<T, D>; 2]; D],
}

impl<T: Scalar, const D: usize> Forcing<T, D> {
    /// No load, every face free.
    pub fn none() -> Self {
        Self {
            body_force: SVector::zeros(),
            faces: [[FaceCondition::Free; 2]; D],
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

/// A particle at a body's surface: it passes tractions on and moves with the material.
///
/// The surface lies half the particle's current length, `volume / (2 area)`, beyond its position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint<T> {
    /// Index of the particle.
    pub particle: usize,
    /// Where the surface looks.
    pub face: Face,
    /// Area that the particle holds (1-D: 1, 2-D: m, 3-D: m2), constant.
    pub area: T,
}

impl<T: Scalar> SurfacePoint<T> {
    /// The same point in another scalar.
    pub fn cast<U: Scalar>(&self) -> SurfacePoint<U> {
        SurfacePoint {
            particle: self.particle,
            face: self.face,
            area: U::lit(self.area.primal()),
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
        Ok(())
    }

    /// Where the surface is, given the particle's position and volume (not beyond the grid).
    pub(super) fn position<const D: usize>(
        &self,
        grid: &crate::grid::Grid<T, D>,
        position: &SVector<T, D>,
        volume: T,
    ) -> SVector<T, D> {
        let reach = volume / (self.area + self.area);
        let mut x = *position;
        match self.face.side {
            Side::Min => x[self.face.axis] -= reach,
            Side::Max => x[self.face.axis] += reach,
        }
        x.zip_zip_map(grid.min(), grid.max(), |x, low, high| x.max(low).min(high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use nalgebra::vector;

    /// Half the particle's current length beyond its position, on the side it looks to, and never beyond the grid.
    #[test]
    fn a_surface_lies_half_a_particle_beyond_it_and_follows_its_length() {
        let grid = Grid::new(vector![0.0, 0.0], vector![1.0, 1.0], [4, 4]).unwrap();
        let at = |side, volume: f64| {
            let point = SurfacePoint {
                particle: 0,
                face: Face { axis: 1, side },
                area: 0.5,
            };
            point.position(&grid, &vector![0.5, 0.75], volume)
        };
        assert_eq!(at(Side::Max, 0.1), vector![0.5, 0.75 + 0.1]);
        assert_eq!(at(Side::Min, 0.2), vector![0.5, 0.75 - 0.2]);
        assert_eq!(at(Side::Max, 0.4), vector![0.5, 1.0]);
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
