//! `[method]`

use super::Section;
use super::material::PhaseCount;
use crate::scene::{Basis, Method, ReconstructionKind, ScalarKind, SceneError};
use materialpoint::mass::VelocityMass;
use materialpoint::reconstruction::SubPoints;

const KEYS: [&str; 7] = [
    "basis",
    "degree",
    "reconstruction",
    "subpoints",
    "virtual_points",
    "velocity_mass",
    "scalar",
];

const RECONSTRUCTIONS: [(&str, ReconstructionKind); 4] = [
    ("shepard", ReconstructionKind::Shepard),
    ("taylor", ReconstructionKind::Taylor),
    ("relaxed-taylor", ReconstructionKind::RelaxedTaylor),
    ("spline", ReconstructionKind::Spline),
];

/// `dimension` is the number of the grid's axes.
pub(super) fn read(section: Section<'_>, dimension: usize, phases: PhaseCount) -> Result<Method, SceneError> {
    let section = section.allow(&KEYS, &[])?;
    let basis = basis(&section)?;
    let reconstruction = reconstruction(&section, dimension, phases)?;
    Ok(Method {
        basis,
        reconstruction,
        subpoints: subpoints(&section, basis, reconstruction)?,
        virtual_points: virtual_points(&section, dimension, reconstruction)?,
        velocity_mass: velocity_mass(&section, reconstruction)?,
        scalar: match section.optional("scalar") {
            Some(item) => item.choice(&[("f64", ScalarKind::F64), ("f32", ScalarKind::F32)], &[])?,
            None => ScalarKind::default(),
        },
    })
}

fn basis(section: &Section<'_>) -> Result<Basis, SceneError> {
    let item = section.required("basis", "\"linear\", \"dual-domain\" or \"bspline\"")?;
    let degree = section.optional("degree");
    let allowed = [
        ("linear", Basis::Linear),
        ("dual-domain", Basis::DualDomain),
        ("bspline", Basis::BSpline { degree: 2 }),
    ];
    match (item.choice(&allowed, &[])?, degree) {
        (Basis::BSpline { .. }, Some(degree)) => Ok(Basis::BSpline {
            degree: degree.size(1, 3)?,
        }),
        (_, Some(degree)) => {
            Err(degree.conflict("it goes with method.basis = \"bspline\" only; leave it out"))
        }
        (basis, None) => Ok(basis),
    }
}

fn reconstruction(
    section: &Section<'_>,
    dimension: usize,
    phases: PhaseCount,
) -> Result<ReconstructionKind, SceneError> {
    let item = section.required(
        "reconstruction",
        "\"shepard\", \"taylor\", \"relaxed-taylor\" or \"spline\"",
    )?;
    let reconstruction = item.choice(&RECONSTRUCTIONS, &[])?;
    if reconstruction == ReconstructionKind::Spline && dimension > 1 {
        return Err(item.conflict(&format!(
            "a cubic spline exists in 1-D only and the grid has {dimension} axes; expected \"shepard\", \"taylor\" or \"relaxed-taylor\""
        )));
    }
    if reconstruction == ReconstructionKind::RelaxedTaylor && phases == PhaseCount::Two && dimension > 1 {
        return Err(item
            .conflict("beyond one axis it knows one phase only so far; expected \"shepard\" or \"taylor\""));
    }
    Ok(reconstruction)
}

/// One sub-point is the particle itself.
fn subpoints(
    section: &Section<'_>,
    basis: Basis,
    reconstruction: ReconstructionKind,
) -> Result<u8, SceneError> {
    let Some(item) = section.optional("subpoints") else {
        return Ok(1);
    };
    if (basis, reconstruction) != (Basis::DualDomain, ReconstructionKind::Shepard) {
        return Err(item.conflict(
            "it goes with method.basis = \"dual-domain\" and method.reconstruction = \"shepard\" only; leave it out",
        ));
    }
    let count = item.count(1, SubPoints::MOST.into())?;
    u8::try_from(count).map_err(|_| item.not_allowed("a smaller number"))
}

/// None unless asked for.
fn virtual_points(
    section: &Section<'_>,
    dimension: usize,
    reconstruction: ReconstructionKind,
) -> Result<bool, SceneError> {
    let Some(item) = section.optional("virtual_points") else {
        return Ok(false);
    };
    let wanted = item.flag("true or false")?;
    if wanted && (reconstruction != ReconstructionKind::Taylor || dimension > 1) {
        return Err(item.conflict(
            "it goes with method.reconstruction = \"taylor\" in one dimension only; leave it out",
        ));
    }
    Ok(wanted)
}

fn velocity_mass(
    section: &Section<'_>,
    reconstruction: ReconstructionKind,
) -> Result<VelocityMass, SceneError> {
    let default = Method::default_velocity_mass(reconstruction);
    let Some(item) = section.optional("velocity_mass") else {
        return Ok(default);
    };
    let allowed = [
        ("consistent", VelocityMass::Consistent),
        ("constrained", VelocityMass::Constrained),
        ("lumped", VelocityMass::Lumped),
    ];
    let mass = item.choice(&allowed, &[])?;
    if reconstruction == ReconstructionKind::Shepard && mass != VelocityMass::Lumped {
        return Err(item.conflict("shepard is always lumped; expected \"lumped\", or leave it out"));
    }
    if reconstruction == ReconstructionKind::RelaxedTaylor && mass != VelocityMass::Constrained {
        return Err(
            item.conflict("relaxed-taylor is always constrained; expected \"constrained\", or leave it out")
        );
    }
    Ok(mass)
}
