//! `[reference]`

use super::{Item, Section};
use crate::scene::{Against, ReferenceSpec, SceneError};

const KEYS: [&str; 2] = ["vibrating-bar", "column-compaction"];
const TWO_PHASE_KEYS: [&str; 2] = ["consolidation", "xie-leo"];

pub(super) fn read(root: &Section<'_>) -> Result<Option<ReferenceSpec>, SceneError> {
    let Some(section) = root.optional_section("reference")? else {
        return Ok(None);
    };
    let section = section.allow(&KEYS, &TWO_PHASE_KEYS)?;
    let found = (
        section.optional("vibrating-bar"),
        section.optional("column-compaction"),
    );
    match found {
        (Some(bar), None) => vibrating_bar(&bar).map(Some),
        (None, Some(column)) => column_compaction(&column).map(Some),
        (None, None) => Err(section.missing("one of vibrating-bar, column-compaction, or no [reference]")),
        (Some(bar), Some(_)) => {
            Err(bar.conflict("there is reference.column-compaction too; expected exactly one reference"))
        }
    }
}

fn vibrating_bar(item: &Item<'_>) -> Result<ReferenceSpec, SceneError> {
    let section = item.section("a table, such as { velocity = 0.8 }")?;
    let section = section.allow(&["velocity"], &[])?;
    Ok(ReferenceSpec::VibratingBar {
        velocity: not_zero(&section, "velocity", "a number other than 0 (m/s)")?,
    })
}

fn column_compaction(item: &Item<'_>) -> Result<ReferenceSpec, SceneError> {
    let section = item.section("a table, such as { body_force = -200.0, ramp = 0.5 }")?;
    let section = section.allow(&["body_force", "ramp", "against"], &[])?;
    let ramp = section.required(
        "ramp",
        "the time over which the load grows, a positive number (s)",
    )?;
    Ok(ReferenceSpec::ColumnCompaction {
        body_force: not_zero(&section, "body_force", "a number other than 0 (N/kg)")?,
        ramp: ramp.positive("s")?,
        against: match section.optional("against") {
            Some(item) => item.choice(&[("static", Against::Static), ("dynamic", Against::Dynamic)], &[])?,
            None => Against::default(),
        },
    })
}

/// Relative errors need something to be relative to.
fn not_zero(section: &Section<'_>, name: &str, expected: &str) -> Result<f64, SceneError> {
    section
        .required(name, expected)?
        .number_where(expected, |number| number != 0.0)
}
