//! From the names in a scene to the types of a stepper.

use nalgebra::SVector;

use super::error::RunError;
use super::initial::{Initial, initial};
use super::space::InSpace;
use crate::basis::BasisFamily;
use crate::error::{GridError, SetupError};
use crate::grid::Grid;
use crate::law::{AnyLaw, LawSweep};
use crate::method::{KnownIn, MethodVisitor, ReconstructionKind};
use crate::particles::Particles;
use crate::phase::{OnePhase, Phase, PoreLiquid, TwoPhase};
use crate::reconstruction::Reconstruction;
use crate::record::Record;
use crate::scalar::Scalar;
use crate::scene::{Phases, Scene};
use crate::stepper::{Setup, Simulation, Stepper, SurfacePoint};

/// A stepper of the chosen types.
pub type Built<const D: usize> = Result<Box<dyn Simulation<D>>, RunError>;

/// The scene's grid.
pub(super) fn grid<T: Scalar, const D: usize>(scene: &Scene) -> Result<Grid<T, D>, GridError> {
    let bound = |values: &[f64]| SVector::from(per_axis(values, f64::NAN).map(T::lit));
    Grid::new(
        bound(&scene.grid.min),
        bound(&scene.grid.max),
        per_axis(&scene.grid.cells, 0),
    )
}

/// The entries of a list with one for each axis; `missing` where there is none.
pub(super) fn per_axis<A: Copy, const D: usize>(values: &[A], missing: A) -> [A; D] {
    std::array::from_fn(|axis| values.get(axis).copied().unwrap_or(missing))
}

/// What a stepper starts from, before its types are known.
pub struct Start<'a, const D: usize> {
    pub(super) scene: &'a Scene,
    initial: Initial<D>,
}

impl<'a, const D: usize> Start<'a, D>
where
    Scene: InSpace<D>,
    ReconstructionKind: KnownIn<D>,
{
    /// Of a run with steps of `dt` (s), or of none.
    pub(super) fn new(scene: &'a Scene, dt: f64) -> Result<Self, RunError> {
        let initial = initial(scene, &grid(scene)?, dt)?;
        Ok(Self { scene, initial })
    }

    /// The stepper once the scalar is a type and the law known.
    pub(super) fn with_law<T>(self, law: AnyLaw<T, D>) -> Built<D>
    where
        T: Scalar + Record<T> + Default,
        AnyLaw<T, D>: LawSweep<T, D, Number = T>,
    {
        let method = self.scene.method.method();
        let built = method.dispatch(WithLaw { start: self, law });
        built.unwrap_or(Err(RunError::NoSuchMethod(method)))
    }
}

/// Builds the stepper once basis and reconstruction are types.
struct WithLaw<'a, T, const D: usize> {
    start: Start<'a, D>,
    law: AnyLaw<T, D>,
}

impl<T, const D: usize> MethodVisitor<T, D> for WithLaw<'_, T, D>
where
    T: Scalar + Record<T> + Default,
    AnyLaw<T, D>: LawSweep<T, D, Number = T>,
{
    type Output = Built<D>;

    fn visit<B, R>(self, basis: B, reconstruction: R) -> Self::Output
    where
        B: BasisFamily<T, D> + Send + 'static,
        R: Reconstruction<T, D> + Clone + Send + 'static,
    {
        let Self { start, law } = self;
        let Initial {
            particles,
            liquid,
            surface,
            first_particles,
        } = start.initial;
        let rest = Rest {
            scene: start.scene,
            law,
            surface,
            first_particles,
        };
        match start.scene.material.phases {
            Phases::One { .. } => rest.stepper(basis, reconstruction, OnePhase, particles.into_cast()),
            // Known at compile time: no stepper is built for what scenes refuse.
            Phases::Two(_) if const { one_phase_only::<T, D, R>() } => Err(SetupError::OnePhaseOnly.into()),
            // Two phases in the plane are verified with laws that remember nothing.
            Phases::Two(_) if D > 1 && rest.law.remembers() => Err(SetupError::OnePhaseOnly.into()),
            Phases::Two(soil) => {
                let mut particles = particles.into_cast();
                particles.phase = liquid.into_iter().map(cast_liquid).collect();
                let phase: TwoPhase<T> = soil.cast();
                rest.stepper(basis, reconstruction, phase, particles)
            }
        }
    }
}

/// Whether there is no scene of two phases: relaxed TLS knows one phase only beyond one axis, and in space, where each
/// stepper takes seconds to compile, two phases are left to callers that name the types.
const fn one_phase_only<T, const D: usize, R>() -> bool
where
    T: Scalar,
    R: Reconstruction<T, D>,
{
    D > 2 || D == 2 && R::PARTICLE_MATRIX
}

/// What a stepper needs besides basis, reconstruction, phase and particles.
struct Rest<'a, T, const D: usize> {
    scene: &'a Scene,
    law: AnyLaw<T, D>,
    surface: Vec<SurfacePoint<f64>>,
    first_particles: Vec<usize>,
}

impl<T, const D: usize> Rest<'_, T, D> {
    /// An error of the initial stress with the body whose particle it is about.
    fn of_body(&self, error: SetupError) -> RunError {
        match error {
            SetupError::InitialStress {
                particle,
                position,
                stress,
                allowed,
            } => {
                let first = self.first_particles.iter().rposition(|&first| first <= particle);
                RunError::InitialStress {
                    body: first.unwrap_or(0),
                    position,
                    stress,
                    allowed,
                }
            }
            error => error.into(),
        }
    }

    fn stepper<B, R, P>(
        self,
        basis: B,
        mut reconstruction: R,
        phase: P,
        particles: Particles<T, D, (), P::Particle>,
    ) -> Built<D>
    where
        T: Scalar + Record<T> + Default,
        AnyLaw<T, D>: LawSweep<T, D, Number = T>,
        B: BasisFamily<T, D> + 'static,
        R: Reconstruction<T, D> + Clone + 'static,
        P: Phase<T, D> + Clone + 'static,
        P::Particle: Record<T>,
    {
        let states = self.law.at_rest(particles.len());
        let mut particles = particles.with_states(states);
        reconstruction.lend_virtual_points(self.scene.method.virtual_points);
        if self.scene.bodies.iter().any(|body| body.stress.is_some()) {
            let started = particles.start_under_stress(&self.law, |_, _| None);
            started.map_err(|error| self.of_body(error))?;
        }
        let stepper = Stepper::new(Setup {
            grid: grid(self.scene)?,
            basis,
            reconstruction,
            law: self.law,
            phase,
            velocity_mass: self.scene.method.velocity_mass,
            particles,
            surface: self.surface.iter().map(|point| point.cast()).collect(),
        })?;
        Ok(Box::new(stepper))
    }
}

fn cast_liquid<T: Scalar, const D: usize>(liquid: PoreLiquid<f64, D>) -> PoreLiquid<T, D> {
    PoreLiquid {
        velocity: liquid.velocity.map(T::lit),
        pressure: T::lit(liquid.pressure),
    }
}
