//! Consolidation at small strain, exactly.

use super::super::check;
use super::diffusion::Layer;
use super::{ReferenceError, Soil, TwoPhaseReference, TwoPhaseState};

/// Consolidation of a linear elastic layer at small strain: exact without inertia.
///
/// The layer of height $H$ stands on a fixed, impermeable base; its top drains and bears the load $q$ from
/// time 0 on, which the liquid carries at first, $p = q$. With $\xi = x/H$, $\tau = c_v t / H^2$ and the
/// pressure $S(\xi, \tau)$ of a layer that starts at 1,
///
/// $$\begin{aligned}
/// p &= q S, & \sigma' &= q (1 - S), & u_s &= \frac{q H}{E} \int_0^\xi (1 - S) d\xi, \\\\
/// v_s &= -\frac{q c_v}{E H} S_\xi, &
/// v_w &= \frac{q c_v}{H} \left(\frac{1}{K_w} + \frac{1-n}{n E}\right) S_\xi, &
/// c_v &= \frac{k_0}{\gamma_w (1/E + n/K_w)}.
/// \end{aligned}$$
///
/// Source: K. Terzaghi 1925; as series in report 18-2, section 6.2 (see the [module](super)). Early times are
/// summed over images instead, so that no time needs more than five terms. At time 0 the load has just been
/// applied: velocities are 0 and $p = q$ up to the top; an instant later the top's velocities are infinite.
#[doc = include_str!("../../../docs/formulas.html")]
///
/// ```
/// # use materialpoint::reference::{ReferenceError, two_phase::{Consolidation, Soil, TwoPhaseReference}};
/// let soil = Soil {
///     porosity: 0.4,
///     solid_density: 2.6e3,
///     liquid_density: 1e3,
///     liquid_bulk_modulus: 3e8,
///     permeability: 1e-5,
///     permeability_exponent: 0.0,
///     gravity: 9.81,
/// };
/// let mut layer = Consolidation::new(1.0, 1e7, -1e4, soil)?;
/// layer.advance(5.0)?;
/// let middle = layer.at(0.5);
/// assert!((middle.effective_stress + middle.pore_pressure + 1e4).abs() < 1e-10);
/// # Ok::<(), ReferenceError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Consolidation {
    height: f64,
    modulus: f64,
    load: f64,
    soil: Soil,
    origin: f64,
    time: f64,
}

impl Consolidation {
    /// A layer of `height`, m, and constrained `modulus`, Pa, under `load`, Pa (negative in compression),
    /// with its base at 0.
    ///
    /// # Errors
    /// Where a parameter is not finite, or height or modulus not positive, or the soil makes no sense.
    pub fn new(height: f64, modulus: f64, load: f64, soil: Soil) -> Result<Self, ReferenceError> {
        Ok(Self {
            height: check::positive("height", height)?,
            modulus: check::positive("modulus", modulus)?,
            load: check::finite("load", load)?,
            soil: soil.check()?,
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

    /// $c_v$, m2/s.
    pub fn coefficient(&self) -> f64 {
        self.soil.consolidation_coefficient(self.modulus)
    }
}

impl TwoPhaseReference for Consolidation {
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
        let flux = load * diffusivity / height * layer.gradient;
        TwoPhaseState {
            solid_displacement: load * height / modulus * layer.drained_below,
            solid_velocity: flux / modulus,
            liquid_velocity: -flux
                * (1.0 / soil.liquid_bulk_modulus + soil.solid_fraction() / (soil.porosity * modulus)),
            effective_stress: load * layer.drained,
            pore_pressure: load * layer.remaining,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::soil::tests::report_soil;
    use super::super::testing::{assert_close, derivative};
    use super::*;

    /// Displaced and of another height, so that no factor is 1 by accident; tau from 0.02 to 0.6.
    const TIMES: [f64; 3] = [0.5, 5.0, 15.0];

    /// With a liquid soft enough for its storage to matter: n/K_w is 0.4 of 1/E.
    fn soil() -> Soil {
        report_soil(1e-4, 1e7)
    }

    fn layer(time: f64) -> Consolidation {
        let layer = Consolidation::new(1.6, 1e7, -1e4, soil());
        let mut layer = layer.and_then(|layer| layer.with_origin(-0.3)).unwrap();
        layer.advance(time).unwrap();
        layer
    }

    #[test]
    fn satisfies_its_equations() {
        let soil = soil();
        let (dx, n) = (4e-3, soil.porosity);
        for time in TIMES {
            let dt = 2e-3 * time;
            for x in [-0.2, 0.4, 1.1] {
                let state = layer(time).at(x);
                let along = |f: fn(TwoPhaseState) -> f64| derivative(|x| f(layer(time).at(x)), x, dx);
                let rate = |f: fn(TwoPhaseState) -> f64| derivative(|t| f(layer(t).at(x)), time, dt);
                let (speed, pressure) = (1e-3, 1e4);

                assert_close(rate(|s| s.solid_displacement), state.solid_velocity, 1e-9 * speed);
                assert_close(
                    1e7 * along(|s| s.solid_displacement),
                    state.effective_stress,
                    1e-8 * pressure,
                );
                assert_close(
                    state.effective_stress + state.pore_pressure,
                    -1e4,
                    1e-12 * pressure,
                );

                let darcy = soil.permeability / soil.unit_weight() * along(|s| s.pore_pressure);
                assert_close(
                    n * (state.liquid_velocity - state.solid_velocity),
                    darcy,
                    1e-8 * speed,
                );

                let inflow = 0.6 * along(|s| s.solid_velocity) + n * along(|s| s.liquid_velocity);
                let stored = n / soil.liquid_bulk_modulus * rate(|s| s.pore_pressure);
                assert_close(inflow, stored, 1e-8 * speed);
            }
        }
    }

    /// Expected values from a 30-digit evaluation of the series: u_s, v_s, v_w, sigma', p; report's table 6
    /// with another permeability, at tau = 0.050, 1.01 and 0.0010.
    #[test]
    #[rustfmt::skip]
    fn reproduces_reference_digits() {
        let cases = [
            (1e-4, 0.5, 0.8, [-0.000_101_773_326_336_723_29, -0.000_207_436_247_689_982_97,
                0.000_318_068_913_124_640_53, -5_283.147_453_120_66, -4_716.852_546_879_34]),
            (1e-3, 1.0, 0.7, [-0.000_639_645_324_566_832_8, -0.000_149_806_044_408_555_28,
                0.000_229_702_601_426_451_42, -9_516.944_893_709_066, -483.055_106_290_934_36]),
            (1e-3, 1e-3, 0.99, [-2.667_432_564_657_043_5e-5, -0.017_455_058_515_240_71,
                0.026_764_423_056_702_42, -8_235.791_383_910_982, -1_764.208_616_089_017_6]),
        ];
        for (permeability, time, x, expected) in cases {
            let mut layer = Consolidation::new(1.0, 1e7, -1e4, report_soil(permeability, 3e8)).unwrap();
            layer.advance(time).unwrap();
            let s = layer.at(x);
            let actual = [s.solid_displacement, s.solid_velocity, s.liquid_velocity, s.effective_stress,
                s.pore_pressure];
            for (a, e) in actual.iter().zip(expected) {
                assert!((a / e - 1.0).abs() < 1e-13, "{a} against {e}");
            }
        }
    }

    #[test]
    fn starts_undrained_and_ends_drained() {
        let start = layer(0.0).at(0.9);
        assert_eq!(
            start,
            TwoPhaseState {
                pore_pressure: -1e4,
                ..TwoPhaseState::default()
            }
        );
        let end = layer(1e4).at(1.3);
        assert_close(end.solid_displacement, -1e-3 * 1.6, 1e-16);
        assert_eq!(end.effective_stress, -1e4);
        let base = layer(2.0).at(-0.3);
        assert_eq!(
            (base.solid_displacement, base.solid_velocity, base.liquid_velocity),
            (0.0, 0.0, 0.0)
        );
        assert!(layer(2.0).at(1.3).pore_pressure.abs() < 1e-11);
    }

    #[test]
    fn refuses_bad_parameters_and_times() {
        let soil = soil();
        assert!(Consolidation::new(0.0, 1e7, -1e4, soil).is_err());
        assert!(Consolidation::new(1.0, -1e7, -1e4, soil).is_err());
        assert!(Consolidation::new(1.0, 1e7, f64::NAN, soil).is_err());
        assert!(
            Consolidation::new(
                1.0,
                1e7,
                -1e4,
                Soil {
                    porosity: 1.5,
                    ..soil
                }
            )
            .is_err()
        );
        assert!(layer(0.0).advance(-1.0).is_err());
        assert!(layer(0.0).with_origin(f64::NAN).is_err());
    }
}
