//! Dual domain with sub-points on the compacting column: the journal's Table 8, ours beside the papers'. What
//! it shows is explained in `docs/verification/sub-points.md`.
//!
//! `cargo run --release --example sub_points`
//!
//! Source: Dhakal & Zhang, J. Comput. Phys. 325 (2016); Wobbes, Moeller, Galavi & Vuik, Int. J. Numer.
//! Methods Eng. 117 (2019), section 6.2: H = 50 m, 50 cells, 20 particles per cell, 5000 steps of 1e-4 s.

use std::error::Error;
use std::time::Instant;

use materialpoint::basis::{AxisBasis, AxisCell, BasisFamily, DualDomain, Functions};
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{Hill, Moduli};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::{Reconstruction, SubPoints, Taylor};
use materialpoint::reference::{self, LagrangianBar, Reference, StaticColumn, Strain};
use materialpoint::scalar::Scalar;
use materialpoint::simd::Lanes;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use nalgebra::vector;

const HEIGHT: f64 = 50.0;
const DENSITY: f64 = 1.0;
const YOUNGS_MODULUS: f64 = 1e6;
const BODY_FORCE: f64 = -200.0;
const STEP: f64 = 1e-4;
const STEPS: u32 = 5000;

/// Dual domain with the weights alpha and 1 - alpha of its gradient exchanged: at cell edges it jumps by all
/// that the linear gradient jumps there.
#[derive(Clone, Copy, Debug)]
pub struct Swapped;

impl<T: Scalar> AxisBasis<T, 4> for Swapped {
    fn dofs_on_axis(&self, cells: usize) -> usize {
        cells + 1
    }

    /// Of the nodes below, left of, right of and above the cell; at an end of the axis one of them is
    /// missing.
    fn evaluate<K: Lanes<T>>(&self, k: K, at: AxisCell, unit: K::V) -> Functions<K::V, 4> {
        let (zero, one, half) = (
            k.splat(T::zero()),
            k.splat(T::one()),
            k.splat(T::one() / T::lit(2.0)),
        );
        let (left, right) = (one - unit, unit);
        let smooth = (left + left) * right;
        let plain = one - smooth;
        let (of_left, of_right) = (smooth * left, smooth * right);
        let mut slope = [zero, zero - plain, plain, zero];
        // Each node's smoothed slope is the central difference, at an end the one-sided one.
        let (below, share) = if at.cell == 0 { (1, one) } else { (0, half) };
        slope[below] = slope[below] - of_left * share;
        slope[2] = slope[2] + of_left * share;
        let (above, share) = if at.cell + 1 == at.cells {
            (2, one)
        } else {
            (3, half)
        };
        slope[1] = slope[1] - of_right * share;
        slope[above] = slope[above] + of_right * share;
        let value = [zero, left, right, zero];
        let places: [usize; 4] = match at.cell - self.first_of(at) {
            0 => [1, 2, 3, 0],
            1 => [0, 1, 2, 3],
            _ => [3, 0, 1, 2],
        };
        Functions {
            value: places.map(|place| value[place]),
            slope: places.map(|place| slope[place]),
        }
    }

    fn first_dof(&self, at: AxisCell) -> usize {
        self.first_of(at)
    }
}

impl Swapped {
    /// The first of the four nodes, of which as many as there are lie in the grid.
    fn first_of(self, at: AxisCell) -> usize {
        at.cell.saturating_sub(1).min((at.cells + 1).saturating_sub(4))
    }
}

materialpoint::tensor_product_family!(Swapped, width = 4, degree = 1);

/// Relative L2 errors of the stress, and time.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Error against the column at rest.
    pub fixed: f64,
    /// Error against the column in motion.
    pub moving: f64,
    /// Time of the steps (s).
    pub seconds: f64,
}

/// The stress that the particles should have.
struct Exact {
    fixed: StaticColumn,
    moving: LagrangianBar<reference::Hill>,
}

impl Exact {
    fn new() -> Result<Self, Box<dyn Error>> {
        let law = reference::Hill {
            youngs_modulus: YOUNGS_MODULUS,
        };
        let end = f64::from(STEPS) * STEP;
        let mut moving = LagrangianBar::column(HEIGHT, DENSITY, BODY_FORCE, end, law)?;
        moving.advance(end)?;
        Ok(Self {
            fixed: StaticColumn::new(HEIGHT, DENSITY, YOUNGS_MODULUS, BODY_FORCE, Strain::Large)?,
            moving,
        })
    }
}

fn error(particles: &Particles<f64, 1>, exact: &dyn Reference) -> f64 {
    let (mut error, mut size) = (0.0, 0.0);
    for (stress, x0) in particles.stress.iter().zip(&particles.initial_position) {
        let expected = exact.at(x0[0]).stress;
        error += (stress[(0, 0)] - expected).powi(2);
        size += expected.powi(2);
    }
    (error / size).sqrt()
}

/// The column with one method.
fn compact<B, R>(basis: B, reconstruction: R, exact: &Exact) -> Result<Outcome, Box<dyn Error>>
where
    B: BasisFamily<f64, 1>,
    R: Reconstruction<f64, 1>,
{
    let grid = Grid::new(vector![0.0], vector![HEIGHT], [50])?;
    let points = lattice(&grid, grid.min(), grid.max(), [20]);
    let mut stepper = Stepper::new(
        Setup::new(
            grid,
            basis,
            reconstruction,
            Hill {
                moduli: Moduli::uniaxial(YOUNGS_MODULUS)?,
            },
            OnePhase,
            Particles::at_rest(&points, DENSITY),
        )
        .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent)),
    )?;
    let base = Face {
        axis: 0,
        side: Side::Min,
    };
    let held = Forcing::none().with_face(base, FaceCondition::fixed());
    let begun = Instant::now();
    for step in 0..STEPS {
        let load = BODY_FORCE * f64::from(step) / f64::from(STEPS);
        stepper.step(STEP, &held.with_body_force(vector![load]))?;
    }
    let seconds = begun.elapsed().as_secs_f64();
    Ok(Outcome {
        fixed: error(stepper.particles(), &exact.fixed),
        moving: error(stepper.particles(), &exact.moving),
        seconds,
    })
}

/// One number of sub-points.
#[derive(Clone, Copy, Debug)]
pub struct Comparison {
    /// How many each particle has.
    pub sub_points: usize,
    /// Dual domain as printed.
    pub printed: Outcome,
    /// With the weights exchanged.
    pub swapped: Outcome,
}

/// Dual domain + TLS, and every number in `counts`. All are run `repeats` times in turn; the median of the
/// times counts.
pub fn run(counts: &[usize], repeats: usize) -> Result<(Outcome, Vec<Comparison>), Box<dyn Error>> {
    let exact = Exact::new()?;
    let (mut taylor, mut rows) = (Vec::new(), vec![(Vec::new(), Vec::new()); counts.len()]);
    for _ in 0..repeats.max(1) {
        taylor.push(compact(DualDomain::new(), Taylor::<f64, 1, 3>::new(), &exact)?);
        for (&count, (printed, swapped)) in counts.iter().zip(&mut rows) {
            let sub_points = SubPoints::new(count)?;
            printed.push(compact(DualDomain::new(), sub_points, &exact)?);
            // Its time says nothing that is wanted.
            if swapped.is_empty() {
                swapped.push(compact(Swapped, sub_points, &exact)?);
            }
        }
    }
    let rows = counts
        .iter()
        .zip(rows)
        .map(|(&sub_points, (printed, swapped))| Comparison {
            sub_points,
            printed: median(printed),
            swapped: median(swapped),
        });
    Ok((median(taylor), rows.collect()))
}

/// The run of median time.
fn median(mut runs: Vec<Outcome>) -> Outcome {
    runs.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    runs[runs.len() / 2]
}

/// Sub-points, error, and time over that of dual domain + TLS, as printed; for one sub-point the journal's
/// Figure 10, without a time.
const PAPER: [(usize, f64, Option<f64>); 8] = [
    (1, 4.4555e-2, None),
    (2, 3.4086e-2, Some(0.3037)),
    (4, 2.7207e-2, Some(0.4224)),
    (8, 2.1469e-2, Some(0.6793)),
    (16, 1.5236e-2, Some(1.2786)),
    (32, 8.1219e-3, Some(3.3569)),
    (64, 6.2274e-3, Some(6.3747)),
    (128, 5.6118e-3, Some(14.422)),
];

// The tests include this file as a module and call `run` themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    let (taylor, rows) = run(&PAPER.map(|row| row.0), 3)?;
    println!("relative L2 error of the stress; time of the step loop over that of dual domain + TLS\n");
    println!("      as printed                      weights exchanged       papers'");
    println!("   S    static   dynamic    time      static   dynamic      static    time");
    for (row, (_, paper, paper_time)) in rows.iter().zip(PAPER) {
        let paper_time = paper_time.map_or_else(String::new, |time| format!("{time:.2}"));
        println!(
            "{:>4} {:>9.3e} {:>9.3e} {:>7.2}   {:>9.3e} {:>9.3e}   {:>9.3e} {paper_time:>7}",
            row.sub_points,
            row.printed.fixed,
            row.printed.moving,
            row.printed.seconds / taylor.seconds,
            row.swapped.fixed,
            row.swapped.moving,
            paper
        );
    }
    println!(
        " TLS {:>9.3e} {:>9.3e} {:>7.2}   {:>9} {:>9}   {:>9.3e} {:>7.2}   ({:.2} s)",
        taylor.fixed, taylor.moving, 1.0, "", "", 4.7796e-3, 1.0, taylor.seconds
    );
    Ok(())
}
