//! Partly filled cells: bodies that move freely through the grid, all bases with all reconstructions.
//!
//! Expected: rigid motion is exact to round-off wherever the ends lie, since equal velocities map to equal
//! velocities and cause no strain. A uniform stress balanced by tractions stays where the quadrature is exact
//! over the body: fits that end at the body's surfaces integrate slopes exactly, particle sums do not. A tiny
//! particle alone in a cell must not be torn off where force and mass come from the same functions.

use materialpoint::error::StepError;
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::stepper::{FaceCondition, Forcing, Simulation};
use nalgebra::vector;

use super::body::{Basis::*, Rebuilt::*, *};

type Elastic = Bodies<LinearElastic<f64>>;

/// No body yet, in units of modulus and wave speed.
fn grid(length: f64, cells: usize) -> Elastic {
    let moduli = Moduli::uniaxial(1.0).unwrap();
    Bodies::on_grid(LinearElastic { moduli }, length, cells)
}

/// The largest departures of velocity and stress from what is exact, and of the positions, over the
/// particles.
#[derive(Debug, Default)]
struct Departure {
    velocity: f64,
    stress: f64,
    position: f64,
}

impl Departure {
    fn take(&mut self, simulation: &dyn Simulation<1>, stress: f64, velocity: f64, path: f64) {
        let found = simulation.particles();
        for p in 0..found.len() {
            let moved = found.position[p][0] - found.initial_position[p][0];
            self.velocity = self.velocity.max((found.velocity[p][0] - velocity).abs());
            self.stress = self.stress.max((found.stress[p][(0, 0)] - stress).abs());
            self.position = self.position.max((moved - path).abs());
        }
    }
}

const SPEED: f64 = 0.1;
const STEP: f64 = 0.05;
const STEPS: usize = 200;

/// Ends of bodies 2.5 cells long: a hundred places in a cell, and one with particles exactly on edges.
fn places() -> impl Iterator<Item = [f64; 2]> {
    let offsets = (0..100).map(|k| f64::from(k) / 100.0).chain([0.125]);
    offsets.map(|offset| [3.0 + offset, 5.5 + offset])
}

/// A body that moves one cell to the right under a uniform `stress`, held by tractions; `known`: its ends are
/// surfaces. The worst over all places, or the first error.
fn translated(variant: Variant, stress: f64, known: bool) -> Result<Departure, StepError> {
    let forcing = Forcing::none()
        .with_face(LEFT, FaceCondition::Traction(vector![-stress]))
        .with_face(RIGHT, FaceCondition::Traction(vector![stress]));
    let mut worst = Departure::default();
    for place in places() {
        let mut bodies = grid(10.0, 10).with_body(place, 10, 1.0, known).moving(|_| SPEED);
        bodies
            .particles
            .stress
            .iter_mut()
            .for_each(|s| s[(0, 0)] = stress);
        let mut simulation = bodies.simulation(variant);
        for n in 1..=STEPS {
            simulation.step(STEP, &forcing)?;
            worst.take(&*simulation, stress, SPEED, SPEED * STEP * n as f64);
        }
    }
    Ok(worst)
}

/// Measured: velocity 2e-15, stress 4e-16, position 1e-13. A particle that steps exactly on an edge used to
/// be strained by a node without mass (linear and dual domain with Shepard, stress 3e-3); relaxed TLS
/// magnified round-off to 1e14 and left.
#[test]
fn rigid_motion_of_an_unstressed_body_is_exact() {
    for variant in variants() {
        let found = translated(variant, 0.0, true).unwrap();
        let exact = found.velocity < 1e-14 && found.stress < 1e-14 && found.position < 2e-12;
        assert!(exact, "{variant:?}: {found:?}");
    }
}

/// Where the ends are not known, fits go on to the end of the cell. Masses that follow from the particles
/// bear it; with published TLS round-off grows in four of six variants (measured: stress 9e-11 to 3e1, one
/// leaves the grid).
#[test]
fn rigid_motion_with_ends_unknown_is_exact_where_masses_are_the_particles() {
    for variant in variants() {
        let found = translated(variant, 0.0, false);
        if matches!(variant.1, Shepard | Relaxed) {
            let found = found.unwrap();
            assert!(
                found.velocity < 1e-14 && found.stress < 1e-14,
                "{variant:?}: {found:?}"
            );
        }
    }
}

/// The force of a uniform stress is the difference of a function's values at the ends, which fits give
/// exactly and the traction takes back (measured: velocity 3e-15, stress 5e-15). Particle sums miss it by
/// their quadrature error.
#[test]
fn rigid_motion_leaves_a_balanced_stress_alone_where_fits_end_at_the_surface() {
    for variant in variants() {
        let found = translated(variant, 1.0, true);
        if variant.1 == Shepard {
            assert!(found.is_err() || found.unwrap().stress > 0.1, "{variant:?}");
            continue;
        }
        let found = found.unwrap();
        let exact = found.velocity < 1e-13 && found.stress < 1e-13 && found.position < 1e-12;
        assert!(exact, "{variant:?}: {found:?}");
    }
}

/// Velocity exact; position late by Euler-Cromer's `b t dt / 2`, no more and no less.
#[test]
fn free_fall_has_exactly_the_error_of_the_time_integration() {
    const WEIGHT: f64 = -0.02;
    let forcing = Forcing::none().with_body_force(vector![WEIGHT]);
    for variant in variants() {
        let mut worst = Departure::default();
        for place in places() {
            let bodies = grid(10.0, 10).with_body(place, 10, 1.0, true).moving(|_| SPEED);
            let mut simulation = bodies.simulation(variant);
            for n in 1..=STEPS {
                simulation.step(STEP, &forcing).unwrap();
                let time = STEP * n as f64;
                let path = SPEED * time + WEIGHT * time * (time + STEP) / 2.0;
                worst.take(&*simulation, 0.0, SPEED + WEIGHT * time, path);
            }
        }
        let exact = worst.velocity < 1e-14 && worst.stress < 1e-14 && worst.position < 2e-12;
        assert!(exact, "{variant:?}: {worst:?}");
    }
}

/// Energy without that of the common motion.
fn vibration(simulation: &dyn Simulation<1>) -> f64 {
    let found = simulation.particles();
    let mass: f64 = found.mass.iter().sum();
    let momentum: f64 = found
        .mass
        .iter()
        .zip(&found.velocity)
        .map(|(m, v)| m * v[0])
        .sum();
    simulation.energy().total() - momentum * momentum / mass / 2.0
}

/// A bar with free ends vibrates in its first mode for five periods while it drifts through ten cells. The
/// highest energy of the vibration over the initial one, up to the end or the error.
fn drifting(variant: Variant, per_cell: usize, known: bool) -> (f64, Result<(), StepError>) {
    let start = 0.53;
    let mode = |x: f64| 1e-3 * ((x - start) * std::f64::consts::PI).cos();
    let bodies = grid(3.0, 30)
        .with_body([start, start + 1.0], 10 * per_cell, 1.0, known)
        .moving(|x| 0.1 + mode(x));
    let mut simulation = bodies.simulation(variant);
    let initial = vibration(&*simulation);
    let mut highest = 1.0_f64;
    let ended = (0..1000).try_for_each(|_| {
        simulation.step(0.01, &Forcing::none())?;
        highest = highest.max(vibration(&*simulation) / initial);
        Ok(())
    });
    (highest, ended)
}

/// Highest energy with 8 and with 4 particles per cell, surfaces known. Euler-Cromer's own wave is 1.016.
/// With 4 particles published TLS feeds on its crossings.
const DRIFTING: [(Variant, f64, f64); 12] = [
    ((Linear, Shepard), 1.021, 1.019),
    ((DualDomain, Shepard), 1.016, 1.016),
    ((BSpline, Shepard), 1.016, 1.016),
    ((Linear, TaylorLumped), 1.019, 2.96),
    ((DualDomain, TaylorLumped), 1.011, 1.011),
    ((BSpline, TaylorLumped), 1.016, 1.017),
    ((Linear, TaylorConsistent), 1.031, 1.056),
    ((DualDomain, TaylorConsistent), 1.086, 1.32),
    ((BSpline, TaylorConsistent), 1.033, 9.14),
    ((Linear, Relaxed), 1.016, 1.033),
    ((DualDomain, Relaxed), 1.012, 1.012),
    ((BSpline, Relaxed), 1.017, 1.016),
];

#[test]
fn a_free_end_sweeps_through_cells() {
    for (variant, eight, four) in DRIFTING {
        for (per_cell, expected) in [(8, eight), (4, four)] {
            let (highest, ended) = drifting(variant, per_cell, true);
            assert_eq!(ended, Ok(()), "{variant:?}, {per_cell}");
            let close = (highest / expected - 1.0).abs() < 0.02;
            assert!(close, "{variant:?}, {per_cell}: {highest} instead of {expected}");
        }
    }
}

/// Published TLS does not bear a free end of which it does not know: it ends in a typed error or, with lumped
/// masses that are positive and the bases whose slopes reach far, with 2e4 and 4e6 times the energy.
#[test]
fn an_unknown_free_end_ends_published_fits() {
    for variant in variants().filter(|v| matches!(v.1, TaylorLumped | TaylorConsistent)) {
        let (highest, ended) = drifting(variant, 8, false);
        let left = matches!(ended, Err(StepError::LeftGrid { .. }));
        let bounded = ended.is_ok() && variant.1 == TaylorLumped;
        assert!(
            (left || bounded) && highest > 1e3,
            "{variant:?}: {highest:e}, {ended:?}"
        );
    }
}

/// Largest acceleration of any particle over a hundred steps of a body under unit stress let go, in units of
/// stress over density and cell, when one particle with 1e-12 of a cell's mass is alone in the next cell.
fn hurled(variant: Variant, place: f64) -> Result<f64, StepError> {
    let (half, step) = (0.5e-12, 0.01);
    let mut bodies = grid(6.0, 6).with_body([1.0, 4.0], 12, 1.0, true).with_body(
        [4.0 + place - half, 4.0 + place + half],
        1,
        1.0,
        true,
    );
    // One body: between its parts there is no surface.
    bodies.surface.drain(1..3);
    bodies.particles.stress.iter_mut().for_each(|s| s[(0, 0)] = 1.0);
    let mut simulation = bodies.simulation(variant);
    let mut most = 0.0_f64;
    for _ in 0..100 {
        let before = simulation.particles().velocity;
        simulation.step(step, &Forcing::none())?;
        let after = simulation.particles().velocity;
        let changes = before.iter().zip(&after).map(|(a, b)| (b[0] - a[0]).abs() / step);
        most = changes.fold(most, f64::max);
    }
    Ok(most)
}

/// Bounded where the force is a sum over the particles and the slopes are those of the values (measured: up
/// to 3.2). Dual domain's slopes reach a cell further than its values, and a fit gives the tiny particle's
/// stress to half a cell: a force without its mass, 1e10 and more, which throws the particle out of the grid.
#[test]
fn a_particle_with_a_billionth_of_a_thousandth_of_a_cell_is_not_torn_off_by_particle_sums() {
    for variant in variants() {
        for place in [0.01, 0.5, 0.99] {
            let found = hurled(variant, place);
            match variant {
                (Linear | BSpline, Shepard) => assert!(found.as_ref().is_ok_and(|&a| a < 4.0), "{found:?}"),
                _ => assert!(
                    matches!(found, Err(StepError::LeftGrid { .. })),
                    "{variant:?}, {place}: {found:?}"
                ),
            }
        }
    }
}

/// Two bars meet and part again. What is lost of mass and momentum in the mapping, and of the particles'
/// momentum, in shares of the mass and of the momenta's sizes.
#[test]
fn a_gap_that_closes_and_opens_keeps_mass_and_momentum() {
    for variant in variants() {
        let bodies = grid(6.0, 30)
            .with_body([1.03, 2.03], 20, 1.0, true)
            .with_body([2.63, 3.63], 20, 1.0, true)
            .moving(|x| if x < 2.3 { 0.1 } else { -0.05 });
        let mut simulation = bodies.simulation(variant);
        let (mut least, mut lost) = (f64::INFINITY, 0.0_f64);
        for _ in 0..1500 {
            simulation.step(0.01, &Forcing::none()).unwrap();
            let found = simulation.particles();
            least = least.min(found.position[20][0] - found.position[19][0]);
            let momentum: f64 = found
                .mass
                .iter()
                .zip(&found.velocity)
                .map(|(m, v)| m * v[0])
                .sum();
            lost = lost.max((momentum - 0.05).abs() / 0.15);
        }
        let found = simulation.particles();
        let gap = found.position[20][0] - found.position[19][0];
        // Measured: 5e-15 at most.
        let errors = simulation.diagnostics().conservation;
        let kept = errors.mass < 1e-14 && errors.momentum_scaled < 1e-14 && lost < 1e-13;
        assert!(kept, "{variant:?}: {errors:?}, {lost:e}");
        // The bars meet when they share a cell's functions, from 0.65 apart, and part slowly where the fits
        // through neighbours see both (B-splines reach furthest). With densities that may be negative
        // published TLS with B-splines and the consistent mass gained so much energy that they went through
        // each other.
        let way = if variant == (BSpline, Relaxed) { 0.05 } else { 0.2 };
        assert!(least < 0.3 && gap > least + way, "{variant:?}: {least} {gap}");
    }
}
