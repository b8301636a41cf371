//! Everything that a basis says at one point, by DOF.

use nalgebra::{SMatrix, SVector};

use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Place, Property, at_least};

/// Values and gradients of all DOFs at a point.
#[derive(Clone, Debug)]
pub(super) struct Sample<T, const D: usize> {
    pub(super) value: Vec<T>,
    pub(super) gradient: Vec<SVector<T, D>>,
    /// Calls of the visitor.
    pub(super) calls: usize,
}

/// Which of the visitors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Visitor<T, const D: usize> {
    Moving,
    Fixed,
    /// That of particles with this domain: half edge vectors, one a column.
    Over(SMatrix<T, D, D>),
}

impl<T: Scalar, const D: usize> Sample<T, D> {
    /// Collects what `basis` says at `x` of `cell`.
    pub(super) fn new<B: BasisFamily<T, D>>(
        basis: &B,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        x: &SVector<T, D>,
        visitor: Visitor<T, D>,
    ) -> Result<Self, Failure> {
        let count = basis.dof_count(grid);
        let mut sample = Self {
            value: vec![T::zero(); count],
            gradient: vec![SVector::zeros(); count],
            calls: 0,
        };
        let mut outside = None;
        let take = |dof: usize, value, gradient: SVector<T, D>| {
            sample.calls += 1;
            if dof < count {
                // A DOF may come twice; its parts add up.
                sample.value[dof] += value;
                sample.gradient[dof] += gradient;
            } else {
                outside = Some(dof);
            }
        };
        match visitor {
            Visitor::Moving => basis.for_each(grid, cell, x, take),
            Visitor::Fixed => basis.for_each_at_fixed_point(grid, cell, x, take),
            Visitor::Over(domain) => basis.for_each_over(grid, cell, x, &domain, take),
        }
        match outside {
            Some(dof) => at_least(
                Property::DofInRange,
                || Place::dof(dof, x),
                T::count(dof + 1),
                T::count(count),
            )
            .map(|()| sample),
            None => Ok(sample),
        }
    }
}

/// Round-off of one value, absolute, in units where a value is at most 1.
///
/// The local coordinate `(x - min)/h - cell` carries two rounding errors of a number as large as the number
/// of cells, and a point on an edge two of one as large as the edge's position in cells. A polynomial with
/// values in `[0, 1]` on the cell has a slope of at most `degree^2` there (Markov), and its evaluation takes
/// about `4 (degree + 1)` operations; both once per axis.
pub(super) fn value_error<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
) -> T {
    let farthest = |a: usize| grid.min()[a].abs().max(grid.max()[a].abs()) * grid.inverse_cell_size()[a];
    let size = (0..D)
        .map(|a| farthest(a) + T::count(grid.cells()[a]))
        .fold(T::one(), T::max);
    let evaluation = T::count(4 * (basis.degree() + 1));
    T::count(D) * (T::lit(2.0) * size * slope_bound::<T, D, B>(basis) + evaluation) * T::default_epsilon()
}

/// The slope of a value of at most 1 is at most this, in cell sizes (Markov).
pub(super) fn slope_bound<T: Scalar, const D: usize, B: BasisFamily<T, D>>(basis: &B) -> T {
    let degree = basis.degree().max(1);
    T::count(degree * degree)
}
