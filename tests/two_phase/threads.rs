//! Two phases take the sweeps of one: threads change no bit, and neither does it matter in which order
//! particles come.

use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::mass::VelocityMass;
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{Drag, PoreLiquid, TwoPhase};
use materialpoint::stepper::{FaceCondition, Forcing, Simulation};
use materialpoint_steppers::Parts;
use nalgebra::{SVector, vector};

use crate::compiled::{self, parts};

const CELLS: [usize; 2] = [72, 40];
const STEPS: usize = 12;

const PHASE: TwoPhase<f64> = TwoPhase {
    porosity: 0.4,
    solid_density: 2650.0,
    liquid_density: 1e3,
    liquid_bulk_modulus: 2.2e6,
    permeability: 1e-2,
    permeability_exponent: 0.0,
    gravity: 10.0,
    drag: Drag::Implicit,
};

/// A full box in which solid and liquid move otherwise, crossing cells; with `shuffled` particles in no
/// order.
fn body(method: Method, mass: VelocityMass, shuffled: bool) -> Box<dyn Simulation<2>> {
    let grid = Grid::new(vector![0.0, 0.0], vector![1.8, 1.0], CELLS).unwrap();
    let mut points = lattice(&grid, grid.min(), grid.max(), [2, 2]);
    let count = points.len();
    if shuffled {
        // A stride that shares no factor with the count visits every point once.
        points = (0..count).map(|p| points[p * 10_007 % count]).collect();
    }
    let mut particles: Particles<f64, 2> = Particles::at_rest(&points, PHASE.dry_density());
    let mut pores = vec![PoreLiquid::default(); count];
    for ((v, pore), x) in (particles.velocity.iter_mut().zip(&mut pores)).zip(&particles.position) {
        let wave = (std::f64::consts::PI * x[1]).sin() * (std::f64::consts::PI * x[0] / 1.8).sin();
        *v = vector![3.0, -2.0] * wave;
        *pore = PoreLiquid {
            velocity: vector![2.0, 3.0] * wave,
            pressure: -1e2 * x[1],
        };
    }
    let law = LinearElastic {
        moduli: Moduli::from_young(1e6, 0.2).unwrap(),
    };
    let parts = Parts {
        liquid: Some(PHASE),
        pores,
        ..parts(grid, law, particles)
    };
    compiled::simulation(method, mass, parts)
}

/// Positions, velocities, stresses, and velocities and pressures of the liquid after some steps on so many
/// threads.
fn run(
    body: impl FnOnce() -> Box<dyn Simulation<2>> + Send,
    floor: FaceCondition<f64, 2>,
    threads: usize,
) -> Vec<f64> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.unwrap().install(|| {
        let walls = Face::all::<2>().fold(Forcing::none(), |forcing, face| {
            forcing.with_face(face, FaceCondition::roller(face.axis))
        });
        let below = Face {
            axis: 1,
            side: Side::Min,
        };
        let forcing = walls.with_face(below, floor).with_body_force(vector![0.0, -10.0]);
        let mut body = body();
        for _ in 0..STEPS {
            body.step(2e-4, &forcing).unwrap();
        }
        assert!(body.diagnostics().grid_crossings > 0);
        let (particles, liquid) = (body.particles(), body.liquid());
        let vectors: Vec<SVector<f64, 2>> = (particles.position.iter().chain(&particles.velocity).copied())
            .chain(liquid.iter().map(|liquid| liquid.velocity))
            .collect();
        let stresses = particles.stress.iter().map(|stress| stress[(0, 1)]);
        let pressures = liquid.iter().map(|liquid| liquid.pressure);
        (vectors.iter().flat_map(|v| [v[0], v[1]]))
            .chain(stresses)
            .chain(pressures)
            .collect()
    })
}

fn check(method: Method, mass: VelocityMass, floor: FaceCondition<f64, 2>) {
    let one = run(|| body(method, mass, false), floor, 1);
    for threads in [2, 3] {
        let more = run(|| body(method, mass, false), floor, threads);
        let same = one.iter().zip(&more).all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(same, "{mass:?}, {threads} threads");
    }
    // Numbers of a kind lie together, and each particle's come back in the order in which it was given.
    let shuffled = run(|| body(method, mass, true), floor, 2);
    let count = one.len() / 8;
    for p in 0..count {
        let q = p * 10_007 % count;
        // Positions, velocities of both phases, stress and pressure: where they begin, how many, and what is
        // round-off.
        for (first, each, size) in [
            (0, 2, 1e-9),
            (2, 2, 1e-9),
            (4, 2, 1e-9),
            (6, 1, 1e-4),
            (7, 1, 1e-4),
        ] {
            let first = first * count;
            for c in 0..each {
                let (a, b) = (one[first + q * each + c], shuffled[first + p * each + c]);
                assert!((a - b).abs() < size, "{mass:?}: {first} of {p}: {a} {b}");
            }
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_bits_of_one_and_the_order_of_particles_does_not_matter() {
    let linear = Method::new(Basis::Linear, ReconstructionKind::Shepard);
    let dual_domain = Method::new(Basis::DualDomain, ReconstructionKind::Shepard);
    let fits = Method::new(Basis::BSpline { degree: 2 }, ReconstructionKind::Taylor);
    let smooth = FaceCondition::roller(1);
    check(linear, VelocityMass::Lumped, smooth);
    check(dual_domain, VelocityMass::Lumped, smooth);
    check(fits, VelocityMass::Lumped, smooth);
    check(fits, VelocityMass::Constrained, smooth);
    check(linear, VelocityMass::Lumped, FaceCondition::frictional(0.3));
}
