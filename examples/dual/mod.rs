//! A scalar that carries a derivative: dual numbers with all that the library asks of a real number.
//!
//! Comparisons and `is_zero` see the value alone, as those of dual numbers do: a number that is zero may have
//! a derivative.

mod real_field;
mod traits;

use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign};

/// `value + derivative d` with `d^2 = 0`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Dual {
    /// The number.
    pub value: f64,
    /// Its derivative.
    pub derivative: f64,
}

impl Dual {
    /// A number with its derivative.
    pub fn new(value: f64, derivative: f64) -> Self {
        Self { value, derivative }
    }

    /// A function of this number, by its value and slope here.
    fn chain(self, value: f64, slope: f64) -> Self {
        Self::new(value, slope * self.derivative)
    }
}

impl From<f64> for Dual {
    fn from(value: f64) -> Self {
        Self::new(value, 0.0)
    }
}

impl PartialEq for Dual {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl PartialOrd for Dual {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl Neg for Dual {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(-self.value, -self.derivative)
    }
}

impl Add for Dual {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value, self.derivative + other.derivative)
    }
}

impl Sub for Dual {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Dual {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let derivative = self.derivative * other.value + self.value * other.derivative;
        Self::new(self.value * other.value, derivative)
    }
}

impl Div for Dual {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        Self::new(
            quotient,
            (self.derivative - quotient * other.derivative) / other.value,
        )
    }
}

impl Rem for Dual {
    type Output = Self;

    fn rem(self, other: Self) -> Self {
        self - Self::from((self.value / other.value).trunc()) * other
    }
}

macro_rules! assigning {
    ($($trait:ident $method:ident $operator:tt),*) => {$(
        impl $trait for Dual {
            fn $method(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    )*};
}

assigning!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *, DivAssign div_assign /,
    RemAssign rem_assign %);
