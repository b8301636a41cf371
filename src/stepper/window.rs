//! The part of a large grid in which the stepper works.
//!
//! Cells and DOFs are numbered, and have a place in memory, in a box around the particles only ([`Window`]),
//! which is laid anew when a particle comes near its border. Numbers grow in the same order in any box, and
//! so do all sums: where the box lies changes no bit but through the spans that threads share, and the
//! preconditioner of a consistent mass matrix.

use super::inner::Inner;
use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid, Window};
use crate::law::LawSweep;
use crate::phase::Phase;
use crate::scalar::Scalar;
use crate::transfer::Transfer;

/// Cells beyond which a window is laid at least.
const MARGIN: usize = 3;
/// One in so many of its cells along an axis are laid beyond a body, so that a window seldom moves.
const PART: usize = 8;

/// Gives the grid a window around the particles' `cells`, or none where that would not spare half of it.
#[inline(never)]
pub(super) fn lay<T: Scalar, const D: usize>(grid: &mut Grid<T, D>, cells: &[Cell<D>]) {
    let around = Window::around(cells).widened(|cells| MARGIN + cells / PART);
    let all = grid.cells();
    let total = all.iter().fold(1.0, |product, &n| product * n as f64);
    let windowed = grid.clone().with_window(around);
    *grid = if 2.0 * windowed.cell_count() as f64 <= total {
        windowed
    } else {
        windowed.with_window(Window::whole(all))
    };
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Lays the window anew around the particles, with DOFs to it.
    #[cold]
    #[inline(never)]
    pub(super) fn follow_particles<B: BasisFamily<T, D>>(&mut self, basis: &B) {
        self.strayed = false;
        lay(&mut self.grid, self.bins.cells());
        self.follow_window(basis);
    }

    /// Takes in that cells and DOFs have other numbers.
    pub(super) fn follow_window<B: BasisFamily<T, D>>(&mut self, basis: &B) {
        self.bins.note_numbering();
        self.order.follow_window(&self.grid);
        self.spans.forget();
        self.allocate_dofs(basis);
    }
}
