//! From the names in a scene to the types of a stepper.

use nalgebra::SVector;

use super::error::RunError;
use super::initial::{Initial, initial};
use super::rate_law::RateLaw;
use crate::basis::BasisFamily;
use crate::error::{GridError, SetupError};
use crate::grid::Grid;
use crate::law::{ConstitutiveLaw, Hill, LinearElastic, Logarithmic, Moduli, NeoHookean};
use crate::method::MethodVisitor;
use crate::particles::Particles;
use crate::phase::{OnePhase, Phase, PoreLiquid, TwoPhase};
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::scene::{Law, Phases, ScalarKind, Scene};
use crate::stepper::{Setup, Simulation, Stepper, SurfacePoint};

/// Builds the stepper a scene asks for.
pub(super) fn build(scene: &Scene) -> Result<Box<dyn Simulation<1>>, RunError> {
    let grid = grid(scene)?;
    let start = Start {
        scene,
        initial: initial(scene, &grid)?,
    };
    match scene.method.scalar {
        ScalarKind::F64 => start.with_scalar::<f64>(),
        ScalarKind::F32 => start.with_scalar::<f32>(),
    }
}

fn grid<T: Scalar>(scene: &Scene) -> Result<Grid<T, 1>, GridError> {
    let bound = |values: &[f64]| SVector::from([T::lit(values.first().copied().unwrap_or(f64::NAN))]);
    let cells = scene.grid.cells.first().copied().unwrap_or(0);
    Grid::new(bound(&scene.grid.min), bound(&scene.grid.max), [cells])
}

struct Start<'a> {
    scene: &'a Scene,
    initial: Initial,
}

impl Start<'_> {
    fn with_scalar<T: Scalar>(self) -> Result<Box<dyn Simulation<1>>, RunError> {
        let uniaxial = |modulus: f64| Moduli::uniaxial(T::lit(modulus));
        match self.scene.material.law {
            Law::LinearElastic { youngs_modulus } => {
                let moduli = uniaxial(youngs_modulus)?;
                self.with_law(RateLaw::LinearElastic(LinearElastic { moduli }))
            }
            Law::Hill { youngs_modulus } => {
                let moduli = uniaxial(youngs_modulus)?;
                self.with_law(RateLaw::Hill(Hill { moduli }))
            }
            Law::NeoHookean { youngs_modulus } => {
                let moduli = uniaxial(youngs_modulus)?;
                self.with_law(NeoHookean { moduli })
            }
            Law::Logarithmic { youngs_modulus } => {
                let moduli = uniaxial(youngs_modulus)?;
                self.with_law(RateLaw::Logarithmic(Logarithmic { moduli }))
            }
        }
    }

    fn with_law<T, L>(self, law: L) -> Result<Box<dyn Simulation<1>>, RunError>
    where
        T: Scalar,
        L: ConstitutiveLaw<T, 1> + Clone + 'static,
    {
        let method = self.scene.method.method();
        let built = method.dispatch(WithLaw { start: self, law });
        built.unwrap_or(Err(RunError::NoSuchMethod(method)))
    }
}

/// Builds the stepper once basis and reconstruction are types.
struct WithLaw<'a, L> {
    start: Start<'a>,
    law: L,
}

impl<T, L> MethodVisitor<T> for WithLaw<'_, L>
where
    T: Scalar,
    L: ConstitutiveLaw<T, 1> + Clone + 'static,
{
    type Output = Result<Box<dyn Simulation<1>>, RunError>;

    fn visit<B, R>(self, basis: B, reconstruction: R) -> Self::Output
    where
        B: BasisFamily<T, 1> + Send + 'static,
        R: Reconstruction<T, 1> + Clone + Send + 'static,
    {
        let Self { start, law } = self;
        let Initial {
            particles,
            liquid,
            surface,
        } = start.initial;
        let rest = Rest {
            scene: start.scene,
            law,
            surface,
        };
        match start.scene.material.phases {
            Phases::One { .. } => rest.stepper(basis, reconstruction, OnePhase, particles.into_cast()),
            // Known at compile time: no stepper of two phases is built for a reconstruction that has none.
            Phases::Two(_) if R::PARTICLE_MATRIX => Err(SetupError::OnePhaseOnly.into()),
            Phases::Two(soil) => {
                let mut particles = particles.into_cast();
                particles.phase = liquid.into_iter().map(cast_liquid).collect();
                let phase: TwoPhase<T> = soil.cast();
                rest.stepper(basis, reconstruction, phase, particles)
            }
        }
    }
}

/// What a stepper needs besides basis, reconstruction, phase and particles.
struct Rest<'a, L> {
    scene: &'a Scene,
    law: L,
    surface: Vec<SurfacePoint<f64>>,
}

impl<L> Rest<'_, L> {
    fn stepper<T, B, R, P>(
        self,
        basis: B,
        reconstruction: R,
        phase: P,
        particles: Particles<T, 1, L::State, P::Particle>,
    ) -> Result<Box<dyn Simulation<1>>, RunError>
    where
        T: Scalar,
        B: BasisFamily<T, 1> + 'static,
        R: Reconstruction<T, 1> + Clone + 'static,
        L: ConstitutiveLaw<T, 1> + Clone + 'static,
        P: Phase<T, 1> + Clone + 'static,
    {
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

fn cast_liquid<T: Scalar>(liquid: PoreLiquid<f64, 1>) -> PoreLiquid<T, 1> {
    PoreLiquid {
        velocity: liquid.velocity.map(T::lit),
        pressure: T::lit(liquid.pressure),
    }
}
