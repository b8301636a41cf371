//! Basis families at every place that particles can take.

use materialpoint::basis::{BSpline, BasisFamily, DualDomain, Linear};
use materialpoint::grid::Grid;
use materialpoint::scalar::Scalar;
use nalgebra::{SVector, vector};
use proptest::prelude::*;

use super::layout::{Body, Layout, layouts};
use super::{config, epsilon};

/// Rounding errors of a sum over all functions at a point.
///
/// The local coordinate is one number for all of them, so its own error cancels in these sums. A value takes
/// `4 p + 4` operations per axis with positive intermediate numbers, so its relative error is that many
/// roundings; values sum to one, and so do the errors' weights. Then the sum itself, one rounding a function.
fn roundings(degree: usize, dimension: usize, calls: usize) -> usize {
    (4 * degree + 4) * dimension + calls
}

/// The local coordinate lies in [0, 1] up to the two roundings of `(x - min)/h`, which is as large as the
/// number of cells, and the two of an edge's position, which is as large as the position; a value then misses
/// [0, 1] by so much times its slope, `degree` at most.
fn below_zero<T: Scalar, const D: usize>(grid: &Grid<T, D>, degree: usize) -> T {
    let farthest = |a: usize| grid.min()[a].abs().max(grid.max()[a].abs()) * grid.inverse_cell_size()[a];
    let size = (0..D)
        .map(|a| farthest(a) + T::count(grid.cells()[a]))
        .fold(T::zero(), T::max);
    epsilon::<T>() * size * T::count(2 * degree)
}

fn sums<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    body: &Body<T, D>,
) -> Result<(), TestCaseError> {
    let dofs = basis.dof_count(&body.grid);
    let least = -below_zero(&body.grid, basis.degree());
    for (p, x) in body.positions.iter().enumerate() {
        let (mut calls, mut sum) = (0, T::zero());
        let (mut slope, mut size) = (SVector::<T, D>::zeros(), SVector::<T, D>::zeros());
        let (mut smallest, mut largest_dof) = (T::zero(), 0);
        basis.for_each(&body.grid, body.bins.cell_of(p), x, |dof, value, gradient| {
            calls += 1;
            sum += value;
            slope += gradient;
            size += gradient.abs();
            smallest = smallest.min(value);
            largest_dof = largest_dof.max(dof);
        });
        let relative = epsilon::<T>() * T::count(roundings(basis.degree(), D, calls));
        prop_assert!((sum - T::one()).abs() <= relative, "sum {sum} at {x}");
        prop_assert!(smallest >= least, "value {smallest} at {x}");
        prop_assert!(largest_dof < dofs);
        for a in 0..D {
            prop_assert!(slope[a].abs() <= relative * size[a], "gradient {slope} at {x}");
        }
    }
    Ok(())
}

/// Greville abscissa of function `i` on an axis of `cells` cells, in cells: the mean of its inner knots. For
/// degree 1 that is the node.
fn greville<T: Scalar>(degree: usize, cells: usize, i: usize) -> T {
    let knots = (i + 1..=i + degree).map(|k| k.saturating_sub(degree).min(cells));
    T::count(knots.sum()) / T::count(degree)
}

/// Coefficients at equal distances: right for degree 1 only.
fn equally_spaced<T: Scalar>(degree: usize, cells: usize, i: usize) -> T {
    T::count(i * cells) / T::count(cells + degree - 1)
}

/// Largest errors of value and gradient of the field `x_axis`, in cells, from coefficients by `place`.
fn linear_field<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    body: &Body<T, D>,
    axis: usize,
    place: fn(usize, usize, usize) -> T,
) -> (T, T) {
    let grid = &body.grid;
    let dofs = basis.dofs(grid);
    let stride: usize = dofs[..axis].iter().product();
    let inverse = grid.inverse_cell_size()[axis];
    let (mut value_error, mut slope_error) = (T::zero(), T::zero());
    for (p, x) in body.positions.iter().enumerate() {
        let (mut value, mut slope) = (T::zero(), SVector::<T, D>::zeros());
        basis.for_each(grid, body.bins.cell_of(p), x, |dof, phi, gradient| {
            let c = place(basis.degree(), grid.cells()[axis], dof / stride % dofs[axis]);
            value += c * phi;
            slope += gradient * c;
        });
        let unit = SVector::from_fn(|a, _| if a == axis { T::one() } else { T::zero() });
        let in_cells = (x[axis] - grid.min()[axis]) * inverse;
        value_error = value_error.max((value - in_cells).abs());
        slope_error = slope_error.max((slope.component_mul(grid.cell_size()) - unit).amax());
    }
    (value_error, slope_error)
}

/// Coefficients are as large as the number of cells, and so are the errors; slopes carry `2 p` more per
/// function, since they are differences of neighbours' products.
fn reproduces_linear<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    body: &Body<T, D>,
) -> Result<(), TestCaseError> {
    let cells = body.grid.cells().into_iter().max().unwrap_or(1);
    let calls = (basis.degree() + 4).pow(D as u32);
    let size = epsilon::<T>() * T::count(roundings(basis.degree(), D, calls) * (cells + 1));
    for axis in 0..D {
        let (value, slope) = linear_field(basis, body, axis, greville);
        prop_assert!(value <= size, "values {value} > {size}");
        prop_assert!(slope <= size * T::count(2 * basis.degree()), "gradients {slope}");
    }
    Ok(())
}

fn all<T: Scalar, const D: usize>(layout: &Layout<D>) -> Result<(), TestCaseError>
where
    BSpline<1>: BasisFamily<T, D>,
    BSpline<2>: BasisFamily<T, D>,
    BSpline<3>: BasisFamily<T, D>,
{
    fn both<T: Scalar, const D: usize>(
        basis: &impl BasisFamily<T, D>,
        body: &Body<T, D>,
    ) -> Result<(), TestCaseError> {
        sums(basis, body)?;
        reproduces_linear(basis, body)
    }
    let body = layout.body::<T>().unwrap();
    both(&Linear, &body)?;
    both(&DualDomain::new(), &body)?;
    both(&BSpline::<1>, &body)?;
    both(&BSpline::<2>, &body)?;
    both(&BSpline::<3>, &body)
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn sums_and_linear_fields_1d(layout in layouts::<1>(12, 8)) {
        all::<f64, 1>(&layout)?;
        all::<f32, 1>(&layout)?;
    }

    #[test]
    fn sums_and_linear_fields_2d(layout in layouts::<2>(4, 6)) {
        all::<f64, 2>(&layout)?;
        all::<f32, 2>(&layout)?;
    }

    #[test]
    fn sums_and_linear_fields_3d(layout in layouts::<3>(3, 3)) {
        all::<f64, 3>(&layout)?;
        all::<f32, 3>(&layout)?;
    }
}

/// The reproduction of `x` needs the right coefficients: equal distances do for nodes, not for B-splines
/// beyond degree 1, whose functions crowd at the ends.
#[test]
fn equally_spaced_coefficients_do_not_reproduce_linear_fields_with_b_splines() {
    let grid = Grid::new(vector![0.0], vector![1.0], [6]).unwrap();
    let positions: Vec<SVector<f64, 1>> = (0..50).map(|k| vector![f64::from(k) / 50.0]).collect();
    let body = Body {
        bins: materialpoint::particles::Bins::new(&grid, &positions).unwrap(),
        volumes: vec![0.02; 50],
        grid,
        positions,
    };
    assert!(linear_field(&Linear, &body, 0, equally_spaced).0 < 1e-14);
    assert!(linear_field(&DualDomain::new(), &body, 0, equally_spaced).0 < 1e-14);
    // Known figures: half a cell's width is shared out among the ends; the largest misfit is near 0.2 cells.
    for error in [
        linear_field(&BSpline::<2>, &body, 0, equally_spaced).0,
        linear_field(&BSpline::<3>, &body, 0, equally_spaced).0,
    ] {
        assert!(error > 0.1 && error < 1.0, "{error}");
    }
}

/// Dual domain gradients are continuous across cell edges where those of hats jump.
#[test]
fn dual_domain_gradients_are_continuous_where_linear_ones_jump() {
    fn jump(basis: &impl BasisFamily<f64, 1>) -> f64 {
        let grid = Grid::new(vector![0.0], vector![5.0], [5]).unwrap();
        let mut largest = 0.0_f64;
        for edge in 1..5_u32 {
            let mut change = vec![0.0; basis.dof_count(&grid)];
            let x = vector![f64::from(edge)];
            basis.for_each(&grid, &[edge], &x, |dof, _, g| change[dof] += g[0]);
            basis.for_each(&grid, &[edge - 1], &x, |dof, _, g| change[dof] -= g[0]);
            largest = change.iter().fold(largest, |m, c| m.max(c.abs()));
        }
        largest
    }
    assert!(jump(&DualDomain::new()) <= 4.0 * f64::EPSILON);
    assert!(jump(&BSpline::<2>) <= 4.0 * f64::EPSILON);
    assert_eq!(jump(&Linear), 2.0);
}
