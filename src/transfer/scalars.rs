//! G2P of a scalar field, and of its gradient.

use nalgebra::SVector;

use super::Sweep;
use super::group::{EachGroup, Group, come_in_eights, components, each_group};
use crate::basis::{BasisFamily, Factors};
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;
use crate::simd::{Lanes, Number, Packs, dispatch_for, each};

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>> Sweep<'_, T, D, B> {
    /// Value of the scalar field with the given DOFs, at the points with the given factors.
    #[inline(always)]
    fn scalar<K: Lanes<T>>(&self, k: K, first: usize, factors: &Factors<K::V, D>, dofs: &[T]) -> K::V {
        let mut result = k.splat(T::zero());
        for row in 0..Self::ROWS {
            let (offset, place) = self.row(row);
            let across = Self::across(k, factors, place);
            let dofs = &dofs[first + offset..first + offset + B::WIDTH];
            let mut sum = factors.value[0][0] * k.splat(dofs[0]);
            for i in 1..B::WIDTH {
                sum = factors.value[0][i].mul_add(k.splat(dofs[i]), sum);
            }
            result = sum.mul_add(across.value, result);
        }
        result
    }

    /// Its derivatives by the coordinates in cell sizes.
    #[inline(always)]
    fn scalar_slopes<K: Lanes<T>>(
        &self,
        k: K,
        first: usize,
        factors: &Factors<K::V, D>,
        dofs: &[T],
    ) -> [K::V; D] {
        let mut slopes = [k.splat(T::zero()); D];
        for row in 0..Self::ROWS {
            let (offset, place) = self.row(row);
            let across = Self::across(k, factors, place);
            let dofs = &dofs[first + offset..first + offset + B::WIDTH];
            let dof = k.splat(dofs[0]);
            let (mut sum, mut slope) = (factors.value[0][0] * dof, factors.slope[0][0] * dof);
            for i in 1..B::WIDTH {
                let dof = k.splat(dofs[i]);
                sum = factors.value[0][i].mul_add(dof, sum);
                slope = factors.slope[0][i].mul_add(dof, slope);
            }
            slopes[0] = slope.mul_add(across.value, slopes[0]);
            for a in 1..D {
                slopes[a] = sum.mul_add(across.slope[a - 1], slopes[a]);
            }
        }
        slopes
    }
}

/// A scalar field seen by the particles of a span, for a [`Contribution`](super::Contribution) that asks for
/// its gradient.
pub(crate) struct ScalarField<'a, T, const D: usize, B> {
    sweep: Sweep<'a, T, D, B>,
    positions: &'a [SVector<T, D>],
    cells: &'a [Cell<D>],
    dofs: &'a [T],
}

impl<T: Copy, const D: usize, B> Clone for ScalarField<'_, T, D, B> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Copy, const D: usize, B> Copy for ScalarField<'_, T, D, B> {}

impl<'a, T: Scalar, const D: usize, B: BasisFamily<T, D>> ScalarField<'a, T, D, B> {
    pub(crate) fn new(
        basis: &'a B,
        grid: &'a Grid<T, D>,
        (positions, cells): (&'a [SVector<T, D>], &'a [Cell<D>]),
        dofs: &'a [T],
    ) -> Self {
        let sweep = Sweep::new(basis, grid);
        Self {
            sweep,
            positions,
            cells,
            dofs,
        }
    }

    /// The same of the first so many particles.
    #[inline(always)]
    pub(crate) fn cut(self, count: usize) -> Self {
        Self {
            positions: &self.positions[..count],
            cells: &self.cells[..count],
            ..self
        }
    }

    /// Gradient at the particles of a group.
    #[inline(always)]
    pub(crate) fn gradient<K: Packs<T, N>, const N: usize, const FULL: bool>(
        &self,
        k: K,
        group: Group<N>,
    ) -> [K::V; D] {
        let sweep = &self.sweep;
        if !sweep.is_in_packs() {
            let lanes: [SVector<T, D>; N] = each(
                #[inline(always)]
                |l| self.gradient_at(group.particle(l)),
            );
            return components(k, &lanes);
        }
        let cell = &self.cells[group.first];
        let x = group.vectors::<FULL, T, K, D>(k, self.positions);
        let factors = sweep.factors(k, cell, &x);
        let slopes = sweep.scalar_slopes(k, sweep.first_dof(cell), &factors, self.dofs);
        let inverse = sweep.inverse(k);
        each(
            #[inline(always)]
            |a| slopes[a] * inverse[a],
        )
    }

    /// The same at one, of a basis that is no product.
    fn gradient_at(&self, p: usize) -> SVector<T, D> {
        let (sweep, mut sum) = (&self.sweep, SVector::zeros());
        sweep.basis.for_each(
            sweep.grid,
            &self.cells[p],
            &self.positions[p],
            |i, _, gradient| {
                sum += gradient * self.dofs[i];
            },
        );
        sum
    }
}

/// Hands `take(particle, value)` the value of the scalar field with the given DOFs at each particle of a
/// span.
#[inline(always)]
pub(crate) fn g2p<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    (positions, cells): (&[SVector<T, D>], &[Cell<D>]),
    dofs: &[T],
    mut take: impl FnMut(usize, T),
) {
    let sweep = Sweep::new(basis, grid);
    if sweep.is_in_packs() {
        return dispatch_for!(T, come_in_eights(cells), |k| in_packs(
            k, &sweep, positions, cells, dofs, take
        ));
    }
    for (p, (x, cell)) in positions.iter().zip(cells).enumerate() {
        let mut value = T::zero();
        basis.for_each(grid, cell, x, |i, phi, _| value += dofs[i] * phi);
        take(p, value);
    }
}

#[inline(always)]
fn in_packs<T: Scalar, const D: usize, B: BasisFamily<T, D>, K: Packs<T, N>, const N: usize>(
    k: K,
    sweep: &Sweep<'_, T, D, B>,
    positions: &[SVector<T, D>],
    cells: &[Cell<D>],
    dofs: &[T],
    take: impl FnMut(usize, T),
) {
    let mut groups = Taking {
        k,
        sweep,
        positions: &positions[..cells.len()],
        cells,
        dofs,
        take,
    };
    each_group(cells, &mut groups);
}

/// The sweep over the groups.
struct Taking<'a, T, K, const D: usize, B, F> {
    k: K,
    sweep: &'a Sweep<'a, T, D, B>,
    positions: &'a [SVector<T, D>],
    cells: &'a [Cell<D>],
    dofs: &'a [T],
    take: F,
}

impl<T, K, const D: usize, const N: usize, B, F> EachGroup<N> for Taking<'_, T, K, D, B, F>
where
    T: Scalar,
    K: Packs<T, N>,
    B: BasisFamily<T, D>,
    F: FnMut(usize, T),
{
    #[inline(always)]
    fn take<const FULL: bool>(&mut self, group: Group<N>) {
        let (k, sweep) = (self.k, self.sweep);
        let cell = &self.cells[group.first];
        let x = group.vectors::<FULL, T, K, D>(k, self.positions);
        let factors = sweep.factors(k, cell, &x);
        let values = k.array(sweep.scalar(k, sweep.first_dof(cell), &factors, self.dofs));
        for l in 0..group.count {
            (self.take)(group.first + l, values[l]);
        }
    }
}
