//! Any number of threads gives the bits of one.
//!
//! Particles enough for many spans, in order along the bar and shuffled (then one span serves), crossing
//! cells as they move.

mod entering;

use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{Hill, Moduli};
use materialpoint::mass::VelocityMass;
use materialpoint::method::Method;
use materialpoint::particles::{Particles, lattice};
use materialpoint::stepper::{FaceCondition, Forcing, Simulation};
use nalgebra::vector;

use crate::compiled::{self, parts};

/// Round-off of sums of 21 000 momenta, which pass no tree: a few times the machine epsilon times the root of
/// their number.
const ROUND_OFF: f64 = 1e-13;
const CELLS: usize = 3000;
const PER_CELL: usize = 7;

#[derive(Clone, Copy)]
struct Bar {
    mass: VelocityMass,
    shuffled: bool,
}

impl Bar {
    fn simulation(self, method: Method) -> Box<dyn Simulation<1>> {
        let grid = Grid::new(vector![0.0], vector![1.0], [CELLS]).unwrap();
        let mut points = lattice(&grid, grid.min(), grid.max(), [PER_CELL]);
        if self.shuffled {
            let count = points.len();
            // A stride that shares no factor with the count visits every point once.
            points = (0..count).map(|p| points[p * 10_007 % count]).collect();
        }
        let mut particles = Particles::at_rest(&points, 2e3);
        for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
            v[0] = 0.8 * (std::f64::consts::PI * x[0]).sin();
        }
        let law = Hill {
            moduli: Moduli::uniaxial(4e4).unwrap(),
        };
        compiled::simulation(method, self.mass, parts(grid, law, particles))
    }
}

/// Positions and velocities after some steps, and the error of the momentum, on so many threads.
fn run(method: Method, bar: Bar, threads: usize) -> (Vec<u64>, f64) {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| {
        let ends = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
        let fixed = |forcing: Forcing<f64, 1>, end| forcing.with_face(end, FaceCondition::fixed());
        let forcing = ends.into_iter().fold(Forcing::none(), fixed);
        let mut simulation = bar.simulation(method);
        for _ in 0..40 {
            simulation.step(1e-5, &forcing).unwrap();
        }
        let found = simulation.diagnostics();
        assert!(found.grid_crossings > 0);
        let particles = simulation.particles();
        let numbers = particles.position.iter().chain(&particles.velocity);
        let stresses = particles.stress.iter().map(|s| s[0].to_bits());
        let bits = numbers.map(|x| x[0].to_bits()).chain(stresses).collect();
        (bits, found.conservation.momentum_scaled)
    })
}

#[test]
fn results_are_the_same_to_the_bit_on_any_number_of_threads() {
    for method in Method::ALL {
        for mass in [VelocityMass::Consistent, VelocityMass::Lumped] {
            for shuffled in [false, true] {
                let bar = Bar { mass, shuffled };
                let (one, momentum) = run(method, bar, 1);
                if !method.to_string().ends_with("spline") {
                    assert!(momentum < ROUND_OFF, "{method} {mass:?}: {momentum:e}");
                }
                for threads in [2, 3, 7] {
                    let (more, _) = run(method, bar, threads);
                    assert!(
                        one == more,
                        "{method} {mass:?} shuffled {shuffled}, {threads} threads"
                    );
                }
            }
        }
    }
}
