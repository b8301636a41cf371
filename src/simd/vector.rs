//! Packs that are vectors of the processor, and the choice of packs at run time.

use std::any::{Any, TypeId};
use std::ops::{Add, Div, Mul, Sub};
use std::sync::OnceLock;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Select, f32x4, f32x8, f64x4};

use super::plain::packs;
use super::{Lanes, Number, Packs, inlined, sealed::Sealed};
use crate::scalar::Scalar;

/// `value` as the other type, if that is the same one.
#[inline(always)]
fn same<A: Copy + 'static, B: Copy + 'static>(value: A) -> Option<B> {
    (&value as &dyn Any).downcast_ref().copied()
}

/// Whether both are the same type.
#[inline(always)]
pub(crate) fn is<A: 'static, B: 'static>() -> bool {
    TypeId::of::<A>() == TypeId::of::<B>()
}

/// The vectors of a processor are made of their own scalar only, and nobody but the macros below has a token
/// for them: asked for another one they would panic.
#[cold]
#[inline(never)]
fn not_its_lanes<V, T>() -> ! {
    panic!(
        "{} is not made of {}",
        std::any::type_name::<V>(),
        std::any::type_name::<T>()
    )
}

macro_rules! vector {
    ($token:ident, $pack:ident, $vector:ident, $scalar:ty, $lanes:literal, |$simd:ident, $packs:ident| $sums:expr) => {
        #[doc = concat!("Makes packs of ", stringify!($lanes), " `", stringify!($scalar), "`.")]
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $token<S>(pub(crate) S);

        #[doc = concat!("As many `", stringify!($scalar), "` in a vector of the processor.")]
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $pack<S: Simd>($vector<S>);

        impl<S: Simd> Add for $pack<S> {
            type Output = Self;

            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }

        impl<S: Simd> Sub for $pack<S> {
            type Output = Self;

            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self(self.0 - other.0)
            }
        }

        impl<S: Simd> Mul for $pack<S> {
            type Output = Self;

            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self(self.0 * other.0)
            }
        }

        impl<S: Simd> Div for $pack<S> {
            type Output = Self;

            #[inline(always)]
            fn div(self, other: Self) -> Self {
                Self(self.0 / other.0)
            }
        }

        impl<T: Scalar, S: Simd> Number<T> for $pack<S> {
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                Self(SimdFloat::mul_add(self.0, factor.0, term.0))
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(SimdFloat::sqrt(self.0))
            }

            #[inline(always)]
            fn abs(self) -> Self {
                Self(self.0.abs())
            }

            #[inline(always)]
            fn above(self, other: Self) -> Self {
                let s = self.0.simd;
                Self(
                    self.0
                        .simd_gt(other.0)
                        .select($vector::splat(s, 1.0), $vector::splat(s, 0.0)),
                )
            }
        }

        impl<S> Sealed for $token<S> {}

        impl<T: Scalar, S: Simd> Lanes<T> for $token<S> {
            type V = $pack<S>;

            #[inline(always)]
            fn splat(self, value: T) -> $pack<S> {
                match same(value) {
                    Some(value) => $pack($vector::splat(self.0, value)),
                    None => not_its_lanes::<$pack<S>, T>(),
                }
            }

            #[inline(always)]
            fn one_by_one<const W: usize>(
                self,
                pack: $pack<S>,
                f: impl FnMut(T) -> [[T; W]; 2],
            ) -> [[$pack<S>; W]; 2] {
                packs(
                    Packs::<T, $lanes>::array(self, pack),
                    f,
                    #[inline(always)]
                    |values| Packs::<T, $lanes>::pack(self, values),
                )
            }

            #[inline(always)]
            fn run<R>(self, f: impl FnOnce() -> R) -> R {
                self.0.vectorize(f)
            }
        }

        impl<T: Scalar, S: Simd> Packs<T, $lanes> for $token<S> {
            #[inline(always)]
            fn pack(self, values: [T; $lanes]) -> $pack<S> {
                match same::<_, [$scalar; $lanes]>(values) {
                    Some(values) => $pack($vector::load_array(self.0, values)),
                    None => not_its_lanes::<$pack<S>, T>(),
                }
            }

            #[inline(always)]
            fn array(self, pack: $pack<S>) -> [T; $lanes] {
                match same::<[$scalar; $lanes], _>(pack.0.to_array()) {
                    Some(values) => values,
                    None => not_its_lanes::<$pack<S>, T>(),
                }
            }

            #[inline(always)]
            fn are_between(self, pack: $pack<S>, low: $pack<S>, high: $pack<S>) -> bool {
                (pack.0.simd_gt(low.0) & high.0.simd_gt(pack.0)).all_true()
            }

            #[inline(always)]
            fn sums(self, $packs: [$pack<S>; 4]) -> [T; 4] {
                let $simd = self.0;
                match same::<[$scalar; 4], _>($sums) {
                    Some(sums) => sums,
                    None => not_its_lanes::<$pack<S>, T>(),
                }
            }
        }
    };
}

vector!(Doubles, Double4, f64x4, f64, 4, |simd, packs| {
    let half = inlined(
        #[inline(always)]
        |pack: Double4<S>| {
            let (low, high) = simd.split_f64x4(pack.0);
            low + high
        },
    );
    let [a, b, c, d] = packs;
    let [a, b, c, d] = [half(a), half(b), half(c), half(d)];
    let [ab, cd] = [a.unzip_low(b) + a.unzip_high(b), c.unzip_low(d) + c.unzip_high(d)];
    let ([a, b], [c, d]) = (ab.to_array(), cd.to_array());
    [a, b, c, d]
});
vector!(Singles, Single4, f32x4, f32, 4, |_simd, packs| {
    let [a, b, c, d] = packs;
    let ab = a.0.unzip_low(b.0) + a.0.unzip_high(b.0);
    let cd = c.0.unzip_low(d.0) + c.0.unzip_high(d.0);
    (ab.unzip_low(cd) + ab.unzip_high(cd)).to_array()
});
vector!(ManySingles, Single8, f32x8, f32, 8, |simd, packs| {
    let half = inlined(
        #[inline(always)]
        |pack: Single8<S>| {
            let (low, high) = simd.split_f32x8(pack.0);
            low + high
        },
    );
    let [a, b, c, d] = packs;
    let [a, b, c, d] = [half(a), half(b), half(c), half(d)];
    let ab = a.unzip_low(b) + a.unzip_high(b);
    let cd = c.unzip_low(d) + c.unzip_high(d);
    (ab.unzip_low(cd) + ab.unzip_high(cd)).to_array()
});

/// The vectors of this machine's processors, if there are any that we use.
#[cfg(target_arch = "x86_64")]
pub(crate) type Best = fearless_simd::Avx2;
#[cfg(target_arch = "aarch64")]
pub(crate) type Best = fearless_simd::Neon;

/// Elsewhere there are none.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
pub(crate) type Best = fearless_simd::Fallback;

/// What proves that the processor has them.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
#[inline]
pub(crate) fn processor() -> Option<Best> {
    static FOUND: OnceLock<Option<Best>> = OnceLock::new();
    *FOUND.get_or_init(|| {
        #[cfg(target_arch = "x86_64")]
        return Level::new().as_avx2();
        #[cfg(target_arch = "aarch64")]
        return Level::new().as_neon();
    })
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
#[inline]
pub(crate) fn processor() -> Option<Best> {
    None
}

/// Whether a scalar has no vectors on any processor, as its size and alignment tell a compiler. One that is
/// laid out as `f64` or `f32` and is neither goes the way of those without vectors.
pub(crate) const fn only_plain<T>() -> bool {
    !matches!((size_of::<T>(), align_of::<T>()), (8, 8) | (4, 4))
}

/// Whether there are packs worth computing a scalar with, on this machine.
#[inline(always)]
pub(crate) fn packs_serve<T: Scalar>() -> bool {
    only_plain::<T>() || (is::<T, f64>() || is::<T, f32>()) && processor().is_some()
}

/// Vectors were asked for where there are none: a mistake of ours, never of input.
#[cold]
#[inline(never)]
pub(crate) fn no_packs() -> ! {
    panic!("no packs serve this scalar here")
}

/// Calls `f` in a function of its own with the instruction set that packs have: a loop there is made of
/// vectors if a compiler finds that it can be.
#[inline(always)]
pub(crate) fn with_features<R>(f: impl FnOnce() -> R) -> R {
    match processor() {
        Some(simd) => simd.vectorize(f),
        None => f(),
    }
}

/// Evaluates an expression with a token for packs of the given scalar, four to a pack, in a function that has
/// their instruction set. What the expression uses is moved: of references to it a compiler would not know
/// that what is written leaves them alone. The size is asked first because the compiler knows it before it
/// makes the code for the packs that are not wanted.
macro_rules! dispatch {
    ($scalar:ty, |$token:ident| $body:expr) => {
        $crate::simd::dispatch_with!($scalar, $token, $body, Singles, true)
    };
}

/// The same for what there is another way for: only asked where [`packs_serve`] the scalar, so that none are
/// made of `f64` and `f32` on processors without vectors.
macro_rules! dispatch_vectors {
    ($scalar:ty, |$token:ident| $body:expr) => {
        $crate::simd::dispatch_with!(
            $scalar,
            $token,
            $body,
            Singles,
            $crate::simd::vector::only_plain::<$scalar>()
        )
    };
}

/// The latter with as many to a pack as suit particles of the given cells: eight `f32` where most come in
/// eights.
macro_rules! dispatch_for {
    ($scalar:ty, $eights:expr, |$token:ident| $body:expr) => {
        if const { size_of::<$scalar>() == 4 } && $eights {
            $crate::simd::dispatch_with!(
                $scalar,
                $token,
                $body,
                ManySingles,
                $crate::simd::vector::only_plain::<$scalar>()
            )
        } else {
            $crate::simd::dispatch_vectors!($scalar, |$token| $body)
        }
    };
}

macro_rules! dispatch_with {
    ($scalar:ty, $token:ident, $body:expr, $singles:ident, $plain:expr) => {{
        use $crate::simd::vector;
        if const { size_of::<$scalar>() == 8 }
            && vector::is::<$scalar, f64>()
            && let Some(simd) = vector::processor()
        {
            let $token = vector::Doubles(simd);
            $crate::simd::Lanes::<$scalar>::run(
                $token,
                #[inline(always)]
                move || $body,
            )
        } else if const { size_of::<$scalar>() == 4 }
            && vector::is::<$scalar, f32>()
            && let Some(simd) = vector::processor()
        {
            let $token = vector::$singles(simd);
            $crate::simd::Lanes::<$scalar>::run(
                $token,
                #[inline(always)]
                move || $body,
            )
        } else if const { $plain } {
            let $token = $crate::simd::Plain;
            $crate::simd::Lanes::<$scalar>::run(
                $token,
                #[inline(always)]
                move || $body,
            )
        } else {
            vector::no_packs()
        }
    }};
}
pub(crate) use {dispatch, dispatch_for, dispatch_vectors, dispatch_with};
