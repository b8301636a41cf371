//! The vibrating bar at small strain, exactly.

use std::f64::consts::PI;

use super::check;
use super::{Reference, ReferenceError, State};

/// A linear elastic bar with both ends fixed, vibrating in its first mode at small strain: exact.
///
/// With `w = pi sqrt(E / rho) / L` and the distance `X` from the left end,
///
/// * `u = v0 / w sin(w t) sin(pi X / L)`,
/// * `v = v0 cos(w t) sin(pi X / L)`,
/// * `sigma = v0 sqrt(E rho) sin(w t) cos(pi X / L)`,
///
/// which solves `rho u_tt = E u_XX` from `u = 0`, `v = v0 sin(pi X / L)`. Source: doi 10.1002/nme.5956,
/// vibrating bar; the amplitude of the stress is printed there with `sqrt(E / rho)`, which has not even the
/// unit of a stress.
#[derive(Clone, Debug, PartialEq)]
pub struct VibratingBar {
    length: f64,
    density: f64,
    youngs_modulus: f64,
    velocity: f64,
    origin: f64,
    time: f64,
}

impl VibratingBar {
    /// A bar of `length`, m, `density`, kg/m3, and `youngs_modulus`, Pa, with the largest initial `velocity`,
    /// m/s, in its middle, and its left end at 0.
    ///
    /// # Errors
    /// Where a parameter is not finite, or length, density or Young's modulus not positive.
    pub fn new(
        length: f64,
        density: f64,
        youngs_modulus: f64,
        velocity: f64,
    ) -> Result<Self, ReferenceError> {
        Ok(Self {
            length: check::positive("length", length)?,
            density: check::positive("density", density)?,
            youngs_modulus: check::positive("Young's modulus", youngs_modulus)?,
            velocity: check::finite("velocity", velocity)?,
            origin: 0.0,
            time: 0.0,
        })
    }

    /// The same bar with its left end at `origin`, m.
    ///
    /// # Errors
    /// Where `origin` is not finite.
    pub fn with_origin(self, origin: f64) -> Result<Self, ReferenceError> {
        Ok(Self {
            origin: check::finite("origin", origin)?,
            ..self
        })
    }

    /// Time of one oscillation, `2 L sqrt(rho / E)`, s.
    pub fn period(&self) -> f64 {
        2.0 * PI / self.angular_frequency()
    }

    /// `pi sqrt(E / rho) / L`, 1/s.
    fn angular_frequency(&self) -> f64 {
        PI * (self.youngs_modulus / self.density).sqrt() / self.length
    }
}

impl Reference for VibratingBar {
    fn advance(&mut self, time: f64) -> Result<(), ReferenceError> {
        self.time = check::time(time)?;
        Ok(())
    }

    /// Outside the bar the formulas simply continue, which no material point of the bar can notice.
    fn at(&self, x0: f64) -> State {
        let frequency = self.angular_frequency();
        let impedance = (self.youngs_modulus * self.density).sqrt();
        let (sin_t, cos_t) = (frequency * self.time).sin_cos();
        let (sin_x, cos_x) = (PI * (x0 - self.origin) / self.length).sin_cos();
        State {
            displacement: self.velocity / frequency * sin_t * sin_x,
            velocity: self.velocity * cos_t * sin_x,
            stress: self.velocity * impedance * sin_t * cos_x,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The small-strain benchmark, moved and stretched so that no factor is 1 by accident.
    fn bar() -> VibratingBar {
        VibratingBar::new(1.7, 2e3, 7e6, 0.28)
            .unwrap()
            .with_origin(-0.4)
            .unwrap()
    }

    fn state(time: f64, x0: f64) -> State {
        let mut bar = bar();
        bar.advance(time).unwrap();
        bar.at(x0)
    }

    /// Central difference of fourth order, whose error here is 1e-11 of the derivative.
    fn derivative(f: impl Fn(f64) -> f64, x: f64, step: f64) -> f64 {
        let near = f(x + step) - f(x - step);
        let far = f(x + 2.0 * step) - f(x - 2.0 * step);
        (8.0 * near - far) / (12.0 * step)
    }

    fn assert_close(a: f64, b: f64, scale: f64) {
        assert!((a - b).abs() < 1e-9 * scale, "{a} against {b}, scale {scale}");
    }

    #[test]
    fn satisfies_motion_kinematics_and_elasticity() {
        let frequency = bar().angular_frequency();
        let (x_step, t_step) = (1e-3, 1e-3 / frequency);
        for (t, x) in [(1e-3, 0.1), (7e-3, 0.9), (2.3e-2, -0.3)] {
            let velocity = derivative(|t| state(t, x).displacement, t, t_step);
            assert_close(velocity, state(t, x).velocity, 0.28);

            let strain = derivative(|x| state(t, x).displacement, x, x_step);
            assert_close(7e6 * strain, state(t, x).stress, 0.28 * (7e6_f64 * 2e3).sqrt());

            let acceleration = derivative(|t| state(t, x).velocity, t, t_step);
            let force = derivative(|x| state(t, x).stress, x, x_step);
            assert_close(2e3 * acceleration, force, 2e3 * 0.28 * frequency);
        }
    }

    #[test]
    fn satisfies_initial_and_boundary_conditions() {
        let start = state(0.0, 0.45);
        assert_eq!((start.displacement, start.stress), (0.0, 0.0));
        assert_close(start.velocity, 0.28, 0.28);
        for end in [-0.4, 1.3] {
            assert_close(state(7e-3, end).displacement, 0.0, 1e-3);
            assert_close(state(7e-3, end).velocity, 0.0, 0.28);
        }
    }

    #[test]
    fn returns_after_a_period() {
        let period = bar().period();
        assert_close(period, 2.0 * 1.7 * (2e3_f64 / 7e6).sqrt(), period);
        assert_close(state(period + 1e-3, 0.1).stress, state(1e-3, 0.1).stress, 3.4e4);
        assert!((state(0.5 * period + 1e-3, 0.1).stress - state(1e-3, 0.1).stress).abs() > 1e3);
    }

    #[test]
    fn refuses_bad_parameters_and_times() {
        assert!(VibratingBar::new(0.0, 1.0, 1.0, 1.0).is_err());
        assert!(VibratingBar::new(1.0, -1.0, 1.0, 1.0).is_err());
        assert!(VibratingBar::new(1.0, 1.0, f64::INFINITY, 1.0).is_err());
        assert!(VibratingBar::new(1.0, 1.0, 1.0, f64::NAN).is_err());
        assert!(bar().with_origin(f64::NAN).is_err());
        assert_eq!(
            bar().advance(-1.0),
            Err(ReferenceError::InvalidTime { time: -1.0 })
        );
    }
}
