//! Consolidation at large strain, exactly.

use super::super::check;
use super::diffusion::Layer;
use super::{ReferenceError, Soil, TwoPhaseReference, TwoPhaseState};

/// Consolidation of a layer at large strain: exact without inertia, for an incompressible liquid or, with
/// [`with_compressible_liquid`](XieLeo::with_compressible_liquid), for the liquid of the soil.
///
/// The problem is that of [`Consolidation`](super::Consolidation), with $\sigma' = E \ln \lambda$ and $k =
/// k_0 \lambda^2$. At an impermeable base the total flux vanishes, so Darcy's law gives, with the material
/// coordinate $X$,
///
/// $$u_t = v_s = -n (v_w - v_s) = -\frac{k}{\gamma_w} \frac{p_X}{\lambda}
///     = \frac{k_0 \lambda}{\gamma_w} \frac{E \lambda_X}{\lambda} = c_v u_{XX}, \qquad c_v = \frac{k_0 E}{\gamma_w}:$$
///
/// the heat equation, linear at any strain. With $S(\xi, \tau)$ of `Consolidation`, $\xi = X/H$, $\tau = c_v
/// t/H^2$,
///
/// $$\lambda = 1 + \left(e^{q/E} - 1\right) (1 - S), \quad u = H \left(e^{q/E} - 1\right) \int_0^\xi (1 - S)
/// d\xi, \quad
///     v_w = -\frac{1-n}{n} v_s, \quad p = q - E \ln \lambda.$$
///
/// A liquid of bulk modulus $K_w$ stores $\dot p = (K_w/(n \lambda)) ((1-n) v_s' + n v_w')$, with $p = q - E
/// \ln \lambda$. The equation stays linear: the same solution with
///
/// $$c_v = \frac{k_0}{\gamma_w (1/E + n/K_w)}, \qquad v_w = v_s - \frac{k_0 E}{n \gamma_w} \lambda_X$$
///
/// is that of the equations of the [module](super) without inertia (own derivation).
///
/// Source: K. H. Xie and C. J. Leo, *Analytical solutions of one-dimensional large strain consolidation of
/// saturated and homogeneous clays*, Comput. Geotech. 31 (2004) 301-314. Only the velocity of the liquid
/// depends on the porosity, which is kept constant, as the method keeps it.
#[doc = include_str!("../../../docs/formulas.html")]
#[derive(Clone, Debug, PartialEq)]
pub struct XieLeo {
    height: f64,
    modulus: f64,
    load: f64,
    soil: Soil,
    compressible: bool,
    origin: f64,
    time: f64,
}

impl XieLeo {
    /// A layer of initial `height`, m, and `modulus` $E$, Pa, under `load`, Pa (negative in compression),
    /// with its base at 0. Of the soil, the bulk modulus does not matter, and the densities only by the unit
    /// weight of the liquid.
    ///
    /// # Errors
    /// Where a parameter is not finite, or height or modulus not positive, the soil makes no sense or its
    /// permeability does not follow $k_0 \lambda^2$.
    pub fn new(height: f64, modulus: f64, load: f64, soil: Soil) -> Result<Self, ReferenceError> {
        let required = 2.0;
        if soil.permeability_exponent != required {
            return Err(ReferenceError::WrongPermeability {
                exponent: soil.permeability_exponent,
                required,
            });
        }
        Ok(Self {
            height: check::positive("height", height)?,
            modulus: check::positive("modulus", modulus)?,
            load: check::finite("load", load)?,
            soil: soil.check()?,
            compressible: false,
            origin: 0.0,
            time: 0.0,
        })
    }

    /// The same layer with its base at `origin`, m.
    ///
    /// # Errors
    /// Where `origin` is not finite.
    pub fn with_origin(self, origin: f64) -> Result<Self, ReferenceError> {
        Ok(Self {
            origin: check::finite("origin", origin)?,
            ..self
        })
    }

    /// The same layer with a liquid that has the soil's bulk modulus.
    pub fn with_compressible_liquid(self) -> Self {
        Self {
            compressible: true,
            ..self
        }
    }

    /// $c_v$, m2/s.
    pub fn coefficient(&self) -> f64 {
        if self.compressible {
            self.soil.consolidation_coefficient(self.modulus)
        } else {
            self.mobility()
        }
    }

    /// $k_0 E / \gamma_w$, m2/s.
    fn mobility(&self) -> f64 {
        self.soil.permeability * self.modulus / self.soil.unit_weight()
    }
}

impl TwoPhaseReference for XieLeo {
    fn advance(&mut self, time: f64) -> Result<(), ReferenceError> {
        self.time = check::time(time)?;
        Ok(())
    }

    /// Beyond the ends, the state of the nearer end.
    fn at(&self, x0: f64) -> TwoPhaseState {
        let &Self {
            height,
            modulus,
            load,
            soil,
            ..
        } = self;
        let diffusivity = self.coefficient();
        let layer = Layer::at(
            (x0 - self.origin) / height,
            diffusivity * self.time / (height * height),
        );
        let final_strain = (load / modulus).exp_m1();
        let stretch_gradient = final_strain / height * layer.gradient;
        let effective_stress = modulus * (final_strain * layer.drained).ln_1p();
        // q - sigma' would leave nothing of a small pressure: ln(lambda / e^(q/E)) is the same.
        let above_final = -final_strain * layer.remaining * (-load / modulus).exp();
        TwoPhaseState {
            solid_displacement: final_strain * height * layer.drained_below,
            solid_velocity: diffusivity * stretch_gradient,
            liquid_velocity: (diffusivity - self.mobility() / soil.porosity) * stretch_gradient,
            effective_stress,
            pore_pressure: -modulus * above_final.ln_1p(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::soil::tests::report_soil;
    use super::super::testing::{assert_close, derivative};
    use super::*;

    fn layer(time: f64) -> XieLeo {
        let layer = XieLeo::new(1.6, 1e6, -5e5, report_soil(3.68e-4, 3e7));
        let mut layer = layer.and_then(|layer| layer.with_origin(0.7)).unwrap();
        layer.advance(time).unwrap();
        layer
    }

    #[test]
    fn satisfies_its_equations() {
        for time in [1.0, 10.0, 40.0] {
            for x in [0.8, 1.5, 2.0] {
                let state = layer(time).at(x);
                let along = |f: fn(TwoPhaseState) -> f64| derivative(|x| f(layer(time).at(x)), x, 4e-3);
                let velocity = derivative(|t| layer(t).at(x).solid_displacement, time, 2e-3 * time);
                assert_close(velocity, state.solid_velocity, 1e-11);

                let stretch = 1.0 + along(|s| s.solid_displacement);
                assert_close(1e6 * stretch.ln(), state.effective_stress, 1e-3);
                assert_close(state.effective_stress + state.pore_pressure, -5e5, 1e-9);

                let permeability = 3.68e-4 * stretch * stretch;
                let darcy = permeability / 9810.0 * along(|s| s.pore_pressure) / stretch;
                let seepage = 0.4 * (state.liquid_velocity - state.solid_velocity);
                assert_close(seepage, darcy, 1e-9);
                assert_close(seepage, -state.solid_velocity, 1e-15);
            }
        }
    }

    /// Expected values from a 30-digit evaluation of the series: u, v_s, v_w, sigma', p for the benchmark of
    /// report 18-2 with the permeability that its settlement needs. The first line is that settlement.
    #[test]
    #[rustfmt::skip]
    fn reproduces_reference_digits() {
        let cases = [
            (0.4, 1.0, [-0.054_385_779_526_026_29, -0.067_982_224_407_532_86,
                0.101_973_336_611_299_29, -5e5, 0.0]),
            (0.4, 0.9, [-0.023_856_589_374_887_785, -0.057_548_968_466_721_83,
                0.086_323_452_700_082_74, -250_804.941_786_062_15, -249_195.058_213_937_85]),
            (10.0, 0.5, [-0.107_367_452_827_370_09, -0.008_267_265_102_085_003,
                0.012_400_897_653_127_506, -291_761.963_149_341_06, -208_238.036_850_658_91]),
        ];
        let mut layer = XieLeo::new(1.0, 1e6, -5e5, report_soil(3.68e-4, 3e7)).unwrap();
        for (time, x, expected) in cases {
            layer.advance(time).unwrap();
            let s = layer.at(x);
            let actual = [s.solid_displacement, s.solid_velocity, s.liquid_velocity, s.effective_stress,
                s.pore_pressure];
            for (a, e) in actual.iter().zip(expected) {
                assert!((a - e).abs() <= 1e-13 * e.abs().max(1e-2), "{a} against {e}");
            }
        }
    }

    /// From the same evaluation. The settlement is the one that the converged method is to be measured
    /// against.
    #[test]
    #[rustfmt::skip]
    fn compressible_liquid_has_its_reference_digits() {
        let layer = XieLeo::new(1.0, 1e6, -5e5, report_soil(3.68e-4, 3e7)).unwrap();
        let mut layer = layer.with_compressible_liquid();
        layer.advance(0.4).unwrap();
        let s = layer.at(0.9);
        let actual = [layer.at(1.0).solid_displacement, s.solid_displacement, s.solid_velocity, s.liquid_velocity,
            s.effective_stress, s.pore_pressure];
        let expected = [-0.054_026_793_559_820_55, -0.023_553_033_288_545_813, -0.057_042_244_797_009_7, 0.087_464_775_355_414_87, -249_497.313_008_961_06, -250_502.686_991_038_94];
        for (a, e) in actual.iter().zip(expected) {
            assert!((a / e - 1.0).abs() <= 1e-13, "{a} against {e}");
        }
    }

    /// The permeability that report 18-2 prints settles by a sixth of what it prints; from the same
    /// evaluation.
    #[test]
    fn printed_permeability_settles_less() {
        let layer = XieLeo::new(1.0, 1e6, -5e5, report_soil(1e-5, 3e7)).unwrap();
        let mut layer = layer.with_compressible_liquid();
        layer.advance(0.4).unwrap();
        assert_close(layer.at(1.0).solid_displacement, -8.906_053_178_382_733e-3, 1e-15);
    }

    /// p_t = (K_w / (n lambda)) ((1-n) v_s' + n v_w').
    #[test]
    fn compressible_liquid_stores() {
        let at = |time: f64, x: f64| {
            let mut layer = layer(0.0).with_compressible_liquid();
            layer.advance(time).unwrap();
            layer.at(x)
        };
        for x in [1.2, 2.1] {
            let along = |f: fn(TwoPhaseState) -> f64| derivative(|x| f(at(4.0, x)), x, 4e-3);
            let stretch = 1.0 + along(|s| s.solid_displacement);
            let inflow = 0.6 * along(|s| s.solid_velocity) + 0.4 * along(|s| s.liquid_velocity);
            let rate = derivative(|t| at(t, x).pore_pressure, 4.0, 8e-3);
            assert_close(3e7 / (0.4 * stretch) * inflow, rate, 1e-6 * rate.abs());
            let darcy = 3.68e-4 * stretch / 9810.0 * along(|s| s.pore_pressure);
            let state = at(4.0, x);
            assert_close(0.4 * (state.liquid_velocity - state.solid_velocity), darcy, 1e-9);
        }
    }

    #[test]
    fn small_loads_give_small_strain() {
        let soil = report_soil(3.68e-4, 1e18);
        let mut large = XieLeo::new(1.0, 1e6, -1.0, soil).unwrap();
        let mut small = super::super::Consolidation::new(1.0, 1e6, -1.0, soil).unwrap();
        large.advance(2.0).unwrap();
        small.advance(2.0).unwrap();
        for x in [0.2, 0.7, 1.0] {
            let (large, small) = (large.at(x), small.at(x));
            assert_close(large.solid_displacement, small.solid_displacement, 1e-12);
            assert_close(large.liquid_velocity, small.liquid_velocity, 1e-12);
            assert_close(large.pore_pressure, small.pore_pressure, 1e-6);
        }
    }

    #[test]
    fn ends_at_the_stretch_of_the_load() {
        let end = layer(1e4).at(2.3);
        assert_close(end.solid_displacement, 1.6 * (-0.5_f64).exp_m1(), 1e-15);
        assert_close(end.effective_stress, -5e5, 1e-9);
    }

    #[test]
    fn refuses_another_permeability() {
        let soil = Soil {
            permeability_exponent: 1.0,
            ..report_soil(1e-4, 3e7)
        };
        assert_eq!(
            XieLeo::new(1.0, 1e6, -5e5, soil).err(),
            Some(ReferenceError::WrongPermeability {
                exponent: 1.0,
                required: 2.0
            })
        );
        assert!(XieLeo::new(1.0, 1e6, f64::INFINITY, report_soil(1e-4, 3e7)).is_err());
        assert!(layer(1.0).advance(f64::NAN).is_err());
    }
}
