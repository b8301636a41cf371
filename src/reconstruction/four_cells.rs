//! What goes with fits of four cells at once ([`Streams`]). No other crate can name any of it.

use std::ops::Range;

use super::points::sealed::Streams;
use super::{Cloud, PointSet};
use crate::grid::Cell;
use crate::scalar::Scalar;
use crate::simd::{LANES, each};

/// Taylor functions are fitted in four cells at once: goes with an implementation of [`Streams`] for the fits.
#[derive(Clone, Copy, Debug)]
pub struct InFours;

impl<T: Scalar, const D: usize, R> PointSet<T, D, R> for InFours where InFours: Streams<T, D, R> {}

/// The occupied cells at the given places, four at most and one at least; the last one again in the place of
/// others.
#[inline(always)]
pub(crate) fn batch_of_cells<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    places: Range<usize>,
) -> [(usize, Cell<D>); LANES] {
    let occupied = &cloud.bins.occupied()[places];
    if let (1, &[a, b, c, d]) = (D, occupied) {
        // Numbers along the only axis are places on it.
        let first = cloud.grid.window().first()[0];
        return [a, b, c, d].map(|number| (number as usize, [first + number; D]));
    }
    each(
        #[inline(always)]
        |l| {
            let number = occupied[l.min(occupied.len() - 1)] as usize;
            (number, cloud.grid.cell(number))
        },
    )
}

/// What became of four cells that were streamed at once.
#[derive(Clone, Copy, Debug, Default)]
pub struct BatchStatus {
    /// Whether a cell could not be.
    pub hard: [bool; LANES],
    /// How many were fitted without the full set of functions.
    pub reduced: usize,
}

/// What is kept of four cells from the first fit of a step to the second.
#[derive(Debug)]
pub struct Kept<'a, T> {
    /// As many numbers as [`Streams::KEPT`], or none: nothing can be kept then.
    pub numbers: &'a mut [[T; LANES]],
    /// Whether particles have not moved since they were kept.
    pub fresh: bool,
}

impl<T> Kept<'_, T> {
    /// Nothing.
    pub fn nothing() -> Self {
        Self {
            numbers: &mut [],
            fresh: false,
        }
    }
}
