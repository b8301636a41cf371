//! The critical step of two phases.

use nalgebra::Matrix2;

use super::super::{CriticalStep, Mechanism};
use crate::scalar::Scalar;

/// Halvings of the interval that holds the critical step: enough for a drag limit 1e12 times below the wave's.
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
    /// Largest step (s) at which nothing grows, where `geometry` (1/m2) is the largest eigenvalue of the scheme's mass inverse
    /// times stiffness for unit density and modulus (`4 / h^2` for linear functions and lumped masses).
    ///
    /// Euler-Cromer changes its behaviour where an amplification factor reaches -1: at the first step that makes
    ///
    /// `4 M - 2 dt D - dt^2 g C` (explicit drag) or `4 M + 2 dt D - dt^2 g C` (implicit drag)
    ///
    /// no longer positive definite. Along every direction this is positive up to one root, so bisection finds the least.
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

    fn largest_step(&self, geometry: T, drag: T) -> Option<T> {
        let n = self.porosity;
        let shares = [n, T::one() - n];
        let (two, four) = (T::lit(2.0), T::lit(4.0));
        let stiffness = Matrix2::from_fn(|i, j| {
            let skeleton = if i == 1 && j == 1 { self.modulus } else { T::zero() };
            self.liquid_stiffness * shares[i] * shares[j] + skeleton
        });
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
