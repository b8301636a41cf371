//! What steppers with domains keep: exact solutions, conservation, and the same whatever the way.

use std::any::type_name;

use materialpoint::basis::{BasisFamily, Linear};
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli, NeoHookean};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{OnePhase, TwoPhase};
use materialpoint::reconstruction::{Reconstruction, RelaxedTaylor, Shepard, Taylor};
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use nalgebra::{SMatrix, SVector, vector};

use super::bodies::{Body, OneByOne, assert_near, particles, state, stepper};
use super::edges::Corners;
use super::gimp::{self, Gimp};

/// A bar in balance flies through the grid. The means of gradients over boxes that fill it sum up to those
/// over the bar, which its ends' tractions balance: nothing but round-off, over 800 steps, of forces of unit
/// size in cells of four particles. At points the forces are off by shares of one.
#[test]
fn a_bar_in_balance_crosses_cells_without_noise() {
    let (over_particles, at_points) = (gimp::run(Gimp).unwrap(), gimp::run(Linear).unwrap());
    assert!(over_particles < 1e-11, "{over_particles:e}");
    assert!(gimp::run(OneByOne(Gimp)).unwrap() < 1e-11);
    assert!(at_points > 0.1, "{at_points:e}");
}

/// So it rests between walls, which its boxes touch.
#[test]
fn a_bar_in_balance_rests_between_walls() {
    let grid = Grid::new(vector![0.0], vector![6.0], [6]).unwrap();
    let points: Vec<_> = (0..20)
        .map(|p| (vector![0.3 * (f64::from(p) + 0.5)], 0.3))
        .collect();
    let mut particles = Particles::at_rest(&points, 1.0);
    particles.stress.iter_mut().for_each(|stress| stress[0] = -3.0);
    let mut stepper = Stepper::new(Setup::new(
        grid,
        Gimp,
        Shepard,
        LinearElastic {
            moduli: Moduli::uniaxial(10.0).unwrap(),
        },
        OnePhase,
        particles,
    ))
    .unwrap();
    let ends = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
    let hold = |forcing: Forcing<f64, 1>, end| forcing.with_face(end, FaceCondition::fixed());
    let forcing = ends.into_iter().fold(Forcing::none(), hold);
    for _ in 0..100 {
        stepper.step(0.01, &forcing).unwrap();
    }
    let fastest = stepper
        .particles()
        .velocity
        .iter()
        .map(|v| v[0].abs())
        .fold(0.0, f64::max);
    assert!(fastest < 1e-13, "{fastest:e}");
}

fn after<const D: usize, B, R>(mut stepper: Body<D, B, R>, steps: usize) -> Body<D, B, R>
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
{
    for _ in 0..steps {
        stepper.step(0.01, &Forcing::none()).unwrap();
    }
    assert!(stepper.diagnostics().grid_crossings > 0);
    stepper
}

/// Four or eight particles at once, one by one, and in another order at the start; mass and momentum mapped
/// to the last digits, and changed by nothing but what acts.
fn same_by_all_ways<const D: usize, R>(reconstruction: R, [cells, per_cell]: [usize; 2])
where
    R: Reconstruction<f64, D> + Clone,
{
    let body = particles::<D>(cells, per_cell);
    let in_packs = after(stepper(Gimp, reconstruction.clone(), body.clone()), 40);
    let errors = in_packs.diagnostics().conservation;
    for error in [errors.mass, errors.momentum_scaled, errors.impulse] {
        assert!(error < 1e-13, "{D}: {errors:?}");
    }
    let in_packs = state(in_packs);
    let one_by_one = after(stepper(OneByOne(Gimp), reconstruction.clone(), body.clone()), 40);
    assert_near(
        &in_packs,
        &state(one_by_one),
        1e-11,
        &format!("one by one, {}", type_name::<R>()),
    );
    let (grid, all) = body;
    let count = all.len();
    // A stride that shares no factor with the count visits each once.
    let stride = (7..)
        .find(|stride| (2..=*stride).all(|k| count % k > 0 || stride % k > 0))
        .unwrap();
    let mut shuffled = all.clone();
    for p in 0..count {
        let from = p * stride % count;
        shuffled.initial_position[p] = all.initial_position[from];
        shuffled.position[p] = all.position[from];
        shuffled.velocity[p] = all.velocity[from];
    }
    let found = state(after(stepper(Gimp, reconstruction, (grid, shuffled)), 40));
    let expected: Vec<_> = (0..count).map(|p| in_packs[p * stride % count].clone()).collect();
    assert_near(
        &expected,
        &found,
        1e-11,
        &format!("in another order, {}", type_name::<R>()),
    );
}

#[test]
fn steppers_are_the_same_by_all_ways_and_keep_momentum() {
    same_by_all_ways::<1, _>(Shepard, [12, 4]);
    same_by_all_ways::<1, _>(Shepard, [9, 9]);
    same_by_all_ways::<2, _>(Shepard, [7, 2]);
    same_by_all_ways::<2, _>(Shepard, [6, 3]);
    same_by_all_ways::<3, _>(Shepard, [5, 2]);
    same_by_all_ways::<1, _>(Taylor::<f64, 1, 3>::new(), [9, 4]);
    same_by_all_ways::<1, _>(RelaxedTaylor::<f64, 1, 3>::for_degree(1), [9, 4]);
    same_by_all_ways::<2, _>(Taylor::<f64, 2, 6>::new(), [7, 3]);
    same_by_all_ways::<3, _>(Taylor::<f64, 3, 10>::new(), [5, 3]);
}

/// Solid and liquid.
#[test]
fn so_are_two_phases() {
    fn run<B: BasisFamily<f64, 1>, R: Reconstruction<f64, 1>>(basis: B, reconstruction: R) -> Vec<Vec<f64>> {
        let (grid, particles) = particles::<1>(10, 4);
        let mut stepper = Stepper::new(Setup::new(
            grid,
            basis,
            reconstruction,
            LinearElastic {
                moduli: Moduli::uniaxial(20.0).unwrap(),
            },
            TwoPhase {
                porosity: 0.4,
                solid_density: 2.0,
                liquid_density: 1.0,
                liquid_bulk_modulus: 50.0,
                permeability: 1e-2,
                permeability_exponent: 0.0,
                gravity: 10.0,
                drag: Default::default(),
            },
            particles.into_cast(),
        ))
        .unwrap();
        for _ in 0..40 {
            stepper.step(0.005, &Forcing::none()).unwrap();
        }
        let all = stepper.particles();
        let of = |p: usize| {
            let liquid = &all.phase[p];
            vec![
                all.position[p][0],
                all.stress[p][0],
                liquid.velocity[0],
                liquid.pressure,
            ]
        };
        (0..all.len()).map(of).collect()
    }
    assert_near(
        &run(Gimp, Shepard),
        &run(OneByOne(Gimp), Shepard),
        1e-11,
        "Shepard",
    );
    let taylor = Taylor::<f64, 1, 3>::new;
    assert_near(
        &run(Gimp, taylor()),
        &run(OneByOne(Gimp), taylor()),
        1e-11,
        "Taylor",
    );
    let relaxed = || RelaxedTaylor::<f64, 1, 3>::for_degree(1);
    assert_near(
        &run(Gimp, relaxed()),
        &run(OneByOne(Gimp), relaxed()),
        1e-10,
        "relaxed",
    );
}

/// 19 000 particles make several spans.
#[test]
fn any_number_of_threads_gives_the_same_bits() {
    fn run<B: BasisFamily<f64, 2>>(basis: B, threads: usize) -> Vec<Vec<f64>> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| state(after(stepper(basis, Shepard, particles::<2>(49, 3)), 24)))
    }
    let one = run(Gimp, 1);
    assert!(run(Gimp, 2) == one && run(Gimp, 3) == one);
    assert!(run(Corners, 1) == run(Corners, 3));
}

/// Loads of single particles that are one for all are an acceleration, whatever the layout.
#[test]
fn a_body_force_of_each_particle_accelerates_all_alike() {
    let (grid, mut all) = particles::<2>(8, 2);
    all.velocity.fill(vector![0.5, 0.25]);
    let mut stepper = stepper(Gimp, Shepard, (grid, all));
    let force = vector![0.2, -0.1];
    stepper.set_body_forces(|_| force);
    for _ in 0..50 {
        stepper.step(0.02, &Forcing::none()).unwrap();
    }
    for v in &stepper.particles().velocity {
        assert!((v - (vector![0.5, 0.25] + force)).norm() < 1e-12, "{v}");
    }
}

/// The critical step parts motions that stay from those that grow, and the bound is below it: where domains
/// fill cells, and where they lie across nodes, so that functions over them and at points differ.
#[test]
fn the_critical_step_is_that_of_the_scheme() {
    [0.0, 0.15].into_iter().for_each(critical_step_of_a_body_beside);
}

fn critical_step_of_a_body_beside(shift: f64) {
    let body = || {
        let (grid, mut all) = particles::<1>(10, 3);
        all.position.iter_mut().for_each(|x| x[0] += shift);
        all.initial_position = all.position.clone();
        for (p, v) in all.velocity.iter_mut().enumerate() {
            v[0] = 1e-6 * f64::from(p as u32 * 37 % 11) - 5e-6;
        }
        stepper(Gimp, Shepard, (grid, all))
    };
    let none = Forcing::none();
    let critical = body().critical_step(&none).unwrap().step;
    let bound = body().stiffness_bound(&none);
    let proved = body().largest_step(bound).unwrap().step;
    assert!(proved <= critical * (1.0 + 1e-4), "{proved} {critical}");
    let fastest = |share: f64| {
        let mut stepper = body();
        for _ in 0..600 {
            if stepper.step(share * critical, &none).is_err() {
                return f64::INFINITY;
            }
        }
        let speeds = stepper.particles().velocity.iter().map(|v| v[0].abs());
        speeds.fold(0.0, f64::max)
    };
    assert!(fastest(0.98) < 1e-4, "{:e}", fastest(0.98));
    assert!(fastest(1.03) > 1e-3, "{:e}", fastest(1.03));
}

/// A block that slides on a floor: the wall gives no more than what it says, so all that touches it does so
/// with the functions over the particles.
#[test]
fn a_wall_that_rubs_keeps_the_balance() {
    let (grid, mut all) = particles::<2>(8, 2);
    for (x, v) in all.position.iter_mut().zip(&mut all.velocity) {
        x[1] -= 1.0;
        *v = vector![1.0, -0.1];
    }
    all.initial_position = all.position.clone();
    let floor = Face {
        axis: 1,
        side: Side::Min,
    };
    let wall = FaceCondition::Frictional {
        coefficient: 0.3,
        velocity: SVector::zeros(),
    };
    let forcing = Forcing::none()
        .with_body_force(vector![0.0, -0.5])
        .with_face(floor, wall);
    for way in [false, true] {
        let (mass, work) = match way {
            true => rub(stepper(Gimp, Shepard, (grid.clone(), all.clone())), &forcing),
            false => rub(
                stepper(OneByOne(Gimp), Shepard, (grid.clone(), all.clone())),
                &forcing,
            ),
        };
        assert!(mass < 1e-13 && work < 0.0, "{mass:e} {work:e}");
    }
}

/// Velocities mapped from what the particles have after a step obey the wall: they pass each impulse on by
/// the functions over the particles, with which it was solved for. With those at points they would enter the
/// wall here, by 1e-2 of the speed, though momentum balances all the same.
#[test]
fn after_a_step_no_velocity_leads_into_the_wall() {
    let (grid, mut all) = particles::<2>(8, 2);
    for (p, (x, v)) in all.position.iter_mut().zip(&mut all.velocity).enumerate() {
        x[1] -= 1.0;
        x[0] += 0.15;
        *v = vector![1.0, -0.2 + 0.05 * f64::from(p as u32 % 7)];
    }
    all.initial_position = all.position.clone();
    let floor = Face {
        axis: 1,
        side: Side::Min,
    };
    let wall = FaceCondition::Frictional {
        coefficient: 0.3,
        velocity: SVector::zeros(),
    };
    let forcing = Forcing::none()
        .with_body_force(vector![0.0, -0.5])
        .with_face(floor, wall);
    let mut body = stepper(Gimp, Shepard, (grid.clone(), all.clone()));
    body.step(0.01, &forcing).unwrap();
    let after = body.into_setup().particles;
    let mut on_floor = vec![false; Gimp.dof_count(&grid)];
    Gimp.for_each_on_face(&grid, floor, |dof| on_floor[dof] = true);
    let mut mapped = vec![(0.0, SVector::zeros()); on_floor.len()];
    for (p, x) in all.position.iter().enumerate() {
        let cell = grid.locate(x).unwrap();
        let half = SMatrix::from_diagonal(&after.domains.half_lengths[p]);
        Gimp.for_each_over(&grid, &cell, x, &half, |i, phi, _| {
            mapped[i].0 += after.mass[p] * phi;
            mapped[i].1 += after.velocity[p] * (after.mass[p] * phi);
        });
    }
    let mut pressed = 0;
    for (dof, (mass, momentum)) in mapped.iter().enumerate() {
        if on_floor[dof] && *mass > 0.0 {
            let normal = momentum[1] / mass;
            assert!(normal > -1e-10, "DOF {dof}: {normal:e}");
            pressed += usize::from(normal < 1e-10);
        }
    }
    assert!(pressed > 3, "{pressed}");
}

/// Error of the balance of momentum, and the wall's work.
fn rub<B: BasisFamily<f64, 2>>(mut stepper: Body<2, B, Shepard>, forcing: &Forcing<f64, 2>) -> (f64, f64) {
    for _ in 0..100 {
        stepper.step(0.01, forcing).unwrap();
    }
    let found = stepper.diagnostics();
    (found.conservation.impulse, found.wall_work)
}

/// A stepper goes on from a checkpoint to the bit, and from its setup as it would have.
#[test]
fn domains_go_with_the_particles() {
    fn run<B: BasisFamily<f64, 2>>(basis: B) {
        let make = || stepper(basis.clone(), Shepard, particles::<2>(8, 2));
        let mut whole = after(make(), 30);
        let (mut bytes, mut restored) = (Vec::new(), make());
        whole.save(&mut bytes).unwrap();
        restored.restore(&mut &bytes[..]).unwrap();
        assert_eq!(whole.particles().domains, restored.particles().domains);
        let mut again = Stepper::new(whole.clone().into_setup()).unwrap();
        whole = after(whole, 60);
        restored = after(restored, 60);
        again = after(again, 60);
        assert_eq!(whole.particles().domains, restored.particles().domains);
        let (whole, restored) = (state(whole), state(restored));
        assert!(whole == restored);
        assert_near(&whole, &state(again), 1e-11, "from its setup");
    }
    run(Gimp);
    run(Corners);
}

/// Not where particles cross cells and are put in order again either.
#[test]
fn no_step_over_domains_allocates() {
    fn check<B: BasisFamily<f64, 2>>(basis: B) {
        let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let mut body = stepper(basis, Shepard, particles::<2>(9, 3));
        let steps = one_thread.install(|| {
            allocation_counter::measure(|| {
                for _ in 0..100 {
                    body.step(0.01, &Forcing::none()).unwrap();
                }
            })
        });
        assert!(body.diagnostics().grid_crossings > 100);
        assert_eq!(steps.count_total, 0);
    }
    check(Gimp);
    check(Corners);
}

/// Domains count as memory.
#[test]
fn bytes_count_domains() {
    let bytes = |with: bool| {
        let mut all = particles::<2>(8, 2).1;
        if with {
            all.domains.half_lengths = vec![SVector::zeros(); all.len()];
        }
        all.bytes()
    };
    assert_eq!(bytes(true) - bytes(false), 16 * particles::<2>(8, 2).1.len());
}

/// A stencil begins a node before its cell, and that may lie before the window of a body that is small in its
/// grid, with more particles than one span holds: a plate in uniform flight keeps its velocity.
#[test]
fn a_window_may_begin_within_a_stencil() {
    let grid = Grid::new(vector![0.0, 0.0], vector![200.0, 200.0], [200, 200]).unwrap();
    let points = lattice(&grid, &vector![60.0, 60.0], &vector![96.0, 96.0], [2, 2]);
    assert!(points.len() > 4096);
    let mut particles = Particles::at_rest(&points, 1.0);
    particles.velocity.fill(vector![-3.0, -2.0]);
    let law = NeoHookean {
        moduli: Moduli::from_young(10.0, 0.3).unwrap(),
    };
    let setup = Setup::new(grid, Gimp, Shepard, law, OnePhase, particles);
    let mut stepper = Stepper::new(setup).unwrap();
    for _ in 0..60 {
        stepper.step(0.05, &Forcing::none()).unwrap();
    }
    for v in &stepper.particles().velocity {
        assert!((v - vector![-3.0, -2.0]).norm() < 1e-12, "{v}");
    }
}
