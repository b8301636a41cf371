//! St. Venant-Kirchhoff elasticity.

use nalgebra::SMatrix;

use super::linear_elastic::hooke;
use super::{ConstitutiveLaw, DeformationGradient, Moduli};
use crate::scalar::Scalar;
use crate::tensor::determinant;

/// St. Venant-Kirchhoff solid: Hooke's law between the second Piola-Kirchhoff stress $S$ and Green's strain
/// $E$,
///
/// $$\sigma = \frac{1}{J}FSF^T,\quad S = \lambda\operatorname{tr}(E)1 + 2\mu E,\quad E = \tfrac{1}{2}(F^TF -
/// 1),\qquad W = \frac{\lambda}{2}\operatorname{tr}(E)^2 + \mu E:E$$
///
/// (Holzapfel 2000, section 6.5), $W$ per reference volume. For large rotations and moderate strains: in
/// uniaxial compression it softens and bears no more below the stretch $1/\sqrt{3}$. Below 3-D the stretches
/// off the plane are 1.
///
/// It starts from rest only: an initial stress has no closed-form state, and under compression up to two.
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StVenantKirchhoff<T> {
    /// Elastic constants.
    pub moduli: Moduli<T>,
}

impl<T: Scalar> StVenantKirchhoff<T> {
    /// Cauchy stress (Pa) of the deformation gradient `f`.
    #[inline(always)]
    pub fn stress<const D: usize>(&self, f: &SMatrix<T, D, D>) -> SMatrix<T, D, D> {
        f * hooke(&self.moduli, &green_strain(f)) * f.transpose() / determinant(f)
    }
}

/// Green's strain `(F^T F - 1) / 2`.
#[inline(always)]
fn green_strain<T: Scalar, const D: usize>(f: &SMatrix<T, D, D>) -> SMatrix<T, D, D> {
    (f.transpose() * f - SMatrix::identity()) / T::lit(2.0)
}

/// Largest row sum of absolute values (Gershgorin): no principal value of a symmetric tensor is greater.
fn row_sum<T: Scalar, const D: usize>(a: &SMatrix<T, D, D>) -> T {
    let sum = |i: usize| a.row(i).iter().fold(T::zero(), |sum, x| sum + x.abs());
    (0..D).map(sum).fold(T::zero(), |most, sum| most.max(sum))
}

impl<T: Scalar, const D: usize> ConstitutiveLaw<T, D> for StVenantKirchhoff<T> {
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

    #[inline]
    fn elastic_constants(&self) -> Option<Moduli<T>> {
        Some(self.moduli)
    }

    /// From `J d sigma/dJ = (lambda + 2 mu) l^4 / J + sigma` for the stretch `l` along an axis. Where the
    /// stretches lie off the axes, the largest row sums of `F F^T` and of the stress are taken: a bound.
    fn wave_speed(&self, density: T, stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        let j = determinant(&state.0);
        let b = state.0 * state.0.transpose();
        let stiffness = self.moduli.p_wave() / j;
        let diagonal = |a: usize| stiffness * b[(a, a)] * b[(a, a)] + stress[(a, a)];
        let aligned = (1..D).fold(diagonal(0), |most, a| most.max(diagonal(a)));
        let sheared = (0..D).any(|i| (0..i).any(|k| !b[(i, k)].is_zero()));
        let modulus = if sheared {
            let stretch_squared = row_sum(&b);
            stiffness * stretch_squared * stretch_squared + row_sum(stress)
        } else {
            aligned
        };
        (modulus.max(T::zero()) / density).sqrt()
    }

    /// `lambda tr(E) / J`: nothing is stretched off the plane.
    fn off_plane_stress(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> Option<T> {
        let trace = green_strain(&state.0).trace();
        (D < 3).then(|| self.moduli.lambda * trace / determinant(&state.0))
    }

    fn energy_density(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        let strain = green_strain(&state.0);
        hooke(&self.moduli, &strain).dot(&strain) / (T::lit(2.0) * determinant(&state.0))
    }
}
