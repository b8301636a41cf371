//! Dual domain: linear values, smoothed gradients.

use super::Linear;
use super::tensor::{AxisFamily, Row};
use crate::scalar::Scalar;

/// Dual domain basis (Zhang, Ma & Giguere 2011, journal section 3.3): values of the linear hats, smoothed gradients
///
/// $$\overline{\nabla\phi_i} = \alpha\nabla\phi_i + (1-\alpha)\widetilde{\nabla\phi_i},\quad
/// \widetilde{\nabla\phi_i}(x) = \sum_j \frac{\phi_j(x)}{V_j}\int\phi_j\nabla\phi_i,\quad
/// V_j = \int\phi_j,\quad \alpha = 2\sum_i\phi_i\phi_{i+1}.$$
///
/// $\alpha$ vanishes at cell edges, so the gradient is continuous there and reaches one cell further than the value. Node
/// $j$'s smoothed slope of a nodal field is the central difference, at the ends of the domain the one-sided one (there both
/// the integral and $V_j$ are halved). Beyond one dimension the gradient along an axis takes this slope along that axis and
/// linear values along the others.
#[doc = include_str!("../../docs/formulas.html")]
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

// Gauss points stand still, so nothing crosses there: the plain gradient is the accurate one.
crate::tensor_product_family!(DualDomain, width = 4, degree = 1, at_fixed_points = Linear);
