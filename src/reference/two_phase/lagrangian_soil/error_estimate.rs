//! The error that a converged solution says it has.

use super::LagrangianSoil;
use crate::reference::two_phase::TwoPhaseReference;
use crate::reference::{ReferenceError, UniaxialLaw};

impl<L: UniaxialLaw + Clone> LagrangianSoil<L> {
    /// Estimates the relative error of the stresses at `time`, s, in the L2 norm over the column, effective
    /// stress and pore pressure together, by comparing with half the elements. Advances to `time`.
    ///
    /// The number is the difference of the two solutions, so it is about the error of the *coarser* one: that
    /// of this one is smaller, by the factor that a doubling gains (at least 16 where the solution is
    /// smooth). It includes the error in time, because the coarser solution takes twice the step. It is 0
    /// while neither has any stress, and infinite where only this one has none.
    ///
    /// # Errors
    /// As [`advance`](TwoPhaseReference::advance), of either solution.
    pub fn error_estimate(&mut self, time: f64) -> Result<f64, ReferenceError> {
        self.advance(time)?;
        let mut coarse = match self.coarse.take() {
            Some(coarse) => coarse,
            None => Box::new(Self::new(self.problem.clone(), self.resolution.halved())?),
        };
        coarse.advance(time)?;
        let origin = self.problem.origin;
        let estimate = self
            .operator
            .difference(&self.problem.law, &self.fields, |x| coarse.at(origin + x));
        self.coarse = Some(coarse);
        Ok(estimate)
    }
}
