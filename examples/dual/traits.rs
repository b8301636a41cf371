//! What `num-traits`, `approx` and `simba` want of a number before it may be a field.

use std::fmt;

use approx::{AbsDiffEq, RelativeEq, UlpsEq};
use num_traits::{FromPrimitive, Num, One, ParseFloatError, Signed, Zero};
use simba::scalar::{Field, SubsetOf};
use simba::simd::SimdValue;

use super::Dual;

impl fmt::Display for Dual {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:e} + {:e} d", self.value, self.derivative)
    }
}

impl Zero for Dual {
    fn zero() -> Self {
        Self::from(0.0)
    }

    fn is_zero(&self) -> bool {
        self.value == 0.0
    }
}

impl One for Dual {
    fn one() -> Self {
        Self::from(1.0)
    }
}

impl Num for Dual {
    type FromStrRadixErr = ParseFloatError;

    fn from_str_radix(text: &str, radix: u32) -> Result<Self, ParseFloatError> {
        f64::from_str_radix(text, radix).map(Self::from)
    }
}

impl Signed for Dual {
    fn abs(&self) -> Self {
        if self.value < 0.0 { -*self } else { *self }
    }

    fn abs_sub(&self, other: &Self) -> Self {
        if self > other {
            *self - *other
        } else {
            Self::zero()
        }
    }

    fn signum(&self) -> Self {
        Self::from(self.value.signum())
    }

    fn is_positive(&self) -> bool {
        self.value > 0.0
    }

    fn is_negative(&self) -> bool {
        self.value < 0.0
    }
}

impl FromPrimitive for Dual {
    fn from_i64(n: i64) -> Option<Self> {
        Some(Self::from(n as f64))
    }

    fn from_u64(n: u64) -> Option<Self> {
        Some(Self::from(n as f64))
    }

    fn from_f64(x: f64) -> Option<Self> {
        Some(Self::from(x))
    }
}

macro_rules! subset {
    ($($float:ty),*) => {$(
        impl SubsetOf<Dual> for $float {
            fn to_superset(&self) -> Dual {
                Dual::from(f64::from(*self))
            }

            fn from_superset_unchecked(element: &Dual) -> Self {
                element.value as Self
            }

            fn is_in_subset(_: &Dual) -> bool {
                true
            }
        }
    )*};
}

subset!(f32, f64);

impl SubsetOf<Self> for Dual {
    fn to_superset(&self) -> Self {
        *self
    }

    fn from_superset_unchecked(element: &Self) -> Self {
        *element
    }

    fn is_in_subset(_: &Self) -> bool {
        true
    }
}

/// One lane. The unchecked methods, unsafe by the trait's declaration, are the checked ones here.
#[expect(unsafe_code, reason = "the trait declares them so; nothing here is unsafe")]
impl SimdValue for Dual {
    const LANES: usize = 1;
    type Element = Self;
    type SimdBool = bool;

    fn splat(val: Self) -> Self {
        val
    }

    fn extract(&self, _lane: usize) -> Self {
        *self
    }

    unsafe fn extract_unchecked(&self, i: usize) -> Self {
        self.extract(i)
    }

    fn replace(&mut self, _lane: usize, val: Self) {
        *self = val;
    }

    unsafe fn replace_unchecked(&mut self, i: usize, val: Self) {
        self.replace(i, val);
    }

    fn select(self, condition: bool, other: Self) -> Self {
        if condition { self } else { other }
    }
}

impl Field for Dual {}

impl AbsDiffEq for Dual {
    type Epsilon = Self;

    fn default_epsilon() -> Self {
        Self::from(f64::EPSILON)
    }

    fn abs_diff_eq(&self, other: &Self, epsilon: Self) -> bool {
        Signed::abs(&(*self - *other)) <= epsilon
    }
}

impl RelativeEq for Dual {
    fn default_max_relative() -> Self {
        Self::default_epsilon()
    }

    fn relative_eq(&self, other: &Self, epsilon: Self, max_relative: Self) -> bool {
        let (a, b) = (Signed::abs(self), Signed::abs(other));
        let largest = if a > b { a } else { b };
        self.abs_diff_eq(other, epsilon) || self.abs_diff_eq(other, largest * max_relative)
    }
}

impl UlpsEq for Dual {
    fn default_max_ulps() -> u32 {
        4
    }

    fn ulps_eq(&self, other: &Self, epsilon: Self, max_ulps: u32) -> bool {
        let relative = Self::from(f64::from(max_ulps)) * Self::default_epsilon();
        self.relative_eq(other, epsilon, relative)
    }
}
