//! `[reference]`

use super::{Item, Section};
use crate::scene::{Against, ReferenceSpec, SceneError};

type Read = fn(&Item<'_>) -> Result<ReferenceSpec, SceneError>;

const REFERENCES: [(&str, Read); 8] = [
    ("vibrating-bar", vibrating_bar),
    ("column-compaction", column_compaction),
    ("consolidation", consolidation),
    ("xie-leo", xie_leo),
    ("standing-wave", standing_wave),
    ("self-weight", self_weight),
    ("manufactured", manufactured),
    ("vortex", vortex),
];

/// Most half waves of a standing wave.
const MOST_MODES: u64 = 1_000_000;

pub(super) fn read(root: &Section<'_>) -> Result<Option<ReferenceSpec>, SceneError> {
    let Some(section) = root.optional_section("reference")? else {
        return Ok(None);
    };
    let names = REFERENCES.map(|reference| reference.0);
    let section = section.allow(&names, &[])?;
    let found: Vec<_> = REFERENCES
        .iter()
        .filter_map(|(name, read)| Some((section.optional(name)?, read)))
        .collect();
    match found.as_slice() {
        [] => Err(section.missing(&format!("one of {}, or no [reference]", names.join(", ")))),
        [(item, read)] => read(item).map(Some),
        [(item, _), (other, _), ..] => Err(item.conflict(&format!(
            "there is {} too; expected exactly one reference",
            other.key
        ))),
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

fn consolidation(item: &Item<'_>) -> Result<ReferenceSpec, SceneError> {
    let section = item.section("a table, such as { load = -1e4, start = 5.0 }")?;
    let section = section.allow(&["load", "start"], &[])?;
    let start = "the time of the solution at which the run starts, 0 or more (s)";
    Ok(ReferenceSpec::Consolidation {
        load: not_zero(&section, "load", "a number other than 0 (Pa)")?,
        start: match section.optional("start") {
            Some(item) => item.number_where(start, |time| time >= 0.0)?,
            None => 0.0,
        },
    })
}

fn xie_leo(item: &Item<'_>) -> Result<ReferenceSpec, SceneError> {
    let section = item.section("a table, such as { load = -5e5 }")?;
    let section = section.allow(&["load"], &[])?;
    Ok(ReferenceSpec::XieLeo {
        load: not_zero(&section, "load", "a number other than 0 (Pa)")?,
    })
}

fn standing_wave(item: &Item<'_>) -> Result<ReferenceSpec, SceneError> {
    let section = item.section("a table, such as { velocity = 1e-3, mode = 1 }")?;
    let section = section.allow(&["velocity", "mode"], &[])?;
    Ok(ReferenceSpec::StandingWave {
        velocity: not_zero(&section, "velocity", "a number other than 0 (m/s)")?,
        mode: match section.optional("mode") {
            Some(item) => item.size(1, MOST_MODES)?,
            None => 1,
        },
    })
}

fn self_weight(item: &Item<'_>) -> Result<ReferenceSpec, SceneError> {
    item.section("an empty table, {}")?.allow_none()?;
    Ok(ReferenceSpec::SelfWeight)
}

fn manufactured(item: &Item<'_>) -> Result<ReferenceSpec, SceneError> {
    let section = item.section("a table, such as { amplitude = 0.05 }")?;
    let section = section.allow(&["amplitude"], &[])?;
    Ok(ReferenceSpec::Manufactured {
        amplitude: not_zero(&section, "amplitude", "a number other than 0 (m)")?,
    })
}

fn vortex(item: &Item<'_>) -> Result<ReferenceSpec, SceneError> {
    let section = item.section("a table, such as { inner = 0.75, outer = 1.25, angle = 0.2, time = 1.0 }")?;
    let section = section.allow(&["inner", "outer", "angle", "time"], &[])?;
    let inner_words = "the inner radius, a positive number (m)";
    let inner = section.required("inner", inner_words)?.positive("m")?;
    let outer_words = format!("a radius above the inner one, {inner:?} m");
    let outer = section.required("outer", &outer_words)?;
    let time = section.required(
        "time",
        "the time after which the ring is back, a positive number (s)",
    )?;
    Ok(ReferenceSpec::Vortex {
        inner,
        outer: outer.number_where(&outer_words, |outer| outer > inner)?,
        angle: not_zero(&section, "angle", "a number other than 0 (rad)")?,
        time: time.positive("s")?,
    })
}

/// Relative errors need something to be relative to.
fn not_zero(section: &Section<'_>, name: &str, expected: &str) -> Result<f64, SceneError> {
    section
        .required(name, expected)?
        .number_where(expected, |number| number != 0.0)
}
