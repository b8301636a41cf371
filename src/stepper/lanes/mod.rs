//! The passes over particles, four particles of a cell at a time.
//!
//! Everything is computed in [`Lanes`], one for each of up to four particles that follow each other in a cell ([`Group`]).
//! Functions are products along the axes, so sums run along axis 0 first, for each *row* of a cell's DOFs, and then over the
//! rows. What a group adds to DOFs stays in lanes while particles of its cell come, and longer where the next cell is the
//! neighbour along axis 0 ([`sums`]). One file per pass: `mass_and_force`, `velocity`, `advance`; `fits` has
//! four cells in the lanes.
//!
//! A group that is not full repeats its last particle without mass and volume. Groups depend on the particles' order and on
//! where spans begin, not on threads.

mod advance;
mod fits;
mod mass_and_force;
mod pairs;
mod rows;
mod sums;
mod velocity;

pub(super) use fits::{Fits, MOST_POINTS};
pub(super) use mass_and_force::Bodies;
pub(super) use velocity::Acceleration;

use nalgebra::{SMatrix, SVector};

use crate::basis::{BasisFamily, Factors, FixedPoints};
use crate::grid::{Cell, Grid};
use crate::lanes::{LANES, Lanes};
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;

/// Whether the passes go this way.
pub(super) const fn apply<T: Scalar, const D: usize, B: BasisFamily<T, D>>() -> bool {
    B::WIDTH > 0
}

/// Whether those go this way that want no gradients.
pub(super) const fn apply_to_values<T: Scalar, const D: usize, B: BasisFamily<T, D>>() -> bool {
    apply::<T, D, B>() || matches!(B::AT_FIXED_POINTS, FixedPoints::Linear)
}

/// Whether fits can be integrated over four cells at a time.
pub(super) const fn fit<T: Scalar, const D: usize, B: BasisFamily<T, D>, R: Reconstruction<T, D>>() -> bool {
    R::BY_FOUR
        && match B::AT_FIXED_POINTS {
            FixedPoints::Alike => apply::<T, D, B>(),
            FixedPoints::Linear => true,
            FixedPoints::Other => false,
        }
}

/// Particles of one cell that follow each other, at most [`LANES`].
#[derive(Clone, Copy)]
struct Group {
    first: usize,
    count: usize,
}

impl Group {
    /// The one that begins with particle `first`.
    #[inline(always)]
    fn at<const D: usize>(first: usize, cells: &[Cell<D>]) -> Self {
        let rest = &cells[first..];
        let count = match rest.first_chunk() {
            Some(four) if are_alike(four) => LANES,
            _ => {
                let alike = |cell: &&Cell<D>| **cell == rest[0];
                rest.iter().take(LANES).take_while(alike).count()
            }
        };
        Self { first, count }
    }

    /// [`LANES`] particles of one cell, the first of which is `first`, if there are so many.
    #[inline(always)]
    fn full_at<const D: usize>(first: usize, cells: &[Cell<D>]) -> Option<Self> {
        let four = cells.get(first..)?.first_chunk()?;
        are_alike(four).then_some(Self { first, count: LANES })
    }

    /// `make` of what an array says of the particle of each lane; the group must be full if `FULL`. It is asked in both branches,
    /// and not once of what they find: four numbers that follow each other are then one load.
    #[inline(always)]
    fn with<const FULL: bool, A: Copy, R>(self, values: &[A], make: impl Fn([A; LANES]) -> R) -> R {
        match values[self.first..].first_chunk() {
            Some(&lanes) if FULL || self.count == LANES => make(lanes),
            // Never: a full group is within its arrays.
            _ if FULL => make([values[self.first]; LANES]),
            _ => make(std::array::from_fn(|l| {
                values[self.first + l.min(self.count - 1)]
            })),
        }
    }

    /// A number of each particle, zero in spare lanes.
    #[inline(always)]
    fn amounts<const FULL: bool, T: Scalar, V: Lanes<T>>(self, values: &[T]) -> V {
        if FULL || self.count == LANES {
            return self.with::<FULL, _, _>(values, V::new);
        }
        V::new(std::array::from_fn(|l| {
            if l < self.count {
                values[self.first + l]
            } else {
                T::zero()
            }
        }))
    }

    /// The components of a vector.
    #[inline(always)]
    fn vectors<const FULL: bool, T: Scalar, V: Lanes<T>, const D: usize>(
        self,
        values: &[SVector<T, D>],
    ) -> [V; D] {
        self.with::<FULL, _, _>(values, |lanes| {
            std::array::from_fn(|a| V::new(std::array::from_fn(|l| lanes[l][a])))
        })
    }

    /// Gives each particle its lane of a vector.
    #[inline(always)]
    fn put<const FULL: bool, T: Scalar, V: Lanes<T>, const D: usize>(
        self,
        values: &mut [SVector<T, D>],
        vector: &[V; D],
    ) {
        let lanes = vector.map(V::array);
        let of_lane = |l: usize| SVector::from_fn(|c, _| lanes[c][l]);
        if FULL {
            let four = &mut values[self.first..self.first + LANES];
            for l in 0..LANES {
                four[l] = of_lane(l);
            }
            return;
        }
        match values[self.first..].first_chunk_mut() {
            Some(all) if self.count == LANES => *all = std::array::from_fn::<_, LANES, _>(of_lane),
            _ => {
                for l in 0..self.count {
                    values[self.first + l] = of_lane(l);
                }
            }
        }
    }
}

/// What a pass does with each group.
trait EachGroup {
    /// Takes in the next one, which is full if `FULL`.
    fn take<const FULL: bool>(&mut self, group: Group);
}

/// Calls [`EachGroup::take`] for the groups of the particles of the given cells. In one dimension, where a group takes as long as
/// the question whether it is full, full ones have a loop of their own that asks once.
#[inline(always)]
fn each_group<const D: usize>(cells: &[Cell<D>], pass: &mut impl EachGroup) {
    let mut p = 0;
    while p < cells.len() {
        if D == 1 {
            while let Some(group) = Group::full_at(p, cells) {
                pass.take::<true>(group);
                p += LANES;
            }
            if p >= cells.len() {
                return;
            }
        }
        let group = Group::at(p, cells);
        pass.take::<false>(group);
        p += group.count;
    }
}

/// Whether all are the same cell.
#[inline(always)]
fn are_alike<const D: usize>(cells: &[Cell<D>; LANES]) -> bool {
    let differ = |l: usize| (0..D).fold(0, |bits, axis| bits | (cells[l][axis] ^ cells[0][axis]));
    (1..LANES).fold(0, |bits, l| bits | differ(l)) == 0
}

/// Component `(c, a)` of the particles' tensors at `[c][a]`.
#[inline(always)]
fn tensors<T: Scalar, V: Lanes<T>, const D: usize>(lanes: &[SMatrix<T, D, D>; LANES]) -> [[V; D]; D] {
    std::array::from_fn(|c| std::array::from_fn(|a| V::new(std::array::from_fn(|l| lanes[l][(c, a)]))))
}

/// What all groups of a pass share.
#[derive(Clone, Copy)]
pub(super) struct Pass<'a, T, const D: usize, B> {
    basis: &'a B,
    grid: &'a Grid<T, D>,
    /// Difference of the numbers of neighbouring DOFs along each axis.
    strides: [usize; D],
    /// What the numbers of the DOFs are less in the grid's window.
    before: usize,
}

impl<'a, T: Scalar, const D: usize, B: BasisFamily<T, D>> Pass<'a, T, D, B> {
    pub(super) fn new(basis: &'a B, grid: &'a Grid<T, D>) -> Self {
        let dofs = basis.dofs(grid);
        let mut strides = [1; D];
        for axis in 1..D {
            strides[axis] = strides[axis - 1] * dofs[axis - 1];
        }
        let first = grid.window().first();
        Self {
            basis,
            grid,
            strides,
            before: (0..D).map(|axis| first[axis] as usize * strides[axis]).sum(),
        }
    }

    /// Coordinates in `cell`, from 0 to 1.
    #[inline(always)]
    fn unit<V: Lanes<T>>(&self, cell: &Cell<D>, x: &[V; D]) -> [V; D] {
        let inverse = self.grid.inverse_cell_size();
        std::array::from_fn(|a| {
            let index = V::splat(T::lit(f64::from(cell[a])));
            (x[a] - V::splat(self.grid.min()[a])) * V::splat(inverse[a]) - index
        })
    }

    #[inline(always)]
    fn factors<V: Lanes<T>>(&self, cell: &Cell<D>, x: &[V; D]) -> Factors<V, D> {
        self.basis.factors(self.grid, cell, &self.unit(cell, x))
    }
}

/// Calls `$method` of the pass over the functions that a basis has at fixed points; their values are those at points that move
/// too where [`apply_to_values`].
macro_rules! at_fixed_points {
    ($basis:ty, $value:expr, $grid:expr, $method:ident $(::<$map:literal>)? ( $($argument:expr),* $(,)? )) => {
        if const { matches!(<$basis>::AT_FIXED_POINTS, $crate::basis::FixedPoints::Linear) } {
            $crate::stepper::lanes::Pass::new(&$crate::basis::Linear, $grid).$method $(::<$map>)? ($($argument),*)
        } else {
            $crate::stepper::lanes::Pass::new($value, $grid).$method $(::<$map>)? ($($argument),*)
        }
    };
}
pub(super) use at_fixed_points;
