//! Two phases in space, as scenes.
//!
//! Source: the series of one-dimensional consolidation (Terzaghi), for a load that comes within a time. Goal:
//! a column in space between smooth walls is the column of one dimension, along every axis. Parameters: a
//! column 1 m high and two cells wide, drained at the top, loaded there by 10 kPa within 0.05 s, Poisson's
//! ratio 0.2; ten cells high, two particles per cell and axis, TLS three; 0.25 s. Expected: at ten cells the
//! pressure within 3 % of the load of the series, and within 0.2 % as near to it as along one axis; the same
//! along every axis to round-off; the pressure in the files. B-splines with TLS are left out: in space, where
//! no even part of the load is taken from the stress, they are three times as far from the series as along one
//! axis (docs/verification/two-phase.md).

use std::f64::consts::PI;

use materialpoint_command::output::Folder;
use materialpoint_command::run::{run, run_in};
use materialpoint_command::scene::{ParticleOutput, Scene};

const AXES: [&str; 3] = ["x", "y", "z"];
const LOAD: f64 = 1e4;
const RAMP: f64 = 0.05;
const END: f64 = 0.25;
/// Modulus of uniaxial strain, stiffness of the liquid in its pores.
const M: f64 = 1e7 * 0.8 / (1.2 * 0.6);
const Q: f64 = 2e7 / 0.4;

/// The column along axis `up` of so many.
fn column(dimension: usize, up: usize, basis: &str, reconstruction: &str) -> Scene {
    let per_axis = |along: &str, beside: &str| {
        let each = (0..dimension).map(|axis| if axis == up { along } else { beside });
        format!("[{}]", each.collect::<Vec<_>>().join(", "))
    };
    let sides: String = (0..dimension)
        .filter(|&axis| axis != up)
        .flat_map(|axis| ["min", "max"].map(|side| format!("{}-{side}", AXES[axis])))
        .map(|face| format!("[[boundary]]\nface = \"{face}\"\nroller = true\n"))
        .collect();
    let law = match dimension {
        1 => format!("{{ youngs_modulus = {M:?} }}"),
        _ => "{ youngs_modulus = 1e7, poissons_ratio = 0.2 }".to_owned(),
    };
    let particles = if reconstruction == "taylor" { "3" } else { "2" };
    let [cells, max, zeros, many] = [
        per_axis("10", "2"),
        per_axis("1", "0.2"),
        per_axis("0", "0"),
        per_axis(particles, particles),
    ];
    let load = per_axis("'-1e4*sin(pi/2*min(t/0.05, 1))^2'", "'0'");
    let above = AXES[up];
    let text = format!(
        r#"
title = "Column"
[grid]
min = {zeros}
max = {max}
cells = {cells}
[time]
step = 2e-4
end = {END}
[method]
basis = "{basis}"
reconstruction = "{reconstruction}"
velocity_mass = "lumped"
[material]
phases = 2
strain = "small"
law.linear-elastic = {law}
porosity = 0.4
solid_density = 2.65e3
liquid_density = 1e3
liquid_bulk_modulus = 2e7
permeability = 2e-3
[[body]]
min = {zeros}
max = {max}
particles_per_cell = {many}
{sides}
[[boundary]]
face = "{above}-min"
roller = true
[[boundary]]
face = "{above}-max"
traction = {load}
drained = true
"#
    );
    Scene::from_toml(&text, &[]).unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn load_at(time: f64) -> f64 {
    LOAD * (PI / 2.0 * (time / RAMP).min(1.0)).sin().powi(2)
}

/// Pressure (Pa) of the series at a height (m) at the end.
fn series(height: f64) -> f64 {
    let diffusivity = 2e-3 / (1e3 * 9.81) / (1.0 / M + 1.0 / Q);
    let after = |time: f64| {
        let terms = (0..60).map(|m| {
            let wave = (f64::from(m) + 0.5) * PI;
            2.0 / wave * (wave * (1.0 - height)).sin() * (-wave * wave * diffusivity * time).exp()
        });
        terms.sum::<f64>()
    };
    let parts = 200;
    let steps = (0..parts).map(|k| {
        let [from, to] = [k, k + 1].map(|k| RAMP * f64::from(k) / f64::from(parts));
        (load_at(to) - load_at(from)) * after(END - (from + to) / 2.0)
    });
    -Q / (Q + M) * steps.sum::<f64>()
}

/// Heights, pressures and vertical stresses of the particles in space; both phases must keep their mass.
fn in_space(up: usize, basis: &str, reconstruction: &str) -> Vec<([f64; 3], f64, f64)> {
    let outcome = run_in::<3>(&column(3, up, basis, reconstruction), None, &mut |_| {}).unwrap();
    let kept = &outcome.summary.conservation;
    assert!(
        kept["solid"].mass < 1e-13 && kept["liquid"].mass < 1e-13,
        "{kept:?}"
    );
    let particles = &outcome.particles;
    let mut rows: Vec<_> = (0..particles.len())
        .map(|p| {
            let x = particles.initial_position[p];
            // Axes in turn: the first one is up.
            let turned = [0, 1, 2].map(|k| x[(up + k) % 3]);
            (turned, outcome.liquid[p].pressure, particles.stress[p][(up, up)])
        })
        .collect();
    rows.sort_by_key(|row| row.0.map(|x| (x * 1e6).round() as i64));
    rows
}

/// Largest difference of the pressure from the series over the load.
fn error(rows: impl Iterator<Item = (f64, f64)>) -> f64 {
    rows.map(|(height, pressure)| (pressure - series(height)).abs() / LOAD)
        .fold(0.0, f64::max)
}

#[test]
fn a_column_in_space_is_the_series_as_well_as_the_line_is() {
    for (basis, reconstruction) in [
        ("linear", "shepard"),
        ("dual-domain", "shepard"),
        ("bspline", "shepard"),
        ("linear", "taylor"),
        ("dual-domain", "taylor"),
    ] {
        let line = run(&column(1, 0, basis, reconstruction), None, &mut |_| {}).unwrap();
        let of_line = error(
            (0..line.liquid.len()).map(|p| (line.particles.initial_position[p][0], line.liquid[p].pressure)),
        );
        let rows = in_space(2, basis, reconstruction);
        let of_space = error(rows.iter().map(|row| (row.0[0], row.1)));
        println!("{basis} {reconstruction}: {of_line:.2e} {of_space:.2e}");
        assert!(
            of_line < 0.03 && (of_space - of_line).abs() < 2e-3,
            "{basis} {reconstruction}: {of_line} {of_space}"
        );
    }
}

#[test]
fn a_column_in_space_is_the_same_along_every_axis() {
    for (basis, reconstruction) in [("bspline", "shepard"), ("linear", "taylor")] {
        let expected = in_space(0, basis, reconstruction);
        for up in [1, 2] {
            for (found, expected) in in_space(up, basis, reconstruction).iter().zip(&expected) {
                let off = (found.1 - expected.1).abs().max((found.2 - expected.2).abs());
                assert!(
                    off < 1e-9 * LOAD,
                    "{basis} {reconstruction} {up}: {found:?} {expected:?}"
                );
            }
        }
    }
}

#[test]
fn files_in_space_tell_the_pressure() {
    let place = std::env::temp_dir().join(format!("materialpoint-pores-{}", std::process::id()));
    let folder = Folder::create(&place).unwrap();
    let mut scene = column(3, 2, "linear", "shepard");
    scene.time.end = 0.01;
    let outcome = run_in::<3>(&scene, Some(&folder), &mut |_| {}).unwrap();
    let table = std::fs::read_to_string(place.join("particles.csv")).unwrap();
    let mut lines = table.lines();
    let names: Vec<_> = lines.next().unwrap().split(',').collect();
    let at = names.iter().position(|name| name.starts_with("pore_pressure"));
    let at = at.unwrap_or_else(|| panic!("{names:?}"));
    let value = |line: &str| line.split(',').nth(at).unwrap().parse::<f64>().unwrap();
    let pressure: Vec<_> = lines.map(value).collect();
    assert_eq!(pressure.len(), outcome.liquid.len());
    scene.output.particles = ParticleOutput::Vtu;
    run_in::<3>(&scene, Some(&folder), &mut |_| {}).unwrap();
    let last = std::fs::read_dir(&place)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "vtu"))
        .max()
        .unwrap();
    let shown = String::from_utf8_lossy(&std::fs::read(&last).unwrap()).contains("pore_pressure");
    assert!(shown, "{last:?}");
    std::fs::remove_dir_all(&place).unwrap();
    for (found, liquid) in pressure.iter().zip(&outcome.liquid) {
        assert!((found - liquid.pressure).abs() < 1e-3, "{found} {liquid:?}");
    }
}
