//! One phase.

use nalgebra::SMatrix;

use super::{Phase, PhaseStep};
use crate::scalar::Scalar;

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
    fn update(&self, _step: &PhaseStep<'_, T, D>, _particle: &mut ()) {}
}
