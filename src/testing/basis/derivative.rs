//! Whether gradients are the derivatives of the values.

use nalgebra::SVector;

use super::sample::{Sample, Visitor, value_error};
use super::{BasisClaims, cell_of};
use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Place, Property};
use crate::testing::worst::Worst;

/// Step of the finite differences in cell sizes: exact in binary, small against the cell, and large enough
/// for round-off to leave half the digits even in `f32`.
pub(super) const STEP: f64 = 1.0 / 128.0;

pub(super) fn check<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    points: &[SVector<T, D>],
    claims: &BasisClaims,
) -> Result<(), Failure> {
    let cases = [
        (
            Visitor::Moving,
            Property::GradientsAreDerivatives,
            claims.gradients_are_derivatives,
        ),
        (
            Visitor::Fixed,
            Property::FixedPointGradients,
            claims.fixed_point_gradients_are_derivatives,
        ),
    ];
    for (visitor, property, claimed) in cases {
        let mut worst = Worst::new();
        for x in points {
            let cell = cell_of(grid, x)?;
            let x = inside(grid, &cell, x);
            for axis in 0..D {
                compare(basis, grid, &cell, &x, axis, visitor, &mut worst)?;
            }
        }
        worst.judge(property, claimed)?;
    }
    Ok(())
}

/// `x`, moved so far from the edges of its cell that differences stay within: gradients may jump at edges.
pub(super) fn inside<T: Scalar, const D: usize>(
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
) -> SVector<T, D> {
    SVector::from_fn(|a, _| {
        let margin = grid.cell_size()[a] * T::lit(3.0 * STEP);
        let (low, high) = (grid.edge(a, cell[a] as usize), grid.edge(a, cell[a] as usize + 1));
        x[a].max(low + margin).min(high - margin)
    })
}

/// Central differences of steps `d` and `2 d`, extrapolated (exact up to degree 4).
///
/// Round-off: each of the two values over `d` carries `value_error`, the extrapolation weighs them by 5/3 in
/// total. Truncation: the two differences differ by `3 d^2/6` of the third derivative; what is left after the
/// extrapolation is smaller by `d^2` where the function varies on the scale of the cell, and `d` is allowed.
fn compare<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
    axis: usize,
    visitor: Visitor<T, D>,
    worst: &mut Worst<T>,
) -> Result<(), Failure> {
    let here = Sample::new(basis, grid, cell, x, visitor)?;
    let near = difference(basis, grid, cell, x, axis, T::lit(STEP))?;
    let far = difference(basis, grid, cell, x, axis, T::lit(2.0 * STEP))?;
    let inverse = grid.inverse_cell_size()[axis];
    let round_off = value_error(basis, grid) * inverse * T::lit(2.0 / STEP);
    for dof in 0..near.len() {
        let change = near[dof] - far[dof];
        let slope = near[dof] + change / T::lit(3.0);
        let allowed = round_off + change.abs() * T::lit(STEP);
        worst.record(here.gradient[dof][axis] - slope, allowed, || Place::dof(dof, x));
    }
    Ok(())
}

/// Central difference of every DOF's value along an axis, `step` in cell sizes.
fn difference<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
    axis: usize,
    step: T,
) -> Result<Vec<T>, Failure> {
    let (mut low, mut high) = (*x, *x);
    low[axis] -= grid.cell_size()[axis] * step;
    high[axis] += grid.cell_size()[axis] * step;
    // The step as rounded, not as wished.
    let width = high[axis] - low[axis];
    let below = Sample::new(basis, grid, cell, &low, Visitor::Moving)?.value;
    let above = Sample::new(basis, grid, cell, &high, Visitor::Moving)?.value;
    Ok(above.iter().zip(&below).map(|(&a, &b)| (a - b) / width).collect())
}
