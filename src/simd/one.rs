//! A single number as a pack.

use super::{Lanes, Number, Packs, sealed::Sealed};
use crate::scalar::Scalar;

/// Makes packs of one number of any scalar.
#[derive(Clone, Copy, Debug, Default)]
pub struct One;

impl Sealed for One {}

impl<T: Scalar> Number<T> for T {
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        nalgebra::ComplexField::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        nalgebra::ComplexField::abs(self)
    }

    #[inline(always)]
    fn above(self, other: Self) -> Self {
        if self > other { T::one() } else { T::zero() }
    }
}

impl<T: Scalar> Lanes<T> for One {
    type V = T;

    #[inline(always)]
    fn splat(self, value: T) -> T {
        value
    }

    #[inline(always)]
    fn one_by_one<const W: usize>(self, pack: T, mut f: impl FnMut(T) -> [[T; W]; 2]) -> [[T; W]; 2] {
        f(pack)
    }

    #[inline(always)]
    fn run<R>(self, f: impl FnOnce() -> R) -> R {
        f()
    }
}

impl<T: Scalar> Packs<T, 1> for One {
    #[inline(always)]
    fn pack(self, [value]: [T; 1]) -> T {
        value
    }

    #[inline(always)]
    fn array(self, pack: T) -> [T; 1] {
        [pack]
    }

    #[inline(always)]
    fn are_between(self, pack: T, low: T, high: T) -> bool {
        pack > low && pack < high
    }

    #[inline(always)]
    fn sums(self, packs: [T; 4]) -> [T; 4] {
        packs
    }
}
