//! Sums over points of products of two functions, kept in lanes: what a cell adds to a mass matrix.
//!
//! Functions are products along the axes, and so are products of two of them: of the 45 pairs that the nine
//! functions of a quadratic cell in the plane make, only 36 = 6 x 6 sums differ, of the 378 in space 216.

use nalgebra::SVector;

use super::group::{EachGroup, Group, come_in_eights, each_group};
use super::{Sites, Sweep};
use crate::basis::{BasisFamily, Factors, MOST_WIDTH};
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;
use crate::simd::{LANES, Lanes, Number, Packs, dispatch_for, each};

/// Most pairs of functions along an axis.
const ALONG: usize = MOST_WIDTH * (MOST_WIDTH + 1) / 2;
/// Most products of those, in three dimensions.
const MOST: usize = ALONG * ALONG * ALONG;

/// Number of the pair of the functions `a` and `b` of an axis.
pub(super) const fn pair(a: usize, b: usize) -> usize {
    let (high, low) = if a > b { (a, b) } else { (b, a) };
    high * (high + 1) / 2 + low
}

/// Hands `matrix(i, j, mass)`, `j <= i`, what particles add to the entries of the consistent mass matrix.
/// Only for bases that are products on grids wide enough ([`sums_apply`]).
#[inline(always)]
pub(crate) fn sum_pairs<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    sites: Sites<'_, T, D>,
    masses: &[T],
    matrix: &mut impl FnMut(usize, usize, T),
) {
    let (sweep, cells) = (Sweep::new(basis, grid), sites.cells);
    dispatch_for!(T, come_in_eights(cells), |k| {
        let mut pass = PairsOfMasses {
            k,
            sweep: &sweep,
            positions: &sites.positions[..cells.len()],
            half_lengths: sites.domains.half_lengths,
            cells,
            masses: &masses[..cells.len()],
            sums: PairSums::<_, D>::new::<T, _>(k),
            matrix,
        };
        each_group(cells, &mut pass);
        pass.sums.flush(k, &sweep, pass.matrix);
    });
}

/// Whether [`sum_pairs`] can be used.
pub(crate) fn sums_apply<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
) -> bool {
    Sweep::new(basis, grid).is_in_packs()
}

/// The sweep over masses that go to the consistent matrix.
struct PairsOfMasses<'a, T, K, V, const D: usize, B, M> {
    k: K,
    sweep: &'a Sweep<'a, T, D, B>,
    positions: &'a [SVector<T, D>],
    half_lengths: &'a [SVector<T, D>],
    cells: &'a [Cell<D>],
    masses: &'a [T],
    sums: PairSums<V, D>,
    matrix: &'a mut M,
}

impl<T, K, const D: usize, const N: usize, B, M> EachGroup<N> for PairsOfMasses<'_, T, K, K::V, D, B, M>
where
    T: Scalar,
    K: Packs<T, N>,
    B: BasisFamily<T, D>,
    M: FnMut(usize, usize, T),
{
    #[inline(always)]
    fn take<const FULL: bool>(&mut self, group: Group<N>) {
        let (k, sweep) = (self.k, self.sweep);
        let cell = &self.cells[group.first];
        let x = group.vectors::<FULL, T, K, D>(k, self.positions);
        let factors = sweep.factors::<FULL, K, N>(k, group, (cell, &x), self.half_lengths);
        let mass = group.amounts::<FULL, T, K>(k, self.masses);
        self.sums.add(k, sweep, cell, &factors, mass, self.matrix);
    }
}

/// One sum for each product of pairs along the axes, axis 0 fastest.
#[derive(Clone, Copy)]
pub(super) struct PairSums<V, const D: usize> {
    cell: Option<Cell<D>>,
    pub(super) sums: [V; MOST],
}

impl<V: Copy, const D: usize> PairSums<V, D> {
    #[inline(always)]
    pub(super) fn new<T: Scalar, K: Lanes<T, V = V>>(k: K) -> Self {
        Self {
            cell: None,
            sums: [k.splat(T::zero()); MOST],
        }
    }

    /// Adds points with the given functions and masses.
    #[inline(always)]
    pub(super) fn add_to<T: Scalar, B: BasisFamily<T, D>>(&mut self, factors: &Factors<V, D>, mass: V)
    where
        V: Number<T>,
    {
        let count = Sweep::<T, D, B>::PAIRS_ALONG;
        let mut products = [[mass; ALONG]; D];
        for axis in 0..D {
            let value = &factors.value[axis];
            for a in 0..B::WIDTH {
                for b in 0..=a {
                    products[axis][pair(a, b)] = value[a] * value[b];
                }
            }
        }
        let (second, third) = (
            if const { D > 1 } { count } else { 1 },
            if D > 2 { count } else { 1 },
        );
        let mut first = 0;
        for c in 0..third {
            for b in 0..second {
                let mut across = mass;
                if const { D > 1 } {
                    across = across * products[1][b];
                }
                if const { D > 2 } {
                    across = across * products[D - 1][c];
                }
                for a in 0..count {
                    let sum = &mut self.sums[first + a];
                    *sum = across.mul_add(products[0][a], *sum);
                }
                first += count;
            }
        }
    }

    /// The same for points of `cell`, one after another; `matrix(i, j, sum)`, `j <= i`, takes what the cell
    /// before them adds.
    #[inline(always)]
    pub(super) fn add<T: Scalar, B: BasisFamily<T, D>, K: Packs<T, N, V = V>, const N: usize>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        cell: &Cell<D>,
        factors: &Factors<V, D>,
        mass: V,
        matrix: &mut impl FnMut(usize, usize, T),
    ) where
        V: Number<T>,
    {
        if self.cell != Some(*cell) {
            self.flush(k, sweep, matrix);
            self.cell = Some(*cell);
        }
        self.add_to::<T, B>(factors, mass);
    }

    /// Hands the sums of the last cell over and starts again.
    #[inline(always)]
    pub(super) fn flush<T: Scalar, B: BasisFamily<T, D>, K: Packs<T, N, V = V>, const N: usize>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        matrix: &mut impl FnMut(usize, usize, T),
    ) {
        let Some(cell) = self.cell.take() else { return };
        let zero = k.splat(T::zero());
        let mut totals = [T::zero(); MOST];
        let count = Sweep::<T, D, B>::PAIRS_ALONG.pow(D as u32);
        for first in (0..count).step_by(LANES) {
            let sums = k.sums(each(
                #[inline(always)]
                |n| self.sums[first + n],
            ));
            totals[first..first + LANES].copy_from_slice(&sums);
        }
        self.sums[..count].fill(zero);
        let first = sweep.first_dof(&cell);
        sweep.for_each_pair(
            #[inline(always)]
            |i, j, number| matrix(first + i, first + j, totals[number]),
        );
    }

    /// Where the lanes are those of four cells: hands over the sums of each cell that is not `left_out` and
    /// starts again.
    #[inline(always)]
    pub(super) fn spread<T: Scalar, B: BasisFamily<T, D>, K: Packs<T, V = V>>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        cells: &[Cell<D>],
        left_out: &[bool; LANES],
        matrix: &mut impl FnMut(usize, usize, T),
    ) {
        let count = Sweep::<T, D, B>::PAIRS_ALONG.pow(D as u32);
        let mut first = [0; LANES];
        for (first, cell) in first.iter_mut().zip(cells) {
            *first = sweep.first_dof(cell);
        }
        sweep.for_each_pair(
            #[inline(always)]
            |i, j, number| {
                let sums = k.array(self.sums[number]);
                for l in 0..cells.len().min(LANES) {
                    if !left_out[l] {
                        matrix(first[l] + i, first[l] + j, sums[l]);
                    }
                }
            },
        );
        self.sums[..count].fill(k.splat(T::zero()));
    }
}

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>> Sweep<'_, T, D, B> {
    /// Pairs of functions along an axis.
    const PAIRS_ALONG: usize = B::WIDTH * (B::WIDTH + 1) / 2;

    /// Calls `f(i, j, number)` for each pair `j <= i` of a cell's DOFs, counted from the cell's first one,
    /// with the number of its sum.
    #[inline(always)]
    fn for_each_pair(&self, mut f: impl FnMut(usize, usize, usize)) {
        for row in 0..Self::ROWS {
            let (start, k) = self.row(row);
            for other in 0..=row {
                let (other_start, l) = self.row(other);
                let mut across = 0;
                if const { D > 2 } {
                    across = pair(k[1], l[1]) * Self::PAIRS_ALONG;
                }
                if const { D > 1 } {
                    across = (across + pair(k[0], l[0])) * Self::PAIRS_ALONG;
                }
                for a in 0..B::WIDTH {
                    let most = if other == row { a + 1 } else { B::WIDTH };
                    for b in 0..most {
                        f(start + a, other_start + b, across + pair(a, b));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{BSpline, Linear};
    use crate::mass::Lattice;
    use crate::particles::Domains;
    use crate::simd::{Four, Plain};

    /// Points that wander through a grid of three cells an axis, some cells of which get none and some many.
    fn check<const D: usize, B: BasisFamily<f64, D>>(basis: &B) {
        let grid = Grid::new(SVector::zeros(), SVector::repeat(3.0), [3; D]).unwrap();
        let place = |p: usize, a: usize| 3.0 * ((p * p + 7 * a * p + a) % 101) as f64 / 101.0;
        let positions: Vec<SVector<f64, D>> = (0..60).map(|p| SVector::from_fn(|a, _| place(p, a))).collect();
        let cells: Vec<Cell<D>> = positions.iter().map(|x| grid.locate(x).unwrap()).collect();
        let masses: Vec<f64> = (0..60).map(|p| 1.0 + (p % 7) as f64).collect();
        let zeros = || Lattice::zeros(basis.dofs(&grid), basis.reach());
        let (mut found, mut expected) = (zeros(), zeros());
        assert!(sums_apply(basis, &grid));
        let none = Domains::none();
        let sites = Sites {
            positions: &positions,
            cells: &cells,
            domains: none.views(),
        };
        sum_pairs(basis, &grid, sites, &masses, &mut |i, j, mass| {
            found.add(i, j, mass)
        });
        for ((x, cell), &mass) in positions.iter().zip(&cells).zip(&masses) {
            basis.for_each(&grid, cell, x, |i, a, _| {
                basis.for_each(&grid, cell, x, |j, b, _| {
                    if j <= i {
                        expected.add(i, j, mass * a * b);
                    }
                });
            });
        }
        let n = found.order();
        let (mut product, mut right) = (vec![0.0; n], vec![0.0; n]);
        let x: Vec<f64> = (0..n).map(|i| (i * i % 13) as f64 - 5.0).collect();
        found.multiply(&x, &mut product);
        expected.multiply(&x, &mut right);
        for (a, b) in product.iter().zip(&right) {
            assert!((a - b).abs() < 1e-11, "{a} {b}");
        }
    }

    #[test]
    fn they_are_the_sums_of_all_pairs_of_functions() {
        check::<1, _>(&Linear);
        check::<1, _>(&BSpline::<3>);
        check::<2, _>(&Linear);
        check::<2, _>(&BSpline::<2>);
        check::<3, _>(&BSpline::<2>);
        check::<3, _>(&BSpline::<3>);
    }

    #[test]
    fn four_cells_get_their_own_and_one_that_is_left_out_nothing() {
        let grid = Grid::new(SVector::from([0.0]), SVector::from([5.0]), [5]).unwrap();
        let (basis, cells) = (Linear, [[0], [1], [2], [3]]);
        let sweep = Sweep::new(&basis, &grid);
        let mut sums = PairSums::<Four<f64>, 1>::new::<f64, _>(Plain);
        let half = Four([0.5; 4]);
        let factors = Factors {
            value: [[half, half, half, half]],
            slope: [[half; MOST_WIDTH]],
        };
        sums.add_to::<f64, Linear>(&factors, Four([4.0, 8.0, 12.0, 16.0]));
        let mut entries: Vec<(usize, usize, f64)> = Vec::new();
        sums.spread(
            Plain,
            &sweep,
            &cells,
            &[false, true, false, false],
            &mut |i, j, sum| {
                entries.push((i, j, sum));
            },
        );
        entries.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
        let expected = [
            (0, 0, 1.0),
            (1, 0, 1.0),
            (1, 1, 1.0),
            (2, 2, 3.0),
            (3, 2, 3.0),
            (3, 3, 3.0),
            (3, 3, 4.0),
            (4, 3, 4.0),
            (4, 4, 4.0),
        ];
        assert_eq!(entries, expected);
    }
}
