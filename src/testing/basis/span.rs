//! Which polynomials are sums of the basis functions.
//!
//! The functions, sampled at Gauss points, are made orthonormal, and a polynomial is projected onto them:
//! what is left is the part that no coefficients reproduce. Every step is applied to the gradients too, so
//! the same projection tells what the gradients make of the polynomial. No coefficients are ever needed.

use nalgebra::SVector;

use super::BasisClaims;
use super::sample::{Sample, Visitor, slope_bound, value_error};
use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::quadrature::gauss_legendre;
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Place, Property, at_least, near};
use crate::testing::worst::Worst;

/// A function: values and gradients at the sample points.
#[derive(Clone, Debug)]
struct Sampled<T, const D: usize> {
    value: Vec<T>,
    gradient: Vec<SVector<T, D>>,
}

impl<T: Scalar, const D: usize> Sampled<T, D> {
    fn dot(&self, other: &Self) -> T {
        self.value
            .iter()
            .zip(&other.value)
            .fold(T::zero(), |sum, (&a, &b)| sum + a * b)
    }

    fn subtract(&mut self, factor: T, other: &Self) {
        self.value
            .iter_mut()
            .zip(&other.value)
            .for_each(|(a, &b)| *a -= factor * b);
        self.gradient
            .iter_mut()
            .zip(&other.gradient)
            .for_each(|(a, b)| *a -= b * factor);
    }

    fn scale(&mut self, factor: T) {
        self.value.iter_mut().for_each(|v| *v *= factor);
        self.gradient.iter_mut().for_each(|g| *g *= factor);
    }

    /// Takes the part in the span of the orthonormal `others` away; twice, since once leaves round-off of the
    /// size of what was taken away.
    fn project_out(&mut self, others: &[Self]) {
        for _ in 0..2 {
            for other in others {
                let part = self.dot(other);
                self.subtract(part, other);
            }
        }
    }

    fn mean_square(&self) -> T {
        self.dot(self) / T::count(self.value.len())
    }
}

pub(super) fn check<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    claims: &BasisClaims,
) -> Result<(), Failure> {
    let points = gauss_points(grid, claims.reproduces.max(basis.degree()) + 2);
    let functions = sample(basis, grid, &points)?;
    // At a point every function that has a value there brings its own error.
    let allowed = T::count(overlap(&functions)) * value_error(basis, grid);
    let orthonormal = orthonormal(functions);
    for degree in 0..=claims.reproduces + 1 {
        let mut worst = Worst::new();
        for axis in 0..D {
            let mut rest = power(grid, &points, axis, degree);
            rest.project_out(&orthonormal);
            worst.record(rest.mean_square().sqrt(), allowed, || Place::Everywhere);
            if degree == 1 {
                let slope = allowed * slope_bound::<T, D, B>(basis);
                gradient_of_linear(grid, &rest, slope, claims)?;
            }
        }
        worst.judge(Property::Reproduces(degree), degree <= claims.reproduces)?;
    }
    near(
        Property::DegreeAsSaid,
        || Place::Everywhere,
        T::count(claims.reproduces),
        T::count(basis.degree()),
        T::zero(),
    )
}

fn gradient_of_linear<T: Scalar, const D: usize>(
    grid: &Grid<T, D>,
    rest: &Sampled<T, D>,
    allowed: T,
    claims: &BasisClaims,
) -> Result<(), Failure> {
    let mut worst = Worst::new();
    for gradient in &rest.gradient {
        for a in 0..D {
            let in_cells = gradient[a] * grid.cell_size()[a];
            worst.record(in_cells, allowed, || Place::Everywhere);
        }
    }
    worst.judge(Property::GradientOfLinearField, claims.gradient_reproduces_linear)
}

/// `n` Gauss points per cell and axis.
fn gauss_points<T: Scalar, const D: usize>(grid: &Grid<T, D>, n: usize) -> Vec<(Cell<D>, SVector<T, D>)> {
    let line = gauss_legendre::<T>(n);
    let mut points = Vec::new();
    for number in 0..grid.cell_count() {
        let cell = grid.cell(number);
        let centre = grid.centre(&cell);
        for mut index in 0..n.pow(D as u32) {
            let x = SVector::from_fn(|a, _| {
                let s = line[index % n].0;
                index /= n;
                centre[a] + s * grid.cell_size()[a] / T::lit(2.0)
            });
            points.push((cell, x));
        }
    }
    points
}

fn sample<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    points: &[(Cell<D>, SVector<T, D>)],
) -> Result<Vec<Sampled<T, D>>, Failure> {
    let empty = Sampled {
        value: vec![T::zero(); points.len()],
        gradient: vec![SVector::zeros(); points.len()],
    };
    let mut functions = vec![empty; basis.dof_count(grid)];
    for (k, (cell, x)) in points.iter().enumerate() {
        let here = Sample::new(basis, grid, cell, x, Visitor::Moving)?;
        for (dof, function) in functions.iter_mut().enumerate() {
            function.value[k] = here.value[dof];
            function.gradient[k] = here.gradient[dof];
        }
    }
    for (dof, function) in functions.iter().enumerate() {
        let reached = function.value.iter().fold(T::zero(), |m, v| m.max(v.abs()));
        let place = || Place::dof(dof, grid.min());
        at_least(Property::EveryDofReached, place, T::default_epsilon(), reached)?;
    }
    Ok(functions)
}

/// Largest number of functions that have a value at one point.
fn overlap<T: Scalar, const D: usize>(functions: &[Sampled<T, D>]) -> usize {
    let points = functions.first().map_or(0, |function| function.value.len());
    let here = |k: usize| {
        functions
            .iter()
            .filter(|function| function.value[k] != T::zero())
            .count()
    };
    (0..points).map(here).max().unwrap_or(0)
}

/// Gram-Schmidt; a function that depends on the ones before it is left out.
fn orthonormal<T: Scalar, const D: usize>(functions: Vec<Sampled<T, D>>) -> Vec<Sampled<T, D>> {
    let mut result = Vec::with_capacity(functions.len());
    for mut function in functions {
        let before = function.mean_square();
        function.project_out(&result);
        // The squares of norms are compared: a share of the root of epsilon in norm.
        if function.mean_square() > before * T::default_epsilon() {
            function.scale(T::one() / function.dot(&function).sqrt());
            result.push(function);
        }
    }
    result
}

/// `xi^degree` with `xi` from -1 to 1 along an axis of the grid.
fn power<T: Scalar, const D: usize>(
    grid: &Grid<T, D>,
    points: &[(Cell<D>, SVector<T, D>)],
    axis: usize,
    degree: usize,
) -> Sampled<T, D> {
    let half = (grid.max()[axis] - grid.min()[axis]) / T::lit(2.0);
    let raise = |xi: T, n: usize| (0..n).fold(T::one(), |product, _| product * xi);
    let xi = |x: &SVector<T, D>| (x[axis] - grid.min()[axis]) / half - T::one();
    let slope = |x: &SVector<T, D>| match degree {
        0 => T::zero(),
        n => T::count(n) * raise(xi(x), n - 1) / half,
    };
    Sampled {
        value: points.iter().map(|(_, x)| raise(xi(x), degree)).collect(),
        gradient: points
            .iter()
            .map(|(_, x)| SVector::from_fn(|a, _| if a == axis { slope(x) } else { T::zero() }))
            .collect(),
    }
}
