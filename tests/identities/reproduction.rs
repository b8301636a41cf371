//! Least squares in one cell, on nasty layouts: what is reproduced, what is dropped, and that nothing grows
//! at the particles.

use materialpoint::scalar::Scalar;
use materialpoint::taylor::{CellFit, DEFAULT_TOLERANCE, taylor_functions};
use nalgebra::{DMatrix, SVector};
use proptest::prelude::*;

use super::layout::{Spot, cell, uneven};
use super::{config, epsilon};

/// The particles of a cell in local coordinates, with the fit prepared for them.
struct Fitted<T: Scalar, const D: usize, const NB: usize> {
    points: Vec<SVector<T, D>>,
    fit: CellFit<T, NB>,
    first: usize,
    /// Singular values of the functions' values, from `first` on, descending; in `f64` whatever `T` is.
    singular: Vec<f64>,
}

impl<T: Scalar, const D: usize, const NB: usize> Fitted<T, D, NB> {
    fn new(spots: &[Spot<D>], first: usize) -> Self {
        let local = |spot: &Spot<D>| SVector::from_fn(|a, _| T::lit(2.0 * spot[a].unit() - 1.0));
        let points: Vec<SVector<T, D>> = spots.iter().map(local).collect();
        let fit = CellFit::new(points.iter().copied(), first, T::lit(DEFAULT_TOLERANCE));
        let rows: Vec<SVector<f64, NB>> = points
            .iter()
            .map(|s| taylor_functions::<f64, D, NB>(&s.map(T::primal)))
            .collect();
        let columns = NB.min(points.len()).saturating_sub(first);
        let design = DMatrix::from_fn(points.len(), columns, |i, j| rows[i][first + j]);
        Self {
            points,
            fit,
            first,
            singular: singular_values(design, |k| size::<D>(first + k)),
        }
    }

    fn coefficients(&self, value: impl Fn(usize) -> T) -> [T; NB] {
        let samples = self
            .points
            .iter()
            .copied()
            .enumerate()
            .map(|(p, s)| (s, T::one(), value(p)));
        self.fit.coefficients(samples, T::zero())
    }

    fn evaluate(&self, coefficients: &[T; NB], p: usize) -> T {
        let psi = taylor_functions::<T, D, NB>(&self.points[p]);
        (0..NB).fold(T::zero(), |sum, k| sum + coefficients[k] * psi[k])
    }

    fn condition(&self) -> f64 {
        self.singular.first().copied().unwrap_or(1.0) / self.singular.last().copied().unwrap_or(1.0)
    }

    /// Operations behind a coefficient: a sum over particles of `NB` products of rows with up to `NB`
    /// entries.
    fn operations(&self) -> T {
        T::count(4 * NB * (self.points.len() + NB))
    }

    /// Whether every function from `first` on is in the fit.
    fn is_full(&self) -> bool {
        self.fit.functions() + self.first == NB
    }
}

/// Root mean square of function `k` over the cell.
fn size<const D: usize>(k: usize) -> f64 {
    match k {
        0 => 1.0,
        _ if k <= D => (1.0_f64 / 3.0).sqrt(),
        _ if k <= 2 * D => (1.0_f64 / 45.0).sqrt(),
        _ => 1.0 / 3.0,
    }
}

/// Singular values, descending, of the matrix with column `k` scaled so that a function with its usual root
/// mean square has length one.
fn singular_values(mut design: DMatrix<f64>, size: impl Fn(usize) -> f64) -> Vec<f64> {
    if design.is_empty() {
        return Vec::new();
    }
    let points = design.nrows() as f64;
    for (k, mut column) in design.column_iter_mut().enumerate() {
        column /= size(k) * points.sqrt();
    }
    let mut values: Vec<f64> = design.singular_values().iter().copied().collect();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

fn root_sum<T: Scalar>(values: impl Iterator<Item = T>) -> T {
    values.fold(T::zero(), |sum, v| sum + v * v).sqrt()
}

/// A polynomial of the fit's functions comes back with its coefficients.
///
/// The fit multiplies with an explicit inverse factor and its transpose (semi-normal equations), so round-off
/// counts the *square* of the condition number, although the factor itself comes from rotations. Stable least
/// squares would count it once.
fn reproduces<T: Scalar, const D: usize, const NB: usize>(
    fitted: &Fitted<T, D, NB>,
) -> Result<(), TestCaseError> {
    if !fitted.is_full() {
        return Ok(());
    }
    let first = fitted.first;
    let exact: [T; NB] = std::array::from_fn(|k| if k < first { T::zero() } else { uneven(k + 3) });
    let found = fitted.coefficients(|p| fitted.evaluate(&exact, p));
    let condition = T::lit(fitted.condition());
    let allowed = epsilon::<T>() * fitted.operations() * condition * condition;
    for k in first..NB {
        let error = (found[k] - exact[k]).abs();
        prop_assert!(
            error <= allowed,
            "function {k}: {} {}, condition {condition}",
            found[k],
            exact[k]
        );
    }
    Ok(())
}

/// A function is in the fit only if it is independent of the others, and each that clearly is, is in it.
///
/// The smallest singular value of the scaled columns is a lower bound for what is left of each.
fn drops_what_is_dependent<T: Scalar, const D: usize, const NB: usize>(
    fitted: &Fitted<T, D, NB>,
) -> Result<(), TestCaseError> {
    let rank = fitted.singular.iter().filter(|&&s| s > 1e-13).count();
    let functions = fitted.fit.functions();
    prop_assert!(
        functions <= rank,
        "{functions} functions on points of rank {rank}"
    );
    // The margin covers the rounding of a value at the very limit.
    if fitted
        .singular
        .last()
        .is_some_and(|&s| s > 1.001 * DEFAULT_TOLERANCE)
    {
        prop_assert_eq!(
            functions,
            fitted.singular.len(),
            "singular values {:?}",
            fitted.singular
        );
    }
    Ok(())
}

/// The fit is a projection of the particles' values: it never lengthens them. That is what garbage from a
/// singular system would do. At least the share `t` of each function is left, so round-off is
/// `operations epsilon / t^2` at worst.
fn nothing_grows_at_the_particles<T: Scalar, const D: usize, const NB: usize>(
    fitted: &Fitted<T, D, NB>,
) -> Result<(), TestCaseError> {
    let coefficients = fitted.coefficients(uneven);
    let given = root_sum((0..fitted.points.len()).map(uneven::<T>));
    let found = root_sum((0..fitted.points.len()).map(|p| fitted.evaluate(&coefficients, p)));
    let slack = fitted.operations() * epsilon::<T>() / T::lit(DEFAULT_TOLERANCE * DEFAULT_TOLERANCE);
    prop_assert!(found <= given * (T::one() + slack), "{given} became {found}");
    Ok(())
}

fn all<T: Scalar, const D: usize, const NB: usize>(spots: &[Spot<D>]) -> Result<(), TestCaseError> {
    for first in [0, 1] {
        let fitted = Fitted::<T, D, NB>::new(spots, first);
        reproduces(&fitted)?;
        drops_what_is_dependent(&fitted)?;
        nothing_grows_at_the_particles(&fitted)?;
    }
    Ok(())
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn fits_in_one_dimension(spots in cell::<1>(8)) {
        all::<f64, 1, 3>(&spots)?;
        all::<f32, 1, 3>(&spots)?;
        all::<f64, 1, 2>(&spots)?;
    }

    #[test]
    fn fits_in_two_dimensions(spots in cell::<2>(16)) {
        all::<f64, 2, 6>(&spots)?;
        all::<f32, 2, 6>(&spots)?;
        all::<f64, 2, 3>(&spots)?;
    }

    #[test]
    fn fits_in_three_dimensions(spots in cell::<3>(30)) {
        all::<f64, 3, 10>(&spots)?;
        all::<f32, 3, 10>(&spots)?;
    }
}
