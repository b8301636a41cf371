//! Solutions in two and three dimensions.

mod elastica;
mod manufactured;
mod vortex;

pub use elastica::Elastica;
pub use manufactured::Manufactured;
pub use vortex::{Ring, Swing, Vortex};

use nalgebra::{SMatrix, SVector};

/// State of a solution in `D` dimensions at one material point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldState<const D: usize> {
    /// Displacement since time 0, m.
    pub displacement: SVector<f64, D>,
    /// Velocity, m/s.
    pub velocity: SVector<f64, D>,
    /// Cauchy stress, Pa, positive in tension.
    pub stress: SMatrix<f64, D, D>,
}

/// A solution in closed form that material points in `D` dimensions can be compared with.
pub trait FieldReference<const D: usize> {
    /// State at `time` (s) of the material point that was at `x0` (m) at time 0.
    fn at(&self, x0: &SVector<f64, D>, time: f64) -> FieldState<D>;

    /// Force per mass (N/kg) that drives that material point at `time` (s).
    fn body_force(&self, x0: &SVector<f64, D>, time: f64) -> SVector<f64, D>;
}
