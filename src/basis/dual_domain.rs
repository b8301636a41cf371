//! Dual domain: linear values, smoothed gradients.

use std::ops::Range;

use nalgebra::SVector;

use super::tensor::{self, AxisBasis, AxisCell, Factors, Functions, Row, axis_cell, factors_of};
use super::{BasisFamily, FixedPoints, Linear};
use crate::grid::{Cell, Grid};
use crate::particles::Bins;
use crate::scalar::Scalar;
use crate::simd::{Lanes, Number, One, each};

/// Dual domain basis (Zhang, Ma & Giguere 2011, journal section 3.3): values of the linear hats, smoothed
/// gradients
///
/// $$\overline{\nabla\phi_i} = \alpha\nabla\phi_i + (1-\alpha)\widetilde{\nabla\phi_i},\quad
/// \widetilde{\nabla\phi_i}(x) = \sum_j \frac{\phi_j(x)}{V_j}\int\phi_j\nabla\phi_i,\quad
/// V_j = \int\phi_j,\quad \alpha = 2\sum_i\phi_i\phi_{i+1}.$$
///
/// $\alpha$ vanishes at cell edges, so the gradient is continuous there and reaches one cell further than the
/// value. Node $j$'s smoothed slope of a nodal field is the central difference, at the ends of the domain the
/// one-sided one (there both the integral and $V_j$ are halved). The domain of the integrals is the cells
/// that hold particles: at a free surface inside the grid a node beyond it moves with nothing, and a central
/// difference over it would be no slope. Beyond one dimension the gradient along an axis takes this slope
/// along that axis and linear values along the others.
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DualDomain {
    /// For each cell its neighbours that are missing, see [`side`]; empty if every cell of the grid counts.
    missing: Vec<u8>,
}

/// Bit of a cell's neighbour: below or above it along an axis.
fn side(axis: usize, above: bool) -> u8 {
    1 << (2 * axis + usize::from(above))
}

/// Whether a cell lacks its neighbours along an axis: below it, above it.
#[inline(always)]
fn ends(missing: u8, axis: usize) -> [bool; 2] {
    [missing & side(axis, false) != 0, missing & side(axis, true) != 0]
}

impl DualDomain {
    /// On a grid whose every cell counts, until [`BasisFamily::take_in`] says which do.
    pub fn new() -> Self {
        Self::default()
    }

    /// The neighbours that the cell lacks.
    #[inline(always)]
    fn missing<T: Scalar, const D: usize>(&self, grid: &Grid<T, D>, cell: &Cell<D>) -> u8 {
        match self.missing.get(grid.linear(cell)) {
            Some(&missing) => missing,
            None => (0..D).fold(0, |bits, axis| {
                let last = cell[axis] as usize + 1 == grid.cells()[axis];
                let below = if cell[axis] == 0 { side(axis, false) } else { 0 };
                let above = if last { side(axis, true) } else { 0 };
                bits | below | above
            }),
        }
    }

    /// The functions along each axis at a point.
    #[inline(always)]
    fn rows<T: Scalar, const D: usize>(
        &self,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        x: &SVector<T, D>,
    ) -> [Row<T, 4>; D] {
        let missing = self.missing(grid, cell);
        each(|axis| {
            let at = axis_cell(grid, cell, axis);
            let unit = grid.unit_coordinate(axis, cell[axis], x[axis]);
            (first_node(at), functions(One, at, unit, ends(missing, axis)))
        })
    }
}

/// Values and slopes of the nodes `first_dof(at)` to `first_dof(at) + 3` in a cell; `ends` says on which
/// sides the domain ends there.
#[inline(always)]
fn functions<T: Scalar, K: Lanes<T>>(k: K, at: AxisCell, unit: K::V, ends: [bool; 2]) -> Functions<K::V, 4> {
    let (zero, one) = (k.splat(T::zero()), k.splat(T::one()));
    let half = k.splat(T::one() / T::lit(2.0));
    let (left, right) = (one - unit, unit);
    let alpha = (left + left) * right;
    let smooth_left = (one - alpha) * left;
    let smooth_right = (one - alpha) * right;
    // Slopes of the four nodes cell - 1 ... cell + 2.
    let mut slope = [zero, zero - alpha, alpha, zero];
    if ends[0] {
        slope[1] = slope[1] - smooth_left;
        slope[2] = slope[2] + smooth_left;
    } else {
        slope[0] = slope[0] - smooth_left * half;
        slope[2] = smooth_left.mul_add(half, slope[2]);
    }
    if ends[1] {
        slope[1] = slope[1] - smooth_right;
        slope[2] = slope[2] + smooth_right;
    } else {
        slope[1] = slope[1] - smooth_right * half;
        slope[3] = smooth_right.mul_add(half, slope[3]);
    }
    let value = [zero, left, right, zero];
    // At an end of the grid the four nodes begin at another place, and those left over have a zero.
    match at.cell - first_node(at) {
        0 => Functions {
            value: [left, right, zero, zero],
            slope: [slope[1], slope[2], slope[3], zero],
        },
        1 => Functions { value, slope },
        _ => Functions {
            value: [zero, zero, left, right],
            slope: [zero, slope[0], slope[1], slope[2]],
        },
    }
}

/// The first of the four nodes: the one before the cell's own two, or the first or fourth last of the grid.
#[inline(always)]
fn first_node(at: AxisCell) -> usize {
    at.cell.min((at.cells + 1).saturating_sub(3)).saturating_sub(1)
}

impl<T: Scalar> AxisBasis<T, 4> for DualDomain {
    fn dofs_on_axis(&self, cells: usize) -> usize {
        cells + 1
    }

    /// On an axis whose every cell counts.
    #[inline(always)]
    fn evaluate<K: Lanes<T>>(&self, k: K, at: AxisCell, unit: K::V) -> Functions<K::V, 4> {
        functions(k, at, unit, [at.cell == 0, at.cell + 1 == at.cells])
    }

    #[inline(always)]
    fn first_dof(&self, at: AxisCell) -> usize {
        first_node(at)
    }
}

impl<T: Scalar, const D: usize> BasisFamily<T, D> for DualDomain {
    const WIDTH: usize = 4;
    const TAKES_IN_CELLS: bool = true;
    const AT_FIXED_POINTS: FixedPoints = FixedPoints::Linear;
    const FOLLOWS_WINDOW: bool = true;

    fn take_in(&mut self, grid: &Grid<T, D>, bins: &Bins<D>) {
        self.missing.clear();
        self.missing.resize(grid.cell_count(), 0);
        let cells = grid.cells();
        let empty = |cell: &Cell<D>| bins.particles_in(grid.linear(cell)).is_empty();
        for &number in bins.occupied() {
            let cell = grid.cell(number as usize);
            for axis in 0..D {
                let (mut below, mut above) = (cell, cell);
                above[axis] += 1;
                let last = above[axis] as usize == cells[axis];
                below[axis] = cell[axis].saturating_sub(1);
                if cell[axis] == 0 || empty(&below) {
                    self.missing[number as usize] |= side(axis, false);
                }
                if last || empty(&above) {
                    self.missing[number as usize] |= side(axis, true);
                }
            }
        }
    }

    fn bytes(&self) -> usize {
        self.missing.capacity()
    }

    fn degree(&self) -> usize {
        1
    }

    fn dofs(&self, grid: &Grid<T, D>) -> [usize; D] {
        tensor::dofs::<T, D, 4, _>(self, grid)
    }

    fn dof_window(&self, grid: &Grid<T, D>, first: &Cell<D>, last: &Cell<D>) -> Range<usize> {
        // The four nodes of a cell at an end lie otherwise about it than those of others, so their numbers do
        // not grow with its own. That of its lowest node does, and they reach at most two below it and three
        // above along each axis.
        let (lowest, shape) = (grid.window().first(), grid.window().shape());
        let (mut first_node, mut last_node, mut step, mut stride) = (0, 0, 0, 1);
        for axis in 0..D {
            first_node += (first[axis] - lowest[axis]) as usize * stride;
            last_node += (last[axis] - lowest[axis]) as usize * stride;
            step += stride;
            stride *= shape[axis] + 1;
        }
        first_node.saturating_sub(2 * step)..(last_node + 3 * step + 1).min(stride)
    }

    #[inline(always)]
    fn for_each(
        &self,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        x: &SVector<T, D>,
        f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        let dofs = tensor::dofs::<T, D, 4, _>(self, grid);
        tensor::product_of_rows(grid, &self.rows(grid, cell, x), dofs, f);
    }

    #[inline(always)]
    fn factors<K: Lanes<T>>(
        &self,
        k: K,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        unit: &[K::V; D],
    ) -> Factors<K::V, D> {
        let missing = self.missing(grid, cell);
        factors_of(
            k,
            #[inline(always)]
            |axis| functions(k, axis_cell(grid, cell, axis), unit[axis], ends(missing, axis)),
        )
    }

    #[inline(always)]
    fn first_dofs(&self, grid: &Grid<T, D>, cell: &Cell<D>) -> [usize; D] {
        tensor::first_dofs(self, grid, cell)
    }

    /// Gauss points stand still, so nothing crosses there: the plain gradient is the accurate one.
    #[inline(always)]
    fn for_each_at_fixed_point(
        &self,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        x: &SVector<T, D>,
        f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        Linear.for_each(grid, cell, x, f);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Window;
    use nalgebra::vector;

    /// A linear field whose nodes beyond the surface have not moved: its slope at every particle is still its
    /// slope.
    #[test]
    fn a_node_beyond_the_last_particle_has_no_part_in_the_slope() {
        let grid = Grid::new(vector![0.0], vector![5.0], [5]).unwrap();
        let x = [0.5, 1.5, 2.2, 2.9].map(|x| vector![x]);
        let bins = Bins::new(&grid, &x).unwrap();
        let mut family = DualDomain::new();
        family.take_in(&grid, &bins);
        let field = [0.0, 1.0, 2.0, 3.0, 0.0, 0.0];
        for (p, x) in x.iter().enumerate() {
            let mut slope = 0.0;
            family.for_each(&grid, bins.cell_of(p), x, |i, _, gradient| {
                slope += field[i] * gradient[0];
            });
            assert!((slope - 1.0_f64).abs() < 1e-14, "{x}: {slope}");
        }
    }

    /// The DOFs are those of the grid's window, in which the particles' cells keep away from the border.
    #[test]
    fn so_it_does_in_a_window_of_the_grid() {
        let grid = Grid::new(vector![0.0, 0.0], vector![90.0, 80.0], [90, 80]).unwrap();
        let grid = grid.with_window(Window::around(&[[30, 50], [37, 54]]));
        let family = DualDomain::new();
        let inner = |cell: &Cell<2>| grid.has_numbers(cell, 1);
        let cells: Vec<_> = (0..40).map(|number| grid.cell(number)).filter(inner).collect();
        for (k, first) in cells.iter().enumerate() {
            for (m, last) in cells.iter().enumerate().skip(k) {
                let window = family.dof_window(&grid, first, last);
                assert!(window.end <= 9 * 6);
                for cell in &cells[k..=m] {
                    family.for_each(&grid, cell, &grid.centre(cell), |dof, _, _| {
                        assert!(window.contains(&dof), "{first:?} to {last:?}: {dof} of {cell:?}");
                    });
                }
            }
        }
    }

    /// The last cells of the row before the last one see more than the first ones of the last row.
    #[test]
    fn a_window_holds_the_dofs_of_every_cell_between() {
        let grid = Grid::new(vector![0.0, 0.0], vector![5.0, 4.0], [5, 4]).unwrap();
        let corner = [vector![0.5, 0.5], vector![1.5, 0.5], vector![0.5, 1.5]];
        let bins = Bins::new(&grid, &corner).unwrap();
        let mut part = DualDomain::new();
        part.take_in(&grid, &bins);
        for family in [DualDomain::new(), part] {
            for (first, last) in (0..20).flat_map(|first| (first..20).map(move |last| (first, last))) {
                let window = family.dof_window(&grid, &grid.cell(first), &grid.cell(last));
                assert!(window.end <= 30);
                for cell in (first..=last).map(|number| grid.cell(number)) {
                    family.for_each(&grid, &cell, &grid.centre(&cell), |dof, _, _| {
                        assert!(window.contains(&dof), "{first} to {last}: {dof} of {cell:?}");
                    });
                }
            }
        }
    }
}
