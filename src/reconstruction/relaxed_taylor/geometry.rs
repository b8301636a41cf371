//! Taking in where the particles are.

use std::ops::Range;

use super::cells::{Kind, RelaxedCell};
use super::determined::seen_by_particles;
use super::four::{FourFits, KeptProducts, keep_gram};
use super::{GROUPS, RelaxedTaylor};
use crate::parallel::{Rows, each_span, worth_sharing};
use crate::reconstruction::{Cloud, Filling};
use crate::scalar::Scalar;
use crate::simd::{LANES, Packs, dispatch};

impl<T: Scalar, const D: usize, const NB: usize> RelaxedTaylor<T, D, NB> {
    /// Whether threads should share the groups of four cells.
    pub(super) fn share_groups(&self) -> bool {
        worth_sharing::<D>(self.cells.len(), GROUPS * LANES)
    }

    /// Places of the cells of a group.
    pub(super) fn places(&self, group: usize) -> Range<usize> {
        group * LANES..self.cells.len().min((group + 1) * LANES)
    }

    /// Makes the fits of all occupied cells, for which there must be room.
    pub(super) fn take_in_geometry(&mut self, cloud: &Cloud<'_, T, D>) {
        let occupied = cloud.bins.occupied().len();
        self.cells.resize(occupied, RelaxedCell::none());
        let groups = occupied.div_ceil(LANES);
        let parallel = self.share_groups();
        let mut grams = std::mem::take(&mut self.grams);
        grams.resize(groups, [[[T::zero(); LANES]; NB]; NB]);
        let this = &*self;
        each_span(parallel, GROUPS, &mut grams[..], &|first, grams| {
            dispatch!(T, |k| this.grams_in(k, cloud, first, grams));
        });
        let (mut fits, mut cells) = (std::mem::take(&mut self.fits), std::mem::take(&mut self.cells));
        let count = cells.len();
        fits.resize(groups, FourFits::empty());
        let work = (
            &mut fits[..],
            Rows {
                values: &mut cells[..],
                width: LANES,
            },
        );
        let (degree, tolerance) = (self.degree, self.tolerance);
        each_span(parallel, GROUPS, work, &|first, (fits, cells)| {
            let fitting = Fitting {
                cloud,
                grams: &grams,
                count,
                degree,
                tolerance,
            };
            dispatch!(T, |k| fitting.fits_in(k, first, fits, cells.values));
        });
        (self.grams, self.fits, self.cells) = (grams, fits, cells);
    }

    /// Leaves those cells to their particles that neither these nor the cells near them determine.
    pub(super) fn leave_undetermined(&mut self, cloud: &Cloud<'_, T, D>) {
        if const { D == 1 } {
            self.leave_short_runs(cloud);
        }
        for place in 0..self.cells.len() {
            if self.cells[place].filling == Filling::PartlyFilled && self.sees_squares_beside(cloud, place) {
                self.cells[place].filling = Filling::Filled;
            }
            let is_alone = match self.cells[place].filling {
                Filling::Underdetermined => !self.is_held(cloud, place),
                Filling::PartlyFilled => self.is_thin(cloud, place),
                Filling::Filled | Filling::Isolated => false,
            };
            if is_alone {
                self.cells[place].leave_alone();
            }
        }
    }

    /// The same along one axis with all cells that follow each other without a gap and hold less particles
    /// than functions: as many as cells, and the degree of the basis more.
    fn leave_short_runs(&mut self, cloud: &Cloud<'_, T, D>) {
        let mut first = 0;
        for run in cloud.bins.occupied().chunk_by(|a, b| a + 1 == *b) {
            let cells = first..first + run.len();
            first = cells.end;
            let particles: usize = run.iter().map(|&cell| cloud.bins.count_in(cell as usize)).sum();
            if particles < run.len() + self.degree {
                self.cells[cells].iter_mut().for_each(RelaxedCell::leave_alone);
            }
        }
    }

    /// Whether particles determine a cell next to this one or, beyond one dimension, where ties reach
    /// further, next to that.
    fn is_held(&self, cloud: &Cloud<'_, T, D>, place: usize) -> bool {
        let holds =
            |place: usize| matches!(self.cells[place].filling, Filling::Filled | Filling::PartlyFilled);
        let (bins, grid) = (cloud.bins, cloud.grid);
        let mut held = false;
        bins.for_each_neighbour(grid, place, |_, _, other| {
            held |= holds(other);
            if const { D > 1 } {
                bins.for_each_neighbour(grid, other, |_, _, next| held |= holds(next));
            }
        });
        held
    }

    /// Whether a whole cell whose particles see no squares, as happens for a while where particles cross, is
    /// beside one whose particles do: they share functions, and a tie would only smooth what is determined.
    fn sees_squares_beside(&self, cloud: &Cloud<'_, T, D>, place: usize) -> bool {
        let mut seen = false;
        if self.cells[place].kind == Kind::Batch {
            let neighbours = |_, _, other: usize| seen |= self.cells[other].is_full;
            cloud.bins.for_each_neighbour(cloud.grid, place, neighbours);
        }
        seen
    }

    /// Whether particles see no square in a cell, and it has no neighbours along an axis that would know.
    fn is_thin(&self, cloud: &Cloud<'_, T, D>, place: usize) -> bool {
        let open = self.fits[place / LANES].open_sides(place % LANES);
        open.contains(&[true; 2])
            && seen_by_particles(cloud, cloud.bins.occupied()[place] as usize, self.degree) != Filling::Filled
    }

    #[inline(always)]
    fn grams_in<K: Packs<T>>(
        &self,
        k: K,
        cloud: &Cloud<'_, T, D>,
        first: usize,
        grams: &mut [KeptProducts<T, NB>],
    ) {
        // A copy: a compiler then knows that what is written leaves it alone.
        let cloud = &{ *cloud };
        for (n, kept) in grams.iter_mut().enumerate() {
            keep_gram::<T, K, D, NB>(k, cloud, self.places(first + n), kept);
        }
    }
}

/// What fits are made of.
struct Fitting<'a, 'c, T, const D: usize, const NB: usize> {
    cloud: &'a Cloud<'c, T, D>,
    grams: &'a [KeptProducts<T, NB>],
    /// Number of occupied cells.
    count: usize,
    /// Of the basis.
    degree: usize,
    tolerance: T,
}

impl<T: Scalar, const D: usize, const NB: usize> Fitting<'_, '_, T, D, NB> {
    #[inline(always)]
    fn fits_in<K: Packs<T>>(
        &self,
        k: K,
        first: usize,
        fits: &mut [FourFits<T, D, NB>],
        cells: &mut [RelaxedCell],
    ) {
        let occupied = self.cloud.bins.occupied();
        for (n, (fits, cells)) in fits.iter_mut().zip(cells.chunks_mut(LANES)).enumerate() {
            let start = (first + n) * LANES;
            let places = start..self.count.min(start + LANES);
            fits.take_in(k, self.cloud, places, self.grams, self.tolerance);
            for (l, cell) in cells.iter_mut().enumerate() {
                let number = occupied[start + l] as usize;
                let own = [fits.own_is_full[l], fits.own_is_hard[l]];
                *cell = RelaxedCell::new::<T, D, NB>(
                    self.cloud,
                    number,
                    &fits.open_sides(l),
                    own,
                    (self.degree, self.tolerance),
                );
            }
        }
    }
}
