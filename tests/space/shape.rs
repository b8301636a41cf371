//! Goal: what shape cells and particles have, which way axes run and in which order particles are given does
//! not matter. Source: a field that does not vary across cannot know how wide a cell is; the balance of
//! momentum knows no axis but gravity's. Parameters: soil at rest under its weight between smooth walls, on
//! cells 1:8 to 8:1 with unequal numbers of particles along the axes; a block that turns, swells and leaves a
//! corner of two smooth walls, its mirror image, and the same with axes exchanged. Expected: stresses that
//! balance the weight leave the soil at rest; images are images of each other, to the digits of the solver.

use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{Moduli, NeoHookean};
use materialpoint::mass::VelocityMass;
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::particles::{Particles, lattice};
use materialpoint::stepper::{FaceCondition, Forcing};
use materialpoint_command::run::run_in;
use nalgebra::{SMatrix, SVector, vector};

use super::scene;
use crate::compiled::{self, parts};

const METHODS: [[&str; 2]; 9] = [
    ["linear", "shepard"],
    ["linear", "taylor"],
    ["linear", "relaxed-taylor"],
    ["dual-domain", "shepard"],
    ["dual-domain", "taylor"],
    ["dual-domain", "relaxed-taylor"],
    ["bspline", "shepard"],
    ["bspline", "taylor"],
    ["bspline", "relaxed-taylor"],
];

const SOIL: &str = r#"
title = "Soil at rest"
[grid]
min = [0, 0]
max = [1, 6]
cells = [2, 12]
[time]
step = 1e-4
end = 1e-4
[method]
basis = "linear"
reconstruction = "shepard"
[material]
strain = "small"
law.linear-elastic = { youngs_modulus = 1e7, poissons_ratio = 0.3 }
density = 1800
[[body]]
min = [0, 0]
max = [1, 5]
particles_per_cell = [2, 2]
stress = { xx = "-10*1800*(5-y)*3/7", yy = "-10*1800*(5-y)" }
[[boundary]]
face = "x-min"
roller = true
[[boundary]]
face = "x-max"
roller = true
[[boundary]]
face = "y-min"
roller = true
[load]
body_force = ["0", "-10"]
[output]
particles = "none"
"#;

fn run(text: &str, [basis, reconstruction]: [&str; 2], set: &[String]) -> Particles<f64, 2> {
    let method = [
        format!("method.basis=\"{basis}\""),
        format!("method.reconstruction=\"{reconstruction}\""),
    ];
    let set: Vec<_> = method.iter().chain(set).map(String::as_str).collect();
    run_in::<2>(&scene(text, &set), None, &mut |_| {})
        .unwrap()
        .particles
}

/// Acceleration in units of gravity, root mean square. Nothing where both force and masses are exact: fits
/// hold a stress with a slope, particle sums and masses of linear functions are midpoint sums of lines.
/// B-splines have masses that are midpoint sums of parabolas, dual domain with particle sums a force of
/// smoothed slopes: up to 0.18, with one cell across. Cells that were cut where particles taken for cubes
/// seemed to end gave 0.25 with linear functions and 0.33 to 0.76 with B-splines.
#[test]
fn soil_at_rest_stays_there_whatever_the_shape_of_cells_and_particles() {
    let shapes = [
        (4.0, 1),
        (2.0, 1),
        (1.0, 1),
        (1.0, 2),
        (1.0, 4),
        (1.0, 8),
        (1.0, 16),
    ];
    let layouts = [[2, 2], [2, 4], [4, 2], [2, 8], [3, 3], [8, 3]];
    for method in METHODS {
        let exact = match method {
            ["linear", _] | ["dual-domain", "taylor" | "relaxed-taylor"] => 1e-6,
            _ => 0.2,
        };
        for (width, across) in shapes {
            for per_cell in layouts {
                let set = [
                    format!("grid.max=[{width:?}, 6]"),
                    format!("grid.cells=[{across}, 12]"),
                    format!("body.0.max=[{width:?}, 5]"),
                    format!("body.0.particles_per_cell={per_cell:?}"),
                ];
                let found = run(SOIL, method, &set);
                let squares: f64 = found.velocity.iter().map(|v| v.norm_squared()).sum();
                let share = (squares / found.len() as f64).sqrt() / (10.0 * 1e-4);
                assert!(
                    share < exact,
                    "{method:?}, {width} in {across}, {per_cell:?}: {share:e}"
                );
            }
        }
    }
}

/// A thing in a corner, one of whose images is the other's: by a mirror or by another order of the axes.
const CORNER: &str = r#"
title = "In a corner"
[grid]
min = [0, 0]
max = [1, 0.75]
cells = [16, 12]
[time]
step = 2e-4
end = 4e-3
[method]
basis = "linear"
reconstruction = "shepard"
[material]
strain = "large"
law.neo-hookean = { youngs_modulus = 1e5, poissons_ratio = 0.3 }
density = 1000
[[body]]
min = [0, 0]
max = [0.5, 0.3125]
particles_per_cell = [3, 3]
velocity = ["1+2*y", "-2*x"]
[[boundary]]
face = "x-min"
roller = true
[[boundary]]
face = "y-min"
roller = true
[load]
body_force = ["1", "-9"]
[output]
particles = "none"
"#;

const MIRRORED: [&str; 6] = [
    "grid.min=[-1, 0]",
    "grid.max=[0, 0.75]",
    "body=[{min=[-0.5, 0], max=[0, 0.3125], particles_per_cell=[3, 3], velocity=[\"-1-2*y\", \"2*x\"]}]",
    "boundary.0.face=\"x-max\"",
    "load.body_force=[\"-1\", \"-9\"]",
    "title=\"Mirrored\"",
];

const EXCHANGED: [&str; 6] = [
    "grid.max=[0.75, 1]",
    "grid.cells=[12, 16]",
    "body=[{min=[0, 0], max=[0.3125, 0.5], particles_per_cell=[3, 3], velocity=[\"-2*y\", \"1+2*x\"]}]",
    "load.body_force=[\"-9\", \"1\"]",
    "grid.min=[0, 0]",
    "title=\"Exchanged\"",
];

/// Initial position, displacement and stress xx, yy, xy, sorted by the first.
fn told(found: &Particles<f64, 2>, image: impl Fn([f64; 2]) -> [f64; 2], exchanged: bool) -> Vec<[f64; 7]> {
    let mut rows: Vec<_> = (0..found.len())
        .map(|p| {
            let (x, u, s) = (
                &found.initial_position[p],
                &found.displacement[p],
                &found.stress[p],
            );
            let ([x0, x1], [u0, u1]) = (image([x[0], x[1]]), image([u[0], u[1]]));
            let (a, b) = if exchanged { (1, 0) } else { (0, 1) };
            [x0, x1, u0, u1, s[(a, a)], s[(b, b)], s[(0, 1)].abs()]
        })
        .collect();
    rows.sort_by_key(|row| ((row[0] * 1e6).round() as i64, (row[1] * 1e6).round() as i64));
    rows
}

#[test]
fn images_are_images_of_each_other() {
    let set = |set: &[&str]| set.iter().map(ToString::to_string).collect::<Vec<_>>();
    for method in METHODS {
        let plain = told(&run(CORNER, method, &[]), |x| x, false);
        let mirrored = told(&run(CORNER, method, &set(&MIRRORED)), |[x, y]| [-x, y], false);
        let exchanged = told(&run(CORNER, method, &set(&EXCHANGED)), |[x, y]| [y, x], true);
        let largest = plain
            .iter()
            .flat_map(|row| &row[4..])
            .fold(0.0_f64, |m, s| m.max(s.abs()));
        for (name, image) in [("mirrored", mirrored), ("exchanged", exchanged)] {
            assert_eq!(image.len(), plain.len());
            for (a, b) in plain.iter().zip(&image) {
                let apart = |columns: std::ops::Range<usize>| {
                    columns.map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max)
                };
                let alike = apart(0..2) < 1e-9 && apart(2..4) < 1e-7 * 0.5 && apart(4..7) < 1e-6 * largest;
                assert!(alike, "{method:?}, {name}: {a:?}, {b:?}");
            }
        }
    }
}

/// Positions and stresses after some steps of a block in a corner, whose particles are given in the order
/// `numbers` of their lattice, in that of the lattice.
fn stepped(basis: Basis, numbers: &[usize]) -> Vec<(SVector<f64, 2>, SMatrix<f64, 2, 2>)> {
    let grid = Grid::new(vector![0.0, 0.0], vector![1.0, 1.5], [8, 6]).unwrap();
    let lattice = lattice(&grid, &vector![0.0, 0.0], &vector![0.5, 0.7], [3, 4]);
    let points: Vec<_> = numbers.iter().map(|&k| lattice[k]).collect();
    let mut particles = Particles::at_rest(&points, 1000.0);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        *v = vector![1.0 + 2.0 * x[1], -2.0 * x[0]];
    }
    let moduli = Moduli::from_young(1e5, 0.3).unwrap();
    let method = Method::new(basis, ReconstructionKind::RelaxedTaylor);
    let parts = parts(grid, NeoHookean { moduli }, particles);
    let mut stepper = compiled::simulation(method, VelocityMass::Constrained, parts);
    let wall = |axis| {
        (
            Face {
                axis,
                side: Side::Min,
            },
            FaceCondition::roller(axis),
        )
    };
    let (left, floor) = (wall(0), wall(1));
    let forcing = Forcing::none()
        .with_face(left.0, left.1)
        .with_face(floor.0, floor.1);
    (0..20).for_each(|_| stepper.step(5e-4, &forcing).unwrap());
    let found = stepper.particles();
    let mut rows = vec![(SVector::zeros(), SMatrix::zeros()); numbers.len()];
    for (p, &k) in numbers.iter().enumerate() {
        rows[k] = (found.position[p], found.stress[p]);
    }
    rows
}

fn order_does_not_matter(basis: Basis) {
    // 4 cells of 3 and 2.8 cells of 4.
    let count = 12 * 11;
    let plain: Vec<_> = (0..count).collect();
    // 97 has no divisor in common with the number of particles.
    let shuffled: Vec<_> = (0..count).map(|k| k * 97 % count).collect();
    let (plain, shuffled) = (stepped(basis, &plain), stepped(basis, &shuffled));
    let largest = plain.iter().fold(0.0_f64, |m, row| m.max(row.1.amax()));
    for (a, b) in plain.iter().zip(&shuffled) {
        let alike = (a.0 - b.0).amax() < 1e-10 && (a.1 - b.1).amax() < 1e-8 * largest;
        assert!(alike, "{a:?}, {b:?}");
    }
}

#[test]
fn the_order_of_the_particles_does_not_matter() {
    order_does_not_matter(Basis::Linear);
    order_does_not_matter(Basis::BSpline { degree: 2 });
}
