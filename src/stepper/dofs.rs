//! What is kept for the DOFs of one phase.

use nalgebra::SVector;

use super::matrix::MassMatrix;
use super::series::Series;
use super::velocity::sum;
use crate::basis::BasisFamily;
use crate::field::MassMomentum;
use crate::grid::Grid;
use crate::mass::Divisor;
use crate::scalar::Scalar;

/// Data of the DOFs, allocated once for each window.
#[derive(Clone, Debug)]
pub(super) struct Dofs<T, const D: usize> {
    /// Lumped mass of the particles.
    pub(super) mass: Vec<T>,
    /// Force, then acceleration.
    pub(super) force: Vec<SVector<T, D>>,
    /// Momentum, then velocity.
    pub(super) velocity: Vec<SVector<T, D>>,
    /// Row sums of the reconstructed mass; empty where the particles' lumped mass or the matrix serves.
    pub(super) lumped: Vec<T>,
    /// Consistent mass; of order zero where it is not used.
    pub(super) matrix: MassMatrix<T, D>,
    /// What the terms of a series are summed in.
    pub(super) series: Option<Box<Series<T, D>>>,
}

impl<T: Scalar, const D: usize> Dofs<T, D> {
    /// Of no DOF.
    pub(super) fn none() -> Self {
        Self {
            mass: Vec::new(),
            force: Vec::new(),
            velocity: Vec::new(),
            lumped: Vec::new(),
            matrix: MassMatrix::none(),
            series: None,
        }
    }

    /// Of the DOFs of `basis`, with what `mass` wants.
    #[inline(never)]
    pub(super) fn new<B: BasisFamily<T, D>>(basis: &B, grid: &Grid<T, D>, mass: Divisor) -> Self {
        let count = basis.dof_count(grid);
        let lumped = if mass == Divisor::FittedLumped { count } else { 0 };
        Self {
            mass: vec![T::zero(); count],
            force: vec![SVector::zeros(); count],
            velocity: vec![SVector::zeros(); count],
            lumped: vec![T::zero(); lumped],
            matrix: match mass.has_matrix() {
                // Weak DOFs are tied to others.
                true => MassMatrix::new(basis, grid, mass == Divisor::ParticleMatrix),
                false => MassMatrix::none(),
            },
            series: mass.is_series().then(|| Box::new(Series::new(count))),
        }
    }

    /// Total of the mass that divides momenta, and total momentum.
    #[inline(never)]
    pub(super) fn mapped_totals(&self, mass: Divisor) -> MassMomentum<T, D> {
        MassMomentum {
            mass: match mass {
                Divisor::Particles => sum(&self.mass),
                Divisor::FittedLumped => sum(&self.lumped),
                Divisor::ParticleSeries(_) => sum(&self.mass),
                Divisor::FittedMatrix { .. } | Divisor::ParticleMatrix => self.matrix.total(),
            },
            momentum: sum(&self.velocity),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<T>() * (self.mass.len() + self.lumped.len())
            + self.matrix.bytes()
            + self.series.as_ref().map_or(0, |series| series.bytes())
            + 2 * size_of::<SVector<T, D>>() * self.force.len()
    }
}
