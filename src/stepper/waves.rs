//! How fast waves run through the material of the particles, whatever the basis and the reconstruction.

use nalgebra::{SMatrix, SVector};

use super::critical::PROBE_STRAIN;
use super::liquid::Coupled;
use super::{CriticalStep, Mechanism};
use crate::law::LawSweep;
use crate::parallel::{PARTICLES, PerSpan, each_span, many_threads};
use crate::particles::Particles;
use crate::phase::{Drag, Phase, PhaseStep};
use crate::scalar::Scalar;
use crate::tensor::symmetric;

/// Particles and what they are made of.
pub(super) struct Waves<'a, T: Scalar, const D: usize, L: LawSweep<T, D>, P: Phase<T, D>> {
    pub(super) law: &'a L,
    pub(super) phase: &'a P,
    pub(super) particles: &'a Particles<T, D, L::Number, P::Particle>,
}

impl<T: Scalar, const D: usize, L: LawSweep<T, D>, P: Phase<T, D>> Waves<'_, T, D, L, P> {
    /// Largest speed (m/s) of a wave through the solid.
    #[inline(never)]
    pub(super) fn largest_speed(&self) -> T {
        let speeds = (0..self.particles.len()).map(|p| self.speed(p));
        speeds.fold(T::zero(), T::max)
    }

    /// Speed (m/s) of the fastest wave at particle `p`, of the law and, unless a liquid flows, with what the
    /// phase adds to its stiffness.
    fn speed(&self, p: usize) -> T {
        let particles = self.particles;
        let density = particles.mass[p] / particles.volume[p];
        let state = self.law.of(&particles.state, p);
        let speed = self.law.wave_speed(density, &particles.stress[p], state);
        if !P::COUPLED || P::FLOWS {
            return speed;
        }
        (speed * speed + self.phase_stiffness(p) / density)
            .max(T::zero())
            .sqrt()
    }

    /// How much a phase that does not flow adds to the modulus (Pa) of a wave along the stiffest axis, by a
    /// small strain.
    pub(super) fn phase_stiffness(&self, p: usize) -> T {
        let (phase, data) = (self.phase, &self.particles.phase[p]);
        let (strain, nothing) = (T::lit(PROBE_STRAIN), SMatrix::zeros());
        let before = phase.total_stress(&nothing, data);
        let along = (0..D).map(|axis| {
            let (mut increment, mut strained) = (nothing, *data);
            increment[(axis, axis)] = strain;
            let step = PhaseStep::strain(&increment, &self.particles.stress[p]);
            phase.update(&step.with_volume(self.particles.volume[p]), &mut strained);
            (phase.total_stress(&nothing, &strained) - before)[(axis, axis)] / strain
        });
        along.fold(-T::lit(f64::INFINITY), T::max)
    }

    /// Change of the total stress (Pa) of particle `p` in one second of this velocity gradient; `state` is
    /// room for a state.
    #[inline(never)]
    pub(super) fn stress_rate(
        &self,
        p: usize,
        gradient: &SMatrix<T, D, D>,
        state: &mut Vec<L::Number>,
    ) -> SMatrix<T, D, D> {
        if P::FLOWS {
            return symmetric(gradient);
        }
        let particles = self.particles;
        let mut stress = particles.stress[p];
        state.clear();
        state.extend_from_slice(self.law.of(&particles.state, p));
        self.law.update(gradient, &mut stress, state);
        if !P::COUPLED {
            return stress - particles.stress[p];
        }
        let mut data = particles.phase[p];
        let step = PhaseStep::strain(gradient, &stress).with_volume(particles.volume[p]);
        self.phase.update(&step, &mut data);
        self.phase.total_stress(&stress, &data)
            - self.phase.total_stress(&particles.stress[p], &particles.phase[p])
    }

    /// The material at particle `p`.
    fn coupled(&self, p: usize) -> Coupled<T> {
        let (particles, phase) = (self.particles, self.phase);
        let (mass, volume) = (particles.mass[p], particles.volume[p]);
        let density = mass / volume;
        let speed = self
            .law
            .wave_speed(density, &particles.stress[p], self.law.of(&particles.state, p));
        Coupled {
            mass: [phase.liquid_mass(volume) / volume, density],
            drag: phase.porosity() * phase.drag(mass, volume) / volume,
            liquid_stiffness: phase.liquid_stiffness(),
            porosity: phase.porosity(),
            modulus: speed * speed * density,
            implicit: phase.drag_treatment() == Drag::Implicit,
        }
    }

    /// Least critical step (s) of two phases at a particle, where `geometry` (1/m2) is the largest eigenvalue
    /// for unit density and modulus.
    #[inline(never)]
    pub(super) fn critical_step_of_both(&self, geometry: T) -> Option<CriticalStep<T>> {
        let steps = (0..self.particles.len()).map(|p| self.coupled(p).critical_step(geometry));
        steps
            .flatten()
            .min_by(|a, b| a.step.primal().total_cmp(&b.step.primal()))
    }

    /// See [`Stepper::largest_step`](super::Stepper::largest_step); lengths are times `inverse`, one over the
    /// cell sizes.
    #[inline(never)]
    pub(super) fn largest_step(&self, inverse: &SVector<T, D>, stiffness: T) -> Option<CriticalStep<T>> {
        let count = self.particles.len().div_ceil(PARTICLES);
        let mut found = vec![None; count];
        let parallel = count > 1 && many_threads();
        // Only to be cut at spans; a particle's data are found by its number.
        let work = (&self.particles.position[..], PerSpan(&mut found[..]));
        each_span(parallel, PARTICLES, work, &|first, (positions, found)| {
            let here = first..first + positions.len();
            let limits = here.filter_map(|p| self.largest_step_of(p, inverse, stiffness));
            found.set(limits.reduce(smaller));
        });
        found.into_iter().flatten().reduce(smaller)
    }

    fn largest_step_of(&self, p: usize, inverse: &SVector<T, D>, stiffness: T) -> Option<CriticalStep<T>> {
        let particles = self.particles;
        let crossing = |v: &SVector<T, D>| v.component_mul(inverse).amax();
        let mut speed = crossing(&particles.velocity[p]);
        let limit = if P::FLOWS {
            let liquid = self.phase.liquid(&particles.phase[p]);
            speed = speed.max(crossing(&liquid.velocity));
            self.coupled(p).stable_step(stiffness)?
        } else {
            let step = T::lit(2.0) / (self.speed(p) * stiffness.sqrt());
            CriticalStep {
                step,
                mechanism: Mechanism::Wave,
            }
        };
        let step = T::one() / (T::one() / limit.step + speed);
        // Without waves, or with a stress of which the law knows none, there is no limit.
        let is_one = limit.step.is_finite() && step > T::zero();
        is_one.then_some(CriticalStep { step, ..limit })
    }
}

pub(super) fn smaller<T: Scalar>(a: CriticalStep<T>, b: CriticalStep<T>) -> CriticalStep<T> {
    if b.step < a.step { b } else { a }
}
