//! `[grid]`

use super::{MOST, Section};
use crate::scene::{Body, GridSpec, ScalarKind, SceneError};

/// Most cells beyond one dimension, where only those of a box around the bodies take memory: their numbers
/// have 32 bits.
const MOST_IN_SPACE: u64 = 4_000_000_000;

/// Cells and spacings below this many round-off units of the largest coordinate would be blurred.
const ROUND_OFF_UNITS: f64 = 100.0;

pub(super) fn read(root: &Section<'_>) -> Result<GridSpec, SceneError> {
    let section = root.section("grid")?.allow(&["min", "max", "cells"], &[])?;
    let min_item = section.required("min", "the lower corner (m), a list of numbers")?;
    let dimension = min_item.list("a list of numbers (m), one per axis")?.len();
    if !(1..=3).contains(&dimension) {
        return Err(min_item.not_allowed("a list of one, two or three numbers (m), one per axis"));
    }
    let min = min_item.per_axis(dimension, "numbers (m)", |x| x.number("a finite number (m)"))?;
    let max_item = section.required("max", "the upper corner (m), a list of numbers")?;
    let max = max_item.per_axis(dimension, "numbers (m)", |x| x.number("a finite number (m)"))?;
    for (axis, item) in max_item.list("a list of numbers (m)")?.iter().enumerate() {
        let low = min.get(axis).copied().unwrap_or(f64::NAN);
        item.number_where(
            &format!("a finite number (m) above grid.min.{axis} = {low:?}"),
            |high| high > low && (high - low).is_finite(),
        )?;
    }
    let cells_item = section.required("cells", "cells along each axis, a list of whole numbers")?;
    let cells = cells_item.per_axis(dimension, "whole numbers", |n| n.size(1, MOST))?;
    let total = cells.iter().fold(1.0, |total, &n| total * n as f64);
    let most = if dimension == 1 { MOST } else { MOST_IN_SPACE };
    if total > most as f64 {
        return Err(cells_item.conflict(&format!("that makes {total:e} cells; expected at most {most}")));
    }
    Ok(GridSpec { min, max, cells })
}

/// Refuses bodies so far apart that the box around them, whose cells take memory, has too many.
pub(super) fn check_box(root: &Section<'_>, grid: &GridSpec, bodies: &[Body]) -> Result<(), SceneError> {
    let along = |axis: usize| {
        let ends = |corner: fn(&Body) -> &[f64]| {
            bodies
                .iter()
                .filter_map(move |body| corner(body).get(axis).copied())
        };
        let low = ends(|body| &body.min).fold(f64::INFINITY, f64::min);
        let high = ends(|body| &body.max).fold(f64::NEG_INFINITY, f64::max);
        let [min, max] = [&grid.min, &grid.max].map(|corner| corner.get(axis).copied().unwrap_or(f64::NAN));
        (high - low) / (max - min) * grid.cells.get(axis).map_or(0.0, |&n| n as f64)
    };
    let total: f64 = (0..grid.cells.len()).map(along).product();
    if total > MOST as f64 {
        let cells = root
            .section("grid")?
            .required("cells", "a list of whole numbers")?;
        return Err(cells.conflict(&format!(
            "the box around the bodies has {total:.1e} of them; expected at most {MOST}"
        )));
    }
    Ok(())
}

/// Refuses cells that the scalar type cannot tell apart.
pub(super) fn check_cell_size(
    root: &Section<'_>,
    grid: &GridSpec,
    scalar: ScalarKind,
) -> Result<(), SceneError> {
    for ((&min, &max), &cells) in grid.min.iter().zip(&grid.max).zip(&grid.cells) {
        let size = (max - min) / cells as f64;
        let reach = min.abs().max(max.abs());
        if is_blurred(size, reach, scalar) {
            let cells = root
                .section("grid")?
                .required("cells", "a list of whole numbers")?;
            return Err(cells.conflict(&format!(
                "a cell of {size:?} m is lost in the round-off of coordinates up to {reach:?} m; expected larger \
                 cells or coordinates nearer to 0{}",
                precision_hint(scalar)
            )));
        }
    }
    Ok(())
}

/// What else helps against round-off.
pub(super) fn precision_hint(scalar: ScalarKind) -> &'static str {
    match scalar {
        ScalarKind::F64 => "",
        ScalarKind::F32 => ", or method.scalar = \"f64\"",
    }
}

/// Whether lengths of `size` (m) drown in the round-off of coordinates up to `reach` (m).
pub(super) fn is_blurred(size: f64, reach: f64, scalar: ScalarKind) -> bool {
    let epsilon = match scalar {
        ScalarKind::F64 => f64::EPSILON,
        ScalarKind::F32 => f64::from(f32::EPSILON),
    };
    size < ROUND_OFF_UNITS * epsilon * reach
}
