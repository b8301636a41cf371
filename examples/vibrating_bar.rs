//! The vibrating bar through the API: pick types, fill a bar, step, compare with the exact solution.
//!
//! `cargo run --release --example vibrating_bar`

use std::error::Error;
use std::f64::consts::PI;

use materialpoint::basis::BSpline;
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::mass::VelocityMass;
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::Taylor;
use materialpoint::reference::{Reference, VibratingBar};
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use nalgebra::vector;

/// Relative L2 error of the stress after a quarter of a period.
pub fn run() -> Result<f64, Box<dyn Error>> {
    let (length, density, youngs_modulus, velocity) = (1.0, 2e3, 7e6, 0.28);

    // A grid of 20 cells, filled with 8 particles per cell.
    let grid = Grid::new(vector![0.0], vector![length], [20])?;
    let points = lattice(&grid, grid.min(), grid.max(), [8]);
    let mut particles = Particles::at_rest(&points, density);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        v[0] = velocity * (PI * x[0] / length).sin();
    }

    // Basis, reconstruction and law are types: the step is compiled for this choice.
    let (basis, fits) = (BSpline::<2>, Taylor::<f64, 1, 3>::new());
    let law = LinearElastic {
        moduli: Moduli::uniaxial(youngs_modulus)?,
    };
    let setup = Setup::new(grid, basis, fits, law, OnePhase, particles);
    let mut stepper = Stepper::new(setup.with_velocity_mass(VelocityMass::Consistent))?;
    let ends = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
    let forcing = ends
        .into_iter()
        .fold(Forcing::none(), |f, end| f.with_face(end, FaceCondition::fixed()));

    let mut exact = VibratingBar::new(length, density, youngs_modulus, velocity)?;
    let end = exact.period() / 4.0;
    let steps = 400;
    for _ in 0..steps {
        stepper.step(end / f64::from(steps), &forcing)?;
    }

    exact.advance(end)?;
    let (mut error, mut size) = (0.0, 0.0);
    let particles = stepper.particles();
    for (stress, x0) in particles.stress.iter().zip(&particles.initial_position) {
        let expected = exact.at(x0[0]).stress;
        error += (stress[(0, 0)] - expected).powi(2);
        size += expected.powi(2);
    }
    Ok((error / size).sqrt())
}

// The tests include this file as a module and call `run` themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "relative L2 error of the stress after a quarter of a period: {:.2e}",
        run()?
    );
    Ok(())
}
