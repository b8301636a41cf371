//! Bodies on a line and the steppers that move them.

use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::ConstitutiveLaw;
use materialpoint::mass::VelocityMass;
use materialpoint::method::{self, Method, ReconstructionKind};
use materialpoint::particles::Particles;
use materialpoint::record::Record;
use materialpoint::stepper::{Simulation, SurfacePoint};
use materialpoint_steppers::Parts;
use nalgebra::vector;

use crate::compiled::{self, parts};

/// The bases of the papers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    Linear,
    DualDomain,
    BSpline,
}

/// Reconstructions, published TLS with either mass behind the DOF velocities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rebuilt {
    Shepard,
    TaylorLumped,
    TaylorConsistent,
    Relaxed,
}

use Basis::*;
use Rebuilt::*;

pub type Variant = (Basis, Rebuilt);

/// Every basis with every reconstruction.
pub fn variants() -> impl Iterator<Item = Variant> {
    [Shepard, TaylorLumped, TaylorConsistent, Relaxed]
        .into_iter()
        .flat_map(|rebuilt| [Linear, DualDomain, BSpline].map(|basis| (basis, rebuilt)))
}

pub const LEFT: Face = face(Side::Min);
pub const RIGHT: Face = face(Side::Max);

const fn face(side: Side) -> Face {
    Face { axis: 0, side }
}

/// Particles of one or more bodies on a grid from 0 to `length`.
#[derive(Clone, Debug)]
pub struct Bodies<L> {
    pub law: L,
    pub length: f64,
    pub cells: usize,
    pub particles: Particles<f64, 1>,
    pub surface: Vec<SurfacePoint<f64>>,
}

impl<L: ConstitutiveLaw<f64, 1, State: Record<f64>> + Copy + 'static> Bodies<L> {
    /// No body yet.
    pub fn on_grid(law: L, length: f64, cells: usize) -> Self {
        Self {
            law,
            length,
            cells,
            particles: Particles::default(),
            surface: Vec::new(),
        }
    }

    /// With a body from `start` to `end`, evenly filled; `surfaces` says whether its ends are known to be
    /// surfaces.
    pub fn with_body(mut self, [start, end]: [f64; 2], count: usize, density: f64, surfaces: bool) -> Self {
        let volume = (end - start) / count as f64;
        let points: Vec<_> = (0..count)
            .map(|k| (vector![start + (k as f64 + 0.5) * volume], volume))
            .collect();
        let first = self.particles.len();
        self.append(Particles::at_rest(&points, density));
        let ends = [(LEFT, first), (RIGHT, first + count - 1)];
        if surfaces {
            self.surface.extend(ends.map(|(face, particle)| SurfacePoint {
                particle,
                face,
                area: 1.0,
                reach: 0.5,
                loaded: true,
            }));
        }
        self
    }

    /// With a velocity that depends on the place.
    pub fn moving(mut self, velocity: impl Fn(f64) -> f64) -> Self {
        let particles = &mut self.particles;
        for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
            v[0] = velocity(x[0]);
        }
        self
    }

    fn append(&mut self, more: Particles<f64, 1>) {
        let all = &mut self.particles;
        all.initial_position.extend(more.initial_position);
        all.position.extend(more.position);
        all.displacement.extend(more.displacement);
        all.velocity.extend(more.velocity);
        all.stress.extend(more.stress);
        all.mass.extend(more.mass);
        all.volume.extend(more.volume);
        all.state.extend(more.state);
        all.phase.extend(more.phase);
    }

    /// The stepper of a variant.
    pub fn simulation(&self, (basis, rebuilt): Variant) -> Box<dyn Simulation<1>> {
        let basis = match basis {
            Linear => method::Basis::Linear,
            DualDomain => method::Basis::DualDomain,
            BSpline => method::Basis::BSpline { degree: 2 },
        };
        let (reconstruction, mass) = match rebuilt {
            Shepard => (ReconstructionKind::Shepard, VelocityMass::Lumped),
            TaylorLumped => (ReconstructionKind::Taylor, VelocityMass::Lumped),
            TaylorConsistent => (ReconstructionKind::Taylor, VelocityMass::Consistent),
            Relaxed => (ReconstructionKind::RelaxedTaylor, VelocityMass::Constrained),
        };
        let grid = Grid::new(vector![0.0], vector![self.length], [self.cells]).unwrap();
        let parts = Parts {
            surface: self.surface.clone(),
            ..parts(grid, self.law, self.particles.clone())
        };
        compiled::simulation(Method::new(basis, reconstruction), mass, parts)
    }
}
