//! The axis-aligned manufactured solution.

use nalgebra::{SMatrix, SVector};
use std::f64::consts::PI;

use super::super::check::{finite, positive};
use super::{FieldReference, FieldState};
use crate::grid::Grid;
use crate::law::Moduli;
use crate::reference::ReferenceError;

/// Standing waves along every axis of a box on rollers, at finite strain (Steffen, Wallstedt, Guilkey, Kirby
/// & Berzins 2008; Wallstedt & Guilkey 2008): a neo-Hookean solid is driven by the body force that makes
///
/// $$u_i = A\sin\frac{\pi X_i}{L_i}\sin\Bigl(\frac{\pi c t}{L_i} + i\pi\Bigr),\qquad c = \sqrt{E/\rho_0}$$
///
/// exact. With $k_i = \pi/L_i$, $F_{ii} = 1 + \partial u_i/\partial X_i$ and $J = \prod F_{ii}$ the balance
/// of momentum asks for
///
/// $$b_i = k_i^2 u_i\Bigl(\frac{\lambda(1-\ln J)/F_{ii}^2 + \mu(1 + 1/F_{ii}^2)}{\rho_0} - c^2\Bigr).$$
#[doc = include_str!("../../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manufactured<const D: usize> {
    origin: SVector<f64, D>,
    length: SVector<f64, D>,
    moduli: Moduli<f64>,
    density: f64,
    amplitude: f64,
    wave_speed: f64,
}

impl<const D: usize> Manufactured<D> {
    /// In the box of `grid`, with the initial `density` (kg/m3) and the `amplitude` (m).
    ///
    /// # Errors
    /// If the density is not positive, or the amplitude not finite or so large that material would turn
    /// inside out (`amplitude pi >= length`).
    pub fn new(
        grid: &Grid<f64, D>,
        moduli: Moduli<f64>,
        density: f64,
        amplitude: f64,
    ) -> Result<Self, ReferenceError> {
        let density = positive("density", density)?;
        let amplitude = finite("amplitude", amplitude)?;
        let length = grid.max() - grid.min();
        if amplitude.abs() * PI >= length.min() {
            return Err(ReferenceError::Folds {
                amplitude,
                largest: length.min() / PI,
            });
        }
        let (lambda, mu) = (moduli.lambda, moduli.mu);
        let youngs_modulus = mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
        Ok(Self {
            origin: *grid.min(),
            length,
            moduli,
            density,
            amplitude,
            wave_speed: (youngs_modulus / density).sqrt(),
        })
    }

    /// Wave number along an axis and the phase of the motion there.
    fn wave(&self, axis: usize, time: f64) -> (f64, f64) {
        let k = PI / self.length[axis];
        // Neighbouring axes swing against each other.
        let start = if axis.is_multiple_of(2) { 0.0 } else { PI };
        (k, k * self.wave_speed * time + start)
    }

    /// Displacements and stretches along the axes.
    fn motion(&self, x0: &SVector<f64, D>, time: f64) -> (SVector<f64, D>, SVector<f64, D>) {
        let s = x0 - self.origin;
        let displacement = SVector::from_fn(|i, _| {
            let (k, phase) = self.wave(i, time);
            self.amplitude * (k * s[i]).sin() * phase.sin()
        });
        let stretch = SVector::from_fn(|i, _| {
            let (k, phase) = self.wave(i, time);
            1.0 + self.amplitude * k * (k * s[i]).cos() * phase.sin()
        });
        (displacement, stretch)
    }
}

impl<const D: usize> FieldReference<D> for Manufactured<D> {
    fn at(&self, x0: &SVector<f64, D>, time: f64) -> FieldState<D> {
        let s = x0 - self.origin;
        let (displacement, stretch) = self.motion(x0, time);
        let velocity = SVector::from_fn(|i, _| {
            let (k, phase) = self.wave(i, time);
            self.amplitude * (k * s[i]).sin() * k * self.wave_speed * phase.cos()
        });
        let Moduli { lambda, mu } = self.moduli;
        let j = stretch.product();
        let stress = stretch.map(|f| (lambda * j.ln() + mu * (f * f - 1.0)) / j);
        FieldState {
            displacement,
            velocity,
            stress: SMatrix::from_diagonal(&stress),
        }
    }

    fn body_force(&self, x0: &SVector<f64, D>, time: f64) -> SVector<f64, D> {
        let (displacement, stretch) = self.motion(x0, time);
        let Moduli { lambda, mu } = self.moduli;
        let log = stretch.product().ln();
        SVector::from_fn(|i, _| {
            let k = PI / self.length[i];
            let squared = stretch[i] * stretch[i];
            let stiffness = lambda * (1.0 - log) / squared + mu * (1.0 + 1.0 / squared);
            k * k * displacement[i] * (stiffness / self.density - self.wave_speed.powi(2))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::vector;

    fn solution() -> Manufactured<3> {
        let grid = Grid::new(vector![-1.0, 0.0, 2.0], vector![1.0, 1.0, 3.5], [1, 1, 1]).unwrap();
        let moduli = Moduli::from_young(1e4, 0.3).unwrap();
        Manufactured::new(&grid, moduli, 2.0, 0.07).unwrap()
    }

    /// First Piola-Kirchhoff stress from Cauchy's, `J sigma F^-T` with a diagonal F.
    fn nominal(solution: &Manufactured<3>, x: &SVector<f64, 3>, time: f64) -> SVector<f64, 3> {
        let (_, stretch) = solution.motion(x, time);
        let stress = solution.at(x, time).stress;
        SVector::from_fn(|i, _| stretch.product() * stress[(i, i)] / stretch[i])
    }

    /// rho0 u_tt = Div P + rho0 b, by central differences of what the solution itself returns.
    #[test]
    fn momentum_is_balanced() {
        let (solution, time, step) = (solution(), 0.013, 1e-5);
        for x in [vector![-0.4, 0.3, 2.2], vector![0.9, 0.8, 3.0]] {
            let velocity = |time| solution.at(&x, time).velocity;
            let acceleration = (velocity(time + step) - velocity(time - step)) / (2.0 * step);
            let divergence = SVector::<f64, 3>::from_fn(|i, _| {
                let shift = SVector::from_fn(|a, _| if a == i { step } else { 0.0 });
                let ahead = nominal(&solution, &(x + shift), time)[i];
                (ahead - nominal(&solution, &(x - shift), time)[i]) / (2.0 * step)
            });
            let right = divergence / 2.0 + solution.body_force(&x, time);
            assert!((acceleration - right).norm() < 1e-6 * acceleration.norm());
        }
    }

    #[test]
    fn velocity_is_the_rate_of_the_displacement_and_rollers_hold() {
        let (solution, time, step) = (solution(), 0.02, 1e-6);
        let x = vector![0.2, 0.7, 2.6];
        let u = |time| solution.at(&x, time).displacement;
        let rate = (u(time + step) - u(time - step)) / (2.0 * step);
        assert!((rate - solution.at(&x, time).velocity).norm() < 1e-7 * rate.norm());
        let wall = solution.at(&vector![-1.0, 0.7, 3.5], time).displacement;
        assert!(wall[0].abs() < 1e-16 && wall[1] != 0.0 && wall[2].abs() < 1e-15);
    }

    #[test]
    fn a_wave_that_would_fold_is_refused() {
        let grid = Grid::new(vector![0.0, 0.0], vector![1.0, 1.0], [1, 1]).unwrap();
        let moduli = Moduli::from_young(1.0, 0.0).unwrap();
        let error = Manufactured::new(&grid, moduli, 1.0, 0.4).unwrap_err();
        assert!(matches!(error, ReferenceError::Folds { .. }));
    }
}
