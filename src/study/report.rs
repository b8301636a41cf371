//! Files and words of a study.

use std::path::PathBuf;

use super::{Row, Study};
use crate::method::{Basis, Method, ReconstructionKind};
use crate::output::{
    Curve, CurvePoint, FieldPanel, Folder, OutputError, Records, draw_fields, draw_grid_of_fields,
    draw_study, number,
};
use crate::run::{ConservationSummary, ErrorNorms, FieldValues, Outcome};

/// What a study of so many phases reports.
struct Words {
    fields: &'static [&'static str],
    /// The field that front, curves and pictures are about.
    stress: &'static str,
    article: &'static str,
    phases: &'static [&'static str],
}

const ONE_PHASE: Words = Words {
    fields: &["displacement", "velocity", "stress"],
    stress: "stress",
    article: "a",
    phases: &["solid"],
};

const TWO_PHASES: Words = Words {
    fields: &[
        "solid_displacement",
        "solid_velocity",
        "liquid_velocity",
        "effective_stress",
        "pore_pressure",
    ],
    stress: "effective_stress",
    article: "an",
    phases: &["solid", "liquid"],
};

impl Words {
    fn of(study: &Study) -> &'static Self {
        if study.phases == 1 {
            &ONE_PHASE
        } else {
            &TWO_PHASES
        }
    }

    /// The stress in words.
    fn stress(&self) -> String {
        spoken(self.stress)
    }
}

/// The name of a field in words.
fn spoken(name: &str) -> String {
    name.replace('_', " ")
}

/// Writes `study.csv`, `study.svg` and `fields.svg`.
///
/// # Errors
/// If a file cannot be written.
pub fn write_files(study: &Study, title: &str, folder: &Folder) -> Result<Vec<PathBuf>, OutputError> {
    let words = Words::of(study);
    let stress = words.stress();
    let picture = draw_study(
        &format!("{title}: {stress} error against time"),
        "time of the step loop [s]",
        &format!("relative L2 error of the {stress} [-]"),
        &curves(&study.rows),
    );
    let panels: Vec<_> = study
        .drawn
        .iter()
        .filter_map(|(method, run)| stress_panel(*method, run, words))
        .collect();
    // Three reconstructions of each basis in two phases, four in one.
    let columns = if study.phases == 1 { 4 } else { 3 };
    let fields = draw_grid_of_fields(
        &format!("{title}: {stress}"),
        "x [m]",
        &format!("{stress} [Pa]"),
        &panels,
        columns,
    );
    Ok(vec![
        records(&study.rows, words).write_csv(folder, "study.csv")?,
        folder.write("study.svg", &picture)?,
        folder.write("fields.svg", &fields)?,
    ])
}

/// Writes `fields.svg`: every field of one run over position, against its reference.
///
/// # Errors
/// If the file cannot be written.
pub fn write_fields(run: &Outcome, folder: &Folder) -> Result<PathBuf, OutputError> {
    let panels: Vec<_> = run
        .fields()
        .iter()
        .map(|field| panel(run, field, spoken(field.name)))
        .collect();
    let title = format!("{} (t = {:.4} s)", run.summary.title, run.summary.time);
    folder.write("fields.svg", &draw_fields(&title, "x [m]", &panels))
}

fn panel(run: &Outcome, field: &FieldValues, name: String) -> FieldPanel {
    FieldPanel {
        name,
        unit: field.unit.to_owned(),
        particles: over_position(run, &field.values),
        reference: over_position(run, &field.exact),
        note: note(run.summary.errors.get(field.name)),
    }
}

/// Values over the particles' positions, ascending.
fn over_position(run: &Outcome, values: &[f64]) -> Vec<(f64, f64)> {
    let positions = run.particles.position.iter().map(|x| x[0]);
    let mut points: Vec<_> = positions.zip(values.iter().copied()).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

fn note(norms: Option<&ErrorNorms>) -> String {
    norms.map_or_else(String::new, |norms| {
        format!("relative L2 error {:.2e}", norms.relative_l2)
    })
}

fn stress_panel(method: Method, run: &Outcome, words: &Words) -> Option<FieldPanel> {
    let fields = run.fields();
    let stress = fields.iter().find(|field| field.name == words.stress)?;
    Some(panel(run, stress, method.literature_name()))
}

fn curves(rows: &[Row]) -> Vec<Curve> {
    let mut curves: Vec<(Method, Curve)> = Vec::new();
    for row in rows {
        let Some(error) = row.stress_error() else { continue };
        let point = CurvePoint {
            x: row.wall_seconds,
            y: error,
            label: format!("{} cells", row.cells),
            on_front: row.on_front,
        };
        match curves.last_mut() {
            Some((method, curve)) if *method == row.method => curve.points.push(point),
            _ => curves.push((row.method, curve(row.method, point))),
        }
    }
    curves.into_iter().map(|(_, curve)| curve).collect()
}

fn curve(method: Method, point: CurvePoint) -> Curve {
    Curve {
        label: method.literature_name(),
        family: match method.basis {
            Basis::Linear => 0,
            // A colour of their own.
            Basis::DualDomain if method.subpoints > 1 => 4,
            Basis::DualDomain => 1,
            Basis::BSpline { degree: 2 } => 2,
            Basis::BSpline { degree } => 2 + degree,
        },
        variant: match method.reconstruction {
            // 2, 4, 8, ... sub-points take the four lines in turn.
            ReconstructionKind::Shepard => method.subpoints.checked_ilog2().unwrap_or(0) as usize,
            ReconstructionKind::Taylor => 1,
            ReconstructionKind::Spline => 2,
            ReconstructionKind::RelaxedTaylor => 3,
        },
        points: vec![point],
    }
}

/// The rows as a table of text; a figure that does not exist is an empty field.
fn records(rows: &[Row], words: &Words) -> Records {
    let mut header: Vec<String> = [
        "basis",
        "degree",
        "reconstruction",
        "subpoints",
        "cells",
        "particles",
    ]
    .map(str::to_owned)
    .to_vec();
    for field in words.fields {
        header.extend(["rms", "relative_l2", "max", "order"].map(|figure| format!("{field}_{figure}")));
    }
    header.extend(["wall_seconds", "particle_steps_per_second"].map(str::to_owned));
    for phase in words.phases {
        // The solid's have no prefix: they are the only ones in one phase.
        let prefix = if *phase == "solid" { "" } else { "liquid_" };
        let errors = ["mass_error", "momentum_error", "momentum_error_scaled"];
        header.extend(errors.map(|error| format!("{prefix}{error}")));
    }
    header.extend(["grid_crossings", "on_front", "stopped"].map(str::to_owned));
    Records {
        header,
        rows: rows.iter().map(|row| record(row, words)).collect(),
    }
}

fn record(row: &Row, words: &Words) -> Vec<String> {
    let figure = |value: Option<f64>| value.filter(|v| v.is_finite()).map_or_else(String::new, number);
    let mut record = vec![
        row.basis.to_owned(),
        row.degree.to_string(),
        row.reconstruction.to_owned(),
        row.subpoints.to_string(),
        row.cells.to_string(),
        row.particles.to_string(),
    ];
    for &field in words.fields {
        let norms = row.errors.get(field);
        let figures = [
            norms.map(|n| n.rms),
            norms.map(|n| n.relative_l2),
            norms.map(|n| n.max),
            row.orders.get(field).copied(),
        ];
        record.extend(figures.map(figure));
    }
    let speed = [row.wall_seconds, row.particle_steps_per_second];
    record.extend(speed.map(Some).map(figure));
    for &phase in words.phases {
        let errors = row.conservation.get(phase);
        let pick = |one: fn(&ConservationSummary) -> f64| errors.map(one);
        let figures = [
            pick(|c| c.mass),
            pick(|c| c.momentum),
            pick(|c| c.momentum_scaled),
        ];
        record.extend(figures.map(figure));
    }
    record.push(row.grid_crossings.to_string());
    record.push(row.on_front.to_string());
    record.push(row.stopped.clone().unwrap_or_default());
    record
}

/// A sentence to act on: the cheapest row whose (effective) stress error is below `limit` (0.01 is 1 %).
pub fn recommendation(study: &Study, limit: f64) -> String {
    let Words { article, .. } = Words::of(study);
    let stress = Words::of(study).stress();
    let good = study
        .rows
        .iter()
        .filter(|row| row.stress_error().is_some_and(|error| error < limit));
    let percent = limit * 100.0;
    match good.min_by(|a, b| a.wall_seconds.total_cmp(&b.wall_seconds)) {
        Some(row) => format!(
            "For {article} {stress} error below {percent} % the cheapest here is {} with {} cells ({:.2} %, {:.3} s).",
            row.method.literature_name(),
            row.cells,
            row.stress_error().unwrap_or(f64::NAN) * 100.0,
            row.wall_seconds
        ),
        None => format!("No method here has {article} {stress} error below {percent} %: take more cells."),
    }
}
