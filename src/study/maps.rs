//! The picture of a run in the plane or in space.

use std::path::PathBuf;

use nalgebra::{SMatrix, SVector};

use crate::output::{Folder, MapPanel, OutputError, draw_maps};
use crate::run::Outcome;
use crate::scene::Scene;

/// Writes `fields.svg`: particles where they are at the end, coloured by the sizes of displacement and velocity, by the mean stress
/// and by von Mises' stress; with two phases by the pore pressure instead of the velocity, and the stress is the effective one.
/// Particles in space are seen along `y`, the later ones in front.
///
/// # Errors
/// If the file cannot be written.
pub fn write_maps<const D: usize>(
    scene: &Scene,
    run: &Outcome<D>,
    folder: &Folder,
) -> Result<PathBuf, OutputError> {
    let particles = &run.particles;
    let size = |v: &SVector<f64, D>| v.norm();
    let (second, mean_name) = match run.liquid.is_empty() {
        true => {
            let speeds = particles.velocity.iter().map(size);
            (panel(scene, run, "velocity", "m/s", speeds), "mean stress")
        }
        false => {
            let pressures = run.liquid.iter().map(|liquid| liquid.pressure);
            let pressures = panel(scene, run, "pore pressure", "Pa", pressures);
            (pressures, "mean effective stress")
        }
    };
    let displacements = particles.displacement.iter().map(size);
    let panels = [
        panel(scene, run, "displacement", "m", displacements),
        second,
        panel(scene, run, mean_name, "Pa", particles.stress.iter().map(mean)),
        panel(
            scene,
            run,
            "von Mises stress",
            "Pa",
            particles.stress.iter().map(von_mises),
        ),
    ];
    let title = format!("{} (t = {:.4} s)", run.summary.title, run.summary.time);
    folder.write("fields.svg", &draw_maps(&title, &panels))
}

fn panel<const D: usize>(
    scene: &Scene,
    run: &Outcome<D>,
    name: &str,
    unit: &str,
    values: impl Iterator<Item = f64>,
) -> MapPanel {
    // Right and up in the picture: the first axis and the last.
    let shown = |x: &[f64]| [x.first(), x.last()].map(|x| x.copied().unwrap_or(f64::NAN));
    MapPanel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        bounds: [shown(&scene.grid.min), shown(&scene.grid.max)],
        points: run
            .particles
            .position
            .iter()
            .map(|x| shown(x.as_slice()))
            .collect(),
        values: values.collect(),
    }
}

/// Of the components along the grid's axes.
fn mean<const D: usize>(stress: &SMatrix<f64, D, D>) -> f64 {
    stress.trace() / D as f64
}

/// `sqrt(3/2 s:s)` of the deviator within the grid's axes.
fn von_mises<const D: usize>(stress: &SMatrix<f64, D, D>) -> f64 {
    let deviator = stress - SMatrix::identity() * mean(stress);
    (1.5 * deviator.norm_squared()).sqrt()
}
