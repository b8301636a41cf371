//! What a reference solution refuses.

use thiserror::Error;

/// Why a reference solution cannot be built or evaluated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// A parameter that must be positive is not.
    #[error("{name} must be positive and finite, not {value}")]
    NotPositive {
        /// The parameter.
        name: &'static str,
        /// Its value, in SI units.
        value: f64,
    },

    /// A parameter or a user's function is infinite or not a number.
    #[error("{name} must be finite, not {value}")]
    NotFinite {
        /// The parameter or function.
        name: &'static str,
        /// Its value, in SI units.
        value: f64,
    },

    /// A porosity is not a part of a whole.
    #[error("porosity must lie between 0 and 1, exclusive, not {value}")]
    InvalidPorosity {
        /// The porosity.
        value: f64,
    },

    /// A solution exists for one law of the permeability only.
    #[error("the permeability must follow k = k0 lambda^{required} here, not lambda^{exponent}")]
    WrongPermeability {
        /// The exponent of the soil.
        exponent: f64,
        /// The exponent that the solution is for.
        required: f64,
    },

    /// A number of elements or a polynomial degree is out of range.
    #[error("{name} must lie between {lowest} and {highest}, not {value}")]
    OutOfRange {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: usize,
        /// The smallest that is allowed.
        lowest: usize,
        /// The largest that is allowed.
        highest: usize,
    },

    /// A law that solutions along one axis do not know.
    #[error("there is no solution along one axis for the law {law}")]
    UnknownLaw {
        /// Its name in scenes.
        law: &'static str,
    },

    /// A motion whose material would turn inside out.
    #[error("amplitude {amplitude} m folds the material; expected less than {largest} m")]
    Folds {
        /// The amplitude, m.
        amplitude: f64,
        /// The bound, m.
        largest: f64,
    },

    /// A time lies before the start or is not finite.
    #[error("time must be finite and at least 0 s, not {time} s")]
    InvalidTime {
        /// The time, s.
        time: f64,
    },

    /// A load asks for more tension than Hill's law can bear: its stress stays below Young's modulus.
    #[error("no equilibrium: stress {stress} Pa reaches Young's modulus {youngs_modulus} Pa")]
    NoEquilibrium {
        /// The stress, in a column that at its fixed base, Pa.
        stress: f64,
        /// Young's modulus, Pa.
        youngs_modulus: f64,
    },

    /// The material is turned inside out, or its stretch is no longer a number.
    #[error("stretch {stretch} at X = {position} m and t = {time} s is not positive and finite")]
    InvalidStretch {
        /// Time of the step in which it happened, s.
        time: f64,
        /// Material coordinate, m.
        position: f64,
        /// The stretch J.
        stretch: f64,
    },

    /// The law's tangent stiffness is not positive, so that waves have no speed and the problem is ill-posed.
    #[error("stiffness {stiffness} Pa at stretch {stretch} is not positive and finite")]
    NotHyperbolic {
        /// The stretch J.
        stretch: f64,
        /// Tangent stiffness, Pa.
        stiffness: f64,
    },

    /// A velocity is infinite or not a number.
    #[error("velocity {velocity} m/s at X = {position} m and t = {time} s is not finite")]
    InvalidVelocity {
        /// Time, s.
        time: f64,
        /// Material coordinate, m.
        position: f64,
        /// The velocity, m/s.
        velocity: f64,
    },

    /// The stable time step is too small to change the time any more.
    #[error("the stable time step {step} s vanishes against the time {time} s")]
    StepTooSmall {
        /// Time, s.
        time: f64,
        /// Stable step, s.
        step: f64,
    },
}
