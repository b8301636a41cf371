//! Sums at the DOFs of a cell, kept in lanes.
//!
//! What four particles add to a DOF is added up over the lanes only when no further particle will add to it:
//! that takes longer than adding. Where the next cell is the neighbour along axis 0, only the first column of
//! DOFs is done with; the others move up by one, which costs nothing, because they are read and written
//! anyway.

use nalgebra::SVector;

use super::Sweep;
use crate::basis::{BasisFamily, Factors};
use crate::grid::Cell;
use crate::scalar::Scalar;
use crate::simd::{LANES, Lanes, Number, Packs, inlined};

/// DOFs of a cell, at most: four along each of three axes.
const MOST_DOFS: usize = 64;

/// Most numbers of a DOF: three scalars and four vectors, in fours.
const MOST_NUMBERS: usize = 16;

/// What particles add to a DOF: `S` scalars times its function, `C` vectors times its function, and `G`
/// vectors that are tensors times its gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sum<T, const D: usize, const S: usize, const C: usize, const G: usize> {
    pub(crate) scalars: [T; S],
    pub(crate) vectors: [SVector<T, D>; C],
    pub(crate) forces: [SVector<T, D>; G],
}

/// What a group adds: scalars and vectors times the functions, and tensors times their slopes.
#[derive(Clone, Copy)]
pub(crate) struct Parts<V, const D: usize, const S: usize, const C: usize, const G: usize> {
    pub(crate) scalars: [V; S],
    pub(crate) vectors: [[V; D]; C],
    pub(crate) tensors: [[[V; D]; D]; G],
}

/// Sums for each DOF of a cell.
pub(super) struct Sums<V, const D: usize, const S: usize, const C: usize, const G: usize> {
    cell: Option<Cell<D>>,
    first: usize,
    pub(super) scalars: [[V; S]; MOST_DOFS],
    pub(super) vectors: [[[V; D]; C]; MOST_DOFS],
    pub(super) forces: [[[V; D]; G]; MOST_DOFS],
}

impl<V: Copy, const D: usize, const S: usize, const C: usize, const G: usize> Sums<V, D, S, C, G> {
    #[inline(always)]
    pub(super) fn new<T: Scalar, K: Lanes<T, V = V>>(k: K) -> Self {
        let zero = k.splat(T::zero());
        Self {
            cell: None,
            first: 0,
            scalars: [[zero; S]; MOST_DOFS],
            vectors: [[[zero; D]; C]; MOST_DOFS],
            forces: [[[zero; D]; G]; MOST_DOFS],
        }
    }

    /// Adds `parts` at the DOFs of `cell`; `sink(dof, sum)` takes what is done with.
    #[inline(always)]
    pub(super) fn add<T: Scalar, B: BasisFamily<T, D>, K: Packs<T, N, V = V>, const N: usize>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        cell: &Cell<D>,
        factors: &Factors<V, D>,
        parts: &Parts<V, D, S, C, G>,
        sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>),
    ) where
        V: Number<T>,
    {
        if self.cell != Some(*cell) {
            let first = sweep.first_dof(cell);
            if self
                .cell
                .is_some_and(|last| follows(&last, cell) && first == self.first + 1)
            {
                self.flush_column(k, sweep, 0, sink);
                (self.cell, self.first) = (Some(*cell), first);
                return self.add_to::<true, T, B, K>(k, sweep, factors, parts);
            }
            self.end(k, sweep, sink);
            (self.cell, self.first) = (Some(*cell), first);
        }
        self.add_to::<false, T, B, K>(k, sweep, factors, parts);
    }

    /// Adds `parts` to the sums, which were those of the cell before if `MOVE`.
    #[inline(always)]
    pub(super) fn add_to<const MOVE: bool, T: Scalar, B: BasisFamily<T, D>, K: Lanes<T, V = V>>(
        &mut self,
        k: K,
        _sweep: &Sweep<'_, T, D, B>,
        factors: &Factors<V, D>,
        parts: &Parts<V, D, S, C, G>,
    ) where
        V: Number<T>,
    {
        let zero = k.splat(T::zero());
        for row in 0..Sweep::<T, D, B>::ROWS {
            let place = [row % B::WIDTH, row / B::WIDTH];
            let across = Sweep::<T, D, B>::across(k, factors, place);
            let scalars: [V; S] = times(&parts.scalars, across.value);
            let mut vectors = parts.vectors;
            for q in 0..C {
                vectors[q] = times(&vectors[q], across.value);
            }
            // Of each tensor and component what goes with the slope along axis 0, and the rest.
            let mut along = [[zero; D]; G];
            let mut sides = [[zero; D]; G];
            for q in 0..G {
                for c in 0..D {
                    let t = &parts.tensors[q][c];
                    along[q][c] = t[0] * across.value;
                    if const { D > 1 } {
                        sides[q][c] = t[1] * across.slope[0];
                    }
                    if const { D == 3 } {
                        sides[q][c] = t[D - 1].mul_add(across.slope[1], sides[q][c]);
                    }
                }
            }
            for i in 0..B::WIDTH {
                let place = row * B::WIDTH + i;
                let from = place + usize::from(MOVE);
                let kept = !MOVE || i + 1 < B::WIDTH;
                let (value, slope) = (factors.value[0][i], factors.slope[0][i]);
                for q in 0..S {
                    let before = if kept { self.scalars[from][q] } else { zero };
                    self.scalars[place][q] = scalars[q].mul_add(value, before);
                }
                for q in 0..C {
                    for c in 0..D {
                        let before = if kept { self.vectors[from][q][c] } else { zero };
                        self.vectors[place][q][c] = vectors[q][c].mul_add(value, before);
                    }
                }
                for q in 0..G {
                    for c in 0..D {
                        let before = if kept { self.forces[from][q][c] } else { zero };
                        let mut sum = along[q][c].mul_add(slope, before);
                        if const { D > 1 } {
                            sum = sides[q][c].mul_add(value, sum);
                        }
                        self.forces[place][q][c] = sum;
                    }
                }
            }
        }
    }

    /// Where the lanes are those of four cells: hands `sink(dof, sum)` the sums of each cell that is not
    /// `left_out` and starts again.
    #[inline(always)]
    pub(super) fn spread<T: Scalar, B: BasisFamily<T, D>, K: Packs<T, V = V>>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        cells: &[Cell<D>],
        left_out: &[bool; LANES],
        sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>),
    ) {
        let zero = k.splat(T::zero());
        let mut first = [0; LANES];
        for (first, cell) in first.iter_mut().zip(cells) {
            *first = sweep.first_dof(cell);
        }
        for row in 0..Sweep::<T, D, B>::ROWS {
            let (offset, _) = sweep.row(row);
            for i in 0..B::WIDTH {
                let place = row * B::WIDTH + i;
                let (scalars, vectors, forces) =
                    (self.scalars[place], self.vectors[place], self.forces[place]);
                for l in 0..cells.len().min(LANES) {
                    if !left_out[l] {
                        let lane = inlined(
                            #[inline(always)]
                            |pack: V| k.array(pack)[l],
                        );
                        sink(first[l] + offset + i, sum_of(&scalars, &vectors, &forces, lane));
                    }
                }
                self.scalars[place] = [zero; S];
                self.vectors[place] = [[zero; D]; C];
                self.forces[place] = [[zero; D]; G];
            }
        }
    }

    /// Whether there are more sums than registers, so that another function may look at them. Along one axis,
    /// where a compiler sees through all indices, sums that nobody else looks at need not be filled with zeros
    /// first.
    const fn are_in_memory<T: Scalar, B: BasisFamily<T, D>>() -> bool {
        D > 1 && B::WIDTH.pow(D as u32) * (S + D * (C + G)) > 16
    }

    /// [`Sums::flush`] in a function of its own: that takes more code than all the rest of a sweep, and few
    /// cells are not neighbours along axis 0 of those before them.
    #[inline(never)]
    fn flush_apart<T: Scalar, B: BasisFamily<T, D>, K: Packs<T, N, V = V>, const N: usize>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>),
    ) {
        k.run(
            #[inline(always)]
            || self.flush(k, sweep, sink),
        );
    }

    /// Hands all sums over where no neighbour follows.
    #[inline(always)]
    pub(super) fn end<T: Scalar, B: BasisFamily<T, D>, K: Packs<T, N, V = V>, const N: usize>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>),
    ) {
        if const { Self::are_in_memory::<T, B>() } {
            self.flush_apart(k, sweep, sink);
        } else {
            self.flush(k, sweep, sink);
        }
    }

    /// Hands all sums over and starts again.
    #[inline(always)]
    fn flush<T: Scalar, B: BasisFamily<T, D>, K: Packs<T, N, V = V>, const N: usize>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>),
    ) {
        if self.cell.is_none() {
            return;
        }
        for column in 0..B::WIDTH {
            self.flush_column(k, sweep, column, sink);
        }
        let zero = k.splat(T::zero());
        let count = B::WIDTH.pow(D as u32);
        for place in 0..count {
            self.scalars[place] = [zero; S];
            self.vectors[place] = [[zero; D]; C];
            self.forces[place] = [[zero; D]; G];
        }
        self.cell = None;
    }

    /// Hands the sums of one column over.
    #[inline(always)]
    fn flush_column<T: Scalar, B: BasisFamily<T, D>, K: Packs<T, N, V = V>, const N: usize>(
        &self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        column: usize,
        sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>),
    ) {
        let zero = k.splat(T::zero());
        let numbers = S + D * (C + G);
        for row in 0..Sweep::<T, D, B>::ROWS {
            let (offset, _) = sweep.row(row);
            let place = row * B::WIDTH + column;
            let mut packs = [zero; MOST_NUMBERS];
            for q in 0..S {
                packs[q] = self.scalars[place][q];
            }
            for c in 0..D {
                for q in 0..C {
                    packs[S + q * D + c] = self.vectors[place][q][c];
                }
                for q in 0..G {
                    packs[S + (C + q) * D + c] = self.forces[place][q][c];
                }
            }
            let mut sums = [T::zero(); MOST_NUMBERS];
            for four in 0..numbers.div_ceil(4) {
                let [a, b, c, d] = k.sums([
                    packs[4 * four],
                    packs[4 * four + 1],
                    packs[4 * four + 2],
                    packs[4 * four + 3],
                ]);
                (sums[4 * four], sums[4 * four + 1]) = (a, b);
                (sums[4 * four + 2], sums[4 * four + 3]) = (c, d);
            }
            let vector = inlined(
                #[inline(always)]
                |q: usize| SVector::from_fn(|c, _| sums[S + q * D + c]),
            );
            let mut sum = Sum {
                scalars: [T::zero(); S],
                vectors: [SVector::zeros(); C],
                forces: [SVector::zeros(); G],
            };
            for q in 0..S {
                sum.scalars[q] = sums[q];
            }
            for q in 0..C {
                sum.vectors[q] = vector(q);
            }
            for q in 0..G {
                sum.forces[q] = vector(C + q);
            }
            sink(self.first + column + offset, sum);
        }
    }
}

/// Packs times a pack.
#[inline(always)]
fn times<V: Copy + std::ops::Mul<Output = V>, const Q: usize>(packs: &[V; Q], factor: V) -> [V; Q] {
    let mut products = *packs;
    for q in 0..Q {
        products[q] = products[q] * factor;
    }
    products
}

/// The sums of a DOF, `number` of each.
#[inline(always)]
pub(super) fn sum_of<V: Copy, T: Scalar, const D: usize, const S: usize, const C: usize, const G: usize>(
    scalars: &[V; S],
    vectors: &[[V; D]; C],
    forces: &[[V; D]; G],
    number: impl Fn(V) -> T,
) -> Sum<T, D, S, C, G> {
    let mut sum = Sum {
        scalars: [T::zero(); S],
        vectors: [SVector::zeros(); C],
        forces: [SVector::zeros(); G],
    };
    for q in 0..S {
        sum.scalars[q] = number(scalars[q]);
    }
    for c in 0..D {
        for q in 0..C {
            sum.vectors[q][c] = number(vectors[q][c]);
        }
        for q in 0..G {
            sum.forces[q][c] = number(forces[q][c]);
        }
    }
    sum
}

/// Whether `next` is the neighbour of `cell` along axis 0.
#[inline(always)]
fn follows<const D: usize>(cell: &Cell<D>, next: &Cell<D>) -> bool {
    next[0] == cell[0] + 1 && cell[1..] == next[1..]
}
