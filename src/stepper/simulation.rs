//! Steppers behind one object-safe face, for callers that choose the method at run time.

use std::io::{self, Read, Write};

use nalgebra::SVector;

use super::critical::critical_step;
use super::inner::Inner;
use super::order::Order;
use super::{
    Conservation, CriticalStep, Diagnostics, DiffusionCondition, Energy, FaceCondition, Forcing,
    MaterialFields, PoreCondition, Stepper,
};
use crate::basis::BasisFamily;
use crate::error::{RestoreError, StepError};
use crate::grid::Face;
use crate::law::LawSweep;
use crate::particles::Particles;
use crate::phase::{Phase, PoreLiquid};
use crate::reconstruction::{Reconstruction, Streams};
use crate::record::Record;
use crate::scalar::Scalar;
use crate::transfer::Transfer;

/// Any stepper, in `f64` whatever its own scalar is: one virtual call per step.
pub trait Simulation<const D: usize> {
    /// See [`Stepper::step`].
    ///
    /// # Errors
    /// As there.
    fn step(&mut self, dt: f64, forcing: &Forcing<f64, D>) -> Result<(), StepError>;

    /// See [`Stepper::step_with_kick`].
    ///
    /// # Errors
    /// As there.
    fn step_with_kick(&mut self, kick: f64, dt: f64, forcing: &Forcing<f64, D>) -> Result<(), StepError>;

    /// See [`Stepper::step_and_measure`].
    ///
    /// # Errors
    /// As there.
    fn step_and_measure(
        &mut self,
        kick: f64,
        dt: f64,
        forcing: &Forcing<f64, D>,
    ) -> Result<Energy<f64>, StepError>;

    /// See [`Stepper::set_body_forces`].
    fn set_body_forces(&mut self, force: &dyn Fn(&SVector<f64, D>) -> SVector<f64, D>);

    /// A copy of the particles, without the law's and the second phase's data, in the order in which they
    /// were given.
    fn particles(&self) -> Particles<f64, D>;

    /// The particles and their liquid without a copy (in `f64`), in the order in which they were given;
    /// everything else is given up.
    fn into_particles(self: Box<Self>) -> (Particles<f64, D>, Vec<PoreLiquid<f64, D>>);

    /// The liquid of every particle; empty where none flows.
    fn liquid(&self) -> Vec<PoreLiquid<f64, D>>;

    /// See [`Stepper::material_fields`].
    fn material_fields(&self) -> MaterialFields;

    /// See [`Stepper::diagnostics`].
    fn diagnostics(&self) -> Diagnostics<f64>;

    /// See [`Stepper::energy`].
    fn energy(&self) -> Energy<f64>;

    /// See [`Stepper::critical_step`].
    fn critical_step(&self, forcing: &Forcing<f64, D>) -> Option<CriticalStep<f64>>;

    /// See [`Stepper::into_critical_step`].
    fn into_critical_step(self: Box<Self>, forcing: &Forcing<f64, D>) -> Option<CriticalStep<f64>>;

    /// See [`Stepper::stiffness_bound`].
    fn stiffness_bound(&mut self, forcing: &Forcing<f64, D>) -> f64;

    /// See [`Stepper::stiffness`].
    fn stiffness(&mut self, forcing: &Forcing<f64, D>) -> Option<f64>;

    /// Whether [`Simulation::stiffness`] is a proved bound, which costs about a step, and no iteration on a
    /// sample of the particles.
    fn stiffness_is_bound(&self) -> bool;

    /// See [`Stepper::largest_step`].
    fn largest_step(&self, stiffness: f64) -> Option<CriticalStep<f64>>;

    /// See [`Stepper::save`].
    ///
    /// # Errors
    /// As there.
    fn save(&self, out: &mut dyn Write) -> io::Result<()>;

    /// See [`Stepper::restore`].
    ///
    /// # Errors
    /// As there.
    fn restore(&mut self, from: &mut dyn Read) -> Result<(), RestoreError>;

    /// Number of particles.
    fn particle_count(&self) -> usize;

    /// Number of DOFs.
    fn dof_count(&self) -> usize;

    /// See [`Stepper::bytes_per_particle`].
    fn bytes_per_particle(&self) -> f64;
}

impl<T, const D: usize, B, R, L, P, X> Simulation<D> for Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D> + Clone,
    L: LawSweep<T, D> + Clone,
    L::Number: Record<T>,
    P: Phase<T, D> + Clone,
    P::Particle: Record<T>,
    X: Transfer<T, D>,
    X::Particle: Record<T>,
{
    fn step(&mut self, dt: f64, forcing: &Forcing<f64, D>) -> Result<(), StepError> {
        self.step(T::lit(dt), &cast_forcing(forcing))
    }

    fn step_and_measure(
        &mut self,
        kick: f64,
        dt: f64,
        forcing: &Forcing<f64, D>,
    ) -> Result<Energy<f64>, StepError> {
        let energy = self.step_and_measure(T::lit(kick), T::lit(dt), &cast_forcing(forcing))?;
        Ok(cast_energy(&energy))
    }

    fn step_with_kick(&mut self, kick: f64, dt: f64, forcing: &Forcing<f64, D>) -> Result<(), StepError> {
        self.step_with_kick(T::lit(kick), T::lit(dt), &cast_forcing(forcing))
    }

    fn set_body_forces(&mut self, force: &dyn Fn(&SVector<f64, D>) -> SVector<f64, D>) {
        self.set_body_forces(|x| force(&x.map(T::primal)).map(T::lit));
    }

    fn particles(&self) -> Particles<f64, D> {
        copied(&self.inner.particles, &self.inner.order)
    }

    fn into_particles(mut self: Box<Self>) -> (Particles<f64, D>, Vec<PoreLiquid<f64, D>>) {
        let (particles, numbers, liquid) = self.inner.give_particles_away();
        // The DOFs' arrays and the reconstruction's are freed before the particles may be copied. By the
        // stepper as a whole: to free it field by field would be compiled for every stepper once more.
        drop(self);
        (in_first_order(particles, numbers), liquid)
    }

    fn liquid(&self) -> Vec<PoreLiquid<f64, D>> {
        liquid_of(&self.inner.phase, &self.inner.particles.phase, &self.inner.order)
    }

    fn material_fields(&self) -> MaterialFields {
        self.material_fields()
    }

    fn diagnostics(&self) -> Diagnostics<f64> {
        cast_diagnostics(&self.inner.diagnostics)
    }

    fn energy(&self) -> Energy<f64> {
        cast_energy(&self.energy())
    }

    fn critical_step(&self, forcing: &Forcing<f64, D>) -> Option<CriticalStep<f64>> {
        self.critical_step(&cast_forcing(forcing)).map(cast_critical)
    }

    fn into_critical_step(mut self: Box<Self>, forcing: &Forcing<f64, D>) -> Option<CriticalStep<f64>> {
        critical_step(self.as_mut(), &cast_forcing(forcing)).map(cast_critical)
    }

    fn stiffness_bound(&mut self, forcing: &Forcing<f64, D>) -> f64 {
        self.stiffness_bound(&cast_forcing(forcing)).primal()
    }

    fn stiffness(&mut self, forcing: &Forcing<f64, D>) -> Option<f64> {
        self.stiffness(&cast_forcing(forcing)).map(T::primal)
    }

    fn stiffness_is_bound(&self) -> bool {
        R::Points::AT_PARTICLES && !X::FROM_GRID
    }

    fn largest_step(&self, stiffness: f64) -> Option<CriticalStep<f64>> {
        self.largest_step(T::lit(stiffness)).map(cast_critical)
    }

    fn save(&self, out: &mut dyn Write) -> io::Result<()> {
        self.save(out)
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), RestoreError> {
        self.restore(from)
    }

    fn particle_count(&self) -> usize {
        self.inner.particles.len()
    }

    fn dof_count(&self) -> usize {
        self.dof_count()
    }

    fn bytes_per_particle(&self) -> f64 {
        self.bytes_per_particle()
    }
}

/// Particles, their numbers and their liquid.
type Bodies<T, const D: usize, S, Q> = (Particles<T, D, S, Q>, Option<Vec<u32>>, Vec<PoreLiquid<f64, D>>);

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Leaves none.
    #[inline(never)]
    fn give_particles_away(&mut self) -> Bodies<T, D, L::Number, P::Particle> {
        let liquid = liquid_of(&self.phase, &self.particles.phase, &self.order);
        let none = Particles::from_points(std::iter::empty(), T::zero());
        let particles = std::mem::replace(&mut self.particles, none);
        (particles, self.order.take_numbers(), liquid)
    }
}

/// Particles in `f64`, in the order of their `numbers`.
#[inline(never)]
fn in_first_order<T: Scalar, const D: usize, S, Q>(
    particles: Particles<T, D, S, Q>,
    numbers: Option<Vec<u32>>,
) -> Particles<f64, D> {
    let mut particles = particles.into_cast();
    particles.put_back(numbers);
    particles
}

/// The same of a copy.
#[inline(never)]
fn copied<T: Scalar, const D: usize, S: Clone, Q: Clone>(
    particles: &Particles<T, D, S, Q>,
    order: &Order,
) -> Particles<f64, D> {
    in_first_order(particles.clone(), order.numbers().map(<[u32]>::to_vec))
}

/// The liquid of every particle, in the order in which they were given.
#[inline(never)]
fn liquid_of<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    data: &[P::Particle],
    order: &Order,
) -> Vec<PoreLiquid<f64, D>> {
    if !P::FLOWS {
        return Vec::new();
    }
    let mut liquid = vec![PoreLiquid::default(); data.len()];
    for (place, data) in data.iter().enumerate() {
        let PoreLiquid { velocity, pressure } = phase.liquid(data);
        liquid[order.number(place)] = PoreLiquid {
            velocity: velocity.map(T::primal),
            pressure: pressure.primal(),
        };
    }
    liquid
}

#[inline(never)]
fn cast_diagnostics<T: Scalar>(diagnostics: &Diagnostics<T>) -> Diagnostics<f64> {
    let Diagnostics {
        conservation,
        liquid_conservation,
        grid_crossings,
        reduced_cells,
        virtual_cells,
        total_mass,
        wall_work,
        wall_gain,
        unsolved_contacts,
    } = *diagnostics;
    Diagnostics {
        conservation: cast_conservation(&conservation),
        liquid_conservation: liquid_conservation.as_ref().map(cast_conservation),
        grid_crossings,
        reduced_cells,
        virtual_cells,
        total_mass: total_mass.primal(),
        wall_work: wall_work.primal(),
        wall_gain: wall_gain.primal(),
        unsolved_contacts,
    }
}

fn cast_energy<T: Scalar>(energy: &Energy<T>) -> Energy<f64> {
    Energy {
        kinetic: energy.kinetic.primal(),
        strain: energy.strain.primal(),
    }
}

fn cast_critical<T: Scalar>(critical: CriticalStep<T>) -> CriticalStep<f64> {
    let CriticalStep { step, mechanism } = critical;
    let step = step.primal();
    CriticalStep { step, mechanism }
}

fn cast_conservation<T: Scalar>(errors: &Conservation<T>) -> Conservation<f64> {
    Conservation {
        mass: errors.mass.primal(),
        momentum: errors.momentum.primal(),
        momentum_scaled: errors.momentum_scaled.primal(),
        impulse: errors.impulse.primal(),
    }
}

fn cast_forcing<T: Scalar, const D: usize>(forcing: &Forcing<f64, D>) -> Forcing<T, D> {
    let cast = |v: &SVector<f64, D>| v.map(T::lit);
    let mut result = Forcing::none().with_body_force(cast(&forcing.body_force));
    for face in Face::all::<D>() {
        let condition = match forcing.face(face) {
            FaceCondition::Free => FaceCondition::Free,
            FaceCondition::Frictional {
                coefficient,
                velocity,
            } => FaceCondition::Frictional {
                coefficient: T::lit(*coefficient),
                velocity: cast(velocity),
            },
            FaceCondition::Traction(traction) => FaceCondition::Traction(cast(traction)),
            FaceCondition::Held {
                held,
                velocity,
                acceleration,
            } => FaceCondition::Held {
                held: *held,
                velocity: cast(velocity),
                acceleration: cast(acceleration),
            },
        };
        result.set_face(face, condition);
        if let PoreCondition::Pressure(pressure) = forcing.pores(face) {
            result.set_pores(face, PoreCondition::Pressure(T::lit(pressure)));
        }
        if let DiffusionCondition::Value(value) = forcing.diffusion(face) {
            result.set_diffusion(face, DiffusionCondition::Value(T::lit(value)));
        }
    }
    result
}
