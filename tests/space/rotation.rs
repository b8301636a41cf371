//! Source: angular momentum and energy of a free body. Goal: what a free disc loses of both in one turn, and
//! how fast that goes with the cells. Parameters: the compiled-in scene `spinning-disc`, 8 and 16 cells
//! across, 9 particles per cell, 0.2 of a cell per step. Expected: internal forces of symmetric stresses have
//! no moment about any point (the grid's functions return linear fields), and moving particles with the
//! mapped velocity keeps the angular momentum. But a particle is accelerated by forces over *lumped* masses,
//! which take it to its nodes: its moment is lost where particles do not lie evenly about them, at the free
//! side.

use materialpoint::error::StepError;
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint_command::scene::Scene;

use super::scene;
use super::watch::{momenta, watch};

/// What a spin leaves, and what it did on the way.
#[derive(Debug)]
struct Spin {
    /// Angular momentum over the first.
    angular: f64,
    /// Most of the total momentum over the sum of its sizes.
    momentum: f64,
    /// Lowest and highest energy over the first.
    energy: [f64; 2],
    /// Largest difference of a particle's distance from the middle to that at the start, over the radius.
    stretch: f64,
    /// Why it stopped.
    ended: Result<(), StepError>,
}

fn spin(method: Method, cells: usize, set: &[&str]) -> Spin {
    let step = format!("time.step={:?}", std::f64::consts::TAU / 262.0 / cells as f64);
    let scene = scene(
        Scene::builtin("spinning-disc").unwrap(),
        &[&[&*step], set].concat(),
    );
    let mut found = Spin {
        angular: f64::NAN,
        momentum: 0.0,
        energy: [f64::INFINITY, 0.0],
        stretch: 0.0,
        ended: Ok(()),
    };
    let (mut angular, mut start, mut n) = (f64::NAN, f64::NAN, 0);
    let result = watch::<2>(
        &scene.with_method(method).with_cells(cells),
        |time, simulation| {
            n += 1;
            if n % 25 != 1 {
                return;
            }
            let sums = momenta(simulation);
            let energy = simulation.energy().total();
            if time == 0.0 {
                (angular, start) = (sums.angular, energy);
            }
            found.angular = sums.angular / angular;
            found.momentum = found.momentum.max(sums.linear.norm() / sums.linear_scale);
            found.energy = [
                found.energy[0].min(energy / start),
                found.energy[1].max(energy / start),
            ];
            let particles = simulation.particles();
            for (x, x0) in particles.position.iter().zip(&particles.initial_position) {
                found.stretch = found.stretch.max((x.norm() - x0.norm()).abs() / 0.5);
            }
        },
    );
    found.ended = result.map(drop);
    found
}
const BASES: [Basis; 3] = [Basis::Linear, Basis::DualDomain, Basis::BSpline { degree: 2 }];

fn shepard(basis: Basis, cells: usize) -> Spin {
    let found = spin(Method::new(basis, ReconstructionKind::Shepard), cells, &[]);
    assert_eq!(found.ended, Ok(()));
    assert!(found.momentum < 1e-13, "{found:?}");
    found
}

/// Angular momentum after a turn on 12 and 24 cells.
const LEFT: [(Basis, [f64; 2]); 3] = [
    (BASES[0], [0.911, 0.987]),
    (BASES[1], [0.876, 0.989]),
    (BASES[2], [0.942, 0.993]),
];

#[test]
fn particle_sums_lose_angular_momentum_at_more_than_second_order() {
    for (basis, expected) in LEFT {
        let spins = [12, 24].map(|cells| shepard(basis, cells));
        for (spin, expected) in spins.iter().zip(expected) {
            let off = (1.0 - spin.angular) / (1.0 - expected);
            assert!((0.8..1.2).contains(&off), "{basis:?} {spin:?}");
            // Energy does not follow: what the rotation loses is found as vibration.
            assert!(spin.energy[0] > 0.995 && spin.energy[1] < 1.002, "{spin:?}");
        }
        assert!(spins.iter().all(|spin| spin.stretch < 0.02), "{spins:?}");
        let order = ((1.0 - spins[0].angular) / (1.0 - spins[1].angular)).log2();
        assert!(order > 2.0, "{basis:?}: {order}");
    }
}

/// Half and a quarter of the step change the loss by less than a tenth: it is the grid's, not time's.
#[test]
fn the_loss_is_not_the_time_step_s() {
    let method = Method::new(BASES[2], ReconstructionKind::Shepard);
    let [half, quarter] =
        ["time.step=1e-3", "time.step=5e-4"].map(|step| 1.0 - spin(method, 12, &[step]).angular);
    assert!((half / quarter - 1.0).abs() < 0.1, "{half} {quarter}");
}

/// Consistent mass, in the acceleration too, and a ghost penalty that vanishes on rotations: nothing of the
/// angular momentum is lost. Measured: 2e-14 (4e-14 with 24 cells); energy from 0.9995 to 1.0001.
fn check_relaxed(cells: usize) {
    for basis in BASES {
        let relaxed = spin(Method::new(basis, ReconstructionKind::RelaxedTaylor), cells, &[]);
        assert_eq!(relaxed.ended, Ok(()), "{basis:?}");
        assert!((relaxed.angular - 1.0).abs() < 1e-12, "{basis:?} {relaxed:?}");
        assert!(relaxed.momentum < 1e-13, "{basis:?} {relaxed:?}");
        assert!(
            relaxed.energy[0] > 0.999 && relaxed.energy[1] < 1.001,
            "{basis:?} {relaxed:?}"
        );
        assert!(relaxed.stretch < 2e-3, "{basis:?} {relaxed:?}");
    }
}

#[test]
fn relaxed_taylor_keeps_the_angular_momentum_to_round_off() {
    check_relaxed(12);
}

#[test]
#[ignore = "20 s: cargo test --release relaxed_taylor_keeps_the_angular -- --ignored"]
fn relaxed_taylor_keeps_the_angular_momentum_on_finer_grids() {
    check_relaxed(24);
}

/// Published TLS fits over whole cells, also where the body ends within.
#[test]
fn published_taylor_does_not_bear_a_round_free_side() {
    for basis in BASES {
        let published = spin(Method::new(basis, ReconstructionKind::Taylor), 12, &[]);
        assert!(published.ended.is_err(), "{published:?}");
    }
}
