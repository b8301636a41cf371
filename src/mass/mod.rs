//! Mass matrices of the DOFs.

mod banded;

pub use banded::Banded;

/// Which mass turns the DOFs' momentum into their velocity. The acceleration always divides by the lumped
/// mass of the particles (journal section 5.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum VelocityMass {
    /// The matrix `integral(rho phi_i phi_j)`, solved with a banded factorisation.
    #[default]
    Consistent,
    /// Its row sums `integral(rho phi_i)`.
    Lumped,
}
