//! `[material]`

use super::{Section, law};
use crate::scene::{Law, Material, Phases, SceneError};
use materialpoint::phase::{Drag, TwoPhase};

const KEYS: [&str; 4] = ["phases", "strain", "law", "density"];

const TWO_PHASE_KEYS: [&str; 7] = [
    "porosity",
    "solid_density",
    "liquid_density",
    "liquid_bulk_modulus",
    "permeability",
    "permeability_exponent",
    "drag",
];

#[derive(Clone, Copy, PartialEq)]
enum Strain {
    Small,
    Large,
}

/// How many phases a scene has: which keys it may use elsewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PhaseCount {
    One,
    Two,
}

impl PhaseCount {
    /// Refuses the given keys of two phases in a scene of one.
    pub(super) fn check(self, section: &Section<'_>, two_phase_keys: &[&str]) -> Result<(), SceneError> {
        if self == Self::Two {
            return Ok(());
        }
        let present = section.present(two_phase_keys);
        match present.first().and_then(|name| section.optional(name)) {
            Some(item) => {
                Err(item.conflict("it goes with material.phases = 2 only; leave it out, or set that"))
            }
            None => Ok(()),
        }
    }
}

/// `material.phases`, which the rest of the scene is read with.
pub(super) fn phases(root: &Section<'_>) -> Result<PhaseCount, SceneError> {
    let Some(item) = root.section("material")?.optional("phases") else {
        return Ok(PhaseCount::One);
    };
    match item.count(0, u64::MAX)? {
        1 => Ok(PhaseCount::One),
        2 => Ok(PhaseCount::Two),
        _ => Err(item.not_allowed("1 (a dry solid) or 2 (a solid and the liquid in its pores)")),
    }
}

/// `gravity` (m/s2) is that of the liquid's unit weight.
/// `dimension` is the number of the grid's axes.
pub(super) fn read(
    section: Section<'_>,
    dimension: usize,
    phases: PhaseCount,
    gravity: f64,
) -> Result<Material, SceneError> {
    let keys = [&KEYS[..], &TWO_PHASE_KEYS].concat();
    let known = match phases {
        // A key of two phases is known, and refused as such below.
        PhaseCount::One if section.present(&TWO_PHASE_KEYS).is_empty() => &KEYS[..],
        _ => &keys,
    };
    let section = section.allow(known, &[])?;
    phases.check(&section, &TWO_PHASE_KEYS)?;
    let strain_item = section.required("strain", "\"small\" or \"large\"")?;
    let strain = strain_item.choice(&[("small", Strain::Small), ("large", Strain::Large)], &[])?;
    let law = law::read(&section.required("law", law::EXPECTED)?, dimension)?;
    let phases = match phases {
        PhaseCount::One => one_phase(&section)?,
        PhaseCount::Two => two_phases(&section, gravity)?,
    };
    let law = match (law, strain) {
        (
            Law::Hill {
                youngs_modulus,
                poissons_ratio,
            },
            Strain::Small,
        ) => Law::LinearElastic {
            youngs_modulus,
            poissons_ratio,
        },
        (law, Strain::Large) => law,
        (law, Strain::Small) => {
            let problem = format!("the law {} is of large strain; expected \"large\"", law.name());
            return Err(strain_item.conflict(&problem));
        }
    };
    Ok(Material { phases, law })
}

fn one_phase(section: &Section<'_>) -> Result<Phases, SceneError> {
    let density = section.required("density", "a positive number (kg/m3)")?;
    Ok(Phases::One {
        density: density.positive("kg/m3")?,
    })
}

fn two_phases(section: &Section<'_>, gravity: f64) -> Result<Phases, SceneError> {
    if let Some(density) = section.optional("density") {
        return Err(density
            .conflict("two phases have porosity, solid_density and liquid_density instead; leave it out"));
    }
    let positive = |name: &str, unit: &str| {
        let item = section.required(name, &format!("a positive number ({unit})"))?;
        item.positive(unit)
    };
    let porosity = "the liquid's share of the volume, above 0 and below 1";
    Ok(Phases::Two(TwoPhase {
        porosity: section
            .required("porosity", porosity)?
            .number_where(porosity, |n| n > 0.0 && n < 1.0)?,
        solid_density: positive("solid_density", "kg/m3")?,
        liquid_density: positive("liquid_density", "kg/m3")?,
        liquid_bulk_modulus: positive("liquid_bulk_modulus", "Pa")?,
        permeability: positive("permeability", "m/s")?,
        permeability_exponent: match section.optional("permeability_exponent") {
            Some(item) => item.number("a finite number")?,
            None => 0.0,
        },
        gravity,
        drag: match section.optional("drag") {
            Some(item) => item.choice(
                &[Drag::Implicit, Drag::Explicit].map(|drag| (drag.name(), drag)),
                &[],
            )?,
            None => Drag::default(),
        },
    }))
}
