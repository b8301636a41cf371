//! Moving particles towards polynomials.

use nalgebra::SVector;

use super::make_room;
use crate::field::Field;
use crate::grid::Cell;
use crate::parallel::{PARTICLES, Sliced, each_span, worth_sharing};
use crate::reconstruction::Cloud;
use crate::scalar::Scalar;
use crate::simd::{LANES, Number, Packs, dispatch, each, in_lanes};
use crate::taylor::{Rights, taylor_lanes};

/// For each occupied cell the polynomial and the share by which its particles are moved:
/// `value += p(x) - share value`.
#[derive(Clone, Debug)]
pub(super) struct Corrections<T> {
    /// Coefficients in the frame of the whole cell, function by function.
    coefficients: Vec<T>,
    shares: Vec<T>,
}

impl<T: Scalar> Corrections<T> {
    /// Of no cell.
    pub(super) fn none() -> Self {
        Self {
            coefficients: Vec::new(),
            shares: Vec::new(),
        }
    }

    /// Makes room for so many cells with so many coefficients each.
    pub(super) fn reserve(&mut self, cells: usize, each: usize) {
        make_room(&mut self.coefficients, cells * each);
        make_room(&mut self.shares, cells);
    }

    /// In place of the share of a cell that is left to be moved by itself.
    pub(super) fn left() -> T {
        -T::one()
    }

    /// Rows of so many cells, none of which pulls, four cells together.
    pub(super) fn rows(&mut self, cells: usize, each: usize) -> CorrectionRows<'_, T> {
        // Coefficients of cells that do not pull are not looked at.
        self.coefficients.resize(cells * each, T::zero());
        self.shares.clear();
        self.shares.resize(cells, T::zero());
        CorrectionRows {
            coefficients: &mut self.coefficients,
            shares: &mut self.shares,
            each,
        }
    }

    /// Whether a cell is left to be moved by itself.
    pub(super) fn is_left(&self, place: usize) -> bool {
        self.shares[place] < T::zero()
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<T>() * (self.coefficients.capacity() + self.shares.capacity())
    }

    /// Moves the `values` of all particles.
    pub(super) fn apply<Q: Field<T>, const D: usize, const NB: usize>(
        &self,
        cloud: &Cloud<'_, T, D>,
        values: &mut [Q],
    ) {
        let parallel = worth_sharing::<D>(values.len(), PARTICLES);
        let work = (values, cloud.positions, cloud.bins.cells());
        each_span(parallel, PARTICLES, work, &|_, (values, positions, cells)| {
            dispatch!(T, |k| self
                .move_in::<_, Q, D, NB>(k, cloud, values, positions, cells));
        });
    }

    #[inline(always)]
    fn move_in<K: Packs<T>, Q: Field<T>, const D: usize, const NB: usize>(
        &self,
        k: K,
        cloud: &Cloud<'_, T, D>,
        values: &mut [Q],
        positions: &[SVector<T, D>],
        cells: &[Cell<D>],
    ) {
        // A copy: a compiler then knows that what is written leaves it alone.
        let cloud = &{ *cloud };
        let (mut near, mut last) = (0, None);
        let mut first = 0;
        while let Some(cell) = cells.get(first) {
            let all = &cells[first..cells.len().min(first + LANES)];
            let count = match all.first_chunk::<LANES>() {
                Some(four) if four[1] == *cell && four[2] == *cell && four[3] == *cell => LANES,
                _ => all.iter().take_while(|&other| other == cell).count(),
            };
            if last != Some(cell) {
                // A particle's cell is occupied.
                near = cloud.bins.place_of(cloud.grid.linear(cell), near).unwrap_or(near);
                last = Some(cell);
            }
            if self.shares[near] > T::zero() {
                let (x, values) = (
                    &positions[first..first + count],
                    &mut values[first..first + count],
                );
                match (x.first_chunk(), values.first_chunk_mut()) {
                    (Some(x), Some(values)) => {
                        self.move_four::<K, Q, D, NB>(k, near, &frame(k, cloud, cell, x), values);
                    }
                    _ => self.move_few::<K, Q, D, NB>(k, near, &frame(k, cloud, cell, &repeated(x)), values),
                }
            }
            first += count;
        }
    }

    /// Moves less than four.
    #[inline(never)]
    fn move_few<K: Packs<T>, Q: Field<T>, const D: usize, const NB: usize>(
        &self,
        k: K,
        place: usize,
        s: &[K::V; D],
        values: &mut [Q],
    ) {
        let mut four = repeated(values);
        k.run(
            #[inline(always)]
            || self.move_four::<K, Q, D, NB>(k, place, s, &mut four),
        );
        for (value, new) in values.iter_mut().zip(four) {
            *value = new;
        }
    }

    #[inline(always)]
    fn move_four<K: Packs<T>, Q: Field<T>, const D: usize, const NB: usize>(
        &self,
        k: K,
        place: usize,
        s: &[K::V; D],
        values: &mut [Q; LANES],
    ) {
        let psi = taylor_lanes::<T, K, D, NB>(k, s);
        let count = NB * Q::COMPONENTS;
        let coefficients = &self.coefficients[place * count..(place + 1) * count];
        let (zero, share) = (k.splat(T::zero()), k.splat(self.shares[place]));
        for q in 0..Q::COMPONENTS {
            let old = k.pack(in_lanes(
                #[inline(always)]
                |l| values[l].component(q),
            ));
            // Only the change is rounded where the polynomial sees the value.
            let mut change = zero - old * share;
            for n in (0..NB).rev() {
                change = psi[n].mul_add(k.splat(coefficients[n * Q::COMPONENTS + q]), change);
            }
            let new = k.array(old + change);
            for l in 0..LANES {
                values[l].set_component(q, new[l]);
            }
        }
    }
}

/// Four of them, the last one again where there are fewer.
#[inline(always)]
fn repeated<A: Copy>(values: &[A]) -> [A; LANES] {
    each(
        #[inline(always)]
        |l| values[l.min(values.len() - 1)],
    )
}

/// Local coordinates of four points of a cell.
#[inline(always)]
fn frame<T: Scalar, K: Packs<T>, const D: usize>(
    k: K,
    cloud: &Cloud<'_, T, D>,
    cell: &Cell<D>,
    x: &[SVector<T, D>; LANES],
) -> [K::V; D] {
    let (two, one) = (k.splat(T::lit(2.0)), k.splat(T::one()));
    each(
        #[inline(always)]
        |a| {
            let x = k.pack(in_lanes(
                #[inline(always)]
                |l| x[l][a],
            ));
            let index = k.splat(T::lit(f64::from(cell[a])));
            let along = (x - k.splat(cloud.grid.min()[a])) * k.splat(cloud.grid.inverse_cell_size()[a]);
            (along - index) * two - one
        },
    )
}

/// What is kept of some cells, to be filled.
pub(super) struct CorrectionRows<'a, T> {
    coefficients: &'a mut [T],
    shares: &'a mut [T],
    /// Coefficients of a cell.
    each: usize,
}

impl<T: Send> Sliced for CorrectionRows<'_, T> {
    fn items(&self) -> usize {
        self.shares.len().div_ceil(LANES)
    }

    fn split(self, _spans: usize, items: usize) -> (Self, Self) {
        let (each, middle) = (self.each, self.shares.len().min(items * LANES));
        let (coefficients, other_coefficients) = self.coefficients.split_at_mut(middle * each);
        let (shares, other_shares) = self.shares.split_at_mut(middle);
        let part = |coefficients, shares| Self {
            coefficients,
            shares,
            each,
        };
        (part(coefficients, shares), part(other_coefficients, other_shares))
    }
}

impl<'a, T> CorrectionRows<'a, T> {
    /// Coefficients and shares of four cells after four.
    pub(super) fn groups(self) -> impl Iterator<Item = (&'a mut [T], &'a mut [T])> {
        let coefficients = self.coefficients.chunks_mut(LANES * self.each);
        coefficients.zip(self.shares.chunks_mut(LANES))
    }
}

/// Puts the coefficients of four cells, `shares` of which are positive, where they are kept.
#[inline(always)]
pub(super) fn keep_corrections<T: Scalar, K: Packs<T>, const NB: usize, const C: usize>(
    k: K,
    rights: &Rights<K::V, NB, C>,
    components: usize,
    shares: [T; LANES],
    (coefficients, kept_shares): (&mut [T], &mut [T]),
) {
    let each = NB * components;
    let cells = coefficients.chunks_exact_mut(each).zip(kept_shares);
    for (l, (cell, share)) in cells.enumerate().take(LANES) {
        *share = shares[l];
        if shares[l] > T::zero() {
            for n in 0..NB {
                for q in 0..components {
                    cell[n * components + q] = k.array(rights[n][q])[l];
                }
            }
        }
    }
}
