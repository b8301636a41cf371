//! How sums over particles and cells are cut into spans.
//!
//! Where a sum is cut decides its last bits. The cuts are made anew when particles have crossed, from the
//! cells of that very step, and stay until the next crossing; so they are saved, as the number of shortest
//! spans that each span is made of. The windows themselves are not: what a wider one holds more is zeros. The
//! capacities are, so that a run reports the same memory.

use std::io;

use super::codec::{In, Out};
use crate::error::RestoreError;
use crate::grid::Grid;
use crate::parallel::{CELLS, PARTICLES};
use crate::particles::Bins;
use crate::scalar::Scalar;
use crate::stepper::spans::{Spans, Store};

impl<T: Scalar, const D: usize> Spans<T, D> {
    pub(super) fn save(&self, out: &mut Out<'_>) -> io::Result<()> {
        out.flag(self.stale)?;
        out.flag(self.unknown)?;
        let [particles, cells] = self.lengths;
        out.count(particles / PARTICLES)?;
        out.count(cells / CELLS)?;
        out.indices(self.bounds.as_flattened())?;
        out.count(self.cells.capacity())?;
        let Store {
            scalars,
            vectors,
            matrices,
        } = &self.store;
        scalars.iter().try_for_each(|store| out.count(store.capacity()))?;
        vectors.iter().try_for_each(|store| out.count(store.capacity()))?;
        matrices.iter().try_for_each(|store| out.count(store.capacity()))
    }

    /// `most` is more than any storage here has room for.
    pub(super) fn restore(
        &mut self,
        from: &mut In<'_>,
        (grid, bins): (&Grid<T, D>, &Bins<D>),
        most: usize,
    ) -> Result<(), RestoreError> {
        let stale = from.flag()?;
        let unknown = from.flag()?;
        let joined = [joined(from)?, joined(from)?];
        from.indices(self.bounds.as_flattened_mut())?;
        self.widen_bounds(grid, bins)?;
        // Made anew by the next step, and if they were not to change then as they were.
        (self.stale, self.unknown) = (true, unknown);
        self.told = (!stale).then_some(joined);
        make_room(&mut self.cells, from.count()?, most);
        for store in &mut self.store.scalars {
            make_room(store, from.count()?, most);
        }
        for store in &mut self.store.vectors {
            make_room(store, from.count()?, most);
        }
        for store in &mut self.store.matrices {
            make_room(store, from.count()?, most);
        }
        Ok(())
    }

    /// Whatever was read, the bounds are cells of the grid, and the particles are within.
    fn widen_bounds(&mut self, grid: &Grid<T, D>, bins: &Bins<D>) -> Result<(), RestoreError> {
        let spans = bins.cells().chunks(PARTICLES);
        for (index, (bounds, cells)) in self.bounds.iter_mut().zip(spans).enumerate() {
            // Where some have no number, the window and the bounds are made anew.
            let numbered = cells.iter().filter(|cell| grid.has_numbers(cell, 0));
            let numbers = numbered.map(|cell| grid.linear(cell) as u32);
            *bounds = numbers.fold(*bounds, |[low, high], n| [low.min(n), high.max(n)]);
            if bounds[1] as usize >= grid.cell_count() {
                let what = "the cells of span";
                return Err(RestoreError::Invalid { what, index });
            }
        }
        Ok(())
    }
}

/// Of how many shortest spans one is made.
fn joined(from: &mut In<'_>) -> Result<usize, RestoreError> {
    let what = "the length of spans";
    match from.count_below(1 << 31, what, 0)? {
        joined if joined.is_power_of_two() => Ok(joined),
        index => Err(RestoreError::Invalid { what, index }),
    }
}

/// Gives `values` a capacity, unless it makes no sense.
fn make_room<Q>(values: &mut Vec<Q>, capacity: usize, most: usize) {
    if capacity <= most {
        values.reserve_exact(capacity.saturating_sub(values.len()));
    }
}
