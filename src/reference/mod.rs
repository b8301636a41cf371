//! Exact and converged solutions for a one-phase continuum and for saturated soil, against which the errors
//! of material point runs are measured.
//!
//! SI units, stresses positive in tension, `f64` throughout. Every solution is asked by *material* point: the
//! state at time `t` of the point that was at `x0` at time 0, because that is what a material point of the
//! method carries.
//!
//! | solution | nature | benchmark |
//! |---|---|---|
//! | [`VibratingBar`] | closed form | bar with fixed ends, small strain |
//! | [`StaticColumn`] | closed form | column under its weight, at rest, small or large strain |
//! | [`LagrangianBar`] | converged numerically, with an estimate of its own error | bar and column in motion, any elastic law, until waves break |
//! | [`EntropyBar`] | converged numerically, with an estimate of its own error | the same with shocks |
//! | [`Consolidation`](two_phase::Consolidation) | closed form | consolidation, small strain |
//! | [`XieLeo`](two_phase::XieLeo) | closed form | consolidation, large strain, without inertia |
//! | [`StandingWave`](two_phase::StandingWave) | closed form | damped waves in saturated soil, small strain |
//! | [`SaturatedColumn`](two_phase::SaturatedColumn) | closed form | saturated column under its weight, at rest |
//! | [`LagrangianSoil`](two_phase::LagrangianSoil) | converged numerically, with an estimate of its own error | saturated soil in motion, any elastic law |
//! | [`Manufactured`] | closed form | waves in a box on rollers, finite strain, any dimension |
//! | [`Elastica`] | converged numerically | slender cantilever bent far by a force at its tip, static |
//! | [`Vortex`] | closed form | a ring sheared and turned at finite strain, two and three dimensions |
//!
//! Soil has its own state and trait, see [`two_phase`].
//!
//! The benchmarks are those of Wobbes, Möller, Galavi and Vuik, *Conservative Taylor least squares
//! reconstruction with application to material point methods*, Int. J. Numer. Methods Eng. 117 (2019), doi
//! 10.1002/nme.5956.

mod check;
mod entropy_bar;
mod error;
mod lagrangian_bar;
mod lobatto;
mod space;
mod static_column;
pub mod two_phase;
mod uniaxial_law;
mod vibrating_bar;

pub use entropy_bar::{EntropyBar, EntropyEstimate};
pub use error::ReferenceError;
pub use lagrangian_bar::{BarProblem, End, LagrangianBar, Resolution};
pub use space::{Elastica, FieldReference, FieldState, Manufactured, Ring, Swing, Vortex};
pub use static_column::{StaticColumn, Strain};
pub use uniaxial_law::{Hill, Hyperelastic, InvertibleLaw, Linear, Logarithmic, NeoHookean, UniaxialLaw};
pub use vibrating_bar::VibratingBar;

/// State of the reference at one material point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Displacement since time 0, m.
    pub displacement: f64,
    /// Velocity, m/s.
    pub velocity: f64,
    /// Cauchy stress, Pa, positive in tension.
    pub stress: f64,
}

/// A solution that material points can be compared with.
///
/// A time-dependent error should be taken at the time at which the compared quantity lives: the Euler-Cromer
/// velocity after `n` steps belongs to the time `(n - 1/2) dt`, so it is compared after
/// `advance((n - 0.5) * dt)`.
pub trait Reference {
    /// Prepares evaluation at `time`, s, at least 0.
    ///
    /// Calling it twice with the same time changes nothing. A closed form only remembers the time; a
    /// converged solution marches its solver, and starts again from 0 where `time` lies before the last one.
    ///
    /// # Errors
    /// [`ReferenceError::InvalidTime`] where `time` is negative or not finite; what else can go wrong is said
    /// by each solution.
    fn advance(&mut self, time: f64) -> Result<(), ReferenceError>;

    /// State, at the time of the last [`advance`](Reference::advance), of the material point that was at
    /// `x0`, m, at time 0. Before the first `advance` the time is 0.
    fn at(&self, x0: f64) -> State;
}
