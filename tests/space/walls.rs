//! Source: Coulomb's law; Bardenhagen, Brackbill & Sulsky (2000).
//! Goal: a frictional wall holds a block up, slows it by mu g while it slides, stops it, and lets go of what moves away.
//! Parameters: a stiff block of 0.4 m x 0.2 m on the floor y = 0 under g = 10 m/s2, started along x at 1 m/s.
//! Expected: while all of it slides the wall's forces are N and mu N, so the mean velocity along is 1 - mu (g t + up), where `up` is the mean
//! velocity up: the block vibrates as its weight comes on, at most with g h / c_p = 0.19 m/s. Stopped, it is left with a vibration
//! in shear of at most mu g h / c_s = 0.19 m/s.

use materialpoint::run::run_in;
use materialpoint::scene::Scene;

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
