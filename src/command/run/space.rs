//! What differs between one, two and three dimensions: the laws, and the references.

use nalgebra::SVector;

use super::dispatch::{Built, Start};
use super::error::RunError;
use super::norms::Exact;
use super::reference::{field_reference, solution};
use super::schedule::Schedule;
use super::state::{self, InitialState, Values, by_expressions};
use crate::scene::{Body, Law, ScalarKind, Scene, SpaceLaw};
use materialpoint::error::SetupError;
use materialpoint::grid::Grid;
use materialpoint::law::{
    AnyLaw, ConeMatch, DruckerPrager, Hencky, Hill, LinearElastic, Logarithmic, Moduli, NeoHookean,
    NewtonianFluid, StVenantKirchhoff, Strength, VonMises,
};
use materialpoint::particles::Particles;
use materialpoint::record::Record;
use materialpoint::reference::FieldReference;
use materialpoint::scalar::Scalar;

/// A scene in `D` dimensions: implemented for those that there are.
pub trait InSpace<const D: usize> {
    /// The stepper that the scene asks for, for steps of `dt` (s).
    ///
    /// # Errors
    /// See [`RunError`].
    fn build(&self, dt: f64) -> Built<D>;

    /// What `body` starts with.
    ///
    /// # Errors
    /// See [`RunError`].
    fn initial_state<'a>(
        &'a self,
        body: &'a Body,
        grid: &Grid<f64, D>,
        dt: f64,
    ) -> Result<InitialState<'a, D>, RunError>;

    /// The reference at the end, at the particles' material points.
    ///
    /// # Errors
    /// See [`RunError`].
    fn exact(&self, particles: &Particles<f64, D>, schedule: &Schedule) -> Result<Exact, RunError>;

    /// The reference whose body force drives the run.
    ///
    /// # Errors
    /// See [`RunError`].
    fn driver(&self) -> Result<Option<Box<dyn FieldReference<D>>>, RunError>;
}

impl InSpace<1> for Scene {
    fn build(&self, dt: f64) -> Built<1> {
        let start = Start::new(self, dt)?;
        match self.method.scalar {
            ScalarKind::F64 => start.with_law(uniaxial::<f64>(self.material.law)?),
            ScalarKind::F32 => start.with_law(uniaxial::<f32>(self.material.law)?),
        }
    }

    fn initial_state<'a>(
        &'a self,
        body: &'a Body,
        grid: &Grid<f64, 1>,
        _dt: f64,
    ) -> Result<InitialState<'a, 1>, RunError> {
        state::on_one_axis(self, body, grid)
    }

    fn exact(&self, particles: &Particles<f64, 1>, schedule: &Schedule) -> Result<Exact, RunError> {
        match solution(self)? {
            None => Ok(Exact::default()),
            Some(solution) => Exact::on_one_axis(self, solution, particles, schedule),
        }
    }

    fn driver(&self) -> Result<Option<Box<dyn FieldReference<1>>>, RunError> {
        Ok(None)
    }
}

/// A law of one axis.
fn uniaxial<T: Scalar + Record<T>>(law: Law) -> Result<AnyLaw<T, 1>, RunError> {
    let moduli = Moduli::uniaxial(T::lit(law.youngs_modulus()))?;
    Ok(match law {
        Law::LinearElastic { .. } => AnyLaw::new(LinearElastic { moduli }),
        Law::Hill { .. } => AnyLaw::new(Hill { moduli }),
        Law::Logarithmic { .. } => AnyLaw::new(Logarithmic { moduli }),
        Law::NeoHookean { .. } => AnyLaw::new(NeoHookean { moduli }),
        Law::InSpace(law) => {
            return Err(RunError::NoSuchLaw {
                law: law.name(),
                dimension: 1,
            });
        }
    })
}

/// A law of two or three axes.
fn law_in_space<const D: usize>(law: Law) -> Result<AnyLaw<f64, D>, SetupError> {
    let moduli = Moduli::from_young;
    Ok(match law {
        Law::LinearElastic {
            youngs_modulus,
            poissons_ratio,
        } => {
            let moduli = moduli(youngs_modulus, poissons_ratio)?;
            AnyLaw::new(LinearElastic { moduli })
        }
        Law::Hill {
            youngs_modulus,
            poissons_ratio,
        } => {
            let moduli = moduli(youngs_modulus, poissons_ratio)?;
            AnyLaw::new(Hill { moduli })
        }
        Law::NeoHookean {
            youngs_modulus,
            poissons_ratio,
        } => {
            let moduli = moduli(youngs_modulus, poissons_ratio)?;
            AnyLaw::new(NeoHookean { moduli })
        }
        Law::Logarithmic {
            youngs_modulus,
            poissons_ratio,
        } => {
            let moduli = moduli(youngs_modulus, poissons_ratio)?;
            AnyLaw::new(Hencky { moduli })
        }
        Law::InSpace(law) => in_space_only(law)?,
    })
}

fn in_space_only<const D: usize>(law: SpaceLaw) -> Result<AnyLaw<f64, D>, SetupError> {
    let moduli = Moduli::from_young;
    Ok(match law {
        SpaceLaw::StVenantKirchhoff {
            youngs_modulus,
            poissons_ratio,
        } => {
            let moduli = moduli(youngs_modulus, poissons_ratio)?;
            AnyLaw::new(StVenantKirchhoff { moduli })
        }
        SpaceLaw::VonMises {
            youngs_modulus,
            poissons_ratio,
            yield_stress,
            hardening,
        } => {
            let moduli = moduli(youngs_modulus, poissons_ratio)?;
            AnyLaw::new(VonMises::new(moduli, yield_stress, hardening)?)
        }
        SpaceLaw::DruckerPrager {
            youngs_modulus,
            poissons_ratio,
            cohesion,
            friction_angle,
            dilation_angle,
        } => {
            let strength = Strength {
                cohesion,
                friction_angle: friction_angle.to_radians(),
                dilation_angle: dilation_angle.to_radians(),
            };
            let moduli = moduli(youngs_modulus, poissons_ratio)?;
            AnyLaw::new(DruckerPrager::new(moduli, &strength, ConeMatch::PlaneStrain)?)
        }
        SpaceLaw::NewtonianFluid {
            bulk_modulus,
            gamma,
            viscosity,
        } => AnyLaw::new(NewtonianFluid::new(bulk_modulus, gamma, viscosity)?),
    })
}

macro_rules! beyond_one_axis {
    ($dimension:literal) => {
        impl InSpace<$dimension> for Scene {
            fn build(&self, dt: f64) -> Built<$dimension> {
                let start = Start::new(self, dt)?;
                start.with_law(law_in_space::<$dimension>(self.material.law)?)
            }

            fn initial_state<'a>(
                &'a self,
                body: &'a Body,
                _grid: &Grid<f64, $dimension>,
                dt: f64,
            ) -> Result<InitialState<'a, $dimension>, RunError> {
                match self.driver()? {
                    None => Ok(Box::new(move |x| by_expressions(body, x))),
                    Some(reference) => {
                        // The first kick leads from where the velocity lives at the start to half a step
                        // after it.
                        let before = if self.time.half_kick { 0.0 } else { dt / 2.0 };
                        Ok(Box::new(move |x| {
                            Ok(started(reference.as_ref(), x, before))
                        }))
                    }
                }
            }

            fn exact(
                &self,
                particles: &Particles<f64, $dimension>,
                schedule: &Schedule,
            ) -> Result<Exact, RunError> {
                match self.driver()? {
                    None => Ok(Exact::default()),
                    Some(reference) => Ok(Exact::in_space(reference.as_ref(), particles, schedule)),
                }
            }

            fn driver(&self) -> Result<Option<Box<dyn FieldReference<$dimension>>>, RunError> {
                field_reference(self)
            }
        }
    };
}

beyond_one_axis!(2);
beyond_one_axis!(3);

/// The reference's state at the start, its velocity a time `before` (s), where the stepper's lives.
fn started<const D: usize>(reference: &dyn FieldReference<D>, x: &SVector<f64, D>, before: f64) -> Values<D> {
    let at_start = reference.at(x, 0.0);
    let velocity = reference.at(x, -before).velocity;
    Values {
        displacement: at_start.displacement,
        velocity,
        stress: at_start.stress,
        liquid_velocity: velocity,
        pore_pressure: 0.0,
    }
}
