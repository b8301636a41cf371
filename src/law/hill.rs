//! Hill's rate at large strain.

use nalgebra::SMatrix;

use super::linear_elastic::{complementary_energy, hooke, unstrained_stress};
use super::{ConstitutiveLaw, Moduli};
use crate::scalar::Scalar;
use crate::tensor::symmetric;

/// Hypoelastic law with Hill's rate,
///
/// $$\dot\sigma = \mathbb{C}:d + W\sigma - \sigma W - \operatorname{tr}(d)\sigma,\qquad\text{in 1-D}\quad
/// \dot\sigma = (E-\sigma)\dot\varepsilon$$
///
/// (journal, equation 3), whose exact integral is $\sigma = E(1 - 1/J)$. Stress reaches $E$ only for infinite
/// stretch; a stress of $E$ or more has no meaning in 1-D.
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hill<T> {
    /// Elastic constants.
    pub moduli: Moduli<T>,
}

impl<T: Scalar, const D: usize> ConstitutiveLaw<T, D> for Hill<T> {
    type State = ();

    fn limits(&self) -> &'static str {
        "in one dimension Hill's law has a meaning below its modulus only, so take smaller steps or another \
         law"
    }

    /// Also refuses a stress that is not a number.
    #[inline(always)]
    fn knows(&self, stress: &SMatrix<T, D, D>, _state: &()) -> bool {
        D > 1 || stress[(0, 0)] < self.moduli.p_wave()
    }

    #[inline(always)]
    fn large_strain(&self) -> bool {
        true
    }

    #[inline(always)]
    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, _state: &mut ()) {
        if const { D == 1 } {
            let modulus = self.moduli.p_wave() - stress[(0, 0)];
            stress[(0, 0)] += modulus * increment[(0, 0)];
            return;
        }
        let strain = symmetric(increment);
        let spin = increment - strain;
        let rotated = spin * *stress - *stress * spin;
        *stress += hooke(&self.moduli, &strain) + rotated - *stress * strain.trace();
    }

    #[inline(always)]
    fn wave_speed(&self, density: T, stress: &SMatrix<T, D, D>, _state: &()) -> T {
        // Along an axis the tangent is C - sigma: the most compressed axis is the fastest.
        let lowest = (1..D).fold(stress[(0, 0)], |lowest, a| lowest.min(stress[(a, a)]));
        let modulus = self.moduli.p_wave() - lowest;
        (modulus.max(T::zero()) / density).sqrt()
    }

    /// That of small strain is exact here too, step by step: spin has no part in the trace, so `tr(sigma)`
    /// gains `(2 (lambda + mu) - tr(sigma)) tr(d)` in the plane and the stress off it `(lambda - sigma_zz)
    /// tr(d)`, which keeps their ratio.
    fn off_plane_stress(&self, stress: &SMatrix<T, D, D>, _state: &()) -> Option<T> {
        unstrained_stress(&self.moduli, stress)
    }

    /// Exact in 1-D: `E (J - 1 - ln J)` per reference volume with `J = 1/(1 - sigma/E)`. Beyond 1-D the rate
    /// has no potential, and this is the leading term `sigma : C^-1 : sigma / 2`.
    fn energy_density(&self, stress: &SMatrix<T, D, D>, _state: &()) -> T {
        if const { D > 1 } {
            return complementary_energy(&self.moduli, stress);
        }
        let modulus = self.moduli.p_wave();
        let strain = stress[(0, 0)] / modulus;
        if strain.abs() < T::default_epsilon().sqrt() {
            // The difference below would cancel.
            return modulus * strain * strain / T::lit(2.0);
        }
        // Per current volume: E (J - 1 - ln J)/J with 1/J = 1 - strain.
        modulus * (strain + (T::one() - strain) * (-strain).ln_1p())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix1;

    #[test]
    fn the_rate_integrates_to_its_closed_form_at_first_order_in_the_step() {
        let law = Hill {
            moduli: Moduli::uniaxial(4e4).unwrap(),
        };
        let end = |steps: u32| {
            let (mut stress, mut stretch) = (Matrix1::new(0.0), 1.0_f64);
            for _ in 0..steps {
                let increment = 0.3 / f64::from(steps);
                law.update(&Matrix1::new(increment), &mut stress, &mut ());
                stretch *= 1.0 + increment;
            }
            (stress[(0, 0)] - 4e4 * (1.0 - 1.0 / 0.3_f64.exp()), stretch)
        };
        let (coarse, fine) = (end(100).0, end(200).0);
        assert!((coarse / fine - 2.0).abs() < 0.02, "{coarse} {fine}");
    }

    #[test]
    fn small_and_large_stress_give_one_energy_curve() {
        let law = Hill {
            moduli: Moduli::uniaxial(1.0).unwrap(),
        };
        for s in [-0.4_f64, -1e-7, 1e-9, 1e-6, 1e-3, 0.5] {
            let energy = ConstitutiveLaw::<f64, 1>::energy_density(&law, &Matrix1::new(s), &());
            // Series of s + (1 - s) ln(1 - s).
            let series: f64 = (2..200).map(|k| s.powi(k) / f64::from(k * (k - 1))).sum();
            assert!((energy - series).abs() <= 2e-8 * series, "{s}: {energy} {series}");
        }
    }
}
