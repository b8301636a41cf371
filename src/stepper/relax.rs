//! The reconstruction's touch on the particles.

use nalgebra::SMatrix;

use super::Stepper;
use crate::basis::BasisFamily;
use crate::law::ConstitutiveLaw;
use crate::phase::Phase;
use crate::reconstruction::{Cloud, Crossed, Reconstruction};
use crate::scalar::Scalar;
use crate::tensor::determinant;

/// Largest strain by which a relaxation moves a stress in a step.
const MOST_STRAIN: f64 = 0.1;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: ConstitutiveLaw<T, D>,
    P: Phase<T, D>,
{
    /// The reconstruction's touch on the particles: the stress after the force is assembled from it (nothing has used it
    /// since), the velocity after its update and before it is mapped.
    pub(super) fn relax(&mut self, dt: T) {
        self.measure_crossings(dt);
        let (crossed, particles) = (&self.crossed[..], &mut self.particles);
        let cloud = Cloud {
            grid: &self.grid,
            bins: &self.bins,
            positions: &particles.position,
            volumes: &particles.volume,
            cuts: &self.cuts,
        };
        if size_of::<L::State>() == 0 {
            self.reconstruction
                .relax(&cloud, None, crossed, &mut particles.stress);
        } else {
            self.relaxed.copy_from_slice(&particles.stress);
            self.reconstruction
                .relax(&cloud, None, crossed, &mut self.relaxed);
        }
        let mass = Some(&particles.mass[..]);
        self.reconstruction
            .relax(&cloud, mass, crossed, &mut particles.velocity);
        if size_of::<L::State>() > 0 {
            self.strain_to_relaxed();
        }
    }

    /// Moves the stress of a law that remembers, which follows from its state or is bound to it, by small strains: stress, state
    /// and volume stay those of one material.
    pub(super) fn strain_to_relaxed(&mut self) {
        let (law, particles) = (&self.law, &mut self.particles);
        let large_strain = law.large_strain();
        for (p, relaxed) in self.relaxed.iter().enumerate() {
            let (stress, state, volume) = (
                &mut particles.stress[p],
                &mut particles.state[p],
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

    /// Part of each occupied cell that a wave crosses in a step, at the cell's first particle.
    pub(super) fn measure_crossings(&mut self, dt: T) {
        let (law, phase, particles) = (&self.law, &self.phase, &self.particles);
        let across = dt / self.grid.cell_size().min();
        self.crossed.clear();
        let cells = self.bins.occupied().iter();
        self.crossed.extend(cells.map(|&cell| {
            let first = self.bins.particles_in(cell as usize).first();
            let p = first.map_or(0, |&p| p as usize);
            let density = particles.mass[p] / particles.volume[p];
            let mut speed = law.wave_speed(density, &particles.stress[p], &particles.state[p]);
            if P::FLOWS {
                // Of both phases together.
                let stiffness = speed * speed * density + phase.liquid_stiffness();
                let liquid = phase.liquid_mass(particles.volume[p]) / particles.volume[p];
                speed = (stiffness / (density + liquid)).sqrt();
            }
            // Also where a law has no wave any more: there is then nothing to relax.
            Crossed {
                wave: (speed * across).max(T::zero()),
                motion: particles.velocity[p].norm() * across,
            }
        }));
    }
}
