//! Metal plasticity.

use nalgebra::{SMatrix, Vector3};

use super::constant::{not_negative, positive};
use super::elastic_stretch::{ElasticStretch, length, stored_energy, wave_modulus};
use super::{ConstitutiveLaw, Moduli};
use crate::error::SetupError;
use crate::scalar::Scalar;

/// Von Mises plasticity with linear isotropic hardening on [`Hencky`](super::Hencky)'s elasticity, in
/// Kirchhoff's stress $\tau = J\sigma$ with deviator $s$:
///
/// $$\sqrt{\tfrac{3}{2}s:s} \le \sigma_Y + H\alpha,\qquad \dot\alpha = \sqrt{\tfrac{2}{3}d_p:d_p}.$$
///
/// The flow is associated and keeps the volume. The radial return in logarithmic strain is closed (de Souza
/// Neto, Perić & Owen 2008, boxes 7.3, 7.4 and 14.3): the trial strain keeps its axes, $\Delta\alpha = (q -
/// \sigma_Y - H\alpha)/(3\mu + H)$.
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VonMises<T> {
    moduli: Moduli<T>,
    yield_stress: T,
    hardening: T,
}

/// What a particle of [`VonMises`] remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VonMisesState<T, const D: usize> {
    /// Elastic stretch.
    pub stretch: ElasticStretch<T, D>,
    /// Accumulated plastic strain `alpha`.
    pub plastic_strain: T,
}

impl<T: Scalar, const D: usize> Default for VonMisesState<T, D> {
    fn default() -> Self {
        Self {
            stretch: ElasticStretch::default(),
            plastic_strain: T::zero(),
        }
    }
}

impl<T: Scalar> VonMises<T> {
    /// From the yield stress in uniaxial tension and the hardening modulus `d sigma_Y / d alpha` (both Pa).
    ///
    /// # Errors
    /// If the yield stress is not positive and finite, or the hardening negative or infinite.
    pub fn new(moduli: Moduli<T>, yield_stress: T, hardening: T) -> Result<Self, SetupError> {
        positive("yield_stress", yield_stress)?;
        not_negative("hardening", hardening)?;
        Ok(Self {
            moduli,
            yield_stress,
            hardening,
        })
    }

    /// Elastic constants.
    pub fn moduli(&self) -> Moduli<T> {
        self.moduli
    }

    /// Yield function (Pa) `q - sigma_Y - H alpha` in Kirchhoff's stress; not above zero after an update, up
    /// to round-off.
    pub fn yield_function<const D: usize>(&self, state: &VonMisesState<T, D>) -> T {
        let deviator = deviator(&state.stretch.principal().strain);
        self.mises(&deviator) - self.strength(state.plastic_strain)
    }

    /// Cauchy stress (Pa) along the axes that the grid does not have.
    pub fn off_plane_stress<const D: usize>(&self, state: &VonMisesState<T, D>) -> T {
        let principal = state.stretch.principal();
        principal.off_plane_stress(&self.moduli, principal.volume())
    }

    /// Mises' stress `sqrt(3/2 s : s)` of a deviatoric strain, `s = 2 mu e`.
    #[inline(always)]
    fn mises(&self, deviator: &Vector3<T>) -> T {
        T::lit(6.0).sqrt() * self.moduli.mu * length(deviator)
    }

    #[inline(always)]
    fn strength(&self, plastic_strain: T) -> T {
        self.yield_stress + self.hardening * plastic_strain
    }
}

/// PrincipalStretch values of the deviator.
#[inline(always)]
pub fn deviator<T: Scalar>(strain: &Vector3<T>) -> Vector3<T> {
    let mean = strain.sum() / T::lit(3.0);
    strain.map(|e| e - mean)
}

impl<T: Scalar, const D: usize> ConstitutiveLaw<T, D> for VonMises<T> {
    type State = VonMisesState<T, D>;

    #[inline(always)]
    fn large_strain(&self) -> bool {
        true
    }

    #[inline]
    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, state: &mut Self::State) {
        state.stretch.carry(increment);
        let mut principal = state.stretch.principal();
        let deviator = deviator(&principal.strain);
        let trial = self.mises(&deviator);
        let excess = trial - self.strength(state.plastic_strain);
        if excess > T::zero() {
            let three_mu = T::lit(3.0) * self.moduli.mu;
            let plastic = excess / (three_mu + self.hardening);
            let share = three_mu * plastic / trial;
            principal.strain -= deviator * share;
            principal.scale_shear(T::one() - share);
            state.plastic_strain += plastic;
            state.stretch = principal.stretch();
        }
        *stress = principal.stress(&self.moduli, principal.volume());
    }

    /// `None` also beyond the yield stress.
    fn start(&self, stress: &SMatrix<T, D, D>, off_plane: Option<T>) -> Option<Self::State> {
        let state = VonMisesState {
            stretch: ElasticStretch::under_stress(&self.moduli, stress, off_plane)?,
            plastic_strain: T::zero(),
        };
        let slack = self.yield_stress * T::default_epsilon().sqrt();
        (self.yield_function(&state) <= slack).then_some(state)
    }

    #[inline]
    fn elastic_constants(&self) -> Option<Moduli<T>> {
        Some(self.moduli)
    }

    /// That of elastic waves, which plastic ones never outrun.
    fn wave_speed(&self, density: T, stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        let j = state.stretch.principal().volume();
        (wave_modulus(&self.moduli, stress, j) / density).sqrt()
    }

    fn off_plane_stress(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> Option<T> {
        (D < 3).then(|| Self::off_plane_stress(self, state))
    }

    fn plastic_strain(&self, state: &Self::State) -> Option<T> {
        Some(state.plastic_strain)
    }

    /// The elastic energy; what hardening stores is counted as dissipated.
    fn energy_density(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        let principal = state.stretch.principal();
        stored_energy(&self.moduli, &principal.strain) / principal.volume()
    }
}
