//! Stage 4: positions, stresses and volumes of the particles.

use nalgebra::{SMatrix, SVector};

use super::Stepper;
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::law::ConstitutiveLaw;
use crate::particles::Particles;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::tensor::determinant;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: ConstitutiveLaw<T, D>,
    P: Phase<T, D>,
{
    pub(super) fn advance(&mut self, dt: T) -> Result<(), StepError> {
        let velocity = &self.dofs.velocity;
        let particles = &mut self.particles;
        for p in 0..particles.position.len() {
            let mut v = SVector::zeros();
            let mut gradient = SMatrix::<T, D, D>::zeros();
            let (cell, x) = (self.bins.cell_of(p), &particles.position[p]);
            self.basis.for_each(&self.grid, cell, x, |i, phi, grad_phi| {
                v += velocity[i] * phi;
                gradient += velocity[i] * grad_phi.transpose();
            });
            let increment = gradient * dt;
            if P::COUPLED {
                self.phase.update(&increment, &mut particles.phase[p]);
            }
            advance_solid(&self.law, particles, p, &(v * dt), &increment)
                .map_err(|volume| StepError::volume(self.steps, p, volume))?;
        }
        Ok(())
    }
}

/// Moves particle `p` by `path` and deforms it by `increment`; the volume is the error if it is no longer a positive number.
#[inline(always)]
pub(super) fn advance_solid<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>, Q>(
    law: &L,
    particles: &mut Particles<T, D, L::State, Q>,
    p: usize,
    path: &SVector<T, D>,
    increment: &SMatrix<T, D, D>,
) -> Result<(), T> {
    particles.position[p] += path;
    particles.displacement[p] += path;
    law.update(increment, &mut particles.stress[p], &mut particles.state[p]);
    if law.large_strain() {
        let volume = particles.volume[p] * determinant(&(SMatrix::identity() + increment));
        // Also refuses a volume that is not a number.
        if !(volume > T::zero() && volume.is_finite()) {
            return Err(volume);
        }
        particles.volume[p] = volume;
    }
    Ok(())
}
