//! A scalar of twice the digits: the judge of what `f64` loses.
//!
//! A number is the unevaluated sum of two `f64`, `hi + lo` with `|lo| <= ulp(hi)/2`: 106 bits, 32 decimal
//! digits. Sums and products after Dekker (1971) and Knuth; `mul_add` gives the error of a product exactly.
//! The four operations and the square root are good to a few units of 2^-104.
//!
//! It is a `RealField`, so every kernel of the crate can run in it. Transcendental functions do not exist:
//! one that fell back to `f64` would bring sixteen digits where thirty are believed, so asking for one panics
//! and names it.

mod real_field;
mod traits;

use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign};

/// `hi + lo`, normalised: comparing `hi` first and then `lo` is comparing the numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct DoubleDouble {
    hi: f64,
    lo: f64,
}

/// `a + b` and its rounding error.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// `a b` and its rounding error.
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

impl DoubleDouble {
    /// The normalised sum of two `f64`, exactly.
    pub fn new(a: f64, b: f64) -> Self {
        let (hi, lo) = two_sum(a, b);
        // The error of an infinite sum is no number, but the sum is.
        let lo = if hi.is_finite() { lo } else { 0.0 };
        Self { hi, lo }
    }

    /// Nearest `f64`.
    pub fn nearest(self) -> f64 {
        self.hi
    }

    /// Karp's square root: one Newton step in full precision on the `f64` root.
    fn square_root(self) -> Self {
        if self.hi <= 0.0 || !self.hi.is_finite() {
            return Self::from(self.hi.sqrt());
        }
        let root = self.hi.sqrt();
        let (square, error) = two_product(root, root);
        let rest = self - Self::new(square, error);
        Self::new(root, rest.hi / (2.0 * root))
    }

    /// Towards zero.
    fn truncated(self) -> Self {
        let round = if self.hi < 0.0 { f64::ceil } else { f64::floor };
        match round(self.hi) {
            // `hi` is whole, so `lo` decides.
            whole if whole == self.hi => Self::new(whole, round(self.lo)),
            whole => Self::from(whole),
        }
    }
}

impl From<f64> for DoubleDouble {
    fn from(x: f64) -> Self {
        Self { hi: x, lo: 0.0 }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            hi: -self.hi,
            lo: -self.lo,
        }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, high_error) = two_sum(self.hi, other.hi);
        let (low, low_error) = two_sum(self.lo, other.lo);
        let first = Self::new(high, high_error + low);
        Self::new(first.hi, first.lo + low_error)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (product, error) = two_product(self.hi, other.hi);
        Self::new(product, error + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Div for DoubleDouble {
    type Output = Self;

    /// Long division, three digits of `f64` each.
    fn div(self, other: Self) -> Self {
        let first = self.hi / other.hi;
        if !first.is_finite() || !other.hi.is_finite() {
            return Self::from(first);
        }
        let rest = self - other * Self::from(first);
        let second = rest.hi / other.hi;
        let third = (rest - other * Self::from(second)).hi / other.hi;
        Self::new(first, second) + Self::from(third)
    }
}

impl Rem for DoubleDouble {
    type Output = Self;

    fn rem(self, other: Self) -> Self {
        self - (self / other).truncated() * other
    }
}

macro_rules! assigning {
    ($($trait:ident $method:ident $operator:tt),*) => {$(
        impl $trait for DoubleDouble {
            fn $method(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    )*};
}

assigning!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *, DivAssign div_assign /,
    RemAssign rem_assign %);

#[cfg(test)]
mod tests {
    use materialpoint::quadrature::gauss_legendre;
    use materialpoint::scalar::Scalar;
    use nalgebra::{ComplexField, RealField};
    use num_traits::{One, Zero};

    use super::DoubleDouble;

    type Double = DoubleDouble;

    fn lit(x: f64) -> Double {
        Double::lit(x)
    }

    /// 2^-104: a few of these is what an operation may lose.
    fn unit() -> f64 {
        2.0_f64.powi(-104)
    }

    #[test]
    fn what_f64_swallows_is_kept() {
        assert_eq!(1.0 + 1e-20 - 1.0, 0.0);
        assert_eq!((Double::one() + lit(1e-20)) - Double::one(), lit(1e-20));
        assert_eq!(lit(1e16) + lit(1.5) - lit(1e16), lit(1.5));
    }

    #[test]
    fn a_third_times_three_is_one() {
        for n in [3.0, 7.0, 49.0, 1e5 + 3.0] {
            let error = Double::one() / lit(n) * lit(n) - Double::one();
            assert!(error.abs().primal() <= unit(), "{n}: {error}");
            // And it is not the rounded quotient of f64.
            assert!((Double::one() / lit(n) - lit(1.0 / n)).abs().primal() > 1e-18 / n);
        }
    }

    #[test]
    fn the_square_of_a_root_comes_back() {
        for x in [2.0, 3.0, 1e-30, 7e20] {
            let root = lit(x).sqrt();
            assert!((root * root - lit(x)).abs().primal() <= 4.0 * unit() * x, "{x}");
        }
        assert_eq!(Double::zero().sqrt(), Double::zero());
        assert!(!lit(-1.0).sqrt().is_finite() && lit(-1.0).try_sqrt().is_none());
    }

    /// Machin's formula, `pi = 16 atan(1/5) - 4 atan(1/239)`: hundreds of operations against a stored
    /// constant.
    #[test]
    fn machin_finds_pi() {
        let atan_of_inverse = |n: f64| {
            let (mut term, mut sum) = (Double::one() / lit(n), Double::zero());
            for k in 0..30 {
                sum += term / Double::count(2 * k + 1);
                term /= -lit(n * n);
            }
            sum
        };
        let pi = lit(16.0) * atan_of_inverse(5.0) - lit(4.0) * atan_of_inverse(239.0);
        assert!((pi - Double::pi()).abs().primal() <= 20.0 * unit(), "{pi}");
    }

    #[test]
    fn numbers_are_ordered_by_their_last_digits_too() {
        let above = Double::one() + lit(1e-25);
        assert!(above > Double::one() && -above < -Double::one());
        assert_eq!(RealField::max(above, Double::one()), above);
        assert_eq!((lit(2.0) - lit(1e-25)).floor(), Double::one());
        assert_eq!((lit(-2.0) + lit(1e-25)).trunc(), -Double::one());
        assert!((lit(7.5) % lit(2.0) - lit(1.5)).is_zero());
    }

    /// The crate's own iteration in this scalar: Gauss points `1/sqrt 3` to 31 digits.
    #[test]
    fn the_gauss_rule_is_as_exact_as_the_scalar() {
        let (x, weight) = gauss_legendre::<Double>(2)[1];
        assert!((x * x * lit(3.0) - Double::one()).abs().primal() <= 4.0 * unit());
        assert!((weight - Double::one()).abs().primal() <= 8.0 * unit());
    }

    #[test]
    #[should_panic(expected = "double-double has no sin")]
    fn a_function_that_is_not_there_says_so() {
        let _ = lit(1.0).sin();
    }
}
