//! What takes time.

use nalgebra::SMatrix;

use super::LawSample;
use super::energy::component;
use super::path::{Material, directions, modulus};
use super::stiffness::{round_off, step};
use crate::law::ConstitutiveLaw;
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Property, at_least};

/// Increments of a path, and of the time that material is held.
const STEPS: usize = 64;

/// Sizes of a step (s).
const TIMES: [f64; 4] = [1e-6, 1e-3, 1.0, 1e3];

/// Strained to the end of each path, then held: what was put in covers the energy, and that does not grow
/// while nothing moves. Of a law whose energy is not its work, energy and work of rates without a potential
/// differ by the strain.
pub(super) fn no_energy_from_nothing<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
    energy_is_work: bool,
) -> Result<(), Failure> {
    let unit = modulus::<T, D, L>(law, sample);
    let steps = T::count(STEPS);
    let second_order = sample.strain * sample.strain / steps;
    let absolute = unit * (round_off::<T>() * steps + second_order * second_order);
    let share = if energy_is_work { steps } else { T::one() };
    let relative = T::lit(4.0) * sample.strain / share + steps * T::default_epsilon();
    for dt in TIMES.map(T::lit) {
        for direction in directions::<T, D>() {
            let place = || component(&direction);
            let mut material = Material::<T, D, L, _>::new(law);
            material.follow_over(Some(dt), &(direction * sample.strain), STEPS);
            let (energy, work) = (material.energy(), material.work);
            let allowed = relative * energy.abs().max(work.abs()) + absolute;
            at_least(Property::NoEnergyFromNothing, place, -allowed, work - energy)?;
            material.follow_over(Some(dt), &SMatrix::zeros(), STEPS);
            let allowed = absolute + energy.abs() * steps * round_off::<T>();
            at_least(
                Property::NoEnergyFromNothing,
                place,
                -allowed,
                energy - material.energy(),
            )?;
        }
    }
    Ok(())
}

/// An increment over next to no time, or over all of it, gives the stress of `update`.
pub(super) fn update_is_a_limit<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
) -> Result<(), Failure> {
    let allowed = modulus::<T, D, L>(law, sample) * (T::lit(16.0) * step::<T>() * step::<T>());
    for direction in directions::<T, D>() {
        let after = |dt: Option<f64>| {
            let mut material = Material::<T, D, L, _>::new(law);
            material.follow_over(dt.map(T::lit), &(direction * step::<T>()), 1);
            material.stress
        };
        let without = after(None);
        let distance = |dt: f64| (after(Some(dt)) - without).norm();
        // Of what is no number the other is less.
        let nearest = distance(1e-12).min(distance(1e12));
        at_least(
            Property::UpdateIsALimit,
            || component(&direction),
            nearest,
            allowed,
        )?;
    }
    Ok(())
}
