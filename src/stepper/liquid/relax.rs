//! The filter of the particles of two phases.

use super::super::Stepper;
use super::super::inner::Inner;
use super::joint::Joint;
use crate::basis::BasisFamily;
use crate::field::Pair;
use crate::law::LawSweep;
use crate::phase::{Phase, PoreLiquid};
use crate::reconstruction::{Cloud, Filters, Reconstruction};
use crate::scalar::Scalar;
use crate::transfer::Transfer;

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Effective stress and pressure after the forces are assembled from them, the velocities of both phases,
    /// each weighted with its masses, after their update and before they are mapped.
    pub(in super::super) fn relax_both(&mut self, dt: T) {
        self.inner.measure_courant_numbers(dt);
        let (crossed, phase) = (&self.inner.crossed[..], &self.inner.phase);
        let Joint {
            liquid_mass,
            state,
            liquid_velocity,
            ..
        } = &mut self.inner.joint;
        let particles = &mut self.inner.particles;
        let copies = state.iter_mut().zip(&mut liquid_velocity[..]);
        for ((state, velocity), (stress, data)) in copies.zip(particles.stress.iter().zip(&particles.phase)) {
            let liquid = phase.liquid(data);
            (*state, *velocity) = (Pair(*stress, liquid.pressure), liquid.velocity);
        }
        let cloud = Cloud {
            grid: &self.inner.grid,
            bins: &self.inner.bins,
            positions: &particles.position,
            volumes: &particles.volume,
            cuts: &self.inner.cuts,
        };
        let reconstruction = &mut self.reconstruction;
        R::Filter::relax(reconstruction, &cloud, crossed, state);
        R::Filter::relax_weighted(reconstruction, &cloud, liquid_mass, crossed, liquid_velocity);
        let mass = &particles.mass[..];
        R::Filter::relax_weighted(reconstruction, &cloud, mass, crossed, &mut particles.velocity);
        self.inner.take_in_relaxed();
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    #[inline(never)]
    fn take_in_relaxed(&mut self) {
        let (phase, particles, joint) = (&self.phase, &mut self.particles, &self.joint);
        let relaxed = joint.state.iter().zip(&joint.liquid_velocity);
        for (data, (&Pair(_, pressure), &velocity)) in particles.phase.iter_mut().zip(relaxed) {
            phase.set_liquid(PoreLiquid { velocity, pressure }, data);
        }
        let stresses = joint.state.iter().map(|state| state.0);
        if !self.law.remembers() {
            particles
                .stress
                .iter_mut()
                .zip(stresses)
                .for_each(|(to, stress)| *to = stress);
        } else {
            self.relaxed
                .iter_mut()
                .zip(stresses)
                .for_each(|(to, stress)| *to = stress);
            self.strain_to_relaxed();
        }
    }
}
