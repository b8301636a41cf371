//! Rotation of stressed material.

use nalgebra::SMatrix;

use super::LawSample;
use super::path::{Material, modulus};
use super::stiffness::same_stress;
use crate::law::ConstitutiveLaw;
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Place, Property, near};
use crate::testing::worst::Worst;

/// Increments of the rotation, and its angle.
const STEPS: usize = 4096;
const ANGLE: f64 = 0.5;

/// Spins stretched material about the axis normal to axes 0 and 1.
///
/// An increment of pure spin by `theta` stretches by `theta^2 / 2` in a law that multiplies deformation
/// gradients, altogether by `angle theta / 2`, and turns stress by an angle wrong at that order; twice that
/// is allowed. Work on that stretch is done along both axes, and a fluid bears as much along the second as
/// along the first.
pub(super) fn check<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
    objective: bool,
) -> Result<(), Failure> {
    let unit = modulus::<T, D, L>(law, sample);
    let spurious = T::lit(ANGLE * ANGLE) / T::count(STEPS) + T::count(STEPS) * T::default_epsilon();
    let before = Material::<T, D, L, _>::stretched(law, sample.strain);
    let mut after = before;
    after.follow(&spin(T::lit(ANGLE)), STEPS);
    let both = spurious + spurious;
    let allowed = unit * both * (sample.strain + spurious) + unit * T::lit(16.0) * T::default_epsilon();
    let everywhere = || Place::Everywhere;
    near(
        Property::RotationKeepsEnergy,
        everywhere,
        before.energy(),
        after.energy(),
        allowed,
    )?;
    let turned = turned(&before.stress, T::lit(ANGLE));
    if objective {
        return same_stress(Property::Objective, &turned, &after.stress, unit * spurious);
    }
    let mut worst = Worst::new();
    worst.record((turned - after.stress).norm(), unit * spurious, everywhere);
    worst.judge(Property::Objective, false)
}

fn spin<T: Scalar, const D: usize>(angle: T) -> SMatrix<T, D, D> {
    let mut spin = SMatrix::zeros();
    spin[(1, 0)] = angle;
    spin[(0, 1)] = -angle;
    spin
}

/// `R stress R^T` for the rotation by `angle`.
fn turned<T: Scalar, const D: usize>(stress: &SMatrix<T, D, D>, angle: T) -> SMatrix<T, D, D> {
    let mut rotation = SMatrix::<T, D, D>::identity();
    rotation[(0, 0)] = angle.cos();
    rotation[(1, 1)] = angle.cos();
    rotation[(1, 0)] = angle.sin();
    rotation[(0, 1)] = -angle.sin();
    rotation * stress * rotation.transpose()
}
