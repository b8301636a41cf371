//! A thread that belongs to no pool sends a long step to the global one, once, and takes a short step itself.
//!
//! A law that notes where it is asked tells where a step runs, and the system how often its caller slept.

use std::collections::HashSet;
use std::sync::{Arc, Mutex};
use std::thread::{self, ThreadId};

use materialpoint::grid::{Face, Grid};
use materialpoint::law::ConstitutiveLaw;
use materialpoint::mass::VelocityMass;
use materialpoint::method::ReconstructionKind::{self, RelaxedTaylor, Shepard};
use materialpoint::method::{Basis, Method};
use materialpoint::particles::{Particles, lattice};
use materialpoint::stepper::{FaceCondition, Forcing};
use materialpoint_steppers::{Build, Parts};
use nalgebra::{SMatrix, SVector};

use crate::compiled::{self, parts};

const MODULUS: f64 = 4e4;
const DENSITY: f64 = 2e3;
const STEPS: usize = 20;

/// Threads that asked the law, and for each whether it was one of a pool.
type Seen = Arc<Mutex<HashSet<(ThreadId, bool)>>>;

/// `d sigma = E d epsilon`, and a note of who asks.
struct Watched(Seen);

impl<const D: usize> ConstitutiveLaw<f64, D> for Watched {
    type State = ();

    fn large_strain(&self) -> bool {
        true
    }

    fn update(&self, increment: &SMatrix<f64, D, D>, stress: &mut SMatrix<f64, D, D>, (): &mut ()) {
        let asking = (thread::current().id(), rayon::current_thread_index().is_some());
        self.0.lock().unwrap().insert(asking);
        *stress += (increment + increment.transpose()) * (0.5 * MODULUS);
    }

    fn wave_speed(&self, density: f64, _stress: &SMatrix<f64, D, D>, (): &()) -> f64 {
        (MODULUS / density).sqrt()
    }

    fn energy_density(&self, stress: &SMatrix<f64, D, D>, (): &()) -> f64 {
        stress.norm_squared() / (2.0 * MODULUS)
    }
}

/// What some steps of a full box led to.
struct Found {
    bits: Vec<u64>,
    threads: HashSet<(ThreadId, bool)>,
    /// How often the thread that asked for the steps gave its processor up because it had to wait, where the
    /// system tells.
    waits: Option<usize>,
}

fn waits() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/thread-self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("voluntary_ctxt_switches:"))?;
    line.trim().parse().ok()
}

fn run<const D: usize>(
    cells: usize,
    per_cell: usize,
    basis: Basis,
    reconstruction: ReconstructionKind,
) -> Found
where
    Parts<f64, D>: Build<D>,
{
    let grid = Grid::new(SVector::zeros(), SVector::repeat(1.0), [cells; D]).unwrap();
    let mut particles = Particles::at_rest(&lattice(&grid, grid.min(), grid.max(), [per_cell; D]), DENSITY);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        *v = x.map(|x| 0.8 * (std::f64::consts::PI * x).sin());
    }
    let seen = Seen::default();
    let parts = parts(grid, Watched(seen.clone()), particles);
    let method = Method::new(basis, reconstruction);
    let mut stepper = compiled::simulation(method, VelocityMass::Lumped, parts);
    let forcing = Face::all::<D>().fold(Forcing::none(), |forcing, face| {
        forcing.with_face(face, FaceCondition::roller(face.axis))
    });
    // The first step may start the pool, and makes room.
    stepper.step(1e-5, &forcing).unwrap();
    seen.lock().unwrap().clear();
    let before = waits();
    for _ in 0..STEPS {
        stepper.step(1e-5, &forcing).unwrap();
    }
    let waits = waits().zip(before).map(|(after, before)| after - before);
    let particles = stepper.particles();
    let vectors = particles.position.iter().chain(&particles.velocity);
    let numbers = vectors
        .flat_map(|x| x.iter())
        .chain(particles.stress.iter().flat_map(|s| s.iter()));
    Found {
        bits: numbers.map(|x| x.to_bits()).collect(),
        threads: seen.lock().unwrap().clone(),
        waits,
    }
}

/// On a thread of its own, which belongs to no pool, and on the only thread of a pool.
fn outside_and_alone(run: impl Fn() -> Found + Send + Sync) -> [Found; 2] {
    let outside = thread::scope(|scope| scope.spawn(&run).join().unwrap());
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    [outside, alone.install(&run)]
}

/// Once a step, and once more if it wakes while the one that woke it still holds the lock. A pass sent alone
/// is a wait: a relaxed step had more than twenty.
#[track_caller]
fn enters_once_a_step(run: impl Fn() -> Found + Send + Sync) {
    // Two threads also on a machine with one processor, unless another test has started the pool already.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(2).build_global();
    let [outside, alone] = outside_and_alone(run);
    assert!(outside.bits == alone.bits);
    if rayon::current_num_threads() > 1 {
        assert!(outside.threads.iter().all(|&(_, in_pool)| in_pool));
    }
    if let Some(waits) = outside.waits {
        assert!(waits <= 2 * STEPS, "{waits} waits in {STEPS} steps");
    }
}

#[test]
fn a_long_step_enters_the_pool_once() {
    const BSPLINE: Basis = Basis::BSpline { degree: 2 };
    enters_once_a_step(|| run::<1>(3000, 7, Basis::Linear, RelaxedTaylor));
    enters_once_a_step(|| run::<1>(3000, 7, Basis::Linear, Shepard));
    enters_once_a_step(|| run::<2>(60, 2, BSPLINE, Shepard));
    enters_once_a_step(|| run::<2>(40, 3, BSPLINE, RelaxedTaylor));
}

#[test]
fn a_short_step_stays_on_its_thread() {
    let [outside, _] = outside_and_alone(|| {
        let found = run::<1>(500, 8, Basis::Linear, RelaxedTaylor);
        let own = thread::current().id();
        assert!(found.threads.iter().all(|&(id, _)| id == own));
        found
    });
    assert_eq!(outside.threads.len(), 1);
    assert!(outside.threads.iter().all(|&(_, in_pool)| !in_pool));
}
