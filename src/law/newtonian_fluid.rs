//! Weakly compressible viscous fluid.

use nalgebra::SMatrix;

use super::ConstitutiveLaw;
use super::constant::{not_negative, positive, require};
use crate::error::SetupError;
use crate::scalar::Scalar;
use crate::tensor::{determinant, symmetric};

/// Current volume over that at zero pressure, `rho_0 / rho`; the default is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeRatio<T>(pub T);

impl<T: Scalar> Default for VolumeRatio<T> {
    fn default() -> Self {
        Self(T::one())
    }
}

/// Weakly compressible Newtonian fluid after Cole (1948) and Monaghan (1994),
///
/// $$\sigma = -p1 + 2\mu\operatorname{dev}d,\qquad p = \frac{K}{\gamma}\left(J^{-\gamma} - 1\right),\quad J =
/// \rho_0/\rho,$$
///
/// with the deviator of three dimensions (no bulk viscosity). The speed of sound at rest is
/// $\sqrt{K/\rho_0}$; ten times the flow's speed keeps changes of density near 1 %. A free fluid bears no
/// tension: beyond $J = 1$ its pressure stays zero, and since the volume itself is remembered, drops that
/// part and meet again do not pile up volume.
///
/// Viscosity is felt in [`update_over`](ConstitutiveLaw::update_over), which knows the time; `update` alone
/// gives the pressure. It also shortens the stable step: [`NewtonianFluid::stable_step`]. The separated fluid
/// keeps its viscosity.
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonianFluid<T> {
    bulk_modulus: T,
    gamma: T,
    viscosity: T,
    bears_tension: bool,
}

impl<T: Scalar> NewtonianFluid<T> {
    /// From the bulk modulus at rest (Pa), the exponent `gamma` (7 for water, 1 for a pressure linear in the
    /// density) and the dynamic viscosity (Pa s). Bears no tension.
    ///
    /// # Errors
    /// If the modulus is not positive, the exponent below 1, the viscosity negative, or one of them infinite.
    pub fn new(bulk_modulus: T, gamma: T, viscosity: T) -> Result<Self, SetupError> {
        positive("bulk_modulus", bulk_modulus)?;
        require(
            "gamma",
            gamma,
            gamma >= T::one(),
            "it must be finite and at least 1",
        )?;
        not_negative("viscosity", viscosity)?;
        Ok(Self {
            bulk_modulus,
            gamma,
            viscosity,
            bears_tension: false,
        })
    }

    /// The same for a fluid that cannot cavitate: its pressure may be negative.
    #[must_use]
    pub fn bearing_tension(self) -> Self {
        Self {
            bears_tension: true,
            ..self
        }
    }

    /// Pressure (Pa).
    #[inline(always)]
    pub fn pressure(&self, ratio: &VolumeRatio<T>) -> T {
        if self.is_separated(ratio) {
            return T::zero();
        }
        // Without the cancellation of J^-gamma - 1.
        self.bulk_modulus / self.gamma * (-self.gamma * ratio.0.ln()).exp_m1()
    }

    #[inline(always)]
    fn is_separated(&self, ratio: &VolumeRatio<T>) -> bool {
        !self.bears_tension && ratio.0 > T::one()
    }

    /// Viscous stress (Pa) `2 mu dev(d)` of the displacement gradient of a step.
    #[inline(always)]
    fn viscous_stress<const D: usize>(&self, dt: T, increment: &SMatrix<T, D, D>) -> SMatrix<T, D, D> {
        let mut rate = symmetric(increment) / dt;
        // The trace of three dimensions, which the axes off the plane add nothing to.
        let mean = rate.trace() / T::lit(3.0);
        for a in 0..D {
            rate[(a, a)] -= mean;
        }
        rate * (self.viscosity + self.viscosity)
    }

    /// Stable step (s) of the viscous fluid, given that of sound alone, `elastic`.
    ///
    /// The step's viscous stress acts in the next step. A mode of frequency `w` and damping `z w`,
    /// `z = mu' k^2 / (2 rho w)`, is then stable while `(w dt / 2)^2 + z w dt <= 1` (Belytschko, Liu & Moran
    /// 2000, section 6.2). With `elastic = 2 / w` and, for the fastest mode of a grid of cells of width
    /// `cell` (m), `k^2 = 4 D / cell^2` and `mu' = 4 mu / 3`, that is `(dt / elastic)^2 + dt / viscous = 1`
    /// with `viscous = rho cell^2 / (2 D mu')`. It is no part of `wave_speed`, which knows no cell; bases
    /// with broader spectra than linear ones on lumped mass need less.
    pub fn stable_step<const D: usize>(&self, elastic: T, density: T, cell: T) -> T {
        let viscosity = T::lit(4.0) / T::lit(3.0) * self.viscosity;
        let ratio = elastic * T::count(D) * viscosity / (density * cell * cell);
        // Root of x^2 + 2 ratio x = 1, x = dt / elastic, without cancellation.
        elastic / (ratio + (ratio * ratio + T::one()).sqrt())
    }
}

impl<T: Scalar, const D: usize> ConstitutiveLaw<T, D> for NewtonianFluid<T> {
    type State = VolumeRatio<T>;

    #[inline(always)]
    fn large_strain(&self) -> bool {
        true
    }

    #[inline(always)]
    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, state: &mut Self::State) {
        state.0 *= determinant(&(SMatrix::identity() + increment));
        *stress = SMatrix::from_diagonal_element(-self.pressure(state));
    }

    #[inline(always)]
    fn update_over(
        &self,
        dt: T,
        increment: &SMatrix<T, D, D>,
        stress: &mut SMatrix<T, D, D>,
        state: &mut Self::State,
    ) {
        self.update(increment, stress, state);
        *stress += self.viscous_stress(dt, increment);
    }

    /// Of a fluid at rest: `None` for a stress that is not isotropic up to round-off, or under tension that
    /// it does not bear.
    fn start(&self, stress: &SMatrix<T, D, D>, off_plane: Option<T>) -> Option<Self::State> {
        let pressure = -stress.trace() / T::count(D);
        let shear = (stress + SMatrix::identity() * pressure).norm();
        let off = off_plane.map_or(
            T::zero(),
            |s| if const { D < 3 } { s + pressure } else { T::zero() },
        );
        let isotropic = shear.max(off.abs()) <= T::default_epsilon().sqrt() * pressure.abs();
        let base = T::one() + self.gamma * pressure / self.bulk_modulus;
        let borne = self.bears_tension || pressure >= T::zero();
        (isotropic && borne && base > T::zero()).then(|| VolumeRatio((-base.ln() / self.gamma).exp()))
    }

    #[inline]
    fn strain_for(
        &self,
        change: &SMatrix<T, D, D>,
        _density: T,
        _stress: &SMatrix<T, D, D>,
        state: &Self::State,
    ) -> Option<SMatrix<T, D, D>> {
        if self.is_separated(state) {
            return None;
        }
        let modulus = self.bulk_modulus * (-self.gamma * state.0.ln()).exp();
        let count = T::count(D);
        // The pressure alone follows from the state.
        Some(SMatrix::from_diagonal_element(
            change.trace() / (count * count * modulus),
        ))
    }

    /// `rho c^2 = K J^-gamma`; of separated fluid what it will be on contact, when its density is `rho J`
    /// again.
    fn wave_speed(&self, density: T, _stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        if self.is_separated(state) {
            return (self.bulk_modulus / (density * state.0)).sqrt();
        }
        let modulus = self.bulk_modulus * (-self.gamma * state.0.ln()).exp();
        (modulus / density).sqrt()
    }

    /// What the deviator of three dimensions, whose trace is zero, leaves of the pressure: `-3 p - tr(sigma)`
    /// over the axes off the plane.
    fn off_plane_stress(&self, stress: &SMatrix<T, D, D>, state: &Self::State) -> Option<T> {
        let whole = -T::lit(3.0) * self.pressure(state) - stress.trace();
        (D < 3).then(|| whole / T::count(3 - D))
    }

    /// Work of compression from `J = 1`.
    fn energy_density(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        if self.is_separated(state) {
            return T::zero();
        }
        let (log, less) = (state.0.ln(), self.gamma - T::one());
        // (J^(1 - gamma) - 1) / (gamma - 1), whose limit at gamma = 1 is -ln J.
        let compressed = if less.is_zero() {
            -log
        } else {
            (-less * log).exp_m1() / less
        };
        self.bulk_modulus / self.gamma * (log.exp_m1() + compressed) / state.0
    }
}
