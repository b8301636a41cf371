//! What a law says of its elastic part and of its stresses.

use nalgebra::SMatrix;

use super::LawSample;
use super::energy::component;
use super::path::{Material, directions, modulus};
use super::stiffness::{round_off, same_stress, step};
use crate::law::ConstitutiveLaw;
use crate::scalar::Scalar;
use crate::tensor::symmetric;
use crate::testing::failure::{Failure, Place, Property, at_least, near};

/// By how much the answer to a wanted change may exceed it, projected on it: more would overshoot for good.
const OVERSHOOT: f64 = 4.0;

/// Hooke's law with the constants that the law tells, against central differences at rest.
pub(super) fn constants<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
) -> Result<(), Failure> {
    let Some(moduli) = law.elastic_constants() else {
        return Ok(());
    };
    let allowed = modulus::<T, D, L>(law, sample) * (T::lit(16.0) * step::<T>() * step::<T>());
    directions::<T, D>().into_iter().try_for_each(|direction| {
        let after = |size: T| {
            let mut material = Material::<T, D, L, _>::new(law);
            material.update(&(direction * size));
            material.stress
        };
        let tangent = (after(step()) - after(-step::<T>())) / (T::lit(2.0) * step::<T>());
        let strain = symmetric(&direction);
        let expected =
            SMatrix::identity() * (moduli.lambda * strain.trace()) + strain * (moduli.mu + moduli.mu);
        same_stress(Property::ElasticConstants, &expected, &tangent, allowed)
    })
}

/// At rest: the change that the strain for a wanted one makes leads towards it, and not far beyond.
pub(super) fn strain_for<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
) -> Result<(), Failure> {
    let size = modulus::<T, D, L>(law, sample) * step::<T>();
    let pressed = -SMatrix::<T, D, D>::identity();
    let wanted = directions::<T, D>()
        .into_iter()
        .map(|direction| symmetric(&direction));
    wanted.chain([pressed]).try_for_each(|direction| {
        let mut material = Material::<T, D, L, _>::new(law);
        let change = direction * size;
        let strain = law.strain_for(&change, sample.density, &material.stress, &material.state);
        let Some(strain) = strain else {
            return Ok(());
        };
        material.update(&strain);
        let made = material.stress.dot(&direction) / (size * direction.norm_squared());
        // Differences of this size are good to as much.
        let slack = T::lit(16.0) * step::<T>();
        let place = || component(&direction);
        at_least(Property::StrainForChange, place, -slack, made)?;
        at_least(Property::StrainForChange, place, made, T::lit(OVERSHOOT))?;
        // Every material bears pressure.
        if direction == pressed {
            at_least(Property::StrainForChange, place, slack, made)?;
        }
        Ok(())
    })
}

/// A zero increment after a start under a stress that the law has given.
pub(super) fn start<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
) -> Result<(), Failure> {
    let allowed = modulus::<T, D, L>(law, sample) * (T::lit(16.0) * round_off::<T>());
    for strain in [sample.strain, -sample.strain] {
        let given = Material::<T, D, L, _>::stretched(law, strain / T::lit(10.0)).stress;
        let Some(mut state) = law.start(&given, None) else {
            continue;
        };
        let mut stress = given;
        law.update(&SMatrix::zeros(), &mut stress, &mut state);
        same_stress(Property::StartKeepsStress, &given, &stress, allowed)?;
    }
    Ok(())
}

/// No step may end in an error for a stress that the sample's strains lead to.
pub(super) fn knows<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
) -> Result<(), Failure> {
    [T::zero(), sample.strain, -sample.strain]
        .into_iter()
        .try_for_each(|strain| {
            let material = Material::<T, D, L, _>::stretched(law, strain);
            let known = law.knows(&material.stress, &material.state);
            let found = if known { T::one() } else { T::zero() };
            near(
                Property::KnowsItsStress,
                || Place::Component(0, 0),
                T::one(),
                found,
                T::zero(),
            )
        })
}
