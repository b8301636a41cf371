//! Sums of four cells that follow each other along axis 0.
//!
//! They share DOFs: added up, row by row, before they are handed over, each DOF is read and written once, and
//! no cell waits for the one before.

use super::Sweep;
use super::pairs::{PairSums, pair};
use super::sums::{Sum, Sums};
use crate::basis::{BasisFamily, MOST_WIDTH};
use crate::grid::Cell;
use crate::scalar::Scalar;
use crate::simd::{LANES, Packs};

/// Most DOFs of four cells.
const MOST: usize = LANES - 1 + MOST_WIDTH;

/// Sums at the DOFs of four cells, of one function of each cell after another.
#[derive(Clone, Copy)]
struct Line<T>([T; MOST]);

impl<T: Scalar> Line<T> {
    #[inline(always)]
    fn new() -> Self {
        Self([T::zero(); MOST])
    }

    /// Adds what each cell has for its DOF number `function`.
    #[inline(always)]
    fn add(&mut self, function: usize, cells: [T; LANES]) {
        for l in 0..LANES {
            self.0[function + l] += cells[l];
        }
    }
}

impl<V: Copy, const D: usize, const S: usize, const C: usize, const G: usize> Sums<V, D, S, C, G> {
    /// Hands `sink(dof, sum)` the sums of the cell in each lane, the first of which is `cell`, and starts
    /// again.
    #[inline(always)]
    pub(super) fn scatter_line<T: Scalar, B: BasisFamily<T, D>, K: Packs<T, V = V>>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        cell: &Cell<D>,
        sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>),
    ) {
        let zero = k.splat(T::zero());
        let first = sweep.first_dof(cell);
        for row in 0..Sweep::<T, D, B>::ROWS {
            let mut scalars = [Line::new(); S];
            let mut vectors = [[Line::new(); D]; C];
            let mut forces = [[Line::new(); D]; G];
            for i in 0..B::WIDTH {
                let place = row * B::WIDTH + i;
                for q in 0..S {
                    scalars[q].add(i, k.array(self.scalars[place][q]));
                }
                for c in 0..D {
                    for q in 0..C {
                        vectors[q][c].add(i, k.array(self.vectors[place][q][c]));
                    }
                    for q in 0..G {
                        forces[q][c].add(i, k.array(self.forces[place][q][c]));
                    }
                }
                self.scalars[place] = [zero; S];
                self.vectors[place] = [[zero; D]; C];
                self.forces[place] = [[zero; D]; G];
            }
            let (offset, _) = sweep.row(row);
            for n in 0..LANES - 1 + B::WIDTH {
                let mut sum = Sum::zero();
                for q in 0..S {
                    sum.scalars[q] = scalars[q].0[n];
                }
                for c in 0..D {
                    for q in 0..C {
                        sum.vectors[q][c] = vectors[q][c].0[n];
                    }
                    for q in 0..G {
                        sum.forces[q][c] = forces[q][c].0[n];
                    }
                }
                sink(first + offset + n, sum);
            }
        }
    }
}

impl<V: Copy, const D: usize> PairSums<V, D> {
    /// The same of pairs: `matrix(i, j, sum)`, `j <= i`.
    #[inline(always)]
    pub(super) fn scatter_line<T: Scalar, B: BasisFamily<T, D>, K: Packs<T, V = V>>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        cell: &Cell<D>,
        matrix: &mut impl FnMut(usize, usize, T),
    ) {
        let first = sweep.first_dof(cell);
        for beside in 0..B::WIDTH {
            let mut line = Line::new();
            for i in beside..B::WIDTH {
                let sum = &mut self.sums[pair(i, i - beside)];
                line.add(i, k.array(*sum));
                *sum = k.splat(T::zero());
            }
            for n in beside..LANES - 1 + B::WIDTH {
                matrix(first + n, first + n - beside, line.0[n]);
            }
        }
    }
}
