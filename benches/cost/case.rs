//! Cases: a method on a body that fills a closed box.

use std::error::Error;
use std::fmt;

use materialpoint::error::StepError;
use materialpoint::grid::{Face, Grid};
use materialpoint::law::{AnyLaw, LinearElastic, Moduli};
use materialpoint::mass::VelocityMass;
use materialpoint::method::{Method, ReconstructionKind};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{Drag, PoreLiquid, TwoPhase};
use materialpoint::scalar::Scalar;
use materialpoint::stepper::{FaceCondition, Forcing, Simulation};
use materialpoint_steppers::{Build, Parts};
use nalgebra::SVector;

/// Cells along each axis of a line, a plane and a cube.
const CELLS: [usize; 3] = [250, 24, 10];
/// Particles along each axis of a cell.
const PER_AXIS: [[usize; 3]; 3] = [[4, 8, 64], [2, 3, 8], [2, 3, 4]];

/// What is stepped.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    method: Method,
    mass: VelocityMass,
    dimension: usize,
    per_axis: usize,
    phases: usize,
    single: bool,
}

impl Case {
    /// All that there are.
    pub fn all() -> Vec<Self> {
        let mut cases = Vec::new();
        for (dimension, per_axis) in (1..).zip(PER_AXIS) {
            let precisions = if dimension == 1 {
                &[false, true][..]
            } else {
                &[false]
            };
            for (phases, &single) in [1, 2]
                .into_iter()
                .flat_map(|n| precisions.iter().map(move |s| (n, s)))
            {
                for method in Method::all_in(dimension, phases) {
                    for &mass in masses(method.reconstruction) {
                        cases.extend(per_axis.map(|per_axis| Self {
                            method,
                            mass,
                            dimension,
                            per_axis,
                            phases,
                            single,
                        }));
                    }
                }
            }
        }
        cases
    }

    /// Particles a cell.
    fn per_cell(&self) -> usize {
        self.per_axis.pow(self.dimension as u32)
    }

    fn cells(&self) -> usize {
        CELLS[self.dimension - 1].pow(self.dimension as u32)
    }

    pub fn particles(&self) -> usize {
        self.cells() * self.per_cell()
    }

    /// The body at its start.
    pub fn body(&self) -> Result<Box<dyn Body>, Box<dyn Error>> {
        match (self.dimension, self.single) {
            (1, false) => self.of::<f64, 1>(),
            (1, true) => self.of::<f32, 1>(),
            (2, _) => self.of::<f64, 2>(),
            _ => self.of::<f64, 3>(),
        }
    }

    fn of<T: Scalar, const D: usize>(&self) -> Result<Box<dyn Body>, Box<dyn Error>>
    where
        Parts<T, D>: Build<D>,
    {
        let cells = [CELLS[D - 1]; D];
        let grid = Grid::new(SVector::zeros(), SVector::repeat(1.0), cells)?;
        let points = lattice(&grid, grid.min(), grid.max(), [self.per_axis; D]);
        let mut particles: Particles<f64, D> = Particles::at_rest(&points, 1560.0);
        let mut pores = Vec::new();
        let smooth = |x: &SVector<f64, D>, a: usize| 0.01 * (1.0 + x[a] + 0.5 * x[(a + 1) % D]).sin();
        for (velocity, x) in particles.velocity.iter_mut().zip(&particles.position) {
            *velocity = SVector::from_fn(|a, _| smooth(x, a));
            pores.push(PoreLiquid {
                velocity: *velocity * 2.0,
                pressure: -1e4,
            });
        }
        let poissons_ratio = if D == 1 { 0.0 } else { 0.3 };
        let moduli = Moduli::from_young(T::lit(1e7), T::lit(poissons_ratio))?;
        let parts = Parts {
            grid: Grid::new(SVector::zeros(), SVector::repeat(T::one()), cells)?,
            law: AnyLaw::new(LinearElastic { moduli }),
            liquid: (self.phases == 2).then(|| liquid().cast()),
            velocity_mass: self.mass,
            virtual_points: false,
            particles,
            pores,
            surface: Vec::new(),
            under_stress: false,
        };
        let walls = Face::all::<D>().fold(Forcing::none(), |forcing, face| {
            forcing.with_face(face, FaceCondition::roller(face.axis))
        });
        Ok(Box::new((parts.stepper(self.method)?, walls)))
    }

    /// Whether the mass is one of several of the method.
    fn has_other_masses(&self) -> bool {
        masses(self.method.reconstruction).len() > 1
    }
}

/// Masses behind the velocities that are compared.
fn masses(reconstruction: ReconstructionKind) -> &'static [VelocityMass] {
    use VelocityMass::{Constrained, Lumped};
    match reconstruction {
        ReconstructionKind::Shepard => &[Lumped],
        ReconstructionKind::RelaxedTaylor => &[Constrained],
        ReconstructionKind::Taylor | ReconstructionKind::Spline => &[Lumped, Constrained],
    }
}

fn liquid() -> TwoPhase<f64> {
    TwoPhase {
        porosity: 0.4,
        solid_density: 2.6e3,
        liquid_density: 1e3,
        liquid_bulk_modulus: 3e8,
        permeability: 1e-4,
        permeability_exponent: 0.0,
        gravity: 9.81,
        drag: Drag::Implicit,
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = ["line", "plane", "space"][self.dimension - 1];
        let precision = if self.single { " f32" } else { "" };
        let phases = if self.phases == 2 { " two phases" } else { "" };
        write!(f, "{place}{precision}{phases}, {}", self.method)?;
        if self.has_other_masses() {
            write!(f, " {}", self.mass.name())?;
        }
        write!(f, ", {}", self.per_cell())
    }
}

/// A body that can be stepped.
pub trait Body {
    /// One step, far smaller than the critical one.
    ///
    /// # Errors
    /// Those of the stepper.
    fn step(&mut self) -> Result<(), StepError>;
}

impl<const D: usize> Body for (Box<dyn Simulation<D>>, Forcing<f64, D>) {
    fn step(&mut self) -> Result<(), StepError> {
        self.0.step(1e-7, &self.1)
    }
}
