//! Deviations judged by claims.

use super::failure::{Expected, Failure, Place, Property, near};
use crate::scalar::Scalar;

/// The largest deviation from a property, and where: judged by what is claimed.
#[derive(Clone, Debug)]
pub(super) struct Worst<T> {
    /// Largest deviation over what round-off allows.
    ratio: T,
    deviation: T,
    allowed: T,
    place: Place,
}

/// By how much a deviation must exceed round-off before it proves that a property does *not* hold.
const CLEARLY: f64 = 16.0;

impl<T: Scalar> Worst<T> {
    pub(super) fn new() -> Self {
        Self {
            ratio: T::zero(),
            deviation: T::zero(),
            allowed: T::zero(),
            place: Place::Everywhere,
        }
    }

    /// Takes in a deviation that round-off explains up to `allowed`.
    pub(super) fn record(&mut self, deviation: T, allowed: T, place: impl FnOnce() -> Place) {
        let deviation = deviation.abs();
        if deviation == T::zero() {
            return;
        }
        let ratio = deviation / allowed;
        // A NaN stays for good: no later comparison with it is true.
        if ratio > self.ratio || (!ratio.is_finite() && self.ratio.is_finite()) {
            *self = Self {
                ratio,
                deviation,
                allowed,
                place: place(),
            };
        }
    }

    /// The property holds where it is claimed, and clearly does not where it is not.
    pub(super) fn judge(self, property: Property, claimed: bool) -> Result<(), Failure> {
        if claimed {
            return near(property, || self.place, T::zero(), self.deviation, self.allowed);
        }
        if self.ratio >= T::lit(CLEARLY) {
            return Ok(());
        }
        Err(Failure {
            property,
            place: self.place,
            expected: Expected::Violation { times: CLEARLY },
            found: self.ratio.primal(),
        })
    }
}
