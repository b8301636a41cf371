//! `[[body]]`

use super::grid::{is_blurred, precision_hint};
use super::material::PhaseCount;
use super::overlap::overlap;
use super::{Item, MOST, Section};
use crate::scene::expression::{COORDINATES, coordinates};
use crate::scene::{
    Body, Expression, FORGIVEN, GridSpec, Initialise, Law, ScalarKind, SceneError, StressSpec,
};

const KEYS: [&str; 11] = [
    "min",
    "max",
    "inside",
    "particles_per_cell",
    "velocity",
    "stress",
    "liquid_velocity",
    "pore_pressure",
    "jitter",
    "seed",
    "initialise",
];

const TWO_PHASE_KEYS: [&str; 2] = ["liquid_velocity", "pore_pressure"];

pub(super) fn read(
    root: &Section<'_>,
    grid: &GridSpec,
    scalar: ScalarKind,
    phases: PhaseCount,
) -> Result<Vec<Body>, SceneError> {
    let expected = "at least one table, written [[body]]";
    let item = root.required("body", expected)?;
    let entries = item.list(expected)?;
    if entries.is_empty() {
        return Err(item.not_allowed(expected));
    }
    let mut bodies: Vec<Body> = Vec::new();
    let mut particles = 0.0;
    for entry in &entries {
        let section = entry.section(expected)?.allow(&KEYS, &[])?;
        phases.check(&section, &TWO_PHASE_KEYS)?;
        let body = one(&section, grid)?;
        let per_cell = section.required("particles_per_cell", expected)?;
        particles += check_particles(&per_cell, &body, grid, scalar)?;
        if particles > MOST as f64 {
            let problem =
                format!("that makes {particles:e} particles; expected at most {MOST} in all bodies");
            return Err(per_cell.conflict(&problem));
        }
        // After the number of particles is known to be within reason: they may all be looked at.
        for (index, other) in bodies.iter().enumerate() {
            if let Some(much) = overlap(&body, other, grid)? {
                let problem =
                    format!("the body overlaps body.{index} {much}; expected bodies that at most touch");
                return Err(section.required("min", expected)?.conflict(&problem));
            }
        }
        bodies.push(body);
    }
    Ok(bodies)
}

/// Refuses, along one axis, a given stress where the law's state, the deformation, is what stress follows
/// from.
pub(super) fn check_stress(root: &Section<'_>, law: Law, dimension: usize) -> Result<(), SceneError> {
    if dimension > 1 || !matches!(law, Law::NeoHookean { .. }) {
        return Ok(());
    }
    let expected = "at least one table, written [[body]]";
    for entry in root.required("body", expected)?.list(expected)? {
        if let Some(stress) = entry.section(expected)?.optional("stress") {
            return Err(stress.conflict(
                "the stress of a neo-hookean body follows from its deformation, and it starts undeformed; leave it out",
            ));
        }
    }
    Ok(())
}

fn one(section: &Section<'_>, grid: &GridSpec) -> Result<Body, SceneError> {
    let dimension = grid.cells.len();
    let (min, max) = corners(section, grid)?;
    let per_cell = section.required("particles_per_cell", "a list of whole numbers, one per axis")?;
    let body = Body {
        particles_per_cell: per_cell.per_axis(dimension, "whole numbers", |n| n.size(1, MOST))?,
        velocity: vector(section, "velocity", dimension)?,
        inside: number(section, "inside", dimension)?,
        stress: stress(section, dimension)?,
        liquid_velocity: vector(section, "liquid_velocity", dimension)?,
        pore_pressure: number(section, "pore_pressure", dimension)?,
        initialise: match section.optional("initialise") {
            Some(item) => item.choice(&[("exact", Initialise::Exact), ("dofs", Initialise::Dofs)], &[])?,
            None => Initialise::default(),
        },
        jitter: match section.optional("jitter") {
            Some(item) => item.number_where("a fraction of the particles' spacing, 0 to 1", |fraction| {
                (0.0..=1.0).contains(&fraction)
            })?,
            None => 0.0,
        },
        seed: match section.optional("seed") {
            Some(item) => item.count(0, u64::MAX)?,
            None => 0,
        },
        min,
        max,
    };
    check_values(&body)?;
    Ok(body)
}

/// One expression per axis under `name`, if there are any.
fn vector(
    section: &Section<'_>,
    name: &str,
    dimension: usize,
) -> Result<Option<Vec<Expression>>, SceneError> {
    let Some(item) = section.optional(name) else {
        return Ok(None);
    };
    item.per_axis(dimension, "expressions", |v| v.expression(coordinates(dimension)))
        .map(Some)
}

/// The expression under `name`, if there is one.
fn number(section: &Section<'_>, name: &str, dimension: usize) -> Result<Option<Expression>, SceneError> {
    let item = section.optional(name);
    item.map(|item| item.expression(coordinates(dimension)))
        .transpose()
}

/// In one dimension an expression, beyond it a table with one for each component.
fn stress(section: &Section<'_>, dimension: usize) -> Result<Option<StressSpec>, SceneError> {
    let Some(item) = section.optional("stress") else {
        return Ok(None);
    };
    let variables = coordinates(dimension);
    if dimension == 1 {
        let components = vec![([0, 0], item.expression(variables)?)];
        return Ok(Some(StressSpec { components }));
    }
    let table = item.section("a table of components (Pa), such as { xx = \"-1e4\", yy = \"-2e4\" }")?;
    let entries: Vec<_> = (0..dimension)
        .flat_map(|row| (0..=row).map(move |column| [row, column]))
        .map(|place| (component_name(place), place))
        .collect();
    let names: Vec<_> = entries.iter().map(|(name, _)| name.as_str()).collect();
    let table = table.allow(&names, &[])?;
    let mut stress = StressSpec::default();
    for (name, place) in &entries {
        if let Some(item) = table.optional(name) {
            stress.components.push((*place, item.expression(variables)?));
        }
    }
    Ok(Some(stress))
}

/// `xx`, `xy`, ... : the lesser axis first.
fn component_name([row, column]: [usize; 2]) -> String {
    let axis = |a: usize| COORDINATES.get(a).copied().unwrap_or("?");
    format!("{}{}", axis(column), axis(row))
}

fn corners(section: &Section<'_>, grid: &GridSpec) -> Result<(Vec<f64>, Vec<f64>), SceneError> {
    let min_item = section.required("min", "the lower corner (m), a list of numbers")?;
    let max_item = section.required("max", "the upper corner (m), a list of numbers")?;
    let read = |item: &Item<'_>| {
        item.per_axis(grid.cells.len(), "numbers (m)", |x| {
            x.number("a finite number (m)")
        })
    };
    let (mut min, mut max) = (read(&min_item)?, read(&max_item)?);
    for corner in [&mut min, &mut max] {
        snap(corner, grid);
    }
    let bounds = grid.min.iter().zip(&grid.max);
    for ((low, high), (grid_low, grid_high)) in min.iter().zip(&max).zip(bounds) {
        let grid_range = format!("within the grid, {grid_low:?} to {grid_high:?} m");
        if low < grid_low || low > grid_high {
            return Err(min_item.not_allowed(&grid_range));
        }
        if high < grid_low || high > grid_high {
            return Err(max_item.not_allowed(&grid_range));
        }
        if high <= low {
            return Err(max_item.not_allowed(&format!("more than the body's min, {low:?} m")));
        }
    }
    Ok((min, max))
}

/// Puts coordinates that are those of the grid's ends but for round-off there.
fn snap(corner: &mut [f64], grid: &GridSpec) {
    let bounds = grid.min.iter().zip(&grid.max).zip(&grid.cells);
    for (x, ((&low, &high), &cells)) in corner.iter_mut().zip(bounds) {
        let cell = (high - low) / cells as f64;
        if let Some(end) = [low, high]
            .into_iter()
            .find(|end| (*x - end).abs() <= FORGIVEN * cell)
        {
            *x = end;
        }
    }
}

/// Refuses initial values that are not finite at the body's ends or middle. A hint: particles lie
/// elsewhere too.
fn check_values(body: &Body) -> Result<(), SceneError> {
    for part in [0.0, 0.5, 1.0] {
        let corners = body.min.iter().zip(&body.max);
        let point: Vec<f64> = corners.map(|(min, max)| min + part * (max - min)).collect();
        let vectors = body.velocity.iter().chain(&body.liquid_velocity).flatten();
        let stresses = body.stress.iter().flat_map(|stress| &stress.components);
        let stresses = stresses.map(|(_, expression)| expression);
        for expression in vectors.chain(stresses).chain(&body.pore_pressure) {
            expression.eval_at(&point)?;
        }
    }
    Ok(())
}

/// Number of particles; refuses those that the scalar type cannot tell apart.
fn check_particles(
    per_cell_item: &Item<'_>,
    body: &Body,
    grid: &GridSpec,
    scalar: ScalarKind,
) -> Result<f64, SceneError> {
    let mut total = 1.0;
    for axis in 0..grid.cells.len() {
        let at = |values: &[f64]| values.get(axis).copied().unwrap_or(f64::NAN);
        let cells = grid.cells.get(axis).copied().unwrap_or(1) as f64;
        let per_cell = body.particles_per_cell.get(axis).copied().unwrap_or(1) as f64;
        let extent = at(&body.max) - at(&body.min);
        let cell_size = (at(&grid.max) - at(&grid.min)) / cells;
        // As `particles::lattice` counts them.
        let count = (extent / cell_size * per_cell).round().max(1.0);
        let reach = at(&body.min).abs().max(at(&body.max).abs());
        if is_blurred(extent / count, reach, scalar) {
            return Err(per_cell_item.conflict(&format!(
                "a spacing of {:?} m is lost in the round-off of coordinates up to {reach:?} m; expected fewer \
                 particles or coordinates nearer to 0{}",
                extent / count,
                precision_hint(scalar)
            )));
        }
        total *= count;
    }
    Ok(total)
}
