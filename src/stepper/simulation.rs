//! Steppers behind one object-safe face, for callers that choose the method at run time.

use nalgebra::SVector;

use super::{Conservation, Diagnostics, Energy, FaceCondition, Forcing, Stepper};
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::grid::Face;
use crate::law::ConstitutiveLaw;
use crate::particles::Particles;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;

/// Any stepper, in `f64` whatever its own scalar is: one virtual call per step.
pub trait Simulation<const D: usize> {
    /// See [`Stepper::step`].
    ///
    /// # Errors
    /// As there.
    fn step(&mut self, dt: f64, forcing: &Forcing<f64, D>) -> Result<(), StepError>;

    /// A copy of the particles, without the law's and the second phase's data.
    fn particles(&self) -> Particles<f64, D>;

    /// See [`Stepper::diagnostics`].
    fn diagnostics(&self) -> Diagnostics<f64>;

    /// See [`Stepper::energy`].
    fn energy(&self) -> Energy<f64>;

    /// See [`Stepper::critical_step`].
    fn critical_step(&self, forcing: &Forcing<f64, D>) -> Option<f64>;

    /// Number of particles.
    fn particle_count(&self) -> usize;

    /// Number of DOFs.
    fn dof_count(&self) -> usize;

    /// See [`Stepper::bytes_per_particle`].
    fn bytes_per_particle(&self) -> f64;
}

impl<T, const D: usize, B, R, L, P> Simulation<D> for Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D> + Clone,
    L: ConstitutiveLaw<T, D> + Clone,
    P: Phase<T, D> + Clone,
{
    fn step(&mut self, dt: f64, forcing: &Forcing<f64, D>) -> Result<(), StepError> {
        self.step(T::lit(dt), &cast_forcing(forcing))
    }

    fn particles(&self) -> Particles<f64, D> {
        self.particles.cast()
    }

    fn diagnostics(&self) -> Diagnostics<f64> {
        let Diagnostics {
            conservation,
            grid_crossings,
            reduced_cells,
            total_mass,
        } = self.diagnostics;
        Diagnostics {
            conservation: Conservation {
                mass: conservation.mass.primal(),
                momentum: conservation.momentum.primal(),
                momentum_scaled: conservation.momentum_scaled.primal(),
            },
            grid_crossings,
            reduced_cells,
            total_mass: total_mass.primal(),
        }
    }

    fn energy(&self) -> Energy<f64> {
        let Energy { kinetic, strain } = self.energy();
        Energy {
            kinetic: kinetic.primal(),
            strain: strain.primal(),
        }
    }

    fn critical_step(&self, forcing: &Forcing<f64, D>) -> Option<f64> {
        self.critical_step(&cast_forcing(forcing)).map(T::primal)
    }

    fn particle_count(&self) -> usize {
        self.particles.len()
    }

    fn dof_count(&self) -> usize {
        self.dof_count()
    }

    fn bytes_per_particle(&self) -> f64 {
        self.bytes_per_particle()
    }
}

fn cast_forcing<T: Scalar, const D: usize>(forcing: &Forcing<f64, D>) -> Forcing<T, D> {
    let cast = |v: &SVector<f64, D>| v.map(T::lit);
    let mut result = Forcing::none().with_body_force(cast(&forcing.body_force));
    for face in Face::all::<D>() {
        let condition = match forcing.face(face) {
            FaceCondition::Free => FaceCondition::Free,
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
    }
    result
}
