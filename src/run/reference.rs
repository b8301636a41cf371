//! The reference that a scene names.

use super::error::RunError;
use crate::reference::{
    Hill, LagrangianBar, Linear, NeoHookean, Reference, ReferenceError, StaticColumn, Strain, VibratingBar,
};
use crate::scene::{Against, Law, ReferenceSpec, Scene};

/// Builds it, with whatever the scene says already.
pub(super) fn solution(scene: &Scene) -> Result<Option<Box<dyn Reference>>, RunError> {
    let (Some(reference), Some(body)) = (&scene.reference, scene.bodies.first()) else {
        return Ok(None);
    };
    let at = |values: &[f64]| values.first().copied().unwrap_or(f64::NAN);
    let problem = Problem {
        origin: at(&body.min),
        length: at(&body.max) - at(&body.min),
        density: scene.material.density,
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
    };
    Ok(Some(solution))
}

struct Problem {
    origin: f64,
    length: f64,
    density: f64,
    law: Law,
}

type Solution = Result<Box<dyn Reference>, ReferenceError>;

impl Problem {
    fn bar(&self, velocity: f64) -> Solution {
        let (length, density) = (self.length, self.density);
        match self.law {
            Law::LinearElastic { youngs_modulus } => {
                let bar = VibratingBar::new(length, density, youngs_modulus, velocity)?;
                Ok(Box::new(bar.with_origin(self.origin)?))
            }
            Law::Hill { youngs_modulus } => {
                let bar = LagrangianBar::vibrating_bar(length, density, velocity, Hill { youngs_modulus })?;
                Ok(Box::new(bar.with_origin(self.origin)?))
            }
            Law::NeoHookean { youngs_modulus } => {
                let law = neo_hookean(youngs_modulus);
                let bar = LagrangianBar::vibrating_bar(length, density, velocity, law)?;
                Ok(Box::new(bar.with_origin(self.origin)?))
            }
        }
    }

    fn static_column(&self, body_force: f64) -> Solution {
        let (strain, youngs_modulus) = match self.law {
            Law::LinearElastic { youngs_modulus } => (Strain::Small, youngs_modulus),
            Law::Hill { youngs_modulus } | Law::NeoHookean { youngs_modulus } => {
                (Strain::Large, youngs_modulus)
            }
        };
        let column = StaticColumn::new(self.length, self.density, youngs_modulus, body_force, strain)?;
        Ok(Box::new(column.with_origin(self.origin)?))
    }

    fn column(&self, body_force: f64, ramp: f64) -> Solution {
        let (length, density, origin) = (self.length, self.density, self.origin);
        match self.law {
            Law::LinearElastic { youngs_modulus } => {
                let law = Linear { youngs_modulus };
                let column = LagrangianBar::column(length, density, body_force, ramp, law)?;
                Ok(Box::new(column.with_origin(origin)?))
            }
            Law::Hill { youngs_modulus } => {
                let law = Hill { youngs_modulus };
                let column = LagrangianBar::column(length, density, body_force, ramp, law)?;
                Ok(Box::new(column.with_origin(origin)?))
            }
            Law::NeoHookean { youngs_modulus } => {
                let law = neo_hookean(youngs_modulus);
                let column = LagrangianBar::column(length, density, body_force, ramp, law)?;
                Ok(Box::new(column.with_origin(origin)?))
            }
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
