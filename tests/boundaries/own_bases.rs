//! Bases whose ends do not interpolate, or whose functions are wider than the degree that they reproduce:
//! what a stepper makes of them.

use std::f64::consts::PI;

use materialpoint::basis::{AxisBasis, AxisCell, BSpline, BasisFamily, Functions, tensor};
use materialpoint::error::StepError;
use materialpoint::grid::{Cell, Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::{Reconstruction, Shepard, Taylor};
use materialpoint::scalar::Scalar;
use materialpoint::simd::Lanes;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use nalgebra::SVector;

/// Quadratic B-splines on plain uniform knots: two functions have a value at each end, neither of them one.
#[derive(Clone, Copy, Debug)]
struct Uniform;

impl<T: Scalar> AxisBasis<T, 3> for Uniform {
    fn dofs_on_axis(&self, cells: usize) -> usize {
        cells + 2
    }

    fn evaluate<K: Lanes<T>>(&self, k: K, _at: AxisCell, s: K::V) -> Functions<K::V, 3> {
        let (one, half) = (k.splat(T::one()), k.splat(T::one() / T::lit(2.0)));
        let r = one - s;
        Functions {
            value: [r * r * half, half + s * r, s * s * half],
            slope: [s - one, r - s, s],
        }
    }
}

materialpoint::tensor_product_family!(Uniform, width = 3, degree = 2);

/// The same written by hand, which says nothing of its faces; `ABOUT` says that it holds them about.
#[derive(Clone, Copy, Debug)]
struct ByHand<const ABOUT: bool>;

impl<const ABOUT: bool> BasisFamily<f64, 1> for ByHand<ABOUT> {
    const HOLDS_ABOUT: bool = ABOUT;

    fn degree(&self) -> usize {
        2
    }

    fn dofs(&self, grid: &Grid<f64, 1>) -> [usize; 1] {
        tensor::dofs::<f64, 1, 3, _>(&Uniform, grid)
    }

    fn for_each(
        &self,
        grid: &Grid<f64, 1>,
        cell: &Cell<1>,
        x: &SVector<f64, 1>,
        f: impl FnMut(usize, f64, SVector<f64, 1>),
    ) {
        tensor::for_each::<f64, 1, 3, _>(&Uniform, grid, cell, x, f);
    }
}

/// Cubic B-splines that are honest about less: only quadratics are said to be reproduced.
#[derive(Clone, Copy, Debug)]
struct Wide;

impl<T: Scalar> AxisBasis<T, 4> for Wide {
    fn dofs_on_axis(&self, cells: usize) -> usize {
        AxisBasis::<T, 4>::dofs_on_axis(&BSpline::<3>, cells)
    }

    fn evaluate<K: Lanes<T>>(&self, k: K, at: AxisCell, unit: K::V) -> Functions<K::V, 4> {
        BSpline::<3>.evaluate(k, at, unit)
    }
}

materialpoint::tensor_product_family!(Wide, width = 4, degree = 2);

const LENGTH: f64 = 1.0;
const DENSITY: f64 = 1e3;
const MODULUS: f64 = 1e5;

/// A box full of material that vibrates along axis 0 between walls; velocities and positions after a part of
/// the period of its first mode.
fn vibrate<const D: usize, B, R>(
    basis: B,
    reconstruction: R,
    cells: usize,
    periods: f64,
) -> Result<Particles<f64, D>, StepError>
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
{
    let grid = Grid::new(SVector::zeros(), SVector::repeat(LENGTH), [cells; D]).unwrap();
    let points = lattice(&grid, grid.min(), grid.max(), [4; D]);
    let mut particles = Particles::at_rest(&points, DENSITY);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        v[0] = 1e-3 * (PI * x[0] / LENGTH).sin();
    }
    let mut stepper = Stepper::new(
        Setup::new(
            grid,
            basis,
            reconstruction,
            LinearElastic {
                moduli: Moduli::from_young(MODULUS, 0.0).unwrap(),
            },
            OnePhase,
            particles,
        )
        .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent)),
    )
    .unwrap();
    let walls = Face::all::<D>().fold(Forcing::none(), |forcing, face| {
        forcing.with_face(face, FaceCondition::roller(face.axis))
    });
    let period = 2.0 * LENGTH / (MODULUS / DENSITY).sqrt();
    let steps = (periods * 40.0 * cells as f64).ceil();
    for _ in 0..steps as usize {
        stepper.step(periods * period / steps, &walls)?;
    }
    Ok(stepper.particles().clone())
}

/// Error of the displacement after a quarter of a period, relative to the amplitude `v / omega` of the exact
/// standing wave.
fn error<B: BasisFamily<f64, 1>>(basis: B, cells: usize) -> f64 {
    let particles = vibrate::<1, _, _>(basis, Shepard, cells, 0.25).unwrap();
    let amplitude = 1e-3 * LENGTH / PI / (MODULUS / DENSITY).sqrt();
    let deviations = particles
        .initial_position
        .iter()
        .zip(&particles.displacement)
        .map(|(x, u)| {
            let exact = amplitude * (PI * x[0] / LENGTH).sin();
            (u[0] - exact).powi(2)
        });
    let count = particles.len() as f64;
    (deviations.sum::<f64>() / count).sqrt() / amplitude
}

/// Both functions that reach a wall are held, which holds strain there too: first order. The ghost node alone
/// would let the ends go, at an error of the amplitude's size.
#[test]
fn walls_hold_a_basis_whose_ends_do_not_interpolate() {
    let [coarse, fine] = [20, 40].map(|cells| error(Uniform, cells));
    assert!(coarse < 0.1, "{coarse}");
    assert!(fine < 0.6 * coarse, "{coarse} {fine}");
    assert!(error(BSpline::<2>, 20) < 0.02);
}

#[test]
fn a_wall_that_a_basis_would_let_slip_is_refused() {
    let refused = vibrate::<1, _, _>(ByHand::<false>, Shepard, 8, 0.1);
    let face = Face {
        axis: 0,
        side: Side::Min,
    };
    assert!(
        matches!(refused, Err(StepError::WallNotHeld { face: at, dof: 1 }) if at == face),
        "{refused:?}"
    );
    assert!(vibrate::<1, _, _>(ByHand::<true>, Shepard, 8, 0.1).is_ok());
}

/// The functions are those of the cubic spline, so the motion is.
#[test]
fn functions_may_be_wider_than_the_degree_that_they_reproduce() {
    fn compare<const D: usize, R: Reconstruction<f64, D> + Clone>(reconstruction: R)
    where
        BSpline<3>: BasisFamily<f64, D>,
    {
        let wide = vibrate::<D, _, _>(Wide, reconstruction.clone(), 5, 0.2).unwrap();
        let cubic = vibrate::<D, _, _>(BSpline::<3>, reconstruction, 5, 0.2).unwrap();
        for (a, b) in wide.velocity.iter().zip(&cubic.velocity) {
            assert!((a - b).norm() < 1e-13, "{a} {b}");
        }
    }
    compare::<1, _>(Taylor::<f64, 1, 3>::for_degree(3));
    compare::<2, _>(Taylor::<f64, 2, 6>::for_degree(3));
}
