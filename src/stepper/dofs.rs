//! What is kept for the DOFs of one phase.

use nalgebra::SVector;

use super::matrix::MassMatrix;
use super::velocity::sum;
use crate::basis::BasisFamily;
use crate::field::MassMomentum;
use crate::grid::Grid;
use crate::mass::VelocityMass;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;

/// What forces and momenta of DOFs are divided by. Forces are by the particles' lumped masses but for
/// [`MassModel::ParticleMatrix`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MassModel {
    /// Lumped masses of the particles.
    Particles,
    /// Row sums of fitted masses.
    FittedLumped,
    /// The consistent matrix of fitted masses; held DOFs are overwritten or, if told so, eliminated.
    FittedMatrix { constrained: bool },
    /// The particles' consistent matrix, held DOFs eliminated: overwritten walls would tear at an
    /// acceleration that knows nothing of them.
    ParticleMatrix,
}

impl MassModel {
    /// That of a reconstruction, with what the setup says of the mass behind DOF velocities.
    pub(super) fn of<T: Scalar, const D: usize, R: Reconstruction<T, D>>(told: VelocityMass) -> Self {
        match (R::PARTICLE_MATRIX, R::AMOUNTS_AT_PARTICLES, told) {
            (true, _, _) => Self::ParticleMatrix,
            (false, true, _) => Self::Particles,
            (false, false, VelocityMass::Lumped) => Self::FittedLumped,
            (false, false, VelocityMass::Consistent) => Self::FittedMatrix { constrained: false },
            (false, false, VelocityMass::Constrained) => Self::FittedMatrix { constrained: true },
        }
    }

    /// Whether there is a matrix.
    pub(super) fn has_matrix(self) -> bool {
        matches!(self, Self::FittedMatrix { .. } | Self::ParticleMatrix)
    }

    /// Whether held DOFs are eliminated from the matrix.
    pub(super) fn is_constrained(self) -> bool {
        matches!(
            self,
            Self::FittedMatrix { constrained: true } | Self::ParticleMatrix
        )
    }
}

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
        }
    }

    /// Of the DOFs of `basis`, with what `mass` wants.
    #[inline(never)]
    pub(super) fn new<B: BasisFamily<T, D>>(basis: &B, grid: &Grid<T, D>, mass: MassModel) -> Self {
        let count = basis.dof_count(grid);
        let lumped = if mass == MassModel::FittedLumped { count } else { 0 };
        Self {
            mass: vec![T::zero(); count],
            force: vec![SVector::zeros(); count],
            velocity: vec![SVector::zeros(); count],
            lumped: vec![T::zero(); lumped],
            matrix: match mass.has_matrix() {
                // Weak DOFs are tied to others.
                true => MassMatrix::new(basis, grid, mass == MassModel::ParticleMatrix),
                false => MassMatrix::none(),
            },
        }
    }

    /// Total of the mass that divides momenta, and total momentum.
    #[inline(never)]
    pub(super) fn mapped_totals(&self, mass: MassModel) -> MassMomentum<T, D> {
        MassMomentum {
            mass: match mass {
                MassModel::Particles => sum(&self.mass),
                MassModel::FittedLumped => sum(&self.lumped),
                MassModel::FittedMatrix { .. } | MassModel::ParticleMatrix => self.matrix.total(),
            },
            momentum: sum(&self.velocity),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<T>() * (self.mass.len() + self.lumped.len())
            + self.matrix.bytes()
            + 2 * size_of::<SVector<T, D>>() * self.force.len()
    }
}
