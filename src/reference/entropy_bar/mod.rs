//! Converged entropy solutions of one-dimensional elastodynamics: shocks included.

mod estimate;
mod face;
mod scheme;
mod slope;
#[cfg(test)]
mod tests;

use std::f64::consts::PI;

use super::{BarProblem, Hyperelastic, Reference, ReferenceError, State, UniaxialLaw, check};
pub use estimate::EntropyEstimate;
use scheme::{Motion, Scheme};

/// Cells of the benchmark. Energy: 2e-7 of the initial one is lost before waves break (at 0.1 s), afterwards
/// too much is, 3e-3 at 1 s and at 2 s, 1e-3 at 5 s, 4e-4 at 10 s. Stress at 0.1 s: 1.2e-6. A second of
/// motion takes a second.
const CELLS: usize = 1000;

/// A converged *entropy* solution of `rho0 u_tt = d sigma/dX + rho0 b(t)`, `sigma = stress(J)`,
/// `J = 1 + du/dX`.
///
/// As a first-order system this is `v_t = sigma_X / rho0 + b`, `J_t = v_X`. Once its waves have broken it has
/// many weak solutions; the one wanted is that whose shocks dissipate energy,
/// `d/dt (rho0 v^2 / 2 + W(J)) <= d/dX (sigma v)`.
///
/// Finite volumes: averages in equal cells, limited slopes, at each face the flux of two waves that run as
/// fast as any wave there (A. Harten, P. D. Lax, B. van Leer, SIAM Review 25, 1983), which holds that
/// inequality without slopes; time by the Runge-Kutta method of order 2 that keeps it (S. Gottlieb, C.-W.
/// Shu, E. Tadmor, SIAM Review 43, 2001). Second order where the solution is smooth, a shock is two or three
/// cells wide. Both waves of this system always run, one to either side, so that no rarefaction needs an
/// entropy fix.
///
/// How good a solution is, [`error_estimate`](EntropyBar::error_estimate) says. Where nothing has broken yet
/// [`LagrangianBar`](super::LagrangianBar) is better by many digits. For a law whose stiffness is not
/// monotonic the speed of a face is a guess from three stretches.
///
/// ```
/// # use materialpoint::reference::{EntropyBar, Hill, Reference, ReferenceError};
/// let mut bar = EntropyBar::vibrating_bar(1.0, 2e3, 0.8, Hill { youngs_modulus: 4e4 })?.with_cells(200)?;
/// bar.advance(2.0)?;
/// let left = bar.energy() / bar.initial_energy();
/// assert!(0.48 < left && left < 0.52);
/// # Ok::<(), ReferenceError>(())
/// ```
#[derive(Clone, Debug)]
pub struct EntropyBar<L> {
    problem: BarProblem<L>,
    scheme: Scheme,
    motion: Motion,
    start: Motion,
    /// The same problem on half the cells, once an estimate was asked for.
    coarse: Option<Box<EntropyBar<L>>>,
}

impl<L: UniaxialLaw> EntropyBar<L> {
    /// The solution of `problem` on this many equal `cells`, at time 0. The work to a given time grows with
    /// their square.
    ///
    /// # Errors
    /// Where a parameter is out of range (`cells` between 2 and 1 000 000), or the initial velocity is not
    /// finite.
    pub fn new(problem: BarProblem<L>, cells: usize) -> Result<Self, ReferenceError> {
        problem.check()?;
        let scheme = Scheme::new(&problem, check::within("number of cells", cells, 2, 1_000_000)?);
        let start = scheme.start(&problem)?;
        Ok(Self {
            problem,
            scheme,
            motion: start.clone(),
            start,
            coarse: None,
        })
    }

    /// The vibrating bar of [`LagrangianBar::vibrating_bar`](super::LagrangianBar::vibrating_bar): both ends
    /// fixed, initial velocity `velocity sin(pi X / length)`; length in m, density in kg/m3, velocity in m/s.
    ///
    /// # Errors
    /// As [`new`](EntropyBar::new).
    pub fn vibrating_bar(length: f64, density: f64, velocity: f64, law: L) -> Result<Self, ReferenceError> {
        check::finite("velocity", velocity)?;
        let problem = BarProblem::new(length, density, law)
            .initial_velocity(move |x| velocity * (PI * x / length).sin());
        Self::new(problem, CELLS)
    }

    /// The same problem on another number of `cells`, at time 0.
    ///
    /// # Errors
    /// As [`new`](EntropyBar::new).
    pub fn with_cells(self, cells: usize) -> Result<Self, ReferenceError> {
        Self::new(self.problem, cells)
    }

    /// The same problem with its left end at `origin`, m, at time 0.
    ///
    /// # Errors
    /// Where `origin` is not finite.
    pub fn with_origin(self, origin: f64) -> Result<Self, ReferenceError> {
        let cells = self.cells();
        Self::new(self.problem.origin(origin), cells)
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.motion.velocity.len()
    }

    /// The next kink of the body force, s, or `time` where that comes first.
    fn next_stop(&self, time: f64) -> f64 {
        let ahead = |kink: &f64| *kink > self.motion.time && *kink < time;
        self.problem.kinks.iter().copied().find(ahead).unwrap_or(time)
    }
}

impl<L: Hyperelastic> EntropyBar<L> {
    /// Kinetic and stored energy at the time of the last `advance`, per cross-section, J/m2: that of the
    /// cells' averages, which is less than that of the solution by a share of the order of the cell's square.
    pub fn energy(&self) -> f64 {
        self.scheme.energy(&self.problem, &self.motion)
    }

    /// The same at time 0, J/m2.
    pub fn initial_energy(&self) -> f64 {
        self.scheme.energy(&self.problem, &self.start)
    }

    /// [`energy`](EntropyBar::energy) over the initial one; 0 where there was none.
    pub fn energy_ratio(&self) -> f64 {
        let initial = self.initial_energy();
        if initial > 0.0 {
            self.energy() / initial
        } else {
            0.0
        }
    }
}

impl<L: UniaxialLaw> Reference for EntropyBar<L> {
    /// Marches from the last time to `time`.
    ///
    /// # Errors
    /// Where `time` is negative or not finite, the body force is not finite, or the material is turned inside
    /// out, loses its stiffness or leaves the finite numbers. The state then is that of the last step that
    /// succeeded.
    fn advance(&mut self, time: f64) -> Result<(), ReferenceError> {
        check::time(time)?;
        if time < self.motion.time {
            self.motion.clone_from(&self.start);
        }
        while self.motion.time < time {
            let stop = self.next_stop(time);
            self.scheme.march(&self.problem, &mut self.motion, stop)?;
        }
        Ok(())
    }

    /// Beyond the ends, the state of the nearer end. Within a shock, which is two or three cells wide, a
    /// state between those on its sides.
    fn at(&self, x0: f64) -> State {
        self.scheme
            .state(&self.problem, &self.motion, x0 - self.problem.origin)
    }
}
