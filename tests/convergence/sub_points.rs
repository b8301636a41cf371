//! Dual domain with sub-points (Dhakal & Zhang 2016, journal Table 8): S sub-points in each particle's domain
//! for the force.
//!
//! Expected: no independent figures exist for the printed gradient (the journal's belong to another one, see
//! `docs/verification/sub-points.md`), so the bounds are this code's own, from both sides. What is
//! independent: one sub-point is plain dual domain to the bit, and no number of them changes the column,
//! whose error is not one of the force.

use materialpoint::basis::DualDomain;
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{Hill, Moduli};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{Drag, OnePhase, Phase, PoreLiquid, TwoPhase};
use materialpoint::reconstruction::SubPoints;
use materialpoint::record::Record;
use materialpoint::stepper::{
    FaceCondition, Forcing, PoreCondition, Setup, Simulation, Stepper, SurfacePoint,
};
use materialpoint_command::run::RunError;
use materialpoint_steppers::{Build, Parts};
use nalgebra::vector;

use super::*;
use crate::compiled::parts;

fn against(kind: &str) -> String {
    format!("reference.column-compaction={{ body_force = -200.0, ramp = 0.5, against = \"{kind}\" }}")
}

fn stress(summary: &Summary) -> f64 {
    summary.errors["stress"].relative_l2
}

/// Static and dynamic error of the column, 20 particles per cell: 4.313e-3 and 2.615e-3 with one sub-point.
#[test]
fn the_column_does_not_change_with_the_number_of_sub_points() {
    for (sub_points, fixed, moving) in [
        (2, 4.309e-3, 2.608e-3),
        (8, 4.306e-3, 2.604e-3),
        (32, 4.307e-3, 2.604e-3),
    ] {
        for (kind, expected) in [("static", fixed), ("dynamic", moving)] {
            let found = summary(
                "column-compaction",
                Method::sub_points(sub_points),
                &[&against(kind)],
            );
            assert_close(&format!("{sub_points} {kind}"), stress(&found), expected, 2e-3);
            let kept = found.conservation["solid"];
            assert!(kept.mass <= 1e-12 && kept.momentum_scaled <= 1e-12, "{kept:?}");
        }
    }
}

/// Few particles per cell are what sub-points are for: on the large bar they take more than two thirds off
/// the error of two particles per cell, and nothing off that of eight.
#[test]
fn few_particles_per_cell_gain_and_many_do_not() {
    for (per_cell, plain, two, sixteen) in [(2, 2.92e-2, 8.94e-3, 7.92e-3), (8, 4.76e-3, 4.72e-3, 4.72e-3)] {
        let particles = format!("body.0.particles_per_cell=[{per_cell}]");
        for (sub_points, expected) in [(1, plain), (2, two), (16, sixteen)] {
            let found = summary(
                "vibrating-bar-large",
                Method::sub_points(sub_points),
                &[&particles],
            );
            let what = format!("{per_cell} per cell, {sub_points} sub-points");
            assert_close(&what, stress(&found), expected, 0.01);
            assert_eq!(found.method.subpoints, sub_points);
        }
    }
}

/// The strain is taken at the particle and the force over its domain, so the work of the two differs: with
/// one particle per cell the large bar gains 2 to 3 % of energy in 0.1 s, where plain dual domain gains 0.1 %
/// and less.
#[test]
fn one_particle_per_cell_gains_energy() {
    let gain = |sub_points| {
        let set = ["body.0.particles_per_cell=[1]"];
        let found = summary("vibrating-bar-large", Method::sub_points(sub_points), &set);
        found.energy.highest_ratio.unwrap() - 1.0
    };
    assert!(gain(1) < 1.5e-3, "{:e}", gain(1));
    for sub_points in [4, 16] {
        let gained = gain(sub_points);
        assert!((0.02..0.03).contains(&gained), "{sub_points}: {gained:e}");
    }
}

/// Consolidation, 20 cells, 4 particles per cell: the effective stress as with plain dual domain, and both
/// phases kept.
#[test]
fn two_phases_take_sub_points_too() {
    let found = summary("consolidation", Method::sub_points(4), &[]);
    let error = |field: &str| found.errors[field].relative_l2;
    assert_close("effective stress", error("effective_stress"), 6.99e-3, 0.01);
    assert_close("pore pressure", error("pore_pressure"), 4.56e-3, 0.01);
    for (phase, kept) in &found.conservation {
        assert!(
            kept.mass <= 1e-14 && kept.momentum_scaled <= 1e-14,
            "{phase}: {kept:?}"
        );
    }
}

#[test]
fn other_pairs_and_numbers_do_not_exist() {
    let scene = Scene::from_toml(Scene::builtin("column-compaction").unwrap(), &[]).unwrap();
    let elsewhere = Method {
        subpoints: 4,
        ..Method::new(LINEAR, SHEPARD)
    };
    for method in [Method::sub_points(0), Method::sub_points(129), elsewhere] {
        let refused = run(&scene.with_method(method), None, &mut |_| {}).unwrap_err();
        assert!(
            matches!(refused, RunError::NoSuchMethod(named) if named == method),
            "{refused}"
        );
    }
    assert_eq!(elsewhere.to_string(), "linear+shepard4");
}

/// A bar or column on which particles cross cells.
fn crossing(density: f64) -> (Grid<f64, 1>, Particles<f64, 1>, Vec<SurfacePoint<f64>>, Hill<f64>) {
    let grid = Grid::new(vector![0.0], vector![1.25], [25]).unwrap();
    let points = lattice(&grid, &vector![0.0], &vector![1.0], [3]);
    let mut particles = Particles::at_rest(&points, density);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        v[0] = 40.0 * x[0];
    }
    let surface = vec![SurfacePoint {
        particle: particles.len() - 1,
        face: face(Side::Max),
        area: 1.0,
        reach: 0.5,
        loaded: true,
    }];
    let moduli = Moduli::uniaxial(1e7).unwrap();
    (grid, particles, surface, Hill { moduli })
}

const fn face(side: Side) -> Face {
    Face { axis: 0, side }
}

/// All that the particles carry after 200 steps.
fn after_200_steps(stepper: &mut dyn Simulation<1>, top: PoreCondition<f64>) -> Vec<f64> {
    let forcing = Forcing::none()
        .with_face(face(Side::Min), FaceCondition::fixed())
        .with_pores(face(Side::Max), top);
    for _ in 0..200 {
        stepper.step(5e-6, &forcing).unwrap();
    }
    assert!(stepper.diagnostics().grid_crossings > 0);
    let particles = stepper.particles();
    let parts = particles
        .position
        .iter()
        .zip(&particles.velocity)
        .zip(&particles.stress);
    parts.flat_map(|((x, v), s)| [x[0], v[0], s[(0, 0)]]).collect()
}

/// Of a method by name.
fn of_method(
    method: Method,
    liquid: Option<TwoPhase<f64>>,
    density: f64,
    top: PoreCondition<f64>,
) -> Vec<f64> {
    let (grid, particles, surface, law) = crossing(density);
    let parts = Parts {
        liquid,
        pores: vec![PoreLiquid::default(); particles.len()],
        surface,
        ..parts(grid, law, particles)
    };
    after_200_steps(parts.stepper(method).unwrap().as_mut(), top)
}

/// Of [`SubPoints`] with the particle itself as the only one, which no name has.
fn of_one_sub_point<P>(phase: P, density: f64, top: PoreCondition<f64>) -> Vec<f64>
where
    P: Phase<f64, 1> + Clone,
    P::Particle: Record<f64>,
{
    let (grid, particles, surface, law) = crossing(density);
    let setup = Setup::new(
        grid,
        DualDomain::new(),
        SubPoints::default(),
        law,
        phase,
        particles.into_cast(),
    );
    after_200_steps(&mut Stepper::new(setup.with_surface(surface)).unwrap(), top)
}

/// Largest difference relative to the larger of the two values.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    let each = pairs.map(|(a, b)| (a - b).abs() / a.abs().max(b.abs()).max(f64::MIN_POSITIVE));
    each.fold(0.0, f64::max)
}

/// The streams are the same to the bit (unit tests of `SubPoints`); plain MPM adds them up in another order.
#[test]
fn one_sub_point_is_plain_dual_domain() {
    const ROUND_OFF: f64 = 1e-11;
    let sealed = PoreCondition::Sealed;
    let dual_domain = Method::new(Basis::DualDomain, ReconstructionKind::Shepard);
    let plain = of_method(dual_domain, None, 2e3, sealed);
    let single = of_one_sub_point(OnePhase, 2e3, sealed);
    assert!(difference(&plain, &single) < ROUND_OFF);
    let two = of_method(Method::sub_points(2), None, 2e3, sealed);
    assert!(difference(&plain, &two) > 1e3 * ROUND_OFF);
    let soil = TwoPhase {
        porosity: 0.4,
        solid_density: 2650.0,
        liquid_density: 1e3,
        liquid_bulk_modulus: 2e8,
        permeability: 1e-3,
        permeability_exponent: 0.0,
        gravity: 9.81,
        drag: Drag::Implicit,
    };
    let (density, drained) = (soil.dry_density(), PoreCondition::Pressure(0.0));
    let plain = of_method(dual_domain, Some(soil), density, drained);
    let single = of_one_sub_point(soil, density, drained);
    assert!(difference(&plain, &single) < ROUND_OFF);
}
