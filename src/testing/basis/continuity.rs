//! Whether values go on from cell to cell.

use nalgebra::SVector;

use super::cell_of;
use super::sample::{Sample, Visitor, value_error};
use crate::basis::BasisFamily;
use crate::grid::Grid;
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Place, Property, near};

/// Moves `x` onto the upper edge of its cell along each axis and asks the cells on both sides: functions that
/// jump there have no gradient, and a balance of momentum by parts wants one.
pub(super) fn check<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    x: &SVector<T, D>,
) -> Result<(), Failure> {
    let cell = cell_of(grid, x)?;
    let error = value_error(basis, grid);
    // Both sides carry it.
    let allowed = error + error;
    for axis in 0..D {
        let mut next = cell;
        next[axis] += 1;
        // The last cell of an axis has no next one.
        if grid.locate(&grid.centre(&next)) != Some(next) {
            continue;
        }
        let mut x = *x;
        x[axis] = grid.edge(axis, next[axis] as usize);
        let below = Sample::new(basis, grid, &cell, &x, Visitor::Moving)?.value;
        let above = Sample::new(basis, grid, &next, &x, Visitor::Moving)?.value;
        for (dof, (&below, &above)) in below.iter().zip(&above).enumerate() {
            near(
                Property::Continuous,
                || Place::dof(dof, &x),
                below,
                above,
                allowed,
            )?;
        }
    }
    Ok(())
}
