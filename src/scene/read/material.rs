//! `[material]`

use super::{Item, Section};
use crate::phase::{Drag, TwoPhase};
use crate::scene::{Law, Material, Phases, SceneError};

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

const LAW: &str = "one law, such as law.linear-elastic = { youngs_modulus = 4e4 }";

#[derive(Clone, Copy, PartialEq)]
enum Strain {
    Small,
    Large,
}

#[derive(Clone, Copy)]
enum LawName {
    LinearElastic,
    NeoHookean,
    Logarithmic,
}

const LAWS: [(&str, LawName); 3] = [
    ("linear-elastic", LawName::LinearElastic),
    ("neo-hookean", LawName::NeoHookean),
    ("logarithmic", LawName::Logarithmic),
];

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
    let law_item = section.required("law", LAW)?;
    let (name, youngs_modulus, poissons_ratio) = law(&law_item, dimension)?;
    let phases = match phases {
        PhaseCount::One => one_phase(&section)?,
        PhaseCount::Two => two_phases(&section, gravity)?,
    };
    let law = match (name, strain) {
        (LawName::LinearElastic, Strain::Small) => Law::LinearElastic {
            youngs_modulus,
            poissons_ratio,
        },
        (LawName::LinearElastic, Strain::Large) => Law::Hill {
            youngs_modulus,
            poissons_ratio,
        },
        (LawName::NeoHookean, Strain::Large) => Law::NeoHookean {
            youngs_modulus,
            poissons_ratio,
        },
        (LawName::Logarithmic, Strain::Large) => Law::Logarithmic { youngs_modulus },
        (LawName::NeoHookean, Strain::Small) => {
            return Err(strain_item.conflict("the law neo-hookean is of large strain; expected \"large\""));
        }
        (LawName::Logarithmic, Strain::Small) => {
            return Err(strain_item.conflict("the law logarithmic is of large strain; expected \"large\""));
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

/// The one law in the table, its Young's modulus (Pa) and, beyond one dimension, Poisson's ratio.
fn law(item: &Item<'_>, dimension: usize) -> Result<(LawName, f64, f64), SceneError> {
    let section = item.section(LAW)?;
    let names = LAWS.map(|law| law.0);
    let section = section.allow(&names, &[])?;
    if section.items().len() > 1 {
        let problem = format!(
            "these are several laws; expected exactly one of {}",
            names.join(", ")
        );
        return Err(item.conflict(&problem));
    }
    for (name, law) in LAWS {
        if let Some(constants) = section.optional(name) {
            let constants = constants.section("a table, such as { youngs_modulus = 4e4 }")?;
            let constants = constants.allow(&["youngs_modulus", "poissons_ratio"], &[])?;
            let modulus = constants.required("youngs_modulus", "a positive number (Pa)")?;
            return Ok((
                law,
                modulus.positive("Pa")?,
                poissons_ratio(&constants, dimension)?,
            ));
        }
    }
    Err(section.missing(LAW))
}

/// One dimension feels the modulus of uniaxial strain alone, which scenes there call Young's.
fn poissons_ratio(constants: &Section<'_>, dimension: usize) -> Result<f64, SceneError> {
    let expected = "a number above -1 and below 0.5";
    if dimension > 1 {
        return constants
            .required("poissons_ratio", expected)?
            .number_where(expected, |ratio| ratio > -1.0 && ratio < 0.5);
    }
    match constants.optional("poissons_ratio") {
        None => Ok(0.0),
        Some(item) => Err(item.conflict(
            "one dimension knows uniaxial strain only, and youngs_modulus is its modulus; leave it out",
        )),
    }
}
