//! `[[boundary]]`

use super::material::PhaseCount;
use super::{Item, Section, check_over_time};
use crate::scene::expression::{COORDINATES, coordinates};
use crate::scene::text::one_of;
use crate::scene::{Boundary, BoundaryKind, Expression, GridSpec, PoreBoundary, SceneError};
use materialpoint::grid::{Face, Side};

const KEYS: [&str; 9] = [
    "face",
    "fixed",
    "roller",
    "friction",
    "velocity",
    "traction",
    "inside",
    "drained",
    "pore_pressure",
];
const KINDS: [&str; 5] = ["fixed", "roller", "friction", "velocity", "traction"];
const TWO_PHASE_KEYS: [&str; 2] = ["drained", "pore_pressure"];

pub(super) fn read(
    root: &Section<'_>,
    grid: &GridSpec,
    end: f64,
    phases: PhaseCount,
) -> Result<Vec<Boundary>, SceneError> {
    let Some(item) = root.optional("boundary") else {
        return Ok(Vec::new());
    };
    let mut boundaries: Vec<Boundary> = Vec::new();
    for entry in item.list("tables, written [[boundary]]")? {
        let section = entry.section("a table, written [[boundary]]")?;
        let section = section.allow(&KEYS, &[])?;
        phases.check(&section, &TWO_PHASE_KEYS)?;
        let face = face(&section, grid.cells.len())?;
        if let Some(other) = boundaries.iter().position(|other| other.face == face.1) {
            let problem =
                format!("boundary.{other} is about that face already; expected one [[boundary]] a face");
            return Err(face.0.conflict(&problem));
        }
        let pores = pores(&section, end)?;
        let kind = kind(&entry, &section, (grid.cells.len(), face.1.axis), end, phases)?;
        boundaries.push(Boundary {
            face: face.1,
            inside: inside(&section, &kind, grid)?,
            kind,
            pores,
        });
    }
    Ok(boundaries)
}

fn face<'a>(section: &Section<'a>, dimension: usize) -> Result<(Item<'a>, Face), SceneError> {
    let axes = (0..dimension).flat_map(|axis| [Side::Min, Side::Max].map(|side| Face { axis, side }));
    let faces: Vec<(String, Face)> = axes.map(|face| (face.to_string(), face)).collect();
    let allowed: Vec<(&str, Face)> = faces.iter().map(|(name, face)| (name.as_str(), *face)).collect();
    let item = section.required("face", &one_of(allowed.iter().map(|face| face.0)))?;
    let face = item.choice(&allowed, &[])?;
    Ok((item, face))
}

fn kind(
    entry: &Item<'_>,
    section: &Section<'_>,
    (dimension, axis): (usize, usize),
    end: f64,
    phases: PhaseCount,
) -> Result<BoundaryKind, SceneError> {
    let found = section.present(&KINDS);
    if found.is_empty() && !section.present(&TWO_PHASE_KEYS).is_empty() {
        return Ok(BoundaryKind::Free);
    }
    // A wall that rubs may move.
    let found = match found.as_slice() {
        ["friction", "velocity"] => vec!["friction"],
        _ => found,
    };
    let [kind] = found.as_slice() else {
        let found = match found.is_empty() {
            true => "none of them".to_string(),
            false => found.join(" and "),
        };
        let beside = match phases {
            PhaseCount::One => "",
            PhaseCount::Two => ", with or without drained or pore_pressure, or one of these alone",
        };
        let problem = format!(
            "expected exactly one of {}{beside}; found {found}",
            KINDS.join(", ")
        );
        return Err(entry.conflict(&problem));
    };
    let item = section.required(kind, "a value")?;
    match *kind {
        "fixed" => holds(&item, BoundaryKind::Fixed),
        "roller" => holds(&item, BoundaryKind::Roller),
        "friction" => {
            let expected = "a coefficient of friction, 0 or more";
            let coefficient = item.number_where(expected, |coefficient| coefficient >= 0.0)?;
            let velocity = section.optional("velocity");
            let velocity = match velocity {
                Some(item) => Some(along_the_wall(&item, dimension, end, axis)?),
                None => None,
            };
            Ok(BoundaryKind::Frictional {
                coefficient,
                velocity,
            })
        }
        "velocity" => Ok(BoundaryKind::Velocity(in_time(&item, dimension, end)?)),
        _ => Ok(BoundaryKind::Traction(in_time(&item, dimension, end)?)),
    }
}

/// The velocity of a wall that rubs, which runs along itself: the face stays where it is.
fn along_the_wall(
    item: &Item<'_>,
    dimension: usize,
    end: f64,
    axis: usize,
) -> Result<Vec<Expression>, SceneError> {
    let velocity = in_time(item, dimension, end)?;
    match velocity.get(axis).is_some_and(|across| !across.is_zero()) {
        true => Err(item.conflict(&format!(
            "a wall that rubs runs along itself; expected \"0\" along {}, or velocity without friction",
            COORDINATES.get(axis).unwrap_or(&"its normal")
        ))),
        false => Ok(velocity),
    }
}

/// Where a traction acts.
fn inside(
    section: &Section<'_>,
    kind: &BoundaryKind,
    grid: &GridSpec,
) -> Result<Option<Expression>, SceneError> {
    let Some(item) = section.optional("inside") else {
        return Ok(None);
    };
    if !matches!(kind, BoundaryKind::Traction(_)) {
        return Err(item.conflict("it says where a traction acts; expected traction beside it"));
    }
    item.expression(coordinates(grid.cells.len())).map(Some)
}

/// What the liquid meets; without a word it does not pass.
fn pores(section: &Section<'_>, end: f64) -> Result<PoreBoundary, SceneError> {
    let expected = "true; where no [[boundary]] says so the liquid does not pass";
    match (section.optional("drained"), section.optional("pore_pressure")) {
        (None, None) => Ok(PoreBoundary::Sealed),
        (Some(drained), Some(_)) => Err(drained.conflict(
            "there is pore_pressure too, the pressure outside, which drained sets to 0; expected one of them",
        )),
        (Some(drained), None) => match drained.flag(expected)? {
            true => Ok(PoreBoundary::Drained),
            false => Err(drained.not_allowed(expected)),
        },
        (None, Some(pressure)) => {
            let pressure = pressure.expression(&["t"])?;
            check_over_time(std::slice::from_ref(&pressure), end)?;
            Ok(PoreBoundary::Pressure(pressure))
        }
    }
}

/// A kind that is there or not.
fn holds(item: &Item<'_>, kind: BoundaryKind) -> Result<BoundaryKind, SceneError> {
    let expected = "true; a face that no [[boundary]] names is free";
    match item.flag(expected)? {
        true => Ok(kind),
        false => Err(item.not_allowed(expected)),
    }
}

fn in_time(item: &Item<'_>, dimension: usize, end: f64) -> Result<Vec<Expression>, SceneError> {
    let expressions = item.per_axis(dimension, "expressions in t", |e| e.expression(&["t"]))?;
    check_over_time(&expressions, end)?;
    Ok(expressions)
}
