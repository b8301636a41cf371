//! Dual numbers as nalgebra's real numbers.

use std::f64::consts::{LN_2, LN_10};

use nalgebra::{ComplexField, RealField};
use num_traits::{One, Signed, Zero};

use super::Dual;

/// Functions of one number, by value and slope at `x`; `y` is the value.
macro_rules! functions {
    ($($name:ident: |$x:ident, $y:ident| $slope:expr;)*) => {$(
        fn $name(self) -> Self {
            let $x = self.value;
            let $y = $x.$name();
            self.chain($y, $slope)
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

    functions! {
        sqrt: |_x, y| 0.5 / y;
        cbrt: |_x, y| 1.0 / (3.0 * y * y);
        exp: |_x, y| y;
        exp2: |_x, y| y * LN_2;
        exp_m1: |_x, y| y + 1.0;
        ln: |x, _y| 1.0 / x;
        ln_1p: |x, _y| 1.0 / (1.0 + x);
        log2: |x, _y| 1.0 / (x * LN_2);
        log10: |x, _y| 1.0 / (x * LN_10);
        sin: |x, _y| x.cos();
        cos: |x, _y| -x.sin();
        tan: |_x, y| 1.0 + y * y;
        asin: |x, _y| 1.0 / (1.0 - x * x).sqrt();
        acos: |x, _y| -1.0 / (1.0 - x * x).sqrt();
        atan: |x, _y| 1.0 / (1.0 + x * x);
        sinh: |x, _y| x.cosh();
        cosh: |x, _y| x.sinh();
        tanh: |_x, y| 1.0 - y * y;
        asinh: |x, _y| 1.0 / (x * x + 1.0).sqrt();
        acosh: |x, _y| 1.0 / (x * x - 1.0).sqrt();
        atanh: |x, _y| 1.0 / (1.0 - x * x);
    }

    fn log(self, base: Self) -> Self {
        ComplexField::ln(self) / ComplexField::ln(base)
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

    fn powf(self, n: Self) -> Self {
        let power = self.value.powf(n.value);
        let by_base = n.value * self.value.powf(n.value - 1.0) * self.derivative;
        // Of a base that is not positive the exponent must be a plain number.
        let by_exponent = match n.derivative {
            0.0 => 0.0,
            derivative => power * self.value.ln() * derivative,
        };
        Self::new(power, by_base + by_exponent)
    }

    fn powc(self, n: Self) -> Self {
        self.powf(n)
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

    fn atan2(self, other: Self) -> Self {
        let squared = self.value * self.value + other.value * other.value;
        let turn = self.derivative * other.value - self.value * other.derivative;
        Self::new(self.value.atan2(other.value), turn / squared)
    }

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
