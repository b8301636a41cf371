//! What is to be solved.

use std::fmt;
use std::sync::Arc;

use super::super::{ReferenceError, UniaxialLaw, check};

/// A function of position or time that a bar can keep and share with its coarser copy.
pub(in crate::reference) type Function = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// What holds one end of the bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The end does not move.
    Fixed,
    /// The end bears no stress.
    Free,
}

/// A bar or column of one elastic material, undeformed at time 0.
///
/// Begins with both ends fixed, the left one at 0, at rest and without body force; the methods change that.
///
/// ```
/// # use materialpoint::reference::{BarProblem, End, Hill};
/// // Dropped onto its base: all of it falls at 0.2 m/s when the base is stopped.
/// let problem = BarProblem::new(1.0, 2e3, Hill { youngs_modulus: 4e4 })
///     .ends(End::Fixed, End::Free)
///     .initial_velocity(|_| -0.2);
/// ```
#[derive(Clone)]
pub struct BarProblem<L> {
    pub(in crate::reference) length: f64,
    pub(in crate::reference) density: f64,
    pub(in crate::reference) law: L,
    pub(in crate::reference) origin: f64,
    pub(in crate::reference) ends: [End; 2],
    pub(in crate::reference) initial_velocity: Function,
    pub(in crate::reference) body_force: Function,
    /// Times at which the body force is not smooth, s, in rising order.
    pub(in crate::reference) kinks: Vec<f64>,
}

impl<L> BarProblem<L> {
    /// A bar of `length`, m, initial `density`, kg/m3, and `law`.
    pub fn new(length: f64, density: f64, law: L) -> Self {
        Self {
            length,
            density,
            law,
            origin: 0.0,
            ends: [End::Fixed; 2],
            initial_velocity: Arc::new(|_| 0.0),
            body_force: Arc::new(|_| 0.0),
            kinks: Vec::new(),
        }
    }

    /// Puts the left end at `x`, m; default 0.
    pub fn origin(self, x: f64) -> Self {
        Self { origin: x, ..self }
    }

    /// Holds the ends; default both fixed.
    pub fn ends(self, left: End, right: End) -> Self {
        Self {
            ends: [left, right],
            ..self
        }
    }

    /// Gives the initial velocity, m/s, as a function of the distance from the left end, m; default 0.
    ///
    /// A fixed end does not move, whatever the function says there: a function that is not zero at a fixed
    /// end starts the motion with a jump.
    pub fn initial_velocity(self, velocity: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Self {
        Self {
            initial_velocity: Arc::new(velocity),
            ..self
        }
    }

    /// Gives the body force, N/kg, as a continuous function of time, s, and the times, s, at which it is not
    /// smooth; default 0. The march makes each of those times the end of a step and so keeps its order.
    pub fn body_force(self, force: impl Fn(f64) -> f64 + Send + Sync + 'static, kinks: &[f64]) -> Self {
        let mut kinks = kinks.to_vec();
        kinks.sort_by(f64::total_cmp);
        Self {
            body_force: Arc::new(force),
            kinks,
            ..self
        }
    }
}

impl<L: UniaxialLaw> BarProblem<L> {
    /// Refuses what cannot be marched from time 0.
    pub(in crate::reference) fn check(&self) -> Result<(), ReferenceError> {
        check::positive("length", self.length)?;
        check::positive("density", self.density)?;
        check::finite("origin", self.origin)?;
        for &kink in &self.kinks {
            check::time(kink)?;
        }
        Ok(())
    }
}

impl<L: fmt::Debug> fmt::Debug for BarProblem<L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BarProblem")
            .field("length", &self.length)
            .field("density", &self.density)
            .field("law", &self.law)
            .field("origin", &self.origin)
            .field("ends", &self.ends)
            .field("kinks", &self.kinks)
            .finish_non_exhaustive()
    }
}
