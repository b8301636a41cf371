//! Nyström's method of order 4 for `u'' = a(t, u)`.

/// Largest stable product of angular frequency and step.
///
/// On `u'' = -w^2 u`, with `z = (w dt)^2`, one step multiplies by a matrix of trace `2 - z + z^2/12` and
/// determinant `1 - z^3/288`. Both eigenvalues lie within the unit circle up to `z = 6.690`, the root of
/// `4 - z + z^2/12 - z^3/288`; below it an oscillation decays by the factor `1 - (w dt)^6/576` in each step,
/// which only unresolved modes feel.
pub(super) const STABILITY_LIMIT: f64 = 2.58;

/// Time, displacement and velocity of all nodes.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    /// s
    pub(super) time: f64,
    /// m
    pub(super) displacement: Vec<f64>,
    /// m/s
    pub(super) velocity: Vec<f64>,
}

impl Motion {
    /// Rest at time 0.
    pub(super) fn at_rest(nodes: usize) -> Self {
        Self {
            time: 0.0,
            displacement: vec![0.0; nodes],
            velocity: vec![0.0; nodes],
        }
    }
}

/// The method's work space.
///
/// Source: E. J. Nyström 1925; E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations
/// I*, section II.14. Where the acceleration does not depend on the velocity, the method has the order of the
/// classical Runge-Kutta method at three evaluations instead of four, and a smaller error.
#[derive(Clone, Debug)]
pub(super) struct Nystrom {
    stage: Vec<f64>,
    accelerations: [Vec<f64>; 3],
}

impl Nystrom {
    /// Work space for a number of `nodes`.
    pub(super) fn new(nodes: usize) -> Self {
        let zeros = || vec![0.0; nodes];
        Self {
            stage: zeros(),
            accelerations: [zeros(), zeros(), zeros()],
        }
    }

    /// Moves `motion` on by `step`, s.
    ///
    /// `acceleration` takes time and displacement and writes the acceleration. After its error `motion` is
    /// unchanged.
    pub(super) fn step<E>(
        &mut self,
        motion: &mut Motion,
        step: f64,
        mut acceleration: impl FnMut(f64, &[f64], &mut [f64]) -> Result<(), E>,
    ) -> Result<(), E> {
        let Self {
            stage,
            accelerations: [first, second, third],
        } = self;
        let Motion {
            time,
            displacement,
            velocity,
        } = motion;
        let half = 0.5 * step;

        acceleration(*time, displacement, first)?;
        drift(stage, displacement, velocity, half, first);
        acceleration(*time + half, stage, second)?;
        drift(stage, displacement, velocity, step, second);
        acceleration(*time + step, stage, third)?;

        let sixth = step / 6.0;
        let increments = first.iter().zip(&*second).zip(&*third);
        for ((u, v), ((a, b), c)) in displacement.iter_mut().zip(velocity).zip(increments) {
            *u += step * (*v + sixth * (a + 2.0 * b));
            *v += sixth * (a + 4.0 * b + c);
        }
        *time += step;
        Ok(())
    }
}

/// Writes the displacement after `step` under constant acceleration.
fn drift(out: &mut [f64], displacement: &[f64], velocity: &[f64], step: f64, acceleration: &[f64]) {
    let half = 0.5 * step;
    for (((out, u), v), a) in out.iter_mut().zip(displacement).zip(velocity).zip(acceleration) {
        *out = u + step * (v + half * a);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// State after `steps` steps to `end`, from displacement 0 and velocity 1.
    fn march(end: f64, steps: u32, acceleration: impl Fn(f64, f64) -> f64) -> (f64, f64) {
        let mut motion = Motion {
            time: 0.0,
            displacement: vec![0.0],
            velocity: vec![1.0],
        };
        let mut method = Nystrom::new(1);
        for _ in 0..steps {
            let result = method.step(&mut motion, end / f64::from(steps), |t, u, out| {
                out[0] = acceleration(t, u[0]);
                Ok::<(), Infallible>(())
            });
            assert!(result.is_ok());
        }
        (motion.displacement[0], motion.velocity[0])
    }

    /// `u'' = sin(sin t) - sin t - sin u`, which `u = sin t` solves: non-linear and driven.
    #[test]
    fn has_order_four_on_a_driven_nonlinear_oscillator() {
        let error = |steps| {
            let (u, v) = march(2.0, steps, |t, u| t.sin().sin() - t.sin() - u.sin());
            (u - 2.0_f64.sin()).abs().max((v - 2.0_f64.cos()).abs())
        };
        let order = (error(100) / error(200)).log2();
        assert!((3.9..4.1).contains(&order), "{order}");
    }

    #[test]
    fn is_stable_up_to_the_limit_and_not_beyond() {
        let amplitude = |step: f64| {
            let (u, v) = march(2000.0 * step, 2000, |_, u| -u);
            u.hypot(v)
        };
        assert!(amplitude(STABILITY_LIMIT) < 2.0);
        assert!(amplitude(STABILITY_LIMIT + 0.02) > 1e3);
    }

    #[test]
    fn damps_as_documented() {
        let (u, v) = march(0.5 * 400.0, 400, |_, u| -u);
        let decay = 1.0 - u.hypot(v).powf(1.0 / 400.0);
        let expected = 0.5_f64.powi(6) / 576.0;
        assert!(
            (decay / expected - 1.0).abs() < 0.05,
            "{decay} against {expected}"
        );
    }
}
