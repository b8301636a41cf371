//! The steppers along one axis.

#![forbid(unsafe_code)]

use materialpoint::method::Method;
use materialpoint_steppers_parts::{Built, Parts};

/// The stepper of a method.
///
/// # Errors
/// If there is no such method, or the parts do not serve.
#[inline(never)]
pub fn stepper(parts: Parts<f64, 1>, method: Method) -> Built<1> {
    materialpoint_steppers_parts::stepper(parts, method)
}
