//! Files and words of a study.

use std::path::PathBuf;

use super::{Row, Study};
use crate::method::{Basis, Method, ReconstructionKind};
use crate::output::{
    Curve, CurvePoint, FieldPanel, Folder, OutputError, Records, draw_fields, draw_grid_of_fields,
    draw_study, number,
};
use crate::run::{ErrorNorms, Outcome};

const FIELDS: [&str; 3] = ["displacement", "velocity", "stress"];

/// Writes `study.csv`, `study.svg` and `fields.svg`.
///
/// # Errors
/// If a file cannot be written.
pub fn write_files(study: &Study, title: &str, folder: &Folder) -> Result<Vec<PathBuf>, OutputError> {
    let picture = draw_study(
        &format!("{title}: stress error against time"),
        "time of the step loop [s]",
        "relative L2 error of the stress [-]",
        &curves(&study.rows),
    );
    let panels: Vec<_> = study
        .drawn
        .iter()
        .map(|(method, run)| stress_panel(*method, run))
        .collect();
    let fields = draw_grid_of_fields(&format!("{title}: stress"), "x [m]", "stress [Pa]", &panels, 4);
    Ok(vec![
        records(&study.rows).write_csv(folder, "study.csv")?,
        folder.write("study.svg", &picture)?,
        folder.write("fields.svg", &fields)?,
    ])
}

/// Writes `fields.svg`: displacement, velocity and stress of one run over position, against its reference.
///
/// # Errors
/// If the file cannot be written.
pub fn write_fields(run: &Outcome, folder: &Folder) -> Result<PathBuf, OutputError> {
    let particles = &run.particles;
    let panel = |name: &'static str, unit: &str, values: Vec<f64>, exact: &[f64]| FieldPanel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        particles: over_position(run, &values),
        reference: over_position(run, exact),
        note: note(run.summary.errors.get(name)),
    };
    let panels = [
        panel(
            "displacement",
            "m",
            particles.displacement.iter().map(|u| u[0]).collect(),
            &run.exact.displacement,
        ),
        panel(
            "velocity",
            "m/s",
            particles.velocity.iter().map(|v| v[0]).collect(),
            &run.exact.velocity,
        ),
        panel("stress", "Pa", stresses(run), &run.exact.stress),
    ];
    let title = format!("{} (t = {:.4} s)", run.summary.title, run.summary.time);
    folder.write("fields.svg", &draw_fields(&title, "x [m]", &panels))
}

fn stresses(run: &Outcome) -> Vec<f64> {
    run.particles.stress.iter().map(|s| s[(0, 0)]).collect()
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

fn stress_panel(method: Method, run: &Outcome) -> FieldPanel {
    FieldPanel {
        name: method.literature_name(),
        unit: "Pa".to_owned(),
        particles: over_position(run, &stresses(run)),
        reference: over_position(run, &run.exact.stress),
        note: note(run.summary.errors.get("stress")),
    }
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
            Basis::DualDomain => 1,
            Basis::BSpline { degree: 2 } => 2,
            Basis::BSpline { degree } => 2 + degree,
        },
        variant: match method.reconstruction {
            ReconstructionKind::Shepard => 0,
            ReconstructionKind::Taylor => 1,
            ReconstructionKind::Spline => 2,
            ReconstructionKind::RelaxedTaylor => 3,
        },
        points: vec![point],
    }
}

/// The rows as a table of text; a figure that does not exist is an empty field.
fn records(rows: &[Row]) -> Records {
    let mut header: Vec<String> = ["basis", "degree", "reconstruction", "cells", "particles"]
        .map(str::to_owned)
        .to_vec();
    for field in FIELDS {
        header.extend(["rms", "relative_l2", "max", "order"].map(|figure| format!("{field}_{figure}")));
    }
    let last = [
        "wall_seconds",
        "particle_steps_per_second",
        "mass_error",
        "momentum_error",
        "momentum_error_scaled",
        "grid_crossings",
        "on_front",
        "stopped",
    ];
    header.extend(last.map(str::to_owned));
    Records {
        header,
        rows: rows.iter().map(record).collect(),
    }
}

fn record(row: &Row) -> Vec<String> {
    let figure = |value: Option<f64>| value.filter(|v| v.is_finite()).map_or_else(String::new, number);
    let mut record = vec![
        row.basis.to_owned(),
        row.degree.to_string(),
        row.reconstruction.to_owned(),
        row.cells.to_string(),
        row.particles.to_string(),
    ];
    for field in FIELDS {
        let norms = row.errors.get(field);
        let figures = [
            norms.map(|n| n.rms),
            norms.map(|n| n.relative_l2),
            norms.map(|n| n.max),
            row.orders.get(field).copied(),
        ];
        record.extend(figures.map(figure));
    }
    let solid = row.conservation.get("solid");
    let figures = [
        Some(row.wall_seconds),
        Some(row.particle_steps_per_second),
        solid.map(|c| c.mass),
        solid.map(|c| c.momentum),
        solid.map(|c| c.momentum_scaled),
    ];
    record.extend(figures.map(figure));
    record.push(row.grid_crossings.to_string());
    record.push(row.on_front.to_string());
    record.push(row.stopped.clone().unwrap_or_default());
    record
}

/// A sentence to act on: the cheapest row whose stress error is below `limit` (0.01 is 1 %).
pub fn recommendation(rows: &[Row], limit: f64) -> String {
    let good = rows
        .iter()
        .filter(|row| row.stress_error().is_some_and(|error| error < limit));
    let percent = limit * 100.0;
    match good.min_by(|a, b| a.wall_seconds.total_cmp(&b.wall_seconds)) {
        Some(row) => format!(
            "For a stress error below {percent} % the cheapest here is {} with {} cells ({:.2} %, {:.3} s).",
            row.method.literature_name(),
            row.cells,
            row.stress_error().unwrap_or(f64::NAN) * 100.0,
            row.wall_seconds
        ),
        None => format!("No method here has a stress error below {percent} %: take more cells."),
    }
}
