//! Compressible neo-Hookean elasticity.

use nalgebra::{SMatrix, SVector};

use super::{ConstitutiveLaw, Moduli};
use crate::scalar::Scalar;
use crate::tensor::{Spectral, determinant, symmetric};

/// Deformation gradient of a particle; the default is the identity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeformationGradient<T, const D: usize>(pub SMatrix<T, D, D>);

impl<T: Scalar, const D: usize> Default for DeformationGradient<T, D> {
    fn default() -> Self {
        Self(SMatrix::identity())
    }
}

/// Compressible neo-Hookean solid, with the Cauchy stress and the energy per reference volume
///
/// $$\sigma = \frac{\lambda\ln J}{J}1 + \frac{\mu}{J}(FF^T - 1),\qquad
/// W = \frac{\mu}{2}(\operatorname{tr}FF^T - D) - \mu\ln J + \frac{\lambda}{2}(\ln J)^2.$$
///
/// Below 3-D the stretches off the plane are 1 (plane, uniaxial strain).
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean<T> {
    /// Elastic constants.
    pub moduli: Moduli<T>,
}

impl<T: Scalar> NeoHookean<T> {
    /// Cauchy stress (Pa) of the deformation gradient `f`.
    #[inline(always)]
    pub fn stress<const D: usize>(&self, f: &SMatrix<T, D, D>) -> SMatrix<T, D, D> {
        let j = determinant(f);
        let mut stress = f * f.transpose() * (self.moduli.mu / j);
        let isotropic = (self.moduli.lambda * j.ln() - self.moduli.mu) / j;
        for a in 0..D {
            stress[(a, a)] += isotropic;
        }
        stress
    }
}

/// Newton steps for the volume that belongs to a stress; five or so are taken.
const NEWTON_STEPS: usize = 60;

impl<T: Scalar> NeoHookean<T> {
    /// Squared principal stretches of principal stresses at `J = exp(x)`.
    fn squared_stretches<const D: usize>(&self, stress: &SVector<T, D>, x: T) -> SVector<T, D> {
        let Moduli { lambda, mu } = self.moduli;
        stress.map(|s| T::one() + (s * x.exp() - lambda * x) / mu)
    }

    /// Squared principal stretches under principal stresses: one equation for `x = ln J`,
    /// `sum ln b(x) = 2 x`.
    fn stretches_under<const D: usize>(&self, stress: &SVector<T, D>) -> Option<SVector<T, D>> {
        let (lambda, two) = (self.moduli.lambda, T::lit(2.0));
        let lawful = |b: &SVector<T, D>| b.iter().all(|b| *b > T::zero());
        let mut x = T::zero();
        for _ in 0..NEWTON_STEPS {
            let b = self.squared_stretches(stress, x);
            if !lawful(&b) {
                // Pressed beyond the shear modulus: look at smaller volumes.
                x -= T::one() / two;
                continue;
            }
            let residual = b.fold(-two * x, |sum, b| sum + b.ln());
            let slope = stress.zip_map(&b, |s, b| (s * x.exp() - lambda) / b).sum() / self.moduli.mu - two;
            let mut change = -residual / slope;
            let falls = slope < T::zero() && change.is_finite();
            // So it does on the branch through rest.
            if !falls {
                return None;
            }
            while !lawful(&self.squared_stretches(stress, x + change)) && change.abs() > T::default_epsilon()
            {
                change /= two;
            }
            x += change;
            if change.abs() <= T::lit(4.0) * T::default_epsilon() * (T::one() + x.abs()) {
                return Some(self.squared_stretches(stress, x));
            }
        }
        None
    }
}

impl<T: Scalar, const D: usize> ConstitutiveLaw<T, D> for NeoHookean<T> {
    type State = DeformationGradient<T, D>;

    #[inline(always)]
    fn large_strain(&self) -> bool {
        true
    }

    #[inline(always)]
    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, state: &mut Self::State) {
        state.0 += increment * state.0;
        *stress = self.stress(&state.0);
    }

    /// A stretch without rotation. `None` for a given stress off the plane, where this solid is not strained.
    fn start(&self, stress: &SMatrix<T, D, D>, off_plane: Option<T>) -> Option<Self::State> {
        if D < 3 && off_plane.is_some() {
            return None;
        }
        let spectral = Spectral::of(&symmetric(stress));
        let squared = self.stretches_under(&spectral.values)?;
        let stretches = squared.map(|b| b.sqrt());
        // That of the squared stretch, over the divided difference of the root.
        let volume_over_mu = stretches.product() / self.moduli.mu;
        let rest =
            |p: usize, q: usize| spectral.rest()[(p, q)] * volume_over_mu / (stretches[p] + stretches[q]);
        Some(DeformationGradient(
            spectral.with_values_and_rest(&stretches, rest),
        ))
    }

    #[inline]
    fn elastic_constants(&self) -> Option<Moduli<T>> {
        Some(self.moduli)
    }

    /// From `J d sigma/dJ` along the most stretched axis. Its squared stretch is the largest row sum of
    /// `F F^T` (Gershgorin): exact where the stretches lie along the axes, an upper bound elsewhere.
    #[inline(always)]
    fn wave_speed(&self, density: T, _stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        let Moduli { lambda, mu } = self.moduli;
        let j = determinant(&state.0);
        let b = state.0 * state.0.transpose();
        let row_sum = |i: usize| b.row(i).iter().fold(T::zero(), |sum, x| sum + x.abs());
        let stretch_squared = (0..D).map(row_sum).fold(T::zero(), |most, sum| most.max(sum));
        let modulus = (lambda * (T::one() - j.ln()) + mu * (T::one() + stretch_squared)) / j;
        (modulus.max(T::zero()) / density).sqrt()
    }

    /// `lambda ln(J) / J`: nothing is stretched off the plane.
    fn off_plane_stress(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> Option<T> {
        let j = determinant(&state.0);
        (D < 3).then(|| self.moduli.lambda * j.ln() / j)
    }

    fn energy_density(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        let Moduli { lambda, mu } = self.moduli;
        let half = T::one() / T::lit(2.0);
        let j = determinant(&state.0);
        let stretch_squared = (state.0 * state.0.transpose()).trace();
        let log = j.ln();
        (half * mu * (stretch_squared - T::count(D)) - mu * log + half * lambda * log * log) / j
    }
}
