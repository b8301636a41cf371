//! What files hold of the particles: one list of names for every format.

use super::fields::{matrices, vectors};
use super::invariants::Invariants;
use crate::scene::{Phases, Scene};
use materialpoint::particles::Particles;
use materialpoint::phase::PoreLiquid;
use materialpoint::stepper::MaterialFields;

/// The particles at one moment, in the order in which the bodies were filled.
#[derive(Clone, Copy)]
pub(super) struct Snapshot<'a, const D: usize> {
    pub(super) particles: &'a Particles<f64, D>,
    /// Empty in one phase.
    pub(super) liquid: &'a [PoreLiquid<f64, D>],
    pub(super) law: &'a MaterialFields,
}

/// What a field has at each particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rank {
    Scalar,
    /// One number for each axis of the grid.
    Vector,
    /// `D D` numbers, column by column.
    Tensor,
}

/// A field of all particles.
pub(super) struct ParticleField {
    /// Stem of its name, the same in every format.
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) rank: Rank,
    /// Particle by particle.
    pub(super) values: Vec<f64>,
}

/// Name of the stress, which formats join with the one off the plane.
pub(super) fn stress_name(scene: &Scene) -> &'static str {
    match scene.material.phases {
        Phases::One { .. } => "stress",
        Phases::Two(_) => "effective_stress",
    }
}

/// The unit of an amount of each particle in one, two and three dimensions.
fn per_extent<const D: usize>(units: [&'static str; 3]) -> &'static str {
    units.get(D.wrapping_sub(1)).copied().unwrap_or("?")
}

impl<const D: usize> Snapshot<'_, D> {
    /// Hands over every field but the position now, one by one: first those that tables began with, in their
    /// order, then the rest. `bodies` are the numbers of particles of the bodies.
    pub(super) fn for_each(&self, scene: &Scene, bodies: &[usize], mut f: impl FnMut(ParticleField)) {
        let (particles, count) = (self.particles, self.particles.len());
        let mut field = |name, unit, rank, values| {
            f(ParticleField {
                name,
                unit,
                rank,
                values,
            });
        };
        let density = || (0..count).map(|p| particles.density(p)).collect();
        let volume_unit = per_extent::<D>(["m", "m2", "m3"]);
        let names = match scene.material.phases {
            Phases::One { .. } => ["u", "v"],
            Phases::Two(_) => ["u_solid", "v_solid"],
        };
        field(
            names[0],
            "m",
            Rank::Vector,
            vectors(particles.displacement.iter()),
        );
        field(names[1], "m/s", Rank::Vector, vectors(particles.velocity.iter()));
        if let Phases::Two(_) = scene.material.phases {
            let velocities = vectors(self.liquid.iter().map(|l| &l.velocity));
            field("v_liquid", "m/s", Rank::Vector, velocities);
        }
        field(
            stress_name(scene),
            "Pa",
            Rank::Tensor,
            matrices(&particles.stress),
        );
        match scene.material.phases {
            Phases::One { .. } => {
                field("density", "kg/m3", Rank::Scalar, density());
                field("volume", volume_unit, Rank::Scalar, particles.volume.clone());
            }
            Phases::Two(soil) => {
                let pressure = self.liquid.iter().map(|l| l.pressure).collect();
                field("pore_pressure", "Pa", Rank::Scalar, pressure);
                // A constant of the model, but a column that others read.
                field("porosity", "-", Rank::Scalar, vec![soil.porosity; count]);
                field("density", "kg/m3", Rank::Scalar, density());
                field("volume", volume_unit, Rank::Scalar, particles.volume.clone());
            }
        }
        let mass_unit = per_extent::<D>(["kg/m2", "kg/m", "kg"]);
        field("mass", mass_unit, Rank::Scalar, particles.mass.clone());
        self.for_each_of_law(scene, &mut field);
        let body = bodies.iter().enumerate();
        let body = body.flat_map(|(body, &count)| std::iter::repeat_n(body as f64, count));
        field("body", "-", Rank::Scalar, body.collect());
        field(
            "particle",
            "-",
            Rank::Scalar,
            (0..count).map(|p| p as f64).collect(),
        );
    }

    fn for_each_of_law(
        &self,
        scene: &Scene,
        field: &mut impl FnMut(&'static str, &'static str, Rank, Vec<f64>),
    ) {
        let invariants: Vec<_> = self.invariants().collect();
        if !invariants.is_empty() {
            let mean = match scene.material.phases {
                Phases::One { .. } => "mean_stress",
                Phases::Two(_) => "mean_effective_stress",
            };
            let values = invariants.iter().map(|i| i.mean).collect();
            field(mean, "Pa", Rank::Scalar, values);
            let values = invariants.iter().map(|i| i.von_mises).collect();
            field("von_mises", "Pa", Rank::Scalar, values);
        }
        if !self.law.plastic_strain.is_empty() {
            let values = self.law.plastic_strain.clone();
            field("plastic_strain", "-", Rank::Scalar, values);
        }
    }

    /// Mean and von Mises stress of the particles; none where the stress off the plane is not known, nor
    /// along one axis, where the law feels a modulus alone.
    pub(super) fn invariants(&self) -> impl Iterator<Item = Invariants> {
        invariants(&self.particles.stress, self.law)
    }
}

/// Mean and von Mises stress; see [`Snapshot::invariants`].
pub(crate) fn invariants<const D: usize>(
    stresses: &[nalgebra::SMatrix<f64, D, D>],
    law: &MaterialFields,
) -> impl Iterator<Item = Invariants> {
    let known = match D {
        1 => 0,
        2 => law.off_plane_stress.len(),
        _ => stresses.len(),
    };
    let off_plane = |p: usize| law.off_plane_stress.get(p).copied().unwrap_or(f64::NAN);
    let stresses = stresses.iter().take(known).enumerate();
    stresses.map(move |(p, stress)| Invariants::of(stress, off_plane(p)))
}
