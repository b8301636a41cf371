//! Whether a basis is one polynomial of its degree in each cell.

use nalgebra::SVector;

use crate::basis::BasisFamily;
use crate::error::SetupError;
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;

/// Points of a cell along an axis: functions that bend nearer to an edge than half their distance are not
/// found out.
const POINTS: usize = 32;
/// What a difference of values may be off, in units of the rounding of one.
const ROUNDING: f64 = 1e4;
/// The same in units of the rounding of a coordinate, in cells.
const OF_COORDINATES: f64 = 64.0;

/// Refuses a basis that is not one polynomial of its degree along each axis of each cell: ties between cells
/// continue that polynomial ([`crate::mass::Penalty`]), and continue something else where functions bend
/// within a cell. Functions over domains always do.
pub(super) fn refuse_bends_within_cells<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
) -> Result<(), SetupError> {
    for axis in 0..D {
        if B::DOMAIN.is_asked_for() {
            return Err(SetupError::NotPolynomial {
                axis,
                cell: 0,
                degree: basis.degree(),
            });
        }
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

/// Whether differences of one order more than the degree do not vanish between points on the middle line of a
/// cell.
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
    let farthest = grid.min()[axis].abs().max(grid.max()[axis].abs()) * grid.inverse_cell_size()[axis];
    let largest = T::default_epsilon() * (T::lit(ROUNDING) + farthest * T::lit(OF_COORDINATES));
    functions.into_iter().any(|(_, mut values)| {
        for _ in 0..=basis.degree() {
            values = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
        }
        // What is not a number is no polynomial either.
        !values.iter().all(|difference| difference.abs() <= largest)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{AxisBasis, AxisCell, BSpline, DualDomain, Functions, Linear};
    use crate::simd::Lanes;
    use nalgebra::vector;

    /// Linear functions averaged over a particle of this half size, in cells (uGIMP): they bend so far from
    /// the edges of cells, with a half in the middle.
    #[derive(Clone, Copy, Debug)]
    struct Averaged(f64);

    impl<T: Scalar> AxisBasis<T, 4> for Averaged {
        fn dofs_on_axis(&self, cells: usize) -> usize {
            cells + 3
        }

        fn evaluate<K: Lanes<T>>(&self, k: K, _at: AxisCell, s: K::V) -> Functions<K::V, 4> {
            let [value, slope] = k.one_by_one(s, |s| self.row(s));
            Functions { value, slope }
        }
    }

    impl Averaged {
        /// Values and, which nobody asks for here, no slopes.
        fn row<T: Scalar>(&self, s: T) -> [[T; 4]; 2] {
            let [half, one, two, four] = [self.0, 1.0, 2.0, 4.0].map(T::lit);
            let value = |node: usize| {
                let away = (s + one - T::count(node)).abs();
                match away {
                    _ if away < half => one - (away * away + half * half) / (two * half),
                    _ if away < one - half => one - away,
                    _ if away < one + half => (one + half - away) * (one + half - away) / (four * half),
                    _ => T::zero(),
                }
            };
            [std::array::from_fn(value), [T::zero(); 4]]
        }
    }

    crate::tensor_product_family!(Averaged, width = 4, degree = 2);

    #[test]
    fn functions_that_bend_within_a_cell_are_found_out() {
        let grid = Grid::<f64, 2>::new(vector![0.0, 0.0], vector![5.0, 1.0], [5, 4]).unwrap();
        let refused = SetupError::NotPolynomial {
            axis: 0,
            cell: 0,
            degree: 2,
        };
        for half in [0.02, 0.125, 0.2, 0.4, 0.5] {
            let found = refuse_bends_within_cells(&Averaged(half), &grid);
            assert_eq!(found, Err(refused.clone()), "{half}");
        }
    }

    #[test]
    fn those_of_the_library_do_not_bend() {
        fn check<B: BasisFamily<f64, 2>>(basis: &B) {
            for (cells, far) in [([1, 1], 0.0), ([2, 7], 0.0), ([5, 4], 1e3)] {
                let grid = Grid::new(vector![far, 0.0], vector![far + 1.0, 8.0], cells).unwrap();
                assert_eq!(refuse_bends_within_cells(basis, &grid), Ok(()), "{cells:?}");
            }
        }
        check(&Linear);
        check(&DualDomain::default());
        check(&BSpline::<1>);
        check(&BSpline::<2>);
        check(&BSpline::<3>);
    }
}
