//! Laws that remember, with two phases, as scenes.
//!
//! Source: equilibrium of a column; the undrained limit, in which a saturated solid is one of one phase whose
//! bulk modulus is larger by `K_w / n`. Goal: a law sees the solid's strain and its effective stress alone,
//! whatever it remembers. Parameters: columns of 2 m between smooth walls under gravity that comes within
//! 0.4 s, with von Mises (yields at 6 kPa) and Drucker-Prager (30 degrees); a block under a load on a part of
//! its top. Expected: drained, the stress of the dry column of the same buoyant weight within 2 % of the
//! largest, and of von Mises `s_xx = s_yy + Y` within half a per cent where it yields; undrained,
//! displacement and total stress of the one phase within 0.1 % of the largest, and its volumes. That the
//! plane does what the line does is in `dimensions.rs`.

use materialpoint_command::run::{Outcome, run_in};
use materialpoint_command::scene::Scene;

fn scene(text: &str) -> Scene {
    Scene::from_toml(text, &[]).unwrap_or_else(|error| panic!("{error}: {text}"))
}

const VON_MISES: &str = "von-mises = { youngs_modulus = 1e7, poissons_ratio = 0.2, yield_stress = 6e3 }";
const SAND: &str = "drucker-prager = { youngs_modulus = 1e7, poissons_ratio = 0.2, friction_angle = 30.0 }";

/// A column 2 m high under gravity that comes within 0.4 s.
fn column(basis: &str, law: &str, material: &str, gravity: f64, top: &str) -> Scene {
    scene(&format!(
        r#"
title = "Column"
[grid]
min = [0, 0]
max = [0.4, 2.2]
cells = [2, 11]
[time]
step = "auto"
safety = 0.6
end = 1.2
[method]
basis = "{basis}"
reconstruction = "shepard"
[material]
strain = "large"
{material}
law.{law}
[[body]]
min = [0, 0]
max = [0.4, 2]
particles_per_cell = [2, 2]
[load]
body_force = ["0", "-{gravity:?}*sin(pi/2*min(t/0.4, 1))^2"]
[[boundary]]
face = "x-min"
roller = true
[[boundary]]
face = "x-max"
roller = true
[[boundary]]
face = "y-min"
roller = true
{top}
"#
    ))
}

/// Density of the whole is 1990 kg/m3, under water 990.
const SATURATED: &str = "phases = 2\nporosity = 0.4\nsolid_density = 2.65e3\nliquid_density = 1e3\n\
                         liquid_bulk_modulus = 2e7\npermeability = 0.05";
const DRAINED: &str = "[[boundary]]\nface = \"y-max\"\ndrained = true";

/// Vertical and lateral stress of the particles, by their height at the start.
fn stresses(outcome: &Outcome<2>) -> Vec<(f64, [f64; 2])> {
    let particles = &outcome.particles;
    let all = particles.initial_position.iter().zip(&particles.stress);
    all.map(|(x, stress)| (x[1], [stress[(1, 1)], stress[(0, 0)]]))
        .collect()
}

#[test]
fn drained_the_grains_bear_the_buoyant_weight_as_a_dry_column_bears_its_own() {
    for basis in ["linear", "dual-domain", "bspline"] {
        for law in [VON_MISES, SAND] {
            let wet = run_in::<2>(&column(basis, law, SATURATED, 9.81, DRAINED), None, &mut |_| {}).unwrap();
            let dry = column(basis, law, "density = 1990.0", 9.81 * 990.0 / 1990.0, "");
            let dry = run_in::<2>(&dry, None, &mut |_| {}).unwrap();
            let largest = 990.0 * 9.81 * 2.0;
            let (mut worst, mut exact, mut flow, mut yields) = (0.0_f64, 0.0_f64, 0.0_f64, 0);
            for ((y, wet), (_, dry)) in stresses(&wet).into_iter().zip(stresses(&dry)) {
                let expected = -990.0 * 9.81 * (2.0 - y);
                exact = exact.max((wet[0] - expected).abs() / largest);
                for k in 0..2 {
                    worst = worst.max((wet[k] - dry[k]).abs() / largest);
                }
                // Elastic columns press sideways with a quarter: three quarters of this are to yield.
                if law == VON_MISES && -0.75 * expected > 6.6e3 {
                    yields += 1;
                    flow = flow.max((wet[1] - wet[0] - 6e3).abs() / 6e3);
                }
            }
            println!("{basis} {law}: {worst:.2e} {exact:.2e} {flow:.2e}, {yields} yield");
            assert!(worst < 0.02, "{basis} {law}: {worst}");
            // A quarter of a cell of weight with linear functions.
            assert!(exact < 0.04 && flow < 5e-3, "{basis} {law}: {exact} {flow}");
            assert!(law != VON_MISES || yields > 40, "{yields}");
        }
    }
}

/// A block whose top bears a load on its left half.
fn block(material: &str, law: &str) -> Scene {
    scene(&format!(
        r#"
title = "Block"
[grid]
min = [0, 0]
max = [1, 1.25]
cells = [8, 10]
[time]
step = 5e-5
end = 0.1
[method]
basis = "linear"
reconstruction = "shepard"
[material]
strain = "large"
{material}
law.{law}
[[body]]
min = [0, 0]
max = [1, 1]
particles_per_cell = [2, 2]
[[boundary]]
face = "x-min"
roller = true
[[boundary]]
face = "x-max"
roller = true
[[boundary]]
face = "y-min"
fixed = true
[[boundary]]
face = "y-max"
traction = ["0", "-1.6e4*sin(pi/2*min(t/0.1, 1))^2"]
inside = "0.5 - x"
"#
    ))
}

#[test]
fn undrained_the_whole_is_one_phase_with_the_liquid_in_its_bulk_modulus() {
    // Shear modulus and bulk modulus of the grains, and with the liquid's 5e7 Pa.
    let (g, k) = (1e7 / 2.4, 1e7 / 1.8);
    let ku: f64 = k + 5e7;
    let (e, nu) = (
        9.0 * ku * g / (3.0 * ku + g),
        (3.0 * ku - 2.0 * g) / (6.0 * ku + 2.0 * g),
    );
    let one =
        format!("von-mises = {{ youngs_modulus = {e:?}, poissons_ratio = {nu:?}, yield_stress = 6e3 }}");
    let one = run_in::<2>(&block("density = 1990.0", &one), None, &mut |_| {}).unwrap();
    let sealed = SATURATED.replace("permeability = 0.05", "permeability = 1e-12");
    let two = run_in::<2>(&block(&sealed, VON_MISES), None, &mut |_| {}).unwrap();
    let mut largest = [0.0_f64; 3];
    let mut worst = [0.0_f64; 3];
    for p in 0..one.particles.len() {
        let (a, b) = (&one.particles, &two.particles);
        let mut total = b.stress[p];
        for axis in 0..2 {
            total[(axis, axis)] += two.liquid[p].pressure;
        }
        let pairs = [
            (
                a.displacement[p].norm(),
                (a.displacement[p] - b.displacement[p]).norm(),
            ),
            (a.stress[p].norm(), (a.stress[p] - total).norm()),
            // All of the volume is that of the liquid: nothing has left.
            (
                a.displacement[p].norm(),
                (two.particles.volume[p] / one.particles.volume[p] - 1.0).abs(),
            ),
        ];
        for k in 0..3 {
            largest[k] = largest[k].max(pairs[k].0);
            worst[k] = worst[k].max(pairs[k].1);
        }
    }
    println!("{worst:?} of {largest:?}");
    assert!(
        worst[0] < 1e-3 * largest[0] && worst[1] < 1e-3 * largest[1],
        "{worst:?} {largest:?}"
    );
    assert!(worst[2] < 1e-5, "{worst:?}");
    // The grains bear no mean stress worth mention, and yield.
    let yields = (0..two.particles.len()).filter(|&p| {
        let s = two.particles.stress[p];
        let deviator = ((s[(0, 0)] - s[(1, 1)]).powi(2) / 4.0 + s[(0, 1)].powi(2)).sqrt();
        deviator > 0.95 * 6e3 / 3.0_f64.sqrt()
    });
    let count = yields.count();
    assert!(count > 10, "{count} yield");
}
