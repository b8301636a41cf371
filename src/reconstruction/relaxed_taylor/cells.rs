//! Cells that are not fitted four at a time: those that end within themselves, and those whose particles are
//! hard to tell apart.

use crate::field::Field;
use crate::grid::Side;
use crate::reconstruction::taylor::local;
use crate::reconstruction::{Cloud, Filling, Patch};
use crate::scalar::Scalar;
use crate::taylor::{CellFit, Gram, shift_sums};

use super::determined::seen_by_particles;
use super::filling::{OpenSides, borders_on_nothing, is_full, reaches};
use super::four::KeptSums;

/// How an occupied cell is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// With three others.
    Batch,
    /// Alone, because a surface cuts it or its particles leave it in doubt what they tell.
    Fallback,
    /// Not at all: material ends within it on any slant, beyond one dimension, or two bodies end within it
    /// along one axis, or there is no fit to speak of ([`Filling::Isolated`]). Its particles are the points
    /// of its force, and are left as they are.
    Open,
}

/// What is kept of an occupied cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelaxedCell {
    pub(super) kind: Kind,
    /// In one dimension full, few or alone.
    pub(super) filling: Filling,
    /// Whether its own particles determine all functions.
    pub(super) is_full: bool,
}

impl RelaxedCell {
    /// Of no particles.
    pub(super) fn none() -> Self {
        Self {
            kind: Kind::Open,
            filling: Filling::Underdetermined,
            is_full: false,
        }
    }

    /// Leaves it to its particles.
    pub(super) fn leave_alone(&mut self) {
        (self.kind, self.filling) = (Kind::Open, Filling::Isolated);
    }

    /// The cell with number `cell`, whose own fit is full or in doubt, and which has no neighbours on its
    /// `open` sides.
    #[inline(always)]
    pub(super) fn new<T: Scalar, const D: usize, const NB: usize>(
        cloud: &Cloud<'_, T, D>,
        cell: usize,
        open: &OpenSides<D>,
        [own_is_full, own_is_hard]: [bool; 2],
        (degree, tolerance): (usize, T),
    ) -> Self {
        let is_cut = !cloud.cuts.is_empty() && cloud.is_cut(&cloud.grid.cell(cell));
        if !is_cut && *open == [[false; 2]; D] && !own_is_hard {
            return Self {
                kind: Kind::Batch,
                filling: match own_is_full {
                    true => Filling::Filled,
                    false => seen_by_particles(cloud, cell, degree),
                },
                is_full: own_is_full,
            };
        }
        Self::apart::<T, D, NB>(cloud, cell, open, [own_is_full, own_is_hard], (degree, tolerance))
    }

    #[cold]
    #[inline(never)]
    fn apart<T: Scalar, const D: usize, const NB: usize>(
        cloud: &Cloud<'_, T, D>,
        cell: usize,
        open: &OpenSides<D>,
        [own_is_full, own_is_hard]: [bool; 2],
        (degree, tolerance): (usize, T),
    ) -> Self {
        let (whole, patch) = (Patch::whole(cloud.grid, cell), ended_patch(cloud, cell, open));
        let is_open = match D {
            1 => two_bodies_end(cloud, cell),
            _ => borders_on_nothing(cloud, &whole, open) && !is_full(cloud, &whole),
        };
        let kind = match (is_open, own_is_hard || patch != whole) {
            (true, _) => Kind::Open,
            (false, true) => Kind::Fallback,
            (false, false) => Kind::Batch,
        };
        let is_full = if patch != whole || own_is_hard {
            own_fit::<T, D, NB>(cloud, cell, &patch, tolerance).functions() == NB
        } else {
            own_is_full
        };
        let ends_within = D > 1 && (is_open || patch != whole);
        let filling = match (ends_within, is_full) {
            (true, true) => Filling::PartlyFilled,
            (true, false) => Filling::Underdetermined,
            (false, true) => Filling::Filled,
            (false, false) => seen_by_particles(cloud, cell, degree),
        };
        Self {
            kind,
            filling,
            is_full,
        }
    }
}

/// Whether one body ends in a cell of the only axis below where another begins: no one box holds what there
/// is.
fn two_bodies_end<T: Scalar, const D: usize>(cloud: &Cloud<'_, T, D>, cell: usize) -> bool {
    let here = || cloud.cuts.iter().filter(|cut| cut.cell as usize == cell);
    let ends = |side: Side| here().filter(move |cut| cut.side == side);
    ends(Side::Max).any(|end| ends(Side::Min).any(|start| start.position >= end.position))
}

/// What surfaces, or the ends of the particles on `open` sides, leave of the cell with number `cell`. Beyond
/// one dimension a cell that borders on nothing stays whole.
pub(super) fn ended_patch<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    cell: usize,
    open: &OpenSides<D>,
) -> Patch<T, D> {
    let (whole, mut patch) = (Patch::whole(cloud.grid, cell), cloud.patch(cell));
    if patch != whole || D > 1 && borders_on_nothing(cloud, &whole, open) {
        return patch;
    }
    for (axis, sides) in open.iter().enumerate() {
        let half = patch.half[axis];
        let [low, high] = reaches(cloud, &whole, axis, *sides).map(|reach| reach * half);
        if low + high > T::zero() {
            patch.centre[axis] += (high - low) / T::lit(2.0);
            patch.half[axis] = (low + high) / T::lit(2.0);
            patch.inverse_half[axis] = T::one() / patch.half[axis];
        }
    }
    patch
}

/// The fit through the own particles, in the frame of `patch`.
pub(super) fn own_fit<T: Scalar, const D: usize, const NB: usize>(
    cloud: &Cloud<'_, T, D>,
    cell: usize,
    patch: &Patch<T, D>,
    tolerance: T,
) -> CellFit<T, NB> {
    let points = local(cloud, cell, patch).map(|(_, s)| (s, T::one()));
    CellFit::weighted(points, 0, tolerance)
}

/// Coefficients of the fit through the particles of the cell at `place` and of its neighbours, in the frame
/// of the whole cell; none where they do not tell all functions apart.
pub(super) fn wide_coefficients<T: Scalar, const D: usize, const NB: usize, Q: Field<T>>(
    cloud: &Cloud<'_, T, D>,
    place: usize,
    sums: &KeptSums<'_, T>,
    tolerance: T,
) -> Option<[Q; NB]> {
    let number = |place: usize| cloud.bins.occupied()[place] as usize;
    let gram_of = |place: usize| {
        let cell = number(place);
        let whole = Patch::whole(cloud.grid, cell);
        Gram::<T, NB>::new(local(cloud, cell, &whole).map(|(_, s)| (s, T::one())))
    };
    let (mut gram, mut right) = (gram_of(place), sums.of_cell::<Q, NB>(place));
    cloud
        .bins
        .for_each_neighbour(cloud.grid, place, |axis, above, other| {
            gram.add_neighbour::<D>(&gram_of(other), axis, above);
            let mut theirs = sums.of_cell::<Q, NB>(other);
            shift_sums::<T, D, NB, Q>(&mut theirs, axis, above);
            (0..NB).for_each(|k| right[k].add_scaled(T::one(), theirs[k]));
        });
    CellFit::full::<D>(&gram, tolerance).map(|wide| wide.coefficients_from_sums(right))
}
