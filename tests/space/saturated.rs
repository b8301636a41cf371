//! Source: the column of one dimension (`tests/two_phase/column.rs`), whose references are exact. Goal:
//! scenes of two phases run in the plane; a wide column of saturated soil is the column of one dimension.
//! Parameters: a column 1 m high and 0.3 m wide between smooth walls, drained at the top, loaded there by 10
//! kPa, Poisson's ratio 0.2; 10 cells high, 2 and 4 particles per cell and axis; 0.05 s. Expected: pressure
//! and effective stress of the line within 1 % (measured 0.65 % at most); with TLS on B-splines the pressure
//! varies across by 19 % of its largest, because Gauss forces over lumped masses differ from wall to middle.
//! Both phases keep their mass.

use materialpoint_command::run::{run, run_in};

use super::scene;

const PLANE: &str = r#"
title = "Saturated column"
[grid]
min = [0, 0]
max = [0.3, 1]
cells = [3, 10]
[time]
step = 5e-5
end = 0.05
[method]
basis = "bspline"
reconstruction = "taylor"
velocity_mass = "lumped"
[material]
phases = 2
strain = "small"
law.linear-elastic = { youngs_modulus = 1e7, poissons_ratio = 0.2 }
porosity = 0.4
solid_density = 2.6e3
liquid_density = 1e3
liquid_bulk_modulus = 3e8
permeability = 1e-2
[[body]]
min = [0, 0]
max = [0.3, 1]
particles_per_cell = [4, 4]
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
traction = ["0", "-1e4*min(t/0.01, 1)"]
drained = true
"#;

/// The same along one axis; its modulus is that of uniaxial strain.
const LINE: [&str; 5] = [
    "grid={min=[0], max=[1], cells=[10]}",
    "material.law={linear-elastic={youngs_modulus=1.1111111111111112e7}}",
    "body=[{min=[0], max=[1], particles_per_cell=[4]}]",
    "boundary=[{face='x-min', fixed=true}, {face='x-max', traction=['-1e4*min(t/0.01, 1)'], drained=true}]",
    "title='Line'",
];

/// Largest difference of pressure and effective stress from the line's, over their largest.
#[track_caller]
fn differences(reconstruction: &str, basis: &str) -> [f64; 2] {
    let method = [
        format!("method.reconstruction={reconstruction:?}"),
        format!("method.basis={basis:?}"),
    ];
    let method = method.each_ref().map(String::as_str);
    let line = run(&scene(PLANE, &[&LINE[..], &method].concat()), None, &mut |_| {}).unwrap();
    let plane = run_in::<2>(&scene(PLANE, &method), None, &mut |_| {}).unwrap();
    let kept = &plane.summary.conservation;
    assert!(
        kept["solid"].mass < 1e-13 && kept["liquid"].mass < 1e-13,
        "{kept:?}"
    );
    let (mut worst, mut largest) = ([0.0_f64; 2], [0.0_f64; 2]);
    for (p, x) in plane.particles.initial_position.iter().enumerate() {
        let at = |q: &usize| (line.particles.initial_position[*q][0] - x[1]).abs() < 1e-9;
        let q = (0..40).find(at).unwrap();
        let found = [plane.liquid[p].pressure, plane.particles.stress[p][(1, 1)]];
        let expected = [line.liquid[q].pressure, line.particles.stress[q][(0, 0)]];
        for k in 0..2 {
            worst[k] = worst[k].max((found[k] - expected[k]).abs());
            largest[k] = largest[k].max(expected[k].abs());
        }
    }
    std::array::from_fn(|k| worst[k] / largest[k])
}

#[test]
fn a_wide_column_is_the_column_of_one_dimension() {
    for (reconstruction, basis) in [
        ("taylor", "linear"),
        ("taylor", "dual-domain"),
        ("shepard", "bspline"),
        ("shepard", "linear"),
    ] {
        let found = differences(reconstruction, basis);
        assert!(
            found.iter().all(|&off| off < 0.01),
            "{reconstruction} {basis}: {found:?}"
        );
    }
}

#[test]
fn b_splines_with_taylor_vary_across_the_column() {
    let [pressure, stress] = differences("taylor", "bspline");
    assert!(
        (0.1..0.3).contains(&pressure) && stress < 0.06,
        "{pressure} {stress}"
    );
}
