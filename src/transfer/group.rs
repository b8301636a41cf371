//! Particles of one cell that follow each other, one in each lane.

use nalgebra::{SMatrix, SVector};

use crate::grid::Cell;
use crate::scalar::Scalar;
use crate::simd::{Packs, each, in_lanes, inlined};

/// Particles of one cell that follow each other, at most `N`: one for each lane. Spare lanes repeat the last
/// one.
#[derive(Clone, Copy)]
pub(crate) struct Group<const N: usize> {
    pub(crate) first: usize,
    pub(crate) count: usize,
}

impl<const N: usize> Group<N> {
    /// The one that begins with particle `first`.
    #[inline(always)]
    pub(crate) fn at<const D: usize>(first: usize, cells: &[Cell<D>]) -> Self {
        let rest = &cells[first..];
        if let Some(all) = rest.first_chunk()
            && are_alike::<D, N>(all)
        {
            return Self { first, count: N };
        }
        let mut count = 1;
        while count < N.min(rest.len()) && rest[count] == rest[0] {
            count += 1;
        }
        Self { first, count }
    }

    /// `N` particles of one cell, the first of which is `first`, if there are so many.
    #[inline(always)]
    pub(crate) fn full_at<const D: usize>(first: usize, cells: &[Cell<D>]) -> Option<Self> {
        let all = cells.get(first..)?.first_chunk::<N>()?;
        are_alike(all).then_some(Self { first, count: N })
    }

    /// Particle of a lane.
    #[inline(always)]
    pub(crate) fn particle(self, lane: usize) -> usize {
        self.first + lane.min(self.count - 1)
    }

    /// `make` of what an array says of the particle of each lane; the group must be full if `FULL`. It is
    /// asked in both branches, and not once of what they find: numbers that follow each other are then one
    /// load.
    #[inline(always)]
    pub(crate) fn with<const FULL: bool, A: Copy, R>(self, values: &[A], make: impl Fn([A; N]) -> R) -> R {
        match values[self.first..].first_chunk() {
            Some(&lanes) if FULL || self.count == N => make(lanes),
            // Never: a full group is within its arrays.
            _ if FULL => make([values[self.first]; N]),
            _ => make(each(
                #[inline(always)]
                |l| values[self.particle(l)],
            )),
        }
    }

    /// A number of each particle.
    #[inline(always)]
    pub(crate) fn numbers<const FULL: bool, T: Scalar, K: Packs<T, N>>(self, k: K, values: &[T]) -> K::V {
        self.with::<FULL, _, _>(
            values,
            #[inline(always)]
            |lanes| k.pack(lanes),
        )
    }

    /// A number of each particle, zero in spare lanes.
    #[inline(always)]
    pub(crate) fn amounts<const FULL: bool, T: Scalar, K: Packs<T, N>>(self, k: K, values: &[T]) -> K::V {
        if FULL || self.count == N {
            return self.numbers::<FULL, T, K>(k, values);
        }
        self.amounts_of(
            k,
            #[inline(always)]
            |p| values[p],
        )
    }

    /// The same of what `amount` says of a particle.
    #[inline(always)]
    pub(crate) fn amounts_of<T: Scalar, K: Packs<T, N>>(self, k: K, amount: impl Fn(usize) -> T) -> K::V {
        k.pack(in_lanes(
            #[inline(always)]
            |l| {
                if l < self.count {
                    amount(self.first + l)
                } else {
                    T::zero()
                }
            },
        ))
    }

    /// The components of a vector.
    #[inline(always)]
    pub(crate) fn vectors<const FULL: bool, T: Scalar, K: Packs<T, N>, const D: usize>(
        self,
        k: K,
        values: &[SVector<T, D>],
    ) -> [K::V; D] {
        self.with::<FULL, _, _>(
            values,
            #[inline(always)]
            |lanes| components(k, &lanes),
        )
    }

    /// Component `(c, a)` of tensors at `[c][a]`.
    #[inline(always)]
    pub(crate) fn tensors<T: Scalar, K: Packs<T, N>, const D: usize>(
        k: K,
        lanes: &[SMatrix<T, D, D>; N],
    ) -> [[K::V; D]; D] {
        each(
            #[inline(always)]
            |c| {
                each(
                    #[inline(always)]
                    |a| {
                        k.pack(in_lanes(
                            #[inline(always)]
                            |l| lanes[l][(c, a)],
                        ))
                    },
                )
            },
        )
    }

    /// Gives each particle its lane of a vector.
    #[inline(always)]
    pub(crate) fn put<const FULL: bool, T: Scalar, K: Packs<T, N>, const D: usize>(
        self,
        k: K,
        values: &mut [SVector<T, D>],
        vector: &[K::V; D],
    ) {
        let lanes: [[T; N]; D] = each(
            #[inline(always)]
            |c| k.array(vector[c]),
        );
        let of_lane = inlined(
            #[inline(always)]
            |l: usize| SVector::from_fn(|c, _| lanes[c][l]),
        );
        if FULL {
            let all = &mut values[self.first..self.first + N];
            for l in 0..N {
                all[l] = of_lane(l);
            }
            return;
        }
        match values[self.first..].first_chunk_mut::<N>() {
            Some(all) if self.count == N => {
                for l in 0..N {
                    all[l] = of_lane(l);
                }
            }
            _ => {
                for l in 0..self.count {
                    values[self.first + l] = of_lane(l);
                }
            }
        }
    }
}

/// The components of vectors.
#[inline(always)]
pub(crate) fn components<T: Scalar, K: Packs<T, N>, const D: usize, const N: usize>(
    k: K,
    lanes: &[SVector<T, D>; N],
) -> [K::V; D] {
    each(
        #[inline(always)]
        |a| {
            k.pack(in_lanes(
                #[inline(always)]
                |l| lanes[l][a],
            ))
        },
    )
}

/// Whether all are the same cell.
#[inline(always)]
fn are_alike<const D: usize, const N: usize>(cells: &[Cell<D>; N]) -> bool {
    let mut bits = 0;
    for l in 1..N {
        for axis in 0..D {
            bits |= cells[l][axis] ^ cells[0][axis];
        }
    }
    bits == 0
}

/// Whether most particles of the given cells come in groups of eight. Asked of the first few: with eight
/// lanes a group that is not full takes longer than two groups of four.
pub(crate) fn come_in_eights<const D: usize>(cells: &[Cell<D>]) -> bool {
    let some = &cells[..cells.len().min(64)];
    let (mut p, mut full) = (0, 0);
    while p < some.len() {
        let Group { count, .. } = Group::<8>::at(p, some);
        full += if count == 8 { count } else { 0 };
        p += count;
    }
    4 * full >= 3 * some.len()
}

/// What a sweep does with each group.
pub(super) trait EachGroup<const N: usize> {
    /// Takes in the next one, which is full if `FULL`.
    fn take<const FULL: bool>(&mut self, group: Group<N>);
}

/// Calls [`EachGroup::take`] for the groups of the particles of the given cells. In one dimension, where a
/// group takes as long as the question whether it is full, full ones have a loop of their own that asks once.
#[inline(always)]
pub(super) fn each_group<const D: usize, const N: usize>(cells: &[Cell<D>], sweep: &mut impl EachGroup<N>) {
    let mut p = 0;
    while p < cells.len() {
        if const { D == 1 } {
            while let Some(group) = Group::full_at(p, cells) {
                sweep.take::<true>(group);
                p += N;
            }
            if p >= cells.len() {
                return;
            }
        }
        let group = Group::at(p, cells);
        sweep.take::<false>(group);
        p += group.count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_come_in_eights_if_most_of_their_particles_do() {
        let cells = |counts: &[usize]| -> Vec<Cell<1>> {
            let of_cell = |(i, &count): (usize, &usize)| vec![[i as u32]; count];
            counts.iter().enumerate().flat_map(of_cell).collect()
        };
        assert!(come_in_eights(&cells(&[8; 20])) && come_in_eights(&cells(&[64, 64])));
        assert!(come_in_eights(&cells(&[25, 17])) && come_in_eights(&cells(&[8])));
        for few in [vec![4; 30], vec![7; 20], vec![12; 10], vec![8, 4, 4, 3], vec![]] {
            assert!(come_in_eights(&cells(&few)) == few.is_empty(), "{few:?}");
        }
    }
}
