//! References of two phases.

use super::super::error::RunError;
use super::neo_hookean;
use crate::scene::{Law, Phases, ReferenceSpec, Scene};
use materialpoint::phase::TwoPhase;
use materialpoint::reference::two_phase::{
    Consolidation, LagrangianSoil, SaturatedColumn, Soil, StandingWave, TwoPhaseReference, XieLeo,
};
use materialpoint::reference::{Hill, Logarithmic, ReferenceError, UniaxialLaw};

type Built = Result<Option<Box<dyn TwoPhaseReference>>, RunError>;

/// Builds the one that the scene names, for a column of `height` (m) that stands on `origin` (m).
pub(super) fn solution(scene: &Scene, reference: ReferenceSpec, origin: f64, height: f64) -> Built {
    let Phases::Two(phases) = scene.material.phases else {
        return Ok(None);
    };
    let (soil, modulus) = (soil(&phases), scene.material.law.youngs_modulus());
    Ok(match reference {
        ReferenceSpec::Consolidation { load, .. } => {
            let layer = Layer {
                origin,
                height,
                load,
                soil,
            };
            Some(match scene.material.law {
                Law::LinearElastic { youngs_modulus, .. } => layer.small(youngs_modulus)?,
                Law::Hill { youngs_modulus, .. } => layer.large(Hill { youngs_modulus })?,
                Law::NeoHookean { youngs_modulus, .. } => layer.large(neo_hookean(youngs_modulus))?,
                Law::Logarithmic { youngs_modulus, .. } => layer.large(Logarithmic { youngs_modulus })?,
                Law::InSpace(law) => return Err(ReferenceError::UnknownLaw { law: law.name() }.into()),
            })
        }
        ReferenceSpec::XieLeo { load } => {
            let layer = XieLeo::new(height, modulus, load, soil)?;
            Some(Box::new(layer.with_origin(origin)?))
        }
        ReferenceSpec::StandingWave { velocity, mode } => {
            let wave = StandingWave::new(height, modulus, soil, mode, velocity)?;
            Some(Box::new(wave.with_origin(origin)?))
        }
        ReferenceSpec::SelfWeight => {
            let column = SaturatedColumn::new(height, modulus, 0.0, soil)?;
            Some(Box::new(column.with_origin(origin)?))
        }
        ReferenceSpec::VibratingBar { .. }
        | ReferenceSpec::ColumnCompaction { .. }
        | ReferenceSpec::Manufactured { .. }
        | ReferenceSpec::Vortex { .. } => None,
    })
}

/// A layer that consolidates.
struct Layer {
    origin: f64,
    height: f64,
    load: f64,
    soil: Soil,
}

impl Layer {
    fn small(self, modulus: f64) -> Result<Box<dyn TwoPhaseReference>, RunError> {
        let layer = Consolidation::new(self.height, modulus, self.load, self.soil)?;
        Ok(Box::new(layer.with_origin(self.origin)?))
    }

    fn large<L: UniaxialLaw + Clone + 'static>(self, law: L) -> Result<Box<dyn TwoPhaseReference>, RunError> {
        let layer = LagrangianSoil::consolidation(self.height, self.load, self.soil, law)?;
        Ok(Box::new(layer.with_origin(self.origin)?))
    }
}

fn soil(phases: &TwoPhase<f64>) -> Soil {
    Soil {
        porosity: phases.porosity,
        solid_density: phases.solid_density,
        liquid_density: phases.liquid_density,
        liquid_bulk_modulus: phases.liquid_bulk_modulus,
        permeability: phases.permeability,
        permeability_exponent: phases.permeability_exponent,
        gravity: phases.gravity,
    }
}
