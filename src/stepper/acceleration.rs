//! Stage 2: accelerations of the DOFs.

use super::matrix::Unknown;
use super::{FaceCondition, Forcing, PoreCondition, Stepper};
use crate::basis::BasisFamily;
use crate::grid::Face;
use crate::law::LawSweep;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::simd::with_features;
use nalgebra::SVector;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    /// Turns forces into accelerations; a DOF that no particle reaches has none.
    pub(super) fn accelerate_one(&mut self, forcing: &Forcing<T, D>) {
        if R::PARTICLE_MATRIX {
            self.solve_accelerations(forcing);
        } else {
            let (forces, masses, body_force) =
                (&mut self.dofs.force[..], &self.dofs.mass[..], forcing.body_force);
            with_features(
                #[inline(always)]
                move || divide_by_masses(forces, masses, body_force),
            );
        }
        self.hold_accelerations(forcing);
    }

    /// `M a = f + m b` with the particles' matrix.
    fn solve_accelerations(&mut self, forcing: &Forcing<T, D>) {
        for (force, &mass) in self.dofs.force.iter_mut().zip(&self.dofs.mass) {
            *force += forcing.body_force * mass;
        }
        self.note_loads_on_held(forcing);
        let pick = |_, acceleration| acceleration;
        let walls = Walls::of_solid(&self.face_dofs, forcing);
        self.dofs
            .solve(Unknown::Acceleration, self.velocity_mass, &walls, true, &pick);
        self.note_inertia_of_held(forcing);
    }
}

/// Forces to accelerations with lumped masses.
#[inline(always)]
fn divide_by_masses<T: Scalar, const D: usize>(
    forces: &mut [SVector<T, D>],
    masses: &[T],
    body_force: SVector<T, D>,
) {
    for (force, &mass) in forces.iter_mut().zip(masses) {
        *force = if mass > T::zero() {
            *force / mass + body_force
        } else {
            SVector::zeros()
        };
    }
}

/// The held faces that one of the phases meets.
#[derive(Clone, Copy)]
pub(super) struct Walls<'a, T, const D: usize> {
    face_dofs: &'a [Vec<u32>],
    forcing: &'a Forcing<T, D>,
    /// The liquid does not feel a face that it passes.
    liquid: bool,
}

impl<'a, T: Scalar, const D: usize> Walls<'a, T, D> {
    pub(super) fn of_solid(face_dofs: &'a [Vec<u32>], forcing: &'a Forcing<T, D>) -> Self {
        Self {
            face_dofs,
            forcing,
            liquid: false,
        }
    }

    pub(super) fn of_liquid(face_dofs: &'a [Vec<u32>], forcing: &'a Forcing<T, D>) -> Self {
        Self {
            face_dofs,
            forcing,
            liquid: true,
        }
    }

    /// Calls `f(dof, axis, velocity, acceleration)` for every held component of the DOFs on held faces. Where faces
    /// meet, the later one has the last word.
    #[inline(always)]
    pub(super) fn for_each_held(&self, mut f: impl FnMut(usize, usize, T, T)) {
        for (face, dofs) in Face::all::<D>().zip(self.face_dofs) {
            let FaceCondition::Held {
                held,
                velocity,
                acceleration,
            } = self.forcing.face(face)
            else {
                continue;
            };
            if self.liquid && matches!(self.forcing.pores(face), PoreCondition::Pressure(_)) {
                continue;
            }
            for &dof in dofs {
                for axis in (0..D).filter(|&axis| held[axis]) {
                    f(dof as usize, axis, velocity[axis], acceleration[axis]);
                }
            }
        }
    }
}
