//! Values as plain numbers, for checkpoints.

use nalgebra::SMatrix;

use crate::scalar::Scalar;

/// A value that can be told as numbers and made from them again, to the bit.
///
/// What a law remembers of a particle and what a phase carries must be able to, where a stepper is to be a
/// [`Simulation`](crate::stepper::Simulation): a checkpoint holds them. `()`, a number, an array and a vector
/// or matrix of nalgebra are. A state of your own hands its fields over one after the other:
///
/// ```
/// use materialpoint::record::Record;
///
/// #[derive(Clone, Copy, Default, PartialEq, Debug)]
/// struct Damaged {
///     strain: [f64; 3],
///     damage: f64,
/// }
///
/// impl Record<f64> for Damaged {
///     fn put(&self, out: &mut impl FnMut(f64)) {
///         self.strain.put(out);
///         self.damage.put(out);
///     }
///
///     fn take(from: &mut impl FnMut() -> f64) -> Option<Self> {
///         Some(Self {
///             strain: Record::take(from)?,
///             damage: Record::take(from)?,
///         })
///     }
/// }
///
/// let state = Damaged { strain: [1.0, 2.0, 3.0], damage: 0.5 };
/// let mut numbers = Vec::new();
/// state.put(&mut |x| numbers.push(x));
/// let mut numbers = numbers.into_iter();
/// assert_eq!(Record::take(&mut || numbers.next().unwrap_or_default()), Some(state));
/// ```
pub trait Record<T>: Sized {
    /// Hands the numbers over, in an order that is always the same.
    fn put(&self, out: &mut impl FnMut(T));

    /// Takes as many from `from`, in that order; `None` if no value has these numbers.
    fn take(from: &mut impl FnMut() -> T) -> Option<Self>;
}

impl<T> Record<T> for () {
    fn put(&self, _out: &mut impl FnMut(T)) {}

    fn take(_from: &mut impl FnMut() -> T) -> Option<Self> {
        Some(())
    }
}

macro_rules! number {
    ($($scalar:ty),+) => {$(
        impl Record<$scalar> for $scalar {
            fn put(&self, out: &mut impl FnMut($scalar)) {
                out(*self);
            }

            fn take(from: &mut impl FnMut() -> $scalar) -> Option<Self> {
                Some(from())
            }
        }
    )+};
}

number!(f64, f32);

impl<T: Scalar, const N: usize> Record<T> for [T; N] {
    fn put(&self, out: &mut impl FnMut(T)) {
        self.iter().copied().for_each(out);
    }

    fn take(from: &mut impl FnMut() -> T) -> Option<Self> {
        Some(std::array::from_fn(|_| from()))
    }
}

impl<T: Scalar, const R: usize, const C: usize> Record<T> for SMatrix<T, R, C> {
    fn put(&self, out: &mut impl FnMut(T)) {
        self.iter().copied().for_each(out);
    }

    fn take(from: &mut impl FnMut() -> T) -> Option<Self> {
        Some(Self::from_fn(|_, _| from()))
    }
}
