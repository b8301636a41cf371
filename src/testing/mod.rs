//! Conformance checks for types that implement this crate's traits.
//!
//! Each check takes an instance and what it *claims*, and asserts a claim both ways: what is claimed must
//! hold, and what is claimed not to hold must visibly fail, so that a claim can be neither too bold nor too
//! shy. The checks return the first [`Failure`] instead of panicking:
//!
//! ```
//! use materialpoint::{basis::DualDomain, grid::Grid, testing};
//! use nalgebra::vector;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let grid = Grid::new(vector![0.0], vector![1.0], [5])?;
//! let points = [vector![0.0], vector![0.37], vector![0.4], vector![1.0]];
//! let claims = testing::BasisClaims {
//!     gradients_are_derivatives: false, // they are smoothed
//!     ..testing::BasisClaims::of_degree(1)
//! };
//! testing::check_basis(&DualDomain::new(), &grid, &points, &claims)?;
//! # Ok(())
//! # }
//! ```
//!
//! With the feature `testing` there are random layouts of particles too (`testing::layout`), which shrink to
//! the one that is to blame.
//!
//! Tolerances follow from the number of operations and the machine epsilon of the scalar; none is a free
//! choice of the caller.

mod basis;
mod failure;
mod law;
#[cfg(feature = "testing")]
pub mod layout;
mod phase;
mod reconstruction;
mod transfer;
mod worst;

pub use basis::{BasisClaims, check_basis};
pub use failure::{Expected, Failure, Place, Property};
pub use law::{LawClaims, LawSample, check_law};
pub use phase::{PhaseSample, check_phase};
pub use reconstruction::{Measure, ReconstructionClaims, check_reconstruction};
pub use transfer::{TransferClaims, check_transfer};
