//! G2P of accelerations, and P2G of the momenta that the particles then have.
//!
//! `v_p += dt sum_i phi_i(x_p) a_i`: the FLIP update of velocities.

use nalgebra::SVector;

use super::cell_sums::StencilSums;
use super::group::{EachGroup, Group, come_in_eights, each_group};
use super::stencil::{Look, Seer, Stencil};
use super::sums::{Parts, Sum, Sums};
use super::{Sites, Sweep};
use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;
use crate::simd::{Number, One, Packs, dispatch_for, each};

/// What accelerations do to the particles of a span: of `C` fields, one a phase.
pub(crate) trait Kick<T: Scalar, const D: usize, const C: usize>: Sized {
    /// The same of the first so many particles.
    fn cut(self, count: usize) -> Self;

    /// Takes in the accelerations of a group's particles; returns their momenta then, nothing in spare lanes.
    fn take<K: Packs<T, N>, const N: usize, const FULL: bool>(
        &mut self,
        k: K,
        group: Group<N>,
        accelerations: &[[K::V; D]; C],
    ) -> [[K::V; D]; C];
}

/// Momentum of particles, and the sum of its sizes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Momentum<T, const D: usize> {
    pub(crate) momentum: SVector<T, D>,
    pub(crate) scale: T,
}

impl<T: Scalar, const D: usize> Momentum<T, D> {
    /// Of no particle.
    pub(crate) fn zero() -> Self {
        Self {
            momentum: SVector::zeros(),
            scale: T::zero(),
        }
    }

    /// Of both together.
    pub(crate) fn with(mut self, other: &Self) -> Self {
        self.momentum += other.momentum;
        self.scale += other.scale;
        self
    }
}

/// Accelerates the particles of a span by the fields with the given DOFs and hands `sink(dof, momenta)` what
/// they then add to the DOFs, of the first `M` fields; returns their momenta, and `what` as it is then.
#[inline(always)]
pub(crate) fn kick<
    const M: usize,
    T: Scalar,
    const D: usize,
    B: BasisFamily<T, D>,
    W: Kick<T, D, C>,
    const C: usize,
>(
    basis: &B,
    grid: &Grid<T, D>,
    sites: Sites<'_, T, D>,
    fields: [&[SVector<T, D>]; C],
    mut what: W,
    mut sink: impl FnMut(usize, Sum<T, D, 0, M, 0>),
) -> ([Momentum<T, D>; C], W) {
    let sweep = Sweep::new(basis, grid);
    if sweep.is_in_packs() {
        return dispatch_for!(T, come_in_eights(sites.cells), |k| in_packs::<
            M,
            _,
            D,
            _,
            _,
            _,
            _,
            C,
        >(
            k, &sweep, sites, fields, what, sink
        ));
    }
    let mut totals = [Momentum::zero(); C];
    let (mut stencil, mut sums) = (Stencil::new(), StencilSums::new());
    for (p, place) in sites.cells.iter().zip(sites.positions).enumerate() {
        let mut a = [[T::zero(); D]; C];
        stencil.for_each(
            (basis, grid),
            &sites.domains,
            Seer::Particle(p),
            place,
            #[inline(always)]
            |i, phi, _| {
                for q in 0..C {
                    for c in 0..D {
                        a[q][c] += fields[q][i][c] * phi;
                    }
                }
            },
        );
        let momenta = what.take::<One, 1, true>(One, Group { first: p, count: 1 }, &a);
        for q in 0..C {
            totals[q].momentum += SVector::from(momenta[q]);
            totals[q].scale += size(&momenta[q]);
        }
        if const { M > 0 } {
            let space = (basis, grid, &mut stencil);
            sums.add(
                space,
                (p, place),
                &sites.domains,
                &parts(&momenta),
                None,
                &mut sink,
            );
        }
    }
    if const { M > 0 } {
        sums.flush(&mut sink);
    }
    (totals, what)
}

/// Momenta of the first fields alone.
#[inline(always)]
fn parts<V: Copy, const D: usize, const C: usize, const M: usize>(
    momenta: &[[V; D]; C],
) -> Parts<V, D, 0, M, 0> {
    let mut vectors = [momenta[0]; M];
    for q in 1..M {
        vectors[q] = momenta[q];
    }
    Parts {
        scalars: [],
        vectors,
        tensors: [],
    }
}

#[inline(always)]
fn in_packs<
    const M: usize,
    T: Scalar,
    const D: usize,
    B: BasisFamily<T, D>,
    K: Packs<T, N>,
    const N: usize,
    W: Kick<T, D, C>,
    const C: usize,
>(
    k: K,
    sweep: &Sweep<'_, T, D, B>,
    sites: Sites<'_, T, D>,
    fields: [&[SVector<T, D>]; C],
    what: W,
    sink: impl FnMut(usize, Sum<T, D, 0, M, 0>),
) -> ([Momentum<T, D>; C], W) {
    let (zero, cells) = (k.splat(T::zero()), sites.cells);
    let mut groups = Kicking::<M, _, _, _, D, _, _, _, C> {
        k,
        sweep,
        positions: &sites.positions[..cells.len()],
        half_lengths: sites.domains.half_lengths,
        cells,
        fields,
        what: what.cut(cells.len()),
        sums: Sums::<K::V, D, 0, M, 0>::new(k),
        momenta: [[zero; D]; C],
        scales: [zero; C],
        sink,
    };
    each_group(cells, &mut groups);
    let (momenta, scales) = (groups.momenta, groups.scales);
    if const { M > 0 } {
        groups.sums.end(k, sweep, &mut groups.sink);
    }
    let mut totals = [Momentum::zero(); C];
    for q in 0..C {
        let mut packs = [zero; 4];
        for c in 0..D {
            packs[c] = momenta[q][c];
        }
        packs[3] = scales[q];
        let sums = k.sums(packs);
        totals[q] = Momentum {
            momentum: SVector::from_fn(|c, _| sums[c]),
            scale: sums[3],
        };
    }
    (totals, groups.what)
}

/// The sweep over the groups.
struct Kicking<'a, const M: usize, T, K, V, const D: usize, B, W, F, const C: usize> {
    k: K,
    sweep: &'a Sweep<'a, T, D, B>,
    positions: &'a [SVector<T, D>],
    half_lengths: &'a [SVector<T, D>],
    cells: &'a [Cell<D>],
    fields: [&'a [SVector<T, D>]; C],
    what: W,
    sums: Sums<V, D, 0, M, 0>,
    /// Of all, and their sizes, lane by lane.
    momenta: [[V; D]; C],
    scales: [V; C],
    sink: F,
}

impl<const M: usize, T, K, const D: usize, const N: usize, B, W, F, const C: usize> EachGroup<N>
    for Kicking<'_, M, T, K, K::V, D, B, W, F, C>
where
    T: Scalar,
    K: Packs<T, N>,
    B: BasisFamily<T, D>,
    W: Kick<T, D, C>,
    F: FnMut(usize, Sum<T, D, 0, M, 0>),
{
    #[inline(always)]
    fn take<const FULL: bool>(&mut self, group: Group<N>) {
        let (k, sweep) = (self.k, self.sweep);
        let cell = &self.cells[group.first];
        let x = group.vectors::<FULL, T, K, D>(k, self.positions);
        let factors = sweep.factors::<FULL, K, N>(k, group, (cell, &x), self.half_lengths);
        let first = sweep.first_dof(cell);
        let a: [[K::V; D]; C] = each(
            #[inline(always)]
            |q| sweep.value(k, first, &factors, self.fields[q]),
        );
        let momenta = self.what.take::<K, N, FULL>(k, group, &a);
        for q in 0..C {
            for c in 0..D {
                self.momenta[q][c] = self.momenta[q][c] + momenta[q][c];
            }
            self.scales[q] = self.scales[q] + size(&momenta[q]);
        }
        if const { M > 0 } {
            self.sums
                .add(k, sweep, cell, &factors, &parts(&momenta), &mut self.sink);
        }
    }
}

/// Sizes of vectors. Along one axis without the root, which takes as long as a dozen sums.
#[inline(always)]
fn size<T: Scalar, V: Number<T>, const D: usize>(vectors: &[V; D]) -> V {
    if const { D == 1 } {
        return vectors[0].abs();
    }
    let mut square = vectors[0] * vectors[0];
    for c in 1..D {
        square = vectors[c].mul_add(vectors[c], square);
    }
    square.sqrt()
}
