//! Double-double as nalgebra's real number.

use nalgebra::{ComplexField, RealField};
use num_traits::{One, Signed, Zero};

use super::DoubleDouble;

/// Functions that do not exist in this scalar.
macro_rules! absent {
    ($($name:ident($($argument:ident),*) -> $result:ty),* $(,)?) => {$(
        fn $name(self $(, $argument: Self)*) -> $result {
            panic!(concat!("double-double has no ", stringify!($name)))
        }
    )*};
}

impl ComplexField for DoubleDouble {
    type RealField = Self;

    fn from_real(re: Self) -> Self {
        re
    }

    fn real(self) -> Self {
        self
    }

    fn imaginary(self) -> Self {
        Self::zero()
    }

    fn modulus(self) -> Self {
        Signed::abs(&self)
    }

    fn modulus_squared(self) -> Self {
        self * self
    }

    fn argument(self) -> Self {
        if self.hi < 0.0 { Self::pi() } else { Self::zero() }
    }

    fn norm1(self) -> Self {
        Signed::abs(&self)
    }

    fn scale(self, factor: Self) -> Self {
        self * factor
    }

    fn unscale(self, factor: Self) -> Self {
        self / factor
    }

    fn floor(self) -> Self {
        let whole = self.truncated();
        if whole > self { whole - Self::one() } else { whole }
    }

    fn ceil(self) -> Self {
        -(-self).floor()
    }

    /// Halves away from zero.
    fn round(self) -> Self {
        (self + Self::from(0.5_f64.copysign(self.hi))).truncated()
    }

    fn trunc(self) -> Self {
        self.truncated()
    }

    fn fract(self) -> Self {
        self - self.truncated()
    }

    /// Rounded twice.
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }

    fn abs(self) -> Self {
        Signed::abs(&self)
    }

    fn signum(self) -> Self {
        Signed::signum(&self)
    }

    /// Without scaling: for numbers whose squares are in the range of `f64`.
    fn hypot(self, other: Self) -> Self {
        (self * self + other * other).square_root()
    }

    fn recip(self) -> Self {
        Self::one() / self
    }

    fn conjugate(self) -> Self {
        self
    }

    fn sqrt(self) -> Self {
        self.square_root()
    }

    fn try_sqrt(self) -> Option<Self> {
        (self.hi >= 0.0).then(|| self.square_root())
    }

    fn powi(self, n: i32) -> Self {
        let power = (0..n.unsigned_abs()).fold(Self::one(), |power, _| power * self);
        if n < 0 { power.recip() } else { power }
    }

    fn is_finite(&self) -> bool {
        self.hi.is_finite()
    }

    absent! {
        sin() -> Self, cos() -> Self, tan() -> Self, sin_cos() -> (Self, Self),
        asin() -> Self, acos() -> Self, atan() -> Self,
        sinh() -> Self, cosh() -> Self, tanh() -> Self, asinh() -> Self, acosh() -> Self, atanh() -> Self,
        exp() -> Self, exp2() -> Self, exp_m1() -> Self,
        ln() -> Self, ln_1p() -> Self, log2() -> Self, log10() -> Self, log(_base) -> Self,
        powf(_n) -> Self, powc(_n) -> Self, cbrt() -> Self,
    }
}

/// Constants by both of their parts.
macro_rules! constants {
    ($($name:ident = $hi:expr, $lo:expr;)*) => {$(
        fn $name() -> Self {
            Self { hi: $hi, lo: $lo }
        }
    )*};
}

/// Constants as quotients of others.
macro_rules! quotients {
    ($($name:ident = $above:expr, $below:expr;)*) => {$(
        fn $name() -> Self {
            $above / $below
        }
    )*};
}

impl RealField for DoubleDouble {
    fn is_sign_positive(&self) -> bool {
        self.hi.is_sign_positive()
    }

    fn is_sign_negative(&self) -> bool {
        self.hi.is_sign_negative()
    }

    fn copysign(self, sign: Self) -> Self {
        if self.hi.is_sign_negative() == sign.hi.is_sign_negative() {
            self
        } else {
            -self
        }
    }

    fn max(self, other: Self) -> Self {
        if self < other { other } else { self }
    }

    fn min(self, other: Self) -> Self {
        if self > other { other } else { self }
    }

    fn clamp(self, min: Self, max: Self) -> Self {
        RealField::min(RealField::max(self, min), max)
    }

    absent! { atan2(_other) -> Self }

    fn min_value() -> Option<Self> {
        Some(Self::from(f64::MIN))
    }

    fn max_value() -> Option<Self> {
        Some(Self::from(f64::MAX))
    }

    constants! {
        pi = std::f64::consts::PI, 1.224_646_799_147_353_2e-16;
        e = std::f64::consts::E, 1.445_646_891_729_250_2e-16;
        ln_2 = std::f64::consts::LN_2, 2.319_046_813_846_299_6e-17;
        ln_10 = std::f64::consts::LN_10, -2.170_756_223_382_249_4e-16;
    }

    quotients! {
        two_pi = Self::pi(), Self::from(0.5);
        frac_pi_2 = Self::pi(), Self::from(2.0);
        frac_pi_3 = Self::pi(), Self::from(3.0);
        frac_pi_4 = Self::pi(), Self::from(4.0);
        frac_pi_6 = Self::pi(), Self::from(6.0);
        frac_pi_8 = Self::pi(), Self::from(8.0);
        frac_1_pi = Self::one(), Self::pi();
        frac_2_pi = Self::from(2.0), Self::pi();
        frac_2_sqrt_pi = Self::from(2.0), Self::pi().square_root();
        log2_e = Self::one(), Self::ln_2();
        log10_e = Self::one(), Self::ln_10();
    }
}
