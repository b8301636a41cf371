//! A transfer of your own: the affine particle-in-cell method (APIC), in one file.
//!
//! PIC gives particles the velocity that the grid has where they are. What the grid cannot show is lost, and
//! a disc that spins soon stands still. APIC (Jiang, Schroeder, Selle, Teran & Stomakhin 2015; Jiang,
//! Schroeder & Teran 2017) lets each particle keep the linear velocity about it too, and with it the angular
//! momentum: to round-off with splines, whose second moments are the same everywhere in the grid's inside.
//!
//! `cargo run --release --example apic`

use std::error::Error;

use materialpoint::basis::{BSpline, BasisFamily};
use materialpoint::grid::Grid;
use materialpoint::law::{Moduli, NeoHookean};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::Shepard;
use materialpoint::record::Record;
use materialpoint::scalar::Scalar;
use materialpoint::stepper::{Forcing, Setup, Stepper};
use materialpoint::transfer::{Flip, GridVelocity, Transfer};
use nalgebra::{SMatrix, SVector, Vector2, vector};

/// Velocities by the grid alone: dissipative, and never noisy.
#[derive(Clone, Copy, Debug)]
pub struct Pic;

impl<T: Scalar, const D: usize> Transfer<T, D> for Pic {
    const FROM_GRID: bool = true;
    type Particle = ();

    fn take(&self, seen: &GridVelocity<T, D>, velocity: &mut SVector<T, D>, _: &mut ()) {
        *velocity = seen.velocity;
    }
}

/// The same with the linear velocity about each particle.
#[derive(Clone, Copy, Debug)]
pub struct Apic;

/// What APIC remembers of a particle.
#[derive(Clone, Copy, Debug)]
pub struct Affine<T, const D: usize> {
    /// Gradient `B D^-1` (1/s) of the velocity about it.
    pub gradient: SMatrix<T, D, D>,
    /// `sum_i phi_i v_i (x_i - x)` (m2/s), whose antisymmetric part is the angular momentum about its place,
    /// over its mass.
    pub moment: SMatrix<T, D, D>,
}

impl<T: Scalar, const D: usize> Default for Affine<T, D> {
    fn default() -> Self {
        let [gradient, moment] = [SMatrix::zeros(); 2];
        Self { gradient, moment }
    }
}

impl<T: Scalar, const D: usize> Record<T> for Affine<T, D> {
    fn put(&self, out: &mut impl FnMut(T)) {
        self.gradient.put(out);
        self.moment.put(out);
    }

    fn take(from: &mut impl FnMut() -> T) -> Option<Self> {
        Some(Self {
            gradient: Record::take(from)?,
            moment: Record::take(from)?,
        })
    }
}

impl<T: Scalar, const D: usize> Transfer<T, D> for Apic {
    const FROM_GRID: bool = true;
    const AFFINE: bool = true;
    type Particle = Affine<T, D>;

    fn gradient(&self, particle: &Affine<T, D>) -> SMatrix<T, D, D> {
        particle.gradient
    }

    fn take(&self, seen: &GridVelocity<T, D>, velocity: &mut SVector<T, D>, particle: &mut Affine<T, D>) {
        *velocity = seen.velocity;
        *particle = Affine {
            gradient: seen.affine(),
            moment: seen.moment,
        };
    }
}

/// What became of a disc that spins freely.
#[derive(Clone, Copy, Debug)]
pub struct Spin {
    /// Share of the angular momentum that is left, what particles hold about their own places included.
    pub angular_momentum: f64,
    /// Share of the kinetic energy of the particles.
    pub kinetic_energy: f64,
    /// Largest relative error of a step's momentum.
    pub momentum: f64,
}

/// Radius of the disc (m).
const RADIUS: f64 = 0.3;
/// Angular velocity (1/s).
const TURN: f64 = 1.0;

/// Spins a disc by so many turns; `moment` is what the transfer remembers of a particle.
///
/// # Errors
/// If something makes no sense.
pub fn spin<B, X>(
    basis: B,
    transfer: X,
    moment: fn(&X::Particle) -> SMatrix<f64, 2, 2>,
    turns: f64,
) -> Result<Spin, Box<dyn Error>>
where
    B: BasisFamily<f64, 2>,
    X: Transfer<f64, 2>,
{
    let grid = Grid::new(vector![0.0, 0.0], vector![1.0, 1.0], [20, 20])?;
    let middle = vector![0.5, 0.5];
    let mut points = lattice(&grid, &vector![0.1, 0.1], &vector![0.9, 0.9], [2, 2]);
    points.retain(|(x, _)| (x - middle).norm() < RADIUS);
    let mut particles = Particles::at_rest(&points, 1000.0);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        *v = vector![middle[1] - x[1], x[0] - middle[0]] * TURN;
    }
    let law = NeoHookean {
        moduli: Moduli::from_young(1e5, 0.3)?,
    };
    let setup = Setup::new(grid, basis, Shepard, law, OnePhase, particles);
    let mut stepper = Stepper::new(setup.with_transfer(transfer))?;
    let measure = |stepper: &Stepper<_, 2, _, _, _, _, X>| {
        let particles = stepper.particles();
        let mut angular = 0.0;
        for (p, own) in stepper.memory().iter().enumerate() {
            let (x, v, own) = (particles.position[p], particles.velocity[p], moment(own));
            angular += (cross(&(x - middle), &v) + own[(1, 0)] - own[(0, 1)]) * particles.mass[p];
        }
        (angular, stepper.energy().kinetic)
    };
    let (angular, kinetic) = measure(&stepper);
    let steps = (turns * 2.0 * std::f64::consts::PI / TURN / 1e-3).round() as usize;
    for _ in 0..steps {
        stepper.step(1e-3, &Forcing::none())?;
    }
    let now = measure(&stepper);
    Ok(Spin {
        angular_momentum: now.0 / angular,
        kinetic_energy: now.1 / kinetic,
        momentum: stepper.diagnostics().conservation.momentum_scaled,
    })
}

fn cross(a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Prints what is left of the spin.
///
/// # Errors
/// If something makes no sense.
pub fn run() -> Result<[Spin; 3], Box<dyn Error>> {
    let nothing = |_: &()| SMatrix::zeros();
    let flip = spin(BSpline::<2>, Flip, nothing, 1.0)?;
    let pic = spin(BSpline::<2>, Pic, nothing, 1.0)?;
    let apic = spin(BSpline::<2>, Apic, |own| own.moment, 1.0)?;
    println!("after one turn    angular momentum   kinetic energy");
    for (name, left) in [("FLIP", flip), ("PIC", pic), ("APIC", apic)] {
        let Spin {
            angular_momentum,
            kinetic_energy,
            ..
        } = left;
        println!("{name:<16} {angular_momentum:17.12} {kinetic_energy:16.4}");
    }
    Ok([flip, pic, apic])
}

#[allow(dead_code)] // The tests take the module without it.
fn main() -> Result<(), Box<dyn Error>> {
    run().map(|_| ())
}
