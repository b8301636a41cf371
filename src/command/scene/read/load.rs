//! `[load]`

use super::material::PhaseCount;
use super::{Section, check_over_time};
use crate::scene::{Expression, GridSpec, SceneError};

/// Gravity of a scene that does not name one (m/s2).
const GRAVITY: f64 = 9.81;

pub(super) struct Load {
    /// Body force (N/kg), in `t`.
    pub(super) body_force: Option<Vec<Expression>>,
    /// Gravity (m/s2) in the unit weight of the liquid; it loads nothing.
    pub(super) gravity: f64,
}

pub(super) fn read(
    root: &Section<'_>,
    grid: &GridSpec,
    end: f64,
    phases: PhaseCount,
) -> Result<Load, SceneError> {
    let mut load = Load {
        body_force: None,
        gravity: GRAVITY,
    };
    let Some(section) = root.optional_section("load")? else {
        return Ok(load);
    };
    let section = section.allow(&["body_force", "gravity"], &[])?;
    if let Some(item) = section.optional("gravity") {
        if phases == PhaseCount::One {
            return Err(item.conflict(
                "it sets the unit weight of the liquid in two phases, and loads nothing; use body_force, or \
                 material.phases = 2",
            ));
        }
        load.gravity = item.positive("m/s2")?;
    }
    if let Some(item) = section.optional("body_force") {
        let expressions = item.per_axis(grid.cells.len(), "expressions in t", |e| e.expression(&["t"]))?;
        check_over_time(&expressions, end)?;
        load.body_force = Some(expressions);
    }
    Ok(load)
}
