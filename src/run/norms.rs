//! Errors of the particles' fields against the reference.

use std::collections::BTreeMap;

use serde::Serialize;

use super::error::RunError;
use super::reference::solution;
use super::schedule::Schedule;
use crate::particles::Particles;
use crate::scene::Scene;

/// Reference values at the particles, in their order; empty where the scene names no reference.
#[derive(Clone, Debug, Default)]
pub struct Exact {
    /// Displacement (m) at the end.
    pub displacement: Vec<f64>,
    /// Velocity (m/s) half a step before the end, where the particles' velocity lives.
    pub velocity: Vec<f64>,
    /// Stress (Pa) at the end.
    pub stress: Vec<f64>,
}

impl Exact {
    /// Evaluates the scene's reference at the particles' material points.
    pub(super) fn of(
        scene: &Scene,
        particles: &Particles<f64, 1>,
        schedule: &Schedule,
    ) -> Result<Self, RunError> {
        let Some(mut solution) = solution(scene)? else {
            return Ok(Self::default());
        };
        let points = || particles.initial_position.iter().map(|x| x[0]);
        solution.advance(schedule.velocity_time())?;
        let velocity = points().map(|x| solution.at(x).velocity).collect();
        solution.advance(schedule.end)?;
        let (displacement, stress) = points()
            .map(|x| solution.at(x))
            .map(|state| (state.displacement, state.stress))
            .unzip();
        Ok(Self {
            displacement,
            velocity,
            stress,
        })
    }
}

/// Error of one field over all particles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorNorms {
    /// Root mean square, in the field's unit.
    pub rms: f64,
    /// Root of the sum of squares over that of the reference; not finite, and left out of JSON, where that is zero.
    #[serde(skip_serializing_if = "is_not_finite")]
    pub relative_l2: f64,
    /// Largest, in the field's unit.
    pub max: f64,
}

fn is_not_finite(value: &f64) -> bool {
    !value.is_finite()
}

impl ErrorNorms {
    fn new(values: impl Iterator<Item = f64>, exact: &[f64]) -> Self {
        let (mut errors, mut squares, mut max) = (0.0, 0.0, 0.0_f64);
        for (value, exact) in values.zip(exact) {
            let error = value - exact;
            errors += error * error;
            squares += exact * exact;
            max = max.max(error.abs());
        }
        Self {
            rms: (errors / exact.len() as f64).sqrt(),
            relative_l2: (errors / squares).sqrt(),
            max,
        }
    }

    /// Errors of displacement, velocity and stress; empty without a reference.
    pub(super) fn all(particles: &Particles<f64, 1>, exact: &Exact) -> BTreeMap<&'static str, Self> {
        if exact.stress.is_empty() {
            return BTreeMap::new();
        }
        let displacement = particles.displacement.iter().map(|u| u[0]);
        let velocity = particles.velocity.iter().map(|v| v[0]);
        let stress = particles.stress.iter().map(|s| s[(0, 0)]);
        BTreeMap::from([
            ("displacement", Self::new(displacement, &exact.displacement)),
            ("velocity", Self::new(velocity, &exact.velocity)),
            ("stress", Self::new(stress, &exact.stress)),
        ])
    }
}
