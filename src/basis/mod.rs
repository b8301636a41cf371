//! Basis families: which degrees of freedom (DOFs) a point sees, with value and gradient.
//!
//! Every family here is a tensor product of one-axis families ([`AxisBasis`]); a family of your own either
//! does the same in a few lines (see `examples/own_basis.rs`) or implements [`BasisFamily`] directly. A
//! family may average its functions over the particles' domains ([`Domain`], `examples/gimp.rs`).

mod bspline;
mod domain;
mod dual_domain;
mod interpolant;
mod linear;
pub mod tensor;

pub use bspline::BSpline;
pub use domain::Domain;
pub use dual_domain::DualDomain;
pub use interpolant::Interpolant;
pub(crate) use interpolant::{shifts_along, steps_from};
pub use linear::Linear;
pub(crate) use tensor::MOST_WIDTH;
pub use tensor::{AxisBasis, AxisCell, Factors, Functions};

use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use crate::grid::{Cell, Face, Grid, Side};
use crate::particles::Bins;
use crate::scalar::Scalar;
use crate::simd::Lanes;

/// What a family is at points that stand still, where nothing crosses from cell to cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FixedPoints {
    /// The same as at those that move; particles with a [`Domain`] are no points.
    Alike,
    /// [`Linear`] functions of the same DOFs, whose values are also those at points that move.
    Linear,
    /// Something else.
    Other,
}

/// A family of grid basis functions `phi_i` in `D` dimensions.
///
/// The DOFs form a lattice, axis 0 fastest. Implementors promise a partition of unity, non-negative values
/// that are continuous from cell to cell, gradients that sum to zero and compact support;
/// [`crate::testing::check_basis`] checks all of it.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no basis family for scalar `{T}` in `{D}` dimensions",
    note = "families: Linear, DualDomain, BSpline<1>, BSpline<2>, BSpline<3>, or your own `impl BasisFamily`"
)]
pub trait BasisFamily<T: Scalar, const D: usize>: Clone + Send + Sync {
    /// Whether [`BasisFamily::take_in`] does anything.
    const TAKES_IN_CELLS: bool = false;

    /// Takes in which cells hold particles, before a step; for families whose functions depend on where the
    /// material ends.
    fn take_in(&mut self, _grid: &Grid<T, D>, _bins: &Bins<D>) {
        const { assert!(!Self::TAKES_IN_CELLS, "TAKES_IN_CELLS wants an own `take_in`") };
    }

    /// Bytes allocated, for the user's information.
    fn bytes(&self) -> usize {
        0
    }

    /// Number of functions along each axis of a cell, if a cell's functions are the products of
    /// [`BasisFamily::factors`]: those of DOFs that follow each other along every axis, from
    /// [`BasisFamily::first_dofs`] on, the same in all cells that have as many cells on every side. Zero if
    /// they are not, or nobody has said so; four points of a cell are then not computed at once.
    const WIDTH: usize = 0;

    /// Whether the DOFs are those of the grid's [`Window`](crate::grid::Window), counted from its first one.
    /// A body in a grid that is much larger then takes memory in proportion to itself. Without it the window
    /// is always the whole grid.
    const FOLLOWS_WINDOW: bool = false;

    /// Whether every gradient is one constant in a cell, as that of linear functions along one axis: stresses
    /// of particles then change alike all over the cell.
    const CONSTANT_GRADIENT: bool = false;

    /// Whether DOFs besides those of [`BasisFamily::for_each_on_face`] have a value on a face, so that a wall
    /// there holds the material about only. A step refuses to hold a face where it finds such DOFs and nobody
    /// has said so.
    const HOLDS_ABOUT: bool = false;

    /// What the functions at a particle are averaged over. Other than [`Domain::Point`] it wants an own
    /// [`BasisFamily::for_each_over`] and, of a product over sizes, [`BasisFamily::factors_over`]; everything
    /// else of this trait is then asked of points, whose domain has vanished.
    const DOMAIN: Domain = Domain::Point;

    /// What [`BasisFamily::for_each_at_fixed_point`] visits.
    const AT_FIXED_POINTS: FixedPoints = FixedPoints::Alike;

    /// The functions of `cell` at several of its points, whose coordinates from 0 to 1 in the cell are
    /// `unit`. Only asked where [`BasisFamily::WIDTH`] is not zero.
    #[inline(always)]
    fn factors<K: Lanes<T>>(
        &self,
        k: K,
        _grid: &Grid<T, D>,
        _cell: &Cell<D>,
        _unit: &[K::V; D],
    ) -> Factors<K::V, D> {
        const { assert!(Self::WIDTH == 0, "WIDTH wants an own `factors`") };
        let nothing = [[k.splat(T::zero()); tensor::MOST_WIDTH]; D];
        Factors {
            value: nothing,
            slope: nothing,
        }
    }

    /// The same over particles of these half lengths along each axis, in cell sizes, whose centres are at
    /// `unit`. Only asked where [`BasisFamily::WIDTH`] is not zero and [`BasisFamily::DOMAIN`] is a size.
    #[inline(always)]
    fn factors_over<K: Lanes<T>>(
        &self,
        k: K,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        unit: &[K::V; D],
        _half: &[K::V; D],
    ) -> Factors<K::V, D> {
        const {
            assert!(
                Self::WIDTH == 0 || !matches!(Self::DOMAIN, Domain::Size { .. }),
                "DOMAIN and WIDTH want an own `factors_over`"
            )
        };
        self.factors(k, grid, cell, unit)
    }

    /// Number of a cell's first DOF along each axis, in the whole grid; likewise.
    #[inline(always)]
    fn first_dofs(&self, _grid: &Grid<T, D>, cell: &Cell<D>) -> [usize; D] {
        cell.map(|index| index as usize)
    }

    /// Polynomial degree that the values reproduce.
    fn degree(&self) -> usize;

    /// How far apart along an axis two DOFs can be whose values overlap; no less than [`BasisFamily::WIDTH`]
    /// less one. Unless told otherwise the least that the degree and the width allow.
    fn reach(&self) -> usize {
        self.degree().max(Self::WIDTH.saturating_sub(1))
    }

    /// Number of DOFs along each axis.
    fn dofs(&self, grid: &Grid<T, D>) -> [usize; D];

    /// Calls `f(dof, phi, grad phi)` (`grad phi` in 1/m) for every DOF whose value *or* gradient may be
    /// non-zero at the point `x` of `cell`. A DOF may come twice; its parts then add up.
    ///
    /// Every point of a cell must see the same DOFs in the same order: the step keeps the sums of a cell at
    /// hand while its particles pass.
    fn for_each(
        &self,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        x: &SVector<T, D>,
        f: impl FnMut(usize, T, SVector<T, D>),
    );

    /// The same over the `domain` of a particle with its centre at `x` of `cell`: half its edge vectors (m),
    /// one in each column, along the axes where sizes are asked for. Only asked where
    /// [`BasisFamily::DOMAIN`] is not that of points.
    ///
    /// The DOFs are those that [`BasisFamily::for_each`] visits in this cell, in the same order, whatever the
    /// domain.
    #[inline(always)]
    fn for_each_over(
        &self,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        x: &SVector<T, D>,
        _domain: &SMatrix<T, D, D>,
        f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        const {
            assert!(
                !Self::DOMAIN.is_asked_for(),
                "DOMAIN wants an own `for_each_over`"
            )
        };
        self.for_each(grid, cell, x, f);
    }

    /// The same for a quadrature point that stands still. Families that smooth their gradients against grid
    /// crossing (dual domain) give the plain ones here, since nothing crosses.
    #[inline(always)]
    fn for_each_at_fixed_point(
        &self,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        x: &SVector<T, D>,
        f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        const {
            assert!(
                matches!(Self::AT_FIXED_POINTS, FixedPoints::Alike),
                "AT_FIXED_POINTS wants an own `for_each_at_fixed_point`"
            )
        };
        self.for_each(grid, cell, x, f);
    }

    /// DOFs among which are all that points in the cells with numbers from that of `first` to that of `last`
    /// see. The fewer, the better can threads share the particles; every DOF unless told otherwise.
    fn dof_window(&self, grid: &Grid<T, D>, _first: &Cell<D>, _last: &Cell<D>) -> Range<usize> {
        0..self.dof_count(grid)
    }

    /// Where (m) the value that belongs to a DOF is taken when a field is interpolated ([`Interpolant`]): the
    /// node, or the Greville abscissa of a spline. Unless told otherwise the points are spread evenly along
    /// each axis.
    fn interpolation_point(&self, grid: &Grid<T, D>, mut dof: usize) -> SVector<T, D> {
        let shape = self.dofs(grid);
        SVector::from_fn(|axis, _| {
            let along = dof % shape[axis];
            dof /= shape[axis];
            let intervals = shape[axis].saturating_sub(1).max(1);
            let whole = grid.max()[axis] - grid.min()[axis];
            grid.min()[axis] + whole * (T::count(along) / T::count(intervals))
        })
    }

    /// Total number of DOFs.
    fn dof_count(&self, grid: &Grid<T, D>) -> usize {
        self.dofs(grid).iter().product()
    }

    /// Largest difference of the numbers of two DOFs whose values overlap: the half band width of a mass
    /// matrix.
    fn half_band(&self, grid: &Grid<T, D>) -> usize {
        let dofs = self.dofs(grid);
        let mut stride = 1;
        let mut reach = 0;
        for count in dofs {
            reach += self.reach().min(count - 1) * stride;
            stride *= count;
        }
        reach
    }

    /// Calls `f` for every DOF that a wall at a face of the grid holds, each once and in ascending order. No
    /// other DOF has a value on the face, unless [`BasisFamily::HOLDS_ABOUT`]. Unless told otherwise the
    /// outermost DOF of each line: right where that one interpolates.
    fn for_each_on_face(&self, grid: &Grid<T, D>, face: Face, mut f: impl FnMut(usize)) {
        let dofs = self.dofs(grid);
        let (first, shape) = (grid.window().first()[face.axis], grid.window().shape()[face.axis]);
        let (reaches, wanted) = match face.side {
            Side::Min => (first == 0, 0),
            Side::Max => (
                first as usize + shape == grid.cells()[face.axis],
                dofs[face.axis] - 1,
            ),
        };
        if !reaches {
            return;
        }
        let stride: usize = dofs[..face.axis].iter().product();
        for dof in 0..self.dof_count(grid) {
            if dof / stride % dofs[face.axis] == wanted {
                f(dof);
            }
        }
    }
}

/// What constants of a family ask of each other; evaluated where a stepper is made.
pub(crate) const fn constants_agree<T: Scalar, const D: usize, B: BasisFamily<T, D>>() {
    assert!(
        B::WIDTH <= MOST_WIDTH,
        "WIDTH is at most `basis::tensor::MOST_WIDTH`"
    );
    assert!(
        B::WIDTH == 0 || !matches!(B::DOMAIN, Domain::Edges),
        "functions over edge vectors are no products along the axes: WIDTH is zero"
    );
}
