//! P2G: what particles add to DOFs.

use nalgebra::SVector;

use super::cell_sums::StencilSums;
use super::group::{EachGroup, Group, come_in_eights, each_group};
use super::places::DofPlaces;
use super::stencil::Stencil;
use super::sums::Sums;
pub(crate) use super::sums::{Parts, Sum};
use super::{Sites, Sweep};
use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;
use crate::simd::{One, Packs, dispatch_for};

/// What particles of a span add to the DOFs: `S` scalars and `C` vectors times the functions, `G` tensors
/// times their gradients. Fused sweeps are contributions of several quantities.
pub(crate) trait Contribution<T: Scalar, const D: usize, const S: usize, const C: usize, const G: usize>:
    Copy
{
    /// The same of the first so many particles: lengths that a compiler sees to be equal, so that one test of
    /// an index does for all arrays.
    fn cut(self, count: usize) -> Self;

    /// Places of the DOFs, if tensors are to go with the moments `phi_i (x_i - x)` in the place of gradients.
    #[inline(always)]
    fn places(&self) -> Option<&DofPlaces<T, D>> {
        None
    }

    /// That of the particles of a group, nothing in spare lanes; `slopes` are to be multiplied with the
    /// columns of tensors: gradients are by coordinates in cell sizes.
    fn parts<K: Packs<T, N>, const N: usize, const FULL: bool>(
        &self,
        k: K,
        group: Group<N>,
        slopes: &[K::V; D],
    ) -> Parts<K::V, D, S, C, G>;
}

/// Hands `sink(dof, sum)` what particles add to the DOFs. All is taken by value: what is behind a reference
/// would be read anew for each DOF.
#[inline(always)]
pub(crate) fn p2g<
    T: Scalar,
    const D: usize,
    B: BasisFamily<T, D>,
    const S: usize,
    const C: usize,
    const G: usize,
>(
    basis: &B,
    grid: &Grid<T, D>,
    sites: Sites<'_, T, D>,
    what: impl Contribution<T, D, S, C, G>,
    mut sink: impl FnMut(usize, Sum<T, D, S, C, G>),
) {
    let sweep = Sweep::new(basis, grid);
    if sweep.is_in_packs() {
        return dispatch_for!(T, come_in_eights(sites.cells), |k| in_packs(
            k, &sweep, sites, what, sink
        ));
    }
    let (mut stencil, mut sums) = (Stencil::new(), StencilSums::new());
    let slopes = [T::one(); D];
    for (p, place) in sites.cells.iter().zip(sites.positions).enumerate() {
        let group = Group { first: p, count: 1 };
        let parts = what.parts::<One, 1, true>(One, group, &slopes);
        let space = (basis, grid, &mut stencil);
        sums.add(
            space,
            (p, place),
            &sites.domains,
            &parts,
            what.places(),
            &mut sink,
        );
    }
    sums.flush(&mut sink);
}

#[inline(always)]
fn in_packs<
    T: Scalar,
    const D: usize,
    B: BasisFamily<T, D>,
    K: Packs<T, N>,
    const N: usize,
    const S: usize,
    const C: usize,
    const G: usize,
>(
    k: K,
    sweep: &Sweep<'_, T, D, B>,
    sites: Sites<'_, T, D>,
    what: impl Contribution<T, D, S, C, G>,
    sink: impl FnMut(usize, Sum<T, D, S, C, G>),
) {
    let cells = sites.cells;
    let mut groups = Adding {
        k,
        sweep,
        positions: &sites.positions[..cells.len()],
        half_lengths: sites.domains.half_lengths,
        cells,
        what: what.cut(cells.len()),
        sums: Sums::<K::V, D, S, C, G>::new(k),
        slopes: sweep.inverse(k),
        sink,
    };
    each_group(cells, &mut groups);
    groups.sums.end(k, sweep, &mut groups.sink);
}

/// The sweep over the groups.
struct Adding<'a, T, K, V, const D: usize, B, W, F, const S: usize, const C: usize, const G: usize> {
    k: K,
    sweep: &'a Sweep<'a, T, D, B>,
    positions: &'a [SVector<T, D>],
    half_lengths: &'a [SVector<T, D>],
    cells: &'a [Cell<D>],
    what: W,
    sums: Sums<V, D, S, C, G>,
    slopes: [V; D],
    sink: F,
}

impl<T, K, const D: usize, const N: usize, B, W, F, const S: usize, const C: usize, const G: usize>
    EachGroup<N> for Adding<'_, T, K, K::V, D, B, W, F, S, C, G>
where
    T: Scalar,
    K: Packs<T, N>,
    B: BasisFamily<T, D>,
    W: Contribution<T, D, S, C, G>,
    F: FnMut(usize, Sum<T, D, S, C, G>),
{
    #[inline(always)]
    fn take<const FULL: bool>(&mut self, group: Group<N>) {
        let (k, sweep) = (self.k, self.sweep);
        let cell = &self.cells[group.first];
        let x = group.vectors::<FULL, T, K, D>(k, self.positions);
        let mut factors = sweep.factors::<FULL, K, N>(k, group, (cell, &x), self.half_lengths);
        if let Some(places) = self.what.places() {
            factors = sweep.moments(k, (cell, &x), &factors, places);
        }
        let parts = self.what.parts::<K, N, FULL>(k, group, &self.slopes);
        self.sums.add(k, sweep, cell, &factors, &parts, &mut self.sink);
    }
}
