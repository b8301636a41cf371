//! The box that a cell's fit covers: the cell, or what a body's surface leaves of it.

use nalgebra::SVector;

use crate::grid::{Cell, Grid, Side};
use crate::scalar::Scalar;

/// Where a body's surface cuts through a cell, perpendicular to axis 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut<T> {
    /// Number of the cell.
    pub cell: u32,
    /// Side of the body on which its surface lies.
    pub side: Side,
    /// Coordinate (m) of the surface along axis 0.
    pub position: T,
}

/// A box within a cell, over which particle data are fitted and integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch<T, const D: usize> {
    /// The cell.
    pub cell: Cell<D>,
    /// Centre (m).
    pub centre: SVector<T, D>,
    /// Half of the extent (m).
    pub half: SVector<T, D>,
    /// One over it (1/m).
    pub inverse_half: SVector<T, D>,
}

impl<T: Scalar, const D: usize> Patch<T, D> {
    /// The whole cell with number `cell`.
    #[inline(always)]
    pub fn whole(grid: &Grid<T, D>, cell: usize) -> Self {
        let cell = grid.cell(cell);
        let two = T::lit(2.0);
        Self {
            centre: grid.centre(&cell),
            half: grid.cell_size() / two,
            inverse_half: grid.inverse_cell_size() * two,
            cell,
        }
    }

    /// What `cuts` leave of the cell with number `cell`. Cuts that would leave nothing are not made: neither
    /// is where one body ends below the start of another.
    pub fn cut(grid: &Grid<T, D>, cell: usize, cuts: &[Cut<T>]) -> Self {
        let mut patch = Self::whole(grid, cell);
        let ends = [patch.centre[0] - patch.half[0], patch.centre[0] + patch.half[0]];
        let [mut low, mut high] = ends;
        for cut in cuts.iter().filter(|cut| cut.cell as usize == cell) {
            // Also refuses a surface that is not a number.
            match cut.side {
                Side::Min if cut.position < ends[1] => low = low.max(cut.position),
                Side::Max if cut.position > ends[0] => high = high.min(cut.position),
                Side::Min | Side::Max => {}
            }
        }
        let (two, half) = (T::lit(2.0), (high - low) / T::lit(2.0));
        if half > T::zero() && [low, high] != ends {
            patch.centre[0] = (low + high) / two;
            patch.half[0] = half;
            patch.inverse_half[0] = T::one() / half;
        }
        patch
    }

    /// Volume (1-D: m, 2-D: m2, 3-D: m3).
    #[inline(always)]
    pub fn volume(&self) -> T {
        self.half.iter().fold(T::one(), |v, &half| v * (half + half))
    }

    /// Local coordinates of `x`, each in `[-1, 1]` inside.
    #[inline(always)]
    pub fn local(&self, x: &SVector<T, D>) -> SVector<T, D> {
        (x - self.centre).component_mul(&self.inverse_half)
    }

    /// Position (m) of the local coordinates `s`.
    #[inline(always)]
    pub fn position(&self, s: &SVector<T, D>) -> SVector<T, D> {
        self.centre + self.half.component_mul(s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::vector;

    #[test]
    fn a_cut_ends_the_patch_at_the_surface_and_touches_no_other_cell() {
        let grid = Grid::new(vector![0.0], vector![2.0], [4]).unwrap();
        let cuts = [Cut {
            cell: 2,
            side: Side::Max,
            position: 1.2,
        }];
        let patch = Patch::cut(&grid, 2, &cuts);
        assert_relative_eq!(patch.volume(), 0.2, max_relative = 1e-14);
        assert_relative_eq!(patch.local(&vector![1.2])[0], 1.0, max_relative = 1e-14);
        assert_relative_eq!(patch.position(&vector![-1.0])[0], 1.0, max_relative = 1e-14);
        assert_eq!(Patch::cut(&grid, 1, &cuts), Patch::whole(&grid, 1));
    }

    /// Whichever is named first.
    #[test]
    fn two_bodies_that_end_in_a_cell_leave_it_whole() {
        let grid = Grid::new(vector![0.0], vector![2.0], [4]).unwrap();
        let cut = |side, position| Cut {
            cell: 2,
            side,
            position,
        };
        let cuts = [cut(Side::Max, 1.2), cut(Side::Min, 1.3)];
        for cuts in [cuts, [cuts[1], cuts[0]]] {
            assert_eq!(Patch::cut(&grid, 2, &cuts), Patch::whole(&grid, 2));
        }
        let part = Patch::cut(&grid, 2, &[cut(Side::Min, 1.1), cut(Side::Max, 1.2)]);
        assert_relative_eq!(part.volume(), 0.1, max_relative = 1e-14);
    }

    #[test]
    fn a_surface_outside_the_cell_or_not_a_number_leaves_it_whole() {
        let grid = Grid::new(vector![0.0], vector![2.0], [4]).unwrap();
        for position in [0.9, 1.0, 1.5, 1.7, f64::NAN] {
            let cut = Cut {
                cell: 2,
                side: Side::Max,
                position,
            };
            assert_eq!(Patch::cut(&grid, 2, &[cut]).volume(), 0.5, "{position}");
        }
    }
}
