//! Positions, stresses, pressures and volumes of the particles.

use nalgebra::{SMatrix, SVector};

use super::super::{Stepper, window};
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::law::ConstitutiveLaw;
use crate::particles::settle;
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
        let (basis, grid, law, phase) = (&self.basis, &self.grid, &self.law, &self.phase);
        let (motion, steps) = (&self.motion[..], self.steps);
        let (mut crossings, mut strayed, mut left) = (0, false, None);
        let places = self.bins.cells_mut().iter_mut();
        for (p, (mut particle, cell)) in self.particles.movable().each().zip(places).enumerate() {
            let mut v = SVector::zeros();
            let mut gradient = SMatrix::<T, D, D>::zeros();
            let mut liquid_gradient = SMatrix::<T, D, D>::zeros();
            basis.for_each(grid, cell, particle.position, |i, phi, grad_phi| {
                let [solid, liquid] = &motion[i];
                v += solid * phi;
                gradient += solid * grad_phi.transpose();
                liquid_gradient += liquid * grad_phi.transpose();
            });
            let increment = gradient * dt;
            phase.update_with_flow(&increment, &(liquid_gradient * dt), particle.phase);
            let pressure = phase.liquid(particle.phase).pressure;
            if !pressure.is_finite() {
                return Err(StepError::Invalid {
                    step: steps,
                    particle: p,
                    name: "pore pressure",
                    value: pressure.primal(),
                });
            }
            particle
                .advance(law, dt, &(v * dt), &increment)
                .map_err(|flaw| flaw.error(steps, p, law.limits()))?;
            match settle(grid, cell, particle.position) {
                Some(crossed) => {
                    crossings += usize::from(crossed);
                    strayed |= crossed && !window::is_safe(grid, cell);
                }
                None => {
                    left = Some(p);
                    break;
                }
            }
        }
        self.strayed |= strayed;
        self.diagnostics.grid_crossings += crossings;
        self.bins.note_crossings(crossings);
        self.spans.stale |= crossings > 0;
        left.map_or(Ok(()), |p| Err(self.left(p)))
    }
}
