//! Whether a basis is one polynomial of its degree in each cell.

use nalgebra::SVector;

use crate::basis::BasisFamily;
use crate::error::SetupError;
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;

/// Points of a cell along an axis: functions that bend nearer to an edge than half their distance are not found out.
const POINTS: usize = 32;
/// Part of one, in units of the rounding of one, that a difference of values may be off.
const ROUNDING: f64 = 1e4;

/// Refuses a basis that is not one polynomial of its degree along each axis of each cell: ties between cells continue that
/// polynomial ([`crate::mass::Penalty`]), and continue something else where functions bend within a cell.
pub(super) fn refuse_bends_within_cells<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
) -> Result<(), SetupError> {
    for axis in 0..D {
        let bend = grid.line(axis).find(|cell| bends_in(basis, grid, cell, axis));
        if let Some(cell) = bend {
            return Err(SetupError::NotPolynomial {
                axis,
                cell: cell[axis],
                degree: basis.degree(),
            });
        }
    }
    Ok(())
}

/// Whether differences of one order more than the degree do not vanish between points on the middle line of a cell.
fn bends_in<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    axis: usize,
) -> bool {
    // Of each function the values at the points, in the order in which the basis first visits it.
    let mut functions: Vec<(usize, Vec<T>)> = Vec::new();
    for k in 0..POINTS {
        let mut x: SVector<T, D> = grid.centre(cell);
        let unit = (T::count(2 * k + 1) - T::count(POINTS)) / T::count(2 * POINTS);
        x[axis] += grid.cell_size()[axis] * unit;
        basis.for_each_at_fixed_point(grid, cell, &x, |dof, value, _| {
            let place = functions.iter().position(|&(other, _)| other == dof);
            let place = place.unwrap_or_else(|| {
                functions.push((dof, vec![T::zero(); POINTS]));
                functions.len() - 1
            });
            functions[place].1[k] += value;
        });
    }
    let largest = T::default_epsilon() * T::lit(ROUNDING);
    functions.into_iter().any(|(_, mut values)| {
        for _ in 0..=basis.degree() {
            values = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
        }
        // What is not a number is no polynomial either.
        !values.iter().all(|difference| difference.abs() <= largest)
    })
}
