//! The DOFs of a cell, row by row along axis 0.

use nalgebra::SVector;

use super::Sweep;
use crate::basis::{BasisFamily, Factors};
use crate::grid::Cell;
use crate::scalar::Scalar;
use crate::simd::{Lanes, Number};

/// The factors of one row: the value of the functions across it, and their slopes along the axes 1 and 2.
#[derive(Clone, Copy)]
pub(super) struct Across<V> {
    pub(super) value: V,
    pub(super) slope: [V; 2],
}

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>> Sweep<'_, T, D, B> {
    /// The first DOF of `cell`.
    #[inline(always)]
    pub(super) fn first_dof(&self, cell: &Cell<D>) -> usize {
        let first = self.basis.first_dofs(self.grid, cell);
        // Neighbours along axis 0 follow each other.
        let mut dof = first[0];
        for axis in 1..D {
            dof += first[axis] * self.strides[axis];
        }
        dof - self.before
    }

    /// Number of rows.
    pub(super) const ROWS: usize = B::WIDTH.pow(D as u32 - 1);

    /// Of a row the first DOF after the cell's first, and its place along the axes 1 and 2.
    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> (usize, [usize; 2]) {
        if const { D == 1 } {
            return (0, [0; 2]);
        }
        let (k1, k2) = (row % B::WIDTH, row / B::WIDTH);
        let deeper = if const { D == 3 } {
            k2 * self.strides[D - 1]
        } else {
            0
        };
        (deeper + k1 * self.strides[1], [k1, k2])
    }

    /// Products of the factors across the row at `[k1, k2]`.
    #[inline(always)]
    pub(super) fn across<K: Lanes<T>>(
        k: K,
        factors: &Factors<K::V, D>,
        [k1, k2]: [usize; 2],
    ) -> Across<K::V> {
        let (value, slope) = (&factors.value, &factors.slope);
        let zero = k.splat(T::zero());
        if const { D == 1 } {
            Across {
                value: k.splat(T::one()),
                slope: [zero; 2],
            }
        } else if const { D == 3 } {
            Across {
                value: value[1][k1] * value[D - 1][k2],
                slope: [slope[1][k1] * value[D - 1][k2], value[1][k1] * slope[D - 1][k2]],
            }
        } else {
            Across {
                value: value[1][k1],
                slope: [slope[1][k1], zero],
            }
        }
    }

    /// Value of the field with the given DOFs, at the points with the given factors.
    #[inline(always)]
    pub(super) fn value<K: Lanes<T>>(
        &self,
        k: K,
        first: usize,
        factors: &Factors<K::V, D>,
        dofs: &[SVector<T, D>],
    ) -> [K::V; D] {
        let mut result = [k.splat(T::zero()); D];
        for row in 0..Self::ROWS {
            let (offset, place) = self.row(row);
            let across = Self::across(k, factors, place);
            let dofs = &dofs[first + offset..first + offset + B::WIDTH];
            for c in 0..D {
                let mut sum = factors.value[0][0] * k.splat(dofs[0][c]);
                for i in 1..B::WIDTH {
                    sum = factors.value[0][i].mul_add(k.splat(dofs[i][c]), sum);
                }
                result[c] = sum.mul_add(across.value, result[c]);
            }
        }
        result
    }

    /// The same with the derivatives by the coordinates in cell sizes, component `c` by axis `a` at `[c][a]`.
    #[inline(always)]
    pub(super) fn value_and_slopes<K: Lanes<T>>(
        &self,
        k: K,
        first: usize,
        factors: &Factors<K::V, D>,
        dofs: &[SVector<T, D>],
    ) -> ([K::V; D], [[K::V; D]; D]) {
        let zero = k.splat(T::zero());
        let (mut value, mut slopes) = ([zero; D], [[zero; D]; D]);
        for row in 0..Self::ROWS {
            let (offset, place) = self.row(row);
            let across = Self::across(k, factors, place);
            let dofs = &dofs[first + offset..first + offset + B::WIDTH];
            for c in 0..D {
                let dof = k.splat(dofs[0][c]);
                let (mut sum, mut slope) = (factors.value[0][0] * dof, factors.slope[0][0] * dof);
                for i in 1..B::WIDTH {
                    let dof = k.splat(dofs[i][c]);
                    sum = factors.value[0][i].mul_add(dof, sum);
                    slope = factors.slope[0][i].mul_add(dof, slope);
                }
                value[c] = sum.mul_add(across.value, value[c]);
                slopes[c][0] = slope.mul_add(across.value, slopes[c][0]);
                for a in 1..D {
                    slopes[c][a] = sum.mul_add(across.slope[a - 1], slopes[c][a]);
                }
            }
        }
        (value, slopes)
    }
}
