//! Sums at the DOFs of one cell, point by point, kept at hand while particles of that cell come one after the
//! other.
//!
//! Adding every particle's part to the DOFs themselves would make each particle wait for the one before: they
//! mostly share DOFs, and an addition in memory takes twice as long as one in a register.

use nalgebra::SVector;

use super::p2g::Parts;
use super::places::DofPlaces;
use super::stencil::{Look, Seer, Stencil};
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
pub(super) struct StencilSums<'a, T, const D: usize, const S: usize, const C: usize, const G: usize> {
    cell: Option<&'a Cell<D>>,
    count: usize,
    dofs: [usize; AT_HAND],
    sums: [Sum<T, D, S, C, G>; AT_HAND],
}

impl<'a, T: Scalar, const D: usize, const S: usize, const C: usize, const G: usize>
    StencilSums<'a, T, D, S, C, G>
{
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            cell: None,
            count: 0,
            dofs: [0; AT_HAND],
            sums: [Sum::zero(); AT_HAND],
        }
    }

    /// Adds `parts`, tensors by coordinates, at every DOF that particle `p` of these domains sees from its
    /// place; with `places` of the DOFs tensors go with moments. `sink(dof, sum)` takes the sums of the cell
    /// before.
    #[inline(always)]
    pub(super) fn add<B: BasisFamily<T, D>>(
        &mut self,
        space: (&B, &Grid<T, D>, &mut Stencil<T, D>),
        (p, place): (usize, Place<'a, T, D>),
        domains: &DomainViews<'_, T, D>,
        parts: &Parts<T, D, S, C, G>,
        places: Option<&DofPlaces<T, D>>,
        sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>),
    ) {
        if self.cell.is_none_or(|last| last != place.0) {
            self.flush(sink);
            self.cell = Some(place.0);
        }
        let mut k = 0;
        let (dofs, sums) = (&mut self.dofs, &mut self.sums);
        let x = place.1;
        let (basis, grid, stencil) = space;
        stencil.for_each(
            (basis, grid),
            domains,
            Seer::Particle(p),
            place,
            #[inline(always)]
            |dof, phi, mut gradient| {
                if let Some(places) = places {
                    gradient = places.offset(dof, x) * phi;
                }
                match sums.get_mut(k) {
                    Some(sum) => {
                        dofs[k] = dof;
                        sum.add(parts, phi, &gradient);
                    }
                    None => sink(dof, Sum::of(parts, phi, &gradient)),
                }
                k += 1;
            },
        );
        self.count = k.min(AT_HAND);
    }

    /// Hands the sums over and starts again.
    #[inline(always)]
    pub(super) fn flush(&mut self, sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>)) {
        for k in 0..self.count.min(AT_HAND) {
            sink(self.dofs[k], self.sums[k]);
            self.sums[k] = Sum::zero();
        }
        self.count = 0;
        self.cell = None;
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
