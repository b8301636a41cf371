//! Checks of material constants.

use crate::error::SetupError;
use crate::scalar::Scalar;

/// Refuses a constant that is not `fine`, or not finite.
pub(super) fn require<T: Scalar>(
    name: &'static str,
    value: T,
    fine: bool,
    allowed: &'static str,
) -> Result<(), SetupError> {
    if fine && value.is_finite() {
        return Ok(());
    }
    let value = value.primal();
    Err(SetupError::Constant { name, value, allowed })
}

/// Refuses a constant that is negative.
pub(super) fn not_negative<T: Scalar>(name: &'static str, value: T) -> Result<(), SetupError> {
    require(
        name,
        value,
        value >= T::zero(),
        "it must be finite and not negative",
    )
}

/// Refuses a constant that is not positive.
pub(super) fn positive<T: Scalar>(name: &'static str, value: T) -> Result<(), SetupError> {
    require(name, value, value > T::zero(), "it must be positive and finite")
}
