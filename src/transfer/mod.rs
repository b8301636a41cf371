//! Between particles and grid: how velocities are transferred ([`Transfer`]), and the sweeps.
//!
//! A sweep is written once, generic in the packs that it computes with (`simd`), in the basis and in
//! what particles add to the DOFs or take from them (`Contribution`, `Kick`): it serves one phase and
//! two, plain particles and the points of fits, four particles of a cell in the lanes or four cells. It knows
//! no law and no phase. Packs are chosen once a span, at run time.
//!
//! | | |
//! |---|---|
//! | `p2g` | `m_i = sum_p m_p phi_i(x_p)`, forces, momenta: what a `Contribution` says |
//! | `kick` | G2P of accelerations, then P2G of the new momenta in the same sweep |
//! | `drift` | G2P of velocities and their gradients: positions, and what laws are asked for |
//! | `gather` | G2P of velocities with their moments, for transfers from the grid |
//! | `fits` | P2G from polynomials fitted in each cell, by `polynomials` where it can |
//! | `scalars` | G2P of a scalar field and of its gradient |
//! | `pairs` | the consistent mass matrix |
//!
//! Functions are products along the axes, so sums run along axis 0 first, for each *row* of a cell's DOFs,
//! and then over the rows (`rows`). What a group adds to DOFs stays in lanes while particles of its cell
//! come, and longer where the next cell is the neighbour along axis 0 (`sums`). A basis that is no product is
//! asked for its functions point by point, with a single number in the place of a pack. Where it averages
//! them over the domains of particles ([`Domain`]), it is given these too.
//!
//! A group that is not full repeats its last particle without mass and volume. Groups depend on the
//! particles' order and on where spans begin, not on threads.

mod cell_sums;
mod drift;
mod fits;
mod flip;
mod gather;
mod group;
mod kick;
mod lines;
mod p2g;
mod pairs;
mod places;
mod polynomials;
mod rows;
mod scalars;
mod sites;
mod stencil;
mod sums;

pub(crate) use drift::{Drift, Outcome, drift};
pub(crate) use fits::{Fits, Integrand, MOST_POINTS, MassesAndMomenta, Stress, components_of};
pub(crate) use flip::constants_agree;
pub use flip::{Flip, GridVelocity, Transfer};
pub(crate) use gather::{Receive, Seen, gather};
pub(crate) use group::Group;
pub(crate) use kick::{Kick, Momentum, kick};
pub(crate) use p2g::{Contribution, Parts, Sum, p2g};
pub(crate) use pairs::{sum_pairs, sums_apply};
pub(crate) use places::DofPlaces;
pub(crate) use scalars::{ScalarField, g2p};
pub(crate) use sites::Sites;
pub(crate) use stencil::{Here, Look, Seer, Stencil, look_up};

use nalgebra::SVector;

use crate::basis::{BasisFamily, Domain, Factors, FixedPoints};
use crate::grid::{Cell, Grid};
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::simd::{Lanes, Packs, each, packs_serve};

/// Whether a basis is a product, so that several points of a cell can be computed at once.
pub(crate) const fn in_packs<T: Scalar, const D: usize, B: BasisFamily<T, D>>() -> bool {
    B::WIDTH > 0
}

/// Whether fits can be integrated over four cells at a time.
pub(crate) const fn fit<T: Scalar, const D: usize, B: BasisFamily<T, D>, R: Reconstruction<T, D>>() -> bool {
    R::BATCHED
        && match B::AT_FIXED_POINTS {
            FixedPoints::Alike => in_packs::<T, D, B>(),
            FixedPoints::Linear => true,
            FixedPoints::Other => false,
        }
}

/// What all groups of a sweep share.
pub(crate) struct Sweep<'a, T, const D: usize, B> {
    basis: &'a B,
    grid: &'a Grid<T, D>,
    /// Difference of the numbers of neighbouring DOFs along each axis.
    strides: [usize; D],
    /// What the numbers of the DOFs are less in the grid's window.
    before: usize,
    /// Whether each axis has as many DOFs as a cell has functions along it.
    is_wide_enough: bool,
}

impl<T: Copy, const D: usize, B> Clone for Sweep<'_, T, D, B> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Copy, const D: usize, B> Copy for Sweep<'_, T, D, B> {}

impl<'a, T: Scalar, const D: usize, B: BasisFamily<T, D>> Sweep<'a, T, D, B> {
    pub(crate) fn new(basis: &'a B, grid: &'a Grid<T, D>) -> Self {
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
            is_wide_enough: dofs.iter().min().is_some_and(|&count| count >= B::WIDTH),
        }
    }

    /// Whether several points of a cell are computed at once.
    #[inline(always)]
    fn is_in_packs(&self) -> bool {
        self.is_wide_enough && const { in_packs::<T, D, B>() } && packs_serve::<T>()
    }

    /// Coordinates in `cell`, from 0 to 1.
    #[inline(always)]
    fn unit<K: Lanes<T>>(&self, k: K, cell: &Cell<D>, x: &[K::V; D]) -> [K::V; D] {
        let inverse = self.grid.inverse_cell_size();
        each(
            #[inline(always)]
            |a| {
                let index = k.splat(T::lit(f64::from(cell[a])));
                (x[a] - k.splat(self.grid.min()[a])) * k.splat(inverse[a]) - index
            },
        )
    }

    /// The functions at the particles of a group, which are at `x` and whose domains have these half lengths.
    #[inline(always)]
    fn factors<const FULL: bool, K: Packs<T, N>, const N: usize>(
        &self,
        k: K,
        group: Group<N>,
        (cell, x): (&Cell<D>, &[K::V; D]),
        half_lengths: &[SVector<T, D>],
    ) -> Factors<K::V, D> {
        let unit = self.unit(k, cell, x);
        if const { matches!(B::DOMAIN, Domain::Size { .. }) } {
            let (half, inverse) = (group.vectors::<FULL, T, K, D>(k, half_lengths), self.inverse(k));
            let half: [K::V; D] = each(
                #[inline(always)]
                |a| half[a] * inverse[a],
            );
            return self.basis.factors_over(k, self.grid, cell, &unit, &half);
        }
        self.basis.factors(k, self.grid, cell, &unit)
    }

    /// One over the cell sizes.
    #[inline(always)]
    fn inverse<K: Lanes<T>>(&self, k: K) -> [K::V; D] {
        let inverse = self.grid.inverse_cell_size();
        each(
            #[inline(always)]
            |a| k.splat(inverse[a]),
        )
    }
}

/// Calls `$sweep` with the functions that a basis has at points that stand still. Their values are those at
/// points that move too unless [`FixedPoints::Other`].
macro_rules! at_fixed_points {
    ($basis:ty, $value:expr, |$fixed:ident| $sweep:expr) => {
        if const { matches!(<$basis>::AT_FIXED_POINTS, $crate::basis::FixedPoints::Linear) } {
            let $fixed = &$crate::basis::Linear;
            $sweep
        } else {
            match $value {
                $fixed => $sweep,
            }
        }
    };
}
pub(crate) use at_fixed_points;

/// The same for values alone, at particles: those over domains are others than at points.
macro_rules! for_values {
    ($basis:ty, $value:expr, |$fixed:ident| $sweep:expr) => {
        if const { <$basis>::DOMAIN.is_asked_for() } {
            match $value {
                $fixed => $sweep,
            }
        } else {
            $crate::transfer::at_fixed_points!($basis, $value, |$fixed| $sweep)
        }
    };
}
pub(crate) use for_values;
