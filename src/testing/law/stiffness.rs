//! Rest, zero and small increments, wave speed.

use nalgebra::SMatrix;

use super::LawSample;
use super::path::{Material, along, directions, modulus};
use crate::law::ConstitutiveLaw;
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Place, Property, at_least, near};
use crate::testing::worst::Worst;

/// Round-off of a stress or an energy in units of the modulus: some ten operations on numbers of size one.
pub(super) fn round_off<T: Scalar>() -> T {
    T::lit(16.0) * T::default_epsilon()
}

/// Step of the differences: truncation (its square) and round-off (over it) are then alike, `epsilon^(2/3)`.
pub(super) fn step<T: Scalar>() -> T {
    T::default_epsilon().cbrt()
}

pub(super) fn at_rest<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
) -> Result<(), Failure> {
    let unit = modulus::<T, D, L>(law, sample);
    let property = Property::Unstressed;
    let allowed = unit * round_off();
    near(
        property,
        || Place::Everywhere,
        T::zero(),
        Material::<T, D, L, _>::new(law).energy(),
        allowed,
    )?;
    let mut material = Material::<T, D, L, _>::new(law);
    material.update(&SMatrix::zeros());
    same_stress(property, &SMatrix::zeros(), &material.stress, allowed)
}

pub(super) fn zero_increment<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
) -> Result<(), Failure> {
    let property = Property::ZeroIncrement;
    let allowed = modulus::<T, D, L>(law, sample) * round_off();
    for strain in [sample.strain, -sample.strain] {
        let before = Material::<T, D, L, _>::stretched(law, strain);
        let mut after = before;
        after.update(&SMatrix::zeros());
        same_stress(property, &before.stress, &after.stress, allowed)?;
        let everywhere = || Place::Everywhere;
        near(property, everywhere, before.energy(), after.energy(), allowed)?;
        let (old, new) = (before.wave_modulus(sample), after.wave_modulus(sample));
        near(property, everywhere, old, new, allowed)?;
    }
    Ok(())
}

/// At the end of straight paths, spin included, over ten increments.
pub(super) fn symmetry<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
) -> Result<(), Failure> {
    let allowed = modulus::<T, D, L>(law, sample) * round_off();
    directions::<T, D>().into_iter().try_for_each(|direction| {
        let mut material = Material::<T, D, L, _>::new(law);
        material.follow(&(direction * sample.strain), 10);
        let stress = &material.stress;
        same_stress(Property::SymmetricStress, &stress.transpose(), stress, allowed)
    })
}

pub(super) fn same_stress<T: Scalar, const D: usize>(
    property: Property,
    expected: &SMatrix<T, D, D>,
    found: &SMatrix<T, D, D>,
    allowed: T,
) -> Result<(), Failure> {
    for i in 0..D {
        for j in 0..D {
            let place = || Place::Component(i, j);
            near(property, place, expected[(i, j)], found[(i, j)], allowed)?;
        }
    }
    Ok(())
}

/// `stress(2 d) = 2 stress(d)` up to `d^2`, with a factor for the law's curvature.
pub(super) fn small_increments<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
) -> Result<(), Failure> {
    let two = T::lit(2.0);
    let allowed = modulus::<T, D, L>(law, sample) * (T::lit(16.0) * step::<T>() * step::<T>());
    for direction in directions::<T, D>() {
        let stress_after = |size: T| {
            let mut material = Material::<T, D, L, _>::new(law);
            material.update(&(direction * size));
            material.stress
        };
        let (small, large) = (stress_after(step()), stress_after(two * step::<T>()));
        same_stress(
            Property::LinearForSmallIncrements,
            &(small * two),
            &large,
            allowed,
        )?;
    }
    Ok(())
}

/// At rest, stretched and compressed: no axis is stiffer than the wave speed says, and where it is claimed,
/// the stiffest is as stiff as that.
pub(super) fn wave_speed<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
    sharp: bool,
) -> Result<(), Failure> {
    let mut worst = Worst::new();
    let allowed = T::lit(16.0) * step::<T>() * step::<T>();
    for strain in [T::zero(), sample.strain, -sample.strain] {
        let material = Material::<T, D, L, _>::stretched(law, strain);
        let claimed = material.wave_modulus(sample);
        let mut stiffest = T::zero();
        for axis in 0..D {
            let stiffness = tangent(&material, axis);
            stiffest = stiffest.max(stiffness);
            let place = || Place::Component(axis, axis);
            at_least(
                Property::WaveSpeed,
                place,
                stiffness * (T::one() - allowed),
                claimed,
            )?;
        }
        worst.record(claimed / stiffest - T::one(), allowed, || Place::Everywhere);
    }
    worst.judge(Property::WaveSpeed, sharp)
}

/// `d sigma_aa / d epsilon_aa` by central differences. That is what drives plane waves along the axis also in
/// stressed material: of the stress increment's change of area and volume nothing is left in uniaxial strain.
fn tangent<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    material: &Material<'_, T, D, L, L::State>,
    axis: usize,
) -> T {
    let after = |size: T| {
        let mut moved = *material;
        moved.update(&(along::<T, D>(axis) * size));
        moved.stress[(axis, axis)]
    };
    (after(step()) - after(-step::<T>())) / (T::lit(2.0) * step::<T>())
}
