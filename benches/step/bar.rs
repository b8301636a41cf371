//! The bar that is stepped.

use materialpoint::basis::BasisFamily;
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{Hill, Moduli};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::method::{Method, MethodVisitor};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::Reconstruction;
use materialpoint::scalar::Scalar;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Simulation, Stepper};
use nalgebra::vector;

use super::yardstick::Bar;

const DENSITY: f64 = 2e3;
const MODULUS: f64 = 4e4;

/// Time step times number of cells (s): a ten-thousandth of the time that a wave takes through a cell, so
/// that the many steps of a measurement change little.
pub const STEP: f64 = 2e-5;

/// Particles between the ends of the bar.
#[derive(Clone, Copy)]
pub struct Layout {
    pub cells: usize,
    pub per_cell: usize,
}

/// Nowhere zero: tiny numbers would be denormal and slow.
fn velocity(x: f64) -> f64 {
    0.1 * (std::f64::consts::PI * x).sin() + 0.01
}

impl Layout {
    /// The same bar for the plain loops.
    pub fn plain(self) -> Bar {
        let count = self.cells * self.per_cell;
        let x: Vec<f64> = (0..count).map(|p| (p as f64 + 0.5) / count as f64).collect();
        let v = x.iter().map(|&x| velocity(x)).collect();
        Bar::new(self.cells, x, v, DENSITY, MODULUS)
    }
}

impl<T: Scalar> MethodVisitor<T> for Layout {
    type Output = Box<dyn Simulation<1>>;

    fn visit<B, R>(self, basis: B, reconstruction: R) -> Self::Output
    where
        B: BasisFamily<T, 1> + Send + 'static,
        R: Reconstruction<T, 1> + Clone + Send + 'static,
    {
        let grid = Grid::new(vector![T::zero()], vector![T::one()], [self.cells]).expect("a valid grid");
        let points = lattice(&grid, grid.min(), grid.max(), [self.per_cell]);
        let mut particles = Particles::at_rest(&points, T::lit(DENSITY));
        for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
            v[0] = T::lit(velocity(x[0].primal()));
        }
        let moduli = Moduli::uniaxial(T::lit(MODULUS)).expect("a positive modulus");
        let stepper = Stepper::new(
            Setup::new(grid, basis, reconstruction, Hill { moduli }, OnePhase, particles)
                .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent)),
        );
        Box::new(stepper.expect("a valid setup"))
    }
}

/// Both ends of the bar are held.
pub fn fixed_ends() -> Forcing<f64, 1> {
    let ends = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
    let fixed = |forcing: Forcing<f64, 1>, end| forcing.with_face(end, FaceCondition::fixed());
    ends.into_iter().fold(Forcing::none(), fixed)
}

/// The stepper of one method.
pub fn simulation(method: Method, layout: Layout) -> Box<dyn Simulation<1>> {
    method
        .dispatch::<f64, _, 1>(layout)
        .expect("a method of the table")
}

/// The same in single precision.
pub fn single_precision(method: Method, layout: Layout) -> Box<dyn Simulation<1>> {
    method
        .dispatch::<f32, _, 1>(layout)
        .expect("a method of the table")
}
