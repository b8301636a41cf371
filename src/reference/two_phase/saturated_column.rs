//! The saturated column under its weight, at rest.

use super::super::check;
use super::{ReferenceError, Soil, TwoPhaseReference, TwoPhaseState};

/// A drained column at rest under its weight and a surface load, at small strain: exact, the same at all
/// times.
///
/// The water table lies at the top, at the height $H$ above the fixed base. The liquid carries its own
/// weight, the skeleton that of the grains under buoyancy and the load $q$; with the height $x$ above the
/// base,
///
/// $$p = -\rho_w g (H - x), \quad \sigma' = q - (1-n) (\rho_s - \rho_w) g (H - x), \quad
///     u_s = \frac1E \left(q x - (1-n) (\rho_s - \rho_w) g \left(H - \frac x2\right) x\right).$$
///
/// Own derivation from the equations of the [module](super) at rest.
#[doc = include_str!("../../../docs/formulas.html")]
#[derive(Clone, Debug, PartialEq)]
pub struct SaturatedColumn {
    height: f64,
    modulus: f64,
    load: f64,
    soil: Soil,
    origin: f64,
}

impl SaturatedColumn {
    /// A column of `height`, m, and constrained `modulus`, Pa, under `load`, Pa (negative in compression, 0
    /// for none), with its base at 0.
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
        })
    }

    /// The same column with its base at `origin`, m.
    ///
    /// # Errors
    /// Where `origin` is not finite.
    pub fn with_origin(self, origin: f64) -> Result<Self, ReferenceError> {
        Ok(Self {
            origin: check::finite("origin", origin)?,
            ..self
        })
    }
}

impl TwoPhaseReference for SaturatedColumn {
    fn advance(&mut self, time: f64) -> Result<(), ReferenceError> {
        check::time(time).map(|_| ())
    }

    /// Outside the column the formulas simply continue.
    fn at(&self, x0: f64) -> TwoPhaseState {
        let &Self {
            height,
            modulus,
            load,
            soil,
            origin,
        } = self;
        let x = x0 - origin;
        let liquid = soil.unit_weight();
        let buoyant = soil.solid_fraction() * (soil.solid_density - soil.liquid_density) * soil.gravity;
        TwoPhaseState {
            solid_displacement: (load - buoyant * (height - 0.5 * x)) * x / modulus,
            effective_stress: load - buoyant * (height - x),
            pore_pressure: -liquid * (height - x),
            ..TwoPhaseState::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::soil::tests::report_soil;
    use super::super::testing::{assert_close, derivative};
    use super::*;

    fn column() -> SaturatedColumn {
        let column = SaturatedColumn::new(2.0, 1e7, -3e3, report_soil(1e-5, 3e8)).unwrap();
        column.with_origin(5.0).unwrap()
    }

    #[test]
    fn balances_liquid_and_mixture_and_derives_from_the_strain() {
        for x in [5.3, 6.0, 6.9] {
            let along = |f: fn(TwoPhaseState) -> f64| derivative(|x| f(column().at(x)), x, 1e-2);
            assert_close(along(|s| s.pore_pressure), 1e3 * 9.81, 1e-7);
            assert_close(
                along(|s| s.effective_stress + s.pore_pressure),
                1960.0 * 9.81,
                1e-7,
            );
            assert_close(
                1e7 * along(|s| s.solid_displacement),
                column().at(x).effective_stress,
                1e-6,
            );
        }
    }

    /// By hand: buoyant weight 0.6 * 1600 * 9.81 = 9417.6 N/m3, settlement (3000 * 2 + 9417.6 * 2) / 1e7.
    #[test]
    fn carries_the_load_and_settles() {
        let (top, base) = (column().at(7.0), column().at(5.0));
        assert_eq!(
            (top.effective_stress, top.pore_pressure, base.solid_displacement),
            (-3e3, 0.0, 0.0)
        );
        assert_close(base.effective_stress, -3e3 - 2.0 * 9417.6, 1e-10);
        assert_close(top.solid_displacement, -2.483_52e-3, 1e-17);
        assert_eq!((top.solid_velocity, base.liquid_velocity), (0.0, 0.0));
    }

    #[test]
    fn refuses_bad_parameters_and_times() {
        let soil = report_soil(1e-5, 3e8);
        assert!(SaturatedColumn::new(-1.0, 1e7, 0.0, soil).is_err());
        assert!(SaturatedColumn::new(1.0, 1e7, f64::NAN, soil).is_err());
        assert!(column().advance(-1.0).is_err());
        assert!(column().advance(1.0).is_ok());
    }
}
