//! Sums at the DOFs of a cell, kept in lanes.
//!
//! What four particles add to a DOF is added up over the lanes only when no further particle will add to it: that takes
//! longer than adding. Where the next cell is the neighbour along axis 0, only the first column of DOFs is done with; the
//! others move up by one, which costs nothing, because they are read and written anyway.

use nalgebra::SVector;

use super::Pass;
use crate::basis::{BasisFamily, Factors};
use crate::grid::Cell;
use crate::lanes::{LANES, Lanes, SideBySide};
use crate::scalar::Scalar;

/// DOFs of a cell, at most: four along each of three axes.
const MOST_DOFS: usize = 64;

/// One scalar and one vector for each DOF.
pub(super) struct Sums<V, const D: usize> {
    cell: Option<Cell<D>>,
    pub(super) scalar: [V; MOST_DOFS],
    pub(super) vector: [[V; D]; MOST_DOFS],
}

/// What a group adds: a scalar times the functions, a vector times the functions, and a tensor times their slopes.
#[derive(Clone, Copy)]
pub(super) struct Parts<V, const D: usize> {
    pub(super) scalar: Option<V>,
    pub(super) vector: Option<[V; D]>,
    pub(super) tensor: Option<[[V; D]; D]>,
}

impl<V: Copy, const D: usize> Sums<V, D> {
    #[inline(always)]
    pub(super) fn new<T: Scalar>() -> Self
    where
        V: SideBySide<T>,
    {
        let zero = V::splat(T::zero());
        Self {
            cell: None,
            scalar: [zero; MOST_DOFS],
            vector: [[zero; D]; MOST_DOFS],
        }
    }

    /// Adds `parts` at the DOFs of `cell`; `sink(dof, scalar, vector)` takes what is done with.
    #[inline(always)]
    pub(super) fn add<T: Scalar, B: BasisFamily<T, D>, const N: usize>(
        &mut self,
        pass: &Pass<'_, T, D, B>,
        cell: &Cell<D>,
        factors: &Factors<V, D>,
        parts: &Parts<V, D>,
        sink: &mut impl FnMut(usize, T, SVector<T, D>),
    ) where
        V: Lanes<T, N>,
    {
        if self.cell == Some(*cell) {
            return self.add_to::<false, T, B>(pass, factors, parts);
        }
        if self.cell.is_some_and(|last| follows(&last, cell)) {
            self.flush_column(pass, 0, parts.scalar.is_some(), sink);
            self.cell = Some(*cell);
            return self.add_to::<true, T, B>(pass, factors, parts);
        }
        self.flush(pass, parts.scalar.is_some(), sink);
        self.cell = Some(*cell);
        self.add_to::<false, T, B>(pass, factors, parts);
    }

    /// Adds `parts` to the sums, which were those of the cell before if `MOVE`.
    #[inline(always)]
    pub(super) fn add_to<const MOVE: bool, T: Scalar, B: BasisFamily<T, D>>(
        &mut self,
        pass: &Pass<'_, T, D, B>,
        factors: &Factors<V, D>,
        parts: &Parts<V, D>,
    ) where
        V: SideBySide<T>,
    {
        let zero = V::splat(T::zero());
        for row in 0..Pass::<T, D, B>::ROWS {
            let (_, k) = pass.row(row);
            let across = Pass::<T, D, B>::across(factors, k);
            let scalar = parts.scalar.map(|m| m * across.value);
            let vector = parts
                .vector
                .map(|q| -> [V; D] { std::array::from_fn(|c| q[c] * across.value) });
            let tensor = parts.tensor.map(|tensor| -> [(V, V); D] {
                std::array::from_fn(|c| {
                    let t = &tensor[c];
                    let mut sides = zero;
                    if D > 1 {
                        sides = t[1] * across.slope[0];
                    }
                    if D == 3 {
                        sides = t[D - 1].mul_add(across.slope[1], sides);
                    }
                    (t[0] * across.value, sides)
                })
            });
            for i in 0..B::WIDTH {
                let place = row * B::WIDTH + i;
                let from = place + usize::from(MOVE);
                let kept = !MOVE || i + 1 < B::WIDTH;
                if let Some(part) = scalar {
                    let before = if kept { self.scalar[from] } else { zero };
                    self.scalar[place] = part.mul_add(factors.value[0][i], before);
                }
                for c in 0..D {
                    let mut sum = if kept { self.vector[from][c] } else { zero };
                    if let Some(part) = vector {
                        sum = part[c].mul_add(factors.value[0][i], sum);
                    }
                    if let Some(part) = tensor {
                        let (along, sides) = part[c];
                        sum = along.mul_add(factors.slope[0][i], sum);
                        if D > 1 {
                            sum = sides.mul_add(factors.value[0][i], sum);
                        }
                    }
                    self.vector[place][c] = sum;
                }
            }
        }
    }

    /// Where the lanes are those of four cells: hands `sink(dof, scalar, vector)` the sums of each cell that is not `left_out`
    /// and starts again.
    #[inline(always)]
    pub(super) fn spread<T: Scalar, B: BasisFamily<T, D>>(
        &mut self,
        pass: &Pass<'_, T, D, B>,
        cells: &[Cell<D>],
        left_out: &[bool; LANES],
        sink: &mut impl FnMut(usize, T, SVector<T, D>),
    ) where
        V: Lanes<T>,
    {
        let zero = V::splat(T::zero());
        let first: [usize; LANES] = std::array::from_fn(|l| cells.get(l).map_or(0, |c| pass.first_dof(c)));
        for row in 0..Pass::<T, D, B>::ROWS {
            let (offset, _) = pass.row(row);
            for i in 0..B::WIDTH {
                let place = row * B::WIDTH + i;
                let scalar = self.scalar[place].array();
                let vector: [[T; LANES]; D] = std::array::from_fn(|c| self.vector[place][c].array());
                for l in 0..cells.len().min(LANES) {
                    if !left_out[l] {
                        let part = SVector::from_fn(|c, _| vector[c][l]);
                        sink(first[l] + offset + i, scalar[l], part);
                    }
                }
                self.scalar[place] = zero;
                self.vector[place] = [zero; D];
            }
        }
    }

    /// Hands all sums over and starts again.
    #[inline(always)]
    pub(super) fn flush<T: Scalar, B: BasisFamily<T, D>, const N: usize>(
        &mut self,
        pass: &Pass<'_, T, D, B>,
        scalars: bool,
        sink: &mut impl FnMut(usize, T, SVector<T, D>),
    ) where
        V: Lanes<T, N>,
    {
        if self.cell.is_none() {
            return;
        }
        for column in 0..B::WIDTH {
            self.flush_column(pass, column, scalars, sink);
        }
        let zero = V::splat(T::zero());
        let count = B::WIDTH.pow(D as u32);
        self.scalar[..count].fill(zero);
        self.vector[..count].fill([zero; D]);
        self.cell = None;
    }

    /// Hands the sums of one column over.
    #[inline(always)]
    fn flush_column<T: Scalar, B: BasisFamily<T, D>, const N: usize>(
        &self,
        pass: &Pass<'_, T, D, B>,
        column: usize,
        scalars: bool,
        sink: &mut impl FnMut(usize, T, SVector<T, D>),
    ) where
        V: Lanes<T, N>,
    {
        let Some(cell) = self.cell else { return };
        let first = pass.first_dof(&cell) + column;
        let zero = V::splat(T::zero());
        for row in 0..Pass::<T, D, B>::ROWS {
            let (offset, _) = pass.row(row);
            let place = row * B::WIDTH + column;
            let vector = self.vector[place];
            let scalar = if scalars { self.scalar[place] } else { zero };
            let packs = std::array::from_fn(|k| match k {
                3 => scalar,
                _ if k < D => vector[k],
                _ => zero,
            });
            let sums = V::sums(packs);
            sink(first + offset, sums[3], SVector::from_fn(|c, _| sums[c]));
        }
    }
}

/// Whether `next` is the neighbour of `cell` along axis 0.
#[inline(always)]
fn follows<const D: usize>(cell: &Cell<D>, next: &Cell<D>) -> bool {
    next[0] == cell[0] + 1 && cell[1..] == next[1..]
}
