//! Particles cell after cell in memory.
//!
//! Passes over particles are fast where the particles of a cell follow each other: they share its DOFs, and
//! four of them are computed with at once. In two and three dimensions particles are therefore put in the
//! order of their cells at the start, and again after enough of them have changed their cells. In one
//! dimension they usually come in order and stay so; there only a start without any order is mended.

use nalgebra::{SMatrix, SVector};

use crate::grid::{Cell, Grid};
use crate::particles::Particles;
use crate::scalar::Scalar;

/// One particle in so many must have changed its cell before all are put in order again: that takes about as
/// long as one step.
const CHANGED: usize = 16;
/// One in so many that come before their predecessor's cell make a line of particles one without order.
const BACKWARD: usize = 8;

/// Which particle is where.
#[derive(Clone, Debug, Default)]
pub(super) struct Order {
    /// Number, in the order they were given in, of the particle at each place; empty where they stay in that
    /// order.
    pub(super) numbers: Vec<u32>,
    /// The place that each particle is to go to.
    targets: Vec<u32>,
    /// The place of each cell's first particle.
    starts: Vec<u32>,
    pub(super) crossings: usize,
    pub(super) moved: bool,
}

impl Order {
    /// For particles in the given cells; allocates what ordering them will need.
    #[inline(never)]
    pub(super) fn new<T: Scalar, const D: usize>(grid: &Grid<T, D>, cells: &[Cell<D>]) -> Self {
        let backward = cells.windows(2).filter(|pair| before(grid, &pair[1], &pair[0]));
        if D == 1 && backward.count() * BACKWARD <= cells.len() {
            return Self::default();
        }
        Self {
            numbers: (0..cells.len() as u32).collect(),
            targets: vec![0; cells.len()],
            starts: vec![0; grid.cell_count()],
            crossings: cells.len(),
            moved: false,
        }
    }

    /// Makes room for the cells of another window.
    pub(super) fn follow_window<T: Scalar, const D: usize>(&mut self, grid: &Grid<T, D>) {
        if !self.numbers.is_empty() {
            self.starts = vec![0; grid.cell_count()];
        }
    }

    /// Notes that so many particles changed their cells.
    pub(super) fn note_crossings(&mut self, crossings: usize) {
        self.crossings += crossings;
    }

    /// Whether there is enough disorder for [`Order::restore`] to be worth its time.
    pub(super) fn is_lost(&self) -> bool {
        !self.numbers.is_empty() && self.crossings * CHANGED >= self.numbers.len()
    }

    /// Puts the particles, with what a transfer remembers of them, in the order of their cells; those of a
    /// cell stay in the order in which they are, and their states take so many numbers each. Returns whether
    /// any has moved; if so, `moves` was told the place that each is at now.
    #[inline(never)]
    pub(super) fn restore<T: Scalar, const D: usize, S: Copy, P: Copy, M>(
        &mut self,
        grid: &Grid<T, D>,
        cells: &mut [Cell<D>],
        (particles, memory): (&mut Particles<T, D, S, P>, &mut [M]),
        numbers_each: usize,
        moves: &mut dyn FnMut(&[u32]),
    ) -> bool {
        self.crossings = 0;
        if cells.windows(2).all(|pair| !before(grid, &pair[1], &pair[0])) {
            return false;
        }
        self.moved = true;
        self.starts.fill(0);
        for cell in cells.iter() {
            self.starts[grid.linear(cell)] += 1;
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += std::mem::replace(start, sum);
        }
        for (cell, target) in cells.iter().zip(&mut self.targets) {
            let next = &mut self.starts[grid.linear(cell)];
            *target = *next;
            *next += 1;
        }
        moves(&self.targets);
        let numbers = &mut self.numbers;
        permute(&mut self.targets, |a, b| {
            particles.swap(a, b, numbers_each);
            memory.swap(a, b);
            cells.swap(a, b);
            numbers.swap(a, b);
        });
        true
    }

    /// Number, in the order they were given in, of the particle at each place; `None` if they still are in
    /// that order.
    pub(super) fn numbers(&self) -> Option<&[u32]> {
        self.moved.then_some(&self.numbers[..])
    }

    /// That of the particle at `place`.
    pub(super) fn number(&self, place: usize) -> usize {
        self.numbers().map_or(place, |numbers| numbers[place] as usize)
    }

    /// The same, taken out of an order that is of no further use.
    pub(super) fn take_numbers(&mut self) -> Option<Vec<u32>> {
        self.moved.then_some(std::mem::take(&mut self.numbers))
    }

    /// The numbers, to be used up.
    pub(super) fn into_numbers(self) -> Option<Vec<u32>> {
        self.moved.then_some(self.numbers)
    }

    /// Bytes allocated.
    pub(super) fn bytes(&self) -> usize {
        size_of::<u32>() * (self.numbers.capacity() + self.targets.capacity() + self.starts.capacity())
    }
}

/// Moves what is at each place to its target by swaps; the targets become the places.
pub(super) fn permute(targets: &mut [u32], mut swap: impl FnMut(usize, usize)) {
    for place in 0..targets.len() {
        while targets[place] as usize != place {
            let target = targets[place] as usize;
            swap(place, target);
            targets.swap(place, target);
        }
    }
}

/// Whether cell `a` has a lower number than `b`.
#[inline(always)]
fn before<T: Scalar, const D: usize>(grid: &Grid<T, D>, a: &Cell<D>, b: &Cell<D>) -> bool {
    grid.linear(a) < grid.linear(b)
}

impl<T: Scalar, const D: usize, S: Copy, P: Copy> Particles<T, D, S, P> {
    /// Exchanges two particles, whose states take so many numbers each.
    pub(super) fn swap(&mut self, a: usize, b: usize, numbers_each: usize) {
        let vectors: [&mut Vec<SVector<T, D>>; 4] = [
            &mut self.initial_position,
            &mut self.position,
            &mut self.displacement,
            &mut self.velocity,
        ];
        vectors.into_iter().for_each(|values| values.swap(a, b));
        let stress: &mut Vec<SMatrix<T, D, D>> = &mut self.stress;
        stress.swap(a, b);
        self.mass.swap(a, b);
        self.volume.swap(a, b);
        for k in 0..numbers_each {
            self.state.swap(a * numbers_each + k, b * numbers_each + k);
        }
        self.phase.swap(a, b);
        self.domains.swap(a, b);
    }

    /// Puts particles with the given `numbers` and a state each in the order of the numbers, which are used
    /// up.
    #[inline(never)]
    pub(super) fn put_back(&mut self, numbers: Option<Vec<u32>>) {
        permute(&mut numbers.unwrap_or_default(), |a, b| self.swap(a, b, 1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::Bins;
    use nalgebra::vector;

    #[test]
    fn particles_come_cell_by_cell_and_can_be_put_back() {
        let grid = Grid::new(vector![0.0, 0.0], vector![3.0, 2.0], [3, 2]).unwrap();
        let places = [[2.5, 1.5], [0.5, 0.5], [2.5, 0.5], [0.6, 0.5], [0.5, 1.5]];
        let points: Vec<_> = places.map(|[x, y]| (vector![x, y], 1.0)).into();
        let mut particles: Particles<f64, 2> = Particles::at_rest(&points, 1.0);
        let mut bins = Bins::new(&grid, &particles.position).unwrap();
        let mut order = Order::new(&grid, bins.cells());
        assert!(order.is_lost());
        let cells = bins.cells_mut();
        let mut memory = [10, 11, 12, 13, 14];
        let both = (&mut particles, &mut memory[..]);
        let moved = order.restore(&grid, cells, both, 1, &mut |targets| {
            assert_eq!(targets, [4, 0, 2, 1, 3]);
        });
        assert!(moved && !order.is_lost());
        assert_eq!(order.numbers(), Some(&[1, 3, 2, 4, 0][..]));
        assert_eq!(order.number(4), 0);
        assert_eq!(cells, [[0, 0], [0, 0], [2, 0], [0, 1], [2, 1]]);
        let both = (&mut particles, &mut memory[..]);
        assert!(!order.restore(&grid, cells, both, 1, &mut |_| ()));
        assert_eq!(memory, [11, 13, 12, 14, 10]);
        particles.put_back(order.into_numbers());
        assert_eq!(particles.position, points.iter().map(|p| p.0).collect::<Vec<_>>());
    }

    #[test]
    fn a_line_in_order_keeps_nothing() {
        let grid = Grid::new(vector![0.0], vector![3.0], [3]).unwrap();
        let order = Order::new(&grid, &[[0], [0], [1], [2]]);
        assert_eq!(
            (order.bytes(), order.is_lost(), order.numbers()),
            (0, false, None)
        );
        assert!(Order::new(&grid, &[[0], [2], [1], [0]]).is_lost());
    }
}
