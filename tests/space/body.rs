//! Bodies in the plane: shapes, tables, files.

use materialpoint_command::output::Folder;
use materialpoint_command::run::{RunError, run, run_in};

use super::scene;

/// A disc of radius 0.3 in free flight.
const DISC: &str = r#"
title = "Disc"
[grid]
min = [0, 0]
max = [2, 1]
cells = [20, 10]
[time]
step = 1e-3
end = 0.1
[method]
basis = "bspline"
reconstruction = "shepard"
[material]
strain = "large"
law.neo-hookean = { youngs_modulus = 1e3, poissons_ratio = 0.3 }
density = 2
[[body]]
min = [0.2, 0.2]
max = [0.8, 0.8]
inside = "0.3^2 - (x - 0.5)^2 - (y - 0.5)^2"
particles_per_cell = [4, 4]
velocity = ["1", "-0.5"]
[load]
body_force = ["0", "-2*t"]
[output]
particles = "vtu"
every = 50
"#;

#[test]
fn a_disc_has_its_mass_and_flies_as_it_should() {
    let outcome = run_in::<2>(&scene(DISC, &[]), None, &mut |_| {}).unwrap();
    let particles = &outcome.particles;
    let mass: f64 = particles.mass.iter().sum();
    assert!(
        (mass / (2.0 * std::f64::consts::PI * 0.09) - 1.0).abs() < 0.02,
        "{mass}"
    );
    // Euler-Cromer sums -2 t over the steps' starts.
    let fallen: f64 = (0..100).map(|n| -2.0 * f64::from(n) * 1e-6).sum();
    for (velocity, stress) in particles.velocity.iter().zip(&particles.stress) {
        assert!((velocity[0] - 1.0).abs() < 1e-12 && (velocity[1] + 0.5 - fallen).abs() < 1e-12);
        assert!(stress.abs().max() < 1e-9);
    }
}

#[test]
fn frames_are_written_from_the_start_with_an_index() {
    let place = std::env::temp_dir().join(format!("materialpoint-frames-{}", std::process::id()));
    let folder = Folder::create(&place).unwrap();
    let outcome = run_in::<2>(&scene(DISC, &[]), Some(&folder), &mut |_| {}).unwrap();
    let names: Vec<_> = outcome
        .files
        .iter()
        .filter_map(|file| file.file_name()?.to_str())
        .collect();
    let frames = [
        "particles-000000.vtu",
        "particles-000001.vtu",
        "particles-000002.vtu",
    ];
    assert_eq!(names[..3], frames);
    let index = std::fs::read_to_string(place.join("particles.pvd")).unwrap();
    assert!(frames.iter().all(|frame| index.contains(frame)));
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn tables_name_every_component() {
    let place = std::env::temp_dir().join(format!("materialpoint-table-{}", std::process::id()));
    let folder = Folder::create(&place).unwrap();
    let set = ["output.particles=csv", "output.every=0", "time.end=0.002"];
    run_in::<2>(&scene(DISC, &set), Some(&folder), &mut |_| {}).unwrap();
    let table = std::fs::read_to_string(place.join("particles.csv")).unwrap();
    let header = "x0[m],y0[m],x[m],y[m],u_x[m],u_y[m],v_x[m/s],v_y[m/s],stress_xx[Pa],stress_yy[Pa],stress_xy[Pa],\
                  density[kg/m3],volume[m2],";
    assert!(table.starts_with(header), "{:?}", table.lines().next());
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn another_number_of_axes_and_a_shape_of_nothing_are_errors() {
    let error = run(&scene(DISC, &[]), None, &mut |_| {}).unwrap_err();
    assert!(matches!(
        error,
        RunError::Dimension {
            found: 2,
            expected: 1
        }
    ));
    let error = run_in::<2>(&scene(DISC, &["body.0.inside=\"-1\""]), None, &mut |_| {}).unwrap_err();
    assert!(matches!(error, RunError::EmptyBody { index: 0 }), "{error}");
}

/// A block under an even stress between rollers and a traction that balances it stays as it is, with each law
/// that can start under stress: two points a cell integrate linear functions along the surface exactly.
#[test]
fn an_even_initial_stress_stays_in_equilibrium() {
    let laws = [
        "linear-elastic={youngs_modulus=1e3, poissons_ratio=0.3}",
        "logarithmic={youngs_modulus=1e3, poissons_ratio=0.3}",
        "drucker-prager={youngs_modulus=1e3, poissons_ratio=0.3, friction_angle=40, cohesion=50}",
        "von-mises={youngs_modulus=1e3, poissons_ratio=0.3, yield_stress=500}",
    ];
    for law in laws {
        for reconstruction in ["shepard", "taylor"] {
            let set = [
                "grid={min=[0, 0], max=[1, 2], cells=[5, 10]}",
                &format!("material.law={{{law}}}"),
                "method.basis=linear",
                &format!("method.reconstruction={reconstruction}"),
                "body=[{min=[0, 0], max=[1, 1], particles_per_cell=[2, 2], stress={xx=\"-5\", yy=\"-10\"}}]",
                "boundary=[{face=\"x-min\", roller=true}, {face=\"x-max\", roller=true}, {face=\"y-min\", roller=true}, {face=\"y-max\", traction=[\"0\", \"-10\"]}]",
                "load={}",
                "output={particles=\"none\"}",
            ];
            let outcome = run_in::<2>(&scene(DISC, &set), None, &mut |_| {}).unwrap();
            for stress in &outcome.particles.stress {
                let off = (stress[(0, 0)] + 5.0).abs() + (stress[(1, 1)] + 10.0).abs() + stress[(0, 1)].abs();
                assert!(off < 1e-6, "{law} {reconstruction}: {stress}");
            }
        }
    }
}
