//! Transfers from the grid: PIC and APIC, as `examples/apic.rs` writes them.

use materialpoint::basis::{BSpline, BasisFamily, DualDomain, Linear};
use materialpoint::error::{SetupError, StepError};
use materialpoint::grid::{Cell, Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli, NeoHookean};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{Drag, OnePhase, TwoPhase};
use materialpoint::reconstruction::{RelaxedTaylor, Shepard, SubPoints, Taylor};
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Simulation, Stepper};
use materialpoint::transfer::{Flip, Transfer};
use nalgebra::{SMatrix, SVector, matrix, vector};

use crate::examples::apic::{Affine, Apic, Pic, run, spin};

fn own(particle: &Affine<f64, 2>) -> SMatrix<f64, 2, 2> {
    particle.moment
}

/// APIC keeps angular momentum to round-off with splines, whose second moment is the same everywhere but near
/// the ends of the grid, and PIC keeps none: in each step it loses what particles would hold about their own
/// places, a share of the order of `(h/R)^2`, so that after a thousand steps next to nothing is left.
#[test]
fn apic_keeps_angular_momentum_and_pic_loses_it() {
    let [flip, pic, apic] = run().unwrap();
    assert!((apic.angular_momentum - 1.0).abs() < 1e-11, "{apic:?}");
    assert!(pic.angular_momentum.abs() < 1e-2, "{pic:?}");
    // FLIP's accelerations lose none, but its particles move with velocities that are mapped again and are
    // not their own: a few per cent in a turn of 6283 steps.
    assert!((0.9..0.99).contains(&flip.angular_momentum), "{flip:?}");
    for spin in [flip, pic, apic] {
        assert!(spin.momentum < 1e-13, "{spin:?}");
    }
    let cubic = spin(BSpline::<3>, Apic, own, 1.0).unwrap();
    assert!((cubic.angular_momentum - 1.0).abs() < 1e-11, "{cubic:?}");
    // Hats spread the less the nearer a particle is to a node: what it holds about its place changes with it.
    // A part of a turn only: some hats see next to no mass at the rim and are thrown by any force, which was
    // the reason for modified update stress last.
    let hats = spin(Linear, Apic, own, 0.005).unwrap().angular_momentum;
    assert!((1e-6..1e-2).contains(&(hats - 1.0).abs()), "{hats}");
}

/// A block of cells filled with particles, stress-free and without stiffness to speak of.
fn block<const D: usize, B, X>(
    basis: B,
    transfer: X,
    gradient: SMatrix<f64, D, D>,
) -> (Block<D, B, X>, SVector<f64, D>)
where
    B: BasisFamily<f64, D>,
    X: Transfer<f64, D>,
{
    let grid = Grid::new(SVector::zeros(), SVector::repeat(8.0), [8; D]).unwrap();
    let points = lattice(&grid, &SVector::repeat(1.0), &SVector::repeat(7.0), [3; D]);
    let mut particles: Particles<f64, D> = Particles::at_rest(&points, 1e3);
    let speed = SVector::from_fn(|a, _| 0.3 + a as f64);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        *v = speed + gradient * x;
    }
    let law = LinearElastic {
        moduli: Moduli::from_young(1e-9, 0.0).unwrap(),
    };
    let setup = Setup::new(grid, basis, Shepard, law, OnePhase, particles);
    (Stepper::new(setup.with_transfer(transfer)).unwrap(), speed)
}

type Block<const D: usize, B, X> = Stepper<f64, D, B, Shepard, LinearElastic<f64>, OnePhase, X>;

/// A linear field of velocity comes back from the grid as it was: where the DOFs about a particle are full of
/// particles that know it, at the second step.
fn keeps_linear_fields<const D: usize, B: BasisFamily<f64, D>>(basis: B) {
    let gradient = SMatrix::<f64, D, D>::from_fn(|c, a| 0.1 * (1.0 + c as f64) - 0.07 * a as f64);
    let (start, speed) = block(basis.clone(), Apic, gradient);
    let memory = vec![
        Affine {
            gradient,
            moment: SMatrix::zeros(),
        };
        start.particles().len()
    ];
    let setup = start.into_setup().with_memory(memory);
    let before = setup.particles.position.clone();
    let mut stepper = Stepper::new(setup).unwrap();
    stepper.step(1e-3, &Forcing::none()).unwrap();
    let numbers: Vec<usize> = match stepper.numbers() {
        Some(numbers) => numbers.iter().map(|&n| n as usize).collect(),
        None => (0..before.len()).collect(),
    };
    for (p, &number) in numbers.iter().enumerate() {
        let x = before[number];
        let (v, own) = (stepper.particles().velocity[p], stepper.memory()[p]);
        assert!((v - speed - gradient * x).norm() < 1e-12, "{D}: {x}");
        assert!(
            (own.gradient - gradient).norm() < 1e-10,
            "{D}: {x} {}",
            own.gradient
        );
    }
}

#[test]
fn linear_velocities_come_back_as_they_were() {
    keeps_linear_fields::<1, _>(Linear);
    keeps_linear_fields::<1, _>(BSpline::<2>);
    keeps_linear_fields::<1, _>(BSpline::<3>);
    keeps_linear_fields::<1, _>(DualDomain::new());
    keeps_linear_fields::<2, _>(Linear);
    keeps_linear_fields::<2, _>(BSpline::<2>);
    keeps_linear_fields::<2, _>(DualDomain::new());
    keeps_linear_fields::<3, _>(Linear);
    keeps_linear_fields::<3, _>(BSpline::<2>);
}

/// In single precision too a linear field comes back to some rounding units, however far from the grid's
/// beginning the bar lies: distances to DOFs are taken from the particle's cell.
#[test]
fn linear_velocities_come_back_far_from_the_origin_in_single_precision() {
    for cells in [16_usize, 4096, 100_000] {
        let grid = Grid::<f32, 1>::new(vector![0.0], vector![cells as f32], [cells]).unwrap();
        let end = cells as f32 - 1.0;
        let points = lattice(&grid, &vector![end - 14.0], &vector![end], [3]);
        let mut particles: Particles<f32, 1> = Particles::at_rest(&points, 1e3);
        let field = |x: f32| 0.25 + 0.1 * (x - end);
        for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
            v[0] = field(x[0]);
        }
        let before = particles.position.clone();
        let moduli = Moduli::uniaxial(1e-9).unwrap();
        let setup = Setup::new(
            grid,
            BSpline::<2>,
            Shepard,
            LinearElastic { moduli },
            OnePhase,
            particles,
        );
        let memory = Affine {
            gradient: matrix![0.1_f32],
            moment: matrix![0.0],
        };
        let setup = setup.with_transfer(Apic).with_memory(vec![memory; before.len()]);
        let mut stepper = Stepper::new(setup).unwrap();
        stepper.step(1e-3, &Forcing::none()).unwrap();
        for (x, v) in before.iter().zip(&stepper.particles().velocity) {
            assert!((v[0] - field(x[0])).abs() < 2e-6, "{cells} cells, {x}: {v}");
        }
    }
}

/// A bar between walls, pulled by its own weight: what particles gain is the impulse of weight and walls, to
/// round-off.
fn impulse<X: Transfer<f64, 2>>(transfer: X) -> f64 {
    let grid = Grid::new(vector![0.0, 0.0], vector![2.0, 1.0], [8, 4]).unwrap();
    let points = lattice(&grid, grid.min(), grid.max(), [2, 2]);
    let mut particles = Particles::at_rest(&points, 1e3);
    particles.velocity.fill(vector![1.0, -0.5]);
    let law = NeoHookean {
        moduli: Moduli::from_young(1e6, 0.3).unwrap(),
    };
    let setup = Setup::new(grid, BSpline::<2>, Shepard, law, OnePhase, particles);
    let mut stepper = Stepper::new(setup.with_transfer(transfer)).unwrap();
    let mut forcing = Forcing::none().with_body_force(vector![0.0, -9.81]);
    for (axis, side) in [(0, Side::Min), (0, Side::Max), (1, Side::Min)] {
        forcing = forcing.with_face(Face { axis, side }, FaceCondition::roller(axis));
    }
    for _ in 0..200 {
        stepper.step(1e-3, &forcing).unwrap();
    }
    stepper.diagnostics().conservation.impulse
}

#[test]
fn momentum_changes_by_the_impulses_of_weight_and_walls() {
    for impulse in [impulse(Flip), impulse(Pic), impulse(Apic)] {
        assert!(impulse > 0.0 && impulse < 1e-13, "{impulse:e}");
    }
}

/// A basis that says nothing of products: sweeps take one particle after another.
#[derive(Clone, Copy, Debug)]
struct PointByPoint;

impl BasisFamily<f64, 2> for PointByPoint {
    fn degree(&self) -> usize {
        2
    }

    fn dofs(&self, grid: &Grid<f64, 2>) -> [usize; 2] {
        BSpline::<2>.dofs(grid)
    }

    fn for_each(
        &self,
        grid: &Grid<f64, 2>,
        cell: &Cell<2>,
        x: &SVector<f64, 2>,
        f: impl FnMut(usize, f64, SVector<f64, 2>),
    ) {
        BSpline::<2>.for_each(grid, cell, x, f);
    }

    fn interpolation_point(&self, grid: &Grid<f64, 2>, dof: usize) -> SVector<f64, 2> {
        BSpline::<2>.interpolation_point(grid, dof)
    }
}

/// A disc that turns and flies, in no order if `stride` is not one.
fn disc<B: BasisFamily<f64, 2>>(basis: B, stride: usize) -> Flying<B> {
    let grid = Grid::new(vector![0.0, 0.0], vector![40.0, 40.0], [40, 40]).unwrap();
    let mut points = lattice(&grid, &vector![4.0, 4.0], &vector![28.0, 28.0], [3, 3]);
    let count = points.len();
    points = (0..count).map(|p| points[p * stride % count]).collect();
    let mut particles = Particles::at_rest(&points, 1.0);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        *v = vector![3.0 - 0.2 * (x[1] - 16.0), 2.0 + 0.2 * (x[0] - 16.0)];
    }
    let law = NeoHookean {
        moduli: Moduli::from_young(100.0, 0.3).unwrap(),
    };
    let setup = Setup::new(grid, basis, Shepard, law, OnePhase, particles);
    Stepper::new(setup.with_transfer(Apic)).unwrap()
}

type Flying<B> = Stepper<f64, 2, B, Shepard, NeoHookean<f64>, OnePhase, Apic>;

fn fly<B: BasisFamily<f64, 2>>(mut stepper: Flying<B>, threads: usize) -> Particles<f64, 2> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.unwrap().install(|| {
        for _ in 0..60 {
            stepper.step(0.02, &Forcing::none()).unwrap();
        }
        assert!(stepper.diagnostics().grid_crossings > 1000);
        Simulation::particles(&stepper)
    })
}

fn furthest(a: &Particles<f64, 2>, b: &Particles<f64, 2>, stride: usize) -> f64 {
    let count = a.len();
    (0..count)
        .map(|p| (a.velocity[p * stride % count] - b.velocity[p]).norm())
        .fold(0.0, f64::max)
}

#[test]
fn threads_order_and_packs_change_nothing() {
    let one = fly(disc(BSpline::<2>, 1), 1);
    let three = fly(disc(BSpline::<2>, 1), 3);
    assert!(one.velocity == three.velocity && one.position == three.position);
    let shuffled = fly(disc(BSpline::<2>, 1009), 1);
    assert!(furthest(&one, &shuffled, 1009) < 1e-11);
    let points = fly(disc(PointByPoint, 1), 1);
    let difference = furthest(&one, &points, 1);
    assert!(difference > 0.0 && difference < 1e-11, "{difference:e}");
}

#[test]
fn what_is_remembered_is_saved_and_handed_back() {
    let none = Forcing::none();
    let mut stepper = disc(BSpline::<2>, 7);
    (0..20).for_each(|_| stepper.step(0.02, &none).unwrap());
    let mut bytes = Vec::new();
    stepper.save(&mut bytes).unwrap();
    let mut restored = disc(BSpline::<2>, 7);
    restored.restore(&mut &bytes[..]).unwrap();
    let mut handed = Stepper::new(stepper.clone().into_setup()).unwrap();
    for body in [&mut stepper, &mut restored, &mut handed] {
        (0..20).for_each(|_| body.step(0.02, &none).unwrap());
    }
    let [a, b, c] = [stepper, restored, handed].map(|body| Simulation::particles(&body));
    assert!(a.velocity == b.velocity);
    assert!(furthest(&a, &c, 1) < 1e-11);
    let forgetful = disc(BSpline::<2>, 7)
        .into_setup()
        .with_memory(vec![Affine::default(); 3]);
    let refused = Stepper::new(forgetful);
    assert!(matches!(refused, Err(SetupError::Lengths { name: "memory", .. })));
}

/// Everything but particle sums, one phase, lumped masses and walls that do not rub is refused by name.
#[test]
fn what_does_not_go_with_the_grids_velocities_is_refused() {
    let parts = || {
        let grid = Grid::new(vector![0.0, 0.0], vector![4.0, 4.0], [4, 4]).unwrap();
        let points = lattice(&grid, &vector![1.0, 1.0], &vector![3.0, 3.0], [2, 2]);
        let moduli = Moduli::from_young(1e3, 0.0).unwrap();
        (grid, points, LinearElastic { moduli })
    };
    let refused = |found: Option<SetupError>| matches!(found, Some(SetupError::FromGrid { .. }));
    let (grid, points, law) = parts();
    let particles = Particles::at_rest(&points, 1.0);
    let setup = Setup::new(grid, Linear, Taylor::<f64, 2, 6>::new(), law, OnePhase, particles);
    assert!(refused(Stepper::new(setup.with_transfer(Pic)).err()));
    let (grid, points, law) = parts();
    let particles = Particles::at_rest(&points, 1.0);
    let relaxed = RelaxedTaylor::<f64, 2, 6>::for_basis(&Linear);
    let setup = Setup::new(grid, Linear, relaxed, law, OnePhase, particles);
    assert!(refused(Stepper::new(setup.with_transfer(Apic)).err()));
    let (grid, points, law) = parts();
    let phase = TwoPhase {
        porosity: 0.4,
        solid_density: 2650.0,
        liquid_density: 1e3,
        liquid_bulk_modulus: 2.2e6,
        permeability: 1e-2,
        permeability_exponent: 0.0,
        gravity: 10.0,
        drag: Drag::Implicit,
    };
    let setup = Setup::new(
        grid,
        Linear,
        Shepard,
        law,
        phase,
        Particles::at_rest(&points, 1e3),
    );
    assert!(refused(Stepper::new(setup.with_transfer(Apic)).err()));

    let (grid, points, law) = parts();
    let particles = Particles::at_rest(&points, 1.0);
    let setup = Setup::new(
        grid,
        DualDomain::new(),
        SubPoints::new(2).unwrap(),
        law,
        OnePhase,
        particles,
    );
    let mut stepper = Stepper::new(setup.with_transfer(Apic)).unwrap();
    let face = Face {
        axis: 1,
        side: Side::Min,
    };
    let rubs = FaceCondition::Frictional {
        coefficient: 0.5,
        velocity: vector![0.0, 0.0],
    };
    let forcing = Forcing::none().with_face(face, rubs);
    let found = stepper.step(1e-3, &forcing);
    assert_eq!(found, Err(StepError::FrictionFromGrid { face }));
    stepper.step(1e-3, &Forcing::none()).unwrap();
}

/// A DOF's place is where linear functions are reproduced about, whatever the basis says of interpolation.
#[test]
fn a_matrix_by_its_moments_is_the_gradient_for_hats() {
    let gradient = matrix![0.3, -0.2; 0.5, 0.1];
    let (mut stepper, _) = block(Linear, Probe, gradient);
    stepper.step(1e-3, &Forcing::none()).unwrap();
    for (by_moments, by_slopes) in stepper.memory() {
        assert!(
            (by_moments - by_slopes).norm() < 1e-11,
            "{by_moments} {by_slopes}"
        );
    }
}

/// Remembers both gradients that a particle can take.
#[derive(Clone, Copy, Debug)]
struct Probe;

impl Transfer<f64, 2> for Probe {
    const FROM_GRID: bool = true;
    type Particle = (SMatrix<f64, 2, 2>, SMatrix<f64, 2, 2>);

    fn take(
        &self,
        seen: &materialpoint::transfer::GridVelocity<f64, 2>,
        velocity: &mut SVector<f64, 2>,
        both: &mut Self::Particle,
    ) {
        *velocity = seen.velocity;
        *both = (seen.affine(), seen.gradient);
    }
}

/// What bounds a step of FLIP does not bound one of these: PIC with hats and one particle a cell grows from
/// 0.71 of it on. Nothing is said rather than something wrong.
#[test]
fn no_step_is_said_to_be_stable() {
    let (mut stepper, _) = block(BSpline::<2>, Pic, SMatrix::<f64, 2, 2>::zeros());
    let forcing = Forcing::none();
    assert!(stepper.critical_step(&forcing).is_none());
    assert!(stepper.stiffness(&forcing).is_none() && stepper.largest_step(1.0).is_none());
    assert!(stepper.stiffness_bound(&forcing).is_infinite() && !stepper.stiffness_is_bound());
    let (mut flip, _) = block(BSpline::<2>, Flip, SMatrix::<f64, 2, 2>::zeros());
    assert!(flip.critical_step(&forcing).is_some() && flip.stiffness(&forcing).is_some());
}

/// Velocities that are written hold if what was remembered of others is written too.
#[test]
fn what_is_remembered_can_be_written() {
    let speed = |forget: bool| {
        let mut stepper = disc(BSpline::<2>, 1);
        (0..5).for_each(|_| stepper.step(0.02, &Forcing::none()).unwrap());
        let stop = |particles: &mut Particles<f64, 2, _>| particles.velocity.fill(vector![0.0, 0.0]);
        stepper.edit_particles(stop).unwrap();
        if forget {
            stepper.edit_memory(|memory| memory.fill(Affine::default()));
        }
        stepper.step(1e-9, &Forcing::none()).unwrap();
        let speeds = stepper.particles().velocity.iter().map(|v| v.norm());
        speeds.fold(0.0, f64::max)
    };
    assert!(speed(true) < 1e-6 && speed(false) > 1e-3);
}
