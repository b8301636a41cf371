//! Dual domain: linear values, smoothed gradients.

use nalgebra::SVector;

use super::tensor::{self, AxisFamily, Row};
use super::{BasisFamily, Linear};
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;

/// Dual domain basis (Zhang, Ma & Giguere 2011, journal section 3.3): values of the linear hats, gradients
/// `alpha grad phi + (1 - alpha) smooth grad phi` with `alpha = 2 sum phi_i phi_(i+1)` and
///
/// `smooth grad phi_i (x) = sum_j phi_j(x)/V_j * integral(phi_j grad phi_i)`, `V_j = integral(phi_j)`.
///
/// `alpha` vanishes at cell edges, so the gradient is continuous there and reaches one cell further than
/// the value. Node `j`'s smoothed slope of a nodal field is the central difference, at the ends of the
/// domain the one-sided one (there both the integral and `V_j` are halved). Beyond one dimension the
/// gradient along an axis takes this slope along that axis and linear values along the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DualDomain;

impl<T: Scalar> AxisFamily<T, 4> for DualDomain {
    fn dofs_on_axis(&self, cells: usize) -> usize {
        cells + 1
    }

    #[inline(always)]
    fn row(&self, cells: usize, cell: usize, unit: T) -> Row<T, 4> {
        let (zero, one) = (T::zero(), T::one());
        let two = one + one;
        let (left, right) = (one - unit, unit);
        let alpha = two * left * right;
        let smooth_left = (one - alpha) * left;
        let smooth_right = (one - alpha) * right;
        // Slopes of the four nodes cell - 1 ... cell + 2.
        let mut slope = [zero, -alpha, alpha, zero];
        if cell == 0 {
            slope[1] -= smooth_left;
            slope[2] += smooth_left;
        } else {
            slope[0] -= smooth_left / two;
            slope[2] += smooth_left / two;
        }
        if cell + 1 == cells {
            slope[1] -= smooth_right;
            slope[2] += smooth_right;
        } else {
            slope[1] -= smooth_right / two;
            slope[3] += smooth_right / two;
        }
        Row {
            dof: [cell.saturating_sub(1), cell, cell + 1, (cell + 2).min(cells)],
            value: [zero, left, right, zero],
            slope,
        }
    }
}

impl<T: Scalar, const D: usize> BasisFamily<T, D> for DualDomain {
    fn degree(&self) -> usize {
        1
    }

    fn dofs(&self, grid: &Grid<T, D>) -> [usize; D] {
        tensor::dofs::<T, D, 4, _>(self, grid)
    }

    #[inline(always)]
    fn for_each(
        &self,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        x: &SVector<T, D>,
        f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        tensor::for_each::<T, D, 4, _>(self, grid, cell, x, f);
    }

    #[inline(always)]
    fn for_each_at_fixed_point(
        &self,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        x: &SVector<T, D>,
        f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        Linear.for_each(grid, cell, x, f);
    }
}
