//! The constants of a saturated soil.

use super::super::{ReferenceError, check};

/// Constants of a saturated soil, without the law of its skeleton.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Soil {
    /// Part of the volume that the liquid fills, $n$, between 0 and 1.
    pub porosity: f64,
    /// Density of the grains, $\rho_s$, kg/m3.
    pub solid_density: f64,
    /// Density of the liquid, $\rho_w$, kg/m3.
    pub liquid_density: f64,
    /// Bulk modulus of the liquid, $K_w$, Pa.
    pub liquid_bulk_modulus: f64,
    /// Hydraulic permeability of the undeformed skeleton, $k_0$, m/s.
    pub permeability: f64,
    /// Exponent $m$ of $k = k_0 \lambda^m$; small strain does not see it.
    pub permeability_exponent: f64,
    /// Magnitude $g$ of gravity, m/s2. It defines the permeability, through the unit weight of the liquid,
    /// also where no weight acts.
    pub gravity: f64,
}

impl Soil {
    /// Passes a soil whose constants make sense.
    ///
    /// # Errors
    /// Where a constant is not finite, the porosity not between 0 and 1, or another one but the exponent not
    /// positive.
    pub fn check(self) -> Result<Self, ReferenceError> {
        if !(self.porosity > 0.0 && self.porosity < 1.0) {
            return Err(ReferenceError::InvalidPorosity { value: self.porosity });
        }
        check::positive("solid density", self.solid_density)?;
        check::positive("liquid density", self.liquid_density)?;
        check::positive("liquid bulk modulus", self.liquid_bulk_modulus)?;
        check::positive("permeability", self.permeability)?;
        check::finite("permeability exponent", self.permeability_exponent)?;
        check::positive("gravity", self.gravity)?;
        Ok(self)
    }

    /// Part of the volume that the grains fill, $1 - n$.
    pub fn solid_fraction(&self) -> f64 {
        1.0 - self.porosity
    }

    /// Unit weight of the liquid, $\gamma_w = \rho_w g$, N/m3.
    pub fn unit_weight(&self) -> f64 {
        self.liquid_density * self.gravity
    }

    /// Density of the saturated soil, $(1-n) \rho_s + n \rho_w$, kg/m3.
    pub fn saturated_density(&self) -> f64 {
        self.solid_fraction() * self.solid_density + self.porosity * self.liquid_density
    }

    /// Stiffness $K_w / n$ that the locked liquid adds to the skeleton, Pa.
    pub fn locked_stiffness(&self) -> f64 {
        self.liquid_bulk_modulus / self.porosity
    }

    /// Coefficient of consolidation $c_v = k_0 / (\gamma_w (1/E + n/K_w))$, m2/s, with a skeleton of
    /// constrained `modulus` $E$, Pa.
    pub fn consolidation_coefficient(&self, modulus: f64) -> f64 {
        self.permeability / (self.unit_weight() * (1.0 / modulus + 1.0 / self.locked_stiffness()))
    }

    /// Part of a load that the pore pressure takes as long as no liquid leaves, $(K_w/n) / (E + K_w/n)$, with
    /// a skeleton of constrained `modulus` $E$, Pa. The skeleton takes the rest.
    pub fn undrained_pressure_ratio(&self, modulus: f64) -> f64 {
        1.0 / (1.0 + modulus / self.locked_stiffness())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The soil of the report's tables 6 and 7, with a permeability and bulk modulus of the caller's.
    pub(in super::super) fn report_soil(permeability: f64, liquid_bulk_modulus: f64) -> Soil {
        Soil {
            porosity: 0.4,
            solid_density: 2.6e3,
            liquid_density: 1e3,
            liquid_bulk_modulus,
            permeability,
            permeability_exponent: 2.0,
            gravity: 9.81,
        }
    }

    /// By hand: 1e-5 / (9810 (1e-7 + 0.4/3e8)).
    #[test]
    fn derived_constants() {
        let soil = report_soil(1e-5, 3e8);
        assert!((soil.saturated_density() - 1960.0).abs() < 1e-12);
        assert!((soil.consolidation_coefficient(1e7) / 1.005_955_255_1e-2 - 1.0).abs() < 1e-10);
        assert!((soil.undrained_pressure_ratio(1e7) - 75.0 / 76.0).abs() < 1e-15);
    }

    #[test]
    fn refuses_senseless_constants() {
        let sound = report_soil(1e-5, 3e8);
        assert_eq!(sound.check(), Ok(sound));
        for porosity in [0.0, 1.0, f64::NAN, -0.1] {
            assert!(Soil { porosity, ..sound }.check().is_err());
        }
        let bad = |change: fn(&mut Soil)| {
            let mut soil = sound;
            change(&mut soil);
            soil.check().is_err()
        };
        assert!(bad(|s| s.solid_density = 0.0));
        assert!(bad(|s| s.liquid_density = -1.0));
        assert!(bad(|s| s.liquid_bulk_modulus = f64::INFINITY));
        assert!(bad(|s| s.permeability = 0.0));
        assert!(bad(|s| s.permeability_exponent = f64::NAN));
        assert!(bad(|s| s.gravity = 0.0));
    }
}
