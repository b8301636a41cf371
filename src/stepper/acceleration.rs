//! Accelerations of the DOFs from the forces on them.

use nalgebra::SVector;

use super::balance::Balance;
use super::dofs::Dofs;
use super::matrix::Unknown;
use super::{FaceCondition, Forcing, PoreCondition};
use crate::grid::Face;
use crate::mass::Divisor;
use crate::scalar::Scalar;
use crate::simd::with_features;

/// Turns forces into accelerations; a DOF that no particle reaches has none. Held components get the
/// prescribed ones, and the forces that this takes are noted.
#[inline(never)]
pub(super) fn accelerate<T: Scalar, const D: usize>(
    dofs: &mut Dofs<T, D>,
    mass: Divisor,
    walls: &Walls<'_, T, D>,
    balance: &mut Balance<T, D>,
) {
    let body_force = walls.forcing.body_force;
    let in_matrix = mass.is_in_acceleration();
    if in_matrix {
        for (force, &mass) in dofs.force.iter_mut().zip(&dofs.mass) {
            *force += body_force * mass;
        }
        balance.note_loads_on_held(&dofs.force, walls);
        let pick = |_, acceleration| acceleration;
        dofs.solve(Unknown::Acceleration, mass, walls, true, &pick);
        balance.note_inertia_of_held(dofs, walls);
    } else {
        let (forces, masses) = (&mut dofs.force[..], &dofs.mass[..]);
        with_features(
            #[inline(always)]
            move || divide_by_masses(forces, masses, body_force),
        );
    }
    let is_lumped = !in_matrix;
    // One after another: where faces meet, the later one finds what the earlier one has prescribed.
    walls.for_each_held(|dof, axis, _, acceleration| {
        let force = &mut dofs.force[dof][axis];
        if is_lumped {
            balance.reaction[axis] += (acceleration - *force) * dofs.mass[dof];
        }
        *force = acceleration;
    });
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

/// Takes the DOFs of a held face, which components are held, velocity and acceleration told.
type OnFace<'f, T, const D: usize> = dyn FnMut(&[u32], &[bool; D], &SVector<T, D>, &SVector<T, D>) + 'f;

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

    /// Of solid and liquid.
    pub(super) fn of_both(face_dofs: &'a [Vec<u32>], forcing: &'a Forcing<T, D>) -> [Self; 2] {
        [
            Self::of_solid(face_dofs, forcing),
            Self::of_liquid(face_dofs, forcing),
        ]
    }

    /// Calls `f(dof, axis, velocity, acceleration)` for every held component of the DOFs on held faces. Where
    /// faces meet, the later one has the last word.
    #[inline(always)]
    pub(super) fn for_each_held(&self, mut f: impl FnMut(usize, usize, T, T)) {
        self.for_each_face(&mut |dofs, held, velocity, acceleration| {
            for &dof in dofs {
                for axis in (0..D).filter(|&axis| held[axis]) {
                    f(dof as usize, axis, velocity[axis], acceleration[axis]);
                }
            }
        });
    }

    /// The same by held faces: one call through a pointer for all DOFs of a face.
    #[inline(never)]
    fn for_each_face(&self, f: &mut OnFace<'_, T, D>) {
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
            f(dofs, held, velocity, acceleration);
        }
    }
}
