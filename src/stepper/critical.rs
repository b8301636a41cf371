//! The critical time step of the scheme as it stands.

use nalgebra::{SMatrix, SVector};

use super::acceleration::{Walls, accelerate};
use super::bound::smaller;
use super::fitted::Fitted;
use super::liquid::Coupled;
use super::sums::Targets;
use super::velocity::divide_by_mass;
use super::{FaceCondition, Forcing, Setup, Stepper, cloud};
use crate::basis::BasisFamily;
use crate::grid::{Cell, Face};
use crate::law::LawSweep;
use crate::parallel::{PARTICLES, each_span, many_threads};
use crate::phase::{Drag, Phase, PhaseStep};
use crate::reconstruction::{Reconstruction, Stresses};
use crate::scalar::Scalar;
use crate::tensor::symmetric;

/// What limits a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mechanism {
    /// A wave that crosses a cell.
    Wave,
    /// The drag between solid and liquid, taken explicitly.
    Drag,
    /// What diffuses gets from particle to particle.
    Diffusion,
}

/// The largest stable step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriticalStep<T> {
    /// Its size (s).
    pub step: T,
    /// What limits it.
    pub mechanism: Mechanism,
}

/// Strain by which the law's tangent is probed.
const PROBE_STRAIN: f64 = 1e-3;
/// Iterations over which the eigenvalue must settle. The change in one is no sign: a mode of a partly filled
/// end cell, of which the start has little, grows unseen below the others for a while.
const STRIDE: usize = 40;
/// Share of `(c / h)^2`, `c` the wave speed, below which an eigenvalue is round-off: particles of which no
/// two share a DOF that strains them.
const ROUND_OFF: f64 = 1e-10;
/// Relative change over a stride below which it has settled.
const TOLERANCE: f64 = 1e-5;
const MOST_ITERATIONS: usize = 400;
/// Particles on which a stiffness is found that nothing bounds: less than a second's work in space.
const SAMPLE: usize = 4096;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D> + Clone,
    L: LawSweep<T, D> + Clone,
    P: Phase<T, D> + Clone,
{
    /// Largest step (s) at which the linearised scheme does not grow, for the particles where they are.
    ///
    /// One step maps particle velocities to DOF velocities, strains, stress rates, forces and back to
    /// particle accelerations: `dv/dt = -G` applied to the time integral of `v`. Euler-Cromer is stable up
    /// to `2 / sqrt(lambda)`, `lambda` the largest eigenvalue of `G`, found here by power iteration on the
    /// scheme's own stages, so it holds for every basis, reconstruction, mass, law and layout. `None` if
    /// nothing resists a motion (no stiffness).
    ///
    /// With a liquid that flows the same iteration, with unit density and modulus, gives what grid, basis,
    /// reconstruction and layout contribute, and the two-phase problem is solved with it for every particle's
    /// material; the least step counts.
    ///
    /// In a phase that diffuses no more than twice one over the proved bound of its largest eigenvalue
    /// (`docs/theory/diffusion.md`).
    pub fn critical_step(&self, forcing: &Forcing<T, D>) -> Option<CriticalStep<T>> {
        self.clone().into_critical_step(forcing)
    }

    /// [`Stepper::critical_step`] without a copy; the stepper is used up.
    // Out of line, as all that is asked once in a run: a stepper is compiled for every method.
    #[inline(never)]
    pub fn into_critical_step(mut self, forcing: &Forcing<T, D>) -> Option<CriticalStep<T>> {
        if P::FLOWS {
            let geometry = self.eigenvalue_of_unit_density(forcing)?;
            let steps = (0..self.particles.len()).map(|p| self.coupled(p).critical_step(geometry));
            return steps
                .flatten()
                .min_by(|a, b| a.step.primal().total_cmp(&b.step.primal()));
        }
        let diffusion = match const { P::DIFFUSES } {
            true => self.critical_diffusion(),
            false => None,
        };
        let speed = self.largest_wave_speed();
        let wave = self
            .largest_eigenvalue(forcing, speed)
            .map(|eigenvalue| CriticalStep {
                step: T::lit(2.0) / eigenvalue.sqrt(),
                mechanism: Mechanism::Wave,
            });
        [wave, diffusion].into_iter().flatten().reduce(smaller)
    }

    /// Stiffness (1/m2) of the layout for [`Stepper::largest_step`]: [`Stepper::stiffness_bound`] where that
    /// is proved, otherwise the largest eigenvalue for waves of 1 m/s, by power iteration, of a sample of
    /// some thousand particles: those in the cells about a corner of the bodies, or all where they are few.
    /// `None` if nothing resists a motion. In a phase that diffuses at least what that contributes, so that
    /// [`Stepper::largest_step`] bounds it too.
    ///
    /// Fits and consistent masses have no bound that is of use: a cell of which particles fill a part may be
    /// a hundred times as stiff as a full one, or a mass matrix next to singular.
    pub fn stiffness(&mut self, forcing: &Forcing<T, D>) -> Option<T> {
        if R::PLAIN {
            return Some(self.stiffness_bound(forcing));
        }
        let waves = self.stiffness_of_sample(forcing);
        if const { !P::DIFFUSES } {
            return waves;
        }
        self.prepare();
        let diffusion = self.diffusion_geometry();
        Some(waves.map_or(diffusion, |waves| waves.max(diffusion)))
    }

    fn stiffness_of_sample(&self, forcing: &Forcing<T, D>) -> Option<T> {
        let mut sample = self.sample()?;
        if P::FLOWS {
            return sample.eigenvalue_of_unit_density(forcing);
        }
        let speed = sample.largest_wave_speed();
        Some(sample.largest_eigenvalue(forcing, speed)? / (speed * speed))
    }

    /// A stepper of the particles about a corner.
    fn sample(&self) -> Option<Self> {
        let cells = self.bins.cells();
        // By coordinates: a particle that has just strayed is in a cell without a number.
        let last_axis_first = |cell: &&Cell<D>| {
            let mut order = **cell;
            order.reverse();
            order
        };
        if cells.len() <= SAMPLE {
            return Some(self.clone());
        }
        let corner = cells.iter().min_by_key(last_axis_first)?;
        let distance = |cell: &Cell<D>| {
            cell.iter()
                .zip(corner)
                .map(|(a, b)| a.abs_diff(*b))
                .max()
                .unwrap_or(0)
        };
        let mut distances: Vec<u32> = cells.iter().map(distance).collect();
        let (_, &mut reach, _) = distances.select_nth_unstable(SAMPLE);
        // Cells at the distance that is reached last come in whole or not at all, and the corner's own in any
        // case.
        let numbers: Vec<usize> = (0..cells.len())
            .filter(|&p| distance(&cells[p]) < reach.max(1))
            .collect();
        let mut surface = self.surface.clone();
        surface.retain_mut(|point| match numbers.binary_search(&point.particle) {
            Ok(number) => {
                point.particle = number;
                true
            }
            Err(_) => false,
        });
        let setup = Setup {
            grid: self.grid.clone(),
            basis: self.basis.clone(),
            reconstruction: self.reconstruction.clone(),
            law: self.law.clone(),
            phase: self.phase.clone(),
            velocity_mass: self.velocity_mass,
            particles: self.particles.picked(&numbers, self.law.numbers()),
            surface,
        };
        Self::new(setup).ok()
    }

    /// Largest eigenvalue for unit density and modulus; velocities and DOFs are used up.
    #[inline(never)]
    fn eigenvalue_of_unit_density(&mut self, forcing: &Forcing<T, D>) -> Option<T> {
        let unit_density = self.particles.volume.clone();
        let mass = std::mem::replace(&mut self.particles.mass, unit_density);
        let eigenvalue = self.largest_eigenvalue(forcing, T::one());
        self.particles.mass = mass;
        eigenvalue
    }

    /// Largest eigenvalue of the map, `None` if it is nothing to a wave of the given `speed`; velocities and
    /// DOFs are used up.
    #[inline(never)]
    fn largest_eigenvalue(&mut self, forcing: &Forcing<T, D>, speed: T) -> Option<T> {
        let across = speed / self.grid.cell_size().min();
        let least = across * across * T::lit(ROUND_OFF);
        let probe = self;
        probe.prepare();
        probe.sum_solid_masses();
        let rest = at_rest(forcing);
        let scale = probe.probe_velocity()?;
        let (mut before, mut eigenvalue) = (T::zero(), T::zero());
        for iteration in 0..MOST_ITERATIONS {
            probe.normalise(scale)?;
            eigenvalue = probe.apply(&rest, scale)?;
            if iteration % STRIDE == STRIDE - 1 {
                if (eigenvalue - before).abs() <= T::lit(TOLERANCE) * eigenvalue {
                    break;
                }
                before = eigenvalue;
            }
        }
        (eigenvalue > least).then_some(eigenvalue)
    }

    /// Velocity that strains a cell by [`PROBE_STRAIN`] in one second.
    fn probe_velocity(&mut self) -> Option<T> {
        let h = self.grid.cell_size().min();
        // A fixed sequence of signs and sizes that excites every mode.
        let mut seed = 1_u32;
        for v in &mut self.particles.velocity {
            for component in v.iter_mut() {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                *component = T::lit(f64::from(seed >> 8) / f64::from(1 << 23) - 1.0);
            }
        }
        h.is_finite().then(|| h * T::lit(PROBE_STRAIN))
    }

    /// Scales the particles' velocities to the root mean square `size`.
    fn normalise(&mut self, size: T) -> Option<()> {
        let norm = rms(&self.particles.velocity);
        if !(norm > T::zero() && norm.is_finite()) {
            return None;
        }
        for v in &mut self.particles.velocity {
            *v *= size / norm;
        }
        Some(())
    }

    /// Replaces the velocities `v` by `G v` and returns `|G v| / |v|`, `|v| = size`.
    fn apply(&mut self, rest: &Forcing<T, D>, size: T) -> Option<T> {
        self.map_solid();
        let walls = Walls::of_solid(&self.face_dofs, rest);
        divide_by_mass(&mut self.dofs, self.mass, &walls, true);
        let mut rates = vec![SMatrix::zeros(); self.particles.len()];
        let parallel = rates.len() > PARTICLES && many_threads();
        each_span(parallel, PARTICLES, &mut rates[..], &|first, rates: &mut [_]| {
            let mut state = Vec::with_capacity(self.law.numbers());
            for (p, rate) in (first..).zip(rates) {
                *rate = self.stress_rate(p, &mut state);
            }
        });
        let batched = self.batched();
        let fitted = Fitted {
            basis: &self.basis,
            cloud: cloud(&self.grid, &self.bins, &self.particles, &self.cuts),
            reconstruction: &mut self.reconstruction,
            spans: &mut self.spans,
            batched,
        };
        let force = Targets::<T, D, 0, 0, 1>::of_forces([&mut self.dofs.force]);
        fitted.forces::<1>(Stresses(&rates), force);
        let walls = Walls::of_solid(&self.face_dofs, rest);
        accelerate(&mut self.dofs, self.mass, &walls, &mut self.balance);
        self.particles.velocity.fill(SVector::zeros());
        self.kick_phases::<1, 0>(-T::one());
        let eigenvalue = rms(&self.particles.velocity) / size;
        eigenvalue.is_finite().then_some(eigenvalue)
    }

    /// Change of a particle's total stress under the DOF velocities in one second; `state` is room for a
    /// state.
    fn stress_rate(&self, p: usize, state: &mut Vec<L::Number>) -> SMatrix<T, D, D> {
        let particles = &self.particles;
        let mut gradient = SMatrix::<T, D, D>::zeros();
        let (cell, x) = (self.bins.cell_of(p), &particles.position[p]);
        self.basis.for_each(&self.grid, cell, x, |i, _, grad_phi| {
            gradient += self.dofs.velocity[i] * grad_phi.transpose();
        });
        if P::FLOWS {
            return symmetric(&gradient);
        }
        let mut stress = particles.stress[p];
        state.clear();
        state.extend_from_slice(self.law.of(&particles.state, p));
        self.law.update(&gradient, &mut stress, state);
        if !P::COUPLED {
            return stress - particles.stress[p];
        }
        let mut data = particles.phase[p];
        let step = PhaseStep::strain(&gradient, &stress).with_volume(particles.volume[p]);
        self.phase.update(&step, &mut data);
        self.phase.total_stress(&stress, &data)
            - self.phase.total_stress(&particles.stress[p], &particles.phase[p])
    }
}

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    /// Largest speed (m/s) of a wave through the solid.
    fn largest_wave_speed(&self) -> T {
        let speeds = (0..self.particles.len()).map(|p| self.wave_speed(p));
        speeds.fold(T::zero(), T::max)
    }

    /// Speed (m/s) of the fastest wave at particle `p`, of the law and, unless a liquid flows, with what the
    /// phase adds to its stiffness.
    pub(super) fn wave_speed(&self, p: usize) -> T {
        let particles = &self.particles;
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
        let (phase, data) = (&self.phase, &self.particles.phase[p]);
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

    /// The material at particle `p`.
    pub(super) fn coupled(&self, p: usize) -> Coupled<T> {
        let (particles, phase) = (&self.particles, &self.phase);
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
}

/// The same constraints with every told value zero, and no load.
pub(super) fn at_rest<T: Scalar, const D: usize>(forcing: &Forcing<T, D>) -> Forcing<T, D> {
    let mut rest = Forcing::none();
    for face in Face::all::<D>() {
        if let FaceCondition::Held { held, .. } = *forcing.face(face) {
            let zero = SVector::zeros();
            let (velocity, acceleration) = (zero, zero);
            rest.set_face(
                face,
                FaceCondition::Held {
                    held,
                    velocity,
                    acceleration,
                },
            );
        }
    }
    rest
}

fn rms<T: Scalar, const D: usize>(values: &[SVector<T, D>]) -> T {
    let sum = values.iter().fold(T::zero(), |s, v| s + v.norm_squared());
    (sum / T::count(values.len())).sqrt()
}
