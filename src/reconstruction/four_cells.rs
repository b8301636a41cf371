//! Fits of four cells at once: how a step asks the fits of the library. No other crate can name any of it.

use std::ops::Range;

use super::points::sealed::Streams;
use super::{CellStream, Cloud, Point, PointSet, Values};
use crate::field::Field;
use crate::grid::Cell;
use crate::scalar::Scalar;
use crate::simd::{LANES, Packs, each};
use crate::taylor::MOST_COMPONENTS;

/// Taylor functions are fitted in four cells at once: goes with [`FourCells`].
#[derive(Clone, Copy, Debug)]
pub struct InFours;

impl<T: Scalar, const D: usize, R: FourCells<T, D>> PointSet<T, D, R> for InFours {}

/// A reconstruction by Taylor functions whose cells are fitted four at once.
pub trait FourCells<T: Scalar, const D: usize>: CellStream<T, D> {
    /// Numbers of each of four cells that [`FourCells::fit_batch`] keeps where it does not conserve, and
    /// takes up again where it does.
    const KEPT: usize = 0;

    /// Whether a cell's fit wants what [`Reconstruction::prepare`](super::Reconstruction::prepare) and
    /// [`FourCells::take_in_field`] took in.
    const NON_LOCAL: bool = false;

    /// Takes in the field that will be streamed next, where a cell's fit wants the values of its neighbours.
    fn take_in_field<Q: Field<T>>(&mut self, _cloud: &Cloud<'_, T, D>, _value: &(impl Values<T, Q> + Sync)) {
        const { assert!(!Self::NON_LOCAL, "NON_LOCAL wants an own `take_in_field`") };
    }

    /// Coordinates in a cell, each in `[-1, 1]`, of the points along an axis whose products
    /// [`FourCells::integrate_batch`] streams, axis 0 fastest; none if it cannot as it is set up.
    fn line(&self) -> impl Iterator<Item = T>;

    /// The same points with their weights, as shares of the line.
    fn weighted_line(&self) -> impl Iterator<Item = (T, T)>;

    /// What [`Reconstruction::integrate_conserved`](super::Reconstruction::integrate_conserved) streams, if
    /// `conserve`, or else [`Reconstruction::integrate`](super::Reconstruction::integrate), in up to four
    /// `cells`, places in the list of occupied ones from a multiple of four on: one cell in each lane, the
    /// number of the point and the components of the value. `value` is that of a particle: in the first case
    /// its density. Returns in which cells it failed (those that a surface cuts always), so that they must be
    /// streamed by [`FourCells::integrate_single`].
    fn integrate_batch<K: Packs<T>, Q: Field<T>>(
        &self,
        k: K,
        batch: (&Cloud<'_, T, D>, Range<usize>),
        conserve: bool,
        kept: Kept<'_, T>,
        value: &impl Values<T, Q>,
        sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus;

    /// What [`FourCells::integrate_batch`] streams, before it is evaluated at points: the number of a
    /// function of [`mod@crate::taylor`] and the components of its coefficient, each function once.
    fn fit_batch<K: Packs<T>, Q: Field<T>>(
        &self,
        k: K,
        batch: (&Cloud<'_, T, D>, Range<usize>),
        conserve: bool,
        kept: Kept<'_, T>,
        value: &impl Values<T, Q>,
        sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus;

    /// [`FourCells::integrate_batch`] in one cell that is given by its number, point by point; returns
    /// whether it was fitted with the full set of functions.
    fn integrate_single<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cell: usize,
        conserve: bool,
        value: &dyn Fn(usize) -> Q,
        sink: &mut dyn FnMut(&Point<T, D>, Q),
    ) -> bool;
}

impl<T: Scalar, const D: usize, R: FourCells<T, D>> Streams<T, D, R> for InFours {
    const IN_CELLS: bool = true;
    const IN_FOURS: bool = true;
    const KEPT: usize = R::KEPT;
    const NON_LOCAL: bool = R::NON_LOCAL;

    #[inline(always)]
    fn cells<Q: Field<T>>(
        reconstruction: &R,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        reconstruction.integrate_cells(cloud, cells, value, sink);
    }

    #[inline(always)]
    fn conserved_cells<Q: Field<T>>(
        reconstruction: &R,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        reconstruction.integrate_conserved_cells(cloud, cells, amount, sink);
    }

    #[inline(always)]
    fn take_in_field<Q: Field<T>>(
        reconstruction: &mut R,
        cloud: &Cloud<'_, T, D>,
        value: &(impl Values<T, Q> + Sync),
    ) {
        reconstruction.take_in_field(cloud, value);
    }

    #[inline(always)]
    fn line(reconstruction: &R) -> impl Iterator<Item = T> {
        reconstruction.line()
    }

    #[inline(always)]
    fn weighted_line(reconstruction: &R) -> impl Iterator<Item = (T, T)> {
        reconstruction.weighted_line()
    }

    #[inline(always)]
    fn integrate_batch<K: Packs<T>, Q: Field<T>>(
        reconstruction: &R,
        k: K,
        batch: (&Cloud<'_, T, D>, Range<usize>),
        conserve: bool,
        kept: Kept<'_, T>,
        value: &impl Values<T, Q>,
        sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus {
        reconstruction.integrate_batch::<K, Q>(k, batch, conserve, kept, value, sink)
    }

    #[inline(always)]
    fn fit_batch<K: Packs<T>, Q: Field<T>>(
        reconstruction: &R,
        k: K,
        batch: (&Cloud<'_, T, D>, Range<usize>),
        conserve: bool,
        kept: Kept<'_, T>,
        value: &impl Values<T, Q>,
        sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus {
        reconstruction.fit_batch::<K, Q>(k, batch, conserve, kept, value, sink)
    }

    #[inline(always)]
    fn integrate_single<Q: Field<T>>(
        reconstruction: &R,
        cloud: &Cloud<'_, T, D>,
        cell: usize,
        conserve: bool,
        value: &dyn Fn(usize) -> Q,
        sink: &mut dyn FnMut(&Point<T, D>, Q),
    ) -> bool {
        reconstruction.integrate_single(cloud, cell, conserve, value, sink)
    }
}

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
    /// As many numbers as [`FourCells::KEPT`], or none: nothing can be kept then.
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
