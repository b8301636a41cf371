//! The table of a study on the terminal.

use comfy_table::{CellAlignment, Table, TableComponent, presets};
use materialpoint_command::run::ConservationSummary;
use materialpoint_command::study::{Row, Study};

/// Column and name of each field.
type Fields = &'static [(&'static str, &'static str)];

/// The front's field first.
const ONE_PHASE: Fields = &[("stress", "stress"), ("u", "displacement"), ("v", "velocity")];
const TWO_PHASES: Fields = &[
    ("stress", "effective_stress"),
    ("p", "pore_pressure"),
    ("u", "solid_displacement"),
    ("v", "solid_velocity"),
    ("v_w", "liquid_velocity"),
];

/// Title, table, what its columns mean, and why runs stopped.
pub(super) fn text(study: &Study, title: &str) -> String {
    let (fields, names) = match study.phases {
        1 => (ONE_PHASE, "stress, displacement u, velocity v"),
        _ => (
            TWO_PHASES,
            "effective stress, pore pressure p, displacement u and velocity v of the solid, velocity v_w of the liquid",
        ),
    };
    let table = table(study, fields);
    let stopped: String = study.rows.iter().filter_map(stopped).collect();
    format!(
        "{title}\n\n{table}\n\
         {names}:\n\
         relative L2 error against the reference;\n\
         ord: observed order of the RMS error, against the row above; time: median, step loop only; Mps/s: million particle steps per\n\
         second; mass, momentum: largest conservation error; front: no other row is both faster and more accurate (stress)\n\
         \n{stopped}"
    )
}

fn table(study: &Study, fields: Fields) -> Table {
    let mut table = Table::new();
    table.load_preset(presets::NOTHING);
    table.set_style(TableComponent::HeaderLines, '─');
    table.set_style(TableComponent::MiddleHeaderIntersections, '─');
    let header = ["method", "cells"].into_iter();
    let header = header.chain(fields.iter().flat_map(|&(column, _)| [column, "ord"]));
    table.set_header(header.chain(["time [s]", "Mps/s", "crossings", "mass", "momentum", "front"]));
    for row in &study.rows {
        table.add_row(cells(row, fields));
    }
    for column in table.column_iter_mut() {
        column.set_padding((0, 1));
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn cells(row: &Row, fields: Fields) -> Vec<String> {
    let mut cells = vec![row.method.literature_name(), row.cells.to_string()];
    for (_, field) in fields {
        let norms = row.errors.get(field).map(|norms| norms.relative_l2);
        cells.push(error(norms, row.stopped.is_some()));
        let order = row.orders.get(field);
        cells.push(order.map_or_else(String::new, |order| format!("{order:.1}")));
    }
    // The worse of the phases.
    let kept = |pick: fn(&ConservationSummary) -> f64| {
        let worst = row.conservation.values().map(pick).reduce(f64::max);
        worst.map_or_else(nothing, |error| format!("{error:.0e}"))
    };
    cells.extend([
        seconds(row.wall_seconds),
        finite(row.particle_steps_per_second / 1e6, |speed| format!("{speed:.1}")),
        match row.stopped {
            Some(_) => nothing(),
            None => row.grid_crossings.to_string(),
        },
        kept(|errors| errors.mass),
        kept(|errors| errors.momentum),
        if row.on_front { "*".into() } else { String::new() },
    ]);
    cells
}

/// A relative error; nothing is relative to a reference that is zero.
fn error(value: Option<f64>, stopped: bool) -> String {
    match value {
        None if stopped => "stopped".into(),
        None => nothing(),
        Some(value) => finite(value, |value| format!("{value:.2e}")),
    }
}

/// Three digits, whether the run took microseconds or minutes.
fn seconds(value: f64) -> String {
    finite(value, |value| match value {
        0.1.. => format!("{value:.3}"),
        _ => format!("{value:.2e}"),
    })
}

fn finite(value: f64, text: impl Fn(f64) -> String) -> String {
    if value.is_finite() { text(value) } else { nothing() }
}

fn nothing() -> String {
    "-".into()
}

fn stopped(row: &Row) -> Option<String> {
    let why = row.stopped.as_ref()?;
    Some(format!("{}, {} cells stopped: {why}\n", row.method, row.cells))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_a_dash_and_a_stop_is_said() {
        assert_eq!(error(Some(0.0123), false), "1.23e-2");
        assert_eq!(error(Some(f64::INFINITY), false), "-");
        assert_eq!(error(None, true), "stopped");
        assert_eq!(error(None, false), "-");
        assert_eq!(
            [seconds(f64::NAN), seconds(2.5e-5), seconds(12.0)],
            ["-", "2.50e-5", "12.000"]
        );
    }
}
