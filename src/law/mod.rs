//! Constitutive laws.

mod hill;
mod linear_elastic;
mod logarithmic;
mod moduli;
mod neo_hookean;

pub use hill::Hill;
pub use linear_elastic::LinearElastic;
pub use logarithmic::Logarithmic;
pub use moduli::Moduli;
pub use neo_hookean::{DeformationGradient, NeoHookean};

use nalgebra::SMatrix;

use crate::scalar::Scalar;

/// How stress follows the deformation.
///
/// Implement it for a law of your own (see `examples/own_law.rs`); [`crate::testing::check_law`] checks that the
/// parts agree with each other.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no constitutive law for scalar `{T}` in `{D}` dimensions"
)]
pub trait ConstitutiveLaw<T: Scalar, const D: usize>: Sync {
    /// What the law remembers of each particle besides its stress; `()` for an elastic rate law.
    /// `Default` is the undeformed state.
    type State: Copy + Default + Send + Sync;

    /// What [`ConstitutiveLaw::knows`] asks for, for messages.
    const LIMITS: &'static str = "its law knows no such stress";

    /// Whether the law has a meaning at this stress. A step that leads beyond ends in an error.
    #[inline(always)]
    fn knows(&self, _stress: &SMatrix<T, D, D>, _state: &Self::State) -> bool {
        true
    }

    /// Whether volume and density follow the deformation (large strain) or stay as they were (small strain).
    fn large_strain(&self) -> bool;

    /// Carries stress (Cauchy, Pa, tension positive) and state over the displacement gradient
    /// `increment` of one step: row = component, column = derivative, taken at the step's start.
    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, state: &mut Self::State);

    /// Speed (m/s) of the fastest wave in material of the given current `density` (kg/m3).
    fn wave_speed(&self, density: T, stress: &SMatrix<T, D, D>, state: &Self::State) -> T;

    /// Strain energy per *current* volume (J/m3); per volume that never changes in small strain.
    fn energy_density(&self, stress: &SMatrix<T, D, D>, state: &Self::State) -> T;
}
