//! What scenes of two and three dimensions do not have in this version.

use super::Section;
use crate::scene::{Basis, Initialise, Law, Phases, ScalarKind, Scene, SceneError, SpaceLaw};

pub(super) fn check(root: &Section<'_>, scene: &Scene) -> Result<(), SceneError> {
    if scene.dimension() == 1 {
        return Ok(());
    }
    if let Phases::Two(_) = scene.material.phases {
        two_phases(root, scene)?;
    }
    if scene.method.scalar != ScalarKind::F64 {
        return Err(refuse(root, "method", "scalar", "\"f64\" beyond one dimension")?);
    }
    if scene.method.basis == (Basis::BSpline { degree: 3 }) {
        return Err(refuse(root, "method", "degree", "1 or 2 beyond one dimension")?);
    }
    if scene.method.subpoints > 1 {
        return Err(refuse(root, "method", "subpoints", "1 beyond one dimension")?);
    }
    let expected = "at least one table, written [[body]]";
    let entries = root.required("body", expected)?.list(expected)?;
    for (entry, body) in entries.iter().zip(&scene.bodies) {
        if body.initialise == Initialise::Dofs {
            let item = entry.section(expected)?.required("initialise", "\"exact\"")?;
            return Err(item.not_in_this_version("\"exact\" beyond one dimension"));
        }
    }
    Ok(())
}

/// Pores need a solid.
fn two_phases(root: &Section<'_>, scene: &Scene) -> Result<(), SceneError> {
    match scene.material.law {
        Law::InSpace(SpaceLaw::NewtonianFluid { .. }) => {
            let item = root.section("material")?.required("law", "the law of a solid")?;
            Err(item.conflict("a fluid has no pores; expected the law of a solid with phases = 2"))
        }
        _ => Ok(()),
    }
}

/// The error about a key that is there.
fn refuse(root: &Section<'_>, section: &str, key: &str, expected: &str) -> Result<SceneError, SceneError> {
    let item = root.section(section)?.required(key, expected)?;
    Ok(item.not_in_this_version(expected))
}
