//! Dual numbers as nalgebra's real number.

use nalgebra::{ComplexField, RealField};
use num_traits::{One, Signed, Zero};

use super::Dual;

/// Functions that do not exist in this scalar.
macro_rules! absent {
    ($($name:ident($($argument:ident),*) -> $result:ty),* $(,)?) => {$(
        fn $name(self $(, $argument: Self)*) -> $result {
            panic!(concat!("these dual numbers have no ", stringify!($name)))
        }
    )*};
}

impl ComplexField for Dual {
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
        if self.value < 0.0 {
            Self::pi()
        } else {
            Self::zero()
        }
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
        Self::from(self.value.floor())
    }

    fn ceil(self) -> Self {
        Self::from(self.value.ceil())
    }

    fn round(self) -> Self {
        Self::from(self.value.round())
    }

    fn trunc(self) -> Self {
        Self::from(self.value.trunc())
    }

    fn fract(self) -> Self {
        self - Self::from(self.value.trunc())
    }

    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }

    fn abs(self) -> Self {
        Signed::abs(&self)
    }

    fn signum(self) -> Self {
        Signed::signum(&self)
    }

    fn hypot(self, other: Self) -> Self {
        (self * self + other * other).sqrt()
    }

    fn recip(self) -> Self {
        Self::one() / self
    }

    fn conjugate(self) -> Self {
        self
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }

    fn exp(self) -> Self {
        let power = self.value.exp();
        self.chain(power, power)
    }

    fn ln(self) -> Self {
        self.chain(self.value.ln(), 1.0 / self.value)
    }

    fn cbrt(self) -> Self {
        let root = self.value.cbrt();
        self.chain(root, 1.0 / (3.0 * root * root))
    }

    fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }

    fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }

    fn sin_cos(self) -> (Self, Self) {
        (ComplexField::sin(self), ComplexField::cos(self))
    }

    fn try_sqrt(self) -> Option<Self> {
        (self.value >= 0.0).then(|| ComplexField::sqrt(self))
    }

    fn powi(self, n: i32) -> Self {
        let power = (0..n.unsigned_abs()).fold(Self::one(), |power, _| power * self);
        if n < 0 { power.recip() } else { power }
    }

    fn is_finite(&self) -> bool {
        self.value.is_finite()
    }

    absent! {
        tan() -> Self, asin() -> Self, acos() -> Self, atan() -> Self,
        sinh() -> Self, cosh() -> Self, tanh() -> Self, asinh() -> Self, acosh() -> Self, atanh() -> Self,
        exp2() -> Self, exp_m1() -> Self, ln_1p() -> Self,
        log2() -> Self, log10() -> Self, log(_base) -> Self,
        powf(_n) -> Self, powc(_n) -> Self,
    }
}

/// Constants by their values.
macro_rules! constants {
    ($($name:ident = $value:ident;)*) => {$(
        fn $name() -> Self {
            Self::from(std::f64::consts::$value)
        }
    )*};
}

impl RealField for Dual {
    fn is_sign_positive(&self) -> bool {
        self.value.is_sign_positive()
    }

    fn is_sign_negative(&self) -> bool {
        self.value.is_sign_negative()
    }

    fn copysign(self, sign: Self) -> Self {
        if self.value.is_sign_negative() == sign.value.is_sign_negative() {
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
        pi = PI; two_pi = TAU; frac_pi_2 = FRAC_PI_2; frac_pi_3 = FRAC_PI_3; frac_pi_4 = FRAC_PI_4;
        frac_pi_6 = FRAC_PI_6; frac_pi_8 = FRAC_PI_8; frac_1_pi = FRAC_1_PI; frac_2_pi = FRAC_2_PI;
        frac_2_sqrt_pi = FRAC_2_SQRT_PI; e = E; log2_e = LOG2_E; log10_e = LOG10_E;
        ln_2 = LN_2; ln_10 = LN_10;
    }
}
