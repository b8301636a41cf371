//! `[material]`

use super::{Item, Section};
use crate::scene::{Law, Material, SceneError};

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
}

const LAWS: [(&str, LawName); 2] = [
    ("linear-elastic", LawName::LinearElastic),
    ("neo-hookean", LawName::NeoHookean),
];

pub(super) fn read(section: Section<'_>) -> Result<Material, SceneError> {
    // First, so that a scene of two phases is told so, not that one of its keys is unknown.
    if let Some(item) = section.optional("phases") {
        match item.count(0, u64::MAX)? {
            1 => {}
            2 => return Err(item.not_in_this_version("1")),
            _ => return Err(item.not_allowed("1")),
        }
    }
    let section = section.allow(&KEYS, &TWO_PHASE_KEYS)?;
    let strain_item = section.required("strain", "\"small\" or \"large\"")?;
    let strain = strain_item.choice(&[("small", Strain::Small), ("large", Strain::Large)], &[])?;
    let (name, youngs_modulus) = law(&section.required("law", LAW)?)?;
    let density = section.required("density", "a positive number (kg/m3)")?;
    let law = match (name, strain) {
        (LawName::LinearElastic, Strain::Small) => Law::LinearElastic { youngs_modulus },
        (LawName::LinearElastic, Strain::Large) => Law::Hill { youngs_modulus },
        (LawName::NeoHookean, Strain::Large) => Law::NeoHookean { youngs_modulus },
        (LawName::NeoHookean, Strain::Small) => {
            return Err(strain_item.conflict("the law neo-hookean is of large strain; expected \"large\""));
        }
    };
    Ok(Material {
        density: density.positive("kg/m3")?,
        law,
    })
}

/// The one law in the table, and its Young's modulus (Pa).
fn law(item: &Item<'_>) -> Result<(LawName, f64), SceneError> {
    let section = item.section(LAW)?;
    let section = section.allow(&LAWS.map(|law| law.0), &["logarithmic"])?;
    if section.items().len() > 1 {
        let problem = "these are several laws; expected exactly one of linear-elastic, neo-hookean";
        return Err(item.conflict(problem));
    }
    for (name, law) in LAWS {
        if let Some(constants) = section.optional(name) {
            let constants = constants.section("a table, such as { youngs_modulus = 4e4 }")?;
            let constants = constants.allow(&["youngs_modulus"], &["poissons_ratio"])?;
            let modulus = constants.required("youngs_modulus", "a positive number (Pa)")?;
            return Ok((law, modulus.positive("Pa")?));
        }
    }
    Err(section.missing(LAW))
}
