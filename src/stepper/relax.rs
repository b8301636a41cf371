//! The filter of the particles' stress and velocity.

use nalgebra::SMatrix;

use super::Stepper;
use super::inner::Inner;
use crate::basis::BasisFamily;
use crate::law::{Bodies, LawSweep};
use crate::parallel::{CELLS, each_span, many_threads};
use crate::phase::Phase;
use crate::reconstruction::{Cloud, CourantNumbers, Filters, Reconstruction};
use crate::scalar::Scalar;
use crate::simd::with_features;
use crate::tensor::determinant;
use crate::transfer::Transfer;

/// Particles that a law is asked for at once.
const AT_ONCE: usize = 32;
/// Largest strain by which a relaxation moves a stress in a step.
const MOST_STRAIN: f64 = 0.1;

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Filters the particles: the stress after the force is assembled from it (nothing
    /// has used it since), the velocity after its update and before it is mapped.
    pub(super) fn relax(&mut self, dt: T) {
        self.inner.measure_courant_numbers(dt);
        let (crossed, particles) = (&self.inner.crossed[..], &mut self.inner.particles);
        let cloud = Cloud {
            grid: &self.inner.grid,
            bins: &self.inner.bins,
            positions: &particles.position,
            volumes: &particles.volume,
            cuts: &self.inner.cuts,
        };
        let reconstruction = &mut self.reconstruction;
        if !self.inner.law.remembers() {
            R::Filter::relax(reconstruction, &cloud, crossed, &mut particles.stress);
        } else {
            self.inner.relaxed.copy_from_slice(&particles.stress);
            R::Filter::relax(reconstruction, &cloud, crossed, &mut self.inner.relaxed);
        }
        let (masses, velocities) = (&particles.mass, &mut particles.velocity);
        R::Filter::relax_weighted(reconstruction, &cloud, masses, crossed, velocities);
        if self.inner.law.remembers() {
            self.inner.strain_to_relaxed();
        }
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Moves the stress of a law that remembers, which follows from its state or is bound to it, by small
    /// strains: stress, state and volume stay those of one material.
    #[inline(never)]
    pub(super) fn strain_to_relaxed(&mut self) {
        let (law, particles) = (&self.law, &mut self.particles);
        let large_strain = law.large_strain();
        for (p, relaxed) in self.relaxed.iter().enumerate() {
            let (stress, state, volume) = (
                &mut particles.stress[p],
                law.of_mut(&mut particles.state, p),
                &mut particles.volume[p],
            );
            let change = relaxed - *stress;
            if change.iter().all(|x| x.is_zero()) {
                continue;
            }
            let density = particles.mass[p] / *volume;
            let Some(strain) = law.strain_for(&change, density, stress, state) else {
                continue;
            };
            let ratio = determinant(&(SMatrix::identity() + strain));
            // A stress that is off by its modulus is beyond what small strains mend.
            let mends = strain.iter().all(|e| e.abs() < T::lit(MOST_STRAIN));
            if !mends {
                continue;
            }
            law.update(&strain, stress, state);
            if large_strain {
                *volume *= ratio;
            }
        }
    }

    /// Parts of each occupied cell that are crossed in a step, in root mean square over its particles: by
    /// waves along the shortest side, for they run every way, and by the particles, who run along their own.
    /// All particles of a cell count alike, so that neither their order nor a mirror matters.
    #[inline(never)]
    pub(super) fn measure_courant_numbers(&mut self, dt: T) {
        let occupied = self.bins.occupied();
        let mut crossed = std::mem::take(&mut self.crossed);
        let nothing = CourantNumbers {
            wave: T::zero(),
            motion: T::zero(),
        };
        crossed.resize(occupied.len(), nothing);
        let parallel = occupied.len() > CELLS && many_threads();
        each_span(parallel, CELLS, &mut crossed[..], &|first, crossed| {
            let cells = &occupied[first..first + crossed.len()];
            with_features(
                #[inline(always)]
                || {
                    for (crossed, &cell) in crossed.iter_mut().zip(cells) {
                        *crossed = self.courant_numbers_in(cell as usize, dt);
                    }
                },
            );
        });
        self.crossed = crossed;
    }

    /// Parts of the cell with a number that are crossed in a step.
    #[inline(always)]
    fn courant_numbers_in(&self, cell: usize, dt: T) -> CourantNumbers<T> {
        let inverse = self.grid.inverse_cell_size();
        let particles = self.bins.particles_in(cell);
        // Also where a law has no wave any more: there is then nothing to relax.
        let (mut waves, mut squares) = (T::zero(), T::zero());
        let mut speeds = [T::zero(); AT_ONCE];
        for some in particles.chunks(AT_ONCE) {
            self.wave_speeds(some, &mut speeds);
            for (&p, &speed) in some.iter().zip(&speeds) {
                let speed = speed.max(T::zero());
                waves += speed * speed;
                let velocity = self.particles.velocity[p as usize];
                squares += velocity.component_mul(inverse).norm_squared();
            }
        }
        let count = T::count(particles.len().max(1));
        CourantNumbers {
            wave: (waves / count).sqrt() * inverse.max() * dt,
            motion: (squares / count).sqrt() * dt,
        }
    }

    /// Speeds of waves at particles (m/s); through both phases together where a liquid flows.
    #[inline(always)]
    fn wave_speeds(&self, which: &[u32], speeds: &mut [T]) {
        let (phase, particles) = (&self.phase, &self.particles);
        let bodies = Bodies {
            mass: &particles.mass,
            volume: &particles.volume,
            stress: &particles.stress,
            state: &particles.state,
        };
        self.law.wave_speeds(which, &bodies, speeds);
        if !P::COUPLED {
            return;
        }
        if !P::FLOWS {
            for (speed, &p) in speeds.iter_mut().zip(which) {
                let p = p as usize;
                let added = self.waves().phase_stiffness(p) * particles.volume[p] / particles.mass[p];
                *speed = (*speed * *speed + added).max(T::zero()).sqrt();
            }
            return;
        }
        for (speed, &p) in speeds.iter_mut().zip(which) {
            let p = p as usize;
            let volume = particles.volume[p];
            let density = particles.mass[p] / volume;
            let stiffness = *speed * *speed * density + phase.liquid_stiffness();
            *speed = (stiffness / (density + phase.liquid_mass(volume) / volume)).sqrt();
        }
    }
}
