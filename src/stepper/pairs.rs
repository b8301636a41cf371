//! Sums over the points of a cell for each pair of its DOFs.

use super::matrix::MassMatrix;
use crate::grid::Cell;
use crate::scalar::Scalar;

/// Most DOFs that a particle sees with the bases of this crate: four along each axis in three dimensions.
/// Others may be told of more, in the first step.
const MOST_SEEN: usize = 64;

/// What the particles, or the quadrature points, of one cell add to a mass matrix. All see the same DOFs in
/// the same order.
#[derive(Clone, Debug)]
pub(super) struct Pairs<T, const D: usize> {
    cell: Option<Cell<D>>,
    dofs: Vec<u32>,
    /// Values of the functions at the point at hand.
    values: Vec<T>,
    /// Of the lower half, row after row.
    sums: Vec<T>,
}

impl<T: Scalar, const D: usize> Pairs<T, D> {
    /// Allocates if they will be `used`.
    pub(super) fn new(used: bool) -> Self {
        let most = if used { MOST_SEEN } else { 0 };
        Self {
            cell: None,
            dofs: Vec::with_capacity(most),
            values: Vec::with_capacity(most),
            sums: Vec::with_capacity(most * (most + 1) / 2),
        }
    }

    /// Bytes allocated.
    pub(super) fn bytes(&self) -> usize {
        size_of::<u32>() * self.dofs.capacity()
            + size_of::<T>() * (self.values.capacity() + self.sums.capacity())
    }

    /// The next point is one of `cell`.
    #[inline(always)]
    pub(super) fn turn_to(&mut self, cell: &Cell<D>, matrix: &mut MassMatrix<T, D>) {
        if self.cell != Some(*cell) {
            self.flush(matrix);
            self.cell = Some(*cell);
            self.dofs.clear();
        }
        self.values.clear();
    }

    /// The point sees a DOF.
    #[inline(always)]
    pub(super) fn see(&mut self, dof: usize, phi: T) {
        if self.dofs.len() == self.values.len() {
            self.dofs.push(dof as u32);
        }
        self.values.push(phi);
    }

    /// The point has seen all its DOFs and has this mass.
    #[inline(always)]
    pub(super) fn add(&mut self, mass: T) {
        let count = self.values.len();
        self.sums.resize(count * (count + 1) / 2, T::zero());
        let mut rest = &mut self.sums[..];
        for (i, &phi) in self.values.iter().enumerate() {
            let (row, below) = rest.split_at_mut(i + 1);
            let m = mass * phi;
            for (sum, &other) in row.iter_mut().zip(&self.values) {
                *sum += m * other;
            }
            rest = below;
        }
    }

    /// Hands the sums to the matrix.
    pub(super) fn flush(&mut self, matrix: &mut MassMatrix<T, D>) {
        self.cell = None;
        let mut sums = self.sums.iter();
        for (a, &i) in self.dofs.iter().enumerate() {
            for (b, (&j, &sum)) in self.dofs[..=a].iter().zip(&mut sums).enumerate() {
                // A DOF that is named twice meets itself in both orders.
                let sum = if i == j && a != b { sum + sum } else { sum };
                matrix.add(i.max(j) as usize, i.min(j) as usize, sum);
            }
        }
        self.sums.clear();
    }
}
