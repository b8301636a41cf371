//! What is counted and measured along the way.

use std::ops::Range;

use nalgebra::SVector;

use super::Stepper;
use super::contact::WallAction;
use super::inner::Inner;
use super::spans::Totals;
use crate::basis::BasisFamily;
use crate::field::MassMomentum;
use crate::law::LawSweep;
use crate::parallel::{PARTICLES, PerSpan, each_span, worth_sharing};
use crate::particles::Particles;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::transfer::Momentum;
use crate::transfer::Transfer;

/// Largest errors, over all steps, of the mapped DOF totals against the particle totals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conservation<T> {
    /// Of mass, relative to the mass.
    pub mass: T,
    /// Of momentum, relative to the total momentum (as the papers report it; large where that passes zero).
    pub momentum: T,
    /// Of momentum, relative to `sum m |v|`.
    pub momentum_scaled: T,
    /// Of the change of the particles' momentum in a step against the impulse of all that acts from outside
    /// (body forces, tractions, held faces, walls that rub), relative to `sum m |v|` and the sizes of these
    /// impulses. Not measured with a liquid that flows; beyond one axis the forces of held faces are not
    /// known with the particles' consistent mass, and the components that they hold are left out.
    pub impulse: T,
}

/// Counts and measures since the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diagnostics<T> {
    /// Conservation by the mapping of mass and momentum.
    pub conservation: Conservation<T>,
    /// The same of the liquid, where one flows.
    pub liquid_conservation: Option<Conservation<T>>,
    /// How often a particle changed its cell.
    pub grid_crossings: usize,
    /// Most cells in one step that could not be fitted with the full set of functions.
    pub reduced_cells: usize,
    /// Most cells in one step that were fitted with virtual points of their neighbours.
    pub virtual_cells: usize,
    /// Mass of all particles.
    pub total_mass: T,
    /// Work of walls that rub on the particles (J), since the start: of their impulses with the velocities
    /// after them.
    pub wall_work: T,
    /// Most work (J) in one step of their impulses with velocities relative to them, zero if it never was
    /// positive: walls at rest only take energy.
    pub wall_gain: T,
    /// Steps in which the impulses of walls were not found within the tolerance.
    pub unsolved_contacts: usize,
}

/// Energy of the particles (1-D: J/m2, 2-D: J/m, 3-D: J).
///
/// Velocities live half a step beside positions. Of particles as they are ([`Stepper::energy`]) the kinetic
/// energy is that of half a step before the strain energy, and their sum swings by parts of a per cent to
/// several although nothing is gained or lost. A step tells both at its start
/// ([`Stepper::step_and_measure`]): the kinetic energy is then $\sum m\,v_-\cdot v_+/2$ with the velocities
/// half a step before and after, and the sum is the energy that Euler-Cromer keeps for linear laws to
/// round-off (Hairer, Lubich & Wanner 2006, "Geometric numerical integration", I.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy<T> {
    /// `sum m |v|^2 / 2`.
    pub kinetic: T,
    /// Strain energy by the law.
    pub strain: T,
}

impl<T: Scalar> Energy<T> {
    pub(super) fn none() -> Self {
        Self {
            kinetic: T::zero(),
            strain: T::zero(),
        }
    }

    /// Kinetic plus strain energy.
    pub fn total(&self) -> T {
        self.kinetic + self.strain
    }
}

impl<T: Scalar> Diagnostics<T> {
    pub(super) fn new(total_mass: T, flows: bool) -> Self {
        let none = Conservation {
            mass: T::zero(),
            momentum: T::zero(),
            momentum_scaled: T::zero(),
            impulse: T::zero(),
        };
        Self {
            conservation: none,
            liquid_conservation: flows.then_some(none),
            grid_crossings: 0,
            reduced_cells: 0,
            virtual_cells: 0,
            total_mass,
            wall_work: T::zero(),
            wall_gain: T::zero(),
            unsolved_contacts: 0,
        }
    }

    pub(super) fn record_reduced(&mut self, cells: usize) {
        self.reduced_cells = self.reduced_cells.max(cells);
    }

    pub(super) fn record_virtual(&mut self, cells: usize) {
        self.virtual_cells = self.virtual_cells.max(cells);
    }

    /// Takes in by how much the change of momentum differs from the impulse.
    pub(super) fn record_impulse(&mut self, difference: T, scale: T) {
        if scale > T::zero() {
            self.conservation.impulse = self.conservation.impulse.max(difference / scale);
        }
    }

    pub(super) fn record_walls<const D: usize>(&mut self, action: &WallAction<T, D>) {
        self.wall_work += action.work;
        self.wall_gain = self.wall_gain.max(action.rubbing);
        self.unsolved_contacts += usize::from(!action.solved);
    }

    /// Compares the mapped totals of the solid, and of the liquid where one flows, with those of the
    /// particles.
    #[inline(never)]
    pub(super) fn record<const D: usize>(
        &mut self,
        totals: &Totals<T, D>,
        [solid, liquid]: [MassMomentum<T, D>; 2],
    ) {
        self.conservation
            .record(self.total_mass, &totals.momenta[0], solid);
        if let Some(errors) = &mut self.liquid_conservation {
            errors.record(totals.liquid_mass, &totals.momenta[1], liquid);
        }
    }
}

impl<T: Scalar> Conservation<T> {
    /// Compares the mapped totals with those of the particles.
    fn record<const D: usize>(
        &mut self,
        total_mass: T,
        particles: &Momentum<T, D>,
        mapped: MassMomentum<T, D>,
    ) {
        let Momentum { momentum, scale } = *particles;
        let mass = (mapped.mass - total_mass).abs() / total_mass;
        self.mass = self.mass.max(mass);
        let difference = (mapped.momentum - momentum).norm();
        let total = momentum.norm();
        if total > T::zero() {
            self.momentum = self.momentum.max(difference / total);
        }
        if scale > T::zero() {
            self.momentum_scaled = self.momentum_scaled.max(difference / scale);
        }
    }
}

/// Particles whose energy is asked for at once.
const BLOCK: usize = 128;

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Kinetic and strain energy of the particles as they are, the liquid's included: the kinetic one half a
    /// step earlier than the strain energy. [`Stepper::step_and_measure`] has both at one time.
    pub fn energy(&self) -> Energy<T> {
        Energy {
            kinetic: kinetic_energy(&self.inner.phase, &self.inner.particles),
            strain: self.inner.strain_energy(),
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
    /// Strain energy of the particles as they are, what a phase stores included.
    pub(super) fn strain_energy(&self) -> T {
        strain_energy(&self.law, &self.phase, &self.particles)
    }

    /// Copies of the velocities of the particles, and of their liquid.
    pub(super) fn velocities(&self) -> [Vec<SVector<T, D>>; 2] {
        velocities(&self.phase, &self.particles.velocity, &self.particles.phase)
    }

    /// `sum m v . v' / 2` of the velocities before and those now.
    pub(super) fn kinetic_energy_across(&self, before: &[Vec<SVector<T, D>>; 2]) -> T {
        kinetic_energy_across(&self.phase, &self.particles, before)
    }
}

#[inline(never)]
fn velocities<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    solid: &[SVector<T, D>],
    data: &[P::Particle],
) -> [Vec<SVector<T, D>>; 2] {
    let liquid = match P::FLOWS {
        true => data.iter().map(|data| phase.liquid(data).velocity).collect(),
        false => Vec::new(),
    };
    [solid.to_vec(), liquid]
}

#[inline(never)]
fn kinetic_energy<T: Scalar, const D: usize, N, P: Phase<T, D>>(
    phase: &P,
    particles: &Particles<T, D, N, P::Particle>,
) -> T {
    let mut kinetic = T::zero();
    for p in 0..particles.position.len() {
        kinetic += particles.velocity[p].norm_squared() * particles.mass[p];
        if P::FLOWS {
            let speed = phase.liquid(&particles.phase[p]).velocity.norm_squared();
            kinetic += speed * phase.liquid_mass(particles.volume[p]);
        }
    }
    kinetic / T::lit(2.0)
}

#[inline(never)]
fn strain_energy<T, const D: usize, L, P>(
    law: &L,
    phase: &P,
    particles: &Particles<T, D, L::Number, P::Particle>,
) -> T
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    let each = law.numbers();
    sum_of_spans(&particles.position, &|span| {
        let (mut densities, mut sum) = ([T::zero(); BLOCK], T::zero());
        for first in span.clone().step_by(BLOCK) {
            let end = (first + BLOCK).min(span.end);
            let states = &particles.state[first * each..end * each];
            law.energy_densities(&particles.stress[first..end], states, &mut densities);
            for (p, &solid) in (first..end).zip(&densities) {
                let mut density = solid;
                if P::COUPLED {
                    density += phase.energy_density(&particles.phase[p]);
                }
                sum += density * particles.volume[p];
            }
        }
        sum
    })
}

#[inline(never)]
fn kinetic_energy_across<T: Scalar, const D: usize, N: Sync, P: Phase<T, D>>(
    phase: &P,
    particles: &Particles<T, D, N, P::Particle>,
    [solid, liquid]: &[Vec<SVector<T, D>>; 2],
) -> T {
    let twice = sum_of_spans(&particles.position, &|span| {
        let mut twice = T::zero();
        for p in span {
            twice += solid[p].dot(&particles.velocity[p]) * particles.mass[p];
            if P::FLOWS {
                let now = phase.liquid(&particles.phase[p]).velocity;
                twice += liquid[p].dot(&now) * phase.liquid_mass(particles.volume[p]);
            }
        }
        twice
    });
    twice / T::lit(2.0)
}

/// What `of` says of each span of particles, added up in their order, so that any number of threads gives the
/// same bits. A run samples its energy hundreds of times: where threads share the step they share that too.
#[inline(never)]
fn sum_of_spans<T: Scalar, const D: usize>(
    positions: &[SVector<T, D>],
    of: &(dyn Fn(Range<usize>) -> T + Sync),
) -> T {
    let mut sums = vec![T::zero(); positions.len().div_ceil(PARTICLES)];
    // Only to be cut at spans; a particle's data are found by its number.
    let work = (positions, PerSpan(&mut sums[..]));
    let parallel = worth_sharing::<D>(positions.len(), PARTICLES);
    each_span(parallel, PARTICLES, work, &|first, (positions, sum)| {
        sum.set(of(first..first + positions.len()));
    });
    sums.into_iter().fold(T::zero(), |total, sum| total + sum)
}
