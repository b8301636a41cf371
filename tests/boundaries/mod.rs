//! Boundary conditions: told velocities, tractions, held B-spline ends.

mod own_bases;

use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint_command::run::{Outcome, run};
use materialpoint_command::scene::Scene;

use crate::compiled::{self, parts};

const RULES: &str = r#"
title = "wave"
[grid]
min = [0.0]
max = [1.0]
cells = [100]
[time]
step = 2e-5
end = 5e-3
[method]
basis = "linear"
reconstruction = "shepard"
[material]
strain = "small"
law.linear-elastic = { youngs_modulus = 1e4 }
density = 1.0
[[body]]
min = [0.0]
max = [1.0]
particles_per_cell = [4]
[output]
particles = "none"
"#;

fn outcome(method: Method, boundary: &str) -> Outcome {
    let scene = Scene::from_toml(&format!("{RULES}{boundary}"), &[]).unwrap();
    run(&scene.with_method(method), None, &mut |_| {}).unwrap()
}

/// Relative L2 distance of the particles' stresses from `exact(x0)`.
fn stress_error(outcome: &Outcome, exact: impl Fn(f64) -> f64) -> f64 {
    let particles = &outcome.particles;
    let (mut error, mut size) = (0.0, 0.0);
    for (x0, stress) in particles.initial_position.iter().zip(&particles.stress) {
        let expected = exact(x0[0]);
        error += (stress[(0, 0)] - expected).powi(2);
        size += expected.powi(2);
    }
    (error / size).sqrt()
}

/// A wall that moves with v(t) = V sin^2(k t) sends the wave v(t - x/c) into the bar, c = 100 m/s,
/// stress -rho c v. It has come to the middle when the run ends.
#[test]
fn a_told_velocity_sends_the_exact_wave_into_the_bar() {
    let wall = "[[boundary]]\nface = \"x-min\"\nvelocity = [\"1e-3*sin(600*t)^2\"]\n";
    let exact = |x: f64| {
        let late = 5e-3 - x / 100.0;
        if late > 0.0 {
            -100.0 * 1e-3 * (600.0 * late).sin().powi(2)
        } else {
            0.0
        }
    };
    for method in Method::ALL {
        let error = stress_error(&outcome(method, wall), exact);
        assert!(error < 0.03, "{method}: {error:e}");
        assert!(error > 1e-4, "{method}: {error:e}: too good to be measured");
    }
}

/// The same wave from the right, sent by a traction on the body's surface.
#[test]
fn a_traction_sends_the_exact_wave_into_the_bar() {
    let pull = "[[boundary]]\nface = \"x-max\"\ntraction = [\"0.1*sin(600*t)^2\"]\n";
    let exact = |x: f64| {
        let late = 5e-3 - (1.0 - x) / 100.0;
        if late > 0.0 {
            0.1 * (600.0 * late).sin().powi(2)
        } else {
            0.0
        }
    };
    for method in Method::ALL {
        let error = stress_error(&outcome(method, pull), exact);
        assert!(error < 0.03, "{method}: {error:e}");
        assert!(error > 1e-4, "{method}: {error:e}: too good to be measured");
    }
}

/// The load goes where the surface goes: a bar hung at its top end and pulled at its lower end.
#[test]
fn a_traction_looks_along_its_face_on_either_side() {
    let left = "[[boundary]]\nface = \"x-min\"\ntraction = [\"-0.1*sin(600*t)^2\"]\n";
    let exact = |x: f64| {
        let late = 5e-3 - x / 100.0;
        if late > 0.0 {
            0.1 * (600.0 * late).sin().powi(2)
        } else {
            0.0
        }
    };
    let method = Method::NINE[0];
    let error = stress_error(&outcome(method, left), exact);
    assert!(error < 0.03, "{error:e}");
}

/// The end functions of open knots interpolate: a particle at the wall itself moves exactly with it.
#[test]
fn held_bspline_ends_are_exact() {
    use materialpoint::grid::{Face, Grid, Side};
    use materialpoint::law::{LinearElastic, Moduli};
    use materialpoint::mass::VelocityMass;
    use materialpoint::particles::Particles;
    use materialpoint::stepper::{FaceCondition, Forcing};
    use nalgebra::vector;

    let method = Method::new(Basis::BSpline { degree: 2 }, ReconstructionKind::Taylor);
    for mass in [
        VelocityMass::Consistent,
        VelocityMass::Constrained,
        VelocityMass::Lumped,
    ] {
        let grid = Grid::new(vector![0.0], vector![1.0], [5]).unwrap();
        // Nodes of a trapezoidal rule: the outermost particles sit on the walls.
        let points: Vec<_> = (0..=20)
            .map(|i| {
                (
                    vector![f64::from(i) / 20.0],
                    if i % 20 == 0 { 0.025 } else { 0.05 },
                )
            })
            .collect();
        let mut particles = Particles::at_rest(&points, 1.0);
        for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
            v[0] = (std::f64::consts::PI * x[0]).sin();
        }
        let law = LinearElastic {
            moduli: Moduli::uniaxial(1e4).unwrap(),
        };
        let mut stepper = compiled::simulation(method, mass, parts(grid, law, particles));
        let ends = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
        let forcing = ends
            .into_iter()
            .fold(Forcing::none(), |f, end| f.with_face(end, FaceCondition::fixed()));
        for _ in 0..50 {
            stepper.step(1e-4, &forcing).unwrap();
        }
        let moved = stepper.particles().displacement;
        assert_eq!((moved[0][0], moved[20][0]), (0.0, 0.0), "{mass:?}");
        assert!(moved[10][0] > 1e-3);
    }
}

/// One particle, linear functions, no force: the wall's acceleration reaches it with the wall's share, and it
/// moves with the interpolated velocity.
#[test]
fn a_told_motion_reaches_the_particles_with_the_wall_s_share() {
    use materialpoint::grid::{Face, Grid, Side};
    use materialpoint::law::{LinearElastic, Moduli};
    use materialpoint::particles::Particles;
    use materialpoint::stepper::{FaceCondition, Forcing};
    use materialpoint_steppers::Build;
    use nalgebra::vector;

    let (share, velocity, acceleration, dt) = (0.75, 0.3, 2.0, 1e-3);
    let grid = Grid::new(vector![0.0], vector![4.0], [4]).unwrap();
    let law = LinearElastic {
        moduli: Moduli::uniaxial(1.0).unwrap(),
    };
    let particles = Particles::at_rest(&[(vector![1.0 - share], 1.0)], 1.0);
    let method = Method::new(Basis::Linear, ReconstructionKind::Shepard);
    let mut stepper = parts(grid, law, particles).stepper(method).unwrap();
    let wall = Face {
        axis: 0,
        side: Side::Min,
    };
    let moving = FaceCondition::moving(vector![velocity], vector![acceleration]);
    stepper
        .step(dt, &Forcing::none().with_face(wall, moving))
        .unwrap();
    let own = share * acceleration * dt;
    let moved = dt * (share * velocity + (1.0 - share) * own);
    approx::assert_relative_eq!(stepper.particles().velocity[0][0], own, max_relative = 1e-14);
    approx::assert_relative_eq!(
        stepper.particles().displacement[0][0],
        moved,
        max_relative = 1e-14
    );
}
