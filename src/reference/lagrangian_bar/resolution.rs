//! How finely a bar or a column is resolved.

use super::super::{ReferenceError, check};

/// The largest polynomial degree: beyond it the nodes crowd at the ends and the step shrinks without gain.
pub(in crate::reference) const HIGHEST_DEGREE: usize = 32;

/// Elements of a [`LagrangianBar`](super::LagrangianBar) or a
/// [`LagrangianSoil`](crate::reference::two_phase::LagrangianSoil) and the polynomial degree on each.
///
/// The work to a given time grows with the square of the elements and the fourth power of the degree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resolution {
    /// Number of equal elements, 1 to 1 000 000; an error estimate needs at least 2.
    pub elements: usize,
    /// Polynomial degree, 1 to 32.
    pub degree: usize,
}

impl Resolution {
    /// Refuses what is out of range.
    pub(in crate::reference) fn check(self) -> Result<Self, ReferenceError> {
        check::within("number of elements", self.elements, 1, 1_000_000)?;
        check::within("degree", self.degree, 1, HIGHEST_DEGREE)?;
        Ok(self)
    }

    /// The resolution that an error is estimated against. An odd number of elements is rounded down.
    pub(in crate::reference) fn halved(self) -> Self {
        Self {
            elements: self.elements / 2,
            ..self
        }
    }
}
