//! Mass matrices of the DOFs.

mod axes;
mod banded;
mod gradients;
mod jumps;
mod lattice;
mod model;
mod penalty;

pub use axes::AxisMasses;
pub use banded::Banded;
pub(crate) use banded::banded_row;
pub use gradients::ConjugateGradients;
pub use lattice::Lattice;
pub(crate) use model::{Divisor, sealed::Divides};
pub use model::{MassModel, ParticleMass, ParticleMatrix, ParticleSeries, VelocityMass};
pub use penalty::Penalty;
