//! Energy against work.

use super::LawSample;
use super::path::{Material, directions, modulus};
use super::stiffness::{round_off, step};
use crate::law::ConstitutiveLaw;
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Place, Property, near};
use crate::testing::worst::Worst;

/// Increments of a path.
const STEPS: usize = 512;

/// Compares `energy * volume` with the work of the stress at the end of straight paths.
///
/// An increment `d` stands for the logarithmic strain `d - d^2/2 + ...`, and a law may follow it at first
/// order: relative errors of the work and of the energy are some `d` each, `4 d` together. An energy per
/// volume is computed from numbers of the size of the modulus. Where a path strains the law at second order
/// only, as an isochoric one does a fluid, all of the energy is of that error: the modulus times the square
/// of the `d^2` of all increments.
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

/// The leading term in the strain, which is of second order: energy and work at a strain so small that what
/// follows, of third order, is hardly more than the round-off of an energy.
pub(super) fn at_small_strain<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
) -> Result<(), Failure> {
    let unit = modulus::<T, D, L>(law, sample);
    let strain = step::<T>().min(sample.strain);
    let factor = T::lit(16.0);
    let allowed = unit * (factor * strain * strain * strain + round_off::<T>());
    directions::<T, D>().into_iter().try_for_each(|direction| {
        let mut material = Material::<T, D, L, _>::new(law);
        material.follow(&(direction * strain), 4);
        let place = || component(&direction);
        near(
            Property::EnergyAtSmallStrain,
            place,
            material.work,
            material.energy(),
            allowed,
        )
    })
}

/// The largest component of a direction.
pub(super) fn component<T: Scalar, const D: usize>(direction: &nalgebra::SMatrix<T, D, D>) -> Place {
    let (row, column) = direction.iamax_full();
    Place::Component(row, column)
}
