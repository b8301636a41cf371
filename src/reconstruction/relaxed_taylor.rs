//! Relaxed Taylor least squares.

use std::ops::Range;

use super::taylor::local;
use super::{Cloud, Patch, Point, Reconstruction, Shepard, Taylor};
use crate::field::Field;
use crate::scalar::Scalar;
use crate::taylor::{CellFit, taylor_functions};

/// Share of the unseen part of a particle's value that a step takes away.
const DEFAULT_RELAXATION: f64 = 0.1;

/// Taylor least squares for long runs, our own: published TLS gains energy wherever particles cross cell edges
/// or do not lie evenly in their cells.
///
/// Four things together: mass and momentum of the DOFs straight from the particles; their consistent mass matrix in both the
/// acceleration and the velocity; the stress by the free fit and Gauss quadrature, as published; and in every step each
/// particle's stress and velocity a little nearer to its cell's fit,
///
/// $$q_p \mathrel{+}= \beta(\hat q(x_p) - q_p).$$
///
/// Particles carry more than a cell's polynomial sees. What the fit does not see does no work now, and returns when
/// particles cross. The fit of the velocity is weighted with the masses: it keeps the momentum exactly and never raises the
/// kinetic energy, because it is a projection in the very product that measures it. The stress of a law with a
/// state of its own (a deformation, plastic history) is bound to that state and not relaxed.
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Debug)]
pub struct RelaxedTaylor<T, const D: usize, const NB: usize> {
    taylor: Taylor<T, D, NB>,
    relaxation: T,
}

impl<T: Scalar, const D: usize, const NB: usize> RelaxedTaylor<T, D, NB> {
    /// For a basis of degree `degree`, with a relaxation of 0.1 a step.
    pub fn for_degree(degree: usize) -> Self {
        Self {
            taylor: Taylor::for_degree(degree),
            relaxation: T::lit(DEFAULT_RELAXATION),
        }
    }

    /// With another share `relaxation` of the unseen part, from 0 (none) to 1 (all), taken away in each step.
    #[must_use]
    pub fn with_relaxation(mut self, relaxation: T) -> Self {
        self.relaxation = relaxation;
        self
    }

    /// As [`Taylor::with_tolerance`].
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: T) -> Self {
        self.taylor = self.taylor.with_tolerance(tolerance);
        self
    }

    /// Moves the values of one cell's particles towards `fit`.
    fn relax_cell<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        (cell, patch): (usize, &Patch<T, D>),
        fit: &CellFit<T, NB>,
        weight: impl Fn(usize) -> T,
        values: &mut [Q],
    ) {
        let samples = local(cloud, cell, patch).map(|(p, s)| (s, weight(p), values[p]));
        let coefficients = fit.coefficients(samples, Q::zero());
        for (p, s) in local(cloud, cell, patch) {
            let psi = taylor_functions::<T, D, NB>(&s);
            let mut unseen = values[p].scaled(-T::one());
            for k in (0..NB).rev() {
                unseen.add_scaled(psi[k], coefficients[k]);
            }
            values[p].add_scaled(self.relaxation, unseen);
        }
    }
}

impl<T: Scalar, const D: usize, const NB: usize> Reconstruction<T, D> for RelaxedTaylor<T, D, NB> {
    const FIELDS_AT_PARTICLES: bool = false;
    const AMOUNTS_AT_PARTICLES: bool = true;
    const PARTICLE_MATRIX: bool = true;
    const BY_CELLS: bool = true;
    const RELAXES: bool = true;

    fn prepare(&mut self, cloud: &Cloud<'_, T, D>) {
        self.taylor.prepare(cloud);
    }

    #[inline(always)]
    fn integrate<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        self.taylor.integrate(cloud, value, sink);
    }

    #[inline(always)]
    fn integrate_conserved<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        Shepard.integrate_conserved(cloud, amount, sink);
    }

    #[inline(always)]
    fn integrate_cells<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        self.taylor.integrate_cells(cloud, cells, value, sink);
    }

    fn relax<Q: Field<T>>(&mut self, cloud: &Cloud<'_, T, D>, weights: Option<&[T]>, values: &mut [Q]) {
        for (cell, fits) in self.taylor.each_cell(cloud) {
            let place = (cell, &fits.patch);
            match weights {
                None => self.relax_cell(cloud, place, &fits.free, |_| T::one(), values),
                Some(weights) => {
                    let points = local(cloud, cell, &fits.patch).map(|(p, s)| (s, weights[p]));
                    let fit = CellFit::weighted(points, 0, self.taylor.tolerance());
                    self.relax_cell(cloud, place, &fit, |p| weights[p], values);
                }
            }
        }
    }

    fn reduced_cells(&self) -> usize {
        Reconstruction::<T, D>::reduced_cells(&self.taylor)
    }

    fn bytes(&self) -> usize {
        Reconstruction::<T, D>::bytes(&self.taylor)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use nalgebra::vector;

    use super::*;
    use crate::grid::Grid;
    use crate::particles::Bins;

    /// Momentum and kinetic energy of unequal masses before and after: the one is kept, the other never raised, and a
    /// velocity that the fit sees is left alone.
    #[test]
    fn a_weighted_relaxation_keeps_the_momentum_and_never_raises_the_energy() {
        let grid = Grid::new(vector![0.0], vector![3.0], [3]).unwrap();
        let positions: Vec<_> = (0..17).map(|p| vector![0.05 + 0.17 * f64::from(p)]).collect();
        let mass: Vec<f64> = (0..17).map(|p| 1.0 + f64::from(p * 7 % 5)).collect();
        let volumes = vec![0.1; 17];
        let bins = Bins::new(&grid, &positions).unwrap();
        let cloud = Cloud::new(&grid, &bins, &positions, &volumes).unwrap();
        let momentum = |v: &[f64]| mass.iter().zip(v).map(|(m, v)| m * v).sum::<f64>();
        let energy = |v: &[f64]| mass.iter().zip(v).map(|(m, v)| m * v * v).sum::<f64>();
        for share in [0.1, 0.7, 1.0] {
            let mut fit = RelaxedTaylor::<f64, 1, 3>::for_degree(2).with_relaxation(share);
            fit.prepare(&cloud);
            let rough: Vec<f64> = (0..17).map(|p| f64::from(p * 11 % 7) - 2.0).collect();
            let mut v = rough.clone();
            fit.relax(&cloud, Some(&mass), &mut v);
            assert_relative_eq!(momentum(&v), momentum(&rough), max_relative = 1e-14);
            assert!(energy(&v) < 0.99 * energy(&rough));
            let smooth: Vec<f64> = positions.iter().map(|x| 1.0 + x[0] - 0.3 * x[0] * x[0]).collect();
            let mut v = smooth.clone();
            fit.relax(&cloud, Some(&mass), &mut v);
            for (found, expected) in v.iter().zip(&smooth) {
                assert_relative_eq!(found, expected, epsilon = 1e-13);
            }
        }
    }
}
