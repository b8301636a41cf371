//! Source: Coulomb's law and Signorini's conditions; a Lagrangian finite element model of the same block
//! where said. Goal: a wall that lets go and rubs holds what rests on it, slows what slides by its law alone,
//! and never gives energy. Parameters: blocks of E = 10 MPa and 2000 kg/m3, 1 m x 0.5 m (or 2 m x 0.25 m),
//! two particles per cell and axis (relaxed TLS three), four cells high, on a floor under gravity that is
//! turned by an angle and either comes on within 0.2 s or acts at once; half the critical step. Expected: the
//! wall's work against friction is never positive (in one step at most what the solution of the contact
//! problem leaves, 1e-8 J beside some 1 J). With gravity within 0.2 s the flat block on 30 degrees and mu =
//! 0.7 slips at most 2e-5 m (finite elements 9.1e-6 m), at 15 degrees nothing slips or lifts. Applied at once
//! gravity makes the normal force a wave that returns to zero, so that elastic blocks slip and bounce for
//! physical reasons. While all of a block slides, v_x + mu v_y = g (sin a - mu cos a) t.

use std::array::from_fn;

use materialpoint::basis::{BSpline, BasisFamily, DualDomain, Linear};
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{Moduli, NeoHookean};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::{Reconstruction, RelaxedTaylor, Shepard};
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use nalgebra::SVector;

/// A block on a floor.
#[derive(Clone, Copy)]
struct Case {
    length: f64,
    height: f64,
    friction: f64,
    /// Of the floor (degrees).
    slope: f64,
    /// Time in which gravity comes on (s).
    ramp: f64,
    gravity: f64,
    end: f64,
    poissons_ratio: f64,
    youngs_modulus: f64,
    /// At the start: height above the floor (m), and velocity (m/s) along and up.
    above: f64,
    velocity: [f64; 2],
    /// Of the floor along itself (m/s).
    belt: f64,
    particles_per_cell: usize,
}

const BLOCK: Case = Case {
    length: 1.0,
    height: 0.5,
    friction: 0.7,
    slope: 30.0,
    ramp: 0.2,
    gravity: 9.81,
    end: 0.6,
    poissons_ratio: 0.3,
    youngs_modulus: 1e7,
    above: 0.0,
    velocity: [0.0; 2],
    belt: 0.0,
    particles_per_cell: 2,
};

/// What became of it.
#[derive(Debug)]
struct Found {
    /// Way of the floor's DOFs along and up (m): mean, and the greatest up.
    slip: f64,
    lift: f64,
    highest_lift: f64,
    /// Mean velocity of the block (m/s).
    velocity: Vec<f64>,
    displacement: f64,
    /// Energy (J) at the start, the highest and the last one.
    energy: [f64; 3],
    /// Most work of the wall in a step, and all of it (J).
    gain: f64,
    work: f64,
    impulse_error: f64,
    time: f64,
}

/// The block in as many dimensions as there are: the floor is the lower face of the last axis, the slope
/// falls along axis 0.
fn run<const D: usize, B, R>(basis: B, reconstruction: R, case: &Case) -> Found
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D> + Clone,
{
    let h = case.height / 4.0;
    let up = D - 1;
    let cells: [usize; D] = from_fn(|axis| match axis {
        0 => (3.0 * case.length / h).round() as usize,
        a if a == up => 8,
        _ => 6,
    });
    let max = SVector::from_fn(|axis, _| cells[axis] as f64 * h);
    let grid = Grid::new(SVector::zeros(), max, cells).unwrap();
    let low = SVector::from_fn(|axis, _| match axis {
        0 => case.length / 2.0,
        a if a == up => case.above,
        _ => h,
    });
    let high = SVector::from_fn(|axis, _| match axis {
        0 => case.length * 1.5,
        a if a == up => case.above + case.height,
        _ => 5.0 * h,
    });
    let points = lattice(&grid, &low, &high, [case.particles_per_cell; D]);
    let mut particles: Particles<f64, D, _, ()> = Particles::at_rest(&points, 2000.0);
    for velocity in &mut particles.velocity {
        velocity[0] = case.velocity[0];
        velocity[up] = case.velocity[1];
    }
    let floor = Face {
        axis: up,
        side: Side::Min,
    };
    let mut on_floor = Vec::new();
    basis.for_each_on_face(&grid, floor, |dof| on_floor.push(dof));
    let mut belt = SVector::zeros();
    belt[0] = case.belt;
    let wall = FaceCondition::Frictional {
        coefficient: case.friction,
        velocity: belt,
    };
    let mut stepper = Stepper::new(
        Setup::new(
            grid,
            basis,
            reconstruction,
            NeoHookean {
                moduli: Moduli::from_young(case.youngs_modulus, case.poissons_ratio).unwrap(),
            },
            OnePhase,
            particles,
        )
        .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent)),
    )
    .unwrap();
    let angle = case.slope.to_radians();
    let gravity = |share: f64| {
        let mut g = SVector::<f64, D>::zeros();
        g[0] = case.gravity * angle.sin() * share;
        g[up] = -case.gravity * angle.cos() * share;
        g
    };
    let forcing = |time: f64| {
        let share = if case.ramp > 0.0 {
            (time / case.ramp).min(1.0)
        } else {
            1.0
        };
        Forcing::none()
            .with_body_force(gravity(share))
            .with_face(floor, wall)
    };
    let limit = stepper.critical_step(&forcing(1.0)).unwrap().step;
    let steps = (case.end / (0.5 * limit)).ceil();
    let dt = case.end / steps;
    let mut way = vec![[0.0; 2]; on_floor.len()];
    let mut energy = [0.0, f64::NEG_INFINITY, 0.0];
    for n in 0..steps as usize {
        let total = stepper
            .step_and_measure(dt, dt, &forcing(n as f64 * dt))
            .unwrap()
            .total();
        if n == 0 {
            energy[0] = total;
        }
        energy = [energy[0], energy[1].max(total), total];
        for (way, &dof) in way.iter_mut().zip(&on_floor) {
            let v = stepper.dof_velocities()[dof];
            way[0] += v[0] * dt;
            way[1] += v[up] * dt;
        }
    }
    let under: Vec<_> = way.iter().filter(|way| **way != [0.0; 2]).collect();
    let mean = |k: usize| under.iter().map(|way| way[k]).sum::<f64>() / under.len() as f64;
    let particles = stepper.particles();
    let mass: f64 = particles.mass.iter().sum();
    let total = |values: &[SVector<f64, D>]| {
        let weighted = values.iter().zip(&particles.mass).map(|(v, m)| v * *m);
        weighted.sum::<SVector<f64, D>>() / mass
    };
    let v = total(&particles.velocity);
    let diagnostics = stepper.diagnostics();
    Found {
        slip: mean(0),
        lift: mean(1),
        highest_lift: under.iter().map(|way| way[1]).fold(0.0, f64::max),
        velocity: vec![v[0], v[up]],
        displacement: total(&particles.displacement)[0],
        energy,
        gain: diagnostics.wall_gain,
        work: diagnostics.wall_work,
        impulse_error: diagnostics.conservation.impulse,
        time: steps * dt,
    }
}

/// Relative to the weight's energies, some 1 J: what the solution of the contact problem leaves.
const LEFT: f64 = 1e-8;

fn hold_the_wall(name: &str, found: &Found) {
    assert!(found.gain <= LEFT, "{name}: {found:?}");
    assert!(found.impulse_error < 1e-12, "{name}: {found:?}");
}

/// Calls `check(method, found)` for plain MPM with each basis.
fn with_every_basis(case: &Case, check: impl Fn(&str, &Found)) {
    for (name, found) in [
        ("linear", run::<2, _, _>(Linear, Shepard, case)),
        ("dual domain", run::<2, _, _>(DualDomain::new(), Shepard, case)),
        ("B-spline", run::<2, _, _>(BSpline::<2>, Shepard, case)),
    ] {
        hold_the_wall(name, &found);
        check(name, &found);
    }
}

/// The same for relaxed TLS, whose mapping is asked for its response: three particles a side, up to `end`
/// (s).
fn with_relaxed_fits(case: &Case, end: f64, check: impl Fn(&str, &Found)) {
    let case = &Case {
        particles_per_cell: 3,
        end,
        ..*case
    };
    let linear = RelaxedTaylor::<f64, 2, 6>::for_basis(&Linear);
    let spline = RelaxedTaylor::<f64, 2, 6>::for_basis(&BSpline::<2>);
    for (name, found) in [
        ("linear, relaxed", run::<2, _, _>(Linear, linear, case)),
        ("B-spline, relaxed", run::<2, _, _>(BSpline::<2>, spline, case)),
    ] {
        hold_the_wall(name, &found);
        check(name, &found);
    }
}

#[test]
fn a_flat_block_stays_on_a_slope_less_steep_than_friction_bears() {
    let flat = Case {
        length: 2.0,
        height: 0.25,
        ..BLOCK
    };
    with_every_basis(&flat, |name, found| {
        // Dual domain spreads the stress of the lowest cells over two: 2.1e-5 m.
        let most = if name == "dual domain" { 2.5e-5 } else { 2e-5 };
        assert!(found.slip.abs() <= most, "{name}: {found:?}");
    });
}

#[test]
fn nothing_slips_or_lifts_on_a_gentle_slope() {
    let gentle = Case { slope: 15.0, ..BLOCK };
    let stays = |name: &str, found: &Found| {
        assert!(found.slip.abs() <= 1e-9, "{name}: {found:?}");
        assert!(found.highest_lift <= 1e-9, "{name}: {found:?}");
    };
    with_every_basis(&gentle, stays);
    with_relaxed_fits(&gentle, 0.05, stays);
}

/// The heel of the block slips by some 1e-4 m and then rests.
#[test]
fn a_block_on_a_slope_slips_at_its_heel_and_rests() {
    for end in [0.5, 2.0] {
        with_every_basis(&Case { end, ..BLOCK }, |name, found| {
            assert!(found.slip.abs() < 5.5e-4, "{name} at {end} s: {found:?}");
            assert!(found.velocity[0].abs() < 1e-3, "{name} at {end} s: {found:?}");
        });
    }
}

/// Applied at once gravity lets the block slip and bounce: a finite element model of it slips by 1.9e-3 m in
/// 2 s.
#[test]
fn gravity_applied_at_once_lets_a_block_slip_by_little() {
    for (end, most) in [(0.1, 9e-4), (2.0, 3e-3)] {
        let sudden = Case {
            slope: 15.0,
            ramp: 0.0,
            end,
            ..BLOCK
        };
        with_every_basis(&sudden, |name, found| {
            assert!((0.0..most).contains(&found.slip), "{name} at {end} s: {found:?}");
        });
    }
}

#[test]
fn what_rests_on_a_floor_gains_nothing_and_stays() {
    let rest = Case {
        slope: 0.0,
        friction: 0.3,
        ramp: 0.0,
        end: 1.0,
        ..BLOCK
    };
    with_every_basis(&rest, |name, found| {
        // Gravity releases at most its work on twice the settlement, (rho g h)^2 / (3 E') of the volume: free
        // sides.
        let m = 1e7 / (1.0 - 0.3 * 0.3);
        let released = 2.0 * (2000.0_f64 * 9.81 * 0.5).powi(2) / (3.0 * m) * 0.5;
        assert!(found.energy[1] < released, "{name}: {found:?} {released}");
        assert!(found.lift.abs() <= 1e-5, "{name}: {found:?}");
        assert!(found.highest_lift <= 5e-3 * 0.125, "{name}: {found:?}");
    });
}

#[test]
fn a_sliding_block_is_slowed_by_the_coefficient_times_what_presses() {
    for friction in [0.0, 0.1, 0.3] {
        let sliding = Case {
            friction,
            ramp: 0.0,
            poissons_ratio: 0.0,
            end: 0.7,
            ..BLOCK
        };
        with_every_basis(&sliding, |name, found| {
            let (sin, cos) = 30.0_f64.to_radians().sin_cos();
            let expected = 9.81 * (sin - friction * cos) * found.time;
            let law = (found.velocity[0] + friction * found.velocity[1]) / expected - 1.0;
            // With mu = 0.3 parts of it stick for the first milliseconds.
            let tolerance = if friction < 0.2 { 1e-9 } else { 1e-3 };
            assert!(law.abs() < tolerance, "{name}, mu = {friction}: {law}, {found:?}");
            let way = found.displacement / (expected * found.time / 2.0) - 1.0;
            assert!(way.abs() < 0.01, "{name}, mu = {friction}: {way}, {found:?}");
        });
    }
}

#[test]
fn without_load_energy_never_rises_and_what_is_pulled_off_flies() {
    let fall = Case {
        gravity: 0.0,
        friction: 0.3,
        above: 0.125,
        velocity: [0.5, -1.0],
        youngs_modulus: 1e6,
        poissons_ratio: 0.0,
        end: 0.5,
        ..BLOCK
    };
    with_every_basis(&fall, |name, found| {
        assert!(
            found.energy[1] <= found.energy[0] * (1.0 + 1e-3),
            "{name}: {found:?}"
        );
        assert!(found.velocity[1] > 0.5, "it comes back, {name}: {found:?}");
    });
    let away = Case {
        above: 0.0,
        velocity: [0.0, 1.0],
        end: 0.2,
        ..fall
    };
    with_every_basis(&away, |name, found| {
        assert!((found.velocity[1] - 1.0).abs() < 1e-12, "{name}: {found:?}");
        assert_eq!(found.work, 0.0, "{name}");
    });
}

/// What holds for plain MPM, longer and for relaxed TLS: minutes.
#[test]
#[ignore = "minutes: each step with a wall asks relaxed TLS for a dozen mappings"]
fn walls_meet_relaxed_fits_as_they_meet_plain_mpm() {
    let gentle = Case { slope: 15.0, ..BLOCK };
    with_relaxed_fits(&gentle, 0.3, |name, found| {
        assert!(
            found.slip.abs() <= 1e-9 && found.highest_lift <= 1e-9,
            "{name}: {found:?}"
        );
    });
    let slides = Case {
        friction: 0.1,
        ramp: 0.0,
        poissons_ratio: 0.0,
        ..BLOCK
    };
    with_relaxed_fits(&slides, 0.3, |name, found| {
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let expected = 9.81 * (sin - 0.1 * cos) * found.time;
        let law = (found.velocity[0] + 0.1 * found.velocity[1]) / expected - 1.0;
        assert!(law.abs() < 1e-6, "{name}: {law} {found:?}");
    });
    let rest = Case {
        slope: 0.0,
        friction: 0.3,
        ramp: 0.0,
        ..BLOCK
    };
    with_relaxed_fits(&rest, 0.3, |name, found| {
        assert!(found.lift.abs() <= 1e-5, "{name}: {found:?}");
    });
}

/// A belt carries a block along with mu g until it has the belt's velocity.
#[test]
fn a_belt_carries_a_block_along() {
    let belt = Case {
        slope: 0.0,
        friction: 0.2,
        belt: 1.0,
        end: 0.5,
        ..BLOCK
    };
    with_every_basis(&belt, |name, found| {
        // Gravity comes on within 0.2 s: mu g (t - 0.1 s), and as much beside as the block still moves up.
        let expected = 0.2 * (9.81 * (found.time - 0.1) + found.velocity[1]);
        assert!(
            (found.velocity[0] - expected).abs() < 2e-3,
            "{name}: {found:?} {expected}"
        );
        assert!(found.work > 0.0, "{name}: {found:?}");
    });
    with_every_basis(&Case { end: 1.2, ..belt }, |name, found| {
        assert!((found.velocity[0] - 1.0).abs() < 0.05, "{name}: {found:?}");
    });
}

#[test]
fn in_space_a_block_rests_slides_and_stays_too() {
    let each = |case: &Case| {
        [
            run::<3, _, _>(Linear, Shepard, case),
            run::<3, _, _>(BSpline::<2>, Shepard, case),
        ]
    };
    let slides = Case {
        ramp: 0.0,
        friction: 0.1,
        poissons_ratio: 0.0,
        end: 0.2,
        ..BLOCK
    };
    for found in each(&slides) {
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let expected = 9.81 * (sin - 0.1 * cos) * found.time;
        let law = (found.velocity[0] + 0.1 * found.velocity[1]) / expected - 1.0;
        assert!(law.abs() < 1e-9, "{found:?}");
        assert!(found.gain <= 1e-8 && found.impulse_error < 1e-12, "{found:?}");
    }
    let stays = Case {
        slope: 15.0,
        end: 0.3,
        ..BLOCK
    };
    for found in each(&stays) {
        assert!(
            found.slip.abs() <= 1e-9 && found.highest_lift <= 1e-9,
            "{found:?}"
        );
    }
}
