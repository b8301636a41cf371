//! The picture of a run in the plane or in space.

use std::collections::HashMap;
use std::path::PathBuf;

use nalgebra::SVector;

use crate::output::{Folder, MapPanel, OutputError, draw_maps};
use crate::run::{Invariants, Outcome};
use crate::scene::Scene;

/// Writes `fields.svg`: particles where they are at the end, coloured by the sizes of displacement and
/// velocity, by the mean stress and by von Mises' stress, both with the stress off the plane; with two phases
/// by the pore pressure instead of the velocity, and the stress is the effective one. Stresses are left out
/// where the law does not know the one off the plane.
///
/// Particles in space are seen along `y` from its lower end: `x` to the right, `z` up, and what lies behind
/// others is hidden.
///
/// # Errors
/// If the file cannot be written.
pub fn write_maps<const D: usize>(
    scene: &Scene,
    run: &Outcome<D>,
    folder: &Folder,
) -> Result<PathBuf, OutputError> {
    let particles = &run.particles;
    let seen = seen(run);
    let size = |v: &SVector<f64, D>| v.norm();
    let panel = |name: &str, unit: &str, values: Vec<f64>| panel(scene, run, &seen, (name, unit), &values);
    let mut panels = vec![panel(
        "displacement",
        "m",
        particles.displacement.iter().map(size).collect(),
    )];
    let mean_name = match run.liquid.is_empty() {
        true => {
            let speeds = particles.velocity.iter().map(size).collect();
            panels.push(panel("velocity", "m/s", speeds));
            "mean stress (xx + yy + zz)/3"
        }
        false => {
            let pressures = run.liquid.iter().map(|liquid| liquid.pressure).collect();
            panels.push(panel("pore pressure", "Pa", pressures));
            "mean effective stress (xx + yy + zz)/3"
        }
    };
    let invariants: Vec<Invariants> = run.invariants().collect();
    if !invariants.is_empty() {
        let mean = invariants.iter().map(|i| i.mean).collect();
        panels.push(panel(mean_name, "Pa", mean));
        let von_mises = invariants.iter().map(|i| i.von_mises).collect();
        panels.push(panel("von Mises stress, with zz", "Pa", von_mises));
    }
    let view = if D == 3 { ", seen along y" } else { "" };
    let title = format!("{} (t = {:.4} s{view})", run.summary.title, run.summary.time);
    folder.write("fields.svg", &draw_maps(&title, &panels))
}

/// Right and up in the picture: the first axis and the last.
fn shown(x: &[f64]) -> [f64; 2] {
    [x.first(), x.last()].map(|x| x.copied().unwrap_or(f64::NAN))
}

fn panel<const D: usize>(
    scene: &Scene,
    run: &Outcome<D>,
    seen: &[usize],
    (name, unit): (&str, &str),
    values: &[f64],
) -> MapPanel {
    let positions = &run.particles.position;
    let points = seen.iter().filter_map(|&p| positions.get(p));
    MapPanel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        axes: ["x", if D == 3 { "z" } else { "y" }],
        bounds: [shown(&scene.grid.min), shown(&scene.grid.max)],
        points: points.map(|x| shown(x.as_slice())).collect(),
        values: seen.iter().filter_map(|&p| values.get(p).copied()).collect(),
    }
}

/// Particles that are not hidden: in space the first one along `y` of each square of half a particle's width.
/// Dots of one colour are drawn together, so that without this the colour would decide what lies in front.
fn seen<const D: usize>(run: &Outcome<D>) -> Vec<usize> {
    let particles = &run.particles;
    if D < 3 {
        return (0..particles.len()).collect();
    }
    let mean = particles.volume.iter().sum::<f64>() / particles.len().max(1) as f64;
    let side = mean.cbrt() / 2.0;
    let mut front: HashMap<[i64; 2], usize> = HashMap::new();
    let depth = |p: usize| particles.position.get(p).and_then(|x| x.get(1).copied());
    for (p, x) in particles.position.iter().enumerate() {
        let square = shown(x.as_slice()).map(|x| (x / side).floor() as i64);
        let first = front.entry(square).or_insert(p);
        if depth(p) < depth(*first) {
            *first = p;
        }
    }
    let mut seen: Vec<usize> = front.into_values().collect();
    seen.sort_unstable();
    seen
}
