//! The one bound on numbers: [`Scalar`].

use nalgebra::RealField;
use simba::scalar::SupersetOf;

/// A real number the whole crate can compute with: `f64`, `f32`, a dual number, double-double, ...
///
/// Implemented for every `nalgebra::RealField` that is `Copy`; there is nothing to implement by hand.
pub trait Scalar: RealField + Copy {
    /// The literal `x`, exactly if `Self` can hold it.
    ///
    /// Write `T::one() / T::lit(6.0)`, never `T::lit(1.0 / 6.0)`: the quotient must be rounded in `Self`.
    fn lit(x: f64) -> Self;

    /// A count as a number.
    fn count(n: usize) -> Self;

    /// The value as `f64`: a dual number loses its derivative, a wider type its last digits.
    fn primal(self) -> f64;
}

impl<T: RealField + Copy> Scalar for T {
    #[inline(always)]
    fn lit(x: f64) -> Self {
        nalgebra::convert(x)
    }

    #[inline(always)]
    fn count(n: usize) -> Self {
        nalgebra::convert(n as f64)
    }

    #[inline(always)]
    fn primal(self) -> f64 {
        <T as SupersetOf<f64>>::to_subset_unchecked(&self)
    }
}

#[cfg(test)]
mod tests {
    use super::Scalar;

    #[test]
    fn a_quotient_is_rounded_in_its_own_type() {
        assert_eq!(f32::lit(1.0) / f32::lit(6.0), 1.0_f32 / 6.0);
        assert_eq!(f64::count(3), 3.0);
        assert_eq!(0.1_f32.primal(), f64::from(0.1_f32));
    }
}
