//! Piecewise linear hat functions.

use nalgebra::SVector;

use super::BasisFamily;
use super::tensor::{self, AxisFamily, Row};
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;

/// Piecewise linear (P1) hat functions, one DOF per node: the basis of the original material point method
/// (Sulsky, Chen & Schreyer 1994). Its gradients jump at cell edges: the grid-crossing error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Linear;

impl<T: Scalar> AxisFamily<T, 2> for Linear {
    fn dofs_on_axis(&self, cells: usize) -> usize {
        cells + 1
    }

    #[inline(always)]
    fn row(&self, _cells: usize, cell: usize, unit: T) -> Row<T, 2> {
        Row {
            dof: [cell, cell + 1],
            value: [T::one() - unit, unit],
            slope: [-T::one(), T::one()],
        }
    }
}

impl<T: Scalar, const D: usize> BasisFamily<T, D> for Linear {
    fn degree(&self) -> usize {
        1
    }

    fn dofs(&self, grid: &Grid<T, D>) -> [usize; D] {
        tensor::dofs::<T, D, 2, _>(self, grid)
    }

    #[inline(always)]
    fn for_each(
        &self,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        x: &SVector<T, D>,
        f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        tensor::for_each::<T, D, 2, _>(self, grid, cell, x, f);
    }
}
