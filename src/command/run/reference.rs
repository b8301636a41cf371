//! The reference that a scene names.

mod two_phase;

use super::error::RunError;
use crate::scene::{Against, Law, ReferenceSpec, Scene};
use materialpoint::law::Moduli;
use materialpoint::reference::two_phase::TwoPhaseReference;
use materialpoint::reference::{
    FieldReference, Hill, LagrangianBar, Linear, Logarithmic, Manufactured, NeoHookean, Reference,
    ReferenceError, Ring, StaticColumn, Strain, Swing, VibratingBar, Vortex,
};

/// A solution for as many phases as the scene has.
pub(super) enum Solution {
    One(Box<dyn Reference>),
    Two(Box<dyn TwoPhaseReference>),
}

/// Builds it, with whatever the scene says already.
pub(super) fn solution(scene: &Scene) -> Result<Option<Solution>, RunError> {
    let (Some(reference), Some(body)) = (&scene.reference, scene.bodies.first()) else {
        return Ok(None);
    };
    let at = |values: &[f64]| values.first().copied().unwrap_or(f64::NAN);
    let problem = Problem {
        origin: at(&body.min),
        length: at(&body.max) - at(&body.min),
        density: scene.material.solid_density(),
        law: scene.material.law,
    };
    let solution = match *reference {
        ReferenceSpec::VibratingBar { velocity } => problem.bar(velocity)?,
        ReferenceSpec::ColumnCompaction {
            body_force,
            ramp,
            against,
        } => match against {
            Against::Static => problem.static_column(body_force)?,
            Against::Dynamic => problem.column(body_force, ramp)?,
        },
        reference => {
            let (origin, height) = (problem.origin, problem.length);
            return two_phase::solution(scene, reference, origin, height)
                .map(|solution| solution.map(Solution::Two));
        }
    };
    Ok(Some(Solution::One(solution)))
}

/// The scene's solution in space, if it names one.
pub(super) fn field_reference<const D: usize>(
    scene: &Scene,
) -> Result<Option<Box<dyn FieldReference<D>>>, RunError> {
    let Law::NeoHookean {
        youngs_modulus,
        poissons_ratio,
    } = scene.material.law
    else {
        return Ok(None);
    };
    let moduli = Moduli::from_young(youngs_modulus, poissons_ratio)?;
    let grid = super::dispatch::grid(scene)?;
    let density = scene.material.solid_density();
    Ok(match scene.reference {
        Some(ReferenceSpec::Manufactured { amplitude }) => {
            Some(Box::new(Manufactured::new(&grid, moduli, density, amplitude)?))
        }
        Some(ReferenceSpec::Vortex {
            inner,
            outer,
            angle,
            time,
        }) => {
            let centre = (grid.min() + grid.max()) / 2.0;
            let (ring, swing) = (Ring { inner, outer }, Swing { angle, time });
            Some(Box::new(Vortex::new(centre, ring, moduli, density, swing)?))
        }
        _ => None,
    })
}

struct Problem {
    origin: f64,
    length: f64,
    density: f64,
    law: Law,
}

type Built = Result<Box<dyn Reference>, ReferenceError>;

impl Problem {
    fn bar(&self, velocity: f64) -> Built {
        let (length, density) = (self.length, self.density);
        match self.law {
            Law::LinearElastic { youngs_modulus, .. } => {
                let bar = VibratingBar::new(length, density, youngs_modulus, velocity)?;
                Ok(Box::new(bar.with_origin(self.origin)?))
            }
            Law::Hill { youngs_modulus, .. } => {
                let bar = LagrangianBar::vibrating_bar(length, density, velocity, Hill { youngs_modulus })?;
                Ok(Box::new(bar.with_origin(self.origin)?))
            }
            Law::NeoHookean { youngs_modulus, .. } => {
                let law = neo_hookean(youngs_modulus);
                let bar = LagrangianBar::vibrating_bar(length, density, velocity, law)?;
                Ok(Box::new(bar.with_origin(self.origin)?))
            }
            Law::Logarithmic { youngs_modulus, .. } => {
                let law = Logarithmic { youngs_modulus };
                let bar = LagrangianBar::vibrating_bar(length, density, velocity, law)?;
                Ok(Box::new(bar.with_origin(self.origin)?))
            }
            Law::InSpace(law) => Err(ReferenceError::UnknownLaw { law: law.name() }),
        }
    }

    fn static_column(&self, body_force: f64) -> Built {
        let (strain, youngs_modulus) = match self.law {
            Law::LinearElastic { youngs_modulus, .. } => (Strain::Small, youngs_modulus),
            law => (Strain::Large, law.youngs_modulus()),
        };
        let column = StaticColumn::new(self.length, self.density, youngs_modulus, body_force, strain)?;
        Ok(Box::new(column.with_origin(self.origin)?))
    }

    fn column(&self, body_force: f64, ramp: f64) -> Built {
        let (length, density, origin) = (self.length, self.density, self.origin);
        match self.law {
            Law::LinearElastic { youngs_modulus, .. } => {
                let law = Linear { youngs_modulus };
                let column = LagrangianBar::column(length, density, body_force, ramp, law)?;
                Ok(Box::new(column.with_origin(origin)?))
            }
            Law::Hill { youngs_modulus, .. } => {
                let law = Hill { youngs_modulus };
                let column = LagrangianBar::column(length, density, body_force, ramp, law)?;
                Ok(Box::new(column.with_origin(origin)?))
            }
            Law::NeoHookean { youngs_modulus, .. } => {
                let law = neo_hookean(youngs_modulus);
                let column = LagrangianBar::column(length, density, body_force, ramp, law)?;
                Ok(Box::new(column.with_origin(origin)?))
            }
            Law::Logarithmic { youngs_modulus, .. } => {
                let law = Logarithmic { youngs_modulus };
                let column = LagrangianBar::column(length, density, body_force, ramp, law)?;
                Ok(Box::new(column.with_origin(origin)?))
            }
            Law::InSpace(law) => Err(ReferenceError::UnknownLaw { law: law.name() }),
        }
    }
}

/// The uniaxial law with Poisson's ratio 0, as in one-dimensional scenes.
fn neo_hookean(youngs_modulus: f64) -> NeoHookean {
    NeoHookean {
        lambda: 0.0,
        mu: youngs_modulus / 2.0,
    }
}
