//! A run that is differentiated: the derivative of every particle's displacement with respect to Young's
//! modulus comes out of the run itself, because its numbers are dual numbers, `value + derivative d` with
//! `d^2 = 0`.
//!
//! Grid, basis, reconstruction, law and stepper are the library's: all of it computes with any real number.
//! The type in [`dual`] is one such number; the tests take the tangents of the laws with it too.
//!
//! Two judges: central differences of runs in `f64`, which must agree to what differences are good for, and
//! the exact derivative of the continuous bar, which must agree to what the method's error is.
//!
//! The bar swings so little that no particle leaves its cell. Where particles cross edges a run jumps with
//! its parameters, because a fit or a gradient jumps and the step in which a particle crosses is a whole
//! number. Dual numbers then give the derivative between the jumps, and differences over a jump give nothing:
//! swinging a thousand times as far, theirs were off by up to 2.6 times the derivative.
//!
//! `cargo run --release --example derivative`

pub mod dual;

use std::error::Error;
use std::f64::consts::PI;

use dual::Dual;
use materialpoint::basis::{BSpline, BasisFamily, DualDomain, Linear};
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::{CubicSpline, Reconstruction, RelaxedTaylor, Shepard, SubPoints, Taylor};
use materialpoint::scalar::Scalar;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use nalgebra::vector;

/// The bar of `vibrating_bar.rs` at a hundredth of its velocity, where small strain has an error of 5e-5:
/// length (m), density (kg/m3), Young's modulus (Pa) and largest velocity (m/s).
const LENGTH: f64 = 1.0;
const DENSITY: f64 = 2e3;
const MODULUS: f64 = 7e6;
const VELOCITY: f64 = 0.0028;

/// Steps of a run over one period, for each cell: a wave crosses a twentieth of a cell in a step.
const STEPS_PER_CELL: usize = 40;

/// How good a derivative is, by the largest deviations of all particles over the largest exact derivative.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Basis and reconstruction.
    pub name: &'static str,
    /// Dual numbers against central differences of the same runs.
    pub from_differences: f64,
    /// Dual numbers against the continuous bar.
    pub from_exact: f64,
    /// Largest deviation of the values of a run of dual numbers from one of plain numbers, over the largest
    /// displacement.
    pub values: f64,
}

/// Frequency (rad/s) of the first mode.
fn frequency(modulus: f64) -> f64 {
    PI / LENGTH * (modulus / DENSITY).sqrt()
}

/// Displacements (m) of a bar, held at both ends, after one period of the bar with [`MODULUS`], and where
/// their particles were at the start. Only the modulus carries a derivative in; the time does not follow it.
fn displacements<T, B, R>(
    cells: usize,
    modulus: T,
    basis: B,
    reconstruction: R,
) -> Result<Vec<(f64, T)>, Box<dyn Error>>
where
    T: Scalar,
    B: BasisFamily<T, 1>,
    R: Reconstruction<T, 1>,
{
    let grid = Grid::new(vector![T::zero()], vector![T::lit(LENGTH)], [cells])?;
    let points = lattice(&grid, grid.min(), grid.max(), [8]);
    let mut particles = Particles::at_rest(&points, T::lit(DENSITY));
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        v[0] = T::lit(VELOCITY) * (x[0] * T::lit(PI / LENGTH)).sin();
    }
    let mut stepper = Stepper::new(
        Setup::new(
            grid,
            basis,
            reconstruction,
            LinearElastic {
                moduli: Moduli::uniaxial(modulus)?,
            },
            OnePhase,
            particles,
        )
        .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent)),
    )?;
    let ends = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
    let forcing = ends
        .into_iter()
        .fold(Forcing::none(), |f, end| f.with_face(end, FaceCondition::fixed()));

    let steps = STEPS_PER_CELL * cells;
    let dt = T::lit(2.0 * PI / frequency(MODULUS) / steps as f64);
    // Half a kick first: the step is then of second order in time.
    stepper.step_with_kick(dt / T::lit(2.0), dt, &forcing)?;
    for _ in 1..steps {
        stepper.step(dt, &forcing)?;
    }
    let particles = stepper.particles();
    let starts = particles.initial_position.iter().map(|x| x[0].primal());
    Ok(starts.zip(particles.displacement.iter().map(|u| u[0])).collect())
}

/// Derivative (m/Pa) of the displacement `v/w sin(w t) sin(pi x/L)` with respect to `E`, with
/// `dw/dE = w/(2 E)`, after one period: the bar gets ahead of itself.
fn exact(x: f64) -> f64 {
    let omega = frequency(MODULUS);
    let t = 2.0 * PI / omega;
    let by_omega = VELOCITY * (t * (omega * t).cos() / omega - (omega * t).sin() / (omega * omega));
    by_omega * omega / (2.0 * MODULUS) * (PI * x / LENGTH).sin()
}

/// One method: `with_dual` and `plain` are the same reconstruction of both kinds of numbers.
fn row<B>(
    name: &'static str,
    cells: usize,
    basis: &B,
    with_dual: impl Reconstruction<Dual, 1>,
    plain: impl Reconstruction<f64, 1> + Clone,
) -> Result<Row, Box<dyn Error>>
where
    B: BasisFamily<Dual, 1> + BasisFamily<f64, 1>,
{
    let found = displacements(cells, Dual::new(MODULUS, 1.0), basis.clone(), with_dual)?;
    let at = |modulus: f64| displacements(cells, modulus, basis.clone(), plain.clone());
    // Truncation grows with the square of the step and round-off with its inverse: they balance at the cube
    // root of epsilon.
    let step = MODULUS * f64::EPSILON.cbrt();
    let (below, value, above) = (at(MODULUS - step)?, at(MODULUS)?, at(MODULUS + step)?);

    let amplitude = VELOCITY / frequency(MODULUS);
    let largest = exact(LENGTH / 2.0).abs();
    let mut row = Row {
        name,
        from_differences: 0.0,
        from_exact: 0.0,
        values: 0.0,
    };
    // What is no number must not get lost in a maximum.
    let worse = |worst: &mut f64, deviation: f64| {
        if deviation.is_nan() || deviation > *worst {
            *worst = deviation;
        }
    };
    for (((&(x, u), &(_, low)), &(_, high)), &(_, plain)) in found.iter().zip(&below).zip(&above).zip(&value)
    {
        let difference = (high - low) / (2.0 * step);
        worse(
            &mut row.from_differences,
            (u.derivative - difference).abs() / largest,
        );
        worse(&mut row.from_exact, (u.derivative - exact(x)).abs() / largest);
        worse(&mut row.values, (u.value - plain).abs() / amplitude);
    }
    Ok(row)
}

/// All reconstructions, on a bar of so many cells.
pub fn run(cells: usize) -> Result<Vec<Row>, Box<dyn Error>> {
    let (spline, dual_domain) = (BSpline::<2>, DualDomain::new());
    let sub_points = SubPoints::new(4)?;
    Ok(vec![
        row("linear, particle sums", cells, &Linear, Shepard, Shepard)?,
        row("B-splines, particle sums", cells, &spline, Shepard, Shepard)?,
        row(
            "dual domain, 4 sub-points",
            cells,
            &dual_domain,
            sub_points,
            sub_points,
        )?,
        row(
            "B-splines, Taylor",
            cells,
            &spline,
            Taylor::<_, 1, 3>::new(),
            Taylor::<_, 1, 3>::new(),
        )?,
        row(
            "B-splines, relaxed Taylor",
            cells,
            &spline,
            RelaxedTaylor::<_, 1, 3>::for_basis(&spline),
            RelaxedTaylor::<_, 1, 3>::for_basis(&spline),
        )?,
        row(
            "B-splines, cubic spline",
            cells,
            &spline,
            CubicSpline::for_degree(2),
            CubicSpline::for_degree(2),
        )?,
    ])
}

// The tests include this file as a module and call `run` themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "Derivative of the displacement by Young's modulus after one period: deviation over the largest"
    );
    println!(
        "{:28} {:>12} {:>16} {:>10}",
        "", "differences", "continuous bar", "values"
    );
    for row in run(20)? {
        let Row {
            name,
            from_differences,
            from_exact,
            values,
        } = row;
        println!("{name:28} {from_differences:12.1e} {from_exact:16.1e} {values:10.1e}");
    }
    Ok(())
}
