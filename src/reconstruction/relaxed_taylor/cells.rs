//! The fits of each cell: of its own particles, and with those of its neighbours.

use crate::field::Field;
use crate::reconstruction::taylor::local;
use crate::reconstruction::{Cloud, Filling, Patch};
use crate::scalar::Scalar;
use crate::taylor::{CellFit, Gram};

use super::filling::{FULL, OpenSides, borders_on_nothing, is_full, reach};

/// The fits of one occupied cell.
#[derive(Clone, Debug)]
pub(super) struct RelaxedCell<T, const D: usize, const NB: usize> {
    /// The whole cell: the frame of sums that neighbours exchange, and of the wide fit.
    pub(super) whole: Patch<T, D>,
    /// What the surface of a body leaves of it: the frame of its own fit, and what is integrated over.
    pub(super) patch: Patch<T, D>,
    pub(super) own: CellFit<T, NB>,
    /// With the particles of the neighbours; none where even they do not tell the functions apart.
    pub(super) wide: Option<CellFit<T, NB>>,
    open: bool,
    /// Beyond one dimension; always full in one, where weak DOFs are lumped.
    pub(super) filling: Filling,
    /// Sums of the own particles, in the frame of the whole cell.
    gram: Gram<T, NB>,
}

impl<T: Scalar, const D: usize, const NB: usize> RelaxedCell<T, D, NB> {
    /// The cell with number `cell`, of its own particles only.
    #[inline(always)]
    pub(super) fn alone(cloud: &Cloud<'_, T, D>, cell: usize, tolerance: T) -> Self {
        let (whole, patch) = (Patch::whole(cloud.grid, cell), cloud.patch(cell));
        let points = |frame| local(cloud, cell, frame).map(|(_, s)| (s, T::one()));
        let gram = Gram::new(points(&whole));
        let own = if patch == whole {
            CellFit::with_gram(&gram, points(&whole), 0, tolerance)
        } else {
            CellFit::weighted(points(&patch), 0, tolerance)
        };
        Self {
            whole,
            patch,
            own,
            wide: None,
            open: false,
            filling: Filling::Full,
            gram,
        }
    }

    /// Cuts the cell on its `open` sides, beyond which there are no particles, to where its particles end.
    fn end_where_particles_end(&mut self, cloud: &Cloud<'_, T, D>, open: &OpenSides<D>, tolerance: T) {
        let mut patch = self.whole;
        for (axis, sides) in open.iter().enumerate() {
            let half = patch.half[axis];
            let ends = |above: bool| {
                let reach = reach(cloud, &self.whole, axis, above);
                let share = if sides[usize::from(above)] && reach < T::lit(FULL) {
                    reach
                } else {
                    T::one()
                };
                half * share
            };
            let (low, high) = (ends(false), ends(true));
            if low + high > T::zero() {
                patch.centre[axis] += (high - low) / T::lit(2.0);
                patch.half[axis] = (low + high) / T::lit(2.0);
                patch.inverse_half[axis] = T::one() / patch.half[axis];
            }
        }
        if patch != self.whole {
            let points = local(cloud, cloud.grid.linear(&patch.cell), &patch).map(|(_, s)| (s, T::one()));
            self.own = CellFit::weighted(points, 0, tolerance);
            self.patch = patch;
        }
    }

    /// Takes in that there are no particles beyond the `open` sides.
    #[cold]
    #[inline(never)]
    fn end_at(&mut self, cloud: &Cloud<'_, T, D>, open: &OpenSides<D>, tolerance: T) {
        let borders_on_nothing = borders_on_nothing(cloud, &self.whole, open);
        if D > 1 && borders_on_nothing {
            self.open = !is_full(cloud, &self.whole);
        } else {
            self.end_where_particles_end(cloud, open, tolerance);
        }
        if D > 1 && (self.open || self.patch != self.whole) {
            self.filling = if self.is_full() {
                Filling::Part
            } else {
                Filling::Few
            };
        }
    }

    /// Whether material ends within it on any slant, beyond one dimension. Its particles are then the points of its force, and are
    /// left as they are.
    #[inline(always)]
    pub(super) fn is_open(&self) -> bool {
        self.open
    }

    /// Whether its own particles determine all functions.
    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.own.functions() == NB
    }

    /// Coefficients of the own fit, from the sums in the frame of the whole cell where they serve.
    #[inline(always)]
    pub(super) fn own_coefficients<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cell: usize,
        sums: [Q; NB],
        value: impl Fn(usize) -> Q,
    ) -> [Q; NB] {
        if self.own.is_well_spread() && self.patch == self.whole {
            return self.own.coefficients_from_sums(sums);
        }
        let samples = local(cloud, cell, &self.patch).map(|(p, s)| (s, T::one(), value(p)));
        self.own.coefficients(samples, Q::zero())
    }
}

/// Makes the wide fits.
pub(super) fn join<T: Scalar, const D: usize, const NB: usize>(
    cells: &mut [RelaxedCell<T, D, NB>],
    cloud: &Cloud<'_, T, D>,
    tolerance: T,
) {
    for place in 0..cells.len() {
        let (mut gram, mut open) = (cells[place].gram, [[true; 2]; D]);
        cloud
            .bins
            .for_each_neighbour(cloud.grid, place, |axis, above, other| {
                gram.add_neighbour::<D>(&cells[other].gram, axis, above);
                open[axis][usize::from(above)] = false;
            });
        let cell = &mut cells[place];
        cell.wide = CellFit::full::<D>(&gram, tolerance);
        if open != [[false; 2]; D] && cell.patch == cell.whole {
            cell.end_at(cloud, &open, tolerance);
        }
    }
}
