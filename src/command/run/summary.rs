//! Figures of a run, as `run --json` prints them.

use std::collections::BTreeMap;

use serde::Serialize;

use super::limits::EnergyGain;
use super::march::March;
use super::norms::ErrorNorms;
use super::schedule::Schedule;
use crate::scene::{Boundary, ScalarKind, Scene};
use materialpoint::stepper::{Conservation, Simulation};

/// The method and the model of a run, by name.
#[derive(Clone, Debug, Serialize)]
pub struct MethodSummary {
    /// Basis family.
    pub basis: &'static str,
    /// Its degree.
    pub degree: usize,
    /// Reconstruction.
    pub reconstruction: &'static str,
    /// Sub-points of each particle; 1 is the particle itself.
    pub subpoints: u8,
    /// Mass behind the DOF velocities.
    pub velocity_mass: &'static str,
    /// Number of phases.
    pub phases: usize,
    /// Constitutive law.
    pub law: &'static str,
    /// `small` or `large`.
    pub strain: &'static str,
    /// Floating-point type.
    pub scalar: &'static str,
    /// Number of axes.
    pub dimension: usize,
}

impl MethodSummary {
    /// Of a scene.
    pub fn of(scene: &Scene) -> Self {
        let law = scene.material.law;
        Self {
            basis: scene.method.basis.name(),
            degree: scene.method.basis.degree(),
            reconstruction: scene.method.reconstruction.name(),
            subpoints: scene.method.subpoints,
            velocity_mass: scene.method.velocity_mass.name(),
            phases: scene.material.phases.count(),
            law: law.name(),
            strain: if law.large_strain() { "large" } else { "small" },
            scalar: match scene.method.scalar {
                ScalarKind::F64 => "f64",
                ScalarKind::F32 => "f32",
            },
            dimension: scene.dimension(),
        }
    }
}

/// Largest conservation errors of one phase.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ConservationSummary {
    /// Relative to the mass.
    pub mass: f64,
    /// Relative to the momentum.
    pub momentum: f64,
    /// Relative to the sum of m |v|.
    pub momentum_scaled: f64,
    /// Change of momentum in a step against the impulse of loads, held faces and walls: see
    /// [`Conservation::impulse`](materialpoint::stepper::Conservation::impulse). Absent where a liquid flows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub impulse: Option<f64>,
}

impl From<Conservation<f64>> for ConservationSummary {
    fn from(errors: Conservation<f64>) -> Self {
        Self {
            mass: errors.mass,
            momentum: errors.momentum,
            momentum_scaled: errors.momentum_scaled,
            impulse: Some(errors.impulse),
        }
    }
}

/// Kinetic plus strain energy of a run, each sample at one time, the start of a step
/// ([`Simulation::step_and_measure`]); ratios to the initial one, absent where that is zero or next to it.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct EnergySummary {
    /// At the start (J; in one dimension J/m2, in two J/m).
    pub initial: f64,
    /// At the start of the last step (J; in one dimension J/m2, in two J/m).
    #[serde(rename = "final")]
    pub last: f64,
    /// Highest over initial.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub highest_ratio: Option<f64>,
    /// Lowest over initial.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lowest_ratio: Option<f64>,
    /// Work of walls that rub on the bodies (J), absent where none does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wall_work: Option<f64>,
    /// Most work (J) that they did in one step beside that of their own motion; zero unless something is
    /// wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wall_gain: Option<f64>,
}

/// Figures of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Title of the scene.
    pub title: String,
    /// Method and model.
    pub method: MethodSummary,
    /// Number of particles.
    pub particles: usize,
    /// Number of cells.
    pub cells: usize,
    /// Number of DOFs.
    pub dofs: usize,
    /// Steps taken, those before a checkpoint included.
    pub steps: usize,
    /// Time reached (s).
    pub time: f64,
    /// Time (s) at which the velocities live that a run leaves behind: the middle of the last step. Positions
    /// and stresses are those of `time`.
    pub velocity_time: f64,
    /// Size of a step (s); of steps that were renewed their mean.
    pub time_step: f64,
    /// Least and greatest size (s) of steps that were renewed with a result: absent where all are alike.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_step_range: Option<[f64; 2]>,
    /// Time of the step loop on the clock (s); of a resumed run that of the steps taken since.
    pub wall_seconds: f64,
    /// Particles times steps per second; of a resumed run those of the steps taken since.
    pub particle_steps_per_second: f64,
    /// Memory per particle, the grid's share included.
    pub bytes_per_particle: f64,
    /// How often a particle changed its cell.
    pub grid_crossings: usize,
    /// Most cells in one step that were fitted with fewer functions than the method's.
    pub reduced_cells: usize,
    /// Most cells in one step that were fitted with virtual points of their neighbours.
    pub virtual_cells: usize,
    /// Errors by field.
    pub errors: BTreeMap<&'static str, ErrorNorms>,
    /// Conservation by phase.
    pub conservation: BTreeMap<&'static str, ConservationSummary>,
    /// Energy.
    pub energy: EnergySummary,
    /// What the user should know although the run was done.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// Files that a former run had left in the output folder and that were removed: frames that this run does
    /// not go on with, and temporary files of killed processes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub removed: Vec<String>,
}

impl Summary {
    /// Without errors and warnings.
    pub(super) fn new<const D: usize>(
        scene: &Scene,
        simulation: &dyn Simulation<D>,
        schedule: &Schedule,
        march: &March,
    ) -> Self {
        let wall_seconds = march.wall.as_secs_f64();
        let particles = simulation.particle_count();
        // A run that was resumed at its end takes none.
        let particle_steps_per_second = match march.steps {
            0 => 0.0,
            steps => particles as f64 * steps as f64 / wall_seconds,
        };
        let diagnostics = simulation.diagnostics();
        let liquid = diagnostics.liquid_conservation;
        let conservation = [("solid", Some(diagnostics.conservation)), ("liquid", liquid)]
            .into_iter()
            .filter_map(|(phase, errors)| {
                let mut errors = ConservationSummary::from(errors?);
                errors.impulse = errors.impulse.filter(|_| liquid.is_none());
                Some((phase, errors))
            })
            .collect();
        let renewed = schedule.range[0] < schedule.range[1];
        let energy = march.energy;
        let rubs = scene.boundaries.iter().any(Boundary::rubs);
        // Of next to nothing nothing is a finite multiple.
        let ratio = |value: f64| Some(value / energy.initial).filter(|ratio| ratio.is_finite());
        Self {
            title: scene.title.clone(),
            method: MethodSummary::of(scene),
            particles,
            cells: scene.grid.cells.iter().product(),
            dofs: simulation.dof_count(),
            steps: schedule.steps,
            time: schedule.end,
            velocity_time: schedule.velocity_time(schedule.steps, scene.time.half_kick),
            time_step: if renewed {
                schedule.end / schedule.steps as f64
            } else {
                schedule.dt
            },
            time_step_range: renewed.then_some(schedule.range),
            wall_seconds,
            particle_steps_per_second,
            bytes_per_particle: simulation.bytes_per_particle(),
            grid_crossings: diagnostics.grid_crossings,
            reduced_cells: diagnostics.reduced_cells,
            virtual_cells: diagnostics.virtual_cells,
            errors: BTreeMap::new(),
            conservation,
            energy: EnergySummary {
                initial: energy.initial,
                last: energy.last,
                highest_ratio: ratio(energy.highest),
                lowest_ratio: ratio(energy.lowest),
                wall_work: rubs.then_some(diagnostics.wall_work),
                wall_gain: rubs.then_some(diagnostics.wall_gain),
            },
            warnings: Vec::new(),
            removed: Vec::new(),
        }
    }

    /// By how much the energy rose although nothing of `scene` gives any; `None` if it did not, or may.
    pub fn energy_gain(&self, scene: &Scene) -> Option<EnergyGain> {
        EnergyGain::of(scene, self.energy.highest_ratio?)
    }
}
