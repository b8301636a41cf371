//! Elastic laws of one-dimensional motion.

use super::{ReferenceError, check};

/// An elastic law of one-dimensional motion, in which the lateral stretches stay 1.
///
/// A cross-section then keeps its area, so that Cauchy and nominal stress are the same number. `J` is the
/// stretch of a material fibre, `1 + du/dX`; it equals the volume ratio.
pub trait UniaxialLaw {
    /// Stress, Pa, at stretch `J`; zero at 1.
    fn stress(&self, stretch: f64) -> f64;

    /// Tangent stiffness `d stress / dJ`, Pa. Waves need it positive: their speed, m/s in the reference
    /// configuration, is `sqrt(stiffness / density)`.
    fn stiffness(&self, stretch: f64) -> f64;
}

/// A law whose stress derives from a stored energy.
///
/// Every uniaxial elastic law has one, but not always in closed form.
pub trait Hyperelastic: UniaxialLaw {
    /// Stored energy per reference volume, J/m3: the integral of the stress over the stretch, from 1.
    fn energy(&self, stretch: f64) -> f64;
}

/// A law that says which stretch a stress belongs to.
///
/// With soil, it is where consolidation under a load ends: the stretch at which the skeleton carries all of
/// it.
pub trait InvertibleLaw: UniaxialLaw {
    /// The stretch at `stress`, Pa.
    ///
    /// # Errors
    /// [`ReferenceError::NoEquilibrium`] where no stretch has that stress, and where it is not finite.
    fn stretch(&self, stress: f64) -> Result<f64, ReferenceError>;
}

/// The linear law of small strain, `sigma = E (J - 1)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// Young's modulus (in one-dimensional strain, the constrained modulus), Pa.
    pub youngs_modulus: f64,
}

impl UniaxialLaw for Linear {
    fn stress(&self, stretch: f64) -> f64 {
        self.youngs_modulus * (stretch - 1.0)
    }

    fn stiffness(&self, _stretch: f64) -> f64 {
        self.youngs_modulus
    }
}

impl Hyperelastic for Linear {
    fn energy(&self, stretch: f64) -> f64 {
        0.5 * self.youngs_modulus * (stretch - 1.0).powi(2)
    }
}

impl InvertibleLaw for Linear {
    fn stretch(&self, stress: f64) -> Result<f64, ReferenceError> {
        Ok(1.0 + check::finite("stress", stress)? / self.youngs_modulus)
    }
}

/// Hill's rate law integrated exactly, `sigma = E (1 - 1/J)`.
///
/// The rate law `d sigma/dt = (E - sigma) dv/dx` is that of the large-strain benchmarks (doi
/// 10.1002/nme.5956). With `dJ/dt = J dv/dx` it reads `d sigma/dJ = (E - sigma)/J`, whose solution from
/// `sigma(1) = 0` this is. Tension stays below `E`; compression is unbounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hill {
    /// Young's modulus, Pa.
    pub youngs_modulus: f64,
}

impl UniaxialLaw for Hill {
    fn stress(&self, stretch: f64) -> f64 {
        // One division and no difference of near equals: 1 - 1/J loses digits at J near 1.
        self.youngs_modulus * ((stretch - 1.0) / stretch)
    }

    fn stiffness(&self, stretch: f64) -> f64 {
        self.youngs_modulus / (stretch * stretch)
    }
}

impl Hyperelastic for Hill {
    fn energy(&self, stretch: f64) -> f64 {
        let strain = stretch - 1.0;
        self.youngs_modulus * (strain - strain.ln_1p())
    }
}

impl InvertibleLaw for Hill {
    fn stretch(&self, stress: f64) -> Result<f64, ReferenceError> {
        let youngs_modulus = self.youngs_modulus;
        if check::finite("stress", stress)? < youngs_modulus {
            Ok(youngs_modulus / (youngs_modulus - stress))
        } else {
            Err(ReferenceError::NoEquilibrium {
                stress,
                youngs_modulus,
            })
        }
    }
}

/// The logarithmic law `sigma = E ln J`.
///
/// The law of soil in one-dimensional compression that the large-strain consolidation of K. H. Xie and C. J.
/// Leo (Comput. Geotech. 31, 2004) belongs to. Its rate is `d sigma/dt = E dv/dx`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Logarithmic {
    /// Young's modulus (in one-dimensional strain, the constrained modulus), Pa.
    pub youngs_modulus: f64,
}

impl UniaxialLaw for Logarithmic {
    fn stress(&self, stretch: f64) -> f64 {
        self.youngs_modulus * (stretch - 1.0).ln_1p()
    }

    fn stiffness(&self, stretch: f64) -> f64 {
        self.youngs_modulus / stretch
    }
}

impl Hyperelastic for Logarithmic {
    fn energy(&self, stretch: f64) -> f64 {
        let strain = stretch - 1.0;
        self.youngs_modulus * (stretch * strain.ln_1p() - strain)
    }
}

impl InvertibleLaw for Logarithmic {
    fn stretch(&self, stress: f64) -> Result<f64, ReferenceError> {
        Ok((check::finite("stress", stress)? / self.youngs_modulus).exp())
    }
}

/// The compressible neo-Hookean law, `sigma = lambda ln J / J + mu (J^2 - 1) / J`.
///
/// Cauchy stress of `(lambda ln J / J) I + (mu / J) (F F^T - I)` along an axis whose lateral stretches are 1.
/// For `lambda > 0` the stiffness falls in tension; it stays positive while
/// `lambda (ln J - 1) < mu (J^2 + 1)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean {
    /// First Lamé parameter, Pa.
    pub lambda: f64,
    /// Shear modulus, Pa.
    pub mu: f64,
}

impl UniaxialLaw for NeoHookean {
    fn stress(&self, stretch: f64) -> f64 {
        let strain = stretch - 1.0;
        (self.lambda * strain.ln_1p() + self.mu * strain * (stretch + 1.0)) / stretch
    }

    fn stiffness(&self, stretch: f64) -> f64 {
        let square = stretch * stretch;
        self.lambda * (1.0 - stretch.ln()) / square + self.mu * (1.0 + 1.0 / square)
    }
}

impl Hyperelastic for NeoHookean {
    fn energy(&self, stretch: f64) -> f64 {
        let strain = stretch - 1.0;
        let log = strain.ln_1p();
        0.5 * self.lambda * log * log + 0.5 * self.mu * (strain * (stretch + 1.0) - 2.0 * log)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRETCHES: [f64; 5] = [0.4, 0.9, 1.0, 1.2, 2.5];
    const STEP: f64 = 1e-4;

    /// Central difference of fourth order.
    fn derivative(f: impl Fn(f64) -> f64, x: f64) -> f64 {
        (8.0 * (f(x + STEP) - f(x - STEP)) - (f(x + 2.0 * STEP) - f(x - 2.0 * STEP))) / (12.0 * STEP)
    }

    /// Stress and stiffness are the derivatives of energy and stress, and vanish where they must.
    fn assert_consistent(law: &impl Hyperelastic, modulus: f64) {
        for stretch in STRETCHES {
            let stress = derivative(|j| law.energy(j), stretch);
            assert!(
                (stress - law.stress(stretch)).abs() < 1e-8 * modulus,
                "stress at {stretch}"
            );
            let stiffness = derivative(|j| law.stress(j), stretch);
            assert!(
                (stiffness - law.stiffness(stretch)).abs() < 1e-8 * modulus,
                "stiffness at {stretch}"
            );
        }
        assert_eq!((law.energy(1.0), law.stress(1.0)), (0.0, 0.0));
        assert!((law.stiffness(1.0) - modulus).abs() < 1e-12 * modulus);
    }

    #[test]
    fn each_law_derives_from_its_energy() {
        assert_consistent(&Linear { youngs_modulus: 4e4 }, 4e4);
        assert_consistent(&Hill { youngs_modulus: 4e4 }, 4e4);
        assert_consistent(&Logarithmic { youngs_modulus: 4e4 }, 4e4);
        assert_consistent(&NeoHookean { lambda: 2e4, mu: 1e4 }, 4e4);
    }

    /// The increments sigma += (E - sigma) d_eps of the method tend to the integral with first order in their
    /// size.
    #[test]
    fn hill_is_the_integral_of_its_rate() {
        let law = Hill { youngs_modulus: 4e4 };
        let error = |steps: u32| {
            let increment = 1.3_f64.ln() / f64::from(steps);
            let stress = (0..steps).fold(0.0, |stress, _| stress + (4e4 - stress) * increment);
            (stress / law.stress(1.3) - 1.0).abs()
        };
        let ratio = error(1000) / error(2000);
        assert!(error(2000) < 1e-3, "{}", error(2000));
        assert!((1.95..2.05).contains(&ratio), "{ratio}");
    }

    #[test]
    fn neo_hookean_follows_the_tensor_formula() {
        let (lambda, mu, j) = (3.0, 5.0, 1.7_f64);
        let expected = lambda * j.ln() / j + mu / j * (j * j - 1.0);
        assert!((NeoHookean { lambda, mu }.stress(j) - expected).abs() < 1e-13);
    }

    #[test]
    fn stretch_undoes_stress() {
        fn assert_inverse(law: &impl InvertibleLaw) {
            for stretch in STRETCHES {
                let back = law.stretch(law.stress(stretch)).unwrap();
                assert!((back - stretch).abs() < 1e-14, "{back} against {stretch}");
            }
            assert!(law.stretch(f64::NAN).is_err());
        }
        assert_inverse(&Linear { youngs_modulus: 4e4 });
        assert_inverse(&Hill { youngs_modulus: 4e4 });
        assert_inverse(&Logarithmic { youngs_modulus: 4e4 });
        let torn = Hill { youngs_modulus: 4e4 }.stretch(4e4);
        assert!(matches!(torn, Err(ReferenceError::NoEquilibrium { .. })));
    }
}
