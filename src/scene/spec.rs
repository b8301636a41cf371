//! The parts of a scene, checked and ready to use.

use super::Expression;
use crate::grid::Face;
use crate::mass::VelocityMass;
use crate::method::{self, Basis, ReconstructionKind};

/// The background grid: a box of equal cells, one number per axis.
#[derive(Clone, Debug, PartialEq)]
pub struct GridSpec {
    /// Lower corner (m).
    pub min: Vec<f64>,
    /// Upper corner (m).
    pub max: Vec<f64>,
    /// Cells along each axis.
    pub cells: Vec<usize>,
}

/// Size of a time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepSize {
    /// Always the same (s).
    Fixed(f64),
    /// A fraction of the largest stable step.
    Auto {
        /// The fraction, above 0 and at most 1; default 0.5.
        safety: f64,
    },
}

/// When a run ends and how it gets there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeSpec {
    /// Size of a step.
    pub step: StepSize,
    /// End of the run (s), positive.
    pub end: f64,
}

/// Floating-point type of the computation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ScalarKind {
    /// 64 bits, 16 digits.
    #[default]
    F64,
    /// 32 bits, 7 digits.
    F32,
}

/// The method of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    /// Basis family of the grid.
    pub basis: Basis,
    /// From particle data to integrals.
    pub reconstruction: ReconstructionKind,
    /// Mass behind the DOFs' velocities.
    pub velocity_mass: VelocityMass,
    /// Floating-point type.
    pub scalar: ScalarKind,
}

impl Method {
    /// Basis and reconstruction alone.
    pub fn method(&self) -> method::Method {
        method::Method::new(self.basis, self.reconstruction)
    }

    /// The velocity mass of a scene that does not name one: lumped for Shepard and constrained for relaxed Taylor, which
    /// have no other, and consistent for the rest.
    pub fn default_velocity_mass(reconstruction: ReconstructionKind) -> VelocityMass {
        match reconstruction {
            ReconstructionKind::Shepard => VelocityMass::Lumped,
            ReconstructionKind::Taylor | ReconstructionKind::Spline => VelocityMass::Consistent,
            ReconstructionKind::RelaxedTaylor => VelocityMass::Constrained,
        }
    }
}

/// Constitutive law with its constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// `linear-elastic` with `strain = "small"`: stress rate `E` times strain rate.
    LinearElastic {
        /// Young's modulus (Pa), positive.
        youngs_modulus: f64,
    },
    /// `linear-elastic` with `strain = "large"`: Hill's rate, in 1-D `(E - stress)` times strain rate.
    Hill {
        /// Young's modulus (Pa), positive.
        youngs_modulus: f64,
    },
    /// `neo-hookean`, large strain.
    NeoHookean {
        /// Young's modulus of the undeformed material (Pa), positive.
        youngs_modulus: f64,
    },
}

/// The material of every body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Mass density at the start (kg/m3), positive.
    pub density: f64,
    /// Constitutive law.
    pub law: Law,
}

/// A box filled with particles.
#[derive(Clone, Debug)]
pub struct Body {
    /// Lower corner (m).
    pub min: Vec<f64>,
    /// Upper corner (m).
    pub max: Vec<f64>,
    /// Particles per cell along each axis, positive.
    pub particles_per_cell: Vec<usize>,
    /// Velocity at the start (m/s), in `x`, `y`, `z`; one expression per axis. Without it the body is at rest.
    pub velocity: Option<Vec<Expression>>,
    /// Stress at the start (Pa), tension positive, in `x`, `y`, `z`. Without it the body is free of stress.
    pub stress: Option<Expression>,
    /// How irregular the layout is: each particle is moved at random within this fraction of its spacing,
    /// 0 to 1.
    pub jitter: f64,
    /// Seed of the random layout.
    pub seed: u64,
}

/// What holds at a face.
#[derive(Clone, Debug)]
pub enum BoundaryKind {
    /// The grid's face does not move.
    Fixed,
    /// The grid's face moves with this velocity (m/s), in `t`; one expression per axis.
    Velocity(Vec<Expression>),
    /// The bodies' surface that looks towards the face bears this force per area (Pa), in `t`; one expression
    /// per axis.
    Traction(Vec<Expression>),
}

/// A face and what holds there; faces that no boundary names are free.
#[derive(Clone, Debug)]
pub struct Boundary {
    /// The face.
    pub face: Face,
    /// What holds.
    pub kind: BoundaryKind,
}

/// Which solution of the column the errors are taken against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Against {
    /// The column at rest under the full load.
    Static,
    /// The column in motion.
    #[default]
    Dynamic,
}

/// A solution that the run is compared with. Density, law, length and supports are those of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReferenceSpec {
    /// `vibrating-bar`: both ends fixed, started with `velocity sin(pi X / length)`.
    VibratingBar {
        /// Largest velocity at the start (m/s), not 0.
        velocity: f64,
    },
    /// `column-compaction`: base fixed, top free, under `body_force min(t / ramp, 1)`.
    ColumnCompaction {
        /// Full body force (N/kg), not 0, negative towards the base.
        body_force: f64,
        /// Time over which the load grows (s), positive.
        ramp: f64,
        /// Column at rest or in motion.
        against: Against,
    },
}

/// File format of the particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ParticleOutput {
    /// `particles.csv`.
    #[default]
    Csv,
    /// No file.
    None,
}

/// What a run writes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct OutputSpec {
    /// Format of the particles.
    pub particles: ParticleOutput,
    /// Steps between outputs; 0 = the end only.
    pub every: usize,
}
