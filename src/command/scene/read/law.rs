//! `material.law`: the table's name is the law.

use super::{Item, Section};
use crate::scene::{Law, SceneError, SpaceLaw};

/// What the key takes.
pub(super) const EXPECTED: &str = "one law, such as law.linear-elastic = { youngs_modulus = 4e4 }";

type Read = fn(Section<'_>, usize) -> Result<Law, SceneError>;

const LAWS: [(&str, Read); 7] = [
    ("linear-elastic", linear_elastic),
    ("neo-hookean", neo_hookean),
    ("logarithmic", logarithmic),
    ("st-venant-kirchhoff", st_venant_kirchhoff),
    ("von-mises", von_mises),
    ("drucker-prager", drucker_prager),
    ("newtonian-fluid", newtonian_fluid),
];

/// Those that need more than one axis come last.
const FIRST_IN_SPACE: usize = 3;

/// The one law in the table; linear-elastic as that of large strain.
pub(super) fn read(item: &Item<'_>, dimension: usize) -> Result<Law, SceneError> {
    let section = item.section(EXPECTED)?;
    let names = LAWS.map(|law| law.0);
    let section = section.allow(&names, &[])?;
    if section.items().len() > 1 {
        let problem = format!(
            "these are several laws; expected exactly one of {}",
            names.join(", ")
        );
        return Err(item.conflict(&problem));
    }
    for (place, (name, read)) in LAWS.iter().enumerate() {
        if let Some(constants) = section.optional(name) {
            if place >= FIRST_IN_SPACE && dimension == 1 {
                return Err(constants.conflict(
                    "it is a law of two and three dimensions; expected linear-elastic, neo-hookean or logarithmic",
                ));
            }
            return read(constants.section("a table of constants")?, dimension);
        }
    }
    Err(section.missing(EXPECTED))
}

/// Young's modulus (Pa) and Poisson's ratio, beside which the law may have the `other` constants.
fn elastic<'a>(
    constants: Section<'a>,
    dimension: usize,
    other: &[&str],
) -> Result<(Section<'a>, f64, f64), SceneError> {
    let known = [&["youngs_modulus", "poissons_ratio"], other].concat();
    let constants = constants.allow(&known, &[])?;
    let modulus = constants
        .required("youngs_modulus", "a positive number (Pa)")?
        .positive("Pa")?;
    let ratio = poissons_ratio(&constants, dimension)?;
    Ok((constants, modulus, ratio))
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

fn linear_elastic(constants: Section<'_>, dimension: usize) -> Result<Law, SceneError> {
    let (_, youngs_modulus, poissons_ratio) = elastic(constants, dimension, &[])?;
    Ok(Law::Hill {
        youngs_modulus,
        poissons_ratio,
    })
}

fn neo_hookean(constants: Section<'_>, dimension: usize) -> Result<Law, SceneError> {
    let (_, youngs_modulus, poissons_ratio) = elastic(constants, dimension, &[])?;
    Ok(Law::NeoHookean {
        youngs_modulus,
        poissons_ratio,
    })
}

fn logarithmic(constants: Section<'_>, dimension: usize) -> Result<Law, SceneError> {
    let (_, youngs_modulus, poissons_ratio) = elastic(constants, dimension, &[])?;
    Ok(Law::Logarithmic {
        youngs_modulus,
        poissons_ratio,
    })
}

fn st_venant_kirchhoff(constants: Section<'_>, dimension: usize) -> Result<Law, SceneError> {
    let (_, youngs_modulus, poissons_ratio) = elastic(constants, dimension, &[])?;
    Ok(Law::InSpace(SpaceLaw::StVenantKirchhoff {
        youngs_modulus,
        poissons_ratio,
    }))
}

fn von_mises(constants: Section<'_>, dimension: usize) -> Result<Law, SceneError> {
    let other = ["yield_stress", "hardening"];
    let (constants, youngs_modulus, poissons_ratio) = elastic(constants, dimension, &other)?;
    let yield_stress = constants.required("yield_stress", "a positive number (Pa)")?;
    Ok(Law::InSpace(SpaceLaw::VonMises {
        youngs_modulus,
        poissons_ratio,
        yield_stress: yield_stress.positive("Pa")?,
        hardening: not_negative(&constants, "hardening", "a number (Pa), 0 or more")?,
    }))
}

fn drucker_prager(constants: Section<'_>, dimension: usize) -> Result<Law, SceneError> {
    let other = ["cohesion", "friction_angle", "dilation_angle"];
    let (constants, youngs_modulus, poissons_ratio) = elastic(constants, dimension, &other)?;
    let expected = "an angle (degrees), 0 or more and below 90";
    let friction_angle = constants
        .required("friction_angle", expected)?
        .number_where(expected, |angle| (0.0..90.0).contains(&angle))?;
    let expected = format!("an angle (degrees) from 0 to the friction angle, {friction_angle:?}");
    let dilation_angle = match constants.optional("dilation_angle") {
        None => 0.0,
        Some(item) => item.number_where(&expected, |angle| (0.0..=friction_angle).contains(&angle))?,
    };
    Ok(Law::InSpace(SpaceLaw::DruckerPrager {
        youngs_modulus,
        poissons_ratio,
        cohesion: not_negative(&constants, "cohesion", "a number (Pa), 0 or more")?,
        friction_angle,
        dilation_angle,
    }))
}

fn newtonian_fluid(constants: Section<'_>, _dimension: usize) -> Result<Law, SceneError> {
    let constants = constants.allow(&["bulk_modulus", "gamma", "viscosity"], &[])?;
    let bulk_modulus = constants.required("bulk_modulus", "a positive number (Pa)")?;
    let expected = "an exponent of at least 1, such as 7 for water";
    Ok(Law::InSpace(SpaceLaw::NewtonianFluid {
        bulk_modulus: bulk_modulus.positive("Pa")?,
        gamma: match constants.optional("gamma") {
            None => 7.0,
            Some(item) => item.number_where(expected, |gamma| gamma >= 1.0)?,
        },
        viscosity: not_negative(&constants, "viscosity", "a number (Pa s), 0 or more")?,
    }))
}

/// A constant that is 0 unless told.
fn not_negative(constants: &Section<'_>, name: &str, expected: &str) -> Result<f64, SceneError> {
    match constants.optional(name) {
        None => Ok(0.0),
        Some(item) => item.number_where(expected, |number| number >= 0.0),
    }
}
