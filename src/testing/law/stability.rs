//! Whether material hardens or softens.

use nalgebra::SMatrix;

use super::LawSample;
use super::path::{Material, along, modulus};
use super::stiffness::round_off;
use crate::law::ConstitutiveLaw;
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Place, Property};
use crate::testing::worst::Worst;

/// Increments of the path.
const STEPS: usize = 256;

/// Simple shear, in one dimension compression, to the sample's strain: the largest drop of the stress below
/// what it has been.
///
/// Shear keeps the volume, so that stress per current area has nothing to lose by it; axes that turn by the
/// strain change the component by the strain's square.
pub(super) fn check<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
    stable: bool,
) -> Result<(), Failure> {
    let absolute = modulus::<T, D, L>(law, sample) * round_off::<T>();
    let relative = T::lit(4.0) * sample.strain * sample.strain;
    let (direction, (row, column)) = match D {
        1 => (-along::<T, D>(0), (0, 0)),
        _ => (shear(), (0, D - 1)),
    };
    let mut worst = Worst::new();
    let mut material = Material::<T, D, L, _>::new(law);
    let (increment, mut most) = (direction * (sample.strain / T::count(STEPS)), T::zero());
    for _ in 0..STEPS {
        material.update(&increment);
        let stress = material.stress[(row, column)] * direction[(row, column)];
        most = most.max(stress);
        worst.record(most - stress, absolute + relative * most, || {
            Place::Component(row, column)
        });
    }
    worst.judge(Property::Stable, stable)
}

fn shear<T: Scalar, const D: usize>() -> SMatrix<T, D, D> {
    let mut gradient = SMatrix::zeros();
    gradient[(0, D - 1)] = T::one();
    gradient
}
