//! `materialpoint study`, and the default study.

use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::reconstruction::SubPoints;
use materialpoint_command::output::Folder;
use materialpoint_command::scene::Scene;
use materialpoint_command::study::{Plan, Row, recommendation, study, write_files};
use serde_json::json;

use super::bar::bar;
use super::failure::Failure;
use super::print::{print, print_json};
use super::run::{load, warn};
use super::{Shared, StudyFlags, study_table};

/// Scene of the default study.
const DEFAULT_SCENE: &str = "vibrating-bar-large";
/// Its numbers of cells.
const DEFAULT_CELLS: [usize; 4] = [10, 20, 40, 80];
/// Stress error that the recommendation asks for.
const LIMIT: f64 = 0.01;

/// Shorter runs are timed again until that makes up this (s).
const LEAST_SECONDS: f64 = 0.1;

pub(super) fn default_study(shared: &Shared, flags: &StudyFlags) -> Result<(), Failure> {
    let scene = Scene::from_toml(Scene::builtin(DEFAULT_SCENE).unwrap_or_default(), &shared.set)?;
    report(&scene, shared, flags, &DEFAULT_CELLS)
}

pub(super) fn study_scene(name: &str, shared: &Shared, flags: &StudyFlags) -> Result<(), Failure> {
    let scene = load(name, &shared.set)?;
    let own = scene.grid.cells.first().copied().unwrap_or(1);
    report(&scene, shared, flags, &[own.div_ceil(2), own, 2 * own])
}

fn report(scene: &Scene, shared: &Shared, flags: &StudyFlags, cells: &[usize]) -> Result<(), Failure> {
    let plan = plan(scene, flags, cells)?;
    let folder = Folder::create(&shared.out)?;
    let progress_bar = bar(
        shared.quiet,
        (plan.methods.len() * plan.cells.len()) as u64,
        "runs",
    );
    let done = study(scene, &plan, &mut |run, _, what| {
        progress_bar.set_position(run as u64);
        progress_bar.set_message(what.to_owned());
    });
    progress_bar.finish_and_clear();
    let done = done?;
    let mut warnings: Vec<String> = done.rows.iter().flat_map(warnings).collect();
    warnings.dedup();
    warn(&warnings);
    let files = write_files(&done, &scene.title, &folder)?;
    if shared.json {
        let recommendation = recommendation(&done, LIMIT);
        return print_json(&json!({ "rows": done.rows, "recommendation": recommendation }));
    }
    let mut text = study_table::text(&done, &scene.title) + &recommendation(&done, LIMIT) + "\n";
    for file in files {
        text += &format!("wrote {}\n", file.display());
    }
    print(&text)
}

fn plan(scene: &Scene, flags: &StudyFlags, default_cells: &[usize]) -> Result<Plan, Failure> {
    let mut cells = if flags.cells.is_empty() {
        default_cells.to_vec()
    } else {
        flags.cells.clone()
    };
    cells.sort_unstable();
    cells.dedup();
    if cells.first() == Some(&0) {
        return Err(Failure::Input("--cells: a grid needs at least 1 cell".into()));
    }
    let repeat = flags.repeat.unwrap_or(1);
    if repeat == 0 {
        return Err(Failure::Input(
            "--repeat 0: each run must be timed at least once".into(),
        ));
    }
    Ok(Plan {
        methods: methods(scene, flags.methods.as_deref().unwrap_or("all"))?,
        cells,
        repeat,
        least_seconds: LEAST_SECONDS,
    })
}

fn methods(scene: &Scene, list: &str) -> Result<Vec<Method>, Failure> {
    let (dimension, phases) = (scene.dimension(), scene.material.phases.count());
    if list == "all" {
        return Ok(Method::all_in(dimension, phases));
    }
    let methods: Vec<_> = list
        .split(',')
        .map(|name| method(name.trim()))
        .collect::<Result<_, _>>()?;
    let unknown = |method: &&Method| !method.reconstruction.is_known(dimension, phases);
    match methods.iter().find(unknown) {
        Some(method) if method.reconstruction == ReconstructionKind::RelaxedTaylor => {
            Err(Failure::Input(format!(
                "--methods: {method} knows one phase only beyond one axis so far; with material.phases = 2 write shepard or taylor"
            )))
        }
        Some(method) => Err(Failure::Input(format!(
            "--methods: {method} exists in one dimension only, and the scene has {dimension}; write shepard, taylor or relaxed-taylor"
        ))),
        None => Ok(methods),
    }
}

/// Any pair of a known basis and a known reconstruction, or dual domain with sub-points.
fn method(name: &str) -> Result<Method, Failure> {
    let bases = [Basis::Linear, Basis::DualDomain]
        .into_iter()
        .chain([2, 1, 3].map(|degree| Basis::BSpline { degree }));
    let kinds = [
        ReconstructionKind::Shepard,
        ReconstructionKind::Taylor,
        ReconstructionKind::RelaxedTaylor,
        ReconstructionKind::Spline,
    ];
    bases
        .flat_map(|basis| kinds.map(|kind| Method::new(basis, kind)))
        .chain((2..=SubPoints::MOST).map(Method::sub_points))
        .find(|method| method.to_string() == name)
        .ok_or_else(|| {
            Failure::Input(format!(
                "--methods: there is no method {name:?}; write all, or basis+reconstruction with linear, dual-domain, \
                 bspline (degree 2), bspline1 or bspline3 and shepard, taylor, relaxed-taylor or spline; \
                 dual-domain+shepard4 has 4 sub-points in each particle, 2 to 128 are possible"
            ))
        })
}

/// The warnings of a row, with its name.
fn warnings(row: &Row) -> Vec<String> {
    let named = |warning| format!("{}, {} cells: {warning}", row.method, row.cells);
    row.warnings.iter().map(named).collect()
}
