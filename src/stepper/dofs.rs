//! What is kept for the DOFs of one phase.

use nalgebra::SVector;

use super::matrix::MassMatrix;
use crate::basis::BasisFamily;
use crate::grid::Grid;
use crate::mass::VelocityMass;
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

    /// `own_mass` is what divides the momenta, if it is not the lumped mass of the particles; `ties` whether weak DOFs are
    /// tied to others.
    pub(super) fn new<B: BasisFamily<T, D>>(
        basis: &B,
        grid: &Grid<T, D>,
        own_mass: Option<VelocityMass>,
        ties: bool,
    ) -> Self {
        let count = basis.dof_count(grid);
        let lumped = if own_mass == Some(VelocityMass::Lumped) {
            count
        } else {
            0
        };
        Self {
            mass: vec![T::zero(); count],
            force: vec![SVector::zeros(); count],
            velocity: vec![SVector::zeros(); count],
            lumped: vec![T::zero(); lumped],
            matrix: match own_mass {
                Some(VelocityMass::Consistent | VelocityMass::Constrained) => {
                    MassMatrix::new(basis, grid, ties)
                }
                Some(VelocityMass::Lumped) | None => MassMatrix::none(),
            },
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<T>() * (self.mass.len() + self.lumped.len())
            + self.matrix.bytes()
            + 2 * size_of::<SVector<T, D>>() * self.force.len()
    }
}
