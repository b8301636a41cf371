//! Small-strain linear elasticity.

use nalgebra::SMatrix;

use super::{ConstitutiveLaw, Moduli};
use crate::scalar::Scalar;
use crate::tensor::symmetric;

/// Hooke's law at small strain: `sigma += lambda tr(d_eps) 1 + 2 mu d_eps`, in 1-D `sigma += E d_eps`.
/// Density and volume stay as they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearElastic<T> {
    /// Elastic constants.
    pub moduli: Moduli<T>,
}

/// `lambda tr(e) 1 + 2 mu e`.
#[inline(always)]
pub(super) fn hooke<T: Scalar, const D: usize>(moduli: &Moduli<T>, e: &SMatrix<T, D, D>) -> SMatrix<T, D, D> {
    if const { D == 1 } {
        return e * moduli.p_wave();
    }
    let mut stress = e * (moduli.mu + moduli.mu);
    let pressure = moduli.lambda * e.trace();
    for a in 0..D {
        stress[(a, a)] += pressure;
    }
    stress
}

/// The strain, without parts off the plane, to which Hooke's law gives this `stress` (Pa).
#[inline]
pub fn hooke_strain<T: Scalar, const D: usize>(
    moduli: &Moduli<T>,
    stress: &SMatrix<T, D, D>,
) -> SMatrix<T, D, D> {
    if const { D == 1 } {
        return stress / moduli.p_wave();
    }
    let two_mu = moduli.mu + moduli.mu;
    let mean = moduli.lambda * stress.trace() / (T::count(D) * moduli.lambda + two_mu);
    let mut strain = *stress;
    for a in 0..D {
        strain[(a, a)] -= mean;
    }
    strain / two_mu
}

/// The same of material that is stiffer or softer now: `modulus` (Pa) of its fastest wave.
#[inline]
pub(super) fn hooke_strain_at<T: Scalar, const D: usize>(
    moduli: &Moduli<T>,
    stress: &SMatrix<T, D, D>,
    modulus: T,
) -> SMatrix<T, D, D> {
    hooke_strain(moduli, stress) * (moduli.p_wave() / modulus)
}

/// Stress (Pa) along the axes that the grid does not have and along which nothing is strained: in the plane
/// `nu (sigma_xx + sigma_yy)`.
#[inline]
pub(super) fn unstrained_stress<T: Scalar, const D: usize>(
    moduli: &Moduli<T>,
    stress: &SMatrix<T, D, D>,
) -> Option<T> {
    let share = moduli.lambda / (T::count(D) * moduli.lambda + moduli.mu + moduli.mu);
    (D < 3).then(|| share * stress.trace())
}

/// `sigma : C^-1 : sigma / 2` for plane or uniaxial strain, where the strains off the plane are zero.
pub(super) fn complementary_energy<T: Scalar, const D: usize>(
    moduli: &Moduli<T>,
    stress: &SMatrix<T, D, D>,
) -> T {
    let two = T::lit(2.0);
    if const { D == 1 } {
        return stress[(0, 0)] * stress[(0, 0)] / (two * moduli.p_wave());
    }
    // Inverse of Hooke's law restricted to D dimensions.
    let trace = stress.trace();
    let bulk = T::count(D) * moduli.lambda + two * moduli.mu;
    (stress.dot(stress) - moduli.lambda / bulk * trace * trace) / (T::lit(4.0) * moduli.mu)
}

impl<T: Scalar, const D: usize> ConstitutiveLaw<T, D> for LinearElastic<T> {
    type State = ();

    #[inline(always)]
    fn large_strain(&self) -> bool {
        false
    }

    #[inline(always)]
    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, _state: &mut ()) {
        *stress += hooke(&self.moduli, &symmetric(increment));
    }

    #[inline(always)]
    fn wave_speed(&self, density: T, _stress: &SMatrix<T, D, D>, _state: &()) -> T {
        (self.moduli.p_wave() / density).sqrt()
    }

    /// An initial stress counts as strained in the grid's axes alone, as [`ConstitutiveLaw::start`] has it.
    fn off_plane_stress(&self, stress: &SMatrix<T, D, D>, _state: &()) -> Option<T> {
        unstrained_stress(&self.moduli, stress)
    }

    fn energy_density(&self, stress: &SMatrix<T, D, D>, _state: &()) -> T {
        complementary_energy(&self.moduli, stress)
    }
}
