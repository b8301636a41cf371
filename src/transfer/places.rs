//! Where DOFs lie, and moments about a point.

use nalgebra::SVector;

use super::Sweep;
use crate::basis::{BasisFamily, Factors, places_along};
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;
use crate::simd::Lanes;

/// Places (m) of the DOFs along each axis, which form a lattice: of the whole grid, so that a window changes
/// nothing but numbers.
#[derive(Clone, Debug)]
pub(crate) struct DofPlaces<T, const D: usize> {
    along: [Vec<T>; D],
    /// First DOF of the grid's window along each axis, and how many there are.
    first: [usize; D],
    shape: [usize; D],
}

impl<T: Scalar, const D: usize> DofPlaces<T, D> {
    /// Of no DOF.
    pub(crate) fn none() -> Self {
        Self {
            along: std::array::from_fn(|_| Vec::new()),
            first: [0; D],
            shape: [0; D],
        }
    }

    /// Of the DOFs of a basis; `None` if they have no places about which it reproduces linear functions.
    pub(crate) fn of<B: BasisFamily<T, D>>(basis: &B, grid: &Grid<T, D>) -> Option<Self> {
        let mut places = Self::none();
        for axis in 0..D {
            places.along[axis] = places_along(basis, grid, axis)?;
        }
        places.follow(basis, grid);
        Some(places)
    }

    /// Takes in the window of the grid.
    pub(crate) fn follow<B: BasisFamily<T, D>>(&mut self, basis: &B, grid: &Grid<T, D>) {
        self.first = grid.window().first().map(|cell| cell as usize);
        self.shape = basis.dofs(grid);
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of::<T>() * self.along.iter().map(Vec::capacity).sum::<usize>()
    }

    /// From `x` to a DOF of the window.
    #[inline(always)]
    pub(crate) fn offset(&self, mut dof: usize, x: &SVector<T, D>) -> SVector<T, D> {
        SVector::from_fn(|axis, _| {
            let along = self.first[axis] + dof % self.shape[axis];
            dof /= self.shape[axis];
            self.along[axis][along] - x[axis]
        })
    }
}

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>> Sweep<'_, T, D, B> {
    /// The functions of `cell` with `phi_i (x_i - x)_a` in the place of their slopes along each axis `a`.
    #[inline(always)]
    pub(super) fn moments<K: Lanes<T>>(
        &self,
        k: K,
        cell: &Cell<D>,
        x: &[K::V; D],
        factors: &Factors<K::V, D>,
        places: &DofPlaces<T, D>,
    ) -> Factors<K::V, D> {
        let mut moments = *factors;
        let firsts = self.basis.first_dofs(self.grid, cell);
        for a in 0..D {
            let places = &places.along[a][firsts[a]..firsts[a] + B::WIDTH];
            for i in 0..B::WIDTH {
                moments.slope[a][i] = factors.value[a][i] * (k.splat(places[i]) - x[a]);
            }
        }
        moments
    }

    /// `sum_i phi_i (x_i - x)_a^2` along each axis, of such moments.
    #[inline(always)]
    pub(super) fn second_moments<K: Lanes<T>>(
        &self,
        k: K,
        cell: &Cell<D>,
        x: &[K::V; D],
        moments: &Factors<K::V, D>,
        places: &DofPlaces<T, D>,
    ) -> [K::V; D] {
        let mut sums = [k.splat(T::zero()); D];
        let firsts = self.basis.first_dofs(self.grid, cell);
        for a in 0..D {
            let places = &places.along[a][firsts[a]..firsts[a] + B::WIDTH];
            for i in 0..B::WIDTH {
                sums[a] = sums[a] + moments.slope[a][i] * (k.splat(places[i]) - x[a]);
            }
        }
        sums
    }
}
