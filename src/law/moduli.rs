//! Elastic constants of an isotropic solid.

use crate::error::SetupError;
use crate::scalar::Scalar;

/// Lame's constants (Pa). In 1-D only the modulus `lambda + 2 mu` of uniaxial strain is felt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moduli<T> {
    /// First constant.
    pub lambda: T,
    /// Shear modulus.
    pub mu: T,
}

impl<T: Scalar> Moduli<T> {
    /// From Young's modulus (Pa) and Poisson's ratio.
    ///
    /// # Errors
    /// If the modulus is not positive and finite, or the ratio is not within (-1, 1/2).
    pub fn from_young(youngs_modulus: T, poissons_ratio: T) -> Result<Self, SetupError> {
        let (one, two) = (T::one(), T::lit(2.0));
        if !youngs_modulus.is_finite() || youngs_modulus <= T::zero() {
            return Err(SetupError::Constant {
                name: "youngs_modulus",
                value: youngs_modulus.primal(),
                allowed: "it must be positive and finite",
            });
        }
        if !(poissons_ratio > -one && poissons_ratio < one / two) {
            return Err(SetupError::Constant {
                name: "poissons_ratio",
                value: poissons_ratio.primal(),
                allowed: "it must lie between -1 and 0.5",
            });
        }
        let mu = youngs_modulus / (two * (one + poissons_ratio));
        Ok(Self {
            lambda: two * mu * poissons_ratio / (one - two * poissons_ratio),
            mu,
        })
    }

    /// For uniaxial strain with the modulus (Pa) that 1-D benchmarks call Young's: Poisson's ratio 0.
    ///
    /// # Errors
    /// If the modulus is not positive and finite.
    pub fn uniaxial(modulus: T) -> Result<Self, SetupError> {
        Self::from_young(modulus, T::zero())
    }

    /// Bulk modulus `lambda + 2 mu / 3` (Pa) of three dimensions, which plane and uniaxial strain live in.
    #[inline(always)]
    pub fn bulk(&self) -> T {
        self.lambda + (self.mu + self.mu) / T::lit(3.0)
    }

    /// Modulus of uniaxial strain `lambda + 2 mu` (Pa).
    #[inline(always)]
    pub fn p_wave(&self) -> T {
        self.lambda + self.mu + self.mu
    }
}
