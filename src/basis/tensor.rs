//! Tensor products of one-axis families.

use std::ops::Range;

use nalgebra::SVector;

use super::BasisFamily;
use crate::grid::{Cell, Face, Grid, Side};
use crate::lanes::SideBySide;
use crate::scalar::Scalar;

/// Most functions along an axis of a cell that can be computed for several points at once.
pub const MOST_WIDTH: usize = 4;

/// Values and slopes (by the coordinate in cell sizes) of a cell's functions along each axis, at several points of the cell:
/// the factors of which the functions are products. Entries beyond the family's width mean nothing.
#[derive(Clone, Copy, Debug)]
pub struct Factors<V, const D: usize> {
    /// Values of each axis's functions.
    pub value: [[V; MOST_WIDTH]; D],
    /// Their derivatives.
    pub slope: [[V; MOST_WIDTH]; D],
}

/// The `W` DOFs that one point of an axis sees.
#[derive(Clone, Copy, Debug)]
pub struct Row<T, const W: usize> {
    /// DOF along the axis.
    pub dof: [usize; W],
    /// Value of its function.
    pub value: [T; W],
    /// Derivative of its function by the coordinate in cell sizes (multiply by `1/h`).
    pub slope: [T; W],
}

/// A family of functions of one axis that has `n` cells of size 1; at most `W` functions per cell.
pub trait AxisFamily<T: Scalar, const W: usize> {
    /// Number of DOFs on an axis of `cells` cells.
    fn dofs_on_axis(&self, cells: usize) -> usize;

    /// Values and slopes in `cell` at `unit` (0 at the cell's left edge, 1 at its right one). Where fewer
    /// than `W` functions exist, the spare entries repeat a DOF with zero value and slope.
    fn row(&self, cells: usize, cell: usize, unit: T) -> Row<T, W>;

    /// Whether the DOFs of cell `i` are `i, i + 1, ... i + W - 1` everywhere, and the functions of all cells that have `W` or more
    /// cells on both sides the same. Then, in two and three dimensions, a step computes with four particles of a cell, or with
    /// four cells, at once.
    const UNIFORM: bool = false;

    /// Values and slopes of [`AxisFamily::row`] at several points of a cell; only asked where [`AxisFamily::UNIFORM`].
    /// Unless told otherwise one point after the other.
    #[inline(always)]
    fn lanes<V: SideBySide<T>>(&self, cells: usize, cell: usize, unit: V) -> ([V; W], [V; W]) {
        one_by_one(self, cells, cell, unit)
    }

    /// Whether a wall at an end is held about only, see [`BasisFamily::HOLDS_ABOUT`].
    const HOLDS_ABOUT: bool = false;

    /// The DOFs that a wall at an end of the axis holds. Unless told otherwise those that have a value there:
    /// material at the wall then moves exactly as told. Where that is not one DOF alone, more is held than
    /// the wall: strain there too, which costs an order of accuracy, so a family whose ends interpolate is
    /// better at walls.
    fn dofs_at_end(&self, cells: usize, side: Side) -> Range<usize> {
        let row = match side {
            Side::Min => self.row(cells, 0, T::zero()),
            Side::Max => self.row(cells, cells.saturating_sub(1), T::one()),
        };
        let felt = row
            .dof
            .iter()
            .zip(&row.value)
            .filter(|(_, value)| !value.is_zero());
        let (first, end) = felt.fold((usize::MAX, 0), |(first, end), (&dof, _)| {
            (first.min(dof), end.max(dof + 1))
        });
        first.min(end)..end
    }

    /// Where, in cell sizes from the axis's lower end, the value that belongs to `dof` is taken when a field is interpolated:
    /// the node, or the Greville abscissa of a spline. Unless told otherwise the points are spread evenly.
    fn interpolation_point(&self, cells: usize, dof: usize) -> T {
        let intervals = self.dofs_on_axis(cells).saturating_sub(1).max(1);
        T::count(dof) * T::count(cells) / T::count(intervals)
    }
}

/// Whether the DOFs of a cell follow from its index alone, see [`BasisFamily::FOLLOWS_WINDOW`].
pub const fn follows_window<T: Scalar, const W: usize, A: AxisFamily<T, W>>() -> bool {
    A::UNIFORM
}

/// [`BasisFamily::WIDTH`] of the product of a family with itself.
pub const fn width_in_lanes<T: Scalar, const W: usize, A: AxisFamily<T, W>>() -> usize {
    if A::UNIFORM && W <= MOST_WIDTH { W } else { 0 }
}

/// [`AxisFamily::lanes`] by way of [`AxisFamily::row`]. Out of the way of the cells that need it not.
#[inline(never)]
pub fn one_by_one<T: Scalar, const W: usize, A: AxisFamily<T, W> + ?Sized, V: SideBySide<T>>(
    family: &A,
    cells: usize,
    cell: usize,
    unit: V,
) -> ([V; W], [V; W]) {
    let [value, slope] = unit.one_by_one(|unit| {
        let row = family.row(cells, cell, unit);
        [row.value, row.slope]
    });
    (value, slope)
}

/// The factors along each axis at the points of `cell` with the coordinates `unit`.
#[inline(always)]
pub fn factors<T: Scalar, const D: usize, const W: usize, A: AxisFamily<T, W>, V: SideBySide<T>>(
    family: &A,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    unit: &[V; D],
) -> Factors<V, D> {
    let (cells, zero) = (grid.cells(), V::splat(T::zero()));
    let mut factors = Factors {
        value: [[zero; MOST_WIDTH]; D],
        slope: [[zero; MOST_WIDTH]; D],
    };
    for axis in 0..D {
        let (value, slope) = family.lanes(cells[axis], cell[axis] as usize, unit[axis]);
        // Copies of slices or iterators over the packs go through memory: measured at a fifth to three quarters of the speed of a
        // whole step.
        #[allow(clippy::manual_memcpy)]
        for k in 0..W.min(MOST_WIDTH) {
            factors.value[axis][k] = value[k];
            factors.slope[axis][k] = slope[k];
        }
    }
    factors
}

/// Point of `dof` in the product of `family` with itself.
pub fn interpolation_point<T: Scalar, const D: usize, const W: usize, A: AxisFamily<T, W>>(
    family: &A,
    grid: &Grid<T, D>,
    mut dof: usize,
) -> SVector<T, D> {
    let (shape, cells, first) = (dofs(family, grid), grid.cells(), grid.window().first());
    SVector::from_fn(|axis, _| {
        let along = first[axis] as usize + dof % shape[axis];
        dof /= shape[axis];
        let whole = grid.max()[axis] - grid.min()[axis];
        let point = family.interpolation_point(cells[axis], along);
        grid.min()[axis] + whole * (point / T::count(cells[axis]))
    })
}

/// DOFs along each axis of the product of `family` with itself, in the grid's window.
pub fn dofs<T: Scalar, const D: usize, const W: usize, A: AxisFamily<T, W>>(
    family: &A,
    grid: &Grid<T, D>,
) -> [usize; D] {
    grid.window().shape().map(|cells| family.dofs_on_axis(cells))
}

/// DOFs that points in the cells with numbers from that of `first` to that of `last` see: the numbers of the DOFs of a cell
/// grow with its own.
pub fn dof_window<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    family: &B,
    grid: &Grid<T, D>,
    first: &Cell<D>,
    last: &Cell<D>,
) -> Range<usize> {
    let (mut low, mut high) = (usize::MAX, 0);
    for cell in [first, last] {
        family.for_each(grid, cell, &grid.centre(cell), |dof, _, _| {
            low = low.min(dof);
            high = high.max(dof + 1);
        });
    }
    low..high
}

/// Visits the DOFs that a wall at `face` holds, of those in the grid's window.
pub fn for_each_on_face<T: Scalar, const D: usize, const W: usize, A: AxisFamily<T, W>>(
    family: &A,
    grid: &Grid<T, D>,
    face: Face,
    mut f: impl FnMut(usize),
) {
    let shape = dofs(family, grid);
    let held = family.dofs_at_end(grid.cells()[face.axis], face.side);
    let first = grid.window().first()[face.axis] as usize;
    let stride: usize = shape[..face.axis].iter().product();
    for dof in 0..shape.iter().product() {
        if held.contains(&(first + dof / stride % shape[face.axis])) {
            f(dof);
        }
    }
}

/// Visits the product functions at `x`: values multiply, a gradient takes the slope along its own axis.
#[inline(always)]
pub fn for_each<T: Scalar, const D: usize, const W: usize, A: AxisFamily<T, W>>(
    family: &A,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
    f: impl FnMut(usize, T, SVector<T, D>),
) {
    let cells = grid.cells();
    let rows = std::array::from_fn(|axis| {
        let unit = grid.unit_coordinate(axis, cell[axis], x[axis]);
        family.row(cells[axis], cell[axis] as usize, unit)
    });
    product_of_rows(grid, &rows, |cells| family.dofs_on_axis(cells), f);
}

/// Visits the products of `rows`, one per axis, on a lattice of `dofs(cells)` DOFs along an axis of so many cells.
#[inline(always)]
pub fn product_of_rows<T: Scalar, const D: usize, const W: usize>(
    grid: &Grid<T, D>,
    rows: &[Row<T, W>; D],
    dofs: impl Fn(usize) -> usize,
    mut f: impl FnMut(usize, T, SVector<T, D>),
) {
    let inverse = grid.inverse_cell_size();
    if D == 1 {
        for k in 0..W {
            let slope = SVector::repeat(rows[0].slope[k] * inverse[0]);
            f(rows[0].dof[k], rows[0].value[k], slope);
        }
        return;
    }
    let lattice = (grid.window().first(), grid.window().shape().map(dofs));
    let mut k = [0; D];
    loop {
        let (dof, value, gradient) = product(&lattice, rows, &k, inverse);
        f(dof, value, gradient);
        if !advance(&mut k, W) {
            return;
        }
    }
}

#[inline(always)]
fn product<T: Scalar, const D: usize, const W: usize>(
    (first, shape): &(Cell<D>, [usize; D]),
    rows: &[Row<T, W>; D],
    k: &[usize; D],
    inverse: &SVector<T, D>,
) -> (usize, T, SVector<T, D>) {
    let (mut dof, mut value) = (0, T::one());
    for axis in (0..D).rev() {
        dof = dof * shape[axis] + rows[axis].dof[k[axis]] - first[axis] as usize;
        value *= rows[axis].value[k[axis]];
    }
    let gradient = SVector::from_fn(|a, _| {
        (0..D).fold(inverse[a], |g, axis| {
            let row = &rows[axis];
            g * if axis == a {
                row.slope[k[axis]]
            } else {
                row.value[k[axis]]
            }
        })
    });
    (dof, value, gradient)
}

/// Counts `k` up in base `width`; false after the last combination.
#[inline(always)]
pub(crate) fn advance<const D: usize>(k: &mut [usize; D], width: usize) -> bool {
    for digit in k.iter_mut() {
        *digit += 1;
        if *digit < width {
            return true;
        }
        *digit = 0;
    }
    false
}

/// Makes a one-axis family a [`BasisFamily`](crate::basis::BasisFamily) in every dimension, by its tensor product.
///
/// `width` is the `W` of its [`AxisFamily`], `degree` that of the polynomials which its values reproduce; `at_fixed_points` names the family whose
/// functions points that stand still see, if it is another one.
#[macro_export]
macro_rules! tensor_product_family {
    ($family:ty, width = $width:literal, degree = $degree:literal $(, at_fixed_points = $plain:expr)?) => {
        impl<T: $crate::scalar::Scalar, const D: usize> $crate::basis::BasisFamily<T, D> for $family {
            const WIDTH: usize =
                $crate::basis::tensor::width_in_lanes::<T, $width, $family>();

            const FOLLOWS_WINDOW: bool =
                $crate::basis::tensor::follows_window::<T, $width, $family>();

            const CONSTANT_GRADIENT: bool = D == 1 && $degree == 1 && $width == 2;

            const HOLDS_ABOUT: bool =
                <$family as $crate::basis::AxisFamily<T, $width>>::HOLDS_ABOUT;

            #[inline(always)]
            fn factors<V: $crate::lanes::SideBySide<T>>(
                &self,
                grid: &$crate::grid::Grid<T, D>,
                cell: &$crate::grid::Cell<D>,
                unit: &[V; D],
            ) -> $crate::basis::tensor::Factors<V, D> {
                $crate::basis::tensor::factors::<T, D, $width, _, V>(self, grid, cell, unit)
            }

            fn degree(&self) -> usize {
                $degree
            }

            fn reach(&self) -> usize {
                $width - 1
            }

            fn dofs(&self, grid: &$crate::grid::Grid<T, D>) -> [usize; D] {
                $crate::basis::tensor::dofs::<T, D, $width, _>(self, grid)
            }

            fn for_each_on_face(
                &self,
                grid: &$crate::grid::Grid<T, D>,
                face: $crate::grid::Face,
                f: impl FnMut(usize),
            ) {
                $crate::basis::tensor::for_each_on_face::<T, D, $width, _>(self, grid, face, f);
            }

            fn interpolation_point(
                &self,
                grid: &$crate::grid::Grid<T, D>,
                dof: usize,
            ) -> ::nalgebra::SVector<T, D> {
                $crate::basis::tensor::interpolation_point::<T, D, $width, _>(self, grid, dof)
            }

            #[inline(always)]
            fn for_each(
                &self,
                grid: &$crate::grid::Grid<T, D>,
                cell: &$crate::grid::Cell<D>,
                x: &::nalgebra::SVector<T, D>,
                f: impl FnMut(usize, T, ::nalgebra::SVector<T, D>),
            ) {
                $crate::basis::tensor::for_each::<T, D, $width, _>(self, grid, cell, x, f);
            }

            fn dof_window(
                &self,
                grid: &$crate::grid::Grid<T, D>,
                first: &$crate::grid::Cell<D>,
                last: &$crate::grid::Cell<D>,
            ) -> ::std::ops::Range<usize> {
                $crate::basis::tensor::dof_window(self, grid, first, last)
            }

            $(
                const AT_FIXED_POINTS: $crate::basis::FixedPoints =
                    $crate::basis::FixedPoints::Other;

                #[inline(always)]
                fn for_each_at_fixed_point(
                    &self,
                    grid: &$crate::grid::Grid<T, D>,
                    cell: &$crate::grid::Cell<D>,
                    x: &::nalgebra::SVector<T, D>,
                    f: impl FnMut(usize, T, ::nalgebra::SVector<T, D>),
                ) {
                    $crate::basis::BasisFamily::for_each(&$plain, grid, cell, x, f);
                }
            )?
        }
    };
}
