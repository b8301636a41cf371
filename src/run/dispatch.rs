//! From the names in a scene to the types of a stepper.

use nalgebra::SVector;

use super::error::RunError;
use super::initial::{Initial, initial};
use crate::basis::BasisFamily;
use crate::error::GridError;
use crate::grid::Grid;
use crate::law::{ConstitutiveLaw, Hill, LinearElastic, Moduli, NeoHookean};
use crate::method::MethodVisitor;
use crate::phase::OnePhase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::scene::{Law, ScalarKind, Scene};
use crate::stepper::{Setup, Simulation, Stepper};

/// Builds the stepper a scene asks for.
pub(super) fn build(scene: &Scene) -> Result<Box<dyn Simulation<1>>, RunError> {
    let grid = grid(scene)?;
    let Initial { particles, surface } = initial(scene, &grid)?;
    let start = Start {
        scene,
        particles,
        surface,
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
    particles: crate::particles::Particles<f64, 1>,
    surface: Vec<crate::stepper::SurfacePoint<f64>>,
}

impl Start<'_> {
    fn with_scalar<T: Scalar>(self) -> Result<Box<dyn Simulation<1>>, RunError> {
        let uniaxial = |modulus: f64| Moduli::uniaxial(T::lit(modulus));
        match self.scene.material.law {
            Law::LinearElastic { youngs_modulus } => {
                let moduli = uniaxial(youngs_modulus)?;
                self.with_law(LinearElastic { moduli })
            }
            Law::Hill { youngs_modulus } => {
                let moduli = uniaxial(youngs_modulus)?;
                self.with_law(Hill { moduli })
            }
            Law::NeoHookean { youngs_modulus } => {
                let moduli = uniaxial(youngs_modulus)?;
                self.with_law(NeoHookean { moduli })
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
        let Start {
            scene,
            particles,
            surface,
        } = self.start;
        let surface = surface.iter().map(|point| point.cast()).collect();
        let stepper = Stepper::new(Setup {
            grid: grid(scene)?,
            basis,
            reconstruction,
            law: self.law,
            phase: OnePhase,
            velocity_mass: scene.method.velocity_mass,
            particles: particles.cast(),
            surface,
        })?;
        Ok(Box::new(stepper))
    }
}
