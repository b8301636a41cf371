//! The library's random layouts of particles.

pub use materialpoint::testing::layout::*;

use materialpoint::scalar::Scalar;

/// A value between -1 and 1 for each particle, without pattern.
pub fn uneven<T: Scalar>(p: usize) -> T {
    T::lit(((p * p * 7 + p * 3 + 5) % 31) as f64) / T::lit(15.0) - T::one()
}
