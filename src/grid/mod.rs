//! The fixed background grid: a box of equal cells.

mod window;

pub use crate::face::{Face, Side};
pub use window::Window;

use nalgebra::SVector;

use crate::error::GridError;
use crate::scalar::Scalar;
use crate::simd::Packs;

/// Cells between a particle and the border of the window: functions of a cell may reach into the next one.
const SAFE: u32 = 1;

/// Index of a cell along each axis.
pub type Cell<const D: usize> = [u32; D];

/// A box `[min, max]` cut into equal cells, `D` axes.
///
/// Along one axis the edges are `min + (max - min) i / n`; a point on an inner edge belongs to the cell on
/// its right, and the last cell is closed on both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<T, const D: usize> {
    min: SVector<T, D>,
    max: SVector<T, D>,
    cells: [usize; D],
    cell_size: SVector<T, D>,
    inverse_cell_size: SVector<T, D>,
    /// Rounding of a coordinate within a cell and of the cell's edges, in cell sizes.
    doubt: SVector<T, D>,
    window: Window<D>,
}

impl<T: Scalar, const D: usize> Grid<T, D> {
    /// A grid over `[min, max]` (m) with `cells` cells along each axis.
    ///
    /// # Errors
    /// If a bound is not finite, `max <= min`, an axis has no cell, or there are 2^32 - 1 cells or more.
    pub fn new(min: SVector<T, D>, max: SVector<T, D>, cells: [usize; D]) -> Result<Self, GridError> {
        for axis in 0..D {
            let (low, high) = (min[axis], max[axis]);
            if !low.is_finite() || !high.is_finite() {
                return Err(GridError::NotFinite { axis });
            }
            if high <= low {
                return Err(GridError::Empty {
                    axis,
                    min: low.primal(),
                    max: high.primal(),
                });
            }
            if cells[axis] == 0 {
                return Err(GridError::NoCells { axis });
            }
        }
        let total = cells.iter().try_fold(1_usize, |n, &c| n.checked_mul(c));
        if total.is_none_or(|n| n >= u32::MAX as usize) {
            return Err(GridError::TooManyCells);
        }
        let cell_size = SVector::from_fn(|a, _| (max[a] - min[a]) / T::count(cells[a]));
        // Of a coordinate `(x - min) / h - i` the difference and the product round, and of `1 / h` the
        // difference and both quotients, by half an epsilon each; of an edge `min + (max - min) i / n` the
        // difference, the product and the quotient: eight halves of n epsilons in all. The sum rounds an edge
        // by half an epsilon of where it is.
        let doubt = SVector::from_fn(|a, _| {
            let reach = (min[a].abs() + max[a].abs()) / cell_size[a];
            T::default_epsilon() * (T::lit(4.0) * T::count(cells[a]) + reach)
        });
        Ok(Self {
            min,
            max,
            cells,
            cell_size,
            // Not n over the extent, which rounds less: patches of cells have theirs from their size, and are
            // compared with whole ones.
            inverse_cell_size: cell_size.map(|h| T::one() / h),
            doubt,
            window: Window::whole(cells),
        })
    }

    /// Lower corner (m).
    pub fn min(&self) -> &SVector<T, D> {
        &self.min
    }

    /// Upper corner (m).
    pub fn max(&self) -> &SVector<T, D> {
        &self.max
    }

    /// Cells along each axis.
    pub fn cells(&self) -> [usize; D] {
        self.cells
    }

    /// The cells that have numbers: all of them, unless told otherwise.
    #[inline(always)]
    pub fn window(&self) -> &Window<D> {
        &self.window
    }

    /// Gives numbers to the cells of `window` only, as much of it as lies in the grid. What is kept for each
    /// cell, or each DOF, then grows with the window and not with the grid. In one dimension all keep theirs.
    #[must_use]
    pub fn with_window(mut self, window: Window<D>) -> Self {
        if const { D > 1 } {
            self.window = window.within(self.cells);
        }
        self
    }

    /// Whether `cell`, and `margin` cells around it as far as the grid goes, have numbers.
    pub fn has_numbers(&self, cell: &Cell<D>, margin: u32) -> bool {
        self.window.holds(cell, margin, self.cells)
    }

    /// Number of cells that have numbers.
    pub fn cell_count(&self) -> usize {
        self.window.shape().iter().product()
    }

    /// The cells along an axis that have numbers, in the first line of the window.
    pub fn line(&self, axis: usize) -> impl Iterator<Item = Cell<D>> + use<T, D> {
        let (first, count) = (self.window.first(), self.window.shape()[axis]);
        (0..count as u32).map(move |i| {
            let mut cell = first;
            cell[axis] += i;
            cell
        })
    }

    /// Size `h` of a cell along each axis (m).
    #[inline(always)]
    pub fn cell_size(&self) -> &SVector<T, D> {
        &self.cell_size
    }

    /// `1 / h` along each axis (1/m).
    #[inline(always)]
    pub fn inverse_cell_size(&self) -> &SVector<T, D> {
        &self.inverse_cell_size
    }

    /// Volume of a cell (1-D: m, 2-D: m2, 3-D: m3).
    #[inline(always)]
    pub fn cell_volume(&self) -> T {
        self.cell_size.iter().fold(T::one(), |v, &h| v * h)
    }

    /// Position (m) of edge `i` along an axis, `0 <= i <= cells`.
    #[inline(always)]
    pub fn edge(&self, axis: usize, i: usize) -> T {
        if i == self.cells[axis] {
            return self.max[axis];
        }
        let extent = self.max[axis] - self.min[axis];
        self.min[axis] + extent * T::count(i) / T::count(self.cells[axis])
    }

    /// Centre of a cell (m).
    #[inline(always)]
    pub fn centre(&self, cell: &Cell<D>) -> SVector<T, D> {
        let half = T::one() / T::lit(2.0);
        SVector::from_fn(|a, _| self.min[a] + (T::lit(f64::from(cell[a])) + half) * self.cell_size[a])
    }

    /// The cell that holds `x`, `None` outside the grid (or if `x` is not a number).
    #[inline]
    pub fn locate(&self, x: &SVector<T, D>) -> Option<Cell<D>> {
        let mut cell = [0; D];
        for axis in 0..D {
            cell[axis] = self.locate_on_axis(axis, x[axis])?;
        }
        Some(cell)
    }

    /// Whether `x` lies in `cell`, and so far from its edges that no rounding can matter: the common case, at
    /// a fraction of the cost of [`Grid::locate`].
    #[inline(always)]
    pub fn strictly_contains(&self, cell: &Cell<D>, x: &SVector<T, D>) -> bool {
        (0..D).all(|axis| {
            let unit = self.unit_coordinate(axis, cell[axis], x[axis]);
            let doubt = self.doubt[axis];
            unit > doubt && unit < T::one() - doubt
        })
    }

    /// The same of four points of which lane by lane `x` are the coordinates along each axis: whether the
    /// cell clearly holds all.
    #[inline(always)]
    pub(crate) fn strictly_contains_all<K: Packs<T, N>, const N: usize>(
        &self,
        k: K,
        cell: &Cell<D>,
        x: &[K::V; D],
    ) -> bool {
        for axis in 0..D {
            let index = k.splat(T::lit(f64::from(cell[axis])));
            let unit = (x[axis] - k.splat(self.min[axis])) * k.splat(self.inverse_cell_size[axis]) - index;
            let doubt = self.doubt[axis];
            if !k.are_between(unit, k.splat(doubt), k.splat(T::one() - doubt)) {
                return false;
            }
        }
        true
    }

    /// Whether all that a particle of `cell` may see has numbers.
    #[inline(always)]
    pub(crate) fn is_safe(&self, cell: &Cell<D>) -> bool {
        D == 1 || self.has_numbers(cell, SAFE)
    }

    /// Moves `x` a few roundings off an inner edge of its `cell`. Just there functions vanish whose slopes do
    /// not: a DOF that nothing else reaches would have no mass, hence no velocity, and yet strain the
    /// particle.
    pub(crate) fn nudge_off_edges(&self, cell: &Cell<D>, x: &mut SVector<T, D>) {
        for axis in 0..D {
            let (i, gap) = (cell[axis] as usize, self.doubt[axis] * self.cell_size[axis]);
            if i > 0 {
                x[axis] = x[axis].max(self.edge(axis, i) + gap);
            }
            if i + 1 < self.cells[axis] {
                x[axis] = x[axis].min(self.edge(axis, i + 1) - gap);
            }
        }
    }

    /// The point of `cell` nearest to `x`. A few roundings are kept from the upper edge, which belongs to the
    /// next cell.
    #[inline]
    pub fn nearest_within(&self, cell: &Cell<D>, x: &SVector<T, D>) -> SVector<T, D> {
        SVector::from_fn(|axis, _| {
            let i = cell[axis] as usize;
            let (low, high) = (self.edge(axis, i), self.edge(axis, i + 1));
            let last = high - self.doubt[axis] * self.cell_size[axis];
            x[axis].min(last).max(low)
        })
    }

    #[inline]
    fn locate_on_axis(&self, axis: usize, x: T) -> Option<u32> {
        let (low, high) = (self.min[axis], self.max[axis]);
        if !(x >= low && x <= high) {
            return None;
        }
        let last = self.cells[axis] - 1;
        // The value part alone decides: a dual number has no floor.
        let scaled = ((x - low) * self.inverse_cell_size[axis]).primal();
        let mut i = (scaled as usize).min(last);
        // Rounding of the quotient may put a point at an edge into the neighbour.
        if i < last && x >= self.edge(axis, i + 1) {
            i += 1;
        } else if i > 0 && x < self.edge(axis, i) {
            i -= 1;
        }
        Some(i as u32)
    }

    /// Number of a cell of the window, axis 0 fastest.
    #[inline(always)]
    pub fn linear(&self, cell: &Cell<D>) -> usize {
        self.window.number(cell)
    }

    /// The cell with number `index`: the inverse of [`Grid::linear`].
    #[inline(always)]
    pub fn cell(&self, index: usize) -> Cell<D> {
        self.window.cell(index)
    }

    /// Coordinate of `x` within its cell along an axis: 0 at the left edge, 1 at the right one.
    #[inline(always)]
    pub fn unit_coordinate(&self, axis: usize, cell: u32, x: T) -> T {
        (x - self.min[axis]) * self.inverse_cell_size[axis] - T::lit(f64::from(cell))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::vector;

    #[test]
    fn a_point_on_an_inner_edge_belongs_to_the_right_cell_and_the_last_cell_is_closed() {
        for n in [1, 3, 7, 10, 40, 49] {
            let grid = Grid::new(vector![0.0], vector![1.0], [n]).unwrap();
            for i in 0..n {
                assert_eq!(grid.locate(&vector![grid.edge(0, i)]), Some([i as u32]));
            }
            assert_eq!(grid.locate(&vector![1.0]), Some([n as u32 - 1]));
        }
    }

    /// Points on edges and one rounding unit beside them, also far from the origin.
    #[test]
    fn what_a_cell_clearly_holds_is_located_in_it() {
        for (min, max, n) in [
            (0.0, 1.0, 10),
            (-3.0, 0.1, 7),
            (1e6, 1e6 + 1.0, 13),
            (-1e-3, 1e3, 1000),
        ] {
            let grid = Grid::new(vector![min], vector![max], [n]).unwrap();
            let mut clear = 0;
            for i in 0..=n {
                let edge: f64 = grid.edge(0, i);
                let middle = edge + 0.4 * (max - min) / n as f64;
                for x in [edge.next_down(), edge, edge.next_up(), middle] {
                    for cell in [i.saturating_sub(1), i.min(n - 1)].map(|c| [c as u32]) {
                        if grid.strictly_contains(&cell, &vector![x]) {
                            clear += 1;
                            assert_eq!(grid.locate(&vector![x]), Some(cell), "{min} {max} {n}: {x}");
                        }
                    }
                }
            }
            assert!(clear >= n, "the middles are clear");
        }
    }

    /// Single precision with so many cells that a cell has a few hundred numbers: one of ten may be in doubt,
    /// not more.
    #[test]
    fn little_is_in_doubt_with_many_cells_in_single_precision() {
        for (min, max, n) in [
            (0.0_f32, 1.0, 62_500),
            (0.0, 1.0, 30_011),
            (-0.3, 0.9, 50_000),
            (7.0, 9.0, 10_007),
        ] {
            let grid = Grid::new(vector![min], vector![max], [n]).unwrap();
            let (mut clear, mut all) = (0, 0);
            for i in (97..n).step_by(97) {
                let (mut x, high) = (
                    grid.edge(0, i).next_down().next_down().max(min),
                    grid.edge(0, i + 1),
                );
                while x < high {
                    let found = grid.locate(&vector![x]).unwrap();
                    for cell in [i.saturating_sub(1), i, (i + 1).min(n - 1)].map(|c| [c as u32]) {
                        let holds = grid.strictly_contains(&cell, &vector![x]);
                        assert!(!holds || found == cell, "{min} {max} {n}: {x}");
                    }
                    clear += usize::from(grid.strictly_contains(&found, &vector![x]));
                    all += 1;
                    x = x.next_up();
                }
            }
            assert!(10 * clear >= 9 * all, "{min} {max} {n}: {clear} of {all}");
        }
    }

    #[test]
    fn the_nearest_point_of_a_cell_is_in_the_cell() {
        for (min, max, n) in [(0.0, 1.0, 10), (-3.0, 0.1, 7), (1e6, 1e6 + 1.0, 13)] {
            let grid = Grid::new(vector![min], vector![max], [n]).unwrap();
            for i in 0..n {
                let cell = [i as u32];
                let (low, high): (f64, f64) = (grid.edge(0, i), grid.edge(0, i + 1));
                for x in [
                    f64::NEG_INFINITY,
                    low,
                    (low + high) / 2.0,
                    high,
                    f64::MAX,
                    f64::NAN,
                ] {
                    let near = grid.nearest_within(&cell, &vector![x]);
                    assert_eq!(grid.locate(&near), Some(cell), "{x}");
                    let moved = (near[0] - x.clamp(low, high)).abs();
                    assert!(x.is_nan() || moved <= 1e-6 * (high - low), "{x}: {near}");
                }
            }
        }
    }

    #[test]
    fn a_point_outside_or_not_a_number_has_no_cell() {
        let grid = Grid::new(vector![-1.0, 0.0], vector![1.0, 2.0], [4, 5]).unwrap();
        for x in [vector![-1.1, 1.0], vector![0.0, 2.1], vector![f64::NAN, 1.0]] {
            assert_eq!(grid.locate(&x), None);
        }
    }

    #[test]
    fn cell_numbers_invert() {
        let grid = Grid::new(vector![0.0, 0.0, 0.0], vector![1.0, 2.0, 3.0], [2, 3, 4]).unwrap();
        for i in 0..grid.cell_count() {
            assert_eq!(grid.linear(&grid.cell(i)), i);
        }
    }

    #[test]
    fn bad_bounds_are_refused() {
        assert!(Grid::new(vector![0.0], vector![0.0], [1]).is_err());
        assert!(Grid::new(vector![0.0], vector![f64::NAN], [1]).is_err());
        assert!(Grid::new(vector![0.0], vector![1.0], [0]).is_err());
        assert!(Grid::new(vector![0.0, 0.0], vector![1.0, 1.0], [1 << 40, 1 << 40]).is_err());
    }
}
