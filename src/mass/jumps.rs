//! Jumps of the highest derivative between the cells of an axis.

use nalgebra::SVector;

use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;

/// What the functions along one axis do at the lines between its cells: a function that is a polynomial of
/// the basis's degree $p$ in two neighbouring cells is the same one in both if $h^p\partial^p$ does not jump
/// between them, for a basis as smooth as splines are.
#[derive(Clone, Debug)]
pub(super) struct AxisJumps<T> {
    /// First function of each cell and how many it has, counted within the window.
    seen: Vec<[u32; 2]>,
    /// Where the coefficients of the jump above each cell start; one more at the end.
    starts: Vec<u32>,
    /// Those of the functions from the first of that cell on.
    coefficients: Vec<T>,
}

impl<T: Scalar> AxisJumps<T> {
    /// Of the functions of `basis` along `axis`, in the grid's window.
    pub(super) fn new<const D: usize, B: BasisFamily<T, D>>(
        basis: &B,
        grid: &Grid<T, D>,
        axis: usize,
    ) -> Self {
        let cells: Vec<_> = grid
            .line(axis)
            .map(|cell| highest_derivative(basis, grid, &cell, axis))
            .collect();
        let mut jumps = Self::none();
        for pair in cells.windows(2) {
            jumps.starts.push(jumps.coefficients.len() as u32);
            let [below, above] = [&pair[0], &pair[1]];
            let start = jumps.coefficients.len();
            let apart = above.first - below.first;
            let width = below.values.len().max(apart + above.values.len());
            jumps.coefficients.resize(start + width, T::zero());
            let row = &mut jumps.coefficients[start..];
            for (place, &value) in below.values.iter().enumerate() {
                row[place] -= value;
            }
            for (place, &value) in above.values.iter().enumerate() {
                row[apart + place] += value;
            }
        }
        jumps.starts.push(jumps.coefficients.len() as u32);
        jumps.seen = cells
            .iter()
            .map(|cell| [cell.first as u32, cell.values.len() as u32])
            .collect();
        jumps
    }

    /// Of no function.
    pub(super) fn none() -> Self {
        Self {
            seen: Vec::new(),
            starts: Vec::new(),
            coefficients: Vec::new(),
        }
    }

    /// Bytes allocated.
    pub(super) fn bytes(&self) -> usize {
        size_of::<[u32; 2]>() * self.seen.capacity()
            + size_of::<u32>() * self.starts.capacity()
            + size_of::<T>() * self.coefficients.capacity()
    }

    /// Lines between cells.
    pub(super) fn lines(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// First function of a cell, counted within the window.
    #[inline(always)]
    pub(super) fn first(&self, cell: usize) -> usize {
        self.seen[cell][0] as usize
    }

    /// Functions of a cell.
    #[inline(always)]
    pub(super) fn seen(&self, cell: usize) -> usize {
        self.seen[cell][1] as usize
    }

    /// Coefficients of the jump above a cell, of the functions from [`AxisJumps::first`] on.
    #[inline(always)]
    pub(super) fn above(&self, cell: usize) -> &[T] {
        &self.coefficients[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }
}

/// $h^p\partial^p$ of a cell's functions along an axis, which is a constant.
struct Derivative<T> {
    first: usize,
    values: Vec<T>,
}

/// By differences of the values at `p + 1` points, exact for polynomials: a family need not tell its
/// derivatives. Functions that have the same place along the axis are added up, which a partition of unity
/// makes functions of that axis alone.
fn highest_derivative<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    axis: usize,
) -> Derivative<T> {
    let shape = basis.dofs(grid);
    let stride: usize = shape[..axis].iter().product();
    let degree = basis.degree();
    let points = T::count(degree + 1);
    let mut along: Vec<(usize, T)> = Vec::new();
    let mut weight = points.powi(degree as i32);
    if degree % 2 == 1 {
        weight = -weight;
    }
    for k in 0..=degree {
        let mut x: SVector<T, D> = grid.centre(cell);
        let unit = (T::count(k) + T::lit(0.5)) / points;
        x[axis] += grid.cell_size()[axis] * (unit - T::lit(0.5));
        basis.for_each_at_fixed_point(grid, cell, &x, |dof, value, _| {
            if value == T::zero() {
                return;
            }
            let place = dof / stride % shape[axis];
            match along.iter_mut().find(|(other, _)| *other == place) {
                Some((_, sum)) => *sum += weight * value,
                None => along.push((place, weight * value)),
            }
        });
        weight *= -T::count(degree - k) / T::count(k + 1);
    }
    let first = along.iter().map(|&(place, _)| place).min().unwrap_or(0);
    let end = along.iter().map(|&(place, _)| place + 1).max().unwrap_or(0);
    let mut values = vec![T::zero(); end - first];
    for (place, value) in along {
        values[place - first] = value;
    }
    Derivative { first, values }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{BSpline, DualDomain, Linear};
    use approx::assert_relative_eq;
    use nalgebra::vector;

    fn check<B: BasisFamily<f64, 2>>(basis: &B, expected: &[f64]) {
        let grid = Grid::new(vector![0.0, 0.0], vector![9.0, 6.0], [9, 12]).unwrap();
        let jumps = AxisJumps::new(basis, &grid, 0);
        assert_eq!(jumps.lines(), 8);
        for (found, expected) in jumps.above(4).iter().zip(expected) {
            assert_relative_eq!(found, expected, epsilon = 1e-10);
        }
        assert_eq!((jumps.above(4).len(), jumps.first(4)), (expected.len(), 4));
        // Also where splines end at a wall, lines bend nowhere: coefficients of x are the interpolation
        // points.
        let jumps = AxisJumps::new(basis, &grid, 1);
        let stride = basis.dofs(&grid)[0];
        for line in 0..jumps.lines() {
            let terms = jumps.above(line).iter().enumerate();
            let line_jump: f64 = terms
                .map(|(k, c)| c * basis.interpolation_point(&grid, (jumps.first(line) + k) * stride)[1])
                .sum();
            assert_relative_eq!(line_jump, 0.0, epsilon = 1e-11);
        }
    }

    #[test]
    fn they_are_differences_of_one_order_more_than_the_degree() {
        check(&Linear, &[1.0, -2.0, 1.0]);
        check(&DualDomain::default(), &[1.0, -2.0, 1.0]);
        check(&BSpline::<2>, &[-1.0, 3.0, -3.0, 1.0]);
        check(&BSpline::<3>, &[1.0, -4.0, 6.0, -4.0, 1.0]);
    }
}
