//! Loads and boundary values of a scene, step by step.

use nalgebra::SVector;

use super::error::RunError;
use crate::scene::{BoundaryKind, Expression, PoreBoundary, Scene};
use materialpoint::stepper::{FaceCondition, Forcing, PoreCondition};

/// Evaluates the scene's expressions for the step from `time` to `time + dt`: loads at its start, told
/// velocities in its middle, where Euler-Cromer's velocity lives (but never before time zero).
pub(super) fn forcing<const D: usize>(
    scene: &Scene,
    time: f64,
    dt: f64,
) -> Result<Forcing<f64, D>, RunError> {
    let mut forcing = Forcing::none();
    if let Some(body_force) = &scene.body_force {
        forcing.body_force = vector(body_force, time)?;
    }
    for boundary in &scene.boundaries {
        let condition = match &boundary.kind {
            BoundaryKind::Free => FaceCondition::Free,
            BoundaryKind::Fixed => FaceCondition::fixed(),
            BoundaryKind::Roller => FaceCondition::roller(boundary.face.axis),
            BoundaryKind::Frictional {
                coefficient,
                velocity,
            } => FaceCondition::Frictional {
                coefficient: *coefficient,
                velocity: match velocity {
                    // The walls act on the velocity in the middle of the step.
                    Some(velocity) => vector(velocity, time + dt / 2.0)?,
                    None => SVector::zeros(),
                },
            },
            BoundaryKind::Velocity(velocity) => {
                let (before, after) = ((time - dt / 2.0).max(0.0), time + dt / 2.0);
                let (start, end): (SVector<f64, D>, _) =
                    (vector(velocity, before)?, vector(velocity, after)?);
                FaceCondition::moving(end, (end - start) / (after - before))
            }
            BoundaryKind::Traction(traction) => FaceCondition::Traction(vector(traction, time)?),
        };
        forcing.set_face(boundary.face, condition);
        let pores = match &boundary.pores {
            PoreBoundary::Sealed => PoreCondition::Sealed,
            PoreBoundary::Drained => PoreCondition::Pressure(0.0),
            PoreBoundary::Pressure(pressure) => PoreCondition::Pressure(pressure.eval_time(time)?),
        };
        forcing.set_pores(boundary.face, pores);
    }
    Ok(forcing)
}

fn vector<const D: usize>(expressions: &[Expression], time: f64) -> Result<SVector<f64, D>, RunError> {
    let mut value = SVector::<f64, D>::zeros();
    for (component, expression) in value.iter_mut().zip(expressions) {
        *component = expression.eval_time(time)?;
    }
    Ok(value)
}
