//! Moving values towards the fits.

use super::cells::{Kind, own_fit, wide_coefficients};
use super::four::{NONE, middle};
use super::pull::{CorrectionRows, Corrections, keep_corrections};
use super::stream::difference;
use super::{ALIKE, GROUPS, RelaxedTaylor};
use crate::field::Field;
use crate::parallel::each_span;
use crate::reconstruction::taylor::{CellGroup, Weighted, local};
use crate::reconstruction::{Cloud, CourantNumbers, Patch, Stored};
use crate::scalar::Scalar;
use crate::simd::{LANES, Number, Packs, dispatch};
use crate::taylor::{CellFit, FEW_COMPONENTS, MOST_COMPONENTS, Rights, are_few, factorise};

impl<T: Scalar, const D: usize, const NB: usize> RelaxedTaylor<T, D, NB> {
    /// Moves the values towards the fits of their own cell and through its neighbours.
    pub(super) fn relax_towards_both<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        crossed: &[CourantNumbers<T>],
        values: &mut [Q],
    ) {
        let taken: &[Q] = values;
        self.sum_field(cloud, &Stored(taken));
        let mut pulls = std::mem::replace(&mut self.pulls, Corrections::none());
        let rows = pulls.rows(self.cells.len(), NB * Q::COMPONENTS);
        let this = &*self;
        each_span(self.share_groups(), GROUPS, rows, &|first, rows| {
            if const { are_few::<T, Q, D>() } {
                dispatch!(T, |k| this
                    .correct_towards_both::<_, Q, FEW_COMPONENTS>(k, crossed, first, rows));
            } else {
                dispatch!(T, |k| this
                    .correct_towards_both::<_, Q, MOST_COMPONENTS>(k, crossed, first, rows));
            }
        });
        pulls.apply::<Q, D, NB>(cloud, values);
        for place in 0..self.cells.len() {
            if self.cells[place].kind == Kind::Fallback {
                self.relax_alone(cloud, place, crossed, values);
            }
        }
        self.pulls = pulls;
    }

    #[inline(always)]
    fn correct_towards_both<K: Packs<T>, Q: Field<T>, const C: usize>(
        &self,
        k: K,
        crossed: &[CourantNumbers<T>],
        first: usize,
        rows: CorrectionRows<'_, T>,
    ) {
        let sums = self.kept_sums::<Q>();
        let zero = k.splat(T::zero());
        for (n, row) in rows.groups().enumerate() {
            let group = first + n;
            let fits = &self.fits[group];
            let (mut own, mut neighbours) = ([T::zero(); LANES], [T::zero(); LANES]);
            for (l, place) in self.places(group).enumerate() {
                if self.cells[place].kind == Kind::Batch {
                    [own[l], neighbours[l]] = self.relaxation.shares(crossed[place]);
                    if !fits.wide_is_full()[l] || !self.are_alike(crossed, place) {
                        neighbours[l] = T::zero();
                    }
                }
            }
            let seen = fits.own_coefficients(k, &sums.load::<K, NB, C>(k, group), Q::COMPONENTS);
            let mut wide = fits.wide_coefficients::<K, C>(k, group, &sums);
            if self.keeps_means {
                fits.keep_means_of_cells::<K, C>(k, group, &self.grams[group], &sums, &mut wide);
            }
            let mut pull: Rights<K::V, NB, C> = [[zero; C]; NB];
            let shares = [k.pack(own), k.pack(neighbours)];
            for n in 0..NB {
                for q in 0..Q::COMPONENTS {
                    pull[n][q] = wide[n][q].mul_add(shares[1], seen[n][q] * shares[0]);
                }
            }
            let shares = k.array(shares[0] + shares[1]);
            keep_corrections::<T, K, NB, C>(k, &pull, Q::COMPONENTS, shares, row);
        }
    }

    /// Whether waves are about as fast in the neighbours of a cell as in itself: stress may jump where the
    /// material changes.
    fn are_alike(&self, crossed: &[CourantNumbers<T>], place: usize) -> bool {
        let [mut slowest, mut fastest] = [crossed[place].wave; 2];
        for other in self.fits[place / LANES].neighbours.iter().flatten() {
            let other = other[place % LANES];
            if other != NONE {
                slowest = slowest.min(crossed[other as usize].wave);
                fastest = fastest.max(crossed[other as usize].wave);
            }
        }
        fastest <= slowest * T::lit(ALIKE)
    }

    /// The same in one cell that is fitted alone. The kept sums are those of before.
    #[cold]
    #[inline(never)]
    fn relax_alone<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        place: usize,
        crossed: &[CourantNumbers<T>],
        values: &mut [Q],
    ) {
        let cell = cloud.bins.occupied()[place] as usize;
        let (whole, patch) = (Patch::whole(cloud.grid, cell), self.patch(cloud, place));
        let samples = local(cloud, cell, &patch).map(|(p, s)| (s, T::one(), values[p]));
        let own_fit = own_fit::<T, D, NB>(cloud, cell, &patch, self.tolerance);
        let seen = own_fit.coefficients(samples, Q::zero());
        let mut wide = if self.are_alike(crossed, place) {
            wide_coefficients::<T, D, NB, Q>(cloud, place, &self.kept_sums::<Q>(), self.tolerance)
        } else {
            None
        };
        if let (true, Some(wide)) = (self.keeps_means, &mut wide) {
            keep_means_of_cells(cloud, [&whole, &patch], &own_fit, values, wide);
        }
        let [own, neighbours] = self.relaxation.shares(crossed[place]);
        for (p, s) in local(cloud, cell, &patch) {
            let old = values[p];
            values[p].add_scaled(own, difference(&s, &seen, old));
            if let Some(wide) = &wide {
                let s = whole.local(&cloud.positions[p]);
                values[p].add_scaled(neighbours, difference(&s, wide, old));
            }
        }
    }

    /// Moves the values towards the weighted fit of their own cell.
    pub(super) fn relax_towards_own<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        weights: &[T],
        crossed: &[CourantNumbers<T>],
        values: &mut [Q],
    ) {
        let taken: &[Q] = values;
        let mut pulls = std::mem::replace(&mut self.pulls, Corrections::none());
        let rows = pulls.rows(self.cells.len(), NB * Q::COMPONENTS);
        let this = &*self;
        each_span(self.share_groups(), GROUPS, rows, &|first, rows| {
            if const { are_few::<T, Q, D>() } {
                dispatch!(T, |k| this.correct_towards_own::<_, Q, FEW_COMPONENTS>(
                    k,
                    cloud,
                    weights,
                    crossed,
                    (first, rows),
                    taken
                ));
            } else {
                dispatch!(T, |k| this.correct_towards_own::<_, Q, MOST_COMPONENTS>(
                    k,
                    cloud,
                    weights,
                    crossed,
                    (first, rows),
                    taken
                ));
            }
        });
        pulls.apply::<Q, D, NB>(cloud, values);
        for (place, cell) in self.cells.iter().enumerate() {
            if cell.kind == Kind::Fallback || pulls.is_left(place) {
                self.relax_alone_towards_own(cloud, place, weights, crossed, values);
            }
        }
        self.pulls = pulls;
    }

    #[inline(always)]
    fn correct_towards_own<K: Packs<T>, Q: Field<T>, const C: usize>(
        &self,
        k: K,
        cloud: &Cloud<'_, T, D>,
        weights: &[T],
        crossed: &[CourantNumbers<T>],
        (first, rows): (usize, CorrectionRows<'_, T>),
        values: &[Q],
    ) {
        // A copy: a compiler then knows that what is written leaves it alone.
        let cloud = &{ *cloud };
        for (n, row) in rows.groups().enumerate() {
            let places = self.places(first + n);
            let group = CellGroup::new(cloud, places.clone());
            let sums =
                group.sums::<Weighted, T, K, Q, NB, C>(k, cloud, places.clone(), &Stored(values), weights);
            let fits = factorise::<T, K, D, NB>(k, &sums.gram, 0, &group.counts, self.tolerance);
            let mut shares = [T::zero(); LANES];
            for (l, place) in places.enumerate() {
                if self.cells[place].kind == Kind::Batch {
                    [shares[l], _] = self.relaxation.shares(crossed[place]);
                }
            }
            let mut pull: Rights<K::V, NB, C> = [[k.splat(T::zero()); C]; NB];
            let share = k.pack(shares);
            for q in 0..Q::COMPONENTS {
                fits.factor
                    .solve::<T, C>(k.splat(T::zero()), 0, q, &sums.right, &mut pull);
                for function in &mut pull {
                    function[q] = function[q] * share;
                }
            }
            for l in 0..LANES {
                if fits.hard[l] && shares[l] > T::zero() {
                    shares[l] = Corrections::left();
                }
            }
            keep_corrections::<T, K, NB, C>(k, &pull, Q::COMPONENTS, shares, row);
        }
    }

    #[cold]
    #[inline(never)]
    fn relax_alone_towards_own<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        place: usize,
        weights: &[T],
        crossed: &[CourantNumbers<T>],
        values: &mut [Q],
    ) {
        let cell = cloud.bins.occupied()[place] as usize;
        let patch = if self.cells[place].kind == Kind::Fallback {
            self.patch(cloud, place)
        } else {
            Patch::whole(cloud.grid, cell)
        };
        let [share, _] = self.relaxation.shares(crossed[place]);
        let points = local(cloud, cell, &patch).map(|(p, s)| (s, weights[p]));
        let samples = local(cloud, cell, &patch).map(|(p, s)| (s, weights[p], values[p]));
        let fit = CellFit::<T, NB>::weighted(points, 0, self.tolerance);
        let seen = fit.coefficients(samples, Q::zero());
        for (p, s) in local(cloud, cell, &patch) {
            let unseen = difference(&s, &seen, values[p]);
            values[p].add_scaled(share, unseen);
        }
    }
}

/// [`super::four::FourFits::keep_means_of_cells`] in one cell, `whole`, of which there is only `patch`.
fn keep_means_of_cells<T: Scalar, const D: usize, const NB: usize, Q: Field<T>>(
    cloud: &Cloud<'_, T, D>,
    [whole, patch]: [&Patch<T, D>; 2],
    own_fit: &CellFit<T, NB>,
    values: &[Q],
    wide: &mut [Q; NB],
) {
    let points = || local(cloud, cloud.grid.linear(&whole.cell), patch);
    let seen = &*wide;
    let samples = points().map(|(p, s)| {
        let beside = difference(&whole.local(&cloud.positions[p]), seen, values[p]);
        (s, T::one(), beside.scaled(-T::one()))
    });
    let rest = own_fit.coefficients(samples, Q::zero());
    let count = points().fold(T::zero(), |count, _| count + T::one());
    for axis in 0..D {
        let sum = points().fold(T::zero(), |sum, (_, s)| sum + s[axis]);
        wide[0].add_scaled(-middle(sum, count), rest[1 + axis]);
    }
}
