//! Compressible neo-Hookean elasticity.

use nalgebra::SMatrix;

use super::{ConstitutiveLaw, Moduli};
use crate::scalar::Scalar;
use crate::tensor::determinant;

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

    /// From `J d sigma/dJ` along the most stretched axis. Its squared stretch is the largest row sum of `F F^T` (Gershgorin):
    /// exact where the stretches lie along the axes, an upper bound elsewhere.
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

    fn energy_density(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        let Moduli { lambda, mu } = self.moduli;
        let half = T::one() / T::lit(2.0);
        let j = determinant(&state.0);
        let stretch_squared = (state.0 * state.0.transpose()).trace();
        let log = j.ln();
        (half * mu * (stretch_squared - T::count(D)) - mu * log + half * lambda * log * log) / j
    }
}
