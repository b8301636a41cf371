//! The reconstruction's touch on the particles.

use super::Stepper;
use crate::basis::BasisFamily;
use crate::law::ConstitutiveLaw;
use crate::phase::Phase;
use crate::reconstruction::{Cloud, Reconstruction};
use crate::scalar::Scalar;

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
        // The stress of a law that remembers follows from its state, or is bound to it: it must not be moved alone.
        if size_of::<L::State>() == 0 {
            self.reconstruction
                .relax(&cloud, None, crossed, &mut particles.stress);
        }
        let mass = Some(&particles.mass[..]);
        self.reconstruction
            .relax(&cloud, mass, crossed, &mut particles.velocity);
    }

    /// Part of each occupied cell that a wave crosses in a step, at the cell's first particle.
    fn measure_crossings(&mut self, dt: T) {
        let (law, particles) = (&self.law, &self.particles);
        let across = dt / self.grid.cell_size().min();
        self.crossed.clear();
        let cells = self.bins.occupied().iter();
        self.crossed.extend(cells.map(|&cell| {
            let first = self.bins.particles_in(cell as usize).first();
            let p = first.map_or(0, |&p| p as usize);
            let density = particles.mass[p] / particles.volume[p];
            let speed = law.wave_speed(density, &particles.stress[p], &particles.state[p]);
            // Also where a law has no wave any more: there is then nothing to relax.
            (speed * across).max(T::zero())
        }));
    }
}
