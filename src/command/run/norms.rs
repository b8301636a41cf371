//! Errors of the particles' fields against the reference.

use std::collections::BTreeMap;

use serde::Serialize;

use super::error::RunError;
use super::fields::{FieldValues, for_each_field};
use super::reference::Solution;
use super::schedule::Schedule;
use crate::scene::Scene;
use materialpoint::particles::Particles;
use materialpoint::phase::PoreLiquid;
use materialpoint::reference::FieldReference;

/// Reference values at the particles, in their order, the components of a vector or tensor together; empty
/// where the scene names no reference, and those of the liquid in one phase.
#[derive(Clone, Debug, Default)]
pub struct Exact {
    /// Displacement (m) of the solid at the end.
    pub displacement: Vec<f64>,
    /// Velocity (m/s) of the solid half a step before the end, where the particles' velocity lives.
    pub velocity: Vec<f64>,
    /// Stress (Pa) at the end, in two phases the effective one.
    pub stress: Vec<f64>,
    /// Velocity (m/s) of the liquid, at the time of the solid's.
    pub liquid_velocity: Vec<f64>,
    /// Pore pressure (Pa) at the end, tension positive.
    pub pore_pressure: Vec<f64>,
}

impl Exact {
    /// Evaluates a solution along one axis at the particles' material points.
    pub(super) fn on_one_axis(
        scene: &Scene,
        solution: Solution,
        particles: &Particles<f64, 1>,
        schedule: &Schedule,
    ) -> Result<Self, RunError> {
        let points: Vec<f64> = particles.initial_position.iter().map(|x| x[0]).collect();
        let start = scene.reference.map_or(0.0, |reference| reference.start());
        let middle = schedule.velocity_time(schedule.steps, scene.time.half_kick);
        let [middle, end] = [middle, schedule.end].map(|time| start + time);
        let mut exact = Self::default();
        match solution {
            Solution::One(mut solution) => {
                solution.advance(middle)?;
                exact.velocity = points.iter().map(|&x| solution.at(x).velocity).collect();
                solution.advance(end)?;
                let states = points.iter().map(|&x| solution.at(x));
                (exact.displacement, exact.stress) = states.map(|s| (s.displacement, s.stress)).unzip();
            }
            Solution::Two(mut solution) => {
                solution.advance(middle)?;
                let states = points.iter().map(|&x| solution.at(x));
                (exact.velocity, exact.liquid_velocity) =
                    states.map(|s| (s.solid_velocity, s.liquid_velocity)).unzip();
                solution.advance(end)?;
                for state in points.iter().map(|&x| solution.at(x)) {
                    exact.displacement.push(state.solid_displacement);
                    exact.stress.push(state.effective_stress);
                    exact.pore_pressure.push(state.pore_pressure);
                }
            }
        }
        Ok(exact)
    }

    /// Evaluates a field at the particles' material points.
    pub(super) fn in_space<const D: usize>(
        reference: &dyn FieldReference<D>,
        particles: &Particles<f64, D>,
        schedule: &Schedule,
    ) -> Self {
        let mut exact = Self::default();
        // At least one step is taken, so that the start has no say.
        let middle = schedule.velocity_time(schedule.steps, false);
        for x in &particles.initial_position {
            let velocity = reference.at(x, middle).velocity;
            exact.velocity.extend(velocity.iter());
            let state = reference.at(x, schedule.end);
            exact.displacement.extend(state.displacement.iter());
            exact.stress.extend(state.stress.iter());
        }
        exact
    }
}

/// Error of one field over all particles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorNorms {
    /// Root mean square, in the field's unit.
    pub rms: f64,
    /// Root of the sum of squares over that of the reference; not finite, and left out of JSON, where that is
    /// zero.
    #[serde(skip_serializing_if = "is_not_finite")]
    pub relative_l2: f64,
    /// Largest, in the field's unit.
    pub max: f64,
}

fn is_not_finite(value: &f64) -> bool {
    !value.is_finite()
}

impl ErrorNorms {
    /// Of vectors and tensors the Euclidean and Frobenius norms count.
    fn new(field: &FieldValues) -> Self {
        let components = field.components.max(1);
        let (mut errors, mut squares, mut max) = (0.0, 0.0, 0.0_f64);
        let particles = field
            .values
            .chunks(components)
            .zip(field.exact.chunks(components));
        for (value, exact) in particles {
            let pairs = value.iter().zip(exact);
            let error: f64 = pairs.map(|(value, exact)| (value - exact).powi(2)).sum();
            errors += error;
            squares += exact.iter().map(|exact| exact * exact).sum::<f64>();
            max = max.max(error.sqrt());
        }
        Self {
            rms: (errors / (field.exact.len() / components) as f64).sqrt(),
            relative_l2: (errors / squares).sqrt(),
            max,
        }
    }

    /// Errors of the fields that a reference knows.
    pub(super) fn all<const D: usize>(
        particles: &Particles<f64, D>,
        liquid: &[PoreLiquid<f64, D>],
        exact: &Exact,
    ) -> BTreeMap<&'static str, Self> {
        let mut norms = BTreeMap::new();
        for_each_field(particles, liquid, exact, |field| {
            if !field.exact.is_empty() {
                norms.insert(field.name, Self::new(&field));
            }
        });
        norms
    }
}
