//! Speed against error: methods x resolutions on one scene.

mod front;
mod maps;
mod report;
mod timing;

pub use maps::write_maps;
pub use report::{front_in_markdown, picture, recommendation, write_fields, write_files};

use std::collections::BTreeMap;

use serde::Serialize;

use crate::output::OutputError;
use crate::run::{
    ConservationSummary, ErrorNorms, InSpace, Outcome, RunError, Summary, in_dimension, run, run_in,
};
use crate::scene::Scene;
use materialpoint::method::Method;
use timing::{Timing, median};

/// What to run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Methods, in the order of the report.
    pub methods: Vec<Method>,
    /// Numbers of cells, ascending.
    pub cells: Vec<usize>,
    /// How often each run is timed at least; the median counts.
    pub repeat: usize,
    /// A run is timed until its median time, as often as it was timed, makes up this (s), or 200 times: the
    /// shortest ones would be noise otherwise.
    pub least_seconds: f64,
}

/// One run of a study.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Basis family.
    pub basis: &'static str,
    /// Its degree.
    pub degree: usize,
    /// Reconstruction.
    pub reconstruction: &'static str,
    /// Sub-points of each particle; 1 is the particle itself.
    pub subpoints: u8,
    /// Mass behind the DOF velocities: the scene's, where the method has a choice.
    pub velocity_mass: &'static str,
    /// Number of cells along the first axis.
    pub cells: usize,
    /// Number of particles.
    pub particles: usize,
    /// Steps taken; zero if the run stopped.
    pub steps: usize,
    /// Errors by field.
    pub errors: BTreeMap<&'static str, ErrorNorms>,
    /// Observed order by field (of the RMS error), against the next coarser row of the method; absent in its
    /// first.
    pub orders: BTreeMap<&'static str, f64>,
    /// Median time of the step loop (s).
    pub wall_seconds: f64,
    /// Of so many.
    pub timings: usize,
    /// Particles times steps per second.
    pub particle_steps_per_second: f64,
    /// Conservation by phase.
    pub conservation: BTreeMap<&'static str, ConservationSummary>,
    /// How often a particle changed its cell.
    pub grid_crossings: usize,
    /// Whether no other row is both faster and more accurate in the (effective) stress.
    pub on_front: bool,
    /// Why the run stopped early, if it did; its errors are then absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped: Option<String>,
    /// What the user should know although the run was done, see [`crate::run::Summary::warnings`].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The method.
    #[serde(skip)]
    pub method: Method,
}

impl Row {
    fn new(method: Method, cells: usize) -> Self {
        Self {
            basis: method.basis.name(),
            degree: method.basis.degree(),
            reconstruction: method.reconstruction.name(),
            subpoints: method.subpoints,
            velocity_mass: crate::scene::Method::default_velocity_mass(method.reconstruction).name(),
            cells,
            particles: 0,
            steps: 0,
            errors: BTreeMap::new(),
            orders: BTreeMap::new(),
            wall_seconds: f64::NAN,
            timings: 0,
            particle_steps_per_second: f64::NAN,
            conservation: BTreeMap::new(),
            grid_crossings: 0,
            on_front: false,
            stopped: None,
            warnings: Vec::new(),
            method,
        }
    }

    /// Takes what does not depend on the clock.
    fn take(&mut self, summary: &Summary) {
        self.particles = summary.particles;
        self.steps = summary.steps;
        self.errors = summary.errors.clone();
        self.conservation = summary.conservation.clone();
        self.grid_crossings = summary.grid_crossings;
        self.warnings = summary.warnings.clone();
    }

    fn take_times(&mut self, times: &[f64]) {
        self.timings = times.len();
        self.wall_seconds = median(times);
        self.particle_steps_per_second = (self.particles * self.steps) as f64 / self.wall_seconds;
    }

    /// Relative L2 error of the stress, in two phases of the effective one: what the front is about.
    pub fn stress_error(&self) -> Option<f64> {
        let errors = &self.errors;
        let stress = errors.get("stress").or_else(|| errors.get("effective_stress"));
        stress.map(|norms| norms.relative_l2)
    }
}

/// Rows of a study, method by method, cells ascending, and the runs at the scene's own resolution.
#[derive(Debug)]
pub struct Study {
    /// Number of phases of the scene.
    pub phases: usize,
    /// All rows.
    pub rows: Vec<Row>,
    /// Runs to draw fields of: each method at the number of cells nearest to the scene's.
    /// None beyond one dimension.
    pub drawn: Vec<(Method, Outcome)>,
}

/// Why a study could not be done.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// Nothing to measure errors against.
    #[error("a study compares errors, and this scene names no [reference]; add one or use `run`")]
    NoReference,
    /// No method or no resolution was asked for.
    #[error("a study needs at least one method and one number of cells")]
    NothingToDo,
    /// A run failed before its first step.
    #[error("{method} with {cells} cells: {source}")]
    Run {
        /// Method at fault.
        method: Method,
        /// Number of cells.
        cells: usize,
        /// What went wrong.
        source: Box<RunError>,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Runs the plan; `progress` is called with the number of runs done, their total and what comes next: before
/// each run, and before each pass in which runs are timed again.
///
/// # Errors
/// If the scene names no reference, the plan is empty, or a run cannot start. A run that becomes unstable is
/// a row with `stopped` set.
pub fn study(
    scene: &Scene,
    plan: &Plan,
    progress: &mut dyn FnMut(usize, usize, &str),
) -> Result<Study, StudyError> {
    if scene.reference.is_none() {
        return Err(StudyError::NoReference);
    }
    if plan.methods.is_empty() || plan.cells.is_empty() {
        return Err(StudyError::NothingToDo);
    }
    let total = plan.methods.len() * plan.cells.len();
    let drawn_cells = nearest(&plan.cells, scene.grid.cells.first().copied().unwrap_or(1));
    let (mut rows, mut drawn) = (Vec::with_capacity(total), Vec::new());
    let mut timings = Vec::with_capacity(total);
    for &method in &plan.methods {
        for &cells in &plan.cells {
            progress(rows.len(), total, &format!("{method}, {cells} cells"));
            let (row, timing, outcome) = one(scene, method, cells)?;
            rows.push(row);
            timings.push(timing);
            if let (Some(outcome), true) = (outcome, cells == drawn_cells) {
                drawn.push((method, outcome));
            }
        }
    }
    timing::complete(&mut timings, plan, &mut |pass| {
        progress(total, total, &format!("timing again, pass {pass}"));
    })?;
    for (row, timing) in rows.iter_mut().zip(&timings) {
        row.take_times(&timing.times);
    }
    fill_orders(&mut rows);
    front::mark(&mut rows);
    Ok(Study {
        phases: scene.material.phases.count(),
        rows,
        drawn,
    })
}

fn nearest(cells: &[usize], wanted: usize) -> usize {
    let distance = |&&n: &&usize| n.abs_diff(wanted);
    cells.iter().min_by_key(distance).copied().unwrap_or(wanted)
}

/// The first run of a method at a resolution: what it found, and how long it took.
fn one(scene: &Scene, method: Method, cells: usize) -> Result<(Row, Timing, Option<Outcome>), StudyError> {
    let scene = scene.with_method(method).with_cells(cells);
    let found = match scene.dimension() {
        1 => run(&scene, None, &mut |_| {}).map(|outcome| (outcome.summary.clone(), Some(outcome))),
        _ => in_dimension!(scene, figures(&scene)).map(|summary| (summary, None)),
    };
    let mut row = Row::new(method, cells);
    row.velocity_mass = scene.method.velocity_mass.name();
    let mut timing = Timing {
        method,
        cells,
        scene,
        times: Vec::new(),
    };
    match found {
        Ok((summary, outcome)) => {
            row.take(&summary);
            timing.times.push(summary.wall_seconds);
            Ok((row, timing, outcome))
        }
        Err(stopped @ (RunError::Stopped { .. } | RunError::NoEnergy { .. })) => {
            row.stopped = Some(stopped.to_string());
            Ok((row, timing, None))
        }
        Err(source) => Err(StudyError::Run {
            method,
            cells,
            source: Box::new(source),
        }),
    }
}

fn figures<const D: usize>(scene: &Scene) -> Result<Summary, RunError>
where
    Scene: InSpace<D>,
{
    run_in::<D>(scene, None, &mut |_| {}).map(|outcome| outcome.summary)
}

/// Order of each field between neighbouring rows of one method.
fn fill_orders(rows: &mut [Row]) {
    for i in 1..rows.len() {
        let (coarse, fine) = (&rows[i - 1], &rows[i]);
        if coarse.method != fine.method {
            rows[i].orders.clear();
            continue;
        }
        let refinement = fine.cells as f64 / coarse.cells as f64;
        let orders = fine
            .errors
            .iter()
            .filter_map(|(&field, error)| {
                let ratio = coarse.errors.get(field)?.rms / error.rms;
                Some((field, ratio.ln() / refinement.ln()))
            })
            .filter(|(_, order)| order.is_finite())
            .collect();
        rows[i].orders = orders;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of one phase with this time (s) and relative stress error.
    pub(super) fn row(seconds: f64, error: Option<f64>) -> Row {
        let mut row = Row::new(Method::NINE[0], 10);
        row.wall_seconds = seconds;
        let norms = error.map(|error| ErrorNorms {
            rms: error,
            relative_l2: error,
            max: error,
        });
        row.errors = norms.map(|norms| ("stress", norms)).into_iter().collect();
        row
    }

    #[test]
    fn the_drawn_resolution_is_the_nearest_one() {
        assert_eq!(nearest(&[5, 10, 40], 20), 10);
        assert_eq!(nearest(&[5, 20, 40], 20), 20);
    }

    #[test]
    fn the_order_is_against_the_next_coarser_row_of_the_same_method() {
        let mut rows = [
            row(1.0, Some(0.4)),
            row(1.0, Some(0.1)),
            row(1.0, None),
            row(1.0, Some(0.1)),
        ];
        rows[1].cells = 20;
        rows[2].cells = 40;
        rows[3].cells = 80;
        fill_orders(&mut rows);
        assert!(rows[0].orders.is_empty());
        assert!((rows[1].orders["stress"] - 2.0).abs() < 1e-14);
        assert!(
            rows[2].orders.is_empty() && rows[3].orders.is_empty(),
            "a run stopped between"
        );
        rows[1].method = Method::NINE[1];
        fill_orders(&mut rows);
        assert!(rows[1].orders.is_empty(), "of another method");
    }

    #[test]
    fn a_row_says_which_mass_its_method_took() {
        let text = Scene::builtin("vibrating-bar-small").unwrap_or_default();
        let told = ["method.reconstruction=taylor", "method.velocity_mass=constrained"];
        let scene = Scene::from_toml(text, &told.map(String::from)).unwrap();
        let taken = |method| one(&scene, method, 5).unwrap().0.velocity_mass;
        // Linear functions with Shepard, which lumps always, and with Taylor.
        assert_eq!(taken(Method::NINE[0]), "lumped");
        assert_eq!(taken(Method::NINE[1]), "constrained");
    }

    #[test]
    fn a_run_has_as_many_times_as_asked_and_speed_is_of_the_median() {
        let text = Scene::builtin("vibrating-bar-small").unwrap_or_default();
        let scene = Scene::from_toml(text, &[]).unwrap();
        let plan = Plan {
            methods: Method::NINE[..2].to_vec(),
            cells: vec![5, 10],
            repeat: 3,
            least_seconds: 0.0,
        };
        let mut told = Vec::new();
        let done = study(&scene, &plan, &mut |run, total, what| {
            told.push(format!("{run}/{total} {what}"))
        });
        let rows = done.unwrap().rows;
        let first = [
            "linear+shepard, 5 cells",
            "linear+shepard, 10 cells",
            "linear+taylor, 5 cells",
        ];
        assert_eq!(told[0], format!("0/4 {}", first[0]));
        assert_eq!(told[2], format!("2/4 {}", first[2]));
        assert_eq!(
            told[4..],
            ["4/4 timing again, pass 2", "4/4 timing again, pass 3"]
        );
        for row in &rows {
            assert_eq!((row.timings, row.steps, row.particles), (3, 19, 12 * row.cells));
            let work = (row.particles * row.steps) as f64;
            let speed = row.particle_steps_per_second;
            assert!((speed * row.wall_seconds / work - 1.0).abs() < 1e-12);
        }
    }
}
