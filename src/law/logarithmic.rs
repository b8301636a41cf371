//! The logarithmic law at large strain.

use nalgebra::SMatrix;

use super::{ConstitutiveLaw, Moduli};
use crate::scalar::Scalar;

/// Hencky's law in uniaxial strain, $\sigma = E\ln J$, in one dimension.
///
/// Written as a rate whose memory is the stress itself: a step that stretches by $1 + \Delta\varepsilon$ adds
/// $E\ln(1 + \Delta\varepsilon)$, which is exact for every step, and an initial stress is the deformation
/// $J = e^{\sigma/E}$ that belongs to it. In consolidation it is the law of Xie and Leo's solution.
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Logarithmic<T> {
    /// Elastic constants; only the modulus of uniaxial strain is felt.
    pub moduli: Moduli<T>,
}

impl<T: Scalar> ConstitutiveLaw<T, 1> for Logarithmic<T> {
    type State = ();

    #[inline(always)]
    fn large_strain(&self) -> bool {
        true
    }

    #[inline(always)]
    fn update(&self, increment: &SMatrix<T, 1, 1>, stress: &mut SMatrix<T, 1, 1>, _state: &mut ()) {
        stress[(0, 0)] += self.moduli.p_wave() * increment[(0, 0)].ln_1p();
    }

    /// In uniaxial strain the area stays, so Cauchy's stress is the nominal one, and along the current
    /// configuration `rho c^2 = J d sigma / d J = E`.
    #[inline(always)]
    fn wave_speed(&self, density: T, _stress: &SMatrix<T, 1, 1>, _state: &()) -> T {
        (self.moduli.p_wave() / density).sqrt()
    }

    /// `E (J ln J - J + 1)` per reference volume, over `J`, with `ln J = sigma / E`.
    fn energy_density(&self, stress: &SMatrix<T, 1, 1>, _state: &()) -> T {
        let modulus = self.moduli.p_wave();
        let strain = stress[(0, 0)] / modulus;
        if strain.abs() < T::default_epsilon().sqrt() {
            // The difference below would cancel.
            return modulus * strain * strain / T::lit(2.0);
        }
        modulus * (strain + (-strain).exp_m1())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix1;

    #[test]
    fn stress_follows_the_stretch_whatever_the_steps() {
        let law = Logarithmic {
            moduli: Moduli::uniaxial(3e4).unwrap(),
        };
        let mut stress = Matrix1::new(3e4 * 0.9_f64.ln());
        for increment in [-0.3, 0.02, -1e-9, 0.5] {
            law.update(&Matrix1::new(increment), &mut stress, &mut ());
        }
        let stretch: f64 = 0.9 * 0.7 * 1.02 * (1.0 - 1e-9) * 1.5;
        assert!((stress[(0, 0)] - 3e4 * stretch.ln()).abs() < 1e-10);
    }

    #[test]
    fn small_and_large_stress_give_one_energy_curve() {
        let law = Logarithmic {
            moduli: Moduli::uniaxial(1.0).unwrap(),
        };
        for s in [-0.4_f64, -1e-7, 1e-9, 1e-6, 1e-3, 0.5] {
            let energy = law.energy_density(&Matrix1::new(s), &());
            // Series of s - 1 + exp(-s).
            let mut term = -s;
            let mut series = 0.0;
            for k in 2..40 {
                term *= -s / f64::from(k);
                series += term;
            }
            assert!((energy - series).abs() <= 3e-8 * series, "{s}: {energy} {series}");
        }
    }
}
