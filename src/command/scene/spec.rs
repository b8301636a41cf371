//! The parts of a scene, checked and ready to use.

use super::{Expression, ExpressionError};
use materialpoint::grid::Face;
use materialpoint::mass::VelocityMass;
use materialpoint::method::{self, Basis, ReconstructionKind};
use materialpoint::phase::TwoPhase;

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
    /// A fraction of the largest stable step, or for plain MPM of a lower bound of it, renewed as the run
    /// goes.
    Auto {
        /// The fraction, above 0 and at most 1; that of the method unless told
        /// ([`Scene::safety`](super::Scene::safety)).
        safety: Option<f64>,
    },
}

/// When a run ends and how it gets there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeSpec {
    /// Size of a step.
    pub step: StepSize,
    /// End of the run (s), positive.
    pub end: f64,
    /// Whether the first kick is half a step, so that velocities given at the start are those of time zero
    /// and the run is of second order in time; otherwise they count as those of half a step before, as in the
    /// papers.
    pub half_kick: bool,
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
    /// Sub-points of each particle's domain, 1 to 128; more than one with dual domain and Shepard along one
    /// axis only.
    pub subpoints: u8,
    /// Whether cells whose particles do not determine their fit borrow virtual points; Taylor in one
    /// dimension only.
    pub virtual_points: bool,
    /// Mass behind the DOFs' velocities; lumped for Shepard, constrained for relaxed Taylor.
    pub velocity_mass: VelocityMass,
    /// Floating-point type.
    pub scalar: ScalarKind,
}

impl Method {
    /// Fraction of the largest stable step that keeps the energy of bodies whose particles cross cells within
    /// some per cent (`docs/verification/stability.md`). Crossing hat functions gives every particle a small
    /// kick of no sign, the gradient's jump for a part of a step, that shrinks with the step alone.
    pub fn default_safety(&self) -> f64 {
        let hats = matches!(self.basis, Basis::Linear | Basis::BSpline { degree: 1 });
        match self.reconstruction {
            ReconstructionKind::Shepard if self.subpoints == 1 => {
                if hats {
                    0.1
                } else {
                    0.25
                }
            }
            // Of the largest stable step itself and no bound of it.
            _ => 0.4,
        }
    }

    /// Basis, reconstruction and sub-points alone.
    pub fn method(&self) -> method::Method {
        method::Method {
            basis: self.basis,
            reconstruction: self.reconstruction,
            subpoints: self.subpoints,
        }
    }

    /// The velocity mass of a scene that does not name one: lumped for Shepard and constrained for relaxed
    /// Taylor, which have no other, and consistent for the rest.
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
        /// Poisson's ratio, 0 in one dimension, which feels the modulus of uniaxial strain alone.
        poissons_ratio: f64,
    },
    /// `linear-elastic` with `strain = "large"`: Hill's rate, in one dimension `(E - stress)` times strain
    /// rate.
    Hill {
        /// Young's modulus (Pa), positive.
        youngs_modulus: f64,
        /// Poisson's ratio, 0 in one dimension, which feels the modulus of uniaxial strain alone.
        poissons_ratio: f64,
    },
    /// `neo-hookean`, large strain.
    NeoHookean {
        /// Young's modulus of the undeformed material (Pa), positive.
        youngs_modulus: f64,
        /// Poisson's ratio, 0 in one dimension, which feels the modulus of uniaxial strain alone.
        poissons_ratio: f64,
    },
    /// `logarithmic`, large strain: stress `E ln J` in one dimension, Hencky's law beyond.
    Logarithmic {
        /// Young's modulus of the undeformed material (Pa), positive.
        youngs_modulus: f64,
        /// Poisson's ratio, 0 in one dimension.
        poissons_ratio: f64,
    },
    /// A law of two and three dimensions only, large strain.
    InSpace(SpaceLaw),
}

/// A constitutive law of two and three dimensions with its constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpaceLaw {
    /// `st-venant-kirchhoff`.
    StVenantKirchhoff {
        /// Young's modulus (Pa), positive.
        youngs_modulus: f64,
        /// Poisson's ratio.
        poissons_ratio: f64,
    },
    /// `von-mises`, with linear isotropic hardening.
    VonMises {
        /// Young's modulus (Pa), positive.
        youngs_modulus: f64,
        /// Poisson's ratio.
        poissons_ratio: f64,
        /// Yield stress in uniaxial tension (Pa), positive.
        yield_stress: f64,
        /// Hardening modulus (Pa), not negative; default 0.
        hardening: f64,
    },
    /// `drucker-prager`, matched to Mohr and Coulomb in plane strain.
    DruckerPrager {
        /// Young's modulus (Pa), positive.
        youngs_modulus: f64,
        /// Poisson's ratio.
        poissons_ratio: f64,
        /// Cohesion (Pa), not negative; default 0.
        cohesion: f64,
        /// Friction angle (degrees), 0 or more and below 90.
        friction_angle: f64,
        /// Dilation angle (degrees), 0 to the friction angle; default 0.
        dilation_angle: f64,
    },
    /// `newtonian-fluid`, weakly compressible, which bears no tension.
    NewtonianFluid {
        /// Bulk modulus at rest (Pa), positive.
        bulk_modulus: f64,
        /// Exponent of the equation of state, at least 1; default 7.
        gamma: f64,
        /// Dynamic viscosity (Pa s), not negative; default 0.
        viscosity: f64,
    },
}

impl SpaceLaw {
    /// Name in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::StVenantKirchhoff { .. } => "st-venant-kirchhoff",
            Self::VonMises { .. } => "von-mises",
            Self::DruckerPrager { .. } => "drucker-prager",
            Self::NewtonianFluid { .. } => "newtonian-fluid",
        }
    }
}

impl Law {
    /// Name in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::LinearElastic { .. } | Self::Hill { .. } => "linear-elastic",
            Self::NeoHookean { .. } => "neo-hookean",
            Self::Logarithmic { .. } => "logarithmic",
            Self::InSpace(law) => law.name(),
        }
    }

    /// Whether it is one of large strain.
    pub fn large_strain(self) -> bool {
        !matches!(self, Self::LinearElastic { .. })
    }

    /// Young's modulus (Pa); of a fluid, which has none, its bulk modulus.
    pub fn youngs_modulus(self) -> f64 {
        match self {
            Self::LinearElastic { youngs_modulus, .. }
            | Self::Hill { youngs_modulus, .. }
            | Self::NeoHookean { youngs_modulus, .. }
            | Self::Logarithmic { youngs_modulus, .. }
            | Self::InSpace(
                SpaceLaw::StVenantKirchhoff { youngs_modulus, .. }
                | SpaceLaw::VonMises { youngs_modulus, .. }
                | SpaceLaw::DruckerPrager { youngs_modulus, .. }
                | SpaceLaw::NewtonianFluid {
                    bulk_modulus: youngs_modulus,
                    ..
                },
            ) => youngs_modulus,
        }
    }
}

/// What the material is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phases {
    /// A dry solid.
    One {
        /// Mass density at the start (kg/m3), positive.
        density: f64,
    },
    /// A solid whose pores are full of a liquid that moves with a velocity of its own.
    Two(TwoPhase<f64>),
}

impl Phases {
    /// How many there are.
    pub fn count(&self) -> usize {
        match self {
            Self::One { .. } => 1,
            Self::Two(_) => 2,
        }
    }
}

/// The material of every body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// The phases with their constants.
    pub phases: Phases,
    /// Constitutive law of the solid.
    pub law: Law,
}

impl Material {
    /// Density (kg/m3) of the particles' own mass at the start: of the solid with its pores, without a liquid
    /// in them.
    pub fn solid_density(&self) -> f64 {
        match self.phases {
            Phases::One { density } => density,
            Phases::Two(soil) => soil.dry_density(),
        }
    }
}

/// Where the expressions of a body's initial values are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Initialise {
    /// At the particles.
    #[default]
    Exact,
    /// At the DOFs' interpolation points, and interpolated to the particles.
    Dofs,
}

/// A symmetric stress by its components (Pa), expressions in `x`, `y`, `z`; one that is not given is zero.
#[derive(Clone, Debug, Default)]
pub struct StressSpec {
    /// Rows and columns with their expression, each pair once, the row not above the column.
    pub components: Vec<([usize; 2], Expression)>,
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
    /// Velocity at the start (m/s), in `x`, `y`, `z`; one expression per axis. Without it the body is at
    /// rest.
    pub velocity: Option<Vec<Expression>>,
    /// Where the body is, within its box: particles at which this is positive are kept, in `x`, `y`, `z`.
    /// Without it all are.
    pub inside: Option<Expression>,
    /// Stress at the start (Pa), tension positive, in `x`, `y`, `z`; with two phases the effective one.
    /// Without it the body is free of stress.
    pub stress: Option<StressSpec>,
    /// Velocity of the liquid at the start (m/s), as `velocity`. Without it the liquid moves with the solid.
    pub liquid_velocity: Option<Vec<Expression>>,
    /// Pore pressure at the start (Pa), tension positive, in `x`, `y`, `z`. Without it there is none.
    pub pore_pressure: Option<Expression>,
    /// Where these are taken.
    pub initialise: Initialise,
    /// How irregular the layout is: each particle is moved at random within this fraction of its spacing,
    /// 0 to 1.
    pub jitter: f64,
    /// Seed of the random layout.
    pub seed: u64,
}

/// Part of a length of the particles up to which two ends are one: round-off of coordinates that people
/// compute.
pub(crate) const FORGIVEN: f64 = 1e-8;

impl Body {
    /// Whether the body is at a point (m).
    ///
    /// # Errors
    /// If its shape has no finite value there.
    pub fn holds(&self, point: &[f64]) -> Result<bool, ExpressionError> {
        let mut bounds = point.iter().zip(self.min.iter().zip(&self.max));
        if bounds.any(|(x, (min, max))| x < min || x > max) {
            return Ok(false);
        }
        match &self.inside {
            Some(inside) => Ok(inside.eval_at(point)? > 0.0),
            None => Ok(true),
        }
    }
}

/// What holds at a face, for the solid with all in its pores.
#[derive(Clone, Debug)]
pub enum BoundaryKind {
    /// Nothing: the boundary is about the liquid only.
    Free,
    /// The grid's face does not move.
    Fixed,
    /// The material slides along the grid's face without friction and stays at it.
    Roller,
    /// A wall at the grid's face that nothing passes, that lets go and rubs.
    Frictional {
        /// Coefficient of friction, not negative.
        coefficient: f64,
        /// Velocity of the wall (m/s), in `t`; one expression per axis. At rest unless told.
        velocity: Option<Vec<Expression>>,
    },
    /// Material at the grid's face is held at this velocity (m/s), in `t`; one expression per axis. The face
    /// stays where it is.
    Velocity(Vec<Expression>),
    /// The bodies' surface that looks towards the face bears this force per area (Pa), in `t`; one expression
    /// per axis.
    Traction(Vec<Expression>),
}

/// What the liquid in the pores meets at a face.
#[derive(Clone, Debug)]
pub enum PoreBoundary {
    /// It does not pass.
    Sealed,
    /// It passes freely into the open, where the pressure is 0.
    Drained,
    /// It passes freely; the pressure outside (Pa, tension positive), in `t`.
    Pressure(Expression),
}

/// A face and what holds there; faces that no boundary names are free, and no liquid passes them.
#[derive(Clone, Debug)]
pub struct Boundary {
    /// The face.
    pub face: Face,
    /// What holds.
    pub kind: BoundaryKind,
    /// Where a traction acts: on particles of the surface at which this is positive at the start, in `x`,
    /// `y`, `z`. Without it on all.
    pub inside: Option<Expression>,
    /// What the liquid meets.
    pub pores: PoreBoundary,
}

impl Boundary {
    /// Whether the grid's face is held: fixed, a roller or told a velocity.
    pub fn is_held(&self) -> bool {
        matches!(
            self.kind,
            BoundaryKind::Fixed | BoundaryKind::Roller | BoundaryKind::Velocity(_)
        )
    }

    /// Whether it is a wall that rubs, and lets go.
    pub fn rubs(&self) -> bool {
        matches!(self.kind, BoundaryKind::Frictional { .. })
    }

    /// Whether liquid passes.
    pub fn is_open(&self) -> bool {
        !matches!(self.pores, PoreBoundary::Sealed)
    }
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
    /// `consolidation`, two phases: a layer on a fixed base under a load at its drained top; exact at small
    /// strain, converged at large strain. Its state at `start` is also the initial state of the body.
    Consolidation {
        /// Load on the top (Pa), not 0, negative in compression.
        load: f64,
        /// Time (s) of the solution at which the run starts; 0 at large strain.
        start: f64,
    },
    /// `xie-leo`, two phases: the same at large strain without inertia, for the logarithmic law and
    /// permeability exponent 2.
    XieLeo {
        /// Load on the top (Pa), not 0, negative in compression.
        load: f64,
    },
    /// `standing-wave`, two phases: both ends fixed, started with the fast damped wave, whose state at time 0
    /// is also the initial state of the body.
    StandingWave {
        /// Largest velocity of the solid at the start (m/s), not 0.
        velocity: f64,
        /// Half waves in the column, positive.
        mode: usize,
    },
    /// `self-weight`, two phases: a column on a fixed base, at rest under its weight.
    SelfWeight,
    /// `manufactured`, two and three dimensions: a neo-Hookean box on rollers, driven by the body force that
    /// makes waves of this amplitude exact. The initial state of the body is the reference's.
    Manufactured {
        /// Largest displacement (m), not 0.
        amplitude: f64,
    },
    /// `vortex`, two and three dimensions: a neo-Hookean ring about the middle of the grid, whose circles
    /// turn and come back, driven by a body force; the body may be larger than the ring. The initial state of
    /// the body is the reference's.
    Vortex {
        /// Inner radius (m), positive.
        inner: f64,
        /// Outer radius (m), above the inner one.
        outer: f64,
        /// Largest angle (rad), not 0.
        angle: f64,
        /// Time (s) after which the ring is back, positive.
        time: f64,
    },
}

impl ReferenceSpec {
    /// Name in scenes.
    pub fn name(&self) -> &'static str {
        match self {
            Self::VibratingBar { .. } => "vibrating-bar",
            Self::ColumnCompaction { .. } => "column-compaction",
            Self::Consolidation { .. } => "consolidation",
            Self::XieLeo { .. } => "xie-leo",
            Self::StandingWave { .. } => "standing-wave",
            Self::SelfWeight => "self-weight",
            Self::Manufactured { .. } => "manufactured",
            Self::Vortex { .. } => "vortex",
        }
    }

    /// How many phases it is about.
    pub fn phases(&self) -> usize {
        match self {
            Self::VibratingBar { .. }
            | Self::ColumnCompaction { .. }
            | Self::Manufactured { .. }
            | Self::Vortex { .. } => 1,
            Self::Consolidation { .. }
            | Self::XieLeo { .. }
            | Self::StandingWave { .. }
            | Self::SelfWeight => 2,
        }
    }

    /// Whether the initial state of the body is the reference's.
    pub fn gives_initial_state(&self) -> bool {
        matches!(
            self,
            Self::Consolidation { .. }
                | Self::XieLeo { .. }
                | Self::StandingWave { .. }
                | Self::Manufactured { .. }
                | Self::Vortex { .. }
        )
    }

    /// Whether it is one of so many axes.
    pub fn knows_dimension(&self, axes: usize) -> bool {
        match self {
            Self::Manufactured { .. } | Self::Vortex { .. } => axes > 1,
            _ => axes == 1,
        }
    }

    /// Time (s) of the reference at which the run starts.
    pub fn start(&self) -> f64 {
        match self {
            Self::Consolidation { start, .. } => *start,
            _ => 0.0,
        }
    }
}

/// File format of the particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ParticleOutput {
    /// `particles.csv`.
    #[default]
    Csv,
    /// `particles-000000.vtu`, ... from the start on, and their index `particles.pvd`, for ParaView.
    Vtu,
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
    /// Steps between checkpoints; 0 = none.
    pub checkpoint_every: usize,
}
