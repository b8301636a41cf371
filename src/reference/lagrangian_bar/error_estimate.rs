//! The error that a converged solution says it has.

use super::super::{Reference, ReferenceError, UniaxialLaw};
use super::LagrangianBar;

impl<L: UniaxialLaw + Clone> LagrangianBar<L> {
    /// Estimates the relative error of the stress at `time`, s, in the L2 norm over the bar, by comparing
    /// with half the elements. Advances to `time`.
    ///
    /// The number is the difference of the two solutions, so it is about the error of the *coarser* one: that
    /// of this one is smaller, by the factor that a doubling gains (at least 16 where the solution is
    /// smooth). It includes the error in time, because the coarser solution takes twice the step. It is 0
    /// while both have no stress at all, and infinite where only this one has none.
    ///
    /// # Errors
    /// As [`advance`](Reference::advance), of either solution.
    pub fn error_estimate(&mut self, time: f64) -> Result<f64, ReferenceError> {
        self.advance(time)?;
        let mut coarse = match self.coarse.take() {
            Some(coarse) => coarse,
            None => Box::new(Self::new(self.problem.clone(), self.resolution.halved())?),
        };
        coarse.advance(time)?;
        let estimate = self.stress_difference(&coarse);
        self.coarse = Some(coarse);
        Ok(estimate)
    }

    /// L2 norm of the difference of the stresses, relative to that of this stress.
    fn stress_difference(&self, other: &Self) -> f64 {
        let (mut difference, mut norm) = (0.0, 0.0);
        for (distance, weight) in self.operator.quadrature() {
            let x0 = self.problem.origin + distance;
            let stress = self.at(x0).stress;
            difference += weight * (stress - other.at(x0).stress).powi(2);
            norm += weight * stress * stress;
        }
        if difference == 0.0 {
            0.0
        } else {
            (difference / norm).sqrt()
        }
    }
}
