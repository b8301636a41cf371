//! Fields that the functions of a basis carry.

use nalgebra::SVector;

use super::BasisFamily;
use crate::grid::{Cell, Grid, Window};
use crate::scalar::Scalar;

/// The field of a basis that agrees with `N` given quantities at every [`BasisFamily::interpolation_point`]:
/// nodal values for hats, for B-splines of degree `p` the interpolating spline at the Greville abscissae,
/// whose error is of order `p + 1` (coefficients that are merely the values there would be of order 2).
#[derive(Clone, Debug)]
pub struct Interpolant<T: Scalar, const N: usize> {
    coefficients: Vec<SVector<T, N>>,
}

impl<T: Scalar, const N: usize> Interpolant<T, N> {
    /// Takes `values` at the points and solves for the coefficients, `O(n w^2)` for `n` DOFs and half band
    /// width `w`. They are not finite if the functions of the basis cannot interpolate there.
    ///
    /// # Errors
    /// The first error of `values`.
    pub fn new<const D: usize, B: BasisFamily<T, D>, E>(
        basis: &B,
        grid: &Grid<T, D>,
        mut values: impl FnMut(&SVector<T, D>) -> Result<SVector<T, N>, E>,
    ) -> Result<Self, E> {
        let mut system = Collocation::new(basis.dof_count(grid), basis.half_band(grid));
        for dof in 0..basis.dof_count(grid) {
            let x = basis.interpolation_point(grid, dof);
            system.right.push(values(&x)?);
            if let Some(cell) = grid.locate(&x) {
                basis.for_each(grid, &cell, &x, |j, phi, _| system.add(dof, j, phi));
            }
        }
        Ok(Self {
            coefficients: system.solve(),
        })
    }

    /// The field at `x`, which lies in the grid; zero outside it.
    pub fn at<const D: usize, B: BasisFamily<T, D>>(
        &self,
        basis: &B,
        grid: &Grid<T, D>,
        x: &SVector<T, D>,
    ) -> SVector<T, N> {
        let mut sum = SVector::zeros();
        if let Some(cell) = grid.locate(x) {
            basis.for_each(grid, &cell, x, |i, phi, _| sum += self.coefficients[i] * phi);
        }
        sum
    }
}

/// Where the DOFs of the whole grid lie along `axis`: DOF `i` at `x_i = x_min + (i + s_i) h`, with the shifts
/// `s_i` that are returned and for which `sum_i phi_i x_i = x`. Nodes of hats (no shift), Greville abscissae of
/// splines, and for functions of another kind what they say themselves. Shifts, unlike places, do not grow
/// with the grid and lose no digit in single precision. `None` if there are none: then the functions do not
/// reproduce linear ones, or are no products along the axes.
pub(crate) fn shifts_along<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    axis: usize,
) -> Option<Vec<T>> {
    let grid = &grid.clone().with_window(Window::whole(grid.cells()));
    let shape = basis.dofs(grid);
    let stride: usize = shape[..axis].iter().product();
    let middle: Cell<D> = std::array::from_fn(|a| grid.cells()[a] as u32 / 2);
    // Along a line through the grid's middle the functions of the other axes add up to one. The place is
    // handed on as a coordinate in its cell, and that cell.
    let values = |along: T, f: &mut dyn FnMut(usize, T)| {
        let mut x = grid.centre(&middle);
        x[axis] = along;
        let cell = grid.locate(&x)?;
        basis.for_each(grid, &cell, &x, |dof, phi, _| f(dof / stride % shape[axis], phi));
        let unit = grid.unit_coordinate(axis, cell[axis], along);
        Some((cell[axis] as usize, unit))
    };
    // What the numbers of the DOFs leave of a place: `xi - sum_i phi_i (i - cell)`.
    let left = |(cell, unit): (usize, T), functions: &[(usize, T)]| {
        let parts = functions.iter().map(|&(j, phi)| phi * steps_from::<T>(cell, j));
        parts.fold(unit, |left, part| left - part)
    };
    let mut functions = Vec::new();
    let mut system = Collocation::<T, 1>::new(shape[axis], basis.reach().min(shape[axis] - 1));
    for n in 0..shape[axis] {
        let x = basis.interpolation_point(grid, n * stride)[axis];
        functions.clear();
        let place = values(x, &mut |j, phi| functions.push((j, phi)))?;
        system.right.push(SVector::repeat(left(place, &functions)));
        for &(j, phi) in &functions {
            system.add(n, j, phi);
        }
    }
    let shifts: Vec<T> = system.solve().iter().map(|s| s[0]).collect();
    let mut reproduces = |cell: usize| {
        let x = grid.edge(axis, cell) + grid.cell_size()[axis] * T::lit(0.3);
        functions.clear();
        let Some(place) = values(x, &mut |j, phi| functions.push((j, phi))) else {
            return false;
        };
        let parts = functions.iter().map(|&(j, phi)| phi * shifts[j]);
        let error = parts.fold(left(place, &functions), |left, part| left - part);
        error.abs() <= T::default_epsilon().sqrt()
    };
    (0..grid.cells()[axis]).all(&mut reproduces).then_some(shifts)
}

/// How many cells further than `cell` the number of a DOF says that it is.
#[inline(always)]
pub(crate) fn steps_from<T: Scalar>(cell: usize, dof: usize) -> T {
    T::lit(f64::from(dof as i32 - cell as i32))
}

/// A banded system of equations, one for each interpolation point. Its matrix is totally positive, or a
/// Kronecker product of such, so elimination needs no pivoting.
struct Collocation<T: Scalar, const N: usize> {
    half_band: usize,
    /// `2 half_band + 1` entries a row.
    rows: Vec<T>,
    right: Vec<SVector<T, N>>,
}

impl<T: Scalar, const N: usize> Collocation<T, N> {
    fn new(order: usize, half_band: usize) -> Self {
        Self {
            half_band,
            rows: vec![T::zero(); order * (2 * half_band + 1)],
            right: Vec::with_capacity(order),
        }
    }

    fn place(&self, i: usize, j: usize) -> usize {
        i * (2 * self.half_band + 1) + j + self.half_band - i
    }

    fn add(&mut self, i: usize, j: usize, value: T) {
        // Functions beyond the band are seen for their gradients; their values are zero.
        if i.abs_diff(j) <= self.half_band {
            let place = self.place(i, j);
            self.rows[place] += value;
        }
    }

    fn solve(mut self) -> Vec<SVector<T, N>> {
        let order = self.right.len();
        for k in 0..order {
            let last = (k + self.half_band + 1).min(order);
            for i in k + 1..last {
                let factor = self.rows[self.place(i, k)] / self.rows[self.place(k, k)];
                for j in k + 1..last {
                    let (from, to) = (self.place(k, j), self.place(i, j));
                    let part = self.rows[from] * factor;
                    self.rows[to] -= part;
                }
                let part = self.right[k] * factor;
                self.right[i] -= part;
            }
        }
        for k in (0..order).rev() {
            let last = (k + self.half_band + 1).min(order);
            let mut rest = self.right[k];
            for j in k + 1..last {
                rest -= self.right[j] * self.rows[self.place(k, j)];
            }
            self.right[k] = rest / self.rows[self.place(k, k)];
        }
        self.right
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{BSpline, DualDomain, Linear};
    use nalgebra::vector;

    fn interpolant<B: BasisFamily<f64, 1>>(
        basis: &B,
        cells: usize,
        f: fn(f64) -> f64,
    ) -> impl Fn(f64) -> f64 {
        let grid = Grid::new(vector![-1.0], vector![2.0], [cells]).unwrap();
        let field = Interpolant::<f64, 1>::new(basis, &grid, |x| Ok::<_, ()>(vector![f(x[0])])).unwrap();
        let basis = basis.clone();
        move |x| field.at(&basis, &grid, &vector![x])[0]
    }

    fn largest_error<B: BasisFamily<f64, 1>>(basis: &B, cells: usize, f: fn(f64) -> f64) -> f64 {
        let field = interpolant(basis, cells, f);
        let points = (0..=997).map(|i| -1.0 + 3.0 * f64::from(i) / 997.0);
        points.map(|x| (field(x) - f(x)).abs()).fold(0.0, f64::max)
    }

    /// Places of DOFs: Greville abscissae of open knots, nodes of hats, and none where a linear function is not
    /// reproduced.
    #[test]
    fn dofs_lie_where_linear_functions_are_reproduced_about() {
        let grid = Grid::new(vector![1.0], vector![3.0], [4]).unwrap();
        let near = |found: Option<Vec<f64>>, expected: &[f64]| {
            let found = found.unwrap();
            assert_eq!(found.len(), expected.len());
            for (i, (shift, place)) in found.iter().zip(expected).enumerate() {
                let found = 1.0 + 0.5 * (i as f64 + shift);
                assert!((found - place).abs() < 1e-14, "DOF {i}: {found} for {place}");
            }
        };
        let nodes = [1.0, 1.5, 2.0, 2.5, 3.0];
        near(shifts_along(&Linear, &grid, 0), &nodes);
        near(shifts_along(&DualDomain::new(), &grid, 0), &nodes);
        let greville = [1.0, 1.25, 1.75, 2.25, 2.75, 3.0];
        near(shifts_along(&BSpline::<2>, &grid, 0), &greville);
        assert!(shifts_along(&Steps, &grid, 0).is_none());
    }

    /// Far from the origin and on many cells a shift is as exact as near it: places in single precision would
    /// be off by a part of a cell here.
    #[test]
    fn places_of_dofs_lose_no_digit_far_from_the_origin() {
        for (min, cells) in [(0.0, 4_usize), (4096.0, 4), (-100.0, 50_000)] {
            let grid = Grid::<f32, 1>::new(vector![min], vector![min + cells as f32 * 0.5], [cells]).unwrap();
            let shifts = shifts_along(&BSpline::<2>, &grid, 0).unwrap();
            for (i, shift) in shifts.iter().enumerate() {
                let expected = match i {
                    0 => 0.0,
                    _ if i == cells + 1 => -1.0,
                    _ => -0.5,
                };
                assert!(
                    (shift - expected).abs() < 1e-6,
                    "{cells} cells from {min}, DOF {i}: {shift}"
                );
            }
        }
    }

    /// One constant function a cell.
    #[derive(Clone, Debug)]
    struct Steps;

    impl BasisFamily<f64, 1> for Steps {
        fn degree(&self) -> usize {
            0
        }

        fn dofs(&self, grid: &Grid<f64, 1>) -> [usize; 1] {
            grid.cells()
        }

        fn for_each(
            &self,
            _grid: &Grid<f64, 1>,
            cell: &Cell<1>,
            _x: &SVector<f64, 1>,
            mut f: impl FnMut(usize, f64, SVector<f64, 1>),
        ) {
            f(cell[0] as usize, 1.0, SVector::zeros());
        }
    }

    #[test]
    fn ones_and_every_polynomial_of_the_degree_are_kept() {
        for cells in [1, 2, 3, 10] {
            assert!(largest_error(&Linear, cells, |_| 1.0) < 1e-14);
            assert!(largest_error(&DualDomain::new(), cells, |x| 1.0 - x) < 1e-14);
            assert!(largest_error(&BSpline::<1>, cells, |x| 2.0 * x) < 1e-14);
            assert!(largest_error(&BSpline::<2>, cells, |x| 3.0 - x * x) < 1e-13);
            assert!(largest_error(&BSpline::<3>, cells, |x| x * x * x - x) < 1e-13);
        }
    }

    #[test]
    fn the_order_is_one_more_than_the_degree() {
        fn order<B: BasisFamily<f64, 1>>(basis: &B) -> f64 {
            let error = |cells| largest_error(basis, cells, |x| (2.0 * x).sin());
            (error(20) / error(40)).log2()
        }
        assert!((order(&Linear) - 2.0).abs() < 0.1);
        assert!((order(&DualDomain::new()) - 2.0).abs() < 0.1);
        assert!(
            (order(&BSpline::<2>) - 3.0).abs() < 0.15,
            "{}",
            order(&BSpline::<2>)
        );
        assert!(
            (order(&BSpline::<3>) - 4.0).abs() < 0.2,
            "{}",
            order(&BSpline::<3>)
        );
    }

    #[test]
    fn the_points_of_a_quadratic_are_its_ends_and_the_middles_of_its_cells() {
        let grid = Grid::new(vector![1.0], vector![3.0], [4]).unwrap();
        let points: Vec<f64> = (0..6)
            .map(|dof| BSpline::<2>.interpolation_point(&grid, dof)[0])
            .collect();
        assert_eq!(points, [1.0, 1.25, 1.75, 2.25, 2.75, 3.0]);
    }

    #[test]
    fn a_product_of_axes_interpolates_too() {
        let grid = Grid::new(vector![0.0, 0.0], vector![1.0, 2.0], [3, 4]).unwrap();
        let f = |x: &SVector<f64, 2>| x[0] * x[0] - x[0] * x[1] * x[1] + 1.0;
        let field = Interpolant::<f64, 1>::new(&BSpline::<2>, &grid, |x| Ok::<_, ()>(vector![f(x)])).unwrap();
        for x in [vector![0.11, 1.93], vector![0.7, 0.4], vector![1.0, 2.0]] {
            assert!((field.at(&BSpline::<2>, &grid, &x)[0] - f(&x)).abs() < 1e-13);
        }
    }
}
