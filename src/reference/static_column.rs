//! The column under its weight, at rest.

use super::check;
use super::{Reference, ReferenceError, State};

/// Which kinematics a closed form belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strain {
    /// The linear law `sigma = E (J - 1)`, see [`Linear`](super::Linear).
    Small,
    /// Hill's law `sigma = E (1 - 1/J)`, see [`Hill`](super::Hill).
    Large,
}

/// A column at rest under a uniform body force, fixed at its base and free at its top: exact, the same at all
/// times.
///
/// Equilibrium of a material point at the height `X` carries the mass above it, whatever the law:
/// `sigma = rho b (H - X)` with the initial density. With `g = rho b / E`,
///
/// * small strain, `u = g X (H - X/2)`;
/// * large strain, `J = 1 / (1 - sigma/E)`, hence `u = ln(1 + g X / (1 - g H)) / g - X`, the integral of
///   `J - 1`.
///
/// Source: the column compaction of doi 10.1002/nme.5956, which gives the stress; the displacement is ours.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticColumn {
    height: f64,
    youngs_modulus: f64,
    /// Initial density times body force, N/m3.
    weight: f64,
    strain: Strain,
    origin: f64,
}

impl StaticColumn {
    /// A column of `height`, m, `density`, kg/m3, and `youngs_modulus`, Pa, under the `body_force`, N/kg,
    /// which is negative where it pulls towards the base; the base is at 0.
    ///
    /// # Errors
    /// Where a parameter is not finite, or height, density or Young's modulus not positive;
    /// [`ReferenceError::NoEquilibrium`] where the column hangs, at large strain, under a weight of `E` or
    /// more.
    pub fn new(
        height: f64,
        density: f64,
        youngs_modulus: f64,
        body_force: f64,
        strain: Strain,
    ) -> Result<Self, ReferenceError> {
        let column = Self {
            height: check::positive("height", height)?,
            youngs_modulus: check::positive("Young's modulus", youngs_modulus)?,
            weight: check::positive("density", density)? * check::finite("body force", body_force)?,
            strain,
            origin: 0.0,
        };
        column.check_equilibrium()?;
        Ok(column)
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

    fn check_equilibrium(&self) -> Result<(), ReferenceError> {
        let stress = check::finite("stress at the base", self.weight * self.height)?;
        if self.strain == Strain::Large && stress >= self.youngs_modulus {
            return Err(ReferenceError::NoEquilibrium {
                stress,
                youngs_modulus: self.youngs_modulus,
            });
        }
        Ok(())
    }

    /// Displacement, m, at the `height` X above the base.
    fn displacement(&self, height: f64) -> f64 {
        let gradient = self.weight / self.youngs_modulus;
        match self.strain {
            Strain::Small => gradient * height * (self.height - 0.5 * height),
            Strain::Large => {
                // u = X (r(y) - 1 + g H) / (1 - g H) with y = g X / (1 - g H), r(y) = ln(1 + y) / y: the same
                // as ln(1 + y)/g - X without the difference of near equals that a small g makes of that.
                let base = gradient * self.height;
                let y = gradient * height / (1.0 - base);
                height * (log_ratio_minus_one(y) + base) / (1.0 - base)
            }
        }
    }
}

/// `ln(1 + y) / y - 1`, without cancellation at small `y`.
fn log_ratio_minus_one(y: f64) -> f64 {
    if y.abs() > 0.05 {
        return y.ln_1p() / y - 1.0;
    }
    // Terms (-y)^k / (k + 1), from k = 1; 0.05^12 / 13 is below the rounding of the first.
    (1..=12)
        .rev()
        .fold(0.0, |sum, k| -y * (1.0 / f64::from(k + 1) + sum))
}

impl Reference for StaticColumn {
    fn advance(&mut self, time: f64) -> Result<(), ReferenceError> {
        check::time(time).map(|_| ())
    }

    /// Outside the column the formulas simply continue.
    fn at(&self, x0: f64) -> State {
        let height = x0 - self.origin;
        State {
            displacement: self.displacement(height),
            velocity: 0.0,
            stress: self.weight * (self.height - height),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Hill, Linear, UniaxialLaw};
    use super::*;

    fn benchmark(strain: Strain) -> StaticColumn {
        StaticColumn::new(50.0, 1.0, 1e6, -200.0, strain).unwrap()
    }

    /// Integral of `f` from 0 to `end` by Simpson's rule.
    fn integral(f: impl Fn(f64) -> f64, end: f64) -> f64 {
        let intervals = 2000;
        let step = end / f64::from(intervals);
        let sum: f64 = (0..=intervals)
            .map(|i| {
                f(f64::from(i) * step)
                    * if i == 0 || i == intervals {
                        1.0
                    } else {
                        f64::from(2 + 2 * (i % 2))
                    }
            })
            .sum();
        sum * step / 3.0
    }

    /// Stretch that carries `stress` under Hill's law, by bisection: the closed inverse is what is tested.
    fn stretch_of(law: &impl UniaxialLaw, stress: f64) -> f64 {
        let (mut low, mut high) = (1e-3, 1e3);
        for _ in 0..200 {
            let middle: f64 = 0.5 * (low + high);
            if law.stress(middle) < stress {
                low = middle
            } else {
                high = middle
            }
        }
        0.5 * (low + high)
    }

    fn assert_matches_quadrature(column: &StaticColumn, law: &impl UniaxialLaw) {
        for part in [0.1, 0.5, 1.0] {
            let end = part * column.height;
            let numerical = integral(|x| stretch_of(law, column.at(x).stress) - 1.0, end);
            let closed = column.at(end).displacement;
            assert!(
                (closed / numerical - 1.0).abs() < 1e-9,
                "{closed} against {numerical} at {end}"
            );
        }
    }

    #[test]
    fn displacement_is_the_integral_of_the_strain() {
        assert_matches_quadrature(&benchmark(Strain::Large), &Hill { youngs_modulus: 1e6 });
        assert_matches_quadrature(&benchmark(Strain::Small), &Linear { youngs_modulus: 1e6 });
        // Strains of 0.75 in compression and 4 in tension leave the range of the series.
        for body_force in [-6e4, 1.6e4] {
            let column = StaticColumn::new(50.0, 1.0, 1e6, body_force, Strain::Large).unwrap();
            assert_matches_quadrature(&column, &Hill { youngs_modulus: 1e6 });
        }
    }

    #[test]
    fn stress_balances_the_weight() {
        let column = benchmark(Strain::Large).with_origin(3.0).unwrap();
        assert_eq!(column.at(3.0).stress, -1e4);
        assert_eq!(column.at(53.0).stress, 0.0);
        assert_eq!(column.at(28.0).stress, -5e3);
        assert_eq!(column.at(3.0).displacement, 0.0);
        assert_eq!(column.at(28.0).velocity, 0.0);
    }

    /// Small strain settles by |g| H^2 / 2 = 0.25 m. Large strain settles by the integral of s / (1 - s),
    /// expanded:
    /// |g| H^2 / 2 - |g|^2 H^3 / 3 + |g|^3 H^4 / 4 - ... The 0.249 m of the benchmark is that of the column in motion.
    #[test]
    fn top_settles_by_the_expansion_of_the_integral() {
        let small = benchmark(Strain::Small).at(50.0).displacement;
        assert!((small + 0.25).abs() < 1e-15, "{small}");
        let (gradient, height) = (2e-4_f64, 50.0_f64);
        let terms = (2..12).map(|k| (-gradient).powi(k - 1) * height.powi(k) / f64::from(k));
        let expansion: f64 = terms.sum();
        let large = benchmark(Strain::Large).at(50.0).displacement;
        assert!((large - expansion).abs() < 1e-15, "{large} against {expansion}");
        assert!((large + 0.248_35).abs() < 5e-6, "{large}");
    }

    /// The first correction to small strain is -g^2 ((H^3 - (H - X)^3) / 3); at a load of 1e-9 E a formula
    /// that cancels would be off by 1e-7.
    #[test]
    fn large_strain_tends_to_small_without_cancellation() {
        let column = |strain| {
            StaticColumn::new(50.0, 1.0, 1e6, -2e-5, strain)
                .unwrap()
                .at(50.0)
                .displacement
        };
        let difference = column(Strain::Large) / column(Strain::Small) - 1.0;
        let expected = -1e-9 * 2.0 / 3.0;
        assert!((difference - expected).abs() < 1e-14, "{difference}");
        let weightless = StaticColumn::new(50.0, 1.0, 1e6, 0.0, Strain::Large).unwrap();
        assert_eq!(weightless.at(50.0).displacement, 0.0);
    }

    /// At the ends of the series' range, and beyond it, where the series would be off by 1e-9.
    #[test]
    fn series_and_logarithm_meet() {
        for y in [-0.19, -0.05, 0.05, 0.19] {
            let series = log_ratio_minus_one(y);
            let logarithm = f64::ln_1p(y) / y - 1.0;
            assert!((series / logarithm - 1.0).abs() < 1e-13, "{series} {logarithm}");
        }
    }

    #[test]
    fn refuses_more_tension_than_the_law_bears() {
        let hanging = |strain| StaticColumn::new(50.0, 1.0, 1e6, 2e4, strain);
        assert_eq!(
            hanging(Strain::Large),
            Err(ReferenceError::NoEquilibrium {
                stress: 1e6,
                youngs_modulus: 1e6
            })
        );
        assert!(hanging(Strain::Small).is_ok());
        assert!(StaticColumn::new(-1.0, 1.0, 1e6, -200.0, Strain::Small).is_err());
        assert!(StaticColumn::new(50.0, 1.0, 1e6, f64::NAN, Strain::Small).is_err());
        assert!(benchmark(Strain::Large).advance(f64::NAN).is_err());
    }
}
