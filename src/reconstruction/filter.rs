//! What a step takes from the particles' stress and velocity because no fit sees it.

use super::Cloud;
use crate::field::Field;
use crate::scalar::Scalar;
use sealed::Filters;

/// What a step takes from the particles' stress and velocity: [`NoFilter`] or, with
/// [`RelaxedTaylor`](super::RelaxedTaylor), the [`NullSpace`] of its fits. Nobody else can implement it.
pub trait Filter<T: Scalar, const D: usize, R>: Filters<T, D, R> {}

/// Nothing.
#[derive(Clone, Copy, Debug)]
pub struct NoFilter;

/// A share of what the fits of [`RelaxedTaylor`](super::RelaxedTaylor) do not see, at the rates of its
/// [`Relaxation`](super::Relaxation).
#[derive(Clone, Copy, Debug)]
pub struct NullSpace;

impl<T: Scalar, const D: usize, R> Filter<T, D, R> for NoFilter {}

impl<T: Scalar, const D: usize, R> Filters<T, D, R> for NoFilter {}

/// How far the particles of a cell determine its functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filling {
    /// They fill it, as far as its functions can tell.
    Filled,
    /// They fill a part, or see all functions but squares.
    PartlyFilled,
    /// They do not, but better cells are near.
    Underdetermined,
    /// Neither do those near it.
    Isolated,
}

/// Parts of a cell that are crossed in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CourantNumbers<T> {
    /// By a wave.
    pub wave: T,
    /// By the particles.
    pub motion: T,
}

/// Out of reach of other crates.
pub(crate) mod sealed {
    use super::{Cloud, CourantNumbers, Field, Filling, Scalar};

    /// How a step filters what a reconstruction `R` does not see.
    pub trait Filters<T: Scalar, const D: usize, R> {
        /// Whether anything is filtered.
        const FILTERS: bool = false;

        /// Moves the particles' `values` towards what the reconstruction sees of them. `crossed` says for
        /// each occupied cell which part of it a wave and its particles cross in this step: the measures of
        /// time for a relaxation. Asked for the stress right after the force is assembled; a law with a state
        /// is then strained towards the moved stress.
        fn relax<Q: Field<T>>(
            _reconstruction: &mut R,
            _cloud: &Cloud<'_, T, D>,
            _crossed: &[CourantNumbers<T>],
            _values: &mut [Q],
        ) {
            const { assert!(!Self::FILTERS) };
        }

        /// The same by a fit that keeps the sum weighted with `weights` (masses). Asked for the velocity,
        /// before it is mapped to the DOFs.
        fn relax_weighted<Q: Field<T>>(
            _reconstruction: &mut R,
            _cloud: &Cloud<'_, T, D>,
            _weights: &[T],
            _crossed: &[CourantNumbers<T>],
            _values: &mut [Q],
        ) {
            const { assert!(!Self::FILTERS) };
        }

        /// How far the particles of the occupied cell at `place` in the list of those determine its
        /// functions. With a matrix of the particles a step ties, beyond one dimension, the functions of
        /// cells that are not full to those of the next ones ([`crate::mass::Penalty`]); those of cells that
        /// are alone it lumps.
        fn filling(_reconstruction: &R, _place: usize) -> Filling {
            const { assert!(!Self::FILTERS) };
            Filling::Filled
        }

        /// A liquid flows: its pressure is filtered with the stress.
        fn suit_liquid(_reconstruction: &mut R) {}
    }
}
