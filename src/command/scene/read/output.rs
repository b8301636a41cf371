//! `[output]`

use super::Section;
use crate::scene::{OutputSpec, ParticleOutput, SceneError};

pub(super) fn read(root: &Section<'_>) -> Result<OutputSpec, SceneError> {
    let mut output = OutputSpec::default();
    let Some(section) = root.optional_section("output")? else {
        return Ok(output);
    };
    let section = section.allow(&["particles", "every", "checkpoint_every"], &[])?;
    if let Some(item) = section.optional("particles") {
        let allowed = [
            ("csv", ParticleOutput::Csv),
            ("vtu", ParticleOutput::Vtu),
            ("none", ParticleOutput::None),
        ];
        output.particles = item.choice(&allowed, &[])?;
    }
    if let Some(item) = section.optional("every") {
        output.every = item.size(0, u64::MAX)?;
    }
    if let Some(item) = section.optional("checkpoint_every") {
        output.checkpoint_every = item.size(0, u64::MAX)?;
    }
    Ok(output)
}
