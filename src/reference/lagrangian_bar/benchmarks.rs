//! The two one-phase benchmarks of doi 10.1002/nme.5956.

use std::f64::consts::PI;

use super::super::{ReferenceError, UniaxialLaw, check};
use super::{BarProblem, End, LagrangianBar, Resolution};

/// Relative error of the stress, large-strain bar: 1e-12 at 0.1 s, 1e-10 at 0.5 s.
const BAR: Resolution = Resolution {
    elements: 32,
    degree: 8,
};
/// Relative error of the stress at 0.5 s: 2e-8, which the kink of the load limits.
const COLUMN: Resolution = Resolution {
    elements: 32,
    degree: 8,
};

impl<L: UniaxialLaw> LagrangianBar<L> {
    /// The vibrating bar: both ends fixed, initial velocity `velocity sin(pi X / length)`; length in m,
    /// density in kg/m3, velocity in m/s. The law carries Young's modulus.
    ///
    /// Any law but the linear one steepens the waves until they break. Under Hill's law the bar is an
    /// isothermal gas in a closed pipe: its two waves of amplitude `velocity / 2` break at about
    /// `2 length / (pi velocity)`, whatever the modulus. Here 0.8 m/s on 1 m breaks at 0.792 s and 0.08 m/s
    /// at 8.0 s. Up to then energy is conserved exactly and the solution converges; from then on it does not.
    ///
    /// # Errors
    /// As [`new`](LagrangianBar::new).
    pub fn vibrating_bar(length: f64, density: f64, velocity: f64, law: L) -> Result<Self, ReferenceError> {
        check::finite("velocity", velocity)?;
        let problem = BarProblem::new(length, density, law)
            .initial_velocity(move |x| velocity * (PI * x / length).sin());
        Self::new(problem, BAR)
    }

    /// The compacting column: base fixed, top free, at rest, under the body force
    /// `body_force min(t / ramp, 1)`; height in m, density in kg/m3, body force in N/kg (negative towards the
    /// base), ramp in s. The law carries Young's modulus.
    ///
    /// # Errors
    /// Where `ramp` is not positive, and as [`new`](LagrangianBar::new).
    pub fn column(
        height: f64,
        density: f64,
        body_force: f64,
        ramp: f64,
        law: L,
    ) -> Result<Self, ReferenceError> {
        check::finite("body force", body_force)?;
        check::positive("ramp", ramp)?;
        let problem = BarProblem::new(height, density, law)
            .ends(End::Fixed, End::Free)
            .body_force(move |t| body_force * (t / ramp).min(1.0), &[ramp]);
        Self::new(problem, COLUMN)
    }
}
