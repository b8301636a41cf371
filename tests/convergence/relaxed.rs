//! Relaxed Taylor least squares: the accuracy and the energy that a prototype found, with 8 (and 4) particles per cell.
//!
//! Large bar: relative L2 error of the stress at 0.1 s against the converged solution, as in `large_bar`. Column: against
//! the dynamic solution, as in `column`. Smooth run: the large bar with v0 = 0.08 m/s, 80 cells, to 8 s. It stays smooth until
//! 7.96 s, so the exact energy is constant; particles cross cell edges all the time, and published TLS gains energy without
//! bound there.

use super::*;

const RELAXED: ReconstructionKind = ReconstructionKind::RelaxedTaylor;

/// Basis; large bar with 8 and with 4 particles per cell; column.
const TABLE: [(Basis, f64, f64, f64); 3] = [
    (LINEAR, 8.2e-3, 8.9e-3, 6.6e-3),
    (DUAL_DOMAIN, 2.4e-3, 3.2e-3, 1.6e-3),
    (BSPLINE, 5.75e-4, 6.7e-4, 1.6e-4),
];

#[test]
fn three_bases_have_the_errors_of_the_prototype() {
    for (basis, eight, four, column) in TABLE {
        let method = Method::new(basis, RELAXED);
        let error = |scene, set: &[&str]| summary(scene, method, set).errors["stress"].relative_l2;
        assert_close(
            &format!("{method}"),
            error("vibrating-bar-large", &[]),
            eight,
            0.03,
        );
        let set = ["body.0.particles_per_cell=[4]"];
        assert_close(
            &format!("{method}, 4"),
            error("vibrating-bar-large", &set),
            four,
            0.03,
        );
        // The prototype's figures have two digits here.
        assert_close(
            &format!("{method}, column"),
            error("column-compaction", &[]),
            column,
            0.05,
        );
    }
}

#[test]
fn mass_and_momentum_are_kept() {
    for (scene, limit) in [("vibrating-bar-large", 1e-14), ("column-compaction", 1e-12)] {
        for (basis, ..) in TABLE {
            let found = summary(scene, Method::new(basis, RELAXED), &[]).conservation["solid"];
            assert!(
                found.mass <= limit && found.momentum <= limit,
                "{scene}: {found:?}"
            );
        }
    }
}

fn smooth(method: Method, end: &str) -> Summary {
    let set = [
        "body.0.velocity=[\"0.08*sin(pi*x)\"]",
        "reference.vibrating-bar.velocity=0.08",
        "grid.cells=[80]",
        end,
    ];
    summary("vibrating-bar-large", method, &set)
}

/// Within 0.98 and 1.003 at all times up to 8 s, where the published method has 1.17 (dual domain, lumped) to 13.5 (linear).
#[test]
fn the_smooth_run_keeps_its_energy_where_the_published_method_gains() {
    for (basis, ..) in TABLE {
        let energy = smooth(Method::new(basis, RELAXED), "time.end=8.0").energy;
        let (lowest, highest) = (energy.lowest_ratio.unwrap(), energy.highest_ratio.unwrap());
        assert!(lowest > 0.98 && highest < 1.003, "{basis}: {lowest} to {highest}");
    }
    let published = smooth(Method::new(LINEAR, TAYLOR), "time.end=6.0").energy;
    assert_close("published, linear", published.highest_ratio.unwrap(), 1.34, 0.03);
}

/// A law that leaves the stress as it is, with a state `S` of its own.
#[derive(Clone, Copy)]
struct Frozen<S>(std::marker::PhantomData<S>);

impl<S: Copy + Default + Send + Sync> materialpoint::law::ConstitutiveLaw<f64, 1> for Frozen<S> {
    type State = S;

    fn large_strain(&self) -> bool {
        false
    }

    fn update(&self, _: &nalgebra::Matrix1<f64>, _: &mut nalgebra::Matrix1<f64>, _: &mut S) {}

    fn wave_speed(&self, _: f64, _: &nalgebra::Matrix1<f64>, _: &S) -> f64 {
        1.0
    }

    fn energy_density(&self, _: &nalgebra::Matrix1<f64>, _: &S) -> f64 {
        0.0
    }
}

/// Whether one step moves rough stresses towards their fit.
fn moves_the_stress<S: Copy + Default + Send + Sync>() -> bool {
    use materialpoint::basis::BSpline;
    use materialpoint::grid::Grid;
    use materialpoint::mass::VelocityMass;
    use materialpoint::particles::{Particles, lattice};
    use materialpoint::phase::OnePhase;
    use materialpoint::reconstruction::RelaxedTaylor;
    use materialpoint::stepper::{Forcing, Setup, Stepper};
    use nalgebra::vector;

    let grid = Grid::new(vector![0.0], vector![1.0], [4]).unwrap();
    let points = lattice(&grid, grid.min(), grid.max(), [6]);
    let mut particles = Particles::at_rest(&points, 1.0);
    for (p, stress) in particles.stress.iter_mut().enumerate() {
        stress[(0, 0)] = (p * 5 % 7) as f64;
    }
    let before = particles.stress.clone();
    let mut stepper = Stepper::new(Setup {
        grid,
        basis: BSpline::<2>,
        reconstruction: RelaxedTaylor::<f64, 1, 3>::for_degree(2),
        law: Frozen(std::marker::PhantomData::<S>),
        phase: OnePhase,
        velocity_mass: VelocityMass::Constrained,
        particles,
        surface: Vec::new(),
    })
    .unwrap();
    stepper.step(1e-6, &Forcing::none()).unwrap();
    stepper.particles().stress != before
}

/// Plastic history, a deformation gradient: stress is bound to it and must not be moved without it.
#[test]
fn the_stress_of_a_law_with_a_state_is_not_relaxed() {
    assert!(moves_the_stress::<()>());
    assert!(!moves_the_stress::<f64>());
}
