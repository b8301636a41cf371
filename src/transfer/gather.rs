//! G2P of velocities, accelerations and moments: what particles take that have their velocities from the
//! grid.

use nalgebra::{SMatrix, SVector};

use super::Sweep;
use super::flip::GridVelocity;
use super::group::{EachGroup, Group, come_in_eights, each_group};
use super::places::DofPlaces;
use super::sites::Sites;
use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;
use crate::simd::{One, Packs, dispatch_for, each};

/// What the particles of a group see of the DOFs; tensors component by axis at `[c][a]`.
#[derive(Clone, Copy)]
pub(crate) struct Seen<V, const D: usize> {
    pub(crate) velocity: [V; D],
    pub(crate) acceleration: [V; D],
    pub(crate) gradient: [[V; D]; D],
    pub(crate) moment: [[V; D]; D],
    pub(crate) second_moment: [V; D],
}

/// What takes in what the particles of a span see.
pub(crate) trait Receive<T: Scalar, const D: usize>: Sized {
    /// The same of the first so many particles.
    fn cut(self, count: usize) -> Self;

    /// Takes in what a group's particles see.
    fn take<K: Packs<T, N>, const N: usize, const FULL: bool>(
        &mut self,
        k: K,
        group: Group<N>,
        seen: &Seen<K::V, D>,
    );
}

/// Lets the particles of a span see the velocities and accelerations of the DOFs; returns `what` as it is
/// then.
#[inline(always)]
pub(crate) fn gather<T: Scalar, const D: usize, B: BasisFamily<T, D>, W: Receive<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    sites: Sites<'_, T, D>,
    fields: [&[SVector<T, D>]; 2],
    places: &DofPlaces<T, D>,
    what: W,
) -> W {
    let sweep = Sweep::new(basis, grid);
    if sweep.is_in_packs() {
        return dispatch_for!(T, come_in_eights(sites.cells), |k| in_packs(
            k, &sweep, sites, fields, places, what
        ));
    }
    let mut what = what;
    for p in 0..sites.positions.len() {
        let seen = seen_from(basis, grid, (sites, p), fields, places);
        what.take::<One, 1, true>(One, Group { first: p, count: 1 }, &seen);
    }
    what
}

/// The same of one particle, for a basis that is no product.
fn seen_from<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    (sites, p): (Sites<'_, T, D>, usize),
    [velocities, accelerations]: [&[SVector<T, D>]; 2],
    places: &DofPlaces<T, D>,
) -> Seen<T, D> {
    let x = &sites.positions[p];
    let mut seen = GridVelocity::none(T::zero(), SVector::zeros());
    sites.for_each(basis, grid, p, |i, phi, gradient| {
        let offset = places.offset(grid, i, (&sites.cells[p], x));
        seen.see(phi, &gradient, &offset, (&velocities[i], &accelerations[i]));
    });
    Seen {
        velocity: seen.velocity.into(),
        acceleration: seen.acceleration.into(),
        gradient: rows(&seen.gradient),
        moment: rows(&seen.moment),
        second_moment: seen.second_moment.into(),
    }
}

fn rows<T: Scalar, const D: usize>(matrix: &SMatrix<T, D, D>) -> [[T; D]; D] {
    std::array::from_fn(|c| std::array::from_fn(|a| matrix[(c, a)]))
}

#[inline(always)]
fn in_packs<
    T: Scalar,
    const D: usize,
    B: BasisFamily<T, D>,
    K: Packs<T, N>,
    const N: usize,
    W: Receive<T, D>,
>(
    k: K,
    sweep: &Sweep<'_, T, D, B>,
    sites: Sites<'_, T, D>,
    fields: [&[SVector<T, D>]; 2],
    places: &DofPlaces<T, D>,
    what: W,
) -> W {
    let cells = sites.cells;
    let mut groups = Gathering {
        k,
        sweep,
        positions: &sites.positions[..cells.len()],
        half_lengths: sites.domains.half_lengths,
        cells,
        fields,
        places,
        what: what.cut(cells.len()),
    };
    each_group(cells, &mut groups);
    groups.what
}

/// The sweep over the groups.
struct Gathering<'a, T, K, const D: usize, B, W> {
    k: K,
    sweep: &'a Sweep<'a, T, D, B>,
    positions: &'a [SVector<T, D>],
    half_lengths: &'a [SVector<T, D>],
    cells: &'a [Cell<D>],
    fields: [&'a [SVector<T, D>]; 2],
    places: &'a DofPlaces<T, D>,
    what: W,
}

impl<T, K, const D: usize, const N: usize, B, W> EachGroup<N> for Gathering<'_, T, K, D, B, W>
where
    T: Scalar,
    K: Packs<T, N>,
    B: BasisFamily<T, D>,
    W: Receive<T, D>,
{
    #[inline(always)]
    fn take<const FULL: bool>(&mut self, group: Group<N>) {
        let (k, sweep, [velocities, accelerations]) = (self.k, self.sweep, self.fields);
        let cell = &self.cells[group.first];
        let x = group.vectors::<FULL, T, K, D>(k, self.positions);
        let factors = sweep.factors::<FULL, K, N>(k, group, (cell, &x), self.half_lengths);
        let moments = sweep.moments(k, (cell, &x), &factors, self.places);
        let first = sweep.first_dof(cell);
        let (velocity, slopes) = sweep.value_and_slopes(k, first, &factors, velocities);
        let inverse = sweep.inverse(k);
        let gradient: [[K::V; D]; D] = each(
            #[inline(always)]
            |c| {
                each(
                    #[inline(always)]
                    |a| slopes[c][a] * inverse[a],
                )
            },
        );
        let seen = Seen {
            velocity,
            acceleration: sweep.value(k, first, &factors, accelerations),
            gradient,
            moment: sweep.value_and_slopes(k, first, &moments, velocities).1,
            second_moment: sweep.second_moments(k, (cell, &x), &moments, self.places),
        };
        self.what.take::<K, N, FULL>(k, group, &seen);
    }
}
