//! Files and words of a study.

use std::path::PathBuf;

use super::{Row, Study};
use crate::output::{
    Curve, CurvePoint, FieldPanel, Folder, OutputError, Records, draw_fields, draw_grid_of_fields,
    draw_study, number,
};
use crate::run::{ConservationSummary, ErrorNorms, FieldValues, Outcome};
use materialpoint::method::{Basis, Method, ReconstructionKind};

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

/// The picture (SVG text) of a study: stress error against time, one curve a method, the front marked.
pub fn picture(study: &Study, title: &str) -> String {
    let stress = Words::of(study).stress();
    draw_study(
        &format!("{title}: {stress} error against time"),
        "time of the step loop [s]",
        &format!("relative L2 error of the {stress} [-]"),
        &curves(&study.rows),
    )
}

/// Writes `study.csv`, `study.svg` and, where there are runs to draw, `fields.svg`.
///
/// # Errors
/// If a file cannot be written.
pub fn write_files(study: &Study, title: &str, folder: &Folder) -> Result<Vec<PathBuf>, OutputError> {
    let words = Words::of(study);
    let stress = words.stress();
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
    let mut files = vec![
        records(&study.rows, words).write_csv(folder, "study.csv")?,
        folder.write("study.svg", &picture(study, title))?,
    ];
    if !panels.is_empty() {
        files.push(folder.write("fields.svg", &fields)?);
    }
    Ok(files)
}

/// Writes `fields.svg`: every field of one run over position, against its reference.
///
/// # Errors
/// If the file cannot be written.
pub fn write_fields(run: &Outcome, folder: &Folder) -> Result<PathBuf, OutputError> {
    let mut panels = Vec::new();
    run.for_each_field(|field| panels.push(panel(run, &field, spoken(field.name))));
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

/// Values over the particles' positions, ascending, no more than a picture can show.
fn over_position(run: &Outcome, values: &[f64]) -> Vec<(f64, f64)> {
    let positions = run.particles.position.iter().map(|x| x[0]);
    let mut points: Vec<_> = positions.zip(values.iter().copied()).collect();
    points.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    thinned(points)
}

/// Beyond this many points only the lowest and the highest of each group of neighbours are drawn.
const MOST_POINTS: usize = 20_000;

/// Of many points the extremes of neighbours, so that no outlier is lost; a value that is no number counts as
/// one.
fn thinned(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    if points.len() <= MOST_POINTS {
        return points;
    }
    let group = points.len().div_ceil(MOST_POINTS / 2);
    let extremes = |group: &[(f64, f64)]| {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let (low, high) = (group.iter().min_by(by_value), group.iter().max_by(by_value));
        [low.copied(), high.copied()]
    };
    let mut few: Vec<_> = points.chunks(group).flat_map(extremes).flatten().collect();
    few.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    few
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
        let error = match row.stress_error() {
            Some(error) => error,
            // Counted by the picture, not drawn.
            None if row.stopped.is_some() => f64::NAN,
            None => continue,
        };
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
    let percent = limit * 100.0;
    let rows = || {
        let known = study
            .rows
            .iter()
            .filter_map(|row| Some((row, row.stress_error()?)));
        known.filter(|(row, error)| error.is_finite() && row.wall_seconds.is_finite())
    };
    let good = rows().filter(|(_, error)| *error < limit);
    if let Some((row, error)) = good.min_by(|a, b| a.0.wall_seconds.total_cmp(&b.0.wall_seconds)) {
        let what = described(row, error);
        return format!("For {article} {stress} error below {percent} % the cheapest here is {what}.");
    }
    let none = format!("No method here has {article} {stress} error below {percent} %");
    match rows().min_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((row, error)) => format!("{none}: nearest is {}; take more cells.", described(row, error)),
        None => format!("{none}: no run has a result; look at the time step and the loads."),
    }
}

fn described(row: &Row, error: f64) -> String {
    let seconds = spoken_time(row.wall_seconds);
    let (method, percent) = (row.method.literature_name(), error * 100.0);
    format!("{method} with {} cells ({percent:.2} %, {seconds})", row.cells)
}

/// A time (s) with its unit, three digits or so.
fn spoken_time(seconds: f64) -> String {
    match seconds {
        0.1.. => format!("{seconds:.2} s"),
        1e-4.. => format!("{:.2} ms", seconds * 1e3),
        _ => format!("{:.1} µs", seconds * 1e6),
    }
}

/// The front as a table in Markdown, ascending in time, with the errors of every field, and a recommendation
/// for each of `limits` (0.01 is 1 %).
pub fn front_in_markdown(study: &Study, limits: &[f64]) -> String {
    let words = Words::of(study);
    let fields = words.fields.iter().map(|field| spoken(field));
    let header: Vec<String> = ["method", "cells", "time"]
        .map(str::to_owned)
        .into_iter()
        .chain(fields)
        .collect();
    let mut lines = vec![header.join(" | "), vec!["---"; header.len()].join(" | ")];
    let mut front: Vec<&Row> = study.rows.iter().filter(|row| row.on_front).collect();
    front.sort_by(|a, b| a.wall_seconds.total_cmp(&b.wall_seconds));
    lines.extend(front.into_iter().map(|row| {
        let error = |field: &&str| row.errors.get(field).map_or(f64::NAN, |norms| norms.relative_l2);
        let mut cells = vec![
            row.method.literature_name(),
            row.cells.to_string(),
            spoken_time(row.wall_seconds),
        ];
        cells.extend(words.fields.iter().map(|field| format!("{:.2e}", error(field))));
        cells.join(" | ")
    }));
    let mut text: String = lines.iter().map(|line| format!("| {line} |\n")).collect();
    for limit in limits {
        text += &format!("\n* {}", recommendation(study, *limit));
    }
    text + "\n"
}

#[cfg(test)]
mod tests {
    use super::super::tests::row;
    use super::*;

    fn study(rows: Vec<Row>) -> Study {
        Study {
            phases: 1,
            rows,
            drawn: Vec::new(),
        }
    }

    #[test]
    fn the_cheapest_that_is_good_enough_is_recommended() {
        let stopped = row(f64::NAN, None);
        let rows = vec![
            row(0.5, Some(2e-3)),
            row(0.25, Some(9e-3)),
            row(0.01, Some(0.02)),
            stopped,
        ];
        let expected =
            "For a stress error below 1 % the cheapest here is MPM with 10 cells (0.90 %, 0.25 s).";
        assert_eq!(recommendation(&study(rows), 0.01), expected);
    }

    #[test]
    fn of_a_million_points_few_are_drawn_and_no_outlier_is_lost() {
        let mut points: Vec<_> = (0..1_000_000).map(|i| (f64::from(i), 1.0)).collect();
        points[123_456].1 = -7.0;
        points[654_321].1 = 9.0;
        let few = thinned(points.clone());
        assert!(
            few.len() <= MOST_POINTS && few.len() > MOST_POINTS / 2,
            "{}",
            few.len()
        );
        assert!(few.contains(&(123_456.0, -7.0)) && few.contains(&(654_321.0, 9.0)));
        assert!(few.is_sorted_by(|a, b| a.0 <= b.0));
        let own = points.split_off(980_000);
        assert_eq!(thinned(own.clone()), own);
    }

    #[test]
    fn the_front_in_markdown_is_in_the_order_of_time_and_ends_with_advice() {
        let mut rows = vec![row(0.5, Some(2e-3)), row(0.25, Some(9e-3)), row(0.3, Some(0.02))];
        super::super::front::mark(&mut rows);
        let text = front_in_markdown(&study(rows), &[0.01, 1e-3]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines[0],
            "| method | cells | time | displacement | velocity | stress |"
        );
        assert_eq!(lines[2], "| MPM | 10 | 0.25 s | NaN | NaN | 9.00e-3 |");
        assert_eq!(lines[3], "| MPM | 10 | 0.50 s | NaN | NaN | 2.00e-3 |");
        assert!(lines[5].starts_with("* For a stress error below 1 %"));
        assert!(lines[6].starts_with("* No method here has a stress error below 0.1 %"));
        assert_eq!(lines.len(), 7);
    }

    #[test]
    fn where_none_is_good_enough_the_nearest_is_named() {
        let rows = vec![
            row(2e-3, Some(0.05)),
            row(1e-5, Some(0.02)),
            row(1.0, Some(f64::NAN)),
        ];
        let sentence = recommendation(&study(rows), 0.01);
        assert!(
            sentence.contains("nearest is MPM with 10 cells (2.00 %, 10.0 µs); take"),
            "{sentence}"
        );
        let none = recommendation(&study(vec![row(f64::NAN, None)]), 0.01);
        assert!(none.contains("no run has a result"), "{none}");
    }

    #[test]
    fn a_stopped_run_is_a_point_that_the_picture_counts_and_cannot_draw() {
        let mut stopped = row(f64::NAN, None);
        stopped.stopped = Some("step 3".into());
        let curves = curves(&[row(1.0, Some(0.1)), stopped, row(1.0, None)]);
        assert_eq!(curves[0].points.len(), 2);
        let picture = draw_study("", "t [s]", "e [-]", &curves);
        assert!(
            picture.contains("1 point not drawn") && picture.contains("stopped, or not"),
            "{picture}"
        );
    }
}
