//! The body that is stepped: a full box between frictionless walls, in smooth motion.

use materialpoint::basis::BSpline;
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::ConstitutiveLaw;
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::Reconstruction;
use materialpoint::record::Record;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Simulation, Stepper};
use nalgebra::SVector;

pub const DENSITY: f64 = 1e3;
pub const YOUNG: f64 = 1e7;
pub const POISSON: f64 = 0.3;
/// Speed (m/s) of the motion: a hundredth of that of a wave.
const SPEED: f64 = 1.0;
/// Time step (s) times number of cells along an axis: a wave takes about eight steps through a cell.
const STEP: f64 = 1e-3;

/// In which order the particles come.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Cell after cell.
    Cells,
    /// At random.
    Shuffled,
}

/// `cells` along each axis of the unit box, `per_cell` particles a cell and axis.
#[derive(Clone, Copy)]
pub struct Body {
    pub cells: usize,
    pub per_cell: usize,
    pub order: Order,
}

impl Body {
    /// The box that comes nearest to so many particles, two of them a cell and axis.
    pub fn of<const D: usize>(particles: usize, order: Order) -> Self {
        Self::with::<D>(particles, 2, order)
    }

    /// The same with so many particles a cell and axis.
    pub fn with<const D: usize>(particles: usize, per_cell: usize, order: Order) -> Self {
        let cells = (particles as f64).powf(1.0 / D as f64) / per_cell as f64;
        let cells = cells.round() as usize;
        Self {
            cells,
            per_cell,
            order,
        }
    }

    /// Number of particles.
    pub fn particles<const D: usize>(self) -> usize {
        (self.per_cell * self.cells).pow(D as u32)
    }

    pub fn step(self) -> f64 {
        STEP / self.cells as f64
    }

    pub fn grid<const D: usize>(self) -> Grid<f64, D> {
        Grid::new(SVector::zeros(), SVector::repeat(1.0), [self.cells; D]).expect("a valid grid")
    }

    /// Positions and volumes.
    pub fn points<const D: usize>(self) -> Vec<(SVector<f64, D>, f64)> {
        let grid = self.grid::<D>();
        let mut points = lattice(&grid, grid.min(), grid.max(), [self.per_cell; D]);
        match self.order {
            Order::Cells => {
                points.sort_by_cached_key(|(x, _)| grid.linear(&grid.locate(x).expect("inside")));
            }
            Order::Shuffled => shuffle(&mut points),
        }
        points
    }

    /// A stepper with quadratic B-splines and lumped velocity mass.
    pub fn simulation<const D: usize, R, L>(
        self,
        reconstruction: R,
        law: L,
        mass: VelocityMass,
    ) -> Box<dyn Simulation<D> + Send>
    where
        R: Reconstruction<f64, D> + Clone + Send + 'static,
        L: ConstitutiveLaw<f64, D, State: Send + Record<f64>> + Clone + Send + 'static,
    {
        let mut particles = Particles::at_rest(&self.points(), DENSITY);
        for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
            *v = velocity(x);
        }
        let setup = Setup::new(
            self.grid(),
            BSpline::<2>,
            reconstruction,
            law,
            OnePhase,
            particles,
        )
        .with_velocity_mass(MassModel::preferring(mass));
        Box::new(Stepper::new(setup).expect("a valid setup"))
    }
}

/// Nowhere zero for long: tiny numbers would be denormal and slow.
pub fn velocity<const D: usize>(x: &SVector<f64, D>) -> SVector<f64, D> {
    x.map(|x| SPEED * ((std::f64::consts::PI * x).sin() + 0.1))
}

/// No wall lets anything through, and nothing sticks to it.
pub fn walls<const D: usize>() -> Forcing<f64, D> {
    let mut forcing = Forcing::none();
    for axis in 0..D {
        for side in [Side::Min, Side::Max] {
            forcing.set_face(Face { axis, side }, FaceCondition::roller(axis));
        }
    }
    forcing
}

/// Fisher and Yates, with a fixed sequence.
fn shuffle<A>(items: &mut [A]) {
    let mut seed = 1_u64;
    for i in (1..items.len()).rev() {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        items.swap(i, (seed >> 33) as usize % (i + 1));
    }
}
