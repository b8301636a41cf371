//! Where particles are, and over which domains: all that a basis is asked with at them.

use nalgebra::{SMatrix, SVector};

use crate::basis::{BasisFamily, Domain};
use crate::grid::{Cell, Grid};
use crate::parallel::Sliced;
use crate::particles::{DomainViews, Particles};
use crate::scalar::Scalar;

impl<T: Scalar, const D: usize> DomainViews<'_, T, D> {
    /// Calls `f(dof, phi, grad phi)` for the DOFs that particle `p`, at `x` of `cell`, sees.
    #[inline(always)]
    pub(crate) fn for_each<B: BasisFamily<T, D>>(
        &self,
        (basis, grid): (&B, &Grid<T, D>),
        p: usize,
        (cell, x): (&Cell<D>, &SVector<T, D>),
        f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        // No `match`, of which all branches would be compiled for every basis.
        if const { matches!(B::DOMAIN, Domain::Point) } {
            basis.for_each(grid, cell, x, f);
        } else if const { matches!(B::DOMAIN, Domain::Edges) } {
            basis.for_each_over(grid, cell, x, &self.half_edges[p], f);
        } else {
            let domain = SMatrix::from_diagonal(&self.half_lengths[p]);
            basis.for_each_over(grid, cell, x, &domain, f);
        }
    }
}

/// Where particles that follow each other are: all that a basis is asked with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sites<'a, T, const D: usize> {
    pub(crate) positions: &'a [SVector<T, D>],
    pub(crate) cells: &'a [Cell<D>],
    pub(crate) domains: DomainViews<'a, T, D>,
}

impl<T: Scalar, const D: usize> Sites<'_, T, D> {
    /// Calls `f(dof, phi, grad phi)` for the DOFs that particle `p` sees.
    #[inline(always)]
    pub(crate) fn for_each<B: BasisFamily<T, D>>(
        &self,
        basis: &B,
        grid: &Grid<T, D>,
        p: usize,
        f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        let place = (&self.cells[p], &self.positions[p]);
        self.domains.for_each((basis, grid), p, place, f);
    }
}

impl<T: Scalar, const D: usize, S, P> Particles<T, D, S, P> {
    /// Where they are, in these cells.
    pub(crate) fn sites<'a>(&'a self, cells: &'a [Cell<D>]) -> Sites<'a, T, D> {
        Sites {
            positions: &self.position,
            cells,
            domains: self.domains.views(),
        }
    }
}

impl<T: Sync, const D: usize> Sliced for Sites<'_, T, D> {
    fn items(&self) -> usize {
        self.positions.len()
    }

    fn split(self, spans: usize, items: usize) -> (Self, Self) {
        let (positions, later_positions) = Sliced::split(self.positions, spans, items);
        let (cells, later_cells) = Sliced::split(self.cells, spans, items);
        let (domains, later_domains) = Sliced::split(self.domains, spans, items);
        let first = Self {
            positions,
            cells,
            domains,
        };
        let rest = Self {
            positions: later_positions,
            cells: later_cells,
            domains: later_domains,
        };
        (first, rest)
    }
}
