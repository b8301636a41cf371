//! The generalized vortex.

use nalgebra::{SMatrix, SVector};
use std::f64::consts::PI;

use super::super::check::{finite, positive};
use super::{FieldReference, FieldState};
use crate::law::Moduli;
use crate::reference::ReferenceError;

/// A ring whose material circles turn by angles of their own and back (Brannon, Kamojjala & Sadeghirad 2011;
/// Kamojjala, Brannon, Sadeghirad & Guilkey 2015): large shear and rotation without change of volume, the
/// circles of the inner and outer radius at rest.
///
/// With the middle radius $R_m$, half the width $w$ and $s = (R - R_m)/w$ every point turns about the centre
/// by
///
/// $$\alpha(R, t) = A\,(1 - s^2)^2\,\sin\frac{\pi t}{T},\qquad x = Q(\alpha)X.$$
///
/// With $\gamma = R\,\partial\alpha/\partial R$ this gives $F = Q(1 + \gamma\,e_\Theta\otimes e_R)$, $J = 1$.
/// In the polar axes of the place now the neo-Hookean stress is $\sigma_{r\theta} = \mu\gamma$,
/// $\sigma_{\theta\theta} = \mu\gamma^2$ and nothing else, free of tractions at both radii (around the ring
/// there may be more of the material, at rest, or nothing), and the balance of momentum asks for
///
/// $$b_r = \frac{\mu\gamma^2}{\rho R} - R\dot\alpha^2,\qquad b_\theta = R\ddot\alpha -
/// \frac{\mu}{\rho}(3\alpha' + R\alpha'').$$
///
/// In space the same happens in every plane across the third axis: a tube, for $\sigma_{zz} = 0$ too.
#[doc = include_str!("../../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vortex<const D: usize> {
    centre: SVector<f64, D>,
    ring: Ring,
    shear_modulus: f64,
    density: f64,
    swing: Swing,
}

/// The ring of a [`Vortex`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Inner radius, m.
    pub inner: f64,
    /// Outer radius, m.
    pub outer: f64,
}

/// How a [`Vortex`] turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Largest angle, rad.
    pub angle: f64,
    /// Time after which the ring is back, s.
    pub time: f64,
}

/// Angle and its derivatives: by the radius, and by time.
struct Turn {
    angle: f64,
    by_radius: [f64; 2],
    by_time: [f64; 2],
}

impl<const D: usize> Vortex<D> {
    const BEYOND_ONE_AXIS: () = assert!(D > 1, "a vortex needs two axes");

    /// About `centre` (m), with the constant `density` (kg/m3).
    ///
    /// # Errors
    /// If a radius, the density, the shear modulus or the time is not positive, the outer radius not larger
    /// than the inner one, or the angle or the centre not finite.
    pub fn new(
        centre: SVector<f64, D>,
        ring: Ring,
        moduli: Moduli<f64>,
        density: f64,
        swing: Swing,
    ) -> Result<Self, ReferenceError> {
        let () = Self::BEYOND_ONE_AXIS;
        for x in centre.iter() {
            finite("centre", *x)?;
        }
        positive("inner radius", ring.inner)?;
        positive("outer radius less the inner one", ring.outer - ring.inner)?;
        finite("angle", swing.angle)?;
        positive("time", swing.time)?;
        Ok(Self {
            centre,
            ring,
            shear_modulus: positive("shear modulus", moduli.mu)?,
            density: positive("density", density)?,
            swing,
        })
    }

    /// Outside of the ring nothing turns.
    fn turn(&self, radius: f64, time: f64) -> Turn {
        let half_width = (self.ring.outer - self.ring.inner) / 2.0;
        let s = ((radius - self.ring.inner) / half_width - 1.0).clamp(-1.0, 1.0);
        let rest = 1.0 - s * s;
        let frequency = PI / self.swing.time;
        let (sin, cos) = (frequency * time).sin_cos();
        let now = self.swing.angle * sin;
        let shape = rest * rest;
        let curvature = if rest > 0.0 { 12.0 * s * s - 4.0 } else { 0.0 };
        Turn {
            angle: now * shape,
            by_radius: [
                -4.0 * now * s * rest / half_width,
                now * curvature / half_width.powi(2),
            ],
            by_time: [
                self.swing.angle * frequency * cos * shape,
                -frequency * frequency * now * shape,
            ],
        }
    }

    /// Radius, and the directions outwards and along the turn of the place that a material point has now.
    fn place(&self, x0: &SVector<f64, D>, time: f64) -> Place<D> {
        let from_centre = x0 - self.centre;
        let (x, y) = (from_centre[0], from_centre[1]);
        let radius = x.hypot(y);
        let turn = self.turn(radius, time);
        let (sin, cos) = turn.angle.sin_cos();
        // At the centre no direction is outwards, and nothing turns.
        let unit = if radius > 0.0 { radius } else { 1.0 };
        let mut outwards = SVector::zeros();
        (outwards[0], outwards[1]) = ((cos * x - sin * y) / unit, (sin * x + cos * y) / unit);
        let mut along = SVector::zeros();
        (along[0], along[1]) = (-outwards[1], outwards[0]);
        Place {
            radius,
            outwards,
            along,
            turn,
        }
    }
}

/// Where a material point is.
struct Place<const D: usize> {
    radius: f64,
    outwards: SVector<f64, D>,
    along: SVector<f64, D>,
    turn: Turn,
}

impl<const D: usize> FieldReference<D> for Vortex<D> {
    fn at(&self, x0: &SVector<f64, D>, time: f64) -> FieldState<D> {
        let Place {
            radius,
            outwards,
            along,
            turn,
        } = self.place(x0, time);
        let from_centre = x0 - self.centre;
        let mut displacement = outwards * radius - from_centre;
        for axis in 2..D {
            displacement[axis] = 0.0;
        }
        let shear = radius * turn.by_radius[0];
        let across: SMatrix<f64, D, D> = outwards * along.transpose();
        let stress = (across + across.transpose() + along * along.transpose() * shear) * shear;
        FieldState {
            displacement,
            velocity: along * (radius * turn.by_time[0]),
            stress: stress * self.shear_modulus,
        }
    }

    fn body_force(&self, x0: &SVector<f64, D>, time: f64) -> SVector<f64, D> {
        let Place {
            radius,
            outwards,
            along,
            turn,
        } = self.place(x0, time);
        let [slope, curvature] = turn.by_radius;
        let [rate, acceleration] = turn.by_time;
        let stiffness = self.shear_modulus / self.density;
        // gamma^2 / R, which is nothing at the centre.
        let tension = radius * slope * slope;
        outwards * (stiffness * tension - radius * rate * rate)
            + along * (radius * acceleration - stiffness * (3.0 * slope + radius * curvature))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::NeoHookean;
    use nalgebra::vector;

    const DENSITY: f64 = 3.0;

    fn moduli() -> Moduli<f64> {
        Moduli::from_young(1e3, 0.3).unwrap()
    }

    fn ring() -> Ring {
        Ring {
            inner: 0.6,
            outer: 1.4,
        }
    }

    fn vortex<const D: usize>(centre: SVector<f64, D>) -> Vortex<D> {
        let swing = Swing {
            angle: 0.7,
            time: 2.0,
        };
        Vortex::new(centre, ring(), moduli(), DENSITY, swing).unwrap()
    }

    fn points() -> [SVector<f64, 3>; 3] {
        [
            vector![1.6, 0.3, 0.2],
            vector![-0.1, -0.7, 1.0],
            vector![0.2, 1.1, 0.0],
        ]
    }

    /// Deformation gradient by central differences.
    fn gradient(vortex: &Vortex<3>, x: &SVector<f64, 3>, time: f64) -> SMatrix<f64, 3, 3> {
        let step = 1e-5;
        let mut f = SMatrix::<f64, 3, 3>::identity();
        for axis in 0..3 {
            let shift = SVector::from_fn(|a, _| if a == axis { step } else { 0.0 });
            let ahead = vortex.at(&(x + shift), time).displacement;
            let behind = vortex.at(&(x - shift), time).displacement;
            let change: SVector<f64, 3> = (ahead - behind) / (2.0 * step);
            let column = f.column(axis) + change;
            f.set_column(axis, &column);
        }
        f
    }

    #[test]
    fn stress_is_the_law_s_of_the_motion_s_gradient() {
        let vortex = vortex(vector![0.4, 0.1, 0.0]);
        let law = NeoHookean { moduli: moduli() };
        for x in points() {
            let f = gradient(&vortex, &x, 0.8);
            assert!((f.determinant() - 1.0).abs() < 1e-8);
            let stress = vortex.at(&x, 0.8).stress;
            assert!(
                (law.stress(&f) - stress).norm() < 1e-6 * stress.norm(),
                "{stress}"
            );
        }
    }

    /// rho u_tt = Div P + rho b with P = J sigma F^-T, all by differences of displacements and stresses.
    #[test]
    fn momentum_is_balanced() {
        let vortex = vortex(vector![0.4, 0.1, 0.0]);
        let (time, step) = (0.8, 1e-4);
        for x in points() {
            let u = |time| vortex.at(&x, time).displacement;
            let acceleration = (u(time + step) - u(time) * 2.0 + u(time - step)) / (step * step);
            let nominal = |x: SVector<f64, 3>| {
                let f = gradient(&vortex, &x, time);
                vortex.at(&x, time).stress * f.try_inverse().unwrap().transpose()
            };
            let mut divergence = SVector::zeros();
            for axis in 0..3 {
                let shift = SVector::from_fn(|a, _| if a == axis { step } else { 0.0 });
                divergence += (nominal(x + shift) - nominal(x - shift)).column(axis) / (2.0 * step);
            }
            let right: SVector<f64, 3> = divergence / DENSITY + vortex.body_force(&x, time);
            let scale = divergence.norm() / DENSITY;
            assert!(
                (acceleration - right).norm() < 1e-5 * scale,
                "{acceleration} {right}"
            );
        }
    }

    #[test]
    fn velocity_is_the_rate_of_the_displacement_and_both_circles_rest() {
        let vortex = vortex(vector![0.0, 0.0]);
        let (x, time, step) = (vector![0.5, 0.9], 0.3, 1e-6);
        let u = |time| vortex.at(&x, time).displacement;
        let rate = (u(time + step) - u(time - step)) / (2.0 * step);
        assert!((rate - vortex.at(&x, time).velocity).norm() < 1e-8 * rate.norm());
        for radius in [0.0, 0.3, 0.6, 1.4, 2.0] {
            let state = vortex.at(&vector![0.0, radius], time);
            assert!(state.displacement.norm() < 1e-15 && state.velocity.norm() < 1e-15);
            assert!(state.stress.norm() < 1e-12);
        }
    }

    #[test]
    fn a_ring_without_width_is_refused() {
        let swing = Swing {
            angle: 1.0,
            time: 1.0,
        };
        let thin = Ring {
            inner: 1.0,
            outer: 1.0,
        };
        let error = Vortex::<2>::new(vector![0.0, 0.0], thin, moduli(), 1.0, swing).unwrap_err();
        assert!(error.to_string().contains("outer radius"), "{error}");
        let never = Swing { time: 0.0, ..swing };
        assert!(Vortex::<2>::new(vector![0.0, 0.0], ring(), moduli(), 1.0, never).is_err());
    }
}
