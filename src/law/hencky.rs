//! Hencky's logarithmic elasticity.

use nalgebra::SMatrix;

use super::elastic_stretch::{ElasticStretch, stored_energy, wave_modulus};
use super::{ConstitutiveLaw, Moduli};
use crate::scalar::Scalar;

/// Hencky's solid: Hooke's law between Kirchhoff's stress and the logarithmic strain,
///
/// $$\sigma = \frac{1}{J}\left(\lambda\operatorname{tr}(\ln V)1 + 2\mu\ln V\right),\quad V^2 = b =
/// FF^T,\qquad W = \frac{\lambda}{2}\operatorname{tr}(\ln V)^2 + \mu\ln V:\ln V$$
///
/// (Hencky 1928; Anand 1979; de Souza Neto, Perić & Owen 2008, section 13.3), $W$ per reference volume. The
/// mean stress has a maximum, $K/e$ at $J = e$: beyond, material that stretches gives way.
///
/// In 1-D that is $\sigma = (E/J)\ln J$ with the modulus $E$ of uniaxial strain, where
/// [`Logarithmic`](super::Logarithmic) has no $1/J$. Below 3-D the strains off the plane stay as they were at
/// the start: none, or those of an initial stress.
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hencky<T> {
    /// Elastic constants.
    pub moduli: Moduli<T>,
}

impl<T: Scalar> Hencky<T> {
    /// Cauchy stress (Pa) of a stretch.
    #[inline(always)]
    pub fn stress<const D: usize>(&self, stretch: &ElasticStretch<T, D>) -> SMatrix<T, D, D> {
        let principal = stretch.principal();
        principal.stress(&self.moduli, principal.volume())
    }

    /// Cauchy stress (Pa) along the axes that the grid does not have.
    pub fn off_plane_stress<const D: usize>(&self, stretch: &ElasticStretch<T, D>) -> T {
        let principal = stretch.principal();
        principal.off_plane_stress(&self.moduli, principal.volume())
    }
}

impl<T: Scalar, const D: usize> ConstitutiveLaw<T, D> for Hencky<T> {
    type State = ElasticStretch<T, D>;

    #[inline(always)]
    fn large_strain(&self) -> bool {
        true
    }

    #[inline(always)]
    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, state: &mut Self::State) {
        state.carry(increment);
        *stress = self.stress(state);
    }

    fn start(&self, stress: &SMatrix<T, D, D>, off_plane: Option<T>) -> Option<Self::State> {
        ElasticStretch::under_stress(&self.moduli, stress, off_plane)
    }

    #[inline]
    fn elastic_constants(&self) -> Option<Moduli<T>> {
        Some(self.moduli)
    }

    fn wave_speed(&self, density: T, stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        let j = state.principal().volume();
        (wave_modulus(&self.moduli, stress, j) / density).sqrt()
    }

    fn off_plane_stress(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> Option<T> {
        (D < 3).then(|| Self::off_plane_stress(self, state))
    }

    fn energy_density(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        let principal = state.principal();
        stored_energy(&self.moduli, &principal.strain) / principal.volume()
    }
}
