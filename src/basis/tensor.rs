//! Tensor products of one-axis families.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use super::{BasisFamily, Domain};
use crate::grid::{Cell, Face, Grid, Side};
use crate::scalar::Scalar;
use crate::simd::{Lanes, One, each};

/// Most functions along an axis of a cell that can be computed for several points at once.
pub const MOST_WIDTH: usize = 4;

/// Values and slopes (by the coordinate in cell sizes) of a cell's functions along each axis, at several
/// points of the cell: the factors of which the functions are products. Entries beyond the family's width
/// mean nothing.
#[derive(Clone, Copy, Debug)]
pub struct Factors<V, const D: usize> {
    /// Values of each axis's functions.
    pub value: [[V; MOST_WIDTH]; D],
    /// Their derivatives.
    pub slope: [[V; MOST_WIDTH]; D],
}

/// A cell of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisCell {
    /// Cells of the axis.
    pub cells: usize,
    /// Number of this one.
    pub cell: usize,
}

/// The `W` functions of a cell of an axis at several of its points.
#[derive(Clone, Copy, Debug)]
pub struct Functions<V, const W: usize> {
    /// Values.
    pub value: [V; W],
    /// Derivatives by the coordinate in cell sizes (multiply by `1/h`).
    pub slope: [V; W],
}

/// A basis of one axis that has `n` cells of size one: `W` functions a cell, those of DOFs that follow each
/// other.
///
/// Cells that have `W` or more cells on both sides have the same functions. One evaluation, generic in the
/// packs of numbers that it computes with, serves single points and several points of a cell at once.
pub trait AxisBasis<T: Scalar, const W: usize>: Send + Sync {
    /// Number of DOFs on an axis of `cells` cells.
    fn dofs_on_axis(&self, cells: usize) -> usize;

    /// Values and slopes of the cell's functions at points whose coordinates are `unit`: 0 at the cell's
    /// lower edge, 1 at its upper one. A function that a cell lacks is zero.
    fn evaluate<K: Lanes<T>>(&self, k: K, at: AxisCell, unit: K::V) -> Functions<K::V, W>;

    /// The first of the cell's DOFs; unless told otherwise that with the cell's own number.
    #[inline(always)]
    fn first_dof(&self, at: AxisCell) -> usize {
        at.cell
    }

    /// Whether particles have a size over which the functions are averaged, see [`BasisFamily::DOMAIN`].
    const DOMAIN: Domain = Domain::Point;

    /// The same over particles whose half length is `half`, in cell sizes, with their centres at `unit`. Only
    /// asked where [`AxisBasis::DOMAIN`] is a size.
    #[inline(always)]
    fn evaluate_over<K: Lanes<T>>(&self, k: K, at: AxisCell, unit: K::V, _half: K::V) -> Functions<K::V, W> {
        const {
            assert!(
                !Self::DOMAIN.is_asked_for(),
                "DOMAIN wants an own `evaluate_over`"
            )
        };
        self.evaluate(k, at, unit)
    }

    /// Whether a wall at an end is held about only, see [`BasisFamily::HOLDS_ABOUT`].
    const HOLDS_ABOUT: bool = false;

    /// The DOFs that a wall at an end of the axis holds. Unless told otherwise those that have a value there:
    /// material at the wall then moves exactly as told. Where that is not one DOF alone, more is held than
    /// the wall: strain there too, which costs an order of accuracy, so a family whose ends interpolate is
    /// better at walls.
    fn dofs_at_end(&self, cells: usize, side: Side) -> Range<usize> {
        let (cell, unit) = match side {
            Side::Min => (0, T::zero()),
            Side::Max => (cells.saturating_sub(1), T::one()),
        };
        let at = AxisCell { cells, cell };
        let (first, values) = (self.first_dof(at), self.evaluate(One, at, unit).value);
        let felt = |value: &T| !value.is_zero();
        let low = values.iter().position(felt).unwrap_or(0);
        let high = values.iter().rposition(felt).map_or(low, |k| k + 1);
        first + low..first + high
    }

    /// Where, in cell sizes from the axis's lower end, the value that belongs to `dof` is taken when a field
    /// is interpolated: the node, or the Greville abscissa of a spline. Unless told otherwise the points are
    /// spread evenly.
    fn interpolation_point(&self, cells: usize, dof: usize) -> T {
        let intervals = self.dofs_on_axis(cells).saturating_sub(1).max(1);
        T::count(dof) * T::count(cells) / T::count(intervals)
    }
}

/// [`BasisFamily::WIDTH`] of a product of bases that have so many functions a cell.
pub const fn width_in_packs(width: usize) -> usize {
    if width <= MOST_WIDTH { width } else { 0 }
}

/// The cell of an axis.
#[inline(always)]
pub fn axis_cell<T: Scalar, const D: usize>(grid: &Grid<T, D>, cell: &Cell<D>, axis: usize) -> AxisCell {
    AxisCell {
        cells: grid.cells()[axis],
        cell: cell[axis] as usize,
    }
}

/// The factors along each axis at the points of `cell` with the coordinates `unit`.
#[inline(always)]
pub fn factors<T: Scalar, const D: usize, const W: usize, A: AxisBasis<T, W>, K: Lanes<T>>(
    family: &A,
    k: K,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    unit: &[K::V; D],
) -> Factors<K::V, D> {
    factors_of(
        k,
        #[inline(always)]
        |axis| family.evaluate(k, axis_cell(grid, cell, axis), unit[axis]),
    )
}

/// The same over particles of the half lengths `half`, in cell sizes.
#[inline(always)]
pub fn factors_over<T: Scalar, const D: usize, const W: usize, A: AxisBasis<T, W>, K: Lanes<T>>(
    family: &A,
    k: K,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    unit: &[K::V; D],
    half: &[K::V; D],
) -> Factors<K::V, D> {
    factors_of(
        k,
        #[inline(always)]
        |axis| family.evaluate_over(k, axis_cell(grid, cell, axis), unit[axis], half[axis]),
    )
}

/// The factors of the functions of each axis.
#[inline(always)]
pub(crate) fn factors_of<T: Scalar, const D: usize, const W: usize, K: Lanes<T>>(
    k: K,
    functions: impl Fn(usize) -> Functions<K::V, W>,
) -> Factors<K::V, D> {
    let zero = k.splat(T::zero());
    let mut factors = Factors {
        value: [[zero; MOST_WIDTH]; D],
        slope: [[zero; MOST_WIDTH]; D],
    };
    for axis in 0..D {
        let Functions { value, slope } = functions(axis);
        // Copies of slices or iterators over the packs go through memory: measured at a fifth to three
        // quarters of the speed of a whole step.
        for k in 0..W.min(MOST_WIDTH) {
            factors.value[axis][k] = value[k];
            factors.slope[axis][k] = slope[k];
        }
    }
    factors
}

/// The first DOF of a cell along each axis.
#[inline(always)]
pub fn first_dofs<T: Scalar, const D: usize, const W: usize, A: AxisBasis<T, W>>(
    family: &A,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
) -> [usize; D] {
    each(
        #[inline(always)]
        |axis| family.first_dof(axis_cell(grid, cell, axis)),
    )
}

/// Point of `dof` in the product of `family` with itself.
pub fn interpolation_point<T: Scalar, const D: usize, const W: usize, A: AxisBasis<T, W>>(
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
#[inline(always)]
pub fn dofs<T: Scalar, const D: usize, const W: usize, A: AxisBasis<T, W>>(
    family: &A,
    grid: &Grid<T, D>,
) -> [usize; D] {
    let shape = grid.window().shape();
    each(|axis| family.dofs_on_axis(shape[axis]))
}

/// DOFs that points in the cells with numbers from that of `first` to that of `last` see. Along each axis the
/// numbers of the DOFs of a cell do not fall as its own grows. So none has lower ones than the first cell or
/// one of those that begin a row, layer and so on after it, and none higher ones than the last cell or one
/// that ends a row or layer before it: where the stencil of an end cell lies on one side of it, those do.
pub fn dof_window<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    family: &B,
    grid: &Grid<T, D>,
    first: &Cell<D>,
    last: &Cell<D>,
) -> Range<usize> {
    let (mut low, mut high) = (usize::MAX, 0);
    let mut see = |cell: &Cell<D>| {
        family.for_each(grid, cell, &grid.centre(cell), |dof, _, _| {
            low = low.min(dof);
            high = high.max(dof + 1);
        });
    };
    see(first);
    see(last);
    let (lowest, shape) = (grid.window().first(), grid.window().shape());
    let between = grid.linear(first)..=grid.linear(last);
    for axis in 1..D {
        let (mut begin, mut end) = (*first, *last);
        begin[axis] += 1;
        end[axis] = end[axis].saturating_sub(1);
        for below in 0..axis {
            begin[below] = lowest[below];
            end[below] = lowest[below] + shape[below] as u32 - 1;
        }
        for cell in [begin, end] {
            let inside =
                (cell[axis] as usize) < lowest[axis] as usize + shape[axis] && cell[axis] >= lowest[axis];
            if inside && between.contains(&grid.linear(&cell)) {
                see(&cell);
            }
        }
    }
    low..high
}

/// Visits the DOFs that a wall at `face` holds, of those in the grid's window.
pub fn for_each_on_face<T: Scalar, const D: usize, const W: usize, A: AxisBasis<T, W>>(
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
pub fn for_each<T: Scalar, const D: usize, const W: usize, A: AxisBasis<T, W>>(
    family: &A,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
    f: impl FnMut(usize, T, SVector<T, D>),
) {
    product_of_rows(grid, &rows(family, grid, cell, x), dofs(family, grid), f);
}

/// Here and not in [`for_each`]: what is written there is compiled for everything that is done with DOFs.
#[inline(always)]
fn rows<T: Scalar, const D: usize, const W: usize, A: AxisBasis<T, W>>(
    family: &A,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
) -> [Row<T, W>; D] {
    each(|axis| {
        let at = axis_cell(grid, cell, axis);
        let unit = grid.unit_coordinate(axis, cell[axis], x[axis]);
        (family.first_dof(at), family.evaluate(One, at, unit))
    })
}

/// The same over the size of a particle, half its edge vectors.
#[inline(always)]
pub fn for_each_over<T: Scalar, const D: usize, const W: usize, A: AxisBasis<T, W>>(
    family: &A,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
    domain: &SMatrix<T, D, D>,
    f: impl FnMut(usize, T, SVector<T, D>),
) {
    const {
        assert!(
            !matches!(A::DOMAIN, Domain::Edges),
            "an axis has sizes, no edge vectors: implement `BasisFamily`"
        )
    };
    let inverse = grid.inverse_cell_size();
    let rows = each(
        #[inline(always)]
        |axis| {
            let at = axis_cell(grid, cell, axis);
            let unit = grid.unit_coordinate(axis, cell[axis], x[axis]);
            let half = domain[(axis, axis)] * inverse[axis];
            (family.first_dof(at), family.evaluate_over(One, at, unit, half))
        },
    );
    product_of_rows(grid, &rows, dofs(family, grid), f);
}

/// The functions of a cell of an axis at one point, after the first of their DOFs.
pub(crate) type Row<T, const W: usize> = (usize, Functions<T, W>);

/// Visits the products of `rows`, one an axis, on a lattice of so many DOFs along each axis.
#[inline(always)]
pub(crate) fn product_of_rows<T: Scalar, const D: usize, const W: usize>(
    grid: &Grid<T, D>,
    rows: &[Row<T, W>; D],
    dofs: [usize; D],
    mut f: impl FnMut(usize, T, SVector<T, D>),
) {
    let inverse = grid.inverse_cell_size();
    let lattice = (grid.window().first(), dofs);
    if const { D == 1 } {
        let (dof, functions) = &rows[0];
        for k in 0..W {
            let slope = SVector::repeat(functions.slope[k] * inverse[0]);
            f(along(&lattice, 0, dof + k), functions.value[k], slope);
        }
        return;
    }
    let mut k = [0; D];
    loop {
        let (dof, value, gradient) = product(&lattice, rows, &k, inverse);
        f(dof, value, gradient);
        if !advance(&mut k, W) {
            return;
        }
    }
}

/// Place of a DOF among those of the window along an axis. On a grid with fewer DOFs than a cell has
/// functions those left over repeat the last one, with nothing; so does the first one for functions that
/// begin before the window, which have nothing where particles are.
#[inline(always)]
fn along<const D: usize>((first, shape): &(Cell<D>, [usize; D]), axis: usize, dof: usize) -> usize {
    dof.saturating_sub(first[axis] as usize).min(shape[axis] - 1)
}

#[inline(always)]
fn product<T: Scalar, const D: usize, const W: usize>(
    lattice: &(Cell<D>, [usize; D]),
    rows: &[Row<T, W>; D],
    k: &[usize; D],
    inverse: &SVector<T, D>,
) -> (usize, T, SVector<T, D>) {
    let shape = &lattice.1;
    let (mut dof, mut value) = (0, T::one());
    for axis in (0..D).rev() {
        let (start, functions) = &rows[axis];
        dof = dof * shape[axis] + along(lattice, axis, start + k[axis]);
        value *= functions.value[k[axis]];
    }
    let gradient = SVector::from_fn(|a, _| {
        (0..D).fold(inverse[a], |g, axis| {
            let (_, functions) = &rows[axis];
            g * if axis == a {
                functions.slope[k[axis]]
            } else {
                functions.value[k[axis]]
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

/// Makes a one-axis family a [`BasisFamily`](crate::basis::BasisFamily) in every dimension, by its tensor
/// product.
///
/// `width` is the `W` of its [`AxisBasis`], `degree` that of the polynomials which its values reproduce;
/// `at_fixed_points` names the family whose functions points that stand still see, if it is another one.
#[macro_export]
macro_rules! tensor_product_family {
    ($family:ty, width = $width:literal, degree = $degree:literal $(, at_fixed_points = $plain:expr)?) => {
        impl<T: $crate::scalar::Scalar, const D: usize> $crate::basis::BasisFamily<T, D> for $family {
            const WIDTH: usize = $crate::basis::tensor::width_in_packs($width);

            const FOLLOWS_WINDOW: bool = true;

            const CONSTANT_GRADIENT: bool = D == 1 && $degree == 1 && $width == 2;

            const HOLDS_ABOUT: bool =
                <$family as $crate::basis::AxisBasis<T, $width>>::HOLDS_ABOUT;

            const DOMAIN: $crate::basis::Domain =
                <$family as $crate::basis::AxisBasis<T, $width>>::DOMAIN;

            #[inline(always)]
            fn factors<K: $crate::simd::Lanes<T>>(
                &self,
                k: K,
                grid: &$crate::grid::Grid<T, D>,
                cell: &$crate::grid::Cell<D>,
                unit: &[K::V; D],
            ) -> $crate::basis::tensor::Factors<K::V, D> {
                $crate::basis::tensor::factors::<T, D, $width, _, K>(self, k, grid, cell, unit)
            }

            #[inline(always)]
            fn factors_over<K: $crate::simd::Lanes<T>>(
                &self,
                k: K,
                grid: &$crate::grid::Grid<T, D>,
                cell: &$crate::grid::Cell<D>,
                unit: &[K::V; D],
                half: &[K::V; D],
            ) -> $crate::basis::tensor::Factors<K::V, D> {
                $crate::basis::tensor::factors_over::<T, D, $width, _, K>(self, k, grid, cell, unit, half)
            }

            #[inline(always)]
            fn first_dofs(
                &self,
                grid: &$crate::grid::Grid<T, D>,
                cell: &$crate::grid::Cell<D>,
            ) -> [usize; D] {
                $crate::basis::tensor::first_dofs::<T, D, $width, _>(self, grid, cell)
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

            #[inline(always)]
            fn for_each_over(
                &self,
                grid: &$crate::grid::Grid<T, D>,
                cell: &$crate::grid::Cell<D>,
                x: &::nalgebra::SVector<T, D>,
                domain: &::nalgebra::SMatrix<T, D, D>,
                f: impl FnMut(usize, T, ::nalgebra::SVector<T, D>),
            ) {
                $crate::basis::tensor::for_each_over::<T, D, $width, _>(self, grid, cell, x, domain, f);
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
