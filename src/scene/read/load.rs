//! `[load]`

use super::{Section, check_over_time};
use crate::scene::{Expression, GridSpec, SceneError};

pub(super) fn read(
    root: &Section<'_>,
    grid: &GridSpec,
    end: f64,
) -> Result<Option<Vec<Expression>>, SceneError> {
    let Some(section) = root.optional_section("load")? else {
        return Ok(None);
    };
    let section = section.allow(&["body_force"], &["gravity"])?;
    let Some(item) = section.optional("body_force") else {
        return Ok(None);
    };
    let expressions = item.per_axis(grid.cells.len(), "expressions in t", |e| e.expression(&["t"]))?;
    check_over_time(&expressions, end)?;
    Ok(Some(expressions))
}
