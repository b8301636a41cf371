//! Positions, stresses, pressures and volumes of the particles.

use nalgebra::{SMatrix, SVector};

use super::super::Stepper;
use super::super::advance::advance_solid;
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::law::ConstitutiveLaw;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: ConstitutiveLaw<T, D>,
    P: Phase<T, D>,
{
    /// Particles move with the solid; the pressure follows both velocities.
    #[inline(never)]
    pub(in super::super) fn advance_both(&mut self, dt: T) -> Result<(), StepError> {
        let motion = &self.motion;
        let particles = &mut self.particles;
        for p in 0..particles.position.len() {
            let mut v = SVector::zeros();
            let mut gradient = SMatrix::<T, D, D>::zeros();
            let mut liquid_gradient = SMatrix::<T, D, D>::zeros();
            let (cell, x) = (self.bins.cell_of(p), &particles.position[p]);
            self.basis.for_each(&self.grid, cell, x, |i, phi, grad_phi| {
                let [solid, liquid] = &motion[i];
                v += solid * phi;
                gradient += solid * grad_phi.transpose();
                liquid_gradient += liquid * grad_phi.transpose();
            });
            let increment = gradient * dt;
            self.phase
                .update_with_flow(&increment, &(liquid_gradient * dt), &mut particles.phase[p]);
            let pressure = self.phase.liquid(&particles.phase[p]).pressure;
            if !pressure.is_finite() {
                return Err(StepError::Invalid {
                    step: self.steps,
                    particle: p,
                    name: "pore pressure",
                    value: pressure.primal(),
                });
            }
            advance_solid(&self.law, particles, p, &(v * dt), &increment)
                .map_err(|volume| StepError::volume(self.steps, p, volume))?;
        }
        Ok(())
    }
}
