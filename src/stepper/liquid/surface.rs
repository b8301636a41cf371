//! What the liquid meets at the bodies' surfaces.

use nalgebra::{SMatrix, SVector};

use super::super::acceleration::Walls;
use super::super::contact::rub;
use super::super::forces::{add_load, each_seen};
use super::super::inner::Inner;
use super::super::{FaceCondition, Forcing, PoreCondition, SurfacePoint};
use super::seal::{Answer, Place, Seal};
use crate::basis::BasisFamily;
use crate::field::{Pair, Symmetric};
use crate::grid::{Face, Side};
use crate::law::LawSweep;
use crate::phase::{Drag, Phase};
use crate::scalar::Scalar;
use crate::transfer::Transfer;

/// An even state that balances the load of a surface.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct UniformLoad<T> {
    /// Total stress (Pa).
    pub(in super::super) stress: T,
    /// Pressure of the liquid (Pa).
    pub(in super::super) pressure: T,
}

impl<T: Scalar> UniformLoad<T> {
    /// Of no load.
    pub(in super::super) fn none() -> Self {
        Self {
            stress: T::zero(),
            pressure: T::zero(),
        }
    }

    /// Total stress and pressure of a particle less the even state.
    #[inline(always)]
    pub(in super::super) fn rest<const D: usize, P: Phase<T, D>>(
        &self,
        phase: &P,
        effective: &SMatrix<T, D, D>,
        data: &P::Particle,
    ) -> Pair<Symmetric<T, D>, T> {
        let mut total = phase.total_stress(effective, data);
        for a in 0..D {
            total[(a, a)] -= self.stress;
        }
        Pair(Symmetric(total), phase.liquid(data).pressure - self.pressure)
    }
}

fn is_held<T: Scalar, const D: usize>(forcing: &Forcing<T, D>, point: &SurfacePoint<T>) -> bool {
    matches!(forcing.face(point.face), FaceCondition::Held { .. })
}

fn rubs<T: Scalar, const D: usize>(forcing: &Forcing<T, D>, face: Face) -> bool {
    matches!(forcing.face(face), FaceCondition::Frictional { .. })
}

/// Whether the liquid does not pass a surface. A wall at the face makes no difference: where the surface does
/// not lie on it nothing else stops the liquid, and where it does the slip is zero already.
fn is_sealed<T: Scalar, const D: usize>(forcing: &Forcing<T, D>, point: &SurfacePoint<T>) -> bool {
    forcing.pores(point.face) == PoreCondition::Sealed
}

/// Force per area (Pa) on the whole.
fn traction<T: Scalar, const D: usize>(forcing: &Forcing<T, D>, point: &SurfacePoint<T>) -> SVector<T, D> {
    match forcing.face(point.face) {
        FaceCondition::Traction(traction) if point.loaded => *traction,
        // What passes a wall presses on the body with its own pressure; the grains' is the wall's impulse.
        FaceCondition::Frictional { .. } => {
            let mut traction = SVector::zeros();
            if let (PoreCondition::Pressure(pressure), axis) = (forcing.pores(point.face), point.face.axis) {
                traction[axis] = pressure * point.outward();
            }
            traction
        }
        FaceCondition::Traction(_) | FaceCondition::Free | FaceCondition::Held { .. } => SVector::zeros(),
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// The load of one surface, as an even state of the whole body.
    ///
    /// With every surface of the bodies known, `integral(t phi_i) - integral(sigma grad phi_i)` does not
    /// change if the same even stress is taken from `sigma` and, times the normal, from the loads `t`. Taking
    /// the load of a surface itself leaves nothing to integrate where the body is in equilibrium with it, so
    /// that particles as quadrature points are exact there; a point load against their sum is not. Beyond one
    /// dimension no even state fits a load, and none is taken.
    pub(in super::super) fn uniform_load(&self, forcing: &Forcing<T, D>) -> UniformLoad<T> {
        if const { D > 1 || !P::FLOWS } {
            return UniformLoad::none();
        }
        if !self.are_rubbed_surfaces_known(forcing) {
            return UniformLoad::none();
        }
        uniform_load(&self.surface, forcing)
    }

    /// Whether every wall that rubs has a surface of the bodies before it, which then takes the even state's
    /// part of what presses there.
    fn are_rubbed_surfaces_known(&self, forcing: &Forcing<T, D>) -> bool {
        let mut walls = Face::all::<D>().filter(|&face| rubs(forcing, face));
        walls.all(|face| self.surface.iter().any(|point| point.face == face))
    }

    /// What loads the surfaces besides the even part: tractions on the whole, pressures on the liquid where
    /// it passes.
    pub(in super::super) fn add_surface_loads<B: BasisFamily<T, D>>(
        &mut self,
        basis: &B,
        even: &UniformLoad<T>,
        forcing: &Forcing<T, D>,
    ) {
        for k in 0..self.surface.len() {
            let point = &self.surface[k];
            let (axis, area, outward) = (point.face.axis, point.area, point.outward());
            let mut load = SVector::zeros();
            if !is_held(forcing, point) {
                load = traction(forcing, point);
                load[axis] -= even.stress * outward;
            }
            let pressure = match forcing.pores(point.face) {
                PoreCondition::Pressure(pressure) => (pressure - even.pressure) * outward,
                PoreCondition::Sealed => T::zero(),
            };
            let (cell, x) = self.loaded_place(basis, point);
            let mut on_liquid = SVector::zeros();
            on_liquid[axis] = pressure * area;
            let (space, place) = ((basis, &self.grid), (&cell, &x));
            add_load(space, place, &(load * area), &mut self.dofs.force);
            add_load(space, place, &on_liquid, &mut self.liquid.force);
        }
    }

    /// Finds the points of the surfaces that the liquid does not pass.
    #[inline(never)]
    pub(in super::super) fn find_seals<B: BasisFamily<T, D>>(&mut self, basis: &B, forcing: &Forcing<T, D>) {
        self.seal.clear();
        self.find_contacts(basis, forcing);
        let shape = basis.dofs(&self.grid);
        for k in 0..self.surface.len() {
            let point = &self.surface[k];
            if !is_sealed(forcing, point) {
                continue;
            }
            let cell = self.bins.cell_of(point.particle);
            let layer = cell[point.face.axis] as usize;
            let end = match point.face.side {
                Side::Min => 0,
                Side::Max => self.grid.cells()[point.face.axis] - 1,
            };
            // A wall that the body has reached seals it by its own DOFs, and the slip next to it is free.
            if is_held(forcing, point) && layer == end {
                continue;
            }
            let x = self.surface_position(point);
            let (space, contact) = ((basis, &self.grid), &self.contact);
            let place = Place {
                face: point.face,
                layer,
                shape,
            };
            // So does a wall that rubs, where they touch.
            let sealed_by_wall = |dof| layer == end && contact.touches(place.below(dof), place.face);
            self.seal.add_point(&place, point.area, &mut |add| {
                each_seen(space, (cell, &x), &mut |i, phi| add(i, phi, !sealed_by_wall(i)));
            });
        }
        self.seal_contacts(basis, forcing);
        number_components(&mut self.seal, Walls::of_both(&self.face_dofs, forcing));
    }

    /// Takes from the accelerations what would let liquid pass a sealed surface. The pressure there acts on
    /// the liquid alone, that is, its opposite on the solid; the drag that is felt at the step's end resists.
    #[inline(never)]
    pub(super) fn seal_accelerations(&mut self, dt: T) {
        let resistance = self.resistance(dt);
        let (solid, liquid) = (&mut self.dofs, &mut self.liquid);
        let masses = [&solid.mass[..], &liquid.mass];
        let motion = [&mut solid.force[..], &mut liquid.force];
        seal(&mut self.seal, masses, (&self.drag, resistance), motion);
    }

    /// Takes from the mapped velocities the slip through sealed surfaces, by the same projection.
    #[inline(never)]
    pub(super) fn seal_velocities(&mut self, dt: T) {
        let resistance = self.resistance(dt);
        let (solid, liquid) = (&mut self.dofs, &mut self.liquid);
        let masses = [&solid.mass[..], &liquid.mass];
        let motion = [&mut solid.velocity[..], &mut liquid.velocity];
        seal(&mut self.seal, masses, (&self.drag, resistance), motion);
    }

    /// What makes mass of a DOF's drag.
    fn resistance(&self, dt: T) -> T {
        match self.phase.drag_treatment() {
            Drag::Implicit => dt * self.phase.porosity(),
            Drag::Explicit => T::zero(),
        }
    }
}

#[inline(never)]
fn uniform_load<T: Scalar, const D: usize>(
    surface: &[SurfacePoint<T>],
    forcing: &Forcing<T, D>,
) -> UniformLoad<T> {
    let mut even = UniformLoad::none();
    let free = |point: &&SurfacePoint<T>| !is_held(forcing, point) && !rubs(forcing, point.face);
    if let Some(point) = surface.iter().find(free) {
        even.stress = traction(forcing, point)[0] * point.outward();
    }
    if rub(forcing) {
        // What the liquid bears of what presses on a wall is its whole pressure.
        return even;
    }
    let pressures = surface.iter().map(|point| forcing.pores(point.face));
    for condition in pressures {
        if let PoreCondition::Pressure(pressure) = condition {
            even.pressure = pressure;
            break;
        }
    }
    even
}

/// Numbers what the points of the seals look at, and notes what walls hold of it.
#[inline(never)]
fn number_components<T: Scalar, const D: usize>(seal: &mut Seal<T>, walls: [Walls<'_, T, D>; 2]) {
    if seal.is_empty() {
        return;
    }
    seal.number();
    let components = &mut seal.components;
    for (phase, walls) in walls.into_iter().enumerate() {
        walls.for_each_held(|dof, axis, _, _| {
            if let Some(k) = components.find::<D>(dof, axis) {
                components.held[k][phase] = true;
            }
        });
    }
}

/// Takes from the `motion` of both phases the slip through the sealed surfaces, where every DOF answers by
/// itself: with its lumped masses and the given multiple of its drag.
#[inline(never)]
fn seal<T: Scalar, const D: usize>(
    seal: &mut Seal<T>,
    [solid_mass, liquid_mass]: [&[T]; 2],
    (drag, share): (&[T], T),
    [solid, liquid]: [&mut [SVector<T, D>]; 2],
) {
    if seal.is_empty() {
        return;
    }
    seal.components.for_each::<D>(|dof, axis, held, response, slip| {
        *response = answer([solid_mass[dof], liquid_mass[dof]], drag[dof] * share, held);
        *slip = liquid[dof][axis] - solid[dof][axis];
    });
    seal.solve();
    let components = &seal.components;
    let answers = components.answers.iter().zip(&components.force);
    for ((dof, axis), (answer, &force)) in components.places::<D>().zip(answers) {
        solid[dof][axis] += answer.solid * force;
        liquid[dof][axis] += answer.liquid * force;
    }
}

/// Accelerations of both phases at a DOF for a unit force on the liquid and its opposite on the solid, which
/// the `drag` opposes.
fn answer<T: Scalar>([m_s, m_w]: [T; 2], drag: T, [solid_held, liquid_held]: [bool; 2]) -> Answer<T> {
    if liquid_held || !(m_s > T::zero() && m_w > T::zero()) {
        return Answer::none();
    }
    if solid_held {
        let liquid = T::one() / (m_w + drag);
        return Answer {
            solid: T::zero(),
            liquid,
        };
    }
    // Without products of masses, which would underflow in nearly empty cells.
    let liquid = T::one() / (m_w + drag * (T::one() + m_w / m_s));
    let solid = -liquid * (m_w / m_s);
    Answer { solid, liquid }
}
