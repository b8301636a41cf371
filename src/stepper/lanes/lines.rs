//! Sums of four cells that follow each other along the only axis.
//!
//! They share DOFs: added up before they are handed over, each DOF is read and written once, and no cell waits for the one before.

use nalgebra::SVector;

use super::Pass;
use super::pairs::{PairSums, pair};
use super::sums::Sums;
use crate::basis::{BasisFamily, MOST_WIDTH};
use crate::grid::Cell;
use crate::lanes::{LANES, Lanes};
use crate::scalar::Scalar;

/// Most DOFs of four cells.
const MOST: usize = LANES - 1 + MOST_WIDTH;

/// Sums at the DOFs of four cells, of one function of each cell after another.
struct Line<T>([T; MOST]);

impl<T: Scalar> Line<T> {
    #[inline(always)]
    fn new() -> Self {
        Self([T::zero(); MOST])
    }

    /// Adds what each cell has for its DOF number `function`.
    #[inline(always)]
    fn add<V: Lanes<T>>(&mut self, function: usize, cells: V) {
        let cells = cells.array();
        for l in 0..LANES {
            self.0[function + l] += cells[l];
        }
    }
}

impl<V: Copy, const D: usize> Sums<V, D> {
    /// Hands `sink(dof, scalar, vector)` the sums of the cell in each lane, the first of which is `cell`, and starts again.
    #[inline(always)]
    pub(super) fn spread_line<T: Scalar, B: BasisFamily<T, D>>(
        &mut self,
        pass: &Pass<'_, T, D, B>,
        cell: &Cell<D>,
        sink: &mut impl FnMut(usize, T, SVector<T, D>),
    ) where
        V: Lanes<T>,
    {
        let zero = V::splat(T::zero());
        let (mut scalars, mut vectors) = (Line::new(), Line::new());
        for i in 0..B::WIDTH {
            scalars.add(i, self.scalar[i]);
            vectors.add(i, self.vector[i][0]);
            self.scalar[i] = zero;
            self.vector[i] = [zero; D];
        }
        let first = pass.first_dof(cell);
        for k in 0..LANES - 1 + B::WIDTH {
            sink(first + k, scalars.0[k], SVector::repeat(vectors.0[k]));
        }
    }
}

impl<V: Copy, const D: usize> PairSums<V, D> {
    /// The same of pairs: `matrix(i, j, sum)`, `j <= i`.
    #[inline(always)]
    pub(super) fn spread_line<T: Scalar, B: BasisFamily<T, D>>(
        &mut self,
        pass: &Pass<'_, T, D, B>,
        cell: &Cell<D>,
        matrix: &mut impl FnMut(usize, usize, T),
    ) where
        V: Lanes<T>,
    {
        let first = pass.first_dof(cell);
        for beside in 0..B::WIDTH {
            let mut line = Line::new();
            for i in beside..B::WIDTH {
                let sum = &mut self.sums[pair(i, i - beside)];
                line.add(i, *sum);
                *sum = V::splat(T::zero());
            }
            for k in beside..LANES - 1 + B::WIDTH {
                matrix(first + k, first + k - beside, line.0[k]);
            }
        }
    }
}
