//! Which time steps are stable where a bar lies anyhow in the grid: maps of step and offset, for
//! `docs/verification/stability.md`.
//!
//! `cargo run --release --example stability_map` draws them anew, in some minutes:
//! `docs/pictures/stability-*.svg`.
//!
//! The bar of `tests/hard_cases/critical_step.rs`: linear elastic, small strain, eight cells long with free
//! ends, so that its end cells are filled as its offset against the grid says. Particles start with
//! velocities of 1e-9 of the wave's speed without any pattern.

use std::error::Error;
use std::path::Path;

use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::stepper::Forcing;
use materialpoint_command::output::{Folder, Line, LineAxis, LineCaptions, LinePanel, draw_lines};
use materialpoint_command::run::{critical_step, simulation};
use materialpoint_command::scene::Scene;

/// How often the energy may be the initial one before a run counts as growing.
pub const GROWTH: f64 = 1e4;

/// Cells of 1 m, waves of 1 m/s: a step is a share of the time in which a wave crosses a cell.
const BAR: &str = r#"
title = "A free bar"
[grid]
min = [0]
max = [11]
cells = [11]
[time]
step = 1
end = 1
[method]
basis = "linear"
reconstruction = "shepard"
[material]
strain = "small"
law.linear-elastic = { youngs_modulus = 1 }
density = 1
[[body]]
min = [1]
max = [9]
particles_per_cell = [2]
velocity = ["1e-9*sin(1e5*x^2)"]
"#;

/// The bar, shifted by `offset` cells.
pub fn bar(method: Method, per_cell: usize, offset: f64) -> Result<Scene, Box<dyn Error>> {
    let set = [
        format!("body.0.min=[{:?}]", 1.0 + offset),
        format!("body.0.max=[{:?}]", 9.0 + offset),
        format!("body.0.particles_per_cell=[{per_cell}]"),
    ];
    Ok(Scene::from_toml(BAR, &set)?.with_method(method))
}

/// One of `n` offsets; no particle of it lies on a cell edge, where linear functions have two slopes.
pub fn offset(k: usize, n: usize) -> f64 {
    (k as f64 + 0.31) / n as f64
}

/// How finely is looked, and for how long.
#[derive(Clone, Copy, Debug)]
pub struct Care {
    /// Number of offsets in a cell.
    pub offsets: usize,
    /// Number of steps (sizes) up to [`LARGEST`].
    pub sizes: usize,
    /// Steps of a run.
    pub steps: usize,
}

/// Largest step that is tried, c dt / h.
pub const LARGEST: f64 = 2.4;

fn grows(scene: &Scene, step: f64, steps: usize) -> Result<bool, Box<dyn Error>> {
    let mut simulation = simulation(scene)?;
    let (free, start) = (Forcing::none(), simulation.energy().total());
    for n in 1..=steps {
        if simulation.step(step, &free).is_err() {
            return Ok(true);
        }
        // Not a number counts as growing.
        if n % 10 == 0 && exceeds(simulation.energy().total(), GROWTH * start) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Of one method and number of particles per cell: which steps grow at which offset, and what was predicted.
#[derive(Clone, Debug, Default)]
pub struct Map {
    /// Offset (cells), step (c dt / h), and whether it grows.
    pub runs: Vec<(f64, f64, bool)>,
    /// Offset and predicted largest stable step.
    pub predicted: Vec<(f64, f64)>,
}

impl Map {
    /// Makes the map.
    pub fn of(method: Method, per_cell: usize, care: Care) -> Result<Self, Box<dyn Error>> {
        let mut map = Self::default();
        for k in 0..care.offsets {
            let offset = offset(k, care.offsets);
            let scene = bar(method, per_cell, offset)?;
            let critical = critical_step(&scene)?.ok_or("nothing resists")?;
            map.predicted.push((offset, critical.step));
            for i in 0..care.sizes {
                let step = (i as f64 + 0.5) / care.sizes as f64 * LARGEST;
                map.runs.push((offset, step, grows(&scene, step, care.steps)?));
            }
        }
        Ok(map)
    }

    /// How many runs below `share` of the predicted step grow, and how many there are.
    pub fn early(&self, share: f64) -> (usize, usize) {
        let below = |&&(offset, step, _): &&(f64, f64, bool)| {
            let predicted = self.predicted.iter().find(|(at, _)| *at == offset);
            predicted.is_some_and(|(_, limit)| step < share * limit)
        };
        let below: Vec<_> = self.runs.iter().filter(below).collect();
        (below.iter().filter(|(.., grows)| *grows).count(), below.len())
    }

    /// Rectangles of what grows, neighbouring steps in one.
    fn shaded(&self, care: Care) -> Vec<[f64; 4]> {
        let (width, height) = (1.0 / care.offsets as f64, LARGEST / care.sizes as f64);
        let mut areas: Vec<[f64; 4]> = Vec::new();
        for &(offset, step, _) in self.runs.iter().filter(|(.., grows)| *grows) {
            let left = offset - 0.31 * width;
            let (low, high) = (step - 0.5 * height, step + 0.5 * height);
            match areas.last_mut() {
                Some(area) if area[0] == left && (area[3] - low).abs() < 1e-9 => area[3] = high,
                _ => areas.push([left, left + width, low, high]),
            }
        }
        areas
    }
}

/// Numbers of particles per cell that are mapped.
pub const PER_CELL: [usize; 3] = [2, 4, 8];

/// The picture of a basis, and for every method and number of particles how much grows below 0.95 of the
/// prediction.
pub fn picture(basis: Basis, care: Care) -> Result<(String, Vec<String>), Box<dyn Error>> {
    use ReconstructionKind::{RelaxedTaylor, Shepard, Taylor};
    let (mut panels, mut counts) = (Vec::new(), Vec::new());
    for kind in [Shepard, Taylor, RelaxedTaylor] {
        for per_cell in PER_CELL {
            let method = Method::new(basis, kind);
            let map = Map::of(method, per_cell, care)?;
            let (early, below) = map.early(0.95);
            counts.push(format!("{method}, {per_cell} per cell: {early} of {below} grow"));
            panels.push(LinePanel {
                name: format!("{}, {per_cell} per cell", method.literature_name()),
                lines: vec![Line {
                    label: "predicted largest stable step".into(),
                    points: map.predicted.clone(),
                    ..Line::default()
                }],
                reference: Vec::new(),
                shaded: map.shaded(care),
            });
        }
    }
    let captions = LineCaptions {
        title: "Stability: steps and places of a bar in the grid",
        x: "offset against the grid [cells]",
        y: "time step c dt / h [-]",
        reference: "",
        stopped: "",
        shaded: "energy grows 1e4 times",
    };
    let axis = LineAxis {
        range: (0.0, LARGEST),
        log: false,
    };
    Ok((draw_lines(&captions, axis, &panels, PER_CELL.len()), counts))
}

// The tests include this file as a module and call `Map::of` themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    let pictures = Folder::create(Path::new("docs/pictures"))?;
    let care = Care {
        offsets: 32,
        sizes: 48,
        steps: 2000,
    };
    for basis in [Basis::Linear, Basis::DualDomain, Basis::BSpline { degree: 2 }] {
        let (picture, counts) = picture(basis, care)?;
        pictures.write(&format!("stability-{}.svg", basis.name()), &picture)?;
        counts.iter().for_each(|line| println!("{line}"));
    }
    Ok(())
}

/// Also of an energy that is no number.
fn exceeds(energy: f64, bound: f64) -> bool {
    energy.is_nan() || energy > bound
}
