//! Where DOFs lie, and moments about a point.

use nalgebra::SVector;

use super::Sweep;
use crate::basis::{BasisFamily, Factors, MOST_WIDTH, shifts_along, steps_from};
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;
use crate::simd::Lanes;

/// Places of the DOFs along each axis, which form a lattice: of the whole grid, so that a window changes
/// nothing but numbers. Distances are taken from a particle's cell, so that they are as exact far from the
/// origin as near it.
#[derive(Clone, Debug)]
pub(crate) struct DofPlaces<T, const D: usize> {
    /// How far each lies, in cells, from where its number says ([`shifts_along`]).
    shifts: [Vec<T>; D],
    /// First DOF of the grid's window along each axis, and how many there are.
    first: [usize; D],
    shape: [usize; D],
}

impl<T: Scalar, const D: usize> DofPlaces<T, D> {
    /// Of no DOF.
    pub(crate) fn none() -> Self {
        Self {
            shifts: std::array::from_fn(|_| Vec::new()),
            first: [0; D],
            shape: [0; D],
        }
    }

    /// Of the DOFs of a basis; `None` if they have no places about which it reproduces linear functions.
    pub(crate) fn of<B: BasisFamily<T, D>>(basis: &B, grid: &Grid<T, D>) -> Option<Self> {
        let mut places = Self::none();
        for axis in 0..D {
            places.shifts[axis] = shifts_along(basis, grid, axis)?;
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
        size_of::<T>() * self.shifts.iter().map(Vec::capacity).sum::<usize>()
    }

    /// From `x` in `cell` to a DOF of the window (m).
    #[inline(always)]
    pub(crate) fn offset(
        &self,
        grid: &Grid<T, D>,
        mut dof: usize,
        (cell, x): (&Cell<D>, &SVector<T, D>),
    ) -> SVector<T, D> {
        SVector::from_fn(|axis, _| {
            let along = self.first[axis] + dof % self.shape[axis];
            dof /= self.shape[axis];
            let at = self.in_cells(axis, along, cell[axis]);
            (at - grid.unit_coordinate(axis, cell[axis], x[axis])) * grid.cell_size()[axis]
        })
    }

    /// Where a DOF of the whole grid lies along an axis, in cells from the beginning of `cell`.
    #[inline(always)]
    fn in_cells(&self, axis: usize, dof: usize, cell: u32) -> T {
        steps_from::<T>(cell as usize, dof) + self.shifts[axis][dof]
    }
}

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>> Sweep<'_, T, D, B> {
    /// The functions of `cell` with `phi_i (x_i - x)_a` in the place of their slopes along each axis `a`.
    #[inline(always)]
    pub(super) fn moments<K: Lanes<T>>(
        &self,
        k: K,
        (cell, x): (&Cell<D>, &[K::V; D]),
        factors: &Factors<K::V, D>,
        places: &DofPlaces<T, D>,
    ) -> Factors<K::V, D> {
        let mut moments = *factors;
        let offsets = self.offsets(k, (cell, x), places);
        for a in 0..D {
            for i in 0..B::WIDTH {
                moments.slope[a][i] = factors.value[a][i] * offsets[a][i];
            }
        }
        moments
    }

    /// `sum_i phi_i (x_i - x)_a^2` along each axis, of such moments.
    #[inline(always)]
    pub(super) fn second_moments<K: Lanes<T>>(
        &self,
        k: K,
        (cell, x): (&Cell<D>, &[K::V; D]),
        moments: &Factors<K::V, D>,
        places: &DofPlaces<T, D>,
    ) -> [K::V; D] {
        let mut sums = [k.splat(T::zero()); D];
        let offsets = self.offsets(k, (cell, x), places);
        for a in 0..D {
            for i in 0..B::WIDTH {
                sums[a] = sums[a] + moments.slope[a][i] * offsets[a][i];
            }
        }
        sums
    }

    /// From `x` to the DOFs of `cell` along each axis (m).
    #[inline(always)]
    fn offsets<K: Lanes<T>>(
        &self,
        k: K,
        (cell, x): (&Cell<D>, &[K::V; D]),
        places: &DofPlaces<T, D>,
    ) -> [[K::V; MOST_WIDTH]; D] {
        let mut offsets = [[k.splat(T::zero()); MOST_WIDTH]; D];
        let firsts = self.basis.first_dofs(self.grid, cell);
        let unit = self.unit(k, cell, x);
        for a in 0..D {
            let size = k.splat(self.grid.cell_size()[a]);
            for i in 0..B::WIDTH {
                let at = places.in_cells(a, firsts[a] + i, cell[a]);
                offsets[a][i] = (k.splat(at) - unit[a]) * size;
            }
        }
        offsets
    }
}
