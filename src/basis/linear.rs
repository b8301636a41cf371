//! Piecewise linear hat functions.

use super::tensor::{AxisBasis, AxisCell, Functions};
use crate::scalar::Scalar;
use crate::simd::Lanes;

/// Piecewise linear (P1) hat functions, one DOF per node: the basis of the original material point method
/// (Sulsky, Chen & Schreyer 1994). Its gradients jump at cell edges: the grid-crossing error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Linear;

impl<T: Scalar> AxisBasis<T, 2> for Linear {
    fn dofs_on_axis(&self, cells: usize) -> usize {
        cells + 1
    }

    #[inline(always)]
    fn evaluate<K: Lanes<T>>(&self, k: K, _at: AxisCell, unit: K::V) -> Functions<K::V, 2> {
        let (zero, one) = (k.splat(T::zero()), k.splat(T::one()));
        Functions {
            value: [one - unit, unit],
            slope: [zero - one, one],
        }
    }
}

crate::tensor_product_family!(Linear, width = 2, degree = 1);
