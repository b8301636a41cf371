//! Sums over the particles of single cells along one axis, four particles at a time.
//!
//! Where the particles of a cell follow each other in memory, four of them are one load. With one particle of
//! each of four cells in the lanes instead, every number has to be gathered.

use std::ops::Range;

use super::cell_group::WantedSums;
use crate::field::Field;
use crate::grid::Cell;
use crate::particles::Bins;
use crate::reconstruction::values::{four_components, four_numbers};
use crate::reconstruction::{Cloud, Values};
use crate::scalar::Scalar;
use crate::simd::{LANES, Packs, each, in_lanes};
use crate::taylor::{BatchSums, taylor_lanes};

/// Particles that follow each other.
#[derive(Clone, Copy)]
pub(super) struct Run {
    first: usize,
    end: usize,
}

impl Run {
    /// The particles of each of four cells, if they follow each other and can be read four by four among all
    /// `count` that there are.
    #[inline(always)]
    pub(super) fn all<const D: usize>(
        bins: &Bins<D>,
        cells: &[usize; LANES],
        count: usize,
    ) -> Option<[Self; LANES]> {
        let run = |cell: usize| {
            let Range { start, end } = bins.run_in(cell)?;
            let can_be_read = start + (end - start).next_multiple_of(LANES) <= count;
            can_be_read.then_some(Self { first: start, end })
        };
        Some([run(cells[0])?, run(cells[1])?, run(cells[2])?, run(cells[3])?])
    }

    /// Sums over the particles, which are those of `cell`, in parts that are spread over the lanes. Not
    /// inlined: among all that is done with them, a compiler would keep none of them in registers.
    #[inline(always)]
    fn sums<
        S: WantedSums,
        T: Scalar,
        K: Packs<T>,
        Q: Field<T>,
        const D: usize,
        const NB: usize,
        const C: usize,
    >(
        self,
        k: K,
        cloud: &Cloud<'_, T, D>,
        cell: &Cell<D>,
        values: &impl Values<T, Q>,
        amounts: &[T],
    ) -> BatchSums<K::V, NB, C> {
        let mut sums = BatchSums::new(k);
        let mut first = self.first;
        // Full fours have a loop of their own, in which a compiler knows that the ones are ones.
        while first + LANES <= self.end {
            let ones = k.splat(T::one());
            add_four::<S, T, K, Q, D, NB, C>(k, &mut sums, cloud, cell, (first, ones), values, amounts);
            first += LANES;
        }
        if first < self.end {
            let ones = first_ones(k, self.end - first);
            add_four::<S, T, K, Q, D, NB, C>(k, &mut sums, cloud, cell, (first, ones), values, amounts);
        }
        sums
    }
}

/// Adds four particles, the first of which has the number `first`; `ones` are zero for those that do not
/// count.
#[inline(always)]
fn add_four<
    S: WantedSums,
    T: Scalar,
    K: Packs<T>,
    Q: Field<T>,
    const D: usize,
    const NB: usize,
    const C: usize,
>(
    k: K,
    sums: &mut BatchSums<K::V, NB, C>,
    cloud: &Cloud<'_, T, D>,
    cell: &Cell<D>,
    (first, ones): (usize, K::V),
    values: &impl Values<T, Q>,
    amounts: &[T],
) {
    let psi = taylor_lanes::<T, K, D, NB>(k, &frame(k, cloud, cell, first));
    let (mut weight, mut alone) = (ones, ones);
    if S::WEIGHTED || S::CONSERVED {
        alone = four_numbers::<T, K>(k, amounts, first) * ones;
    }
    if S::WEIGHTED {
        weight = alone;
    }
    if S::PRODUCTS {
        // Without weights the first product is the number of particles.
        sums.add_products(&psi, weight, usize::from(!S::WEIGHTED));
    }
    if S::VALUES {
        let field = values.four::<K, C>(k, first);
        sums.add_values(&psi, weight, alone, &field, Q::COMPONENTS);
    }
}

/// One in so many lanes, zero in the others.
#[inline(always)]
fn first_ones<T: Scalar, K: Packs<T>>(k: K, count: usize) -> K::V {
    let (zero, one) = (T::zero(), T::one());
    match count {
        1 => k.pack([one, zero, zero, zero]),
        2 => k.pack([one, one, zero, zero]),
        3 => k.pack([one, one, one, zero]),
        _ => k.splat(one),
    }
}

/// Local coordinates of four particles of a cell.
#[inline(always)]
fn frame<T: Scalar, K: Packs<T>, const D: usize>(
    k: K,
    cloud: &Cloud<'_, T, D>,
    cell: &Cell<D>,
    first: usize,
) -> [K::V; D] {
    let (two, one) = (k.splat(T::lit(2.0)), k.splat(T::one()));
    each(
        #[inline(always)]
        |a| {
            let x = four_components::<T, K, D>(k, cloud.positions, first, a) - k.splat(cloud.grid.min()[a]);
            let index = k.splat(T::lit(f64::from(cell[a])));
            (x * k.splat(cloud.grid.inverse_cell_size()[a]) - index) * two - one
        },
    )
}

/// The sums of four cells, a cell in each lane.
#[inline(always)]
pub(super) fn sums_of_runs<
    S: WantedSums,
    T: Scalar,
    K: Packs<T>,
    Q: Field<T>,
    const D: usize,
    const NB: usize,
    const C: usize,
>(
    k: K,
    cloud: &Cloud<'_, T, D>,
    runs: &[Run; LANES],
    cells: &[Cell<D>; LANES],
    values: &impl Values<T, Q>,
    amounts: &[T],
) -> BatchSums<K::V, NB, C> {
    let mut of_runs = [BatchSums::new(k); LANES];
    for l in 0..LANES {
        of_runs[l] = runs[l].sums::<S, T, K, Q, D, NB, C>(k, cloud, &cells[l], values, amounts);
    }
    let [a, b, c, d] = &of_runs;
    let mut sums = BatchSums::new(k);
    for i in 0..NB {
        if S::PRODUCTS {
            for j in 0..i + 1 {
                if i == 0 && !S::WEIGHTED {
                    continue;
                }
                let parts = [a.gram[i][j], b.gram[i][j], c.gram[i][j], d.gram[i][j]];
                sums.gram[i][j] = k.pack(k.sums(parts));
            }
        }
        if S::VALUES {
            for q in 0..Q::COMPONENTS {
                let parts = [a.right[i][q], b.right[i][q], c.right[i][q], d.right[i][q]];
                sums.right[i][q] = k.pack(k.sums(parts));
            }
        }
    }
    if !S::WEIGHTED {
        // A conversion from 64 bits takes five times as long.
        sums.gram[0][0] = k.pack(in_lanes(
            #[inline(always)]
            |l| T::lit(f64::from((runs[l].end - runs[l].first) as u32)),
        ));
    }
    sums
}
