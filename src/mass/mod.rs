//! Mass matrices of the DOFs.

mod axes;
mod banded;
mod gradients;
mod jumps;
mod lattice;
mod penalty;

pub use axes::AxisMasses;
pub use banded::Banded;
pub(crate) use banded::banded_row;
pub use gradients::ConjugateGradients;
pub use lattice::Lattice;
pub use penalty::Penalty;

/// Which mass turns the DOFs' momentum into their velocity. The acceleration always divides by the lumped
/// mass of the particles (journal section 5.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum VelocityMass {
    /// The matrix `integral(rho phi_i phi_j)`, solved with a banded factorisation in one dimension and by
    /// preconditioned conjugate gradients beyond; held DOFs are then overwritten with what they are told, as
    /// published.
    #[default]
    Consistent,
    /// The same matrix, solved under the constraint that the held DOFs have what they are told. Overwriting
    /// leaves the neighbours of a held DOF as if it were free, an error of one order less in the strain of
    /// the cells at the wall.
    Constrained,
    /// Its row sums `integral(rho phi_i)`.
    Lumped,
}

impl VelocityMass {
    /// Name in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Consistent => "consistent",
            Self::Constrained => "constrained",
            Self::Lumped => "lumped",
        }
    }
}
