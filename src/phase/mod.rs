//! Phases: what shares the pores with the solid.

use nalgebra::SMatrix;

use crate::scalar::Scalar;

/// What a particle carries besides its solid, and how that enters the balance of momentum.
///
/// [`OnePhase`] is the dry solid: no data, no work. Everything a phase adds to the step stands under
/// `if P::COUPLED`, since zero-sized data alone leave empty loops behind.
pub trait Phase<T: Scalar, const D: usize> {
    /// Whether there is anything but the solid.
    const COUPLED: bool;

    /// Data per particle; `()` takes no memory.
    type Particle: Copy + Default;

    /// Stress (Pa) that the momentum balance of the whole feels, given the solid's effective stress.
    fn total_stress(&self, effective: &SMatrix<T, D, D>, particle: &Self::Particle) -> SMatrix<T, D, D>;

    /// Carries the data over the displacement gradient `increment` of one step.
    fn update(&self, increment: &SMatrix<T, D, D>, particle: &mut Self::Particle);
}

/// The dry solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OnePhase;

impl<T: Scalar, const D: usize> Phase<T, D> for OnePhase {
    const COUPLED: bool = false;
    type Particle = ();

    #[inline(always)]
    fn total_stress(&self, effective: &SMatrix<T, D, D>, _particle: &()) -> SMatrix<T, D, D> {
        *effective
    }

    #[inline(always)]
    fn update(&self, _increment: &SMatrix<T, D, D>, _particle: &mut ()) {}
}
