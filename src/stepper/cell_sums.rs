//! Sums at the DOFs of one cell, kept at hand while particles of that cell come one after the other.
//!
//! Adding every particle's part to the DOFs themselves would make each particle wait for the one before: they mostly share
//! DOFs, and an addition in memory takes twice as long as one in a register.

use nalgebra::SVector;
use num_traits::Zero;

use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;

/// DOFs that are kept at hand, enough for the cubic B-splines of a cell in three dimensions; any more are added directly.
const AT_HAND: usize = 64;

/// Sums of the DOFs of a cell, in the order in which the basis visits them: the same one for every point of the cell.
pub(super) struct CellSums<'a, T, const D: usize, B, Q> {
    basis: &'a B,
    grid: &'a Grid<T, D>,
    cell: Option<(&'a Cell<D>, &'a SVector<T, D>)>,
    sums: [Q; AT_HAND],
}

impl<'a, T: Scalar, const D: usize, B: BasisFamily<T, D>, Q: Copy + Zero> CellSums<'a, T, D, B, Q> {
    #[inline(always)]
    pub(super) fn new(basis: &'a B, grid: &'a Grid<T, D>) -> Self {
        Self {
            basis,
            grid,
            cell: None,
            sums: [Q::zero(); AT_HAND],
        }
    }

    /// Adds `part(phi, grad phi)` at every DOF that `x` in `cell` sees. `sink(dof, sum)` takes the sums of the cell before.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        cell: &'a Cell<D>,
        x: &'a SVector<T, D>,
        part: impl Fn(T, SVector<T, D>) -> Q,
        sink: &mut impl FnMut(usize, Q),
    ) {
        if self.cell.is_none_or(|(last, _)| last != cell) {
            self.flush(sink);
            self.cell = Some((cell, x));
        }
        let mut k = 0;
        let sums = &mut self.sums;
        self.basis.for_each(self.grid, cell, x, |dof, phi, gradient| {
            let part = part(phi, gradient);
            match sums.get_mut(k) {
                Some(sum) => *sum = *sum + part,
                None => sink(dof, part),
            }
            k += 1;
        });
    }

    /// Hands the sums over and starts again.
    #[inline(always)]
    pub(super) fn flush(&mut self, sink: &mut impl FnMut(usize, Q)) {
        let Some((cell, x)) = self.cell.take() else {
            return;
        };
        let mut k = 0;
        let sums = &mut self.sums;
        self.basis.for_each(self.grid, cell, x, |dof, _, _| {
            if let Some(sum) = sums.get_mut(k) {
                sink(dof, *sum);
                *sum = Q::zero();
            }
            k += 1;
        });
    }
}
