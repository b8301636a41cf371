//! Which method buys the least error for the most speed: studies of the benchmarks, written into
//! `docs/verification/speed-and-error.md`.
//!
//! `cargo run --release --example speed_and_error` measures all anew: the pictures in `docs/pictures/` and
//! what stands between the markers of the page. The prose around them is not touched.

use std::error::Error;
use std::fs;
use std::path::Path;

use materialpoint::method::Method;
use materialpoint_command::output::{Folder, fill_in};
use materialpoint_command::scene::Scene;
use materialpoint_command::study::{Plan, front_in_markdown, picture, study};

/// A compiled-in scene, the numbers of cells, and the stress errors that a user may ask for.
pub struct Case {
    /// Name of the scene.
    pub scene: &'static str,
    /// Numbers of cells, ascending.
    pub cells: &'static [usize],
    /// Relative errors; 0.01 is 1 %.
    pub limits: &'static [f64],
}

/// The page's, in its order.
pub const CASES: [Case; 5] = [
    Case {
        scene: "vibrating-bar-small",
        cells: &[5, 10, 20, 40],
        limits: &[0.05, 0.01, 0.001],
    },
    Case {
        scene: "vibrating-bar-period",
        cells: &[10, 20, 40, 80],
        limits: &[0.05, 0.01],
    },
    Case {
        scene: "vibrating-bar-large",
        cells: &[10, 20, 40, 80],
        limits: &[0.05, 0.01, 0.001],
    },
    Case {
        scene: "column-compaction",
        cells: &[25, 50, 100],
        limits: &[0.05, 0.01, 0.001],
    },
    Case {
        scene: "consolidation",
        cells: &[10, 20, 40],
        limits: &[0.05, 0.01, 0.001],
    },
];

/// How carefully is timed, see [`Plan`].
#[derive(Clone, Copy)]
pub struct Care {
    /// How often each run is timed at least.
    pub repeat: usize,
    /// Until its times sum to this (s).
    pub least_seconds: f64,
}

/// Studies one case with all methods; its picture goes to `pictures`, its table into the `page`.
pub fn report(page: &str, case: &Case, care: Care, pictures: &Folder) -> Result<String, Box<dyn Error>> {
    let text = Scene::builtin(case.scene).ok_or("no such scene")?;
    let scene = Scene::from_toml(text, &[])?;
    let plan = Plan {
        methods: Method::all_in(scene.dimension(), scene.material.phases.count()),
        cells: case.cells.to_vec(),
        repeat: care.repeat,
        least_seconds: care.least_seconds,
    };
    let done = study(&scene, &plan, &mut |_, _, what| {
        eprintln!("{}: {what}", case.scene);
    })?;
    let name = format!("speed-{}.svg", case.scene);
    pictures.write(&name, &picture(&done, &scene.title))?;
    let cells: Vec<String> = case.cells.iter().map(usize::to_string).collect();
    let text = format!(
        "![{}: error against time](../pictures/{name})\n\n\
         `materialpoint study {} --cells {}`; the front:\n\n{}",
        scene.title,
        case.scene,
        cells.join(","),
        front_in_markdown(&done, case.limits)
    );
    Ok(fill_in(page, case.scene, &text)?)
}

// The tests include this file as a module and call `report` themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    let path = Path::new("docs/verification/speed-and-error.md");
    let pictures = Folder::create(Path::new("docs/pictures"))?;
    let care = Care {
        repeat: 5,
        least_seconds: 0.5,
    };
    for case in &CASES {
        let page = report(&fs::read_to_string(path)?, case, care, &pictures)?;
        fs::write(path, page)?;
    }
    Ok(())
}
