//! The error that an entropy solution says it has.

use super::super::{Hyperelastic, Reference, ReferenceError};
use super::EntropyBar;

/// How far an entropy solution and that on half the cells differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EntropyEstimate {
    /// Integral of the difference of the stresses over that of the stress. The mean, not the mean square: a
    /// shock that is a cell too wide has a difference of the order of the cell in the one and of its root in
    /// the other.
    pub stress: f64,
    /// Difference of the energies, each over its initial one.
    pub energy: f64,
}

impl<L: Hyperelastic + Clone> EntropyBar<L> {
    /// Estimates the errors at `time`, s, by comparing with half the cells. Advances to `time`.
    ///
    /// The numbers are about the *coarser* solution: the error of this one is smaller, four times where
    /// nothing has broken, about twice after that. The stress's is 0 while there is none.
    ///
    /// # Errors
    /// As [`advance`](Reference::advance), of either solution, and where there are fewer than four cells.
    pub fn error_estimate(&mut self, time: f64) -> Result<EntropyEstimate, ReferenceError> {
        self.advance(time)?;
        let mut coarse = match self.coarse.take() {
            Some(coarse) => coarse,
            None => Box::new(Self::new(self.problem.clone(), self.cells() / 2)?),
        };
        coarse.advance(time)?;
        let estimate = EntropyEstimate {
            stress: self.stress_difference(&coarse),
            energy: (self.energy_ratio() - coarse.energy_ratio()).abs(),
        };
        self.coarse = Some(coarse);
        Ok(estimate)
    }

    fn stress_difference(&self, other: &Self) -> f64 {
        let cells = self.cells();
        let (mut difference, mut size) = (0.0, 0.0);
        for cell in 0..cells {
            let x0 = self.problem.origin + (cell as f64 + 0.5) / cells as f64 * self.problem.length;
            let stress = self.at(x0).stress;
            difference += (stress - other.at(x0).stress).abs();
            size += stress.abs();
        }
        if difference == 0.0 { 0.0 } else { difference / size }
    }
}
