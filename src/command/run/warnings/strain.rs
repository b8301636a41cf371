//! Small strain that did not stay small.

use nalgebra::SMatrix;

use super::super::dispatch::grid;
use super::super::error::RunError;
use super::super::initial::initial;
use super::super::space::InSpace;
use crate::scene::{Law, Scene};
use materialpoint::law::{Moduli, hooke_strain};
use materialpoint::particles::Particles;

/// Principal strain beyond which small strain is no longer small: stresses and volumes are wrong by as much.
const MOST_STRAIN: f64 = 0.05;

/// A warning if the particles of a run in small strain were strained by much at its end. The strain is the
/// one that Hooke's law has for what the stress has changed by.
pub(crate) fn small_strain<const D: usize>(
    scene: &Scene,
    particles: &Particles<f64, D>,
    dt: f64,
) -> Result<Option<String>, RunError>
where
    Scene: InSpace<D>,
{
    let Law::LinearElastic {
        youngs_modulus,
        poissons_ratio,
    } = scene.material.law
    else {
        return Ok(None);
    };
    let moduli = Moduli::from_young(youngs_modulus, poissons_ratio)?;
    // Only a stress that was given was there before the strain.
    let given = scene.bodies.iter().any(|body| body.stress.is_some());
    let start = match given {
        true => initial(scene, &grid(scene)?, dt)?.particles.stress,
        false => Vec::new(),
    };
    let before = |p: usize| start.get(p).copied().unwrap_or_else(SMatrix::zeros);
    let changes = particles.stress.iter().enumerate();
    let strains = changes.map(|(p, stress)| largest(&hooke_strain(&moduli, &(stress - before(p)))));
    let (particle, strain) =
        strains.enumerate().fold(
            (0, 0.0_f64),
            |most, (p, strain)| {
                if strain > most.1 { (p, strain) } else { most }
            },
        );
    Ok((strain > MOST_STRAIN).then(|| {
        format!(
            "material.strain = \"small\", and the strain grew to {strain:.3} (particle {particle}): stresses \
             and volumes are wrong \
             by as much; take strain = \"large\", or look at the loads and the stiffness"
        )
    }))
}

/// The largest principal value by size.
fn largest<const D: usize>(strain: &SMatrix<f64, D, D>) -> f64 {
    materialpoint::tensor::Spectral::of(strain)
        .values
        .iter()
        .fold(0.0, |most: f64, e| most.max(e.abs()))
}
