//! What steppers of named methods are made of, and how.
//!
//! A [`Stepper`] is compiled for its basis, its reconstruction, its phases and its scalar: by the crates that
//! call [`stepper`], one for each dimension and scalar.

#![forbid(unsafe_code)]

use materialpoint::basis::BasisFamily;
use materialpoint::error::SetupError;
use materialpoint::grid::Grid;
use materialpoint::law::{AnyLaw, LawSweep};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::method::{KnownIn, Method, MethodVisitor, ReconstructionKind};
use materialpoint::particles::Particles;
use materialpoint::phase::{OnePhase, Phase, PoreLiquid, TwoPhase};
use materialpoint::reconstruction::Reconstruction;
use materialpoint::record::Record;
use materialpoint::scalar::Scalar;
use materialpoint::stepper::{Setup, Simulation, Stepper, SurfacePoint};
use thiserror::Error;

/// A stepper of the chosen types.
pub type Built<const D: usize> = Result<Box<dyn Simulation<D>>, BuildError>;

/// A stepper that cannot be built.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BuildError {
    /// The method does not exist here.
    #[error("there is no method {0} in so many dimensions")]
    NoSuchMethod(Method),
    /// The reconstruction of the method has another mass.
    #[error("this method has no mass behind its velocities that is {}", .0.name())]
    NoSuchMass(VelocityMass),
    /// What it is to be made of does not serve.
    #[error(transparent)]
    Setup(#[from] SetupError),
}

/// All that a stepper is made of besides its method.
#[derive(Clone, Debug)]
pub struct Parts<T, const D: usize> {
    /// Background grid.
    pub grid: Grid<T, D>,
    /// Constitutive law.
    pub law: AnyLaw<T, D>,
    /// The liquid in the pores, if there is one.
    pub liquid: Option<TwoPhase<T>>,
    /// Mass behind the DOF velocities, one that the method has.
    pub velocity_mass: VelocityMass,
    /// Whether published TLS takes virtual points where particles are few.
    pub virtual_points: bool,
    /// Particles in their initial state.
    pub particles: Particles<f64, D>,
    /// Their liquid, where there is one.
    pub pores: Vec<PoreLiquid<f64, D>>,
    /// Particles at surfaces.
    pub surface: Vec<SurfacePoint<T>>,
    /// Whether the law is asked for the states that belong to the particles' stress.
    pub under_stress: bool,
}

/// The stepper of a method. Compiled where it is called: once, in a crate of a dimension and a scalar.
///
/// # Errors
/// If there is no such method, or the parts do not serve.
pub fn stepper<T, const D: usize>(parts: Parts<T, D>, method: Method) -> Built<D>
where
    T: Scalar + Record<T> + Default,
    AnyLaw<T, D>: LawSweep<T, D, Number = T>,
    ReconstructionKind: KnownIn<D>,
{
    let built = method.dispatch(parts);
    built.unwrap_or(Err(BuildError::NoSuchMethod(method)))
}

impl<T, const D: usize> MethodVisitor<T, D> for Parts<T, D>
where
    T: Scalar + Record<T> + Default,
    AnyLaw<T, D>: LawSweep<T, D, Number = T>,
{
    type Output = Built<D>;

    fn lends_virtual_points(&self) -> bool {
        self.virtual_points
    }

    fn visit<B, R>(mut self, basis: B, reconstruction: R) -> Self::Output
    where
        B: BasisFamily<T, D> + Send + 'static,
        R: Reconstruction<T, D> + Clone + Send + 'static,
    {
        match self.liquid.take() {
            None => self.of_phase(basis, reconstruction, OnePhase, nothing),
            // Known at compile time: no stepper is built for what scenes refuse.
            Some(_) if const { one_phase_only::<T, D, R>() } => Err(SetupError::OnePhaseOnly.into()),
            Some(phase) => self.of_phase(basis, reconstruction, phase, cast_liquid),
        }
    }
}

/// Whether there is no scene of two phases: relaxed TLS knows one phase only beyond one axis.
const fn one_phase_only<T, const D: usize, R>() -> bool
where
    T: Scalar,
    R: Reconstruction<T, D>,
{
    D > 1 && R::Mass::IN_ACCELERATION
}

impl<T, const D: usize> Parts<T, D> {
    /// The stepper, with the data of the phase made of each particle's liquid.
    fn of_phase<B, R, P>(
        self,
        basis: B,
        reconstruction: R,
        phase: P,
        data: fn(PoreLiquid<f64, D>) -> P::Particle,
    ) -> Built<D>
    where
        T: Scalar + Record<T> + Default,
        AnyLaw<T, D>: LawSweep<T, D, Number = T>,
        B: BasisFamily<T, D> + 'static,
        R: Reconstruction<T, D> + Clone + 'static,
        P: Phase<T, D> + Clone + 'static,
        P::Particle: Record<T>,
    {
        let mass = R::Mass::named(self.velocity_mass);
        let mass = mass.ok_or(BuildError::NoSuchMass(self.velocity_mass))?;
        // All that may fail while it is whole, in a function that is compiled for no method.
        let Ready {
            grid,
            law,
            phase,
            particles,
            surface,
        } = self.ready(phase, data)?;
        let setup = Setup::new(grid, basis, reconstruction, law, phase, particles);
        let setup = setup.with_velocity_mass(mass).with_surface(surface);
        let stepper = Stepper::new(setup)?;
        Ok(Box::new(stepper))
    }

    /// What does not depend on the method.
    #[inline(never)]
    fn ready<P>(
        self,
        phase: P,
        data: fn(PoreLiquid<f64, D>) -> P::Particle,
    ) -> Result<Ready<T, D, P>, SetupError>
    where
        T: Scalar + Record<T> + Default,
        AnyLaw<T, D>: LawSweep<T, D, Number = T>,
        P: Phase<T, D>,
    {
        let pores = P::FLOWS.then_some(self.pores);
        let particles = made_of(self.particles, pores, data, &self.law, self.under_stress)?;
        Ok(Ready {
            grid: self.grid,
            law: self.law,
            phase,
            particles,
            surface: self.surface,
        })
    }
}

/// What a stepper of known phases is made of besides its method.
struct Ready<T: Scalar, const D: usize, P: Phase<T, D>> {
    grid: Grid<T, D>,
    law: AnyLaw<T, D>,
    phase: P,
    particles: Particles<T, D, T, P::Particle>,
    surface: Vec<SurfacePoint<T>>,
}

/// The particles with their liquid, if it flows, and their states.
#[inline(never)]
fn made_of<T, const D: usize, Q>(
    particles: Particles<f64, D>,
    pores: Option<Vec<PoreLiquid<f64, D>>>,
    data: fn(PoreLiquid<f64, D>) -> Q,
    law: &AnyLaw<T, D>,
    under_stress: bool,
) -> Result<Particles<T, D, T, Q>, SetupError>
where
    T: Scalar + Record<T> + Default,
    AnyLaw<T, D>: LawSweep<T, D, Number = T>,
    Q: Copy + Default,
{
    let mut particles = particles.into_cast::<T, (), Q>();
    if let Some(pores) = pores {
        particles.phase = pores.into_iter().map(data).collect();
    }
    let states = law.at_rest(particles.len());
    let mut particles = particles.with_states(states);
    if under_stress {
        particles.start_under_stress(law, |_, _| None)?;
    }
    Ok(particles)
}

fn nothing<const D: usize>(_: PoreLiquid<f64, D>) {}

fn cast_liquid<T: Scalar, const D: usize>(liquid: PoreLiquid<f64, D>) -> PoreLiquid<T, D> {
    PoreLiquid {
        velocity: liquid.velocity.map(T::lit),
        pressure: T::lit(liquid.pressure),
    }
}
