//! The critical step of two phases.

use nalgebra::Matrix2;

use super::super::{CriticalStep, Mechanism};
use crate::scalar::Scalar;

/// Halvings of the interval that holds the critical step: enough for a drag limit 1e12 times below the
/// wave's.
const HALVINGS: usize = 100;

/// Material at one place, as the stability of a step feels it; rows and columns are liquid and solid.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Coupled<T: Scalar> {
    /// Masses per volume (kg/m3).
    pub(in super::super) mass: [T; 2],
    /// Drag per volume (kg/(m3 s)): `n^2 gamma_w / k`.
    pub(in super::super) drag: T,
    /// Stiffness of the liquid in its pores (Pa): `K_w / n`.
    pub(in super::super) liquid_stiffness: T,
    /// Porosity.
    pub(in super::super) porosity: T,
    /// Modulus of the solid's uniaxial strain (Pa).
    pub(in super::super) modulus: T,
    /// Whether the drag is felt at the end of the step.
    pub(in super::super) implicit: bool,
}

impl<T: Scalar> Coupled<T> {
    /// Largest step (s) at which nothing grows, where `geometry` (1/m2) is the largest eigenvalue of the
    /// scheme's mass inverse times stiffness for unit density and modulus (`4 / h^2` for linear functions and
    /// lumped masses).
    ///
    /// Euler-Cromer changes its behaviour where an amplification factor reaches -1: at the first step that
    /// makes
    ///
    /// `4 M - 2 dt D - dt^2 g C` (explicit drag) or `4 M + 2 dt D - dt^2 g C` (implicit drag)
    ///
    /// no longer positive definite. Along every direction this is positive up to one root, so bisection finds
    /// the least.
    pub(in super::super) fn critical_step(&self, geometry: T) -> Option<CriticalStep<T>> {
        let with_drag = self.largest_step(geometry, self.drag)?;
        let wave = self.largest_step(geometry, T::zero())?;
        // Drag alone: 2 M - dt D.
        let rate = self.drag * (T::one() / self.mass[0] + T::one() / self.mass[1]);
        let drag_limits = !self.implicit && T::lit(2.0) < rate * wave;
        Some(CriticalStep {
            step: with_drag,
            mechanism: if drag_limits {
                Mechanism::Drag
            } else {
                Mechanism::Wave
            },
        })
    }

    /// A step of at most [`Coupled::critical_step`], without a search.
    ///
    /// With `mu` the largest eigenvalue of `M^-1 C` and `r` that of `M^-1 D`, `4 M - 2 dt D - dt^2 g C` is
    /// positive definite where `2 dt r + dt^2 g mu <= 4`. Drag at the end of the step only adds to it. Exact
    /// where one of both limits alone; where they are equal 0.62 of it at least.
    pub(in super::super) fn stable_step(&self, geometry: T) -> Option<CriticalStep<T>> {
        let (two, four) = (T::lit(2.0), T::lit(4.0));
        let [liquid, solid] = self.mass;
        let c = self.stiffness();
        let (a, b) = (c[(0, 0)] / liquid, c[(1, 1)] / solid);
        let (mean, half) = ((a + b) / two, (a - b) / two);
        let mu = mean + (half * half + c[(0, 1)] * c[(0, 1)] / (liquid * solid)).sqrt();
        let wave = geometry * mu;
        let drag = match self.implicit {
            true => T::zero(),
            false => self.drag * (T::one() / liquid + T::one() / solid),
        };
        // The positive root of 2 dt r + dt^2 w = 4, without the difference of equals.
        let step = four / (drag + (drag * drag + four * wave).sqrt());
        let mechanism = match drag * drag > wave {
            true => Mechanism::Drag,
            false => Mechanism::Wave,
        };
        (step > T::zero() && step.is_finite()).then_some(CriticalStep { step, mechanism })
    }

    /// `C`, for a unit of `geometry`.
    fn stiffness(&self) -> Matrix2<T> {
        let n = self.porosity;
        let shares = [n, T::one() - n];
        Matrix2::from_fn(|i, j| {
            let skeleton = if i == 1 && j == 1 { self.modulus } else { T::zero() };
            self.liquid_stiffness * shares[i] * shares[j] + skeleton
        })
    }

    fn largest_step(&self, geometry: T, drag: T) -> Option<T> {
        let (two, four) = (T::lit(2.0), T::lit(4.0));
        let stiffness = self.stiffness();
        let sign = if self.implicit { T::one() } else { -T::one() };
        let stable = |dt: T| {
            let d = sign * two * dt * drag;
            let c = stiffness * (dt * dt * geometry);
            let (a, b) = (four * self.mass[0] - c[(0, 0)], four * self.mass[1] - c[(1, 1)]);
            let off = -c[(0, 1)];
            // The determinant with the drag's part taken out of the products: d^2 would cancel.
            let determinant = a * b - off * off + d * (a + b + off + off);
            a + d > T::zero() && determinant > T::zero()
        };
        // Both phases together feel no drag: the undrained wave bounds every step.
        let whole = self.mass[0] + self.mass[1];
        let mut high = two * (whole / (geometry * stiffness.sum())).sqrt();
        if !(high > T::zero() && high.is_finite()) {
            return None;
        }
        let mut low = T::zero();
        for _ in 0..HALVINGS {
            let middle = (low + high) / two;
            if stable(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        (low > T::zero()).then_some(low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Soils from gravel to clay, grids from fine to coarse: never above the search's result, which bisects
    /// the determinant itself, and no less than the golden section of it.
    #[test]
    fn the_closed_form_stays_below_the_search() {
        for exponent in 0..12 {
            for geometry in [1e-2, 1.0, 1e4, 1e8] {
                for (implicit, modulus) in [(false, 1e5), (false, 1e9), (true, 1e5), (true, 1e9)] {
                    let soil = Coupled {
                        mass: [300.0, 1855.0],
                        drag: 0.3 * 0.3 * 1e4 * 10.0_f64.powi(exponent),
                        liquid_stiffness: 2.2e9 / 0.3,
                        porosity: 0.3,
                        modulus,
                        implicit,
                    };
                    let (exact, bound) = (
                        soil.critical_step(geometry).unwrap(),
                        soil.stable_step(geometry).unwrap(),
                    );
                    let ratio = bound.step / exact.step;
                    assert!(ratio <= 1.0 + 1e-9, "{soil:?}: {ratio}");
                    // Drag at the end of the step helps, and the closed form does not count on it.
                    assert!(implicit || ratio > 0.6, "{soil:?}: {ratio}");
                }
            }
        }
    }
}
