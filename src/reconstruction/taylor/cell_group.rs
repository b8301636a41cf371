//! Four cells whose fits are made at once, one in each lane.

use std::ops::Range;

use super::runs::{Run, sums_of_runs};
use crate::field::Field;
use crate::grid::Cell;
use crate::reconstruction::{Cloud, Values, batch_of_cells};
use crate::scalar::Scalar;
use crate::simd::{LANES, Number, Packs, each, in_lanes};
use crate::taylor::{BatchSums, taylor_lanes};

/// Up to four occupied cells with their particles; spare lanes repeat the last cell.
pub(in super::super) struct CellGroup<const D: usize> {
    pub(in super::super) len: usize,
    pub(in super::super) cells: [Cell<D>; LANES],
    numbers: [usize; LANES],
    pub(in super::super) counts: [usize; LANES],
}

/// What is summed over particles.
pub(in super::super) trait WantedSums {
    /// Products of two functions.
    const PRODUCTS: bool = true;
    /// Functions times the components of a field.
    const VALUES: bool = true;
    /// Whether all is weighted with the particles' amounts.
    const WEIGHTED: bool = false;
    /// Whether the components alone are, which is their product with the first function.
    const CONSERVED: bool = false;
}

/// Sums of a free fit.
pub(in super::super) struct Free;

impl WantedSums for Free {}

/// Sums of a fit that keeps the integrals of densities, given the volumes.
pub(in super::super) struct Conserved;

impl WantedSums for Conserved {
    const CONSERVED: bool = true;
}

/// What a field of densities adds to that, given the products.
pub(in super::super) struct ConservedValues;

impl WantedSums for ConservedValues {
    const PRODUCTS: bool = false;
    const CONSERVED: bool = true;
}

/// Sums of a weighted fit.
pub(in super::super) struct Weighted;

impl WantedSums for Weighted {
    const WEIGHTED: bool = true;
}

/// What a fit is made of before there is a field.
pub(in super::super) struct Products;

impl WantedSums for Products {
    const VALUES: bool = false;
}

/// What a field adds to that.
pub(in super::super) struct OfValues;

impl WantedSums for OfValues {
    const PRODUCTS: bool = false;
}

impl<const D: usize> CellGroup<D> {
    #[inline(always)]
    pub(in super::super) fn new<T: Scalar>(cloud: &Cloud<'_, T, D>, places: Range<usize>) -> Self {
        let len = places.len();
        let cells = batch_of_cells(cloud, places);
        Self {
            len,
            cells: cells.map(|(_, cell)| cell),
            counts: cells.map(|(number, _)| cloud.bins.count_in(number)),
            numbers: cells.map(|(number, _)| number),
        }
    }

    /// Most particles of a cell.
    fn longest(&self) -> usize {
        self.counts.iter().copied().max().unwrap_or(0)
    }

    /// Sums over the particles of each cell, which are those at `places`.
    #[inline(always)]
    pub(in super::super) fn sums<
        S: WantedSums,
        T: Scalar,
        K: Packs<T>,
        Q: Field<T>,
        const NB: usize,
        const C: usize,
    >(
        &self,
        k: K,
        cloud: &Cloud<'_, T, D>,
        places: Range<usize>,
        values: &impl Values<T, Q>,
        amounts: &[T],
    ) -> BatchSums<K::V, NB, C> {
        if const { D > 1 } {
            return self.sums_one_by_one::<S, T, K, Q, NB, C>(k, cloud, values, amounts);
        }
        match Run::all(cloud.bins, &self.numbers, cloud.positions.len()) {
            Some(runs) => sums_of_runs::<S, T, K, Q, D, NB, C>(k, cloud, &runs, &self.cells, values, amounts),
            None => Self::sums_apart::<S, T, K, Q, NB, C>(k, cloud, places, values, amounts),
        }
    }

    /// [`CellGroup::sums_one_by_one`], out of the way of the code that usually runs.
    #[inline(never)]
    fn sums_apart<S: WantedSums, T: Scalar, K: Packs<T>, Q: Field<T>, const NB: usize, const C: usize>(
        k: K,
        cloud: &Cloud<'_, T, D>,
        places: Range<usize>,
        values: &impl Values<T, Q>,
        amounts: &[T],
    ) -> BatchSums<K::V, NB, C> {
        k.run(
            #[inline(always)]
            || Self::new(cloud, places).sums_one_by_one::<S, T, K, Q, NB, C>(k, cloud, values, amounts),
        )
    }

    /// The same wherever the particles are, one of each cell at a time.
    #[inline(always)]
    fn sums_one_by_one<
        S: WantedSums,
        T: Scalar,
        K: Packs<T>,
        Q: Field<T>,
        const NB: usize,
        const C: usize,
    >(
        &self,
        k: K,
        cloud: &Cloud<'_, T, D>,
        values: &impl Values<T, Q>,
        amounts: &[T],
    ) -> BatchSums<K::V, NB, C> {
        let mut sums = BatchSums::new(k);
        let particles: [&[u32]; LANES] = each(
            #[inline(always)]
            |l| cloud.bins.particles_in(self.numbers[l]),
        );
        let frame = self.frame(k, cloud);
        let counts = k.pack(in_lanes(
            #[inline(always)]
            |l| T::lit(f64::from(self.counts[l] as u32)),
        ));
        let mut number = k.splat(T::zero());
        for n in 0..self.longest() {
            let numbers = self.particles(&particles, n);
            let mut weight = counts.above(number);
            number = number + k.splat(T::one());
            let psi = taylor_lanes::<T, K, D, NB>(k, &frame.local(k, cloud, &numbers));
            let mut first = weight;
            if S::WEIGHTED || S::CONSERVED {
                first = k.pack(in_lanes(
                    #[inline(always)]
                    |l| amounts[numbers[l]],
                )) * weight;
            }
            if S::WEIGHTED {
                weight = first;
            }
            if S::PRODUCTS {
                sums.add_products(&psi, weight, 0);
            }
            if S::VALUES {
                let values = values.lanes::<K, C>(k, &numbers);
                sums.add_values(&psi, weight, first, &values, Q::COMPONENTS);
            }
        }
        sums
    }

    /// The `n`-th particle of each cell; the last particle where there are fewer.
    #[inline(always)]
    fn particles(&self, particles: &[&[u32]; LANES], n: usize) -> [usize; LANES] {
        each(
            #[inline(always)]
            |l| particles[l][n.min(self.counts[l] - 1)] as usize,
        )
    }

    /// What local coordinates are made by.
    #[inline(always)]
    fn frame<T: Scalar, K: Packs<T>>(&self, k: K, cloud: &Cloud<'_, T, D>) -> Frame<K::V, D> {
        let two = T::lit(2.0);
        Frame {
            min: each(
                #[inline(always)]
                |a| k.splat(cloud.grid.min()[a]),
            ),
            inverse: each(
                #[inline(always)]
                |a| k.splat(two * cloud.grid.inverse_cell_size()[a]),
            ),
            middle: each(
                #[inline(always)]
                |a| {
                    k.pack(in_lanes(
                        #[inline(always)]
                        |l| two * T::lit(f64::from(self.cells[l][a])) + T::one(),
                    ))
                },
            ),
        }
    }
}

/// The grid's corner, one over half a cell, and the middles of four cells in halves of one.
struct Frame<V, const D: usize> {
    min: [V; D],
    inverse: [V; D],
    middle: [V; D],
}

impl<V: Copy, const D: usize> Frame<V, D> {
    /// Local coordinates of one particle of each cell.
    #[inline(always)]
    fn local<T: Scalar, K: Packs<T, V = V>>(
        &self,
        k: K,
        cloud: &Cloud<'_, T, D>,
        numbers: &[usize; LANES],
    ) -> [V; D]
    where
        V: Number<T>,
    {
        let x: [_; LANES] = each(
            #[inline(always)]
            |l| &cloud.positions[numbers[l]],
        );
        each(
            #[inline(always)]
            |a| {
                let x = k.pack(in_lanes(
                    #[inline(always)]
                    |l| x[l][a],
                ));
                (x - self.min[a]) * self.inverse[a] - self.middle[a]
            },
        )
    }
}
