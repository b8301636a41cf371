//! Which cell holds which particles.

use std::ops::Range;

use nalgebra::SVector;

use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;

/// A particle that is in no cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outside(pub usize);

/// The cell of every particle, and the particles of every cell.
#[derive(Clone, Debug, Default)]
pub struct Bins<const D: usize> {
    cell_of: Vec<Cell<D>>,
    start: Vec<u32>,
    order: Vec<u32>,
    occupied: Vec<u32>,
    lists_are_stale: bool,
    /// Whether the lists, end to end, are the particles in their own order.
    are_in_order: bool,
}

impl<const D: usize> Bins<D> {
    /// Cells and lists of `positions`.
    ///
    /// # Errors
    /// [`Outside`] names the first particle that is not in the grid.
    pub fn new<T: Scalar>(grid: &Grid<T, D>, positions: &[SVector<T, D>]) -> Result<Self, Outside> {
        let mut bins = Self::without_lists(grid, positions)?;
        bins.list(grid);
        Ok(bins)
    }

    /// Cells of `positions` alone; the lists take no memory, and are empty, until [`Bins::list`].
    #[inline(never)]
    pub(crate) fn without_lists<T: Scalar>(
        grid: &Grid<T, D>,
        positions: &[SVector<T, D>],
    ) -> Result<Self, Outside> {
        let mut bins = Self {
            cell_of: vec![[u32::MAX; D]; positions.len()],
            start: Vec::new(),
            order: Vec::new(),
            occupied: Vec::new(),
            lists_are_stale: true,
            are_in_order: false,
        };
        bins.locate(grid, positions)?;
        Ok(bins)
    }

    /// Particles in the given cells, without lists.
    #[cfg(test)]
    pub(crate) fn of_cells(cells: Vec<Cell<D>>) -> Self {
        Self {
            cell_of: cells,
            start: Vec::new(),
            order: Vec::new(),
            occupied: Vec::new(),
            lists_are_stale: true,
            are_in_order: false,
        }
    }

    /// Looks every particle's cell up again and returns how many changed theirs.
    ///
    /// # Errors
    /// [`Outside`] names the first particle that is not in the grid.
    #[inline(never)]
    pub fn locate<T: Scalar>(
        &mut self,
        grid: &Grid<T, D>,
        positions: &[SVector<T, D>],
    ) -> Result<usize, Outside> {
        let mut crossings = 0;
        for (p, (cell, x)) in self.cell_of.iter_mut().zip(positions).enumerate() {
            crossings += usize::from(relocate(grid, cell, x).ok_or(Outside(p))?);
        }
        self.note_crossings(crossings);
        Ok(crossings)
    }

    /// Cell of each particle.
    #[inline(always)]
    pub fn cells(&self) -> &[Cell<D>] {
        &self.cell_of
    }

    /// The same, to be changed; [`Bins::note_crossings`] must then be told how many were.
    #[inline(always)]
    pub(crate) fn cells_mut(&mut self) -> &mut [Cell<D>] {
        &mut self.cell_of
    }

    /// Makes the lists stale because cells have other numbers.
    pub(crate) fn note_numbering(&mut self) {
        self.lists_are_stale = true;
    }

    /// Makes the lists stale if particles changed their cells.
    pub(crate) fn note_crossings(&mut self, crossings: usize) {
        self.lists_are_stale |= crossings > 0;
    }

    /// Brings the lists per cell up to date (a counting sort, only after a particle changed its cell).
    #[inline(never)]
    pub fn list<T: Scalar>(&mut self, grid: &Grid<T, D>) {
        if !self.lists_are_stale {
            return;
        }
        self.lists_are_stale = false;
        if self.are_in_order && self.list_in_order(grid) {
            return;
        }
        self.occupied.clear();
        if self.start.len() != grid.cell_count() + 1 {
            self.start = vec![0; grid.cell_count() + 1];
            self.order = vec![0; self.cell_of.len()];
            self.occupied = Vec::with_capacity(grid.cell_count());
        }
        self.start.fill(0);
        for cell in &self.cell_of {
            self.start[grid.linear(cell) + 1] += 1;
        }
        for c in 0..grid.cell_count() {
            if self.start[c + 1] > 0 {
                self.occupied.push(c as u32);
            }
            self.start[c + 1] += self.start[c];
        }
        self.are_in_order = true;
        for (p, cell) in self.cell_of.iter().enumerate() {
            let next = &mut self.start[grid.linear(cell)];
            self.order[*next as usize] = p as u32;
            self.are_in_order &= *next as usize == p;
            *next += 1;
        }
        // Filling advanced every start to its cell's end: shift them back.
        self.start.rotate_right(1);
        self.start[0] = 0;
    }

    /// The same in one pass where particles that were in the order of their cells still are; returns whether
    /// they are.
    fn list_in_order<T: Scalar>(&mut self, grid: &Grid<T, D>) -> bool {
        if self.start.len() != grid.cell_count() + 1 {
            return false;
        }
        self.occupied.clear();
        // Cells below this one have their starts.
        let mut next = 0;
        for (p, cell) in self.cell_of.iter().enumerate() {
            let number = grid.linear(cell);
            if number + 1 == next {
                continue;
            }
            if number < next {
                return false;
            }
            self.start[next..=number].fill(p as u32);
            self.occupied.push(number as u32);
            next = number + 1;
        }
        self.start[next..].fill(self.cell_of.len() as u32);
        true
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.cell_of.len()
    }

    /// Whether there is no particle.
    pub fn is_empty(&self) -> bool {
        self.cell_of.is_empty()
    }

    /// Cell of particle `p`.
    #[inline(always)]
    pub fn cell_of(&self, p: usize) -> &Cell<D> {
        &self.cell_of[p]
    }

    /// Particles of the cell with number `cell`, in ascending order, as of the last [`Bins::list`].
    #[inline(always)]
    pub fn particles_in(&self, cell: usize) -> &[u32] {
        match (self.start.get(cell), self.start.get(cell + 1)) {
            (Some(&first), Some(&end)) => &self.order[first as usize..end as usize],
            _ => &[],
        }
    }

    /// Number of particles in the cell with number `cell`.
    #[inline(always)]
    pub(crate) fn count_in(&self, cell: usize) -> usize {
        match (self.start.get(cell), self.start.get(cell + 1)) {
            (Some(&first), Some(&end)) => (end - first) as usize,
            _ => 0,
        }
    }

    /// The particles of the cell with number `cell`, if it has any and they follow each other.
    #[inline(always)]
    pub(crate) fn run_in(&self, cell: usize) -> Option<Range<usize>> {
        if !self.are_in_order {
            return self.run_in_list(cell);
        }
        match (self.start.get(cell), self.start.get(cell + 1)) {
            (Some(&first), Some(&end)) if first < end => Some(first as usize..end as usize),
            _ => None,
        }
    }

    #[inline(never)]
    fn run_in_list(&self, cell: usize) -> Option<Range<usize>> {
        let particles = self.particles_in(cell);
        let (&first, &last) = (particles.first()?, particles.last()?);
        // They ascend.
        let follow = (last - first) as usize + 1 == particles.len();
        follow.then_some(first as usize..last as usize + 1)
    }

    /// Numbers of the cells that hold a particle, ascending.
    pub fn occupied(&self) -> &[u32] {
        &self.occupied
    }

    /// Place among the occupied cells of the one with number `cell`, if it is one; found at once next to the
    /// place `near`.
    #[inline(always)]
    pub(crate) fn place_of(&self, cell: usize, near: usize) -> Option<usize> {
        let at = |place: usize| self.occupied.get(place).is_some_and(|&c| c as usize == cell);
        [near + 1, near.wrapping_sub(1)]
            .into_iter()
            .find(|&place| at(place))
            .or_else(|| self.occupied.binary_search(&(cell as u32)).ok())
    }

    /// Calls `f(axis, above, place)` for the occupied cells that share a face with the one at `place` in the
    /// list of the occupied: above or below it along an axis, and their own places.
    #[inline(always)]
    pub fn for_each_neighbour<T: Scalar>(
        &self,
        grid: &Grid<T, D>,
        place: usize,
        mut f: impl FnMut(usize, bool, usize),
    ) {
        let number = self.occupied[place] as usize;
        let cell = grid.cell(number);
        let window = grid.window();
        let (first, cells) = (window.first(), window.shape());
        let mut stride = 1;
        for axis in 0..D {
            let place_on_axis = (cell[axis] - first[axis]) as usize;
            if place_on_axis > 0
                && let Some(other) = self.place_of(number - stride, place)
            {
                f(axis, false, other);
            }
            if place_on_axis + 1 < cells[axis]
                && let Some(other) = self.place_of(number + stride, place)
            {
                f(axis, true, other);
            }
            stride *= cells[axis];
        }
    }

    /// Bytes allocated: per particle its cell and its place in the lists, per cell the start of its list and
    /// its place among the occupied.
    pub fn bytes(&self) -> usize {
        let lists = self.start.capacity() + self.order.capacity() + self.occupied.capacity();
        self.cell_of.capacity() * size_of::<Cell<D>>() + lists * size_of::<u32>()
    }
}

/// Looks the cell at `x` up again and returns whether it is another one; `None` if `x` is not in the grid.
#[inline(always)]
pub(crate) fn relocate<T: Scalar, const D: usize>(
    grid: &Grid<T, D>,
    cell: &mut Cell<D>,
    x: &SVector<T, D>,
) -> Option<bool> {
    if grid.strictly_contains(cell, x) {
        return Some(false);
    }
    let found = grid.locate(x)?;
    let crossed = found != *cell;
    *cell = found;
    Some(crossed)
}

/// The same for a particle that moves on: from an edge it is moved off ([`Grid::nudge_off_edges`]).
#[inline(always)]
pub(crate) fn settle<T: Scalar, const D: usize>(
    grid: &Grid<T, D>,
    cell: &mut Cell<D>,
    x: &mut SVector<T, D>,
) -> Option<bool> {
    if grid.strictly_contains(cell, x) {
        return Some(false);
    }
    let crossed = relocate(grid, cell, x)?;
    grid.nudge_off_edges(cell, x);
    Some(crossed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::vector;

    #[test]
    fn lists_cost_nothing_until_they_are_asked_for() {
        let grid = Grid::new(vector![0.0], vector![4.0], [4]).unwrap();
        let x = [vector![3.5], vector![0.5]];
        let mut bins = Bins::without_lists(&grid, &x).unwrap();
        assert_eq!((bins.bytes(), bins.cell_of(0)), (2 * 4, &[3]));
        assert_eq!((bins.particles_in(3), bins.occupied()), (&[][..], &[][..]));
        bins.list(&grid);
        assert_eq!((bins.particles_in(3), bins.occupied()), (&[0][..], &[0, 3][..]));
        assert_eq!(bins.bytes(), 4 * (2 + 2 + 5 + 4));
    }

    #[test]
    fn lists_hold_every_particle_once_and_follow_a_crossing() {
        let grid = Grid::new(vector![0.0], vector![4.0], [4]).unwrap();
        let mut x = vec![vector![3.5], vector![0.5], vector![0.2], vector![1.0]];
        let mut bins = Bins::new(&grid, &x).unwrap();
        assert_eq!(bins.particles_in(0), &[1, 2]);
        assert_eq!(
            (bins.run_in(0), bins.run_in(2), bins.run_in(9)),
            (Some(1..3), None, None)
        );
        assert_eq!(bins.particles_in(1), &[3]);
        assert_eq!(bins.particles_in(2), &[] as &[u32]);
        assert_eq!(bins.occupied(), &[0, 1, 3]);
        x[1][0] = 2.5;
        assert_eq!(bins.locate(&grid, &x), Ok(1));
        bins.list(&grid);
        assert_eq!(bins.particles_in(0), &[2]);
        assert_eq!(bins.particles_in(2), &[1]);
        assert_eq!(bins.occupied(), &[0, 1, 2, 3]);
        let in_order = [0.2, 0.5, 1.0, 2.5].map(|x| vector![x]);
        let bins_in_order = Bins::new(&grid, &in_order).unwrap();
        assert_eq!(
            (bins_in_order.run_in(0), bins_in_order.run_in(3)),
            (Some(0..2), None)
        );
        x[3][0] = -0.1;
        assert_eq!(bins.locate(&grid, &x), Err(Outside(3)));
    }
}
