//! Velocities of the DOFs from their momenta.

use nalgebra::SVector;
use num_traits::Zero;

use super::acceleration::Walls;
use super::matrix::Unknown;
use super::{Forcing, Stepper};
use crate::basis::BasisFamily;
use crate::law::LawSweep;
use crate::mass::VelocityMass;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::simd::with_features;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    /// Momentum to velocity, with the told values at held DOFs. DOFs without mass are at rest. Without `fresh` matrix and
    /// held DOFs are those last solved with.
    pub(super) fn divide_by_mass(&mut self, forcing: &Forcing<T, D>, fresh: bool) {
        let own_lumped = !R::AMOUNTS_AT_PARTICLES && self.velocity_mass == VelocityMass::Lumped;
        if own_lumped || R::AMOUNTS_AT_PARTICLES && !R::PARTICLE_MATRIX {
            self.divide_by_lumped_mass();
        } else {
            let pick = |velocity, _| velocity;
            let walls = Walls::of_solid(&self.face_dofs, forcing);
            self.dofs
                .solve(Unknown::Velocity, self.velocity_mass, &walls, fresh, &pick);
        }
        let velocities = &mut self.dofs.velocity;
        Walls::of_solid(&self.face_dofs, forcing).for_each_held(|dof, axis, velocity, _| {
            velocities[dof][axis] = velocity;
        });
    }

    fn divide_by_lumped_mass(&mut self) {
        let dofs = &mut self.dofs;
        let mass = if R::AMOUNTS_AT_PARTICLES {
            &dofs.mass
        } else {
            &dofs.lumped
        };
        divide(&mut dofs.velocity, mass);
    }
}

/// Momentum to velocity, DOF by DOF.
pub(super) fn divide<T: Scalar, const D: usize>(velocity: &mut [SVector<T, D>], mass: &[T]) {
    with_features(
        #[inline(always)]
        move || divide_each(velocity, mass),
    );
}

#[inline(always)]
fn divide_each<T: Scalar, const D: usize>(velocity: &mut [SVector<T, D>], mass: &[T]) {
    for (velocity, &mass) in velocity.iter_mut().zip(mass) {
        // A fitted density may be negative somewhere; only a vanishing mass has no velocity.
        *velocity = if mass == T::zero() {
            SVector::zeros()
        } else {
            *velocity / mass
        };
    }
}

/// Sum in four parts: otherwise each addition would wait for the one before.
pub(super) fn sum<Q: Copy + Zero>(values: &[Q]) -> Q {
    with_features(
        #[inline(always)]
        move || sum_of(values),
    )
}

#[inline(always)]
fn sum_of<Q: Copy + Zero>(values: &[Q]) -> Q {
    let (fours, rest) = values.as_chunks::<4>();
    let mut parts = [Q::zero(); 4];
    for four in fours {
        parts = std::array::from_fn(|k| parts[k] + four[k]);
    }
    let [a, b, c, d] = parts;
    rest.iter().fold((a + b) + (c + d), |sum, &value| sum + value)
}
