//! Typed errors: what is wrong, where, and what to do.

use std::io;

use thiserror::Error;

use crate::face::Face;

/// A grid that cannot be built.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum GridError {
    /// A bound is infinite or not a number.
    #[error("grid: a bound of axis {axis} is not a finite number")]
    NotFinite {
        /// Axis at fault.
        axis: usize,
    },
    /// The box has no extent.
    #[error("grid: axis {axis} runs from {min} to {max}; max must be greater than min")]
    Empty {
        /// Axis at fault.
        axis: usize,
        /// Lower bound (m).
        min: f64,
        /// Upper bound (m).
        max: f64,
    },
    /// An axis has no cell.
    #[error("grid: axis {axis} has 0 cells; at least 1 is needed")]
    NoCells {
        /// Axis at fault.
        axis: usize,
    },
    /// More cells than a 32-bit index can tell apart.
    #[error("grid: too many cells; fewer than 2^32 are possible")]
    TooManyCells,
}

/// A stepper that cannot be built.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SetupError {
    /// No particle at all.
    #[error("there is no particle: a run needs at least one")]
    NoParticles,
    /// Particle data of different lengths.
    #[error("particle data have different lengths: {name} has {found}, positions have {expected}")]
    Lengths {
        /// Name of the field at fault.
        name: &'static str,
        /// Its length.
        found: usize,
        /// Number of positions.
        expected: usize,
    },
    /// Domains that the basis does not ask for.
    #[error("particles have {name}, which the basis does not ask for; clear Particles::domains")]
    UnwantedDomains {
        /// Name of the field at fault.
        name: &'static str,
    },
    /// A reconstruction that knows no liquid beyond one axis.
    #[error(
        "relaxed Taylor least squares know one phase only beyond one axis so far; with a liquid that flows use Shepard or Taylor"
    )]
    OnePhaseOnly,
    /// A series of the particles' matrix beyond one axis with a basis whose DOFs have no places.
    #[error(
        "a series of the consistent mass wants a basis that is a product along the axes and reproduces linear functions"
    )]
    NoPlaces,
    /// A series of the particles' matrix with a liquid that flows.
    #[error("a series of the consistent mass knows one phase only so far")]
    SeriesWithFlow,
    /// A transfer from the grid with what it does not serve.
    #[error("a transfer that gives particles their velocities from the grid needs {reason}")]
    FromGrid {
        /// What it needs, and why.
        reason: &'static str,
    },
    /// A basis whose functions bend within a cell.
    #[error(
        "the basis is no polynomial of degree {degree} along axis {axis} in cell {cell}: beyond one axis relaxed Taylor least \
         squares need one in each cell; use Shepard or Taylor, or a basis that is (linear, dual domain, B-splines)"
    )]
    NotPolynomial {
        /// Axis along which it bends.
        axis: usize,
        /// Index of the cell along it.
        cell: u32,
        /// What [`degree`](crate::basis::BasisFamily::degree) says.
        degree: usize,
    },
    /// A particle outside the grid.
    #[error("particle {particle} starts at {position:?}, outside the grid")]
    Outside {
        /// Index of the particle.
        particle: usize,
        /// Its position (m).
        position: Vec<f64>,
    },
    /// A mass, volume, velocity or stress that makes no sense.
    #[error("particle {particle} has {name} = {value}; {allowed}")]
    Value {
        /// Index of the particle.
        particle: usize,
        /// Name of the quantity.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A stress at the start that the law cannot bear.
    #[error(
        "particle {particle} at {position:?} m starts under {}; {allowed}",
        named(stress)
    )]
    InitialStress {
        /// Index of the particle.
        particle: usize,
        /// Its position (m).
        position: Vec<f64>,
        /// Components of the stress (Pa) by name.
        stress: Vec<(String, f64)>,
        /// What the law bears instead.
        allowed: String,
    },
    /// Material constants that make no sense.
    #[error("{name} = {value}; {allowed}")]
    Constant {
        /// Name of the constant.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
}

/// Components of a stress (Pa) in words, as messages have them.
pub fn named(stress: &[(String, f64)]) -> String {
    let each = stress
        .iter()
        .map(|(name, value)| format!("{name} = {value:.4e} Pa"));
    each.collect::<Vec<_>>().join(", ")
}

impl SetupError {
    /// The same with another number of the particle that it names.
    #[must_use]
    pub(crate) fn renumbered(mut self, number: impl Fn(usize) -> usize) -> Self {
        if let Self::Outside { particle, .. }
        | Self::Value { particle, .. }
        | Self::InitialStress { particle, .. } = &mut self
        {
            *particle = number(*particle);
        }
        self
    }
}

/// A step that could not be completed; the particles hold the state in which it was noticed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum StepError {
    /// A particle is no longer in the grid.
    #[error("step {step}: particle {particle} left the grid at {position:?} m")]
    LeftGrid {
        /// Number of the step, from 1.
        step: usize,
        /// Index of the particle.
        particle: usize,
        /// Where it went (m).
        position: Vec<f64>,
    },
    /// A particle's volume is zero or negative, or a number is no longer finite.
    #[error("step {step}: {name} of particle {particle} became {value}")]
    Invalid {
        /// Number of the step, from 1.
        step: usize,
        /// Index of the particle.
        particle: usize,
        /// Name of the quantity.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A stress beyond what the law has a meaning for.
    #[error("step {step}: the stress of particle {particle} became {value} Pa; {allowed}")]
    Stress {
        /// Number of the step, from 1.
        step: usize,
        /// Index of the particle.
        particle: usize,
        /// The stress along axis 0 (Pa).
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Friction at a face, with particles that take their velocities from the grid.
    #[error(
        "the face {face} is to rub, but particles take their velocities from the grid; with such a transfer let it \
         be held or free, or take FLIP"
    )]
    FrictionFromGrid {
        /// The face.
        face: Face,
    },
    /// A wall at a face where DOFs that it does not hold have a value.
    #[error(
        "the face {face} cannot be held: DOF {dof} has a value there that the basis does not name; \
         `for_each_on_face` must, or HOLDS_ABOUT say so"
    )]
    WallNotHeld {
        /// The face.
        face: Face,
        /// A DOF that is left out.
        dof: usize,
    },
    /// A wall that rubs with a coefficient or a velocity that makes no sense.
    #[error(
        "the face {face} is to rub with a coefficient of {coefficient}; it must be finite and not negative, and the wall's velocity finite"
    )]
    Friction {
        /// The face.
        face: Face,
        /// Its coefficient.
        coefficient: f64,
    },
    /// A wall that rubs and moves along its normal.
    #[error(
        "the face {face} is to rub and to move at {velocity} m/s along its normal; a wall that rubs runs along itself \
         (velocity without friction holds what is at the face)"
    )]
    RubbingAcross {
        /// The face.
        face: Face,
        /// Component of its velocity (m/s) along the face's axis.
        velocity: f64,
    },
    /// A pressure outside the pores, where no liquid flows through them.
    #[error(
        "the face {face} has a pore pressure, but no liquid flows through the pores of this phase; leave it \
         out"
    )]
    PressureWithoutFlow {
        /// The face.
        face: Face,
    },
    /// A value at a face for what diffuses, where nothing does.
    #[error(
        "the face {face} has a value for what diffuses, but nothing diffuses in this phase; leave it out"
    )]
    ValueWithoutDiffusion {
        /// The face.
        face: Face,
    },
    /// A value at a face for what diffuses that is no number.
    #[error("the face {face} has the value {value} for what diffuses; it must be finite")]
    DiffusingValue {
        /// The face.
        face: Face,
        /// The value.
        value: f64,
    },
    /// The step size is not a positive number.
    #[error("the time step is {value} s; it must be positive and finite")]
    StepSize {
        /// The step asked for (s).
        value: f64,
    },
}

/// A saved state that a stepper cannot take over.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RestoreError {
    /// It cannot be read, or ends early.
    #[error("the state cannot be read ({0})")]
    Read(#[from] io::Error),
    /// It is that of another stepper.
    #[error("the state has {found} {what}; expected {expected}")]
    Other {
        /// What there is another number of.
        what: &'static str,
        /// Its number in the state.
        found: usize,
        /// Its number in the stepper.
        expected: usize,
    },
    /// It was changed.
    #[error("the state is damaged: {what} {index} makes no sense")]
    Invalid {
        /// What is wrong.
        what: &'static str,
        /// Which of them.
        index: usize,
    },
    /// Particles that no run leaves behind.
    #[error("the state is damaged: {0}")]
    Particles(#[from] SetupError),
}
