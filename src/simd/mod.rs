//! Numbers computed side by side.
//!
//! A processor's vector unit adds or multiplies four `f64`, or eight `f32`, in the time of one. Compilers
//! rarely find that out for the sums of a particle method, so sweeps are written once, generic in a *token*
//! ([`Lanes`], [`Packs`]) that makes *packs* of numbers: [`Plain`] makes them of any scalar, dual numbers for
//! instance, [`One`] is a single number, and for `f64` and `f32` there are the vectors of the processor,
//! whose token is a proof that the processor has them. It is asked for once a sweep, at run time
//! (`dispatch`): no build flag is wanted of anyone.
//!
//! Everything inside a sweep must be inlined into it, closures too (`#[inline(always)] |a| ..`): what is not
//! loses the instruction set, and with it a factor of three to six. `each` stands in for
//! `std::array::from_fn`, which is not certain to be. What must stay a function of its own is run by
//! [`Lanes::run`].

mod one;
mod plain;
pub(crate) mod vector;

pub use one::One;
pub use plain::{Four, Plain};
pub(crate) use vector::{
    dispatch, dispatch_for, dispatch_vectors, dispatch_with, is, packs_serve, with_features,
};

use std::ops::{Add, Div, Mul, Sub};

use crate::scalar::Scalar;

/// Number of lanes, unless told otherwise.
pub const LANES: usize = 4;

/// Number of lanes, at most.
pub(crate) const MOST_LANES: usize = 8;

/// Numbers of type `T` that are computed with side by side, however many they are.
pub trait Number<T>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Send + Sync
{
    /// `self * factor + term`, in one operation where the processor has it.
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// Square roots.
    fn sqrt(self) -> Self;

    /// Sizes.
    fn abs(self) -> Self;

    /// One where the number is greater than the other's, zero elsewhere.
    fn above(self, other: Self) -> Self;
}

/// What makes packs, however many numbers they have: all that the functions of a basis are made of.
pub trait Lanes<T>: Copy + Send + Sync + sealed::Sealed {
    /// A pack.
    type V: Number<T>;

    /// The same number in every lane.
    fn splat(self, value: T) -> Self::V;

    /// What `f` makes of each number, one lane after another.
    fn one_by_one<const W: usize>(self, pack: Self::V, f: impl FnMut(T) -> [[T; W]; 2]) -> [[Self::V; W]; 2];

    /// Calls `f` in a function of its own that has the instruction set of the packs.
    fn run<R>(self, f: impl FnOnce() -> R) -> R;
}

/// What makes packs of `N` numbers.
pub trait Packs<T, const N: usize = LANES>: Lanes<T> {
    /// The given numbers.
    fn pack(self, values: [T; N]) -> Self::V;

    /// The numbers of a pack.
    fn array(self, pack: Self::V) -> [T; N];

    /// Whether every number lies between the others' and equals neither.
    fn are_between(self, pack: Self::V, low: Self::V, high: Self::V) -> bool;

    /// Sums over the lanes of four packs at once.
    fn sums(self, packs: [Self::V; 4]) -> [T; 4];
}

mod sealed {
    /// Tokens are made here.
    pub trait Sealed {}
}

/// `std::array::from_fn` of one number at least that is certain to be inlined.
#[inline(always)]
pub(crate) fn each<A: Copy, const N: usize>(mut f: impl FnMut(usize) -> A) -> [A; N] {
    let mut all = [f(0); N];
    for i in 1..N {
        all[i] = f(i);
    }
    all
}

/// The same of numbers for a pack, which begins with zeros: of the first number in all places a compiler
/// makes shuffles.
#[inline(always)]
pub(crate) fn in_lanes<T: Scalar, const N: usize>(mut f: impl FnMut(usize) -> T) -> [T; N] {
    let mut all = [T::zero(); N];
    for i in 0..N {
        all[i] = f(i);
    }
    all
}

/// Calls `f` for each number below `N`, in code of its own where these are few: arrays that are indexed by it
/// can stay in registers then. Compilers give up on loops within loops whose ends differ.
#[inline(always)]
pub(crate) fn unrolled<const N: usize>(mut f: impl FnMut(usize)) {
    if const { N > 6 } {
        for n in 0..N {
            f(n);
        }
        return;
    }
    if const { N > 0 } {
        f(0);
    }
    if const { N > 1 } {
        f(1);
    }
    if const { N > 2 } {
        f(2);
    }
    if const { N > 3 } {
        f(3);
    }
    if const { N > 4 } {
        f(4);
    }
    if const { N > 5 } {
        f(5);
    }
}

/// A closure that is certain to be inlined if it is told so: attributes are allowed on arguments only.
#[inline(always)]
pub(crate) fn inlined<F>(f: F) -> F {
    f
}

#[cfg(test)]
mod tests;
