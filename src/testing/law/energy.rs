//! Energy against work.

use super::LawSample;
use super::path::{Material, directions, modulus};
use crate::law::ConstitutiveLaw;
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Place, Property};
use crate::testing::worst::Worst;

/// Increments of a path.
const STEPS: usize = 512;

/// Compares `energy * volume` with the work of the stress at the end of straight paths.
///
/// An increment `d` stands for the logarithmic strain `d - d^2/2 + ...`, and a law may follow it at first order:
/// relative errors of the work and of the energy are some `d` each, `4 d` together. An energy per volume is
/// computed from numbers of the size of the modulus. Where a path strains the law at second order only, as an isochoric one does a
/// fluid, all of the energy is of that error: the modulus times the square of the `d^2` of all increments.
pub(super) fn is_work<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
    claimed: bool,
) -> Result<(), Failure> {
    let unit = modulus::<T, D, L>(law, sample);
    let round_off = unit * T::lit(16.0) * T::default_epsilon();
    let second_order = sample.strain * sample.strain / T::count(STEPS);
    let absolute = round_off + unit * second_order * second_order;
    let relative = T::lit(4.0) * sample.strain / T::count(STEPS) + T::count(STEPS) * T::default_epsilon();
    let mut worst = Worst::new();
    for direction in directions::<T, D>() {
        for strain in [sample.strain, -sample.strain] {
            let mut material = Material::<T, D, L, _>::new(law);
            material.follow(&(direction * strain), STEPS);
            let (energy, work) = (material.energy(), material.work);
            let allowed = relative * energy.abs().max(work.abs()) + absolute;
            worst.record(energy - work, allowed, || component(&direction));
        }
    }
    worst.judge(Property::EnergyIsWork, claimed)
}

/// The largest component of a direction.
fn component<T: Scalar, const D: usize>(direction: &nalgebra::SMatrix<T, D, D>) -> Place {
    let (row, column) = direction.iamax_full();
    Place::Component(row, column)
}
