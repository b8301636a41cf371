//! Products of the mass matrices of single axes.

use nalgebra::SVector;

use super::Banded;
use crate::basis::BasisFamily;
use crate::grid::Grid;
use crate::quadrature::gauss_legendre;
use crate::scalar::Scalar;

/// The Kronecker product of one mass matrix for each axis: that of a tensor-product basis where evenly spread
/// material fills the grid. Solved axis by axis, at a few operations for each DOF.
#[derive(Clone, Debug)]
pub struct AxisMasses<T, const D: usize> {
    factors: [Banded<T>; D],
    shape: [usize; D],
    diagonals: [Vec<T>; D],
}

impl<T: Scalar, const D: usize> AxisMasses<T, D> {
    /// Of the functions of `basis` on the grid's cells.
    pub fn new<B: BasisFamily<T, D>>(basis: &B, grid: &Grid<T, D>) -> Self {
        let shape = basis.dofs(grid);
        let matrices: [Banded<T>; D] = std::array::from_fn(|axis| axis_mass(basis, grid, axis));
        let diagonals =
            std::array::from_fn(|axis| (0..shape[axis]).map(|i| matrices[axis].get(i, i)).collect());
        Self {
            factors: matrices.map(|mut matrix| {
                matrix.factorise();
                matrix
            }),
            shape,
            diagonals,
        }
    }

    /// One of no DOFs.
    pub fn none() -> Self {
        Self {
            factors: std::array::from_fn(|_| Banded::zeros(0, 0)),
            shape: [0; D],
            diagonals: std::array::from_fn(|_| Vec::new()),
        }
    }

    /// Bytes allocated.
    pub fn bytes(&self) -> usize {
        let numbers = |axis: usize| self.factors[axis].len() + self.diagonals[axis].capacity();
        size_of::<T>() * (0..D).map(numbers).sum::<usize>()
    }

    /// Diagonal entry of a DOF.
    pub fn diagonal(&self, mut dof: usize) -> T {
        (0..D).fold(T::one(), |product, axis| {
            let along = dof % self.shape[axis];
            dof /= self.shape[axis];
            product * self.diagonals[axis][along]
        })
    }

    /// Replaces `x` by the solution for the right-hand side `x`.
    pub fn solve(&self, x: &mut [T]) {
        let mut stride = 1;
        for axis in 0..D {
            self.factors[axis].solve_lines(x, stride);
            stride *= self.shape[axis];
        }
    }
}

/// Mass matrix of the functions along one axis: sums of those that have the same place along it, which a
/// partition of unity makes functions of that axis alone.
fn axis_mass<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    axis: usize,
) -> Banded<T> {
    let shape = basis.dofs(grid);
    let stride: usize = shape[..axis].iter().product();
    let degree = basis.degree();
    let mut matrix = Banded::zeros(shape[axis], basis.reach().min(shape[axis].saturating_sub(1)));
    let half_band = matrix.half_band();
    let rule = gauss_legendre::<T>(degree + 1);
    let half = T::one() / T::lit(2.0);
    let mut along: Vec<(usize, T)> = Vec::new();
    for cell in grid.line(axis) {
        let centre = grid.centre(&cell);
        for &(s, weight) in &rule {
            let mut x: SVector<T, D> = centre;
            x[axis] += grid.cell_size()[axis] * s * half;
            along.clear();
            basis.for_each_at_fixed_point(grid, &cell, &x, |dof, value, _| {
                let place = dof / stride % shape[axis];
                match along.iter_mut().find(|(other, _)| *other == place) {
                    Some((_, sum)) => *sum += value,
                    None => along.push((place, value)),
                }
            });
            for &(i, a) in &along {
                for &(j, b) in along.iter().filter(|&&(j, _)| j <= i && i - j <= half_band) {
                    matrix.add(i, j, weight * a * b);
                }
            }
        }
    }
    matrix
}
