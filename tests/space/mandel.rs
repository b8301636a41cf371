//! Sources: Mandel (1953); Cheng & Detournay (1988), whose series is summed here.
//! Goal: two phases in the plane against an exact solution in which strain and flow are coupled: a slab between smooth rigid plates is
//! pressed and drains sideways, and the pressure in its middle rises before it falls.
//! Parameters: a quarter of the slab, half a width of 1 m and a height of 0.4 m, E = 50 MPa, nu = 0.2, M = K_w / n = 750 MPa,
//! k such that c_v = 1 m2/s; started from the series at 0.02 s, the plate moved as the series says; the side drained and free.
//! Inertia, which the series leaves out, is (time of a shear wave / time of draining)^2 = 1e-4 of the rest.

use materialpoint::grid::{Face, Side};
use materialpoint::run::simulation_in;
use materialpoint::stepper::{FaceCondition, Forcing, PoreCondition};
use nalgebra::vector;

use super::scene;

const HEIGHT: f64 = 0.4;
const YOUNG: f64 = 5e7;
const POISSON: f64 = 0.2;
const POROSITY: f64 = 0.4;
const LIQUID: f64 = 3e8;
/// Force on the half plate (N/m).
const FORCE: f64 = 1e5;
const START: f64 = 0.02;
/// Terms of the series: the next one is smaller than 1e-13 at the start.
const TERMS: usize = 12;

/// Mandel's series for a half width of 1 m. Pressure is positive in tension, as in the code.
struct Mandel {
    shear: f64,
    /// Poisson's ratios, drained and undrained.
    nu: [f64; 2],
    /// M, and the permeability over the unit weight (m2/(Pa s)).
    storage: f64,
    mobility: f64,
    roots: Vec<f64>,
    /// Twice the pressure (Pa) in the first moment.
    scale: f64,
}

impl Mandel {
    fn new() -> Self {
        let shear = YOUNG / (2.0 * (1.0 + POISSON));
        let lame = 2.0 * shear * POISSON / (1.0 - 2.0 * POISSON);
        let storage = LIQUID / POROSITY;
        let undrained = (lame + storage) / (2.0 * (lame + storage + shear));
        let ratio = (1.0 - POISSON) / (undrained - POISSON);
        Self {
            shear,
            nu: [POISSON, undrained],
            storage,
            // c_v = 1 m2/s.
            mobility: 1.0 / storage + 1.0 / (lame + 2.0 * shear),
            roots: (0..TERMS).map(|i| root(i, ratio)).collect(),
            scale: FORCE * storage / (storage + lame + shear),
        }
    }

    /// Permeability (m/s) for gravity 9.81 m/s2.
    fn permeability(&self) -> f64 {
        self.mobility * 9810.0
    }

    /// `sum f(alpha) exp(-alpha^2 t) / (alpha - sin alpha cos alpha)`, term by term.
    fn terms(&self, t: f64, f: impl Fn(f64) -> f64) -> Vec<f64> {
        let term = |&a: &f64| f(a) * (-a * a * t).exp() / (a - a.sin() * a.cos());
        self.roots.iter().map(term).collect()
    }

    fn sum(&self, t: f64, f: impl Fn(f64) -> f64) -> f64 {
        self.terms(t, f).iter().sum()
    }

    fn pressure(&self, x: f64, t: f64) -> f64 {
        -self.scale * self.sum(t, |a| a.sin() * ((a * x).cos() - a.cos()))
    }

    /// Effective stress along y.
    fn stress(&self, x: f64, t: f64) -> f64 {
        let [nu, undrained] = self.nu;
        let along = (undrained - nu) / (1.0 - nu) * 2.0 * FORCE;
        let total = self.sum(t, |a| {
            2.0 * FORCE * a.sin() * a.cos() - along * a.sin() * (a * x).cos()
        });
        total - FORCE - self.pressure(x, t)
    }

    fn side(&self, t: f64) -> f64 {
        let [nu, undrained] = self.nu;
        let change = self.sum(t, |a| (1.0 - undrained) * a.sin() * a.cos());
        FORCE / self.shear * (nu / 2.0 + change)
    }

    /// Velocity along y over y.
    fn pressing(&self, t: f64) -> f64 {
        let share = FORCE * (1.0 - self.nu[1]) / self.shear;
        -share * self.sum(t, |a| a * a * a.sin() * a.cos())
    }

    /// The state at the start, as keys of a body; velocities half a step before.
    fn state(&self, dt: f64) -> [String; 4] {
        let before = START - dt / 2.0;
        let series = |parts: Vec<f64>, function: &str| {
            let parts = parts.iter().zip(&self.roots);
            let parts: Vec<String> = parts
                .map(|(c, a)| format!("({c:?})*{function}({a:?}*x)"))
                .collect();
            parts.join("+")
        };
        let [nu, undrained] = self.nu;
        let even = self.scale * self.sum(START, |a| a.sin() * a.cos());
        let pressure = format!(
            "{even:?}+{}",
            series(self.terms(START, |a| -self.scale * a.sin()), "cos")
        );
        let along = (undrained - nu) / (1.0 - nu) * 2.0 * FORCE;
        let rest = self.sum(START, |a| 2.0 * FORCE * a.sin() * a.cos()) - FORCE;
        let total = format!(
            "{rest:?}+{}",
            series(self.terms(START, |a| -along * a.sin()), "cos")
        );
        let strain = self.sum(before, |a| undrained * a * a * a.sin() * a.cos()) * FORCE / self.shear;
        let solid = self.terms(before, |a| -FORCE / self.shear * a * a * a.cos());
        let solid = format!("{strain:?}*x+{}", series(solid, "sin"));
        let slip = self.terms(before, |a| self.mobility / POROSITY * self.scale * a * a.sin());
        let up = format!("{:?}*y", self.pressing(before));
        [
            format!("body.0.pore_pressure=\"{pressure}\""),
            format!("body.0.stress={{ xx = \"-({pressure})\", yy = \"{total}-({pressure})\" }}"),
            format!("body.0.velocity=[\"{solid}\", \"{up}\"]"),
            format!(
                "body.0.liquid_velocity=[\"{solid}+{}\", \"{up}\"]",
                series(slip, "sin")
            ),
        ]
    }
}

/// The root of `tan(alpha) / alpha = ratio` between `i pi` and `(i + 1/2) pi`, by halving.
fn root(i: usize, ratio: f64) -> f64 {
    let (mut low, mut high) = (
        std::f64::consts::PI * i as f64 + if i == 0 { 1e-3 } else { 0.0 },
        std::f64::consts::PI * (i as f64 + 0.5),
    );
    for _ in 0..200 {
        let middle = (low + high) / 2.0;
        if middle.tan() < ratio * middle {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

const SCENE: &str = r#"
title = "Mandel's problem"
[grid]
min = [0, 0]
max = [1, 0.4]
cells = [10, 4]
[time]
step = 1e-5
end = 1
[method]
basis = "bspline"
reconstruction = "shepard"
velocity_mass = "lumped"
[material]
phases = 2
strain = "small"
law.linear-elastic = { youngs_modulus = 5e7, poissons_ratio = 0.2 }
porosity = 0.4
solid_density = 2.6e3
liquid_density = 1e3
liquid_bulk_modulus = 3e8
permeability = 1
[[body]]
min = [0, 0]
max = [1, 0.4]
particles_per_cell = [2, 2]
[[boundary]]
face = "x-min"
roller = true
[[boundary]]
face = "y-min"
roller = true
[[boundary]]
face = "y-max"
roller = true
[[boundary]]
face = "x-max"
drained = true
"#;

/// What is found at one time.
#[derive(Clone, Copy, Debug)]
struct Found {
    /// Relative L2 errors of the pressure and of the effective stress along y.
    pressure: f64,
    stress: f64,
    /// Pressure in the middle over that of the first moment, and what it should be.
    middle: [f64; 2],
    /// Motion of the free side since the start over that of the series.
    side: f64,
}

/// Runs with so many cells along x to the times `until` (s).
fn run(cells: usize, basis: &str, reconstruction: &str, until: &[f64]) -> Vec<Found> {
    let exact = Mandel::new();
    let dt = 0.4e-3 / cells as f64;
    let mut set = vec![
        format!("grid.cells=[{cells}, {}]", cells * 2 / 5),
        format!("method.basis={basis:?}"),
        format!("method.reconstruction={reconstruction:?}"),
        format!("material.permeability={:?}", exact.permeability()),
    ];
    set.extend(exact.state(dt));
    let set: Vec<&str> = set.iter().map(String::as_str).collect();
    let mut simulation = simulation_in::<2>(&scene(SCENE, &set)).unwrap();
    let face = |axis, side| Face { axis, side };
    let mut forcing = Forcing::none()
        .with_face(face(0, Side::Min), FaceCondition::roller(0))
        .with_face(face(1, Side::Min), FaceCondition::roller(1))
        .with_pores(face(0, Side::Max), PoreCondition::Pressure(0.0));
    let (mut step, mut found) = (0, Vec::new());
    for &end in until {
        while START + step as f64 * dt < end - dt / 2.0 {
            let time = START + step as f64 * dt;
            let [before, after] = [time - dt / 2.0, time + dt / 2.0].map(|t| exact.pressing(t) * HEIGHT);
            let plate = FaceCondition::Held {
                held: [false, true],
                velocity: vector![0.0, after],
                acceleration: vector![0.0, (after - before) / dt],
            };
            forcing.set_face(face(1, Side::Max), plate);
            simulation.step(dt, &forcing).unwrap();
            step += 1;
        }
        let (particles, liquid) = (simulation.particles(), simulation.liquid());
        let time = START + step as f64 * dt;
        let mut sums = [[0.0; 2]; 2];
        let (mut middle, mut side) = ([0.0; 2], [0.0_f64; 2]);
        for (p, x) in particles.initial_position.iter().enumerate() {
            let expected = [exact.pressure(x[0], time), exact.stress(x[0], time)];
            let values = [liquid[p].pressure, particles.stress[p][(1, 1)]];
            for k in 0..2 {
                sums[k][0] += (values[k] - expected[k]).powi(2);
                sums[k][1] += expected[k].powi(2);
            }
            if x[0] < 0.5 / cells as f64 {
                middle[0] += values[0];
                middle[1] += expected[0];
            }
            if x[0] > 1.0 - 0.5 / cells as f64 {
                side[0] += particles.displacement[p][0];
                side[1] += exact.side(time) - exact.side(START);
            }
        }
        let column = 2.0 * (cells * 2 / 5) as f64;
        found.push(Found {
            pressure: (sums[0][0] / sums[0][1]).sqrt(),
            stress: (sums[1][0] / sums[1][1]).sqrt(),
            middle: middle.map(|p| p / column / (-exact.scale / 2.0)),
            side: side[0] / side[1],
        });
    }
    found
}

#[test]
fn probe() {
    for (basis, reconstruction) in [
        ("bspline", "shepard"),
        ("linear", "shepard"),
        ("dual-domain", "shepard"),
        ("bspline", "taylor"),
        ("linear", "taylor"),
        ("dual-domain", "taylor"),
    ] {
        for cells in [10, 20] {
            let start = std::time::Instant::now();
            let found = run(cells, basis, reconstruction, &[START, 0.05, 0.1, 0.2, 0.5]);
            println!(
                "{basis} {reconstruction} {cells} {:.2} s",
                start.elapsed().as_secs_f64()
            );
            for f in found {
                println!("   {f:?}");
            }
        }
    }
}
