//! Velocities of the DOFs from their momenta.

use nalgebra::SVector;
use num_traits::Zero;

use super::acceleration::Walls;
use super::dofs::Dofs;
use super::matrix::Unknown;
use crate::mass::Divisor;
use crate::scalar::Scalar;
use crate::simd::with_features;

/// Momentum to velocity, with the prescribed values at held DOFs. DOFs without mass are at rest. Without
/// `fresh` matrix and held DOFs are those last solved with.
#[inline(never)]
pub(super) fn divide_by_mass<T: Scalar, const D: usize>(
    dofs: &mut Dofs<T, D>,
    mass: Divisor,
    walls: &Walls<'_, T, D>,
    fresh: bool,
) {
    undo_mass(dofs, mass, walls, fresh);
    walls.for_each_held(|dof, axis, velocity, _| dofs.velocity[dof][axis] = velocity);
}

/// The same without the prescribed values, unless the matrix is constrained by them.
#[inline(never)]
pub(super) fn undo_mass<T: Scalar, const D: usize>(
    dofs: &mut Dofs<T, D>,
    mass: Divisor,
    walls: &Walls<'_, T, D>,
    fresh: bool,
) {
    match mass {
        Divisor::Particles => divide(&mut dofs.velocity, &dofs.mass),
        Divisor::FittedLumped => divide(&mut dofs.velocity, &dofs.lumped),
        Divisor::FittedMatrix { .. } | Divisor::ParticleMatrix | Divisor::ParticleSeries(_) => {
            let pick = |velocity, _| velocity;
            dofs.solve(Unknown::Velocity, mass, walls, fresh, &pick);
        }
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
