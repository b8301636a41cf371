//! Momenta and masses of the DOFs, four particles at a time or from fits of densities made and integrated for four cells at a time.
//!
//! Apart from the stepper, because nothing here knows of a law or a phase: it is compiled once for all of them.

use nalgebra::SVector;

use super::Dofs;
use super::lanes::{Bodies, Fits, at_fixed_points};
use super::matrix::MassMatrix;
use super::spans::{Spans, share};
use crate::basis::BasisFamily;
use crate::grid::Grid;
use crate::mass::banded_row;
use crate::parallel::{Windows, add_up, each_span};
use crate::reconstruction::{Cloud, Densities, Reconstruction};
use crate::scalar::Scalar;

/// What is fitted, and where it goes.
pub(super) struct ByFour<'a, T, const D: usize, B, R> {
    pub(super) basis: &'a B,
    pub(super) reconstruction: &'a R,
    pub(super) cloud: Cloud<'a, T, D>,
    pub(super) masses: &'a [T],
    pub(super) velocities: &'a [SVector<T, D>],
    pub(super) spans: &'a mut Spans<T, D>,
    pub(super) dofs: &'a mut Dofs<T, D>,
}

impl<'a, T: Scalar, const D: usize, B: BasisFamily<T, D>, R: Reconstruction<T, D>> ByFour<'a, T, D, B, R> {
    fn densities(&self) -> Densities<'a, T, D> {
        Densities {
            masses: self.masses,
            velocities: self.velocities,
            volumes: self.cloud.volumes,
        }
    }

    /// Momentum, and the row sums of the mass.
    #[inline(never)]
    pub(super) fn lump(self) {
        let (basis, reconstruction, cloud) = (self.basis, self.reconstruction, &self.cloud);
        let grid = cloud.grid;
        let density = self.densities();
        let occupied = cloud.bins.occupied();
        let (lumped, momentum) = self.dofs.lumped_mut();
        let Spans {
            cells: spans,
            lengths,
            scalars,
            vectors,
            ..
        } = self.spans;
        let (span, parallel) = share::<D>(spans, occupied.len(), lengths[1]);
        let work = (
            occupied,
            Windows::new(spans, scalars, lumped, 1),
            Windows::new(spans, vectors, momentum, 1),
        );
        each_span(parallel, span, work, &|place, (cells, mass, momentum)| {
            let ((first, mass), (_, momentum)) = (mass.one(), momentum.one());
            let momentum = &mut momentum[..mass.len()];
            let fits = Fits {
                moving: basis,
                reconstruction,
                cloud,
                cells: place..place + cells.len(),
            };
            let mut sink = |i: usize, m, q| {
                mass[i - first] += m;
                momentum[i - first] += q;
            };
            at_fixed_points!(B, basis, grid, integrate_densities(fits, &density, &mut sink));
        });
        add_up(spans, scalars, lumped, 1);
        add_up(spans, vectors, momentum, 1);
    }

    /// Momentum, and the mass matrix of one dimension.
    #[inline(never)]
    pub(super) fn fill_band(self) {
        let half_band = self.dofs.matrix.band_mut().half_band();
        let (basis, reconstruction, cloud) = (self.basis, self.reconstruction, &self.cloud);
        let grid = cloud.grid;
        let density = self.densities();
        let occupied = cloud.bins.occupied();
        let (rows, momentum) = self.dofs.band_mut();
        let Spans {
            cells: spans,
            lengths,
            matrices,
            vectors,
            ..
        } = self.spans;
        let (span, parallel) = share::<D>(spans, occupied.len(), lengths[1]);
        let work = (
            occupied,
            Windows::new(spans, matrices, rows, half_band + 1),
            Windows::new(spans, vectors, momentum, 1),
        );
        each_span(parallel, span, work, &|place, (cells, rows, momentum)| {
            let ((first, rows), (_, momentum)) = (rows.one(), momentum.one());
            let fits = Fits {
                moving: basis,
                reconstruction,
                cloud,
                cells: place..place + cells.len(),
            };
            // By value: references to the slices would be read anew for each DOF.
            let mut sink = move |i: usize, q: SVector<T, D>| momentum[i - first] += q;
            let mut matrix = move |i: usize, j: usize, mass| {
                banded_row(rows, i - first, half_band)[half_band + j - i] += mass;
            };
            at_fixed_points!(
                B,
                basis,
                grid,
                integrate_pairs(fits, &density, &mut sink, &mut matrix)
            );
        });
        add_up(spans, matrices, rows, half_band + 1);
        add_up(spans, vectors, momentum, 1);
    }

    /// Momentum, and the mass matrix beyond one dimension.
    #[inline(never)]
    pub(super) fn fill_lattice(self) {
        let density = self.densities();
        let Dofs { matrix, velocity, .. } = self.dofs;
        matrix.clear();
        velocity.fill(SVector::zeros());
        let fits = Fits {
            moving: self.basis,
            reconstruction: self.reconstruction,
            cloud: &self.cloud,
            cells: 0..self.cloud.bins.occupied().len(),
        };
        let mut sink = |i: usize, q: SVector<T, D>| velocity[i] += q;
        let mut pairs = |i: usize, j: usize, mass| matrix.add(i, j, mass);
        at_fixed_points!(
            B,
            self.basis,
            self.cloud.grid,
            integrate_pairs(fits, &density, &mut sink, &mut pairs)
        );
    }
}

/// Adds the particles' masses to those of the DOFs from `first` on.
#[inline(never)]
pub(super) fn add_masses<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    bodies: Bodies<'_, T, D>,
    first: usize,
    mass: &mut [T],
) {
    let mut sink = |i: usize, m| mass[i - first] += m;
    at_fixed_points!(B, basis, grid, sum_masses(bodies, &mut sink));
}

/// Adds the particles' momenta to those of the DOFs.
#[inline(never)]
pub(super) fn add_momenta<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    bodies: Bodies<'_, T, D>,
    velocities: &[SVector<T, D>],
    momentum: &mut [SVector<T, D>],
) {
    let mut sink = |i: usize, q| momentum[i] += q;
    at_fixed_points!(B, basis, grid, sum_momenta(bodies, velocities, &mut sink));
}

/// Adds the particles' masses to the consistent matrix.
#[inline(never)]
pub(super) fn add_pairs<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    bodies: Bodies<'_, T, D>,
    matrix: &mut MassMatrix<T, D>,
) {
    let mut sink = |i: usize, j: usize, mass| matrix.add(i, j, mass);
    at_fixed_points!(B, basis, grid, sum_pairs(bodies, &mut sink));
}
