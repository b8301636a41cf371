//! A constitutive law of your own: Hencky's logarithmic law, in one file.
//!
//! The library has the law too, as a rate without a state ([`materialpoint::law::Logarithmic`]); this one
//! remembers its strain, to show how a law does that.
//!
//! `cargo run --release --example own_law`

use std::error::Error;

use materialpoint::basis::BSpline;
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::ConstitutiveLaw;
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::Shepard;
use materialpoint::scalar::Scalar;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use nalgebra::{SMatrix, vector};

/// `sigma = E ln J`, Hencky's law in uniaxial strain, with its logarithmic strain as the state.
#[derive(Clone, Copy, Debug)]
pub struct Logarithmic<T> {
    /// Modulus (Pa).
    pub modulus: T,
}

impl<T: Scalar> ConstitutiveLaw<T, 1> for Logarithmic<T> {
    /// Logarithmic strain `ln J`; its default 0 is the undeformed state.
    type State = LogStrain<T>;

    fn large_strain(&self) -> bool {
        true
    }

    fn update(&self, increment: &SMatrix<T, 1, 1>, stress: &mut SMatrix<T, 1, 1>, state: &mut LogStrain<T>) {
        state.0 += increment[(0, 0)].ln_1p();
        stress[(0, 0)] = self.modulus * state.0;
    }

    /// `rho c^2 = d sigma / d ln J`.
    fn wave_speed(&self, density: T, _stress: &SMatrix<T, 1, 1>, _state: &LogStrain<T>) -> T {
        (self.modulus / density).sqrt()
    }

    /// `E ((ln J - 1) J + 1)` per reference volume, over `J`.
    fn energy_density(&self, _stress: &SMatrix<T, 1, 1>, state: &LogStrain<T>) -> T {
        self.modulus * (state.0 - T::one() + (-state.0).exp())
    }
}

/// `ln J`.
#[derive(Clone, Copy, Debug)]
pub struct LogStrain<T>(pub T);

impl<T: Scalar> Default for LogStrain<T> {
    fn default() -> Self {
        Self(T::zero())
    }
}

/// Pulls a bar at its free end by 1 % of the modulus and returns its mean strain when the oscillation
/// has the same number of halves behind and before it: the static strain, about 1 %.
pub fn run() -> Result<f64, Box<dyn Error>> {
    let (length, density, modulus): (f64, f64, f64) = (1.0, 1e3, 1e5);
    let grid = Grid::new(vector![0.0], vector![1.2 * length], [24])?;
    let points = lattice(&grid, grid.min(), &vector![length], [6]);
    let particles = Particles::at_rest(&points, density);
    let face = |side| Face { axis: 0, side };
    // The traction acts on the outermost particle's outer end and moves with it.
    let surface = vec![materialpoint::stepper::SurfacePoint {
        particle: particles.len() - 1,
        face: face(Side::Max),
        area: 1.0,
        reach: 0.5,
        loaded: true,
    }];
    // Published TLS does not bear a free end that moves into an empty cell; plain MPM does.
    let setup = Setup::new(
        grid,
        BSpline::<2>,
        Shepard,
        Logarithmic { modulus },
        OnePhase,
        particles,
    );
    let mut stepper = Stepper::new(setup.with_surface(surface))?;
    let pull = FaceCondition::Traction(vector![0.01 * modulus]);
    let forcing = Forcing::none()
        .with_face(face(Side::Min), FaceCondition::fixed())
        .with_face(face(Side::Max), pull);

    let period = 4.0 * length / (modulus / density).sqrt();
    let steps = 2000;
    let (mut mean, dt) = (0.0, period / f64::from(steps));
    for _ in 0..steps {
        stepper.step(dt, &forcing)?;
        let end = stepper.particles().displacement.last().map_or(0.0, |u| u[0]);
        mean += end / length / f64::from(steps);
    }
    Ok(mean)
}

// The tests include this file as a module and call `run` themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "mean strain over one period of a suddenly pulled bar: {:.4} (static: 0.0101)",
        run()?
    );
    Ok(())
}
