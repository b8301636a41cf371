//! Check of a basis family.

mod continuity;
mod derivative;
mod domains;
mod doors;
mod pointwise;
mod sample;
mod span;

use nalgebra::SVector;

use super::failure::{Failure, Place, Property};
use crate::basis::BasisFamily;
use crate::grid::Grid;
use crate::scalar::Scalar;

/// What a basis family claims beyond what the trait demands of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BasisClaims {
    /// Gradients of `for_each` are the derivatives of the values. False where they are smoothed.
    pub gradients_are_derivatives: bool,
    /// The same for `for_each_at_fixed_point`.
    pub fixed_point_gradients_are_derivatives: bool,
    /// Largest degree of which every polynomial of one coordinate is a sum of the values, with *some*
    /// coefficients. (For hats and dual domain the coefficients are the polynomial at the nodes, for
    /// B-splines and a linear field the Greville abscissae.) One degree more must not be reproduced, and
    /// [`BasisFamily::degree`] must say the same.
    pub reproduces: usize,
    /// With the coefficients of a linear field, the gradients of `for_each` sum to its gradient.
    pub gradient_reproduces_linear: bool,
}

impl BasisClaims {
    /// What hats (degree 1) and B-splines claim: true derivatives, and reproduction up to `degree >= 1`.
    pub fn of_degree(degree: usize) -> Self {
        Self {
            gradients_are_derivatives: true,
            fixed_point_gradients_are_derivatives: true,
            reproduces: degree,
            gradient_reproduces_linear: true,
        }
    }
}

/// Checks `basis` on `grid`: at the given `points` the same DOFs in the same order as elsewhere in the cell,
/// partition of unity, non-negative values, gradients that sum to zero, DOF numbers in range, overlap within
/// the half band, values on faces, values at fixed points, and what the fast ways of a step see
/// ([`BasisFamily::factors`], what [`BasisFamily::AT_FIXED_POINTS`] and [`BasisFamily::CONSTANT_GRADIENT`]
/// say); on the edges between cells the same values from both; and from points of its own the `claims`, the
/// `degree`, and that no DOF is out of reach. A basis that asks for domains ([`BasisFamily::DOMAIN`]) is
/// checked over several of them besides, and over one that has vanished it must be what it is at points.
///
/// Choose points on edges and faces too. The cost grows with the square of the number of DOFs: a few cells
/// along each axis are enough, and different numbers of them find more.
///
/// # Errors
/// The first property that does not hold, or holds although it is claimed not to.
pub fn check_basis<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    points: &[SVector<T, D>],
    claims: &BasisClaims,
) -> Result<(), Failure> {
    for x in points {
        pointwise::check(basis, grid, x)?;
    }
    for x in points {
        continuity::check(basis, grid, x)?;
    }
    derivative::check(basis, grid, points, claims)?;
    domains::check(basis, grid, points, claims)?;
    span::check(basis, grid, claims)
}

/// Cell of `x`, or the failure that it has none.
fn cell_of<T: Scalar, const D: usize>(grid: &Grid<T, D>, x: &SVector<T, D>) -> Result<[u32; D], Failure> {
    grid.locate(x).ok_or_else(|| Failure {
        property: Property::PointsInGrid,
        place: Place::point(x),
        expected: super::Expected::AtLeast(1.0),
        found: 0.0,
    })
}
