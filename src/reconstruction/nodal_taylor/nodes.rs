//! The nodes of the occupied cells.

use crate::grid::{Cell, Grid};
use crate::reconstruction::Cloud;
use crate::scalar::Scalar;

const NONE: u32 = u32::MAX;

/// A node as a point of one of its cells sees it.
pub(super) struct Corner<T, const D: usize> {
    /// Number of the node.
    pub(super) node: usize,
    /// Its hat there.
    pub(super) hat: T,
    /// Coordinates relative to it, in cells.
    pub(super) s: [T; D],
}

/// The nodes of a step, numbered as the occupied cells meet them.
#[derive(Clone, Debug)]
pub(super) struct Nodes<const D: usize> {
    /// Number of the node at each place of the grid's window, or [`NONE`].
    numbers: Vec<u32>,
    /// Where each is: cells below it along each axis.
    places: Vec<[u32; D]>,
    /// The window, in nodes.
    first: [u32; D],
    shape: [usize; D],
}

impl<const D: usize> Nodes<D> {
    pub(super) fn none() -> Self {
        Self {
            numbers: Vec::new(),
            places: Vec::new(),
            first: [0; D],
            shape: [0; D],
        }
    }

    pub(super) fn len(&self) -> usize {
        self.places.len()
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<u32>() * self.numbers.capacity() + size_of::<[u32; D]>() * self.places.capacity()
    }

    pub(super) fn reserve(&mut self, nodes: usize) {
        super::make_room(&mut self.numbers, nodes);
        super::make_room(&mut self.places, nodes);
    }

    /// Numbers the nodes of the occupied cells.
    pub(super) fn number<T: Scalar>(&mut self, cloud: &Cloud<'_, T, D>) {
        let window = cloud.grid.window();
        self.first = window.first();
        self.shape = window.shape().map(|cells| cells + 1);
        self.numbers.clear();
        self.numbers.resize(self.shape.iter().product(), NONE);
        self.places.clear();
        for &cell in cloud.bins.occupied() {
            let cell = cloud.grid.cell(cell as usize);
            for corner in 0..1 << D {
                let place = corner_of(&cell, corner);
                let slot = self.slot(&place);
                if self.numbers[slot] == NONE {
                    self.numbers[slot] = self.places.len() as u32;
                    self.places.push(place);
                }
            }
        }
    }

    #[inline(always)]
    fn slot(&self, place: &[u32; D]) -> usize {
        let (mut slot, mut stride) = (0, 1);
        for a in 0..D {
            slot += (place[a] - self.first[a]) as usize * stride;
            stride *= self.shape[a];
        }
        slot
    }

    /// Number of the node at a corner of a cell of the window, if it has one.
    #[inline(always)]
    pub(super) fn at_corner(&self, cell: &Cell<D>, corner: usize) -> Option<usize> {
        let number = self.numbers[self.slot(&corner_of(cell, corner))];
        (number != NONE).then_some(number as usize)
    }

    /// The first node of a cell of which `counts` says so.
    pub(super) fn first_corner(&self, cell: &Cell<D>, counts: &impl Fn(usize) -> bool) -> Option<usize> {
        (0..1 << D).find_map(|corner| self.at_corner(cell, corner).filter(|&node| counts(node)))
    }

    /// Calls `f` for the nodes of `cell` as its point at `u`, each coordinate from 0 to 1, sees them.
    #[inline(always)]
    pub(super) fn for_each_corner<T: Scalar>(
        &self,
        cell: &Cell<D>,
        u: &[T; D],
        mut f: impl FnMut(Corner<T, D>),
    ) {
        for corner in 0..1_usize << D {
            let Some(node) = self.at_corner(cell, corner) else {
                continue;
            };
            let (mut hat, mut s) = (T::one(), *u);
            for a in 0..D {
                if corner >> a & 1 == 1 {
                    hat *= u[a];
                    s[a] -= T::one();
                } else {
                    hat *= T::one() - u[a];
                }
            }
            f(Corner { node, hat, s });
        }
    }

    /// Calls `f` for the cells of the grid's window around a node.
    pub(super) fn for_each_cell_around<T: Scalar>(
        &self,
        grid: &Grid<T, D>,
        node: usize,
        mut f: impl FnMut(Cell<D>),
    ) {
        let place = &self.places[node];
        for corner in 0..1_usize << D {
            let beyond = |a: usize| match corner >> a & 1 {
                1 => place[a] == 0,
                _ => place[a] as usize == grid.cells()[a],
            };
            if (0..D).any(beyond) {
                continue;
            }
            let cell = std::array::from_fn(|a| place[a] - (corner >> a & 1) as u32);
            if grid.has_numbers(&cell, 0) {
                f(cell);
            }
        }
    }

    /// Along which axes a side of the grid halves the patch of a node, the `a`-th as bit `a`.
    pub(super) fn halved<T: Scalar>(&self, grid: &Grid<T, D>, node: usize) -> usize {
        let (place, cells) = (&self.places[node], grid.cells());
        let at_side = |a: usize| place[a] == 0 || place[a] as usize == cells[a];
        (0..D).fold(0, |halved, a| halved | usize::from(at_side(a)) << a)
    }
}

fn corner_of<const D: usize>(cell: &Cell<D>, corner: usize) -> [u32; D] {
    std::array::from_fn(|a| cell[a] + (corner >> a & 1) as u32)
}

/// Cell of a particle and its coordinates there, from 0 to 1.
#[inline(always)]
pub(super) fn local<T: Scalar, const D: usize>(cloud: &Cloud<'_, T, D>, p: usize) -> (Cell<D>, [T; D]) {
    let (cell, x, grid) = (*cloud.bins.cell_of(p), &cloud.positions[p], cloud.grid);
    let u = std::array::from_fn(|a| grid.unit_coordinate(a, cell[a], x[a]));
    (cell, u)
}
