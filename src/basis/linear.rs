//! Piecewise linear hat functions.

use super::tensor::{AxisFamily, Row};
use crate::lanes::SideBySide;
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

    const UNIFORM: bool = true;

    #[inline(always)]
    fn lanes<V: SideBySide<T>>(&self, _cells: usize, _cell: usize, unit: V) -> ([V; 2], [V; 2]) {
        let (zero, one) = (V::splat(T::zero()), V::splat(T::one()));
        ([one - unit, unit], [zero - one, one])
    }
}

crate::tensor_product_family!(Linear, width = 2, degree = 1);
