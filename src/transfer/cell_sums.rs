//! Sums at the DOFs of one cell for a basis that is no product, kept at hand while particles of that cell
//! come one after the other.
//!
//! Adding every particle's part to the DOFs themselves would make each particle wait for the one before: they
//! mostly share DOFs, and an addition in memory takes twice as long as one in a register.

use nalgebra::SVector;

use super::p2g::Parts;
use super::places::DofPlaces;
use super::sums::Sum;
use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::particles::DomainViews;
use crate::scalar::Scalar;

/// DOFs that are kept at hand, enough for the cubic B-splines of a cell in three dimensions; any more are
/// added directly.
const AT_HAND: usize = 64;

/// A cell, and a point of it.
type Place<'a, T, const D: usize> = (&'a Cell<D>, &'a SVector<T, D>);

/// Sums of the DOFs of a cell, in the order in which the basis visits them: the same one for every point of
/// the cell.
pub(super) struct StencilSums<'a, T, const D: usize, B, const S: usize, const C: usize, const G: usize> {
    basis: &'a B,
    grid: &'a Grid<T, D>,
    cell: Option<Place<'a, T, D>>,
    sums: [Sum<T, D, S, C, G>; AT_HAND],
}

impl<'a, T: Scalar, const D: usize, B: BasisFamily<T, D>, const S: usize, const C: usize, const G: usize>
    StencilSums<'a, T, D, B, S, C, G>
{
    #[inline(always)]
    pub(super) fn new(basis: &'a B, grid: &'a Grid<T, D>) -> Self {
        Self {
            basis,
            grid,
            cell: None,
            sums: [Sum::zero(); AT_HAND],
        }
    }

    /// Adds `parts`, tensors by coordinates, at every DOF that particle `p` of these domains sees from its
    /// place; with `places` of the DOFs tensors go with moments. `sink(dof, sum)` takes the sums of the cell
    /// before.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        (p, place): (usize, Place<'a, T, D>),
        domains: &DomainViews<'_, T, D>,
        parts: &Parts<T, D, S, C, G>,
        places: Option<&DofPlaces<T, D>>,
        sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>),
    ) {
        if self.cell.is_none_or(|(last, _)| last != place.0) {
            self.flush(sink);
            self.cell = Some(place);
        }
        let mut k = 0;
        let sums = &mut self.sums;
        domains.for_each((self.basis, self.grid), p, place, |dof, phi, mut gradient| {
            if let Some(places) = places {
                gradient = places.offset(self.grid, dof, place) * phi;
            }
            match sums.get_mut(k) {
                Some(sum) => sum.add(parts, phi, &gradient),
                None => {
                    let mut sum = Sum::zero();
                    sum.add(parts, phi, &gradient);
                    sink(dof, sum);
                }
            }
            k += 1;
        });
    }

    /// Hands the sums over and starts again.
    #[inline(always)]
    pub(super) fn flush(&mut self, sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>)) {
        let Some((cell, x)) = self.cell.take() else {
            return;
        };
        let mut k = 0;
        let sums = &mut self.sums;
        self.basis.for_each(self.grid, cell, x, |dof, _, _| {
            if let Some(sum) = sums.get_mut(k) {
                sink(dof, *sum);
                *sum = Sum::zero();
            }
            k += 1;
        });
    }
}

impl<T: Scalar, const D: usize, const S: usize, const C: usize, const G: usize> Sum<T, D, S, C, G> {
    /// Nothing.
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        Self {
            scalars: [T::zero(); S],
            vectors: [SVector::zeros(); C],
            forces: [SVector::zeros(); G],
        }
    }

    /// What a point with these parts adds to a DOF.
    #[inline(always)]
    pub(crate) fn of(parts: &Parts<T, D, S, C, G>, phi: T, gradient: &SVector<T, D>) -> Self {
        let mut sum = Self::zero();
        sum.add(parts, phi, gradient);
        sum
    }

    /// Adds what a point with these parts adds to a DOF.
    #[inline(always)]
    fn add(&mut self, parts: &Parts<T, D, S, C, G>, phi: T, gradient: &SVector<T, D>) {
        for q in 0..S {
            self.scalars[q] += parts.scalars[q] * phi;
        }
        for c in 0..D {
            for q in 0..C {
                self.vectors[q][c] += parts.vectors[q][c] * phi;
            }
            for q in 0..G {
                for a in 0..D {
                    self.forces[q][c] += parts.tensors[q][c][a] * gradient[a];
                }
            }
        }
    }
}
