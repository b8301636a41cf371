//! Streaming the fits.

use std::ops::Range;

use super::RelaxedTaylor;
use super::cells::{Kind, ended_patch, own_fit, wide_coefficients};
use super::four::{KeptSums, keep_sums};
use crate::field::Field;
use crate::parallel::{Rows, each_span};
use crate::reconstruction::gauss::polynomial;
use crate::reconstruction::taylor::{CellGroup, OfValues, local};
use crate::reconstruction::{Cloud, Patch, Point, Values};
use crate::scalar::Scalar;
use crate::simd::{LANES, Packs, dispatch};
use crate::taylor::{FEW_COMPONENTS, MOST_COMPONENTS, Rights, are_few, taylor_functions};

impl<T: Scalar, const D: usize, const NB: usize> RelaxedTaylor<T, D, NB> {
    /// Sums the functions times a field over the particles of each cell.
    pub(super) fn sum_field<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        value: &(impl Values<T, Q> + Sync),
    ) {
        let mut kept = std::mem::take(&mut self.sums);
        // All are written below: what a list of this length holds may stay.
        kept.resize(self.fits.len() * NB * Q::COMPONENTS, [T::zero(); LANES]);
        let work = Rows {
            values: &mut kept[..],
            width: NB * Q::COMPONENTS,
        };
        let this = &*self;
        each_span(self.share_groups(), super::GROUPS, work, &|first, kept| {
            if const { are_few::<T, Q, D>() } {
                dispatch!(T, |k| this.sums_in::<_, Q, _, FEW_COMPONENTS>(
                    k,
                    cloud,
                    first,
                    value,
                    kept.values
                ));
            } else {
                dispatch!(T, |k| this.sums_in::<_, Q, _, MOST_COMPONENTS>(
                    k,
                    cloud,
                    first,
                    value,
                    kept.values
                ));
            }
        });
        self.sums = kept;
    }

    #[inline(always)]
    fn sums_in<K: Packs<T>, Q: Field<T>, F: Values<T, Q>, const C: usize>(
        &self,
        k: K,
        cloud: &Cloud<'_, T, D>,
        first: usize,
        value: &F,
        kept: &mut [[T; LANES]],
    ) {
        // A copy: a compiler then knows that what is written leaves it alone.
        let cloud = &{ *cloud };
        for (n, kept) in kept.chunks_exact_mut(NB * Q::COMPONENTS).enumerate() {
            let places = self.places(first + n);
            let group = CellGroup::new(cloud, places.clone());
            let sums = group.sums::<OfValues, T, K, Q, NB, C>(k, cloud, places, value, cloud.volumes);
            keep_sums::<T, K, NB, C>(k, &sums.right, Q::COMPONENTS, kept);
        }
    }

    /// The sums of the field that was taken in last.
    pub(super) fn kept_sums<Q: Field<T>>(&self) -> KeptSums<'_, T> {
        KeptSums {
            values: &self.sums,
            components: Q::COMPONENTS,
        }
    }

    /// Coefficients of what is integrated in four cells.
    #[inline(always)]
    pub(super) fn integrated<K: Packs<T>, Q: Field<T>, const C: usize>(
        &self,
        k: K,
        group: usize,
    ) -> Rights<K::V, NB, C> {
        let sums = self.kept_sums::<Q>();
        self.fits[group].integrated(k, group, &self.grams[group], &sums)
    }

    /// Streams the fits of whole cells, four at a time, and the other ones. Compiled once for all bases: what
    /// a point is handed to is called through a pointer. Steps come here where four cells cannot be
    /// integrated at once only.
    #[inline(never)]
    pub(super) fn integrate_each<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        value: &dyn Fn(usize) -> Q,
        sink: &mut dyn FnMut(&Point<T, D>, Q),
    ) {
        dispatch!(T, |k| self.integrate_in(k, cloud, cells, value, sink));
    }

    #[inline(always)]
    fn integrate_in<K: Packs<T>, Q: Field<T>>(
        &self,
        k: K,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        value: &dyn Fn(usize) -> Q,
        mut sink: &mut dyn FnMut(&Point<T, D>, Q),
    ) {
        // A copy: a compiler then knows that what is written leaves it alone.
        let cloud = &{ *cloud };
        let mut coefficients = [[k.splat(T::zero()); MOST_COMPONENTS]; NB];
        let mut at_hand = None;
        for place in cells {
            if self.cells[place].kind != Kind::Batch {
                self.integrate_apart(cloud, place, value, sink);
                continue;
            }
            if at_hand != Some(place / LANES) {
                at_hand = Some(place / LANES);
                coefficients = self.integrated::<K, Q, MOST_COMPONENTS>(k, place / LANES);
            }
            let mut of_cell = [Q::zero(); NB];
            for n in 0..NB {
                for q in 0..Q::COMPONENTS {
                    of_cell[n].set_component(q, k.array(coefficients[n][q])[place % LANES]);
                }
            }
            let patch = Patch::whole(cloud.grid, cloud.bins.occupied()[place] as usize);
            self.rule.emit(&patch, &of_cell, &mut sink);
        }
    }

    /// Streams one cell that is not fitted with others.
    #[cold]
    #[inline(never)]
    pub(super) fn integrate_apart<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        place: usize,
        value: &dyn Fn(usize) -> Q,
        mut sink: &mut dyn FnMut(&Point<T, D>, Q),
    ) {
        let (value, sink) = (&value, &mut sink);
        let cell = cloud.bins.occupied()[place] as usize;
        if self.cells[place].kind == Kind::Open {
            return emit_particles(cloud, cell, value, sink);
        }
        let (whole, patch) = (Patch::whole(cloud.grid, cell), self.patch(cloud, place));
        let own = own_fit::<T, D, NB>(cloud, cell, &patch, self.tolerance);
        let samples = local(cloud, cell, &patch).map(|(p, s)| (s, T::one(), value(p)));
        let seen = if self.cells[place].is_full {
            None
        } else {
            wide_coefficients::<T, D, NB, Q>(cloud, place, &self.kept_sums::<Q>(), self.tolerance)
        };
        let coefficients = match seen {
            // What the neighbours see, and on top of it what the own particles see beside that.
            Some(seen) => {
                self.rule.emit_in_frame(&patch, &whole, &seen, sink);
                let rest = samples.map(|(s, weight, value)| {
                    let s_whole = whole.local(&patch.position(&s));
                    (s, weight, difference(&s_whole, &seen, value).scaled(-T::one()))
                });
                own.coefficients(rest, Q::zero())
            }
            None => own.coefficients(samples, Q::zero()),
        };
        self.rule.emit(&patch, &coefficients, sink);
    }

    /// What a cell that is fitted alone covers.
    pub(super) fn patch(&self, cloud: &Cloud<'_, T, D>, place: usize) -> Patch<T, D> {
        let cell = cloud.bins.occupied()[place] as usize;
        ended_patch(cloud, cell, &self.fits[place / LANES].open_sides(place % LANES))
    }
}

/// What takes the `value` at `s` to the polynomial.
#[inline(always)]
pub(super) fn difference<T: Scalar, const D: usize, const NB: usize, Q: Field<T>>(
    s: &nalgebra::SVector<T, D>,
    coefficients: &[Q; NB],
    value: Q,
) -> Q {
    let mut difference = polynomial(&taylor_functions(s), coefficients);
    difference.add_scaled(-T::one(), value);
    difference
}

/// Streams the values at the particles of a cell.
#[inline(always)]
fn emit_particles<T: Scalar, const D: usize, Q: Field<T>>(
    cloud: &Cloud<'_, T, D>,
    cell: usize,
    value: &impl Fn(usize) -> Q,
    sink: &mut impl FnMut(&Point<T, D>, Q),
) {
    for &p in cloud.bins.particles_in(cell) {
        let p = p as usize;
        sink(&Point::of_particle(cloud, p), value(p).scaled(cloud.volumes[p]));
    }
}
