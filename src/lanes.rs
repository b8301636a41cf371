//! Some numbers computed side by side.
//!
//! A processor's vector unit adds or multiplies four `f64`, or eight `f32`, in the time of one. Compilers rarely find that out
//! for the sums of a particle method, so the passes over particles are written for [`Lanes`]: one lane for each
//! of four or eight particles of a cell. For `f64` and `f32` the lanes are a vector register (crate `wide`); for every other scalar,
//! dual numbers for instance, they are [`Four`], four scalars after one another: the same code, and the same result but for
//! the rounding that [`SideBySide::mul_add`] spares. What has a cell in each lane always has four.

use std::any::Any;
use std::ops::{Add, Div, Mul, Sub};

use wide::{f32x4, f32x8, f64x4};

use crate::scalar::Scalar;

/// Number of lanes, unless told otherwise.
pub const LANES: usize = 4;

/// Number of lanes, at most.
pub(crate) const MOST_LANES: usize = 8;

/// Numbers of type `T` that are computed with side by side, however many they are: what the functions of a basis are made of.
pub trait SideBySide<T>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Send
{
    /// The same one in every lane.
    fn splat(value: T) -> Self;

    /// `self * factor + term`, in one operation where the processor has it.
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// Square roots.
    fn sqrt(self) -> Self;

    /// Sizes.
    fn abs(self) -> Self;

    /// One where the number is greater than the other's, zero elsewhere.
    fn above(self, other: Self) -> Self;

    /// What `f` makes of each number, one lane after another.
    fn one_by_one<const K: usize>(self, f: impl FnMut(T) -> [[T; K]; 2]) -> [[Self; K]; 2];
}

/// `N` such numbers.
pub trait Lanes<T, const N: usize = LANES>: SideBySide<T> {
    /// The given ones.
    fn new(values: [T; N]) -> Self;

    /// The numbers.
    fn array(self) -> [T; N];

    /// Whether every number lies between the others' and equals neither.
    #[inline(always)]
    fn are_between(self, low: Self, high: Self) -> bool
    where
        T: PartialOrd,
    {
        let (low, high) = (low.array(), high.array());
        let mut numbers = self.array().into_iter().zip(low.iter().zip(&high));
        numbers.all(|(x, (low, high))| x > *low && x < *high)
    }

    /// Sums over the lanes of four packs at once.
    fn sums(packs: [Self; 4]) -> [T; 4];
}

/// `value` as the other type, if that is the same one.
#[inline(always)]
fn same<A: Copy + 'static, B: Copy + 'static>(value: A) -> Option<B> {
    (&value as &dyn Any).downcast_ref().copied()
}

/// Whether both are the same type.
#[inline(always)]
pub(crate) fn is<A: 'static, B: 'static>() -> bool {
    std::any::TypeId::of::<A>() == std::any::TypeId::of::<B>()
}

/// Calls `$run::<V>` with the lanes `V` of the scalar `$scalar`. The size is asked first because the compiler knows it before
/// it makes the code for the lanes that are not wanted.
macro_rules! with_lanes_of {
    ($scalar:ty, $receiver:ident . $run:ident $([$($more:tt),*])? ( $($argument:expr),* )) => {
        if const { size_of::<$scalar>() == 8 } && $crate::lanes::is::<$scalar, f64>() {
            $receiver.$run::<::wide::f64x4 $(, $($more),*)?>($($argument),*)
        } else if const { size_of::<$scalar>() == 4 } && $crate::lanes::is::<$scalar, f32>() {
            $receiver.$run::<::wide::f32x4 $(, $($more),*)?>($($argument),*)
        } else {
            $receiver.$run::<$crate::lanes::Four<$scalar> $(, $($more),*)?>($($argument),*)
        }
    };
}
pub(crate) use with_lanes_of;

/// Lanes of any scalar.
#[derive(Clone, Copy, Debug)]
pub struct Four<T>(pub [T; LANES]);

impl<T: Scalar> Four<T> {
    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        Self(std::array::from_fn(|l| f(self.0[l], other.0[l])))
    }
}

impl<T: Scalar> Add for Four<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl<T: Scalar> Sub for Four<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl<T: Scalar> Mul for Four<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl<T: Scalar> Div for Four<T> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.with(other, |a, b| a / b)
    }
}

/// Two rows of `K` packs from what `f` makes of each number.
#[inline(always)]
fn packs<T: Scalar, V: Copy, const N: usize, const K: usize>(
    numbers: [T; N],
    mut f: impl FnMut(T) -> [[T; K]; 2],
    new: impl Fn([T; N]) -> V,
) -> [[V; K]; 2] {
    let mut lanes = [[[T::zero(); N]; K]; 2];
    for l in 0..N {
        let rows = f(numbers[l]);
        for row in 0..2 {
            for k in 0..K {
                lanes[row][k][l] = rows[row][k];
            }
        }
    }
    let pack = |row: usize| std::array::from_fn(|k| new(lanes[row][k]));
    [pack(0), pack(1)]
}

impl<T: Scalar> SideBySide<T> for Four<T> {
    #[inline(always)]
    fn splat(value: T) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(T::sqrt))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(nalgebra::ComplexField::abs))
    }

    #[inline(always)]
    fn above(self, other: Self) -> Self {
        self.with(other, |a, b| if a > b { T::one() } else { T::zero() })
    }

    #[inline(always)]
    fn one_by_one<const K: usize>(self, f: impl FnMut(T) -> [[T; K]; 2]) -> [[Self; K]; 2] {
        packs(self.0, f, Self)
    }
}

impl<T: Scalar> Lanes<T> for Four<T> {
    #[inline(always)]
    fn new(values: [T; LANES]) -> Self {
        Self(values)
    }

    #[inline(always)]
    fn array(self) -> [T; LANES] {
        self.0
    }

    #[inline(always)]
    fn sums(packs: [Self; 4]) -> [T; 4] {
        packs.map(|Self([a, b, c, d])| (a + b) + (c + d))
    }
}

/// Vectors of a processor as lanes of a scalar that is not their own: a mistake of whoever names both types,
/// never of input.
#[cold]
#[inline(never)]
fn not_its_lanes<V, T>() -> ! {
    panic!(
        "{} is not made of {}",
        std::any::type_name::<V>(),
        std::any::type_name::<T>()
    )
}

/// The vectors of a processor are the lanes of their own scalar only: asked for another one they panic.
macro_rules! vector {
    ($vector:ident, $scalar:ty, $lanes:literal, |$packs:ident| $sums:expr) => {
        impl<T: Scalar> SideBySide<T> for $vector {
            #[inline(always)]
            fn splat(value: T) -> Self {
                Self::splat(same(value).unwrap_or_else(|| not_its_lanes::<Self, T>()))
            }

            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                self.mul_add(factor, term)
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                self.sqrt()
            }

            #[inline(always)]
            fn abs(self) -> Self {
                self.abs()
            }

            #[inline(always)]
            fn above(self, other: Self) -> Self {
                self.simd_gt(other) & Self::splat(1.0)
            }

            #[inline(always)]
            fn one_by_one<const K: usize>(self, f: impl FnMut(T) -> [[T; K]; 2]) -> [[Self; K]; 2] {
                packs(self.array(), f, <Self as Lanes<T, $lanes>>::new)
            }
        }

        impl<T: Scalar> Lanes<T, $lanes> for $vector {
            #[inline(always)]
            fn new(values: [T; $lanes]) -> Self {
                let values: Option<[$scalar; $lanes]> = same(values);
                Self::new(values.unwrap_or_else(|| not_its_lanes::<Self, T>()))
            }

            #[inline(always)]
            fn array(self) -> [T; $lanes] {
                same(self.to_array()).unwrap_or_else(|| not_its_lanes::<Self, T>())
            }

            #[inline(always)]
            fn are_between(self, low: Self, high: Self) -> bool {
                (self.simd_gt(low) & high.simd_gt(self)).all()
            }

            #[inline(always)]
            fn sums($packs: [Self; 4]) -> [T; 4] {
                $sums
            }
        }
    };
}

vector!(f64x4, f64, 4, |packs| {
    let [a, b, c, d] = f64x4::transpose(packs);
    ((a + b) + (c + d)).array()
});
vector!(f32x4, f32, 4, |packs| {
    let [a, b, c, d] = f32x4::transpose(packs);
    ((a + b) + (c + d)).array()
});
vector!(f32x8, f32, 8, |packs| {
    let halves = packs.map(|pack| {
        let [a, b, c, d, e, f, g, h] = pack.to_array();
        f32x4::new([a, b, c, d]) + f32x4::new([e, f, g, h])
    });
    f32x4::sums(halves)
});

#[cfg(test)]
mod tests {
    use super::*;

    fn check<T: Scalar, V: Lanes<T>>() {
        let numbers = [0.5, -2.0, 3.0, 4.0].map(T::lit);
        let [[half], [double]] = V::new(numbers).one_by_one(|x| [[x / T::lit(2.0)], [x + x]]);
        assert_eq!((half + half).array(), numbers);
        assert_eq!(double.array()[3], T::lit(8.0));
        let (a, two) = (V::new(numbers), V::splat(T::lit(2.0)));
        assert_eq!(a.array(), numbers);
        assert_eq!(
            a.mul_add(two, a - two).array(),
            [-0.5, -8.0, 7.0, 10.0].map(T::lit)
        );
        assert_eq!(
            (a / two).above(V::splat(T::zero())).array(),
            [1.0, 0.0, 1.0, 1.0].map(T::lit)
        );
        let between = |low: f64, high: f64| a.are_between(V::splat(T::lit(low)), V::splat(T::lit(high)));
        assert!(between(-2.5, 4.5) && !between(-2.0, 4.5) && !between(-2.5, 4.0));
        let none = V::splat(T::zero() / T::zero());
        assert!(!none.are_between(a - two, a) && !a.are_between(none, two));
        assert_eq!((a.abs() * two).sqrt().array()[1], T::lit(2.0));
        assert_eq!(
            V::sums([a, two, a + two, a * two]),
            [5.5, 8.0, 13.5, 11.0].map(T::lit)
        );
    }

    #[test]
    fn eight_lanes_do_what_four_do() {
        let numbers = [0.5, -2.0, 3.0, 4.0, 5.0, -1.5, 0.25, 8.0_f32];
        let a = <f32x8 as Lanes<f32, 8>>::new(numbers);
        assert_eq!(Lanes::<f32, 8>::array(a), numbers);
        let one = f32x8::splat(1.0);
        assert_eq!(
            <f32x8 as Lanes<f32, 8>>::sums([a, one, a + one, a * one]),
            [17.25, 8.0, 25.25, 17.25]
        );
    }

    #[test]
    fn all_lanes_do_the_same() {
        check::<f64, f64x4>();
        check::<f32, f32x4>();
        check::<f64, Four<f64>>();
    }
}
