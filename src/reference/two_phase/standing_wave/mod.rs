//! Damped waves in saturated soil at small strain, exactly.

mod spectrum;
#[cfg(test)]
mod tests;

use std::f64::consts::PI;

use nalgebra::Complex;

use super::super::check;
use super::{ReferenceError, Soil, TwoPhaseReference, TwoPhaseState};
use spectrum::Spectrum;

const MOST_MODES: usize = 1_000_000;

/// A standing wave in a linear elastic saturated column with fixed, impermeable ends, at small strain: exact,
/// with inertia.
///
/// With $\kappa = m \pi / H$, velocities $\propto \sin \kappa x$ and stresses $\propto \cos \kappa x$, the
/// equations of the [module](super) without weight become, for displacements $(u_w, u_s) e^{s t}$,
///
/// $$\left(s^2 \begin{pmatrix} n \rho_w & \\\\ & (1-n) \rho_s \end{pmatrix}
///     + s \frac{n^2 \gamma_w}{k} \begin{pmatrix} 1 & -1 \\\\ -1 & 1 \end{pmatrix}
///     + \kappa^2 \left[ \frac{K_w}{n} \begin{pmatrix} n^2 & n (1-n) \\\\ n (1-n) & (1-n)^2 \end{pmatrix}
///     + \begin{pmatrix} 0 & \\\\ & E \end{pmatrix} \right] \right) \begin{pmatrix} u_w \\\\ u_s
///       \end{pmatrix} = 0.$$
///
/// Measured by the undrained frequency $\omega_0 = \kappa \sqrt{W}$, $W = (E + K_w/n) / \rho$, with the
/// saturated density $\rho = a + b$, $a = n \rho_w$, $b = (1-n) \rho_s$, and $z = s/\omega_0$, the
/// determinant is the quartic
///
/// $$z^4 + \delta z^3 + (1 + \gamma + g) z^2 + \delta z + \gamma, \quad
///     \delta = \frac{n^2 \gamma_w \rho}{k a b \omega_0}, \quad \gamma = \frac{n K_w E}{a b W^2}, \quad
///     g = \frac{(K_w - a W)^2}{a b W^2}.$$
///
/// None of its roots is 0. Their fast pair is a wave of angular frequency $\omega_0$ for $k \to 0$, damped at
/// the rate $g \omega_0 / (2 \delta)$, and one of the two undamped waves of independent phases for $k \to
/// \infty$. The other pair is consolidation and decay of the relative velocity, or the slow wave. Own
/// derivation; the waves are those of M. A. Biot 1956.
///
/// The solution is the real part of the fast eigenvector, times a factor that gives the solid the asked
/// velocity at time 0. Displacements begin with 0 there, stresses with what belongs to the wave.
#[doc = include_str!("../../../../docs/formulas.html")]
#[derive(Clone, Debug, PartialEq)]
pub struct StandingWave {
    wave_number: f64,
    modulus: f64,
    velocity: f64,
    soil: Soil,
    origin: f64,
    time: f64,
}

impl StandingWave {
    /// A column of `height`, m, and constrained `modulus`, Pa, with `mode` half waves and the largest initial
    /// `velocity` of the solid, m/s, with its base at 0.
    ///
    /// # Errors
    /// Where a parameter is not finite, or height or modulus not positive, `mode` not between 1 and 1 000 000
    /// or the soil makes no sense.
    pub fn new(
        height: f64,
        modulus: f64,
        soil: Soil,
        mode: usize,
        velocity: f64,
    ) -> Result<Self, ReferenceError> {
        let mode = check::within("mode", mode, 1, MOST_MODES)? as f64;
        Ok(Self {
            wave_number: mode * PI / check::positive("height", height)?,
            modulus: check::positive("modulus", modulus)?,
            velocity: check::finite("velocity", velocity)?,
            soil: soil.check()?,
            origin: 0.0,
            time: 0.0,
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

    /// The eigenvalues $s$, 1/s: the fast pair, then the other two; of a conjugate pair the one with positive
    /// frequency first, of a real pair the one that decays more slowly.
    pub fn eigenvalues(&self) -> [Complex<f64>; 4] {
        self.spectrum().roots().map(|z| z * self.undrained_frequency())
    }

    /// Angular frequency, rad/s, and damping rate, 1/s, of the fast wave: $s = -\text{rate} \pm
    /// i\,\text{frequency}$.
    pub fn fast_wave(&self) -> (f64, f64) {
        let [fast, ..] = self.eigenvalues();
        (fast.im, -fast.re)
    }

    /// Amplitudes at the time of the last `advance`: the velocities and the displacement are these times
    /// $\sin \kappa x$, the stresses times $\cos \kappa x$.
    pub fn amplitudes(&self) -> TwoPhaseState {
        let rate = self.rate();
        let turn = (rate * self.time).exp() * self.velocity;
        let [liquid, effective, pore] = self.eigenvector();
        TwoPhaseState {
            solid_displacement: (exp_m1(rate * self.time) / rate).re * self.velocity,
            solid_velocity: turn.re,
            liquid_velocity: (liquid * turn).re,
            effective_stress: (effective * turn).re,
            pore_pressure: (pore * turn).re,
        }
    }

    /// $s$ of the wave, 1/s.
    fn rate(&self) -> Complex<f64> {
        let [fast, ..] = self.eigenvalues();
        fast
    }

    /// Velocity of the liquid, effective stress and pore pressure for a velocity of the solid of 1.
    fn eigenvector(&self) -> [Complex<f64>; 3] {
        let Soil {
            porosity,
            liquid_bulk_modulus,
            ..
        } = self.soil;
        let fast = self.spectrum().fast();
        let [z, _] = fast.roots();
        let [liquid_mass, _] = self.masses();
        let inertia = liquid_mass * self.undrained_stiffness();
        let drag = self.drag() * self.undrained_frequency() / self.wave_number.powi(2);

        // z^2 + 1 = -(2 mu z + y), without the cancellation where the wave is almost undamped.
        let force = -(z * (2.0 * fast.damping) + fast.excess) * inertia + self.imbalance();
        let relative = -force / (z * z * inertia + z * drag + liquid_bulk_modulus * porosity);

        let strain = self.wave_number / self.rate();
        let stored = (relative * porosity + 1.0) * self.soil.locked_stiffness();
        [relative + 1.0, strain * self.modulus, strain * stored]
    }

    fn spectrum(&self) -> Spectrum {
        let [liquid, solid] = self.masses();
        let unit = liquid * solid * self.undrained_stiffness().powi(2);
        Spectrum {
            drag: self.drag() * (1.0 / liquid + 1.0 / solid) / self.undrained_frequency(),
            coupling: self.imbalance().powi(2) / unit,
            product: self.soil.porosity * self.soil.liquid_bulk_modulus * self.modulus / unit,
        }
    }

    /// $a$ and $b$, kg/m3.
    fn masses(&self) -> [f64; 2] {
        [
            self.soil.porosity * self.soil.liquid_density,
            self.soil.solid_fraction() * self.soil.solid_density,
        ]
    }

    /// $W$, m2/s2.
    fn undrained_stiffness(&self) -> f64 {
        (self.modulus + self.soil.locked_stiffness()) / self.soil.saturated_density()
    }

    /// $\omega_0$, rad/s.
    fn undrained_frequency(&self) -> f64 {
        self.wave_number * self.undrained_stiffness().sqrt()
    }

    /// $n^2 \gamma_w / k$, kg/(m3 s).
    fn drag(&self) -> f64 {
        self.soil.porosity.powi(2) * self.soil.unit_weight() / self.soil.permeability
    }

    /// $K_w - a W$, Pa, what pushes the liquid through the skeleton when both move together; 0 in a
    /// dynamically compatible soil. Here without its cancellation.
    fn imbalance(&self) -> f64 {
        let Soil {
            liquid_bulk_modulus,
            solid_density,
            liquid_density,
            porosity,
            ..
        } = self.soil;
        let buoyant = self.soil.solid_fraction() * (solid_density - liquid_density);
        (liquid_bulk_modulus * buoyant - porosity * liquid_density * self.modulus)
            / self.soil.saturated_density()
    }
}

impl TwoPhaseReference for StandingWave {
    fn advance(&mut self, time: f64) -> Result<(), ReferenceError> {
        self.time = check::time(time)?;
        Ok(())
    }

    /// Outside the column the formulas simply continue, which no material point of the column can notice.
    fn at(&self, x0: f64) -> TwoPhaseState {
        let (sine, cosine) = (self.wave_number * (x0 - self.origin)).sin_cos();
        let amplitudes = self.amplitudes();
        TwoPhaseState {
            solid_displacement: amplitudes.solid_displacement * sine,
            solid_velocity: amplitudes.solid_velocity * sine,
            liquid_velocity: amplitudes.liquid_velocity * sine,
            effective_stress: amplitudes.effective_stress * cosine,
            pore_pressure: amplitudes.pore_pressure * cosine,
        }
    }
}

/// $e^z - 1$, without cancellation at small $z$.
fn exp_m1(z: Complex<f64>) -> Complex<f64> {
    let half = (0.5 * z.im).sin();
    let real = z.re.exp_m1() * z.im.cos() - 2.0 * half * half;
    Complex::new(real, z.re.exp() * z.im.sin())
}
