//! Solving with the mass matrix of a lattice.

use nalgebra::SVector;

use super::{AxisMasses, Lattice, Penalty};
use crate::basis::BasisFamily;
use crate::grid::Grid;
use crate::scalar::Scalar;
use crate::simd::with_features;

/// Iterations after which the solution is taken as it is. Ten to thirty are usual.
const MOST_ITERATIONS: usize = 200;

/// Conjugate gradients for [`Lattice`] matrices of masses, one component of the right-hand side after the
/// other.
///
/// The preconditioner is $S K S$: $K$ the Kronecker product of the axes' mass matrices ([`AxisMasses`]), $S$
/// diagonal and such that the product has the diagonal of the matrix. Where material fills the grid evenly it
/// is nearly the inverse; elsewhere $S$ takes in how much of it a DOF sees (Loli, Sangalli & Tani 2022, "Easy
/// and efficient preconditioning of the isogeometric mass matrix"). Where a [`Penalty`] ties DOFs, what is
/// smooth and what is not weigh the other way round, and the diagonal alone takes half the iterations. The
/// start is the lumped solution, exact for rigid translations, and at the end each component that nothing
/// holds is shifted so that the sum of the residual vanishes: momentum is kept to round-off whatever the
/// tolerance.
#[derive(Clone, Debug)]
pub struct ConjugateGradients<T, const D: usize> {
    axes: AxisMasses<T, D>,
    /// Inverse of `S`; zero for DOFs that are tied, and for those that have no neighbours, which the start
    /// solves for.
    scale: Vec<T>,
    sums: Vec<T>,
    /// Of matrix and penalty.
    diagonal: Vec<T>,
    /// One over it for DOFs that the penalty ties; zero for others.
    tied: Vec<T>,
    /// Whether a DOF's component is solved for: one or zero.
    free: [Vec<T>; D],
    solution: [Vec<T>; D],
    residual: [Vec<T>; D],
    direction: [Vec<T>; D],
    work: Vec<T>,
    held: [bool; D],
    iterations: usize,
}

impl<T: Scalar, const D: usize> ConjugateGradients<T, D> {
    /// For matrices of the DOFs of `basis` on `grid`.
    #[inline(never)]
    pub fn new<B: BasisFamily<T, D>>(basis: &B, grid: &Grid<T, D>) -> Self {
        Self::with(AxisMasses::new(basis, grid), basis.dof_count(grid))
    }

    /// For no DOF.
    pub fn none() -> Self {
        Self::with(AxisMasses::none(), 0)
    }

    fn with(axes: AxisMasses<T, D>, count: usize) -> Self {
        let numbers = || vec![T::zero(); count];
        let vectors = || std::array::from_fn(|_| numbers());
        Self {
            axes,
            scale: numbers(),
            sums: numbers(),
            diagonal: numbers(),
            tied: numbers(),
            free: vectors(),
            solution: vectors(),
            residual: vectors(),
            direction: vectors(),
            work: numbers(),
            held: [false; D],
            iterations: 0,
        }
    }

    /// Bytes allocated.
    pub fn bytes(&self) -> usize {
        self.axes.bytes() + size_of::<T>() * (5 + 4 * D) * self.work.len()
    }

    /// Sum of all entries of the matrix.
    pub fn total(&self) -> T {
        self.sums.iter().fold(T::zero(), |sum, &s| sum + s)
    }

    /// Iterations of the last solution.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Takes in a matrix and a penalty to be added to it.
    #[inline(never)]
    pub fn prepare(&mut self, matrix: &Lattice<T>, penalty: &Penalty<T, D>) {
        matrix.row_sums(&mut self.sums);
        self.diagonal.copy_from_slice(matrix.diagonal());
        penalty.add_diagonal(&mut self.diagonal);
        let largest = self.diagonal.iter().fold(T::zero(), |m, &x| m.max(x.abs()));
        let negligible = largest * T::default_epsilon() * T::default_epsilon();
        let rounding = T::default_epsilon() * T::lit(64.0);
        for (i, &mass) in self.diagonal.iter().enumerate() {
            if mass.abs() <= negligible {
                self.sums[i] = T::zero();
            }
            let coupled = mass > negligible && (self.sums[i] - mass).abs() > mass * rounding;
            let tied = coupled && mass > matrix.diagonal()[i];
            self.scale[i] = if coupled && !tied {
                (self.axes.diagonal(i) / mass).sqrt()
            } else {
                T::zero()
            };
            self.tied[i] = if tied { T::one() / mass } else { T::zero() };
        }
        self.release();
    }

    /// Holds nothing.
    pub fn release(&mut self) {
        self.held = [false; D];
        for free in &mut self.free {
            free.fill(T::one());
        }
    }

    /// Holds component `axis` of a DOF at what the right-hand side has there.
    pub fn hold(&mut self, dof: usize, axis: usize) {
        self.held[axis] = true;
        self.free[axis][dof] = T::zero();
    }

    /// Replaces `right` by the solution of `(matrix + penalty) x = right`. DOFs without mass get zero.
    pub fn solve(&mut self, matrix: &Lattice<T>, penalty: &Penalty<T, D>, right: &mut [SVector<T, D>]) {
        self.iterations = 0;
        for axis in 0..D {
            with_features(
                #[inline(always)]
                || self.solve_component(matrix, penalty, right, axis),
            );
        }
    }

    #[inline(always)]
    fn solve_component(
        &mut self,
        matrix: &Lattice<T>,
        penalty: &Penalty<T, D>,
        right: &mut [SVector<T, D>],
        axis: usize,
    ) {
        let aim = self.start(matrix, penalty, right, axis);
        let mut size = self.precondition(axis);
        self.direction[axis].copy_from_slice(&self.work);
        for iteration in 0..MOST_ITERATIONS {
            if size <= aim || !size.is_finite() {
                break;
            }
            self.iterations = self.iterations.max(iteration + 1);
            matrix.multiply(&self.direction[axis], &mut self.work);
            penalty.add_product(&self.direction[axis], &mut self.work);
            let curvature = dot(&self.direction[axis], &self.work);
            // A fitted density may be negative somewhere, and what few particles see need not determine all
            // functions; what is found so far is then the best there is.
            if curvature <= self.negligible_curvature(axis) {
                break;
            }
            let step = size / curvature;
            let (solution, residual) = (&mut self.solution[axis], &mut self.residual[axis]);
            let numbers = self.direction[axis].iter().zip(&self.work).zip(&self.free[axis]);
            for ((x, r), ((&p, &q), &free)) in solution.iter_mut().zip(residual).zip(numbers) {
                *x += step * p;
                *r -= step * q * free;
            }
            let before = std::mem::replace(&mut size, self.precondition(axis));
            let share = size / before;
            for (p, &z) in self.direction[axis].iter_mut().zip(&self.work) {
                *p = z + share * *p;
            }
        }
        let shift = if self.held[axis] {
            T::zero()
        } else {
            self.shift(axis)
        };
        for (i, right) in right.iter_mut().enumerate() {
            let x = self.solution[axis][i];
            right[axis] = if self.is_coupled(i) { x + shift } else { x };
        }
    }

    /// First guess and its residual; returns the square below which the preconditioned residual is to fall.
    ///
    /// The guess is the lumped solution, and of tied DOFs, whose own mass may be next to nothing, the
    /// translation of the whole and what it leaves over the diagonal.
    #[inline(always)]
    fn start(
        &mut self,
        matrix: &Lattice<T>,
        penalty: &Penalty<T, D>,
        right: &[SVector<T, D>],
        axis: usize,
    ) -> T {
        let translation = self.translation(right, axis);
        let solution = &mut self.solution[axis];
        let mut scale = T::zero();
        for (i, x) in solution.iter_mut().enumerate() {
            let (free, value, sum) = (self.free[axis][i] > T::zero(), right[i][axis], self.sums[i]);
            *x = if !free {
                value
            } else if self.tied[i] > T::zero() {
                translation + (value - sum * translation) * self.tied[i]
            } else if sum != T::zero() {
                value / sum
            } else {
                T::zero()
            };
            scale += (*x * *x * sum).abs();
        }
        matrix.multiply(solution, &mut self.work);
        penalty.add_product(solution, &mut self.work);
        let residual = self.residual[axis].iter_mut().zip(&self.work);
        for (i, (r, &product)) in residual.enumerate() {
            let coupled = self.scale[i] > T::zero() || self.tied[i] > T::zero();
            *r = if coupled {
                (right[i][axis] - product) * self.free[axis][i]
            } else {
                T::zero()
            };
        }
        // Five sixths of the digits: far below what a step's own errors are.
        let tolerance = T::default_epsilon().powf(T::lit(5.0) / T::lit(6.0));
        scale * tolerance * tolerance
    }

    /// Curvature along the direction that is round-off.
    #[inline(always)]
    fn negligible_curvature(&self, axis: usize) -> T {
        let direction = &self.direction[axis];
        let largest = self.diagonal.iter().zip(direction);
        let sum = largest.fold(T::zero(), |sum, (&d, &p)| sum + d * p * p);
        sum * T::default_epsilon()
    }

    /// Whether a DOF has neighbours to be solved for with it.
    #[inline(always)]
    fn is_coupled(&self, i: usize) -> bool {
        self.scale[i] > T::zero() || self.tied[i] > T::zero()
    }

    /// Velocity of the whole, but for what is held.
    #[inline(always)]
    fn translation(&self, right: &[SVector<T, D>], axis: usize) -> T {
        let (mut momentum, mut mass) = (T::zero(), T::zero());
        for ((right, &sum), &free) in right.iter().zip(&self.sums).zip(&self.free[axis]) {
            momentum += right[axis] * free;
            mass += sum * free;
        }
        if mass > T::zero() {
            momentum / mass
        } else {
            T::zero()
        }
    }

    /// Preconditioned residual, left in `work`; returns its product with the residual.
    #[inline(always)]
    fn precondition(&mut self, axis: usize) -> T {
        let (residual, work) = (&self.residual[axis], &mut self.work);
        for ((w, &r), &scale) in work.iter_mut().zip(residual).zip(&self.scale) {
            *w = r * scale;
        }
        self.axes.solve(work);
        let factors = self.scale.iter().zip(&self.tied).zip(&self.free[axis]);
        for ((w, &r), ((&scale, &tied), &free)) in work.iter_mut().zip(residual).zip(factors) {
            *w = (*w * scale + r * tied) * free;
        }
        dot(residual, work)
    }

    /// What, added to all coupled DOFs, makes the sum of the residual vanish.
    #[inline(always)]
    fn shift(&self, axis: usize) -> T {
        let (mut left, mut mass) = (T::zero(), T::zero());
        for (i, &r) in self.residual[axis].iter().enumerate() {
            if self.is_coupled(i) {
                left += r;
                mass += self.sums[i];
            }
        }
        if mass > T::zero() { left / mass } else { T::zero() }
    }
}

/// Sum of the products, in eight chains: one would wait for itself.
#[inline(always)]
fn dot<T: Scalar>(a: &[T], b: &[T]) -> T {
    let (a, a_rest) = a.as_chunks::<8>();
    let (b, b_rest) = b.as_chunks::<8>();
    let mut sums = [T::zero(); 8];
    for (a, b) in a.iter().zip(b) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest = a_rest.iter().zip(b_rest).fold(T::zero(), |s, (&a, &b)| s + a * b);
    sums.iter().fold(rest, |s, &x| s + x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::BSpline;
    use crate::particles::lattice;
    use nalgebra::{DMatrix, DVector, vector};

    const BASIS: BSpline<2> = BSpline::<2>;

    fn grid(cells: usize) -> Grid<f64, 2> {
        Grid::new(vector![0.0, 0.0], vector![1.0, 1.0], [cells; 2]).unwrap()
    }

    /// Of particles in those places that `keep` says, on a lattice that is not even.
    fn matrix(grid: &Grid<f64, 2>, keep: impl Fn(&SVector<f64, 2>) -> bool) -> Lattice<f64> {
        let mut matrix = Lattice::zeros(BASIS.dofs(grid), 2);
        for (x, volume) in lattice(grid, grid.min(), grid.max(), [3; 2]) {
            let x = vector![x[0] - 0.02 * (9.0 * x[1]).sin().powi(2) * x[0], x[1]];
            if !keep(&x) {
                continue;
            }
            let cell = grid.locate(&x).unwrap();
            BASIS.for_each(grid, &cell, &x, |i, a, _| {
                BASIS.for_each(grid, &cell, &x, |j, b, _| {
                    if j <= i {
                        matrix.add(i, j, volume * a * b);
                    }
                });
            });
        }
        matrix
    }

    /// Across all faces between cells whose middles are kept, of which some are partly filled.
    fn ties(grid: &Grid<f64, 2>, keep: impl Fn(&SVector<f64, 2>) -> bool) -> Penalty<f64, 2> {
        let mut penalty = Penalty::new(&BASIS, grid);
        let cells = grid.cells().map(|n| n as u32);
        let middle = |cell: [u32; 2]| keep(&grid.centre(&cell));
        for (i, j) in (0..cells[0]).flat_map(|i| (0..cells[1]).map(move |j| (i, j))) {
            if i + 1 < cells[0] && middle([i, j]) {
                penalty.add_face(grid, &[i, j], 0, 1e-3 * grid.cell_volume());
            }
            if j + 1 < cells[1] && middle([i, j]) {
                penalty.add_face(grid, &[i, j], 1, 1e-3 * grid.cell_volume());
            }
        }
        penalty
    }

    fn dense(matrix: &Lattice<f64>, penalty: &Penalty<f64, 2>) -> DMatrix<f64> {
        let n = matrix.order();
        let mut dense = DMatrix::zeros(n, n);
        let mut unit = vec![0.0; n];
        for i in 0..n {
            unit[i] = 1.0;
            let mut column = vec![0.0; n];
            matrix.multiply(&unit, &mut column);
            penalty.add_product(&unit, &mut column);
            dense.set_column(i, &DVector::from_vec(column));
            unit[i] = 0.0;
        }
        dense
    }

    fn rough(i: usize) -> SVector<f64, 2> {
        vector![(i * 7 % 5) as f64 - 1.3, (i * i % 7) as f64 - 2.9]
    }

    #[test]
    fn it_solves_what_a_dense_factorisation_solves_also_for_a_body_that_fills_little_and_is_held() {
        let grid = grid(9);
        let matrix = matrix(&grid, |x| (x[0] - 0.1).hypot(x[1] - 0.4) < 0.37);
        let mut gradients = ConjugateGradients::new(&BASIS, &grid);
        let penalty = ties(&grid, |x| (x[0] - 0.1).hypot(x[1] - 0.4) < 0.37);
        gradients.prepare(&matrix, &penalty);
        let mut full = dense(&matrix, &penalty);
        let n = matrix.order();
        let mass = matrix.diagonal().to_vec();
        let mut right: Vec<_> = (0..n).map(|i| rough(i) * mass[i]).collect();
        let mut known = DVector::from_fn(n, |i, _| right[i][0]);
        // Component 0 is held on the left.
        for dof in (0..n).filter(|dof| dof % 11 == 0) {
            gradients.hold(dof, 0);
            right[dof][0] = 0.25;
            known -= full.column(dof) * 0.25;
            full.row_mut(dof).fill(0.0);
            full.column_mut(dof).fill(0.0);
        }
        let mut exact = Vec::new();
        for i in 0..n {
            let held = i % 11 == 0;
            if full[(i, i)] == 0.0 {
                full[(i, i)] = 1.0;
                known[i] = if held { 0.25 } else { 0.0 };
            }
        }
        let solution = full.lu().solve(&known).unwrap();
        exact.extend(solution.iter().copied());
        gradients.solve(&matrix, &penalty, &mut right);
        for i in 0..n {
            assert!(
                (right[i][0] - exact[i]).abs() < 1e-9,
                "{i}: {} {}",
                right[i][0],
                exact[i]
            );
        }
        assert!(gradients.iterations() < 60, "{}", gradients.iterations());
    }

    #[test]
    fn a_translation_needs_no_iteration_and_the_sum_is_kept_to_round_off() {
        let grid = grid(8);
        let matrix = matrix(&grid, |x| x[0] + x[1] < 1.1);
        let mut gradients = ConjugateGradients::new(&BASIS, &grid);
        let penalty = ties(&grid, |x| x[0] + x[1] < 1.1);
        gradients.prepare(&matrix, &penalty);
        let n = matrix.order();
        let mut sums = vec![0.0; n];
        matrix.row_sums(&mut sums);
        let mut x: Vec<_> = sums.iter().map(|&m| vector![3.0, -0.5] * m).collect();
        gradients.solve(&matrix, &penalty, &mut x);
        assert_eq!(gradients.iterations(), 0);
        for i in (0..n).filter(|&i| sums[i] > 0.0) {
            assert!((x[i] - vector![3.0, -0.5]).norm() < 1e-14);
        }
        let mut x: Vec<_> = (0..n).map(|i| rough(i) * sums[i]).collect();
        let before: SVector<f64, 2> = x.iter().sum();
        gradients.solve(&matrix, &penalty, &mut x);
        let after: SVector<f64, 2> = x.iter().zip(&sums).map(|(x, &m)| x * m).sum();
        assert!((after - before).norm() < 1e-13, "{after} {before}");
    }

    #[test]
    fn iterations_do_not_grow_with_the_grid() {
        for cells in [8, 40] {
            let grid = grid(cells);
            let matrix = matrix(&grid, |_| true);
            let mut gradients = ConjugateGradients::new(&BASIS, &grid);
            let penalty = Penalty::none();
            gradients.prepare(&matrix, &penalty);
            let mut x: Vec<_> = (0..matrix.order()).map(rough).collect();
            gradients.solve(&matrix, &penalty, &mut x);
            assert!(
                (5..60).contains(&gradients.iterations()),
                "{}",
                gradients.iterations()
            );
        }
    }
}
