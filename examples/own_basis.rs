//! A basis family of your own: quadratic B-splines without repeated knots at the ends, in one file.
//!
//! `cargo run --release --example own_basis`

use std::error::Error;
use std::f64::consts::PI;

use materialpoint::basis::{AxisBasis, AxisCell, Functions};
use materialpoint::grid::Grid;
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::Taylor;
use materialpoint::scalar::Scalar;
use materialpoint::simd::Lanes;
use materialpoint::stepper::{Forcing, Setup, Stepper};
use nalgebra::vector;

/// Quadratic B-splines on plain uniform knots, as many MPM codes use them: every cell has the same three
/// functions. No function interpolates at the ends: a wall holds both that have a value there, and so the
/// strain in its cell too. A free body does not mind.
#[derive(Clone, Copy, Debug)]
pub struct UniformQuadratic;

impl<T: Scalar> AxisBasis<T, 3> for UniformQuadratic {
    fn dofs_on_axis(&self, cells: usize) -> usize {
        cells + 2
    }

    /// `s` runs from 0 to 1 in the cell.
    fn evaluate<K: Lanes<T>>(&self, k: K, _at: AxisCell, s: K::V) -> Functions<K::V, 3> {
        let (one, half) = (k.splat(T::one()), k.splat(T::one() / T::lit(2.0)));
        let r = one - s;
        Functions {
            value: [r * r * half, half + s * r, s * s * half],
            slope: [s - one, r - s, s],
        }
    }
}

// In every dimension: the product of the one-axis functions.
materialpoint::tensor_product_family!(UniformQuadratic, width = 3, degree = 2);

/// Lets a free bar vibrate for one period; returns the largest ratio of energy to initial energy.
pub fn run() -> Result<f64, Box<dyn Error>> {
    let (length, density, modulus): (f64, f64, f64) = (1.0, 1e3, 1e5);
    let grid = Grid::new(vector![-0.1], vector![1.1], [24])?;
    let points = lattice(&grid, &vector![0.0], &vector![length], [6]);
    let mut particles = Particles::at_rest(&points, density);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        v[0] = 0.01 * (PI * x[0] / length).cos();
    }
    let mut stepper = Stepper::new(Setup::new(
        grid,
        UniformQuadratic,
        Taylor::<f64, 1, 3>::new(),
        LinearElastic {
            moduli: Moduli::uniaxial(modulus)?,
        },
        OnePhase,
        particles,
    ))?;
    let period = 2.0 * length / (modulus / density).sqrt();
    let (start, steps) = (stepper.energy().total(), 1000);
    let mut highest = 0.0_f64;
    for _ in 0..steps {
        stepper.step(period / f64::from(steps), &Forcing::none())?;
        highest = highest.max(stepper.energy().total() / start);
    }
    Ok(highest)
}

// The tests include this file as a module and call `run` themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "highest energy over one period, relative to the initial: {:.4}",
        run()?
    );
    Ok(())
}
