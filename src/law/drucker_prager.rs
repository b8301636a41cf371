//! Frictional plasticity of soil.

mod cone;

pub use cone::{ConeMatch, Strength};

use nalgebra::SMatrix;

use self::cone::Cone;
use super::elastic_stretch::{ElasticStretch, PrincipalStretch, length, stored_energy, wave_modulus};
use super::linear_elastic::hooke_strain_at;
use super::von_mises::deviator;
use super::{ConstitutiveLaw, Moduli};
use crate::error::SetupError;
use crate::scalar::Scalar;
use crate::tensor::determinant;

/// Drucker-Prager plasticity without hardening on [`Hencky`](super::Hencky)'s elasticity, in Kirchhoff's
/// stress $\tau = J\sigma$ with deviator $s$ and mean $p$ (tension positive):
///
/// $$\Phi = \sqrt{\tfrac{1}{2}s:s} + \eta p - \xi c \le 0,\qquad
/// d_p = \dot\gamma\left(\frac{s}{2\sqrt{\tfrac{1}{2}s:s}} + \frac{\bar\eta}{3}1\right).$$
///
/// Friction $\eta$, cohesion $\xi c$ and dilation $\bar\eta$ follow from the Mohr-Coulomb constants by a
/// [`ConeMatch`]. The return in principal logarithmic strains goes to the cone or to its apex $p = \xi
/// c/\eta$ and is closed (de Souza Neto, Perić & Owen 2008, boxes 8.8 to 8.10 and 14.3).
///
/// Material without cohesion **separates** at its apex: the volume it gains there is kept as
/// [`DruckerPragerState::gap`], it bears nothing, and it bears again only when that volume is closed. Opening
/// and closing do no work, and grains that part and meet again do not pile up volume (the purpose of the
/// volume correction of Tampubolon et al. 2017). With cohesion the apex is held in tension and the volume
/// gained is plastic for good.
///
/// The stress is per current volume, the strength per volume of the unloaded undeformed material: a
/// dissipation $\tau:d_p\ge 0$ for every dilation up to the friction.
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DruckerPrager<T> {
    moduli: Moduli<T>,
    cone: Cone<T>,
}

/// What a particle of [`DruckerPrager`] remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DruckerPragerState<T, const D: usize> {
    /// Elastic stretch.
    pub stretch: ElasticStretch<T, D>,
    /// Volume over that of the unloaded material at the start, elastic and plastic.
    pub volume: T,
    /// Accumulated plastic strain: integral of `sqrt(2/3 e : e)` with the deviator `e` of the plastic strain
    /// rate.
    pub plastic_strain: T,
    /// Logarithmic volume strain by which separated material must close before it bears again; 0 in contact.
    pub gap: T,
}

impl<T: Scalar, const D: usize> Default for DruckerPragerState<T, D> {
    fn default() -> Self {
        Self {
            stretch: ElasticStretch::default(),
            volume: T::one(),
            plastic_strain: T::zero(),
            gap: T::zero(),
        }
    }
}

impl<T: Scalar> DruckerPrager<T> {
    /// From the Mohr-Coulomb strength and the cone that stands for it.
    ///
    /// # Errors
    /// If the cohesion is negative or infinite, the friction angle not within [0, pi/2), or the dilation
    /// angle not between 0 and the friction angle.
    pub fn new(moduli: Moduli<T>, strength: &Strength<T>, matching: ConeMatch) -> Result<Self, SetupError> {
        let cone = Cone::new(strength, matching)?;
        Ok(Self { moduli, cone })
    }

    /// Elastic constants.
    pub fn moduli(&self) -> Moduli<T> {
        self.moduli
    }

    /// Yield function `Phi` (Pa) in Kirchhoff's stress; not above zero after an update, up to round-off.
    pub fn yield_function<const D: usize>(&self, state: &DruckerPragerState<T, D>) -> T {
        let strain = state.stretch.principal().strain;
        self.cone.yield_function(&self.moduli, &strain)
    }

    /// Cauchy stress (Pa) along the axes that the grid does not have.
    pub fn off_plane_stress<const D: usize>(&self, state: &DruckerPragerState<T, D>) -> T {
        let principal = state.stretch.principal();
        principal.off_plane_stress(&self.moduli, state.volume)
    }
}

/// Closes the gap of separated material before its strain counts.
///
/// Separated material is at its apex, free of stress and strain: the trial strain is this step's alone. Of
/// its shear only the part of the step in contact counts, or closing in one step would press the grains
/// together by what they slid apart.
#[inline(always)]
fn close<T: Scalar, const D: usize>(trial: &mut PrincipalStretch<T, D>, gap: T) {
    let change = trial.strain.sum();
    let rest = change + gap;
    let contact = if rest < T::zero() { rest / change } else { T::one() };
    let mean = rest / T::lit(3.0);
    trial.strain = deviator(&trial.strain).map(|e| e * contact + mean);
    trial.scale_shear(contact);
}

impl<T: Scalar, const D: usize> ConstitutiveLaw<T, D> for DruckerPrager<T> {
    type State = DruckerPragerState<T, D>;

    #[inline(always)]
    fn large_strain(&self) -> bool {
        true
    }

    #[inline]
    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, state: &mut Self::State) {
        state.stretch.carry(increment);
        state.volume *= determinant(&(SMatrix::identity() + increment));
        let mut principal = state.stretch.principal();
        let separated = state.gap > T::zero();
        if separated {
            close(&mut principal, state.gap);
        }
        let trial = principal.strain;
        let (yields, scale) = self.cone.return_to(&self.moduli, &mut principal.strain);
        principal.scale_shear(scale);
        state.gap = T::zero();
        if yields.is_at_apex() && self.cone.separates() {
            state.gap = trial.sum();
        }
        if yields.is_plastic() {
            let flow = deviator(&(trial - principal.strain));
            state.plastic_strain += (T::lit(2.0) / T::lit(3.0)).sqrt() * length(&flow);
        }
        if separated || yields.is_plastic() {
            state.stretch = principal.stretch();
        }
        *stress = principal.stress(&self.moduli, state.volume);
    }

    /// `None` also outside the cone.
    fn start(&self, stress: &SMatrix<T, D, D>, off_plane: Option<T>) -> Option<Self::State> {
        let stretch = ElasticStretch::under_stress(&self.moduli, stress, off_plane)?;
        let principal = stretch.principal();
        let state = DruckerPragerState {
            stretch,
            volume: principal.volume(),
            ..Default::default()
        };
        let slack = T::default_epsilon().sqrt() * self.moduli.mu * principal.strain.norm();
        (self.yield_function(&state) <= slack).then_some(state)
    }

    #[inline]
    fn strain_for(
        &self,
        change: &SMatrix<T, D, D>,
        density: T,
        stress: &SMatrix<T, D, D>,
        state: &Self::State,
    ) -> Option<SMatrix<T, D, D>> {
        let separated = state.gap > T::zero();
        let speed = self.wave_speed(density, stress, state);
        let modulus = density * speed * speed;
        (!separated).then(|| hooke_strain_at(&self.moduli, change, modulus))
    }

    /// That of elastic waves, which plastic ones never outrun; of separated material what it will be on
    /// contact, or more.
    fn wave_speed(&self, density: T, stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        (wave_modulus(&self.moduli, stress, state.volume) / density).sqrt()
    }

    fn off_plane_stress(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> Option<T> {
        (D < 3).then(|| Self::off_plane_stress(self, state))
    }

    fn plastic_strain(&self, state: &Self::State) -> Option<T> {
        Some(state.plastic_strain)
    }

    fn energy_density(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        stored_energy(&self.moduli, &state.stretch.principal().strain) / state.volume
    }
}
