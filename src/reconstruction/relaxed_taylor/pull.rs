//! Moving particles towards polynomials.

use nalgebra::SVector;

use super::make_room;
use crate::field::Field;
use crate::grid::Cell;
use crate::lanes::{LANES, Lanes, with_lanes_of};
use crate::parallel::{PARTICLES, Sliced, each_span, worth_sharing};
use crate::reconstruction::Cloud;
use crate::scalar::Scalar;
use crate::taylor::{Rights, taylor_lanes};

/// For each occupied cell the polynomial and the share by which its particles are moved: `value += p(x) - share value`.
#[derive(Clone, Debug)]
pub(super) struct Pulls<T> {
    /// Coefficients in the frame of the whole cell, function by function.
    coefficients: Vec<T>,
    shares: Vec<T>,
}

impl<T: Scalar> Pulls<T> {
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
    pub(super) fn rows(&mut self, cells: usize, each: usize) -> PullRows<'_, T> {
        // Coefficients of cells that do not pull are not looked at.
        self.coefficients.resize(cells * each, T::zero());
        self.shares.clear();
        self.shares.resize(cells, T::zero());
        PullRows {
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
            with_lanes_of!(T, self.move_in[_, D, NB](cloud, values, positions, cells));
        });
    }

    #[inline(never)]
    fn move_in<V: Lanes<T>, Q: Field<T>, const D: usize, const NB: usize>(
        &self,
        cloud: &Cloud<'_, T, D>,
        values: &mut [Q],
        positions: &[SVector<T, D>],
        cells: &[Cell<D>],
    ) {
        let (mut near, mut last) = (0, None);
        let mut first = 0;
        while let Some(cell) = cells.get(first) {
            let all = &cells[first..cells.len().min(first + LANES)];
            let count = match all.first_chunk::<LANES>() {
                Some(four) if four.iter().all(|other| other == cell) => LANES,
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
                        self.move_four::<V, Q, D, NB>(near, &frame(cloud, cell, x), values);
                    }
                    _ => self.move_few::<V, Q, D, NB>(near, &frame(cloud, cell, &repeated(x)), values),
                }
            }
            first += count;
        }
    }

    /// Moves less than four.
    #[inline(never)]
    fn move_few<V: Lanes<T>, Q: Field<T>, const D: usize, const NB: usize>(
        &self,
        place: usize,
        s: &[V; D],
        values: &mut [Q],
    ) {
        let mut four = repeated(values);
        self.move_four::<V, Q, D, NB>(place, s, &mut four);
        for (value, new) in values.iter_mut().zip(four) {
            *value = new;
        }
    }

    #[inline(always)]
    fn move_four<V: Lanes<T>, Q: Field<T>, const D: usize, const NB: usize>(
        &self,
        place: usize,
        s: &[V; D],
        values: &mut [Q; LANES],
    ) {
        let psi = taylor_lanes::<T, V, D, NB>(s);
        let each = NB * Q::COMPONENTS;
        let coefficients = &self.coefficients[place * each..(place + 1) * each];
        let (zero, share) = (V::splat(T::zero()), V::splat(self.shares[place]));
        for q in 0..Q::COMPONENTS {
            let old = V::new(std::array::from_fn(|l| values[l].component(q)));
            // Only the change is rounded where the polynomial sees the value.
            let mut change = zero - old * share;
            for k in (0..NB).rev() {
                change = psi[k].mul_add(V::splat(coefficients[k * Q::COMPONENTS + q]), change);
            }
            let new = (old + change).array();
            for l in 0..LANES {
                values[l].set_component(q, new[l]);
            }
        }
    }
}

/// Four of them, the last one again where there are fewer.
#[inline(always)]
fn repeated<A: Copy>(values: &[A]) -> [A; LANES] {
    std::array::from_fn(|l| values[l.min(values.len() - 1)])
}

/// Local coordinates of four points of a cell.
#[inline(always)]
fn frame<T: Scalar, V: Lanes<T>, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    cell: &Cell<D>,
    x: &[SVector<T, D>; LANES],
) -> [V; D] {
    let (two, one) = (V::splat(T::lit(2.0)), V::splat(T::one()));
    std::array::from_fn(|a| {
        let x = V::new(std::array::from_fn(|l| x[l][a])) - V::splat(cloud.grid.min()[a]);
        let index = V::splat(T::lit(f64::from(cell[a])));
        (x * V::splat(cloud.grid.inverse_cell_size()[a]) - index) * two - one
    })
}

/// What is kept of some cells, to be filled.
pub(super) struct PullRows<'a, T> {
    coefficients: &'a mut [T],
    shares: &'a mut [T],
    /// Coefficients of a cell.
    each: usize,
}

impl<T: Send> Sliced for PullRows<'_, T> {
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

impl<'a, T> PullRows<'a, T> {
    /// Coefficients and shares of four cells after four.
    pub(super) fn groups(self) -> impl Iterator<Item = (&'a mut [T], &'a mut [T])> {
        let coefficients = self.coefficients.chunks_mut(LANES * self.each);
        coefficients.zip(self.shares.chunks_mut(LANES))
    }
}

/// Puts the coefficients of four cells, `shares` of which are positive, where they are kept.
#[inline(always)]
pub(super) fn keep_pulls<T: Scalar, V: Lanes<T>, const NB: usize, const C: usize>(
    rights: &Rights<V, NB, C>,
    components: usize,
    shares: [T; LANES],
    (coefficients, kept_shares): (&mut [T], &mut [T]),
) {
    let each = NB * components;
    let cells = coefficients.chunks_exact_mut(each).zip(kept_shares);
    for (l, (cell, share)) in cells.enumerate().take(LANES) {
        *share = shares[l];
        if shares[l] > T::zero() {
            for k in 0..NB {
                for q in 0..components {
                    cell[k * components + q] = rights[k][q].array()[l];
                }
            }
        }
    }
}
