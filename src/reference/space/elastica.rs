//! The elastica.

use super::super::check::positive;
use crate::reference::ReferenceError;

/// Runge-Kutta steps along the beam: the tip is then right to 1e-11 of the length.
const STEPS: usize = 400;
/// Halvings of the interval of the tip's slope.
const HALVINGS: usize = 60;

/// A slender cantilever bent far by a force at its tip across the unbent beam, a force that keeps its
/// direction (Bisshopp & Drucker 1945; Mattiasson 1981), without shear and stretch: with the slope $\theta$
/// over the length $s$ along the beam
///
/// $$EI\,\theta'' = -P\cos\theta,\qquad \theta(0) = 0,\quad \theta'(L) = 0.$$
///
/// Found by shooting from the tip.
#[doc = include_str!("../../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastica {
    /// Slope of the tip, rad, towards the force.
    pub slope: f64,
    /// Displacement of the tip along the force, m.
    pub deflection: f64,
    /// Displacement of the tip towards the clamped end, m.
    pub shortening: f64,
}

impl Elastica {
    /// For a `length` (m), a bending stiffness `E I` (N m2; in plane strain `E/(1 - nu^2) t^3/12`, N m) and a
    /// `force` (N; in plane strain N/m).
    ///
    /// # Errors
    /// If one of them is not positive.
    pub fn new(length: f64, stiffness: f64, force: f64) -> Result<Self, ReferenceError> {
        let length = positive("length", length)?;
        let stiffness = positive("bending stiffness", stiffness)?;
        let load = positive("force", force)? * length * length / stiffness;
        let load = positive("force over bending stiffness", load)?;
        // The steeper the tip, the steeper the other end.
        let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2);
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            if Shot::from_tip(middle, load).slope > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        let slope = (low + high) / 2.0;
        let shot = Shot::from_tip(slope, load);
        Ok(Self {
            slope,
            deflection: shot.across * length,
            shortening: (1.0 - shot.along) * length,
        })
    }
}

/// The other end of a beam of unit length, from its tip on.
#[derive(Clone, Copy)]
struct Shot {
    slope: f64,
    curvature: f64,
    along: f64,
    across: f64,
}

impl Shot {
    fn from_tip(slope: f64, load: f64) -> Self {
        let start = Self {
            slope,
            curvature: 0.0,
            along: 0.0,
            across: 0.0,
        };
        let step = 1.0 / STEPS as f64;
        (0..STEPS).fold(start, |at, _| {
            let first = at.rates(load);
            let second = at.moved(step / 2.0, first).rates(load);
            let third = at.moved(step / 2.0, second).rates(load);
            let fourth = at.moved(step, third).rates(load);
            at.moved(step / 6.0, first)
                .moved(step / 3.0, second)
                .moved(step / 3.0, third)
                .moved(step / 6.0, fourth)
        })
    }

    fn rates(self, load: f64) -> Self {
        let (sin, cos) = self.slope.sin_cos();
        Self {
            slope: self.curvature,
            curvature: -load * cos,
            along: cos,
            across: sin,
        }
    }

    fn moved(self, step: f64, rates: Self) -> Self {
        Self {
            slope: self.slope + step * rates.slope,
            curvature: self.curvature + step * rates.curvature,
            along: self.along + step * rates.along,
            across: self.across + step * rates.across,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mattiasson's table, from elliptic integrals.
    #[test]
    fn the_tip_is_where_elliptic_integrals_have_it() {
        let table = [
            (1.0, 0.46135, 0.30172, 0.05643),
            (2.0, 0.78175, 0.49346, 0.16064),
            (5.0, 1.21537, 0.71379, 0.38763),
            (10.0, 1.43029, 0.81061, 0.55500),
        ];
        for (load, slope, deflection, shortening) in table {
            let found = Elastica::new(2.0, 3.0, load * 3.0 / 4.0).unwrap();
            let close = |a: f64, b: f64| (a - b).abs() < 6e-6;
            assert!(
                close(found.slope, slope)
                    && close(found.deflection, 2.0 * deflection)
                    && (found.shortening - 2.0 * shortening).abs() < 1.1e-5,
                "{load}: {found:?}"
            );
        }
    }

    #[test]
    fn a_small_force_bends_as_in_linear_theory() {
        let found = Elastica::new(1.0, 1.0, 1e-4).unwrap();
        assert!((found.deflection / (1e-4 / 3.0) - 1.0).abs() < 1e-8);
        assert!((found.slope / (1e-4 / 2.0) - 1.0).abs() < 1e-8);
        assert!(Elastica::new(1.0, 1.0, -1.0).is_err() && Elastica::new(0.0, 1.0, 1.0).is_err());
    }
}
