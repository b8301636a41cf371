//! Speed against error: methods x resolutions on one scene.

mod front;
mod report;

pub use report::{recommendation, write_fields, write_files};

use std::collections::BTreeMap;

use serde::Serialize;

use crate::method::Method;
use crate::output::OutputError;
use crate::run::{ConservationSummary, ErrorNorms, Outcome, RunError, run};
use crate::scene::Scene;

/// What to run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Methods, in the order of the report.
    pub methods: Vec<Method>,
    /// Numbers of cells, ascending.
    pub cells: Vec<usize>,
    /// How often each run is timed; the median counts.
    pub repeat: usize,
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
    /// Number of cells.
    pub cells: usize,
    /// Number of particles.
    pub particles: usize,
    /// Errors by field.
    pub errors: BTreeMap<&'static str, ErrorNorms>,
    /// Observed order by field (of the RMS error), against the next coarser row of the method; absent in its first.
    pub orders: BTreeMap<&'static str, f64>,
    /// Median time of the step loop (s).
    pub wall_seconds: f64,
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
        source: RunError,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Runs the plan; `progress` is called before each run with its number, the number of runs, and what it is.
///
/// # Errors
/// If the scene names no reference, the plan is empty, or a run cannot start. A run that becomes unstable is a row
/// with `stopped` set.
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
    let drawn_cells = nearest(&plan.cells, scene.grid.cells.iter().product());
    let (mut rows, mut drawn) = (Vec::with_capacity(total), Vec::new());
    for &method in &plan.methods {
        for &cells in &plan.cells {
            progress(rows.len(), total, &format!("{method}, {cells} cells"));
            let (row, outcome) = one(scene, method, cells, plan.repeat)?;
            rows.push(row);
            if let (Some(outcome), true) = (outcome, cells == drawn_cells) {
                drawn.push((method, outcome));
            }
        }
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

fn one(
    scene: &Scene,
    method: Method,
    cells: usize,
    repeat: usize,
) -> Result<(Row, Option<Outcome>), StudyError> {
    let scene = scene.with_method(method).with_cells(cells);
    let mut row = Row {
        basis: method.basis.name(),
        degree: method.basis.degree(),
        reconstruction: method.reconstruction.name(),
        subpoints: method.subpoints,
        cells,
        particles: 0,
        errors: BTreeMap::new(),
        orders: BTreeMap::new(),
        wall_seconds: f64::NAN,
        particle_steps_per_second: f64::NAN,
        conservation: BTreeMap::new(),
        grid_crossings: 0,
        on_front: false,
        stopped: None,
        warnings: Vec::new(),
        method,
    };
    let mut times = Vec::with_capacity(repeat);
    let mut last = None;
    for _ in 0..repeat.max(1) {
        match run(&scene, None, &mut |_| {}) {
            Ok(outcome) => {
                times.push(outcome.summary.wall_seconds);
                last = Some(outcome);
            }
            Err(stopped @ RunError::Stopped { .. }) => {
                row.stopped = Some(stopped.to_string());
                return Ok((row, None));
            }
            Err(source) => {
                return Err(StudyError::Run {
                    method,
                    cells,
                    source,
                });
            }
        }
    }
    if let Some(Outcome { summary, .. }) = &last {
        row.wall_seconds = median(&mut times);
        row.particles = summary.particles;
        row.particle_steps_per_second = (summary.particles * summary.steps) as f64 / row.wall_seconds;
        row.errors = summary.errors.clone();
        row.conservation = summary.conservation.clone();
        row.grid_crossings = summary.grid_crossings;
        row.warnings = summary.warnings.clone();
    }
    Ok((row, last))
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    let upper = times.get(times.len() / 2).copied().unwrap_or(f64::NAN);
    if times.len() % 2 == 1 || times.is_empty() {
        return upper;
    }
    (upper + times[times.len() / 2 - 1]) / 2.0
}

/// Order of each field between neighbouring rows of one method.
fn fill_orders(rows: &mut [Row]) {
    for i in 1..rows.len() {
        let (coarse, fine) = (&rows[i - 1], &rows[i]);
        if coarse.method != fine.method {
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

    #[test]
    fn the_median_of_an_even_number_lies_between() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(&mut []).is_nan());
    }

    #[test]
    fn the_drawn_resolution_is_the_nearest_one() {
        assert_eq!(nearest(&[5, 10, 40], 20), 10);
        assert_eq!(nearest(&[5, 20, 40], 20), 20);
    }
}
