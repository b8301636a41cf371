//! Taylor least squares.

mod cell_group;
mod runs;
#[cfg(test)]
mod tests;
mod virtual_points;

use std::ops::Range;

use nalgebra::SVector;

pub(super) use cell_group::{CellGroup, OfValues, Products, Weighted};
use cell_group::{Conserved, ConservedValues, Free};
use virtual_points::Lent;

use super::gauss::GaussRule;
use super::{
    BatchStatus, CellStream, Cloud, InFours, Kept, NoFilter, Patch, Point, Reconstruction, Streams, Values,
};
use crate::basis::BasisFamily;
use crate::field::Field;
use crate::grid::Cell;
use crate::mass::VelocityMass;
use crate::parallel::{self, each_span};
use crate::scalar::Scalar;
use crate::simd::{LANES, Packs, each};
use crate::taylor::{
    BatchSums, CellFit, FourFits, Gram, MOST_COMPONENTS, Rights, SharedFactor, default_tolerance,
    keep_products, kept, kept_products, taylor_functions,
};

/// Calls with the least number `C` of those that arrays for so many components may have: what is not used of
/// an array is written all the same.
macro_rules! with_room {
    ($components:expr, |$c:ident| $call:expr) => {
        if const { $components <= 1 } {
            const $c: usize = 1;
            $call
        } else if const { $components <= 2 } {
            const $c: usize = 2;
            $call
        } else if const { $components <= 4 } {
            const $c: usize = 4;
            $call
        } else if const { $components <= 6 } {
            const $c: usize = 6;
            $call
        } else {
            const $c: usize = MOST_COMPONENTS;
            $call
        }
    };
}

/// Taylor least squares (Wobbes, Moller, Galavi & Vuik 2019): in each cell $e$ a polynomial of `NB` Taylor
/// functions through the particles' values, integrated by Gauss quadrature. `NB` = 3, 6, 10 in 1, 2, 3
/// dimensions.
///
/// $$\hat q_e = \sum_k a_k\psi_k,\qquad \int_e\hat q_e = a_1|e|.$$
///
/// Fields (stress) are fitted freely; densities (mass, momentum) keep the cell's integral, because their
/// $a_1$ is the cell's amount over its volume (journal, equation 14). A cell that a body's surface cuts is
/// fitted and integrated up to the surface ([`Cloud::cuts`]). The functions are those of
/// [`mod@crate::taylor`].
///
/// A density of mass stays positive at the Gauss points (at least 1 % of the cell's mean): where a fit would
/// be less, all its coefficients but $a_1$, and those of the momentum beside it, are scaled by one factor,
/// which keeps the cell's integrals.
///
/// A cell never uses more functions than it has points, nor one that its layout cannot tell from the others:
/// that share of each function is measured before it is fitted. Where the particles do not determine all
/// functions, *virtual points* can lend a hand ([`Taylor::with_virtual_points`]); what they do not determine
/// either is left out.
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Debug)]
pub struct Taylor<T, const D: usize, const NB: usize> {
    rule: GaussRule<T, D, NB>,
    tolerance: T,
    virtual_points: bool,
    cells: Vec<CellFits<T, D, NB>>,
    /// Cells without the full set of functions, and cells with virtual points.
    reduced: usize,
    lent: usize,
    /// Cells in which a density was kept positive, in the last stream of all.
    limited: usize,
}

/// The fits of one occupied cell and the box they cover.
#[derive(Clone, Debug)]
struct CellFits<T, const D: usize, const NB: usize> {
    patch: Patch<T, D>,
    free: CellFit<T, NB>,
    conserved: CellFit<T, NB>,
    /// Sums of the Taylor functions over the particles.
    sums: SVector<T, NB>,
    /// Where either fit has a virtual point.
    lent: Lent,
}

impl<T: Scalar, const D: usize, const NB: usize> CellFits<T, D, NB> {
    /// Of no particles.
    fn empty(cloud: &Cloud<'_, T, D>) -> Self {
        let nothing = std::iter::empty::<(SVector<T, D>, T)>();
        let fit = CellFit::weighted(nothing, 0, T::one());
        Self {
            patch: cloud.patch(0),
            free: fit,
            conserved: fit,
            sums: SVector::zeros(),
            lent: Lent::default(),
        }
    }

    /// Of the particles in the cell with number `cell`.
    #[inline(always)]
    fn new(cloud: &Cloud<'_, T, D>, cell: usize, tolerance: T) -> Self {
        let patch = cloud.patch(cell);
        let points = local(cloud, cell, &patch).map(|(_, s)| (s, T::one()));
        let gram = Gram::new(points.clone());
        Self {
            patch,
            free: CellFit::with_gram(&gram, points.clone(), 0, tolerance),
            conserved: CellFit::with_gram(&gram, points, 1, tolerance),
            sums: SVector::from_fn(|k, _| gram.sum(k)),
            lent: Lent::default(),
        }
    }

    fn free_is_full(&self) -> bool {
        self.free.functions() == NB
    }

    /// The given mean is one of the functions and not counted.
    fn conserved_is_full(&self) -> bool {
        self.conserved.functions() + 1 == NB
    }

    /// Whether both fits have all functions.
    fn is_full(&self) -> bool {
        self.free_is_full() && self.conserved_is_full()
    }
}

/// An occupied cell: its place in the list of those, its number, its fits.
#[derive(Clone, Copy)]
struct Occupied<'a, T, const D: usize, const NB: usize> {
    place: usize,
    number: usize,
    fits: &'a CellFits<T, D, NB>,
}

impl<T: Scalar, const D: usize, const NB: usize> Default for Taylor<T, D, NB> {
    fn default() -> Self {
        Self::with_gauss_points(2)
    }
}

impl<T: Scalar, const D: usize, const NB: usize> Taylor<T, D, NB> {
    /// The method as published: two Gauss points per cell and axis.
    pub fn new() -> Self {
        Self::default()
    }

    /// For a basis, as [`Taylor::for_degree`] of its degree.
    pub fn for_basis<B: BasisFamily<T, D>>(basis: &B) -> Self {
        Self::for_degree(basis.degree())
    }

    /// For a basis of degree `degree`: two Gauss points per cell and axis as published for degrees 1 and 2,
    /// `degree + 1` beyond. Two points would make a cubic basis lose an order in the stress, because they
    /// integrate its mass matrix too crudely.
    pub fn for_degree(degree: usize) -> Self {
        Self::with_gauss_points(GaussRule::<T, D, NB>::points_for_degree(degree))
    }

    /// With `n >= 1` Gauss points per cell and axis. Two integrate the quadratic fit exactly.
    pub fn with_gauss_points(n: usize) -> Self {
        Self {
            rule: GaussRule::new(n),
            tolerance: default_tolerance(D),
            virtual_points: false,
            cells: Vec::new(),
            reduced: 0,
            lent: 0,
            limited: 0,
        }
    }

    /// Drops a function where, on a cell's particles, less than the share `tolerance` of it is left after the
    /// functions before it ([`default_tolerance`]).
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: T) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Lets a cell whose particles do not determine its fit borrow *virtual points* (journal section 5.3), in
    /// one dimension and where there are particles in both neighbouring cells: from each of these that is
    /// fitted by its own particles with all functions, the value of that fit at the common edge is one more
    /// point of the least squares. It never enters the mean, so every amount is kept as without. Off by
    /// default: a smooth field is fitted much better, but runs are no more accurate (figures in
    /// `docs/verification/stability.md`).
    #[must_use]
    pub fn with_virtual_points(mut self, lent: bool) -> Self {
        self.virtual_points = lent;
        self
    }

    /// Cells in which the last [`Reconstruction::integrate_conserved`] had to keep a density positive
    /// ([`Field::DENSITIES`]), and drew all that it streamed towards its mean. What belongs to those
    /// densities must be streamed together with them there.
    pub fn limited_cells(&self) -> usize {
        self.limited
    }

    /// Coefficients of the conserved fit in every occupied cell, ascending, from the amounts (the fit's mean
    /// is the cell's sum of amounts over its volume).
    pub fn conserved_coefficients<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        amount: impl Fn(usize) -> Q,
    ) -> Vec<[Q; NB]> {
        self.occupied(cloud, 0..self.cells.len())
            .map(|cell| self.rule.keep_positive(self.conserved(cloud, cell, &amount)).0)
            .collect()
    }

    /// Coefficients in every occupied cell, ascending, of the fit through the `value`s whose mean is
    /// `mean(cell)`.
    pub fn coefficients_with_mean<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        value: impl Fn(usize) -> Q,
        mean: impl Fn(&Cell<D>) -> Q,
    ) -> Vec<[Q; NB]> {
        self.occupied(cloud, 0..self.cells.len())
            .map(|cell| self.about_mean(cloud, cell, &value, &mean))
            .collect()
    }

    /// Streams the fit through the `value`s whose mean is `mean(cell)`: to keep an integral that is known
    /// from elsewhere.
    pub fn integrate_with_mean<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        value: impl Fn(usize) -> Q,
        mean: impl Fn(&Cell<D>) -> Q,
        mut sink: impl FnMut(&Point<T, D>, Q),
    ) {
        let coefficients = self.coefficients_with_mean(cloud, value, mean);
        for (fits, coefficients) in self.cells.iter().zip(&coefficients) {
            self.rule.emit(&fits.patch, coefficients, &mut sink);
        }
    }

    /// Coefficients of the free fit in every occupied cell, ascending.
    pub fn free_coefficients<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        value: impl Fn(usize) -> Q,
    ) -> Vec<[Q; NB]> {
        self.occupied(cloud, 0..self.cells.len())
            .map(|cell| self.free(cloud, cell, &value))
            .collect()
    }

    /// The cells at these places in the list of occupied ones.
    #[inline(always)]
    fn occupied(
        &self,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
    ) -> impl Iterator<Item = Occupied<'_, T, D, NB>> {
        let numbers = cloud.bins.occupied()[cells.clone()].iter();
        let numbers = numbers.zip(&self.cells[cells.clone()]);
        cells.zip(numbers).map(|(place, (&number, fits))| Occupied {
            place,
            number: number as usize,
            fits,
        })
    }

    /// Coefficients of the free fit.
    #[inline(always)]
    fn free<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cell: Occupied<'_, T, D, NB>,
        value: &impl Fn(usize) -> Q,
    ) -> [Q; NB] {
        if const { D == 1 } && cell.fits.lent.to_free() {
            return self.free_with_lent(cloud, cell.place, value);
        }
        free(cell.fits, cloud, cell.number, value)
    }

    /// The same of the conserved fit.
    #[inline(always)]
    fn conserved<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cell: Occupied<'_, T, D, NB>,
        amount: &impl Fn(usize) -> Q,
    ) -> [Q; NB] {
        if const { D == 1 } && cell.fits.lent.to_conserved() {
            return self.conserved_with_lent(cloud, cell.place, amount);
        }
        conserved(cell.fits, cloud, cell.number, amount)
    }

    /// Streams the conserved fits in `cells`, places in the list of occupied ones; returns in how many a
    /// density had to be kept positive.
    #[inline(always)]
    fn stream_conserved<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        amount: &impl Fn(usize) -> Q,
        mut sink: impl FnMut(&Point<T, D>, Q),
    ) -> usize {
        let mut limited = 0;
        for cell in self.occupied(cloud, cells) {
            let (coefficients, drawn) = self.rule.keep_positive(self.conserved(cloud, cell, amount));
            limited += usize::from(drawn);
            self.rule.emit(&cell.fits.patch, &coefficients, &mut sink);
        }
        limited
    }

    /// The same of the fit with a given mean.
    fn about_mean<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cell: Occupied<'_, T, D, NB>,
        value: &impl Fn(usize) -> Q,
        mean: &impl Fn(&Cell<D>) -> Q,
    ) -> [Q; NB] {
        if const { D == 1 } && cell.fits.lent.to_conserved() {
            return self.about_mean_with_lent(cloud, cell.place, value, mean);
        }
        let mean = mean(&cell.fits.patch.cell);
        fit_about_mean(cell.fits, cloud, cell.number, value, mean)
    }

    /// [`Streams::integrate_batch`] of a field of not more than `C` components.
    #[inline(always)]
    fn integrate_few<K: Packs<T>, Q: Field<T>, const C: usize>(
        &self,
        k: K,
        (cloud, cells): (&Cloud<'_, T, D>, Range<usize>),
        conserve: bool,
        kept: Kept<'_, T>,
        value: &impl Values<T, Q>,
        mut sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus {
        let mut coefficients = [[k.splat(T::zero()); C]; NB];
        let four = self.fit_four::<K, Q, C>(k, (cloud, cells), conserve, kept, value, &mut coefficients);
        let volume = cloud.grid.cell_volume();
        self.rule
            .emit_lanes(k, volume, &coefficients, Q::COMPONENTS, &mut sink);
        four
    }

    /// [`Streams::fit_batch`] likewise.
    #[inline(always)]
    fn fit_few<K: Packs<T>, Q: Field<T>, const C: usize>(
        &self,
        k: K,
        place: (&Cloud<'_, T, D>, Range<usize>),
        conserve: bool,
        kept: Kept<'_, T>,
        value: &impl Values<T, Q>,
        sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus {
        let mut coefficients = [[k.splat(T::zero()); C]; NB];
        let four = self.fit_four::<K, Q, C>(k, place, conserve, kept, value, &mut coefficients);
        hand_over(k, &coefficients, Q::COMPONENTS, sink);
        four
    }

    /// Coefficients of the fits of four cells. Out of line: it knows nothing of a basis, and is compiled once
    /// for all.
    #[inline(never)]
    fn fit_four<K: Packs<T>, Q: Field<T>, const C: usize>(
        &self,
        k: K,
        place: (&Cloud<'_, T, D>, Range<usize>),
        conserve: bool,
        kept: Kept<'_, T>,
        value: &impl Values<T, Q>,
        coefficients: &mut Rights<K::V, NB, C>,
    ) -> BatchStatus {
        k.run(
            #[inline(always)]
            move || self.fit_here::<K, Q, C>(k, place, conserve, kept, value, coefficients),
        )
    }

    #[inline(always)]
    fn fit_here<K: Packs<T>, Q: Field<T>, const C: usize>(
        &self,
        k: K,
        (cloud, cells): (&Cloud<'_, T, D>, Range<usize>),
        conserve: bool,
        kept: Kept<'_, T>,
        value: &impl Values<T, Q>,
        coefficients: &mut Rights<K::V, NB, C>,
    ) -> BatchStatus {
        let cloud = &{ *cloud };
        let group = CellGroup::new(cloud, cells.clone());
        let mut fits = if conserve {
            self.fit_conserved::<K, Q, C>(k, (cloud, &group, cells), kept, value)
        } else {
            let sums = group.sums::<Free, T, K, Q, NB, C>(k, cloud, cells, value, cloud.volumes);
            self.fit_free::<K, Q, C>(k, &group, kept, &sums)
        };
        let mut hard = fits.hard;
        let mut negative = false;
        if conserve {
            let any = self.rule.may_be_negative::<K, Q, C>(k, &fits.coefficients);
            negative = any != [false; LANES];
            hard = each(
                #[inline(always)]
                |l| hard[l] || any[l],
            );
        }
        if !cloud.cuts.is_empty() {
            hard = each(
                #[inline(always)]
                |l| hard[l] || cloud.is_cut(&group.cells[l]),
            );
        }
        for n in 0..NB {
            for q in 0..Q::COMPONENTS {
                coefficients[n][q] = fits.coefficients[n][q];
            }
        }
        let mut four = BatchStatus::default();
        // What usually is so, and sooner found out than whether each cell is hard.
        if fits.are_full && !negative && cloud.cuts.is_empty() {
            return four;
        }
        let first = usize::from(conserve);
        for l in 0..group.len {
            four.hard[l] = hard[l];
            fits.functions[l] += first;
            four.reduced += usize::from(!hard[l] && fits.functions[l] < NB);
        }
        four
    }

    /// The free fit, whose factor is kept if it will do for the other one too.
    #[inline(always)]
    fn fit_free<K: Packs<T>, Q: Field<T>, const C: usize>(
        &self,
        k: K,
        group: &CellGroup<D>,
        kept: Kept<'_, T>,
        sums: &BatchSums<K::V, NB, C>,
    ) -> FourFits<K::V, NB, C> {
        let shared = SharedFactor::new::<T, K, D>(k, &sums.gram, &group.counts, self.tolerance);
        if !kept.numbers.is_empty() {
            SharedFactor::keep::<T, K>(shared.as_ref(), k, kept.numbers);
            if shared.is_none() {
                keep_products::<T, K, NB>(k, &sums.gram, kept.numbers);
            }
        }
        match shared {
            Some(factor) => full_fits(k, &factor, true, &sums.right, Q::COMPONENTS),
            None => k.run(
                #[inline(always)]
                || sums.fit::<T, K, D>(k, 0, &group.counts, self.tolerance, Q::COMPONENTS),
            ),
        }
    }

    /// The fit of densities, whose means are known.
    #[inline(always)]
    fn fit_conserved<K: Packs<T>, Q: Field<T>, const C: usize>(
        &self,
        k: K,
        (cloud, group, cells): (&Cloud<'_, T, D>, &CellGroup<D>, Range<usize>),
        kept: Kept<'_, T>,
        value: &impl Values<T, Q>,
    ) -> FourFits<K::V, NB, C> {
        let shared = match kept.fresh {
            true => SharedFactor::kept::<T, K>(k, kept.numbers),
            false => None,
        };
        let Some(factor) = shared else {
            return self.fit_conserved_anew::<K, Q, C>(k, (cloud, cells), kept, value);
        };
        let mut sums: BatchSums<K::V, NB, C> =
            group.sums::<ConservedValues, T, K, Q, NB, C>(k, cloud, cells, value, cloud.volumes);
        for n in 1..NB {
            sums.gram[n][0] = factor.with_constant[n];
        }
        let mean = sums.take_out_mean::<T, K>(k, cloud.grid.cell_volume(), Q::COMPONENTS);
        let mut fits = full_fits(k, &factor, false, &sums.right, Q::COMPONENTS);
        fits.coefficients[0] = mean;
        fits
    }

    /// The same with a factorisation of its own.
    #[inline(never)]
    fn fit_conserved_anew<K: Packs<T>, Q: Field<T>, const C: usize>(
        &self,
        k: K,
        (cloud, cells): (&Cloud<'_, T, D>, Range<usize>),
        kept: Kept<'_, T>,
        value: &impl Values<T, Q>,
    ) -> FourFits<K::V, NB, C> {
        k.run(
            #[inline(always)]
            move || {
                let group = CellGroup::new(cloud, cells.clone());
                let products = match kept.fresh {
                    true => kept_products::<T, K, NB>(k, kept.numbers),
                    false => None,
                };
                let mut sums: BatchSums<K::V, NB, C> = match products {
                    Some(gram) => BatchSums {
                        gram,
                        ..group.sums::<ConservedValues, T, K, Q, NB, C>(k, cloud, cells, value, cloud.volumes)
                    },
                    None => group.sums::<Conserved, T, K, Q, NB, C>(k, cloud, cells, value, cloud.volumes),
                };
                let mean = sums.take_out_mean::<T, K>(k, cloud.grid.cell_volume(), Q::COMPONENTS);
                let mut fits = sums.fit::<T, K, D>(k, 1, &group.counts, self.tolerance, Q::COMPONENTS);
                fits.coefficients[0] = mean;
                fits
            },
        )
    }
}

/// Hands over the coefficients of each function.
#[inline(always)]
pub(super) fn hand_over<T: Scalar, K: Packs<T>, const NB: usize, const C: usize>(
    k: K,
    coefficients: &Rights<K::V, NB, C>,
    components: usize,
    mut sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
) {
    for n in 0..NB {
        let mut values = [k.splat(T::zero()); MOST_COMPONENTS];
        for q in 0..components {
            values[q] = coefficients[n][q];
        }
        sink(n, &values);
    }
}

/// Fits with all functions by a factor that cells share.
#[inline(always)]
fn full_fits<T: Scalar, K: Packs<T>, const NB: usize, const C: usize>(
    k: K,
    factor: &SharedFactor<K::V, NB>,
    all: bool,
    right: &Rights<K::V, NB, C>,
    components: usize,
) -> FourFits<K::V, NB, C> {
    let zero = k.splat(T::zero());
    let mut coefficients = [[zero; C]; NB];
    for q in 0..components {
        factor.solve::<T, C>(zero, all, q, right, &mut coefficients);
    }
    FourFits {
        coefficients,
        hard: [false; LANES],
        functions: [NB - usize::from(!all); LANES],
        are_full: true,
    }
}

/// Local coordinates in `patch` of the particles of the cell with number `cell`.
#[inline(always)]
pub(super) fn local<'a, T: Scalar, const D: usize>(
    cloud: &Cloud<'a, T, D>,
    cell: usize,
    patch: &Patch<T, D>,
) -> impl Iterator<Item = (usize, SVector<T, D>)> + Clone + 'a {
    let positions = cloud.positions;
    let patch = *patch;
    cloud.bins.particles_in(cell).iter().map(move |&p| {
        let p = p as usize;
        (p, patch.local(&positions[p]))
    })
}

#[inline(always)]
fn samples<'a, T: Scalar, const D: usize, Q: Field<T>>(
    cloud: &Cloud<'a, T, D>,
    cell: usize,
    patch: &Patch<T, D>,
    value: &'a impl Fn(usize) -> Q,
) -> impl Iterator<Item = (SVector<T, D>, T, Q)> + Clone + 'a {
    local(cloud, cell, patch).map(move |(p, s)| (s, T::one(), value(p)))
}

#[inline(always)]
fn free<T: Scalar, const D: usize, const NB: usize, Q: Field<T>>(
    fits: &CellFits<T, D, NB>,
    cloud: &Cloud<'_, T, D>,
    cell: usize,
    value: &impl Fn(usize) -> Q,
) -> [Q; NB] {
    let samples = samples(cloud, cell, &fits.patch, value);
    fits.free.coefficients(samples, Q::zero())
}

#[inline(always)]
fn conserved<T: Scalar, const D: usize, const NB: usize, Q: Field<T>>(
    fits: &CellFits<T, D, NB>,
    cloud: &Cloud<'_, T, D>,
    cell: usize,
    amount: &impl Fn(usize) -> Q,
) -> [Q; NB] {
    let inverse_volume = T::one() / fits.patch.volume();
    if !fits.conserved.is_well_spread() {
        let particles = cloud.bins.particles_in(cell).iter();
        let total = particles.fold(Q::zero(), |sum, &p| sum + amount(p as usize));
        let density = |p: usize| amount(p).scaled(T::one() / cloud.volumes[p]);
        return fit_about_mean(fits, cloud, cell, &density, total.scaled(inverse_volume));
    }
    // Total and sums in one pass; the mean is taken out of the sums afterwards.
    let (mut total, mut sums) = (Q::zero(), [Q::zero(); NB]);
    for (p, s) in local(cloud, cell, &fits.patch) {
        let psi = taylor_functions::<T, D, NB>(&s);
        let amount = amount(p);
        let density = amount.scaled(T::one() / cloud.volumes[p]);
        total.add_scaled(T::one(), amount);
        for k in 1..NB {
            sums[k].add_scaled(psi[k], density);
        }
    }
    let mean = total.scaled(inverse_volume);
    for k in 1..NB {
        sums[k].add_scaled(-fits.sums[k], mean);
    }
    let mut coefficients = fits.conserved.coefficients_from_sums(sums);
    coefficients[0] = mean;
    coefficients
}

#[inline(always)]
fn fit_about_mean<T: Scalar, const D: usize, const NB: usize, Q: Field<T>>(
    fits: &CellFits<T, D, NB>,
    cloud: &Cloud<'_, T, D>,
    cell: usize,
    value: &impl Fn(usize) -> Q,
    mean: Q,
) -> [Q; NB] {
    let samples = samples(cloud, cell, &fits.patch, value);
    let mut coefficients = fits.conserved.coefficients(samples, mean);
    coefficients[0] = mean;
    coefficients
}

impl<T: Scalar, const D: usize, const NB: usize> Reconstruction<T, D> for Taylor<T, D, NB> {
    type Points = InFours;
    type Mass = VelocityMass;
    type Filter = NoFilter;

    fn prepare(&mut self, cloud: &Cloud<'_, T, D>) {
        // One slot for each cell there is, so that a later step never has to allocate.
        self.cells
            .reserve(cloud.grid.cell_count() - self.cells.len().min(cloud.grid.cell_count()));
        let occupied = cloud.bins.occupied();
        let empty = CellFits::empty(cloud);
        self.cells.resize(occupied.len(), empty);
        let tolerance = self.tolerance;
        let parallel = parallel::worth_sharing::<D>(occupied.len(), parallel::CELLS);
        each_span(
            parallel,
            parallel::CELLS,
            (occupied, &mut self.cells[..]),
            &|_, (cells, fits)| {
                for (&cell, fits) in cells.iter().zip(fits) {
                    *fits = CellFits::new(cloud, cell as usize, tolerance);
                }
            },
        );
        self.reduced = self.cells.iter().filter(|fits| !fits.is_full()).count();
        self.lent = 0;
        if const { D == 1 } && self.virtual_points && self.reduced > 0 {
            self.lend(cloud);
        }
    }

    #[inline(always)]
    fn integrate<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        self.integrate_cells(cloud, 0..self.cells.len(), value, sink);
    }

    #[inline(always)]
    fn integrate_conserved<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        self.limited = self.stream_conserved(cloud, 0..self.cells.len(), &amount, sink);
    }

    fn reduced_cells(&self) -> usize {
        self.reduced
    }

    fn virtual_cells(&self) -> usize {
        self.lent
    }

    fn bytes(&self) -> usize {
        self.cells.capacity() * size_of::<CellFits<T, D, NB>>()
    }
}

impl<T: Scalar, const D: usize, const NB: usize> CellStream<T, D> for Taylor<T, D, NB> {
    #[inline(always)]
    fn integrate_cells<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        value: impl Fn(usize) -> Q,
        mut sink: impl FnMut(&Point<T, D>, Q),
    ) {
        for cell in self.occupied(cloud, cells) {
            let coefficients = self.free(cloud, cell, &value);
            self.rule.emit(&cell.fits.patch, &coefficients, &mut sink);
        }
    }

    #[inline(always)]
    fn integrate_conserved_cells<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        self.stream_conserved(cloud, cells, &amount, sink);
    }
}

impl<T: Scalar, const D: usize, const NB: usize> Streams<T, D, Taylor<T, D, NB>> for InFours {
    const IN_CELLS: bool = true;
    const IN_FOURS: bool = true;
    const KEPT: usize = kept::<NB>();

    #[inline(always)]
    fn cells<Q: Field<T>>(
        taylor: &Taylor<T, D, NB>,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        taylor.integrate_cells(cloud, cells, value, sink);
    }

    #[inline(always)]
    fn conserved_cells<Q: Field<T>>(
        taylor: &Taylor<T, D, NB>,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        taylor.integrate_conserved_cells(cloud, cells, amount, sink);
    }

    fn line(taylor: &Taylor<T, D, NB>) -> impl Iterator<Item = T> {
        // Virtual points want the fits of neighbours.
        let points = if D == 1 && taylor.virtual_points {
            0
        } else {
            usize::MAX
        };
        taylor.rule.line().take(points)
    }

    #[inline(always)]
    fn integrate_batch<K: Packs<T>, Q: Field<T>>(
        taylor: &Taylor<T, D, NB>,
        k: K,
        (cloud, cells): (&Cloud<'_, T, D>, Range<usize>),
        conserve: bool,
        kept: Kept<'_, T>,
        value: &impl Values<T, Q>,
        sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus {
        with_room!(Q::COMPONENTS, |C| taylor.integrate_few::<K, Q, C>(
            k,
            (cloud, cells),
            conserve,
            kept,
            value,
            sink
        ))
    }

    fn weighted_line(taylor: &Taylor<T, D, NB>) -> impl Iterator<Item = (T, T)> {
        taylor.rule.weighted_line()
    }

    #[inline(always)]
    fn fit_batch<K: Packs<T>, Q: Field<T>>(
        taylor: &Taylor<T, D, NB>,
        k: K,
        place: (&Cloud<'_, T, D>, Range<usize>),
        conserve: bool,
        kept: Kept<'_, T>,
        value: &impl Values<T, Q>,
        sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus {
        with_room!(Q::COMPONENTS, |C| taylor
            .fit_few::<K, Q, C>(k, place, conserve, kept, value, sink))
    }

    #[cold]
    #[inline(never)]
    fn integrate_single<Q: Field<T>>(
        taylor: &Taylor<T, D, NB>,
        cloud: &Cloud<'_, T, D>,
        cell: usize,
        conserve: bool,
        value: &dyn Fn(usize) -> Q,
        sink: &mut dyn FnMut(&Point<T, D>, Q),
    ) -> bool {
        let fits = CellFits::new(cloud, cell, taylor.tolerance);
        let (coefficients, full) = if conserve {
            let amount = |p| value(p).scaled(cloud.volumes[p]);
            let coefficients = conserved(&fits, cloud, cell, &amount);
            (
                taylor.rule.keep_positive(coefficients).0,
                fits.conserved_is_full(),
            )
        } else {
            (free(&fits, cloud, cell, &value), fits.free_is_full())
        };
        taylor
            .rule
            .emit(&fits.patch, &coefficients, &mut |point, value| sink(point, value));
        full
    }
}
