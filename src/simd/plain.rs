//! Packs of any scalar: four numbers after one another.

use std::ops::{Add, Div, Mul, Sub};

use super::{LANES, Lanes, Number, Packs, each, sealed::Sealed};
use crate::scalar::Scalar;

/// Makes packs of four numbers of any scalar: the same code as for the vectors of a processor, and the same
/// result but for the rounding that their [`Number::mul_add`] spares.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plain;

/// Four numbers.
#[derive(Clone, Copy, Debug)]
pub struct Four<T>(pub [T; LANES]);

impl<T: Scalar> Four<T> {
    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        Self(each(
            #[inline(always)]
            |l| f(self.0[l], other.0[l]),
        ))
    }
}

macro_rules! operation {
    ($trait:ident, $method:ident) => {
        impl<T: Scalar> $trait for Four<T> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(
                    other,
                    #[inline(always)]
                    |a, b| $trait::$method(a, b),
                )
            }
        }
    };
}

operation!(Add, add);
operation!(Sub, sub);
operation!(Mul, mul);
operation!(Div, div);

impl<T: Scalar> Number<T> for Four<T> {
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(nalgebra::ComplexField::sqrt))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(nalgebra::ComplexField::abs))
    }

    #[inline(always)]
    fn above(self, other: Self) -> Self {
        self.with(
            other,
            #[inline(always)]
            |a, b| if a > b { T::one() } else { T::zero() },
        )
    }
}

impl Sealed for Plain {}

/// Two rows of `W` packs from what `f` makes of each number.
#[inline(always)]
pub(super) fn packs<T: Scalar, V: Copy, const N: usize, const W: usize>(
    numbers: [T; N],
    mut f: impl FnMut(T) -> [[T; W]; 2],
    new: impl Fn([T; N]) -> V,
) -> [[V; W]; 2] {
    let mut lanes = [[[T::zero(); N]; W]; 2];
    for l in 0..N {
        let rows = f(numbers[l]);
        for row in 0..2 {
            for k in 0..W {
                lanes[row][k][l] = rows[row][k];
            }
        }
    }
    each(
        #[inline(always)]
        |row| {
            each(
                #[inline(always)]
                |k| new(lanes[row][k]),
            )
        },
    )
}

impl<T: Scalar> Lanes<T> for Plain {
    type V = Four<T>;

    #[inline(always)]
    fn splat(self, value: T) -> Four<T> {
        Four([value; LANES])
    }

    #[inline(always)]
    fn one_by_one<const W: usize>(self, pack: Four<T>, f: impl FnMut(T) -> [[T; W]; 2]) -> [[Four<T>; W]; 2] {
        packs(pack.0, f, Four)
    }

    #[inline(never)]
    fn run<R>(self, f: impl FnOnce() -> R) -> R {
        f()
    }
}

impl<T: Scalar> Packs<T> for Plain {
    #[inline(always)]
    fn pack(self, values: [T; LANES]) -> Four<T> {
        Four(values)
    }

    #[inline(always)]
    fn array(self, pack: Four<T>) -> [T; LANES] {
        pack.0
    }

    #[inline(always)]
    fn are_between(self, pack: Four<T>, low: Four<T>, high: Four<T>) -> bool {
        (0..LANES).all(|l| pack.0[l] > low.0[l] && pack.0[l] < high.0[l])
    }

    #[inline(always)]
    fn sums(self, packs: [Four<T>; 4]) -> [T; 4] {
        packs.map(|Four([a, b, c, d])| (a + b) + (c + d))
    }
}
