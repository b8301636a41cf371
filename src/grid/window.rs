//! The part of a grid whose cells and DOFs have numbers.

use super::Cell;

/// A box of cells. In a grid that is much larger than what moves through it only the cells of such a box get
/// numbers, and with them a place in memory; the box follows the particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window<const D: usize> {
    first: Cell<D>,
    shape: [usize; D],
}

impl<const D: usize> Window<D> {
    /// Of `shape` cells along each axis, from the cell `first` on.
    pub fn new(first: Cell<D>, shape: [usize; D]) -> Self {
        Self { first, shape }
    }

    /// All of `cells` cells along each axis.
    pub fn whole(cells: [usize; D]) -> Self {
        Self {
            first: [0; D],
            shape: cells,
        }
    }

    /// The smallest box that holds all `cells`; empty if there is none.
    pub fn around<'a>(cells: impl IntoIterator<Item = &'a Cell<D>>) -> Self {
        let (mut low, mut high) = ([u32::MAX; D], [0; D]);
        for cell in cells {
            for axis in 0..D {
                low[axis] = low[axis].min(cell[axis]);
                high[axis] = high[axis].max(cell[axis] + 1);
            }
        }
        if low[0] == u32::MAX {
            return Self {
                first: [0; D],
                shape: [0; D],
            };
        }
        Self {
            first: low,
            shape: std::array::from_fn(|axis| (high[axis] - low[axis]) as usize),
        }
    }

    /// The same with `margin(cells)` more cells on both sides of each axis, given how many it has along the
    /// axis.
    #[must_use]
    pub fn widened(self, margin: impl Fn(usize) -> usize) -> Self {
        let margins = self.shape.map(margin);
        // What is cut off below is not missed above: a box must hold what it held.
        let below: [usize; D] = std::array::from_fn(|axis| margins[axis].min(self.first[axis] as usize));
        Self {
            first: std::array::from_fn(|axis| self.first[axis] - below[axis] as u32),
            shape: std::array::from_fn(|axis| self.shape[axis] + below[axis] + margins[axis]),
        }
    }

    /// What of it lies in a grid of `cells`.
    pub(super) fn within(self, cells: [usize; D]) -> Self {
        let first: Cell<D> = std::array::from_fn(|axis| self.first[axis].min(cells[axis] as u32));
        Self {
            first,
            shape: std::array::from_fn(|axis| self.shape[axis].min(cells[axis] - first[axis] as usize)),
        }
    }

    /// Its first cell.
    #[inline(always)]
    pub fn first(&self) -> Cell<D> {
        self.first
    }

    /// Cells along each axis.
    #[inline(always)]
    pub fn shape(&self) -> [usize; D] {
        self.shape
    }

    /// Whether a cell lies in it, and `margin` more cells around that belong to a grid of `cells` do too.
    pub fn holds(&self, cell: &Cell<D>, margin: u32, cells: [usize; D]) -> bool {
        (0..D).all(|axis| {
            let (first, index) = (self.first[axis], cell[axis]);
            let end = first + self.shape[axis] as u32;
            let below = index.saturating_sub(margin) >= first;
            below && index >= first && (index + margin < end || index < end && end as usize == cells[axis])
        })
    }

    /// Number of a cell of the box, axis 0 fastest.
    #[inline(always)]
    pub(super) fn number(&self, cell: &Cell<D>) -> usize {
        let mut index = 0;
        for axis in (0..D).rev() {
            index = index * self.shape[axis] + (cell[axis] - self.first[axis]) as usize;
        }
        index
    }

    /// The cell with a number: the inverse of [`Window::number`].
    #[inline(always)]
    pub(super) fn cell(&self, mut index: usize) -> Cell<D> {
        let mut cell = self.first;
        for axis in 0..D {
            cell[axis] += (index % self.shape[axis]) as u32;
            index /= self.shape[axis];
        }
        cell
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_holds_what_it_was_laid_around_and_numbers_its_cells() {
        let window = Window::around(&[[5, 7], [8, 7], [6, 9]]);
        assert_eq!((window.first(), window.shape()), ([5, 7], [4, 3]));
        for number in 0..12 {
            assert_eq!(window.number(&window.cell(number)), number);
        }
        assert_eq!(window.cell(5), [6, 8]);
    }

    #[test]
    fn it_is_widened_within_the_grid() {
        let window = Window::around(&[[1, 7], [2, 8]])
            .widened(|cells| cells)
            .within([20, 9]);
        assert_eq!((window.first(), window.shape()), ([0, 5], [5, 4]));
        let cells = [20, 9];
        assert!(window.holds(&[0, 8], 1, cells), "there are no cells beyond");
        assert!(window.holds(&[3, 6], 1, cells));
        assert!(window.holds(&[4, 6], 0, cells) && !window.holds(&[4, 6], 1, cells));
        assert!(!window.holds(&[3, 5], 1, cells) && !window.holds(&[3, 4], 0, cells));
        assert_eq!(Window::<2>::around(&[]).shape(), [0, 0]);
    }
}
