//! Source: Coulomb's law; Bardenhagen, Brackbill & Sulsky (2000). Goal: a frictional wall holds a block up,
//! slows it by mu g while it slides, stops it, and lets go of what moves away. Parameters: a stiff block of
//! 0.4 m x 0.2 m on the floor y = 0 under g = 10 m/s2, started along x at 1 m/s. Expected: while all of it
//! slides the wall's forces are N and mu N, so the mean velocity along is 1 - mu (g t + up), where `up` is
//! the mean velocity up: the block vibrates as its weight comes on, at most with g h / c_p = 0.19 m/s.
//! Stopped, it is left with a vibration in shear of at most mu g h / c_s = 0.19 m/s.

use materialpoint_command::run::{InSpace, Summary, run_in};
use materialpoint_command::scene::Scene;

use super::scene;

const BLOCK: &str = r#"
title = "Sliding block"
[grid]
min = [0, 0]
max = [2, 1]
cells = [40, 20]
[time]
step = "auto"
safety = 0.3
end = 0.1
[method]
basis = "linear"
reconstruction = "shepard"
[material]
strain = "large"
law.neo-hookean = { youngs_modulus = 1e5, poissons_ratio = 0.2 }
density = 1000
[[body]]
min = [0.2, 0]
max = [0.6, 0.2]
particles_per_cell = [2, 2]
velocity = ["1", "0"]
[[boundary]]
face = "y-min"
friction = 0.3
[load]
body_force = ["0", "-10"]
[output]
particles = "none"
"#;

fn mean_velocity(scene: &Scene) -> [f64; 2] {
    let particles = run_in::<2>(scene, None, &mut |_| {}).unwrap().particles;
    let mass: f64 = particles.mass.iter().sum();
    [0, 1].map(|axis| {
        let momenta = particles.velocity.iter().zip(&particles.mass);
        momenta.map(|(v, m)| v[axis] * m).sum::<f64>() / mass
    })
}

#[test]
fn friction_slows_a_block_in_proportion_to_its_weight() {
    for mu in [0.0, 0.3, 0.6] {
        let friction = format!("boundary.0.friction={mu:?}");
        let [along, up] = mean_velocity(&scene(BLOCK, &[&friction]));
        let expected = 1.0 - mu * (1.0 + up);
        assert!(
            (along - expected).abs() < 0.01,
            "mu = {mu}: {along}, expected {expected}"
        );
        assert!(up.abs() < 0.19, "{up}");
    }
}

#[test]
fn a_rough_floor_stops_the_block_for_good() {
    let [along, _] = mean_velocity(&scene(BLOCK, &["boundary.0.friction=0.6", "time.end=0.4"]));
    assert!(along.abs() < 0.19, "{along}");
}

#[test]
fn a_wall_lets_go_of_what_moves_away() {
    let set = [
        "body.0.velocity=[\"0\", \"1\"]",
        "load.body_force=[\"0\", \"0\"]",
        "time.end=0.05",
    ];
    let [along, up] = mean_velocity(&scene(BLOCK, &set));
    assert!(along.abs() < 1e-12 && (up - 1.0).abs() < 1e-9, "{along} {up}");
}

/// The particles at the end and the summary.
fn run<const D: usize>(scene: &Scene) -> (materialpoint::particles::Particles<f64, D>, Summary)
where
    Scene: InSpace<D>,
{
    let outcome = run_in::<D>(scene, None, &mut |_| {}).unwrap();
    let energy = outcome.summary.energy;
    assert!(
        energy
            .wall_gain
            .is_none_or(|gain| gain < 1e-9 * (1.0 + energy.last.abs())),
        "{energy:?}"
    );
    (outcome.particles, outcome.summary)
}

const BASES: [&str; 3] = ["linear", "dual-domain", "bspline"];

/// Water at rest between walls that let go: they are pressed all the time, so they do what rollers do.
#[test]
fn still_water_stays_between_walls_that_let_go() {
    const WATER: &str = r#"
title = "Still water"
grid = { min = [0, 0], max = [0.4, 0.5], cells = [8, 10] }
time = { step = "auto", end = 0.4 }
method = { basis = "bspline", reconstruction = "shepard" }
output = { particles = "none" }
load = { body_force = ["0", "-9.81"] }
[material]
strain = "large"
law.newtonian-fluid = { bulk_modulus = 1e6, gamma = 7.0, viscosity = 1e-3 }
density = 1000
[[body]]
min = [0, 0]
max = [0.4, 0.3]
particles_per_cell = [2, 2]
stress = { xx = "-1000*9.81*(0.3-y)", yy = "-1000*9.81*(0.3-y)" }
[[boundary]]
face = "x-min"
friction = 0
[[boundary]]
face = "x-max"
friction = 0
[[boundary]]
face = "y-min"
friction = 0
"#;
    for basis in BASES {
        let (particles, summary) = run::<2>(&scene(WATER, &[&format!("method.basis={basis}")]));
        let highest = summary.energy.highest_ratio.unwrap();
        assert!(highest < 1.05, "{basis}: {highest}");
        let pressures = particles.stress.iter().zip(&particles.initial_position);
        let squares = pressures.map(|(stress, x)| {
            let exact = -1000.0 * 9.81 * (0.3 - x[1]);
            ((stress[(0, 0)] + stress[(1, 1)]) / 2.0 - exact).powi(2)
        });
        let rms = (squares.sum::<f64>() / particles.len() as f64).sqrt() / (1000.0 * 9.81 * 0.3);
        assert!(rms < 0.03, "{basis}: {rms}");
        for u in &particles.displacement {
            // Quadrature of splines lets it settle by a part of a percent of its depth and its stiffness.
            assert!(u.norm() < 1e-4, "{basis}: {u}");
        }
    }
}

/// Two walls meet at a corner: no load, so nothing gives energy, and the splash is symmetric about the
/// diagonal.
#[test]
fn water_thrown_into_a_corner_gains_nothing() {
    const SPLASH: &str = r#"
title = "Corner"
grid = { min = [0, 0], max = [0.4, 0.4], cells = [20, 20] }
time = { step = "auto", end = 0.1 }
method = { basis = "bspline", reconstruction = "shepard" }
output = { particles = "none" }
[material]
strain = "large"
law.newtonian-fluid = { bulk_modulus = 2e5, gamma = 7.0, viscosity = 1e-3 }
density = 1000
[[body]]
min = [0, 0]
max = [0.2, 0.2]
particles_per_cell = [2, 2]
velocity = ["-1", "-1"]
[[boundary]]
face = "x-min"
friction = 0
[[boundary]]
face = "x-max"
friction = 0
[[boundary]]
face = "y-min"
friction = 0
[[boundary]]
face = "y-max"
friction = 0
"#;
    for basis in BASES {
        for friction in ["0", "0.4"] {
            let walls = format!("boundary.2.friction={friction}");
            let (particles, summary) = run::<2>(&scene(SPLASH, &[&format!("method.basis={basis}"), &walls]));
            let highest = summary.energy.highest_ratio.unwrap();
            assert!(highest < 1.015, "{basis}, {friction}: {highest}");
            if friction == "0" {
                let [a, b] = [0, 1].map(|axis| particles.position.iter().map(|x| x[axis]).sum::<f64>());
                assert!((a - b).abs() < 1e-6 * a, "{basis}: {a} {b}");
            }
        }
    }
}

/// A bar that hits a smooth wall leaves it with its speed after 2 L / c, and its energy never rises.
#[test]
fn an_elastic_bar_bounces() {
    const BAR: &str = r#"
title = "Bar on a floor"
grid = { min = [0, 0], max = [0.1, 1], cells = [4, 40] }
time = { step = "auto", end = 0.2 }
method = { basis = "linear", reconstruction = "shepard" }
output = { particles = "none" }
[material]
strain = "large"
law.neo-hookean = { youngs_modulus = 2e5, poissons_ratio = 0 }
density = 1000
[[body]]
min = [0, 0.1]
max = [0.1, 0.5]
particles_per_cell = [2, 2]
velocity = ["0", "-1"]
[[boundary]]
face = "x-min"
roller = true
[[boundary]]
face = "x-max"
roller = true
[[boundary]]
face = "y-min"
friction = 0
"#;
    for basis in BASES {
        let (particles, summary) = run::<2>(&scene(BAR, &[&format!("method.basis={basis}")]));
        let highest = summary.energy.highest_ratio.unwrap();
        assert!(highest < 1.01, "{basis}: {highest}");
        let up = particles.velocity.iter().map(|v| v[1]).sum::<f64>() / particles.len() as f64;
        assert!((0.9..1.01).contains(&up), "{basis}: {up}");
    }
}

/// In equilibrium with what presses, the part of gravity along the slope comes on within 0.2 s: the block
/// slides with g_x - mu g_y, or slips a little and rests.
#[test]
fn a_block_slides_down_a_slope_as_a_rigid_one_does() {
    const SLOPE: &str = r#"
title = "Block on a slope"
grid = { min = [0, 0], max = [4, 1], cells = [40, 10] }
time = { step = "auto", end = 1.2 }
method = { basis = "linear", reconstruction = "shepard" }
output = { particles = "none" }
load = { body_force = ["4.905*min(t/0.2,1)", "-8.4957"] }
[material]
strain = "large"
law.neo-hookean = { youngs_modulus = 1e6, poissons_ratio = 0 }
density = 2000
[[body]]
min = [0.4, 0]
max = [1, 0.4]
particles_per_cell = [2, 2]
stress = { yy = "-2000*8.4957*(0.4-y)" }
[[boundary]]
face = "y-min"
friction = 0.3
"#;
    for basis in BASES {
        for (mu, v, u) in [(0.3, 2.4695, 1.2950), (0.5, 0.6659, 0.3375), (0.7, 0.0, 0.0)] {
            let set = [
                format!("method.basis={basis}"),
                format!("boundary.0.friction={mu:?}"),
            ];
            let (particles, _) = run::<2>(&scene(SLOPE, &[&set[0], &set[1]]));
            let n = particles.len() as f64;
            let along = particles.velocity.iter().map(|v| v[0]).sum::<f64>() / n;
            let way = particles.displacement.iter().map(|u| u[0]).sum::<f64>() / n;
            let up = particles.displacement.iter().map(|u| u[1]).sum::<f64>() / n;
            assert!((along - v).abs() < 0.02 * 4.905 * 1.2, "{basis}, {mu}: {along}");
            assert!((way - u).abs() < 0.02 * 4.905 * 0.72, "{basis}, {mu}: {way}");
            assert!(up.abs() < 1e-3, "{basis}, {mu}: {up}");
        }
    }
}

/// At rest on a floor that rubs a block has the energy that it has on one that is fixed, in the plane and in
/// space.
#[test]
fn a_block_at_rest_has_the_energy_of_one_that_is_held() {
    const REST: &str = r#"
title = "Block at rest"
grid = { min = [0, 0], max = [2, 1], cells = [20, 10] }
time = { step = "auto", end = 1.0 }
method = { basis = "bspline", reconstruction = "shepard" }
output = { particles = "none" }
load = { body_force = ["0", "-9.81*min(t/0.2,1)"] }
[material]
strain = "small"
law.linear-elastic = { youngs_modulus = 1e7, poissons_ratio = 0 }
density = 2000
[[body]]
min = [0.5, 0]
max = [1.5, 0.5]
particles_per_cell = [2, 2]
[[boundary]]
face = "y-min"
friction = 0.3
"#;
    // rho^2 g^2 h^3 L / (6 E) at rest, and no more than a tenth of it that still swings.
    let rest = (2000.0_f64 * 9.81).powi(2) * 0.125 / 6e7;
    for basis in BASES {
        let (_, summary) = run::<2>(&scene(REST, &[&format!("method.basis={basis}")]));
        let last = summary.energy.last;
        assert!((0.85..1.15).contains(&(last / rest)), "{basis}: {last}, {rest}");
    }
    let set = [
        "grid={min=[0,0,0], max=[1.5,1.5,1], cells=[15,15,10]}",
        "body.0={min=[0.25,0.25,0], max=[1.25,1.25,0.5], particles_per_cell=[2,2,2]}",
        "boundary.0={face='z-min', friction=0.3}",
        "load.body_force=['0','0','-9.81*min(t/0.2,1)']",
        "time.end=0.4",
    ];
    let (_, summary) = run::<3>(&scene(REST, &set));
    let last = summary.energy.last;
    assert!((0.85..1.15).contains(&(last / rest)), "space: {last}, {rest}");
}

/// A cube thrown at a floor in space. While it slides, friction takes `mu` of what the floor gives upwards,
/// and it still slides when it lets go: 0.3 * 1.7 < 0.71. With two B-splines' particles a cell the floor's
/// operator is next to singular.
#[test]
fn a_cube_in_space_is_slowed_in_proportion_to_its_impact() {
    const CUBE: &str = r#"
title = "Cube thrown at a floor"
grid = { min = [0, 0, 0], max = [1.5, 1.5, 1], cells = [12, 12, 8] }
time = { step = "auto", end = 0.25 }
method = { basis = "bspline", reconstruction = "shepard" }
output = { particles = "none" }
[material]
strain = "large"
law.neo-hookean = { youngs_modulus = 1e6, poissons_ratio = 0 }
density = 2000
[[body]]
min = [0.5, 0.5, 0.125]
max = [1, 1, 0.625]
particles_per_cell = [2, 2, 2]
velocity = ["0.5", "0.5", "-1"]
[[boundary]]
face = "z-min"
friction = 0.3
"#;
    for basis in BASES {
        let basis = format!("method.basis=\"{basis}\"");
        let (particles, summary) = run::<3>(&scene(CUBE, &[&basis]));
        let mass: f64 = particles.mass.iter().sum();
        let momenta = particles.velocity.iter().zip(&particles.mass);
        let v = momenta.map(|(v, m)| v * *m).sum::<nalgebra::SVector<f64, 3>>() / mass;
        assert!(summary.warnings.is_empty(), "{basis}: {:?}", summary.warnings);
        assert!((v[0] - v[1]).abs() < 1e-9, "{basis}: {v}");
        assert!(v[2] > 0.6 && v[2] < 0.9, "{basis}: {v}");
        let expected = 0.5_f64.hypot(0.5) - 0.3 * (1.0 + v[2]);
        let along = v[0].hypot(v[1]);
        // A corner that sticks for a moment takes less than mu of what presses there, and none takes more.
        assert!(
            (-1e-6..0.03).contains(&(along - expected)),
            "{basis}: {along}, expected {expected}"
        );
    }
}

/// A face stays where it is, so a wall that rubs cannot push.
#[test]
fn a_wall_that_rubs_does_not_run_across_itself() {
    let across = "boundary.0.velocity=[\"0\", \"0.2\"]".to_owned();
    let message = Scene::from_toml(BLOCK, &[across]).unwrap_err().to_string();
    assert!(
        message.contains("boundary.0.velocity") && message.contains("runs along itself"),
        "{message}"
    );
    let steady = scene(
        BLOCK,
        &["boundary.0.velocity=[\"0.5\", \"0 * 3\"]", "time.end=1e-2"],
    );
    assert!(run_in::<2>(&steady, None, &mut |_| {}).is_ok());
}
