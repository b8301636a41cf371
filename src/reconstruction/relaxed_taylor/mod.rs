//! Relaxed Taylor least squares.

mod cells;
mod determined;
mod filling;
mod four;
mod geometry;
mod pull;
mod relax;
mod relaxation;
mod stream;
#[cfg(test)]
mod tests;

use std::ops::Range;

use super::gauss::GaussRule;
use super::taylor::hand_over;
use super::{
    BatchStatus, CellStream, Cloud, CourantNumbers, Filling, Filter, Filters, InFours, Kept, NullSpace,
    Point, Reconstruction, Stored, Streams, Values,
};
use crate::basis::BasisFamily;
use crate::field::Field;
use crate::mass::ParticleMatrix;
use crate::parallel::CELLS;
use crate::scalar::Scalar;
use crate::simd::{LANES, Packs};
use crate::taylor::{FEW_COMPONENTS, MOST_COMPONENTS, are_few, default_tolerance};
use cells::{Kind, RelaxedCell};
use four::{FourFits, KeptProducts};
use pull::Corrections;

pub use relaxation::Relaxation;

/// Groups of four cells in a span.
const GROUPS: usize = CELLS / LANES;

/// Wave speeds in neighbouring cells that differ by more than this factor are those of two materials.
const ALIKE: f64 = 2.0;

/// Taylor least squares for long runs, our own: published TLS gains energy wherever particles cross cell
/// edges or do not lie evenly in their cells.
///
/// Four things together: mass and momentum of the DOFs straight from the particles; their consistent mass
/// matrix in both the acceleration and the velocity; the stress by the free fit and Gauss quadrature, as
/// published; and in every step each particle's stress and velocity a little nearer to what their fits see,
///
/// $$v_p \mathrel{+}= \beta_o(\hat v(x_p) - v_p),\qquad
///   \sigma_p \mathrel{+}= \beta_o(\hat\sigma(x_p) - \sigma_p) + \beta_n(\bar\sigma(x_p) - \sigma_p).$$
///
/// $\hat v$ and $\hat\sigma$ are the fits of the particle's own cell, $\bar\sigma$ is the fit through the
/// particles of the cell *and* of those that share a face with it. Particles carry more than a cell's
/// polynomial sees. What the fit does not see does no work now, and returns when particles cross: the first
/// term takes it away. What a cell's few particles determine badly the neighbours know: the second term
/// bounds it. The fit of the velocity is weighted with the masses: it keeps the momentum exactly and never
/// raises the kinetic energy, because it is a projection in the very product that measures it.
///
/// Where the basis has one gradient in a cell ([`RelaxedTaylor::for_basis`]), $\bar\sigma$ gets a constant
/// with which its slope leaves the mean of the cell's fit alone: the mean is all that does work there.
///
/// The shares follow from [`Relaxation`] rates, for each crossing of a cell by a wave or by the particles, so
/// that a smaller time step changes nothing. A cell whose particles do not tell all functions apart takes the
/// fit with its neighbours for the force too, if that one can. The stress of a law with a state of its own (a
/// deformation, plastic history) is moved by straining the state
/// ([`ConstitutiveLaw::strain_for`](crate::law::ConstitutiveLaw::strain_for)).
///
/// In one dimension a cell ends where a body's surface cuts it. Beyond, where material ends within a cell on
/// any slant, the particles themselves are the points of its force, nothing is relaxed there, and the stepper
/// ties its functions to those of the next cells ([`crate::mass::Penalty`]). The same ties hold beyond one
/// dimension where particles do not see all that a basis is made of. Cells that neither their particles nor
/// the cells near them determine (one particle a cell, drops) are lumped, and stepped as by
/// [`Shepard`](super::Shepard).
#[doc = include_str!("../../../docs/formulas.html")]
#[derive(Clone, Debug)]
pub struct RelaxedTaylor<T, const D: usize, const NB: usize> {
    rule: GaussRule<T, D, NB>,
    /// Of the basis.
    degree: usize,
    tolerance: T,
    relaxation: Relaxation<T>,
    /// What takes its place where a liquid flows.
    with_liquid: Option<Relaxation<T>>,
    /// Whether slopes that neighbours give a cell leave its mean alone ([`BasisFamily::CONSTANT_GRADIENT`]).
    keeps_means: bool,
    cells: Vec<RelaxedCell>,
    /// Sums of products of the functions over the particles, four cells each.
    grams: Vec<KeptProducts<T, NB>>,
    fits: Vec<FourFits<T, D, NB>>,
    /// Sums of the functions times the components of a field ([`KeptSums`]).
    sums: Vec<[T; LANES]>,
    pulls: Corrections<T>,
    /// Most scalars of a field.
    components: usize,
    reduced: usize,
}

impl<T: Scalar, const D: usize, const NB: usize> RelaxedTaylor<T, D, NB> {
    /// For a basis, with the relaxation that suits it.
    pub fn for_basis<B: BasisFamily<T, D>>(basis: &B) -> Self {
        let fit = Self::for_degree(basis.degree());
        if !B::CONSTANT_GRADIENT {
            return fit;
        }
        Self {
            keeps_means: true,
            relaxation: Relaxation::with_constant_gradients(),
            with_liquid: Some(Relaxation::with_liquid(basis.degree(), true)),
            ..fit
        }
    }

    /// For a basis of degree `degree` whose gradients are not constant in a cell (for linear functions along
    /// one axis see [`RelaxedTaylor::for_basis`]), with the default relaxation.
    pub fn for_degree(degree: usize) -> Self {
        Self {
            rule: GaussRule::new(GaussRule::<T, D, NB>::points_for_degree(degree)),
            degree,
            tolerance: default_tolerance(D),
            relaxation: Relaxation::in_dimensions(D),
            with_liquid: Some(Relaxation::with_liquid(degree, false)),
            keeps_means: false,
            cells: Vec::new(),
            grams: Vec::new(),
            fits: Vec::new(),
            sums: Vec::new(),
            pulls: Corrections::none(),
            components: D * D,
            reduced: 0,
        }
    }

    /// With other rates of relaxation.
    #[must_use]
    pub fn with_relaxation(mut self, relaxation: Relaxation<T>) -> Self {
        self.relaxation = relaxation;
        self.with_liquid = None;
        self
    }

    /// As [`Taylor::with_tolerance`](super::Taylor::with_tolerance).
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: T) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Which cells at these places are none of four.
    #[inline(always)]
    fn batch_status(&self, cells: Range<usize>) -> BatchStatus {
        let mut four = BatchStatus::default();
        for (hard, cell) in four.hard.iter_mut().zip(&self.cells[cells]) {
            *hard = cell.kind != Kind::Batch;
        }
        four
    }

    /// Makes room for all cells there are, so that a later step never has to allocate.
    fn reserve(&mut self, cells: usize) {
        let groups = cells.div_ceil(LANES);
        make_room(&mut self.cells, cells);
        make_room(&mut self.grams, groups);
        make_room(&mut self.fits, groups);
        make_room(&mut self.sums, groups * NB * self.components);
        self.pulls.reserve(cells, NB * self.components);
    }
}

/// Makes room for so many values in all. Those of the last step stay: all are written anew, and to empty the
/// list would be to fill it once more.
fn make_room<A>(values: &mut Vec<A>, count: usize) {
    values.reserve(count.saturating_sub(values.len()));
}

impl<T: Scalar, const D: usize, const NB: usize> Reconstruction<T, D> for RelaxedTaylor<T, D, NB> {
    type Points = InFours;
    type Mass = ParticleMatrix;
    type Filter = NullSpace;

    fn prepare(&mut self, cloud: &Cloud<'_, T, D>) {
        self.reserve(cloud.grid.cell_count());
        self.take_in_geometry(cloud);
        self.leave_undetermined(cloud);
        let reduced = |cell: &&RelaxedCell| cell.kind != Kind::Open && !cell.is_full;
        self.reduced = self.cells.iter().filter(reduced).count();
    }

    #[inline(always)]
    fn integrate<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        // Not what a step calls: that streams cells, and allocates nothing.
        let values: Vec<Q> = (0..cloud.positions.len()).map(value).collect();
        self.sum_field(cloud, &Stored(&values));
        self.integrate_cells(cloud, 0..self.cells.len(), |p| values[p], sink);
    }

    fn reduced_cells(&self) -> usize {
        self.reduced
    }

    fn bytes(&self) -> usize {
        self.cells.capacity() * size_of::<RelaxedCell>()
            + self.grams.capacity() * size_of::<KeptProducts<T, NB>>()
            + self.fits.capacity() * size_of::<FourFits<T, D, NB>>()
            + self.sums.capacity() * size_of::<[T; LANES]>()
            + self.pulls.bytes()
    }
}

impl<T: Scalar, const D: usize, const NB: usize> Filter<T, D, RelaxedTaylor<T, D, NB>> for NullSpace {}

impl<T: Scalar, const D: usize, const NB: usize> Filters<T, D, RelaxedTaylor<T, D, NB>> for NullSpace {
    const FILTERS: bool = true;

    fn relax<Q: Field<T>>(
        fits: &mut RelaxedTaylor<T, D, NB>,
        cloud: &Cloud<'_, T, D>,
        crossed: &[CourantNumbers<T>],
        values: &mut [Q],
    ) {
        fits.relax_towards_both(cloud, crossed, values);
    }

    fn relax_weighted<Q: Field<T>>(
        fits: &mut RelaxedTaylor<T, D, NB>,
        cloud: &Cloud<'_, T, D>,
        weights: &[T],
        crossed: &[CourantNumbers<T>],
        values: &mut [Q],
    ) {
        fits.relax_towards_own(cloud, weights, crossed, values);
    }

    fn filling(fits: &RelaxedTaylor<T, D, NB>, place: usize) -> Filling {
        fits.cells.get(place).map_or(Filling::Filled, |cell| cell.filling)
    }

    fn suit_liquid(fits: &mut RelaxedTaylor<T, D, NB>) {
        fits.components = D * D + 1;
        if let Some(relaxation) = fits.with_liquid {
            fits.relaxation = relaxation;
        }
    }
}

impl<T: Scalar, const D: usize, const NB: usize> CellStream<T, D> for RelaxedTaylor<T, D, NB> {
    #[inline(always)]
    fn integrate_cells<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        value: impl Fn(usize) -> Q,
        mut sink: impl FnMut(&Point<T, D>, Q),
    ) {
        self.integrate_each(cloud, cells, &value, &mut sink);
    }
}

impl<T: Scalar, const D: usize, const NB: usize> Streams<T, D, RelaxedTaylor<T, D, NB>> for InFours {
    const IN_CELLS: bool = true;
    const IN_FOURS: bool = true;
    const NON_LOCAL: bool = true;

    #[inline(always)]
    fn cells<Q: Field<T>>(
        fits: &RelaxedTaylor<T, D, NB>,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        fits.integrate_cells(cloud, cells, value, sink);
    }

    #[inline(always)]
    fn conserved_cells<Q: Field<T>>(
        fits: &RelaxedTaylor<T, D, NB>,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        fits.integrate_conserved_cells(cloud, cells, amount, sink);
    }

    fn take_in_field<Q: Field<T>>(
        fits: &mut RelaxedTaylor<T, D, NB>,
        cloud: &Cloud<'_, T, D>,
        value: &(impl Values<T, Q> + Sync),
    ) {
        fits.sum_field(cloud, value);
    }

    fn line(fits: &RelaxedTaylor<T, D, NB>) -> impl Iterator<Item = T> {
        fits.rule.line()
    }

    #[inline(always)]
    fn integrate_batch<K: Packs<T>, Q: Field<T>>(
        fits: &RelaxedTaylor<T, D, NB>,
        k: K,
        (cloud, cells): (&Cloud<'_, T, D>, Range<usize>),
        _conserve: bool,
        _kept: Kept<'_, T>,
        _value: &impl Values<T, Q>,
        mut sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus {
        let (group, volume) = (cells.start / LANES, cloud.grid.cell_volume());
        if const { are_few::<T, Q, D>() } {
            let coefficients = fits.integrated::<K, Q, FEW_COMPONENTS>(k, group);
            fits.rule
                .emit_lanes(k, volume, &coefficients, Q::COMPONENTS, &mut sink);
        } else {
            let coefficients = fits.integrated::<K, Q, MOST_COMPONENTS>(k, group);
            fits.rule
                .emit_lanes(k, volume, &coefficients, Q::COMPONENTS, &mut sink);
        }
        fits.batch_status(cells)
    }

    fn weighted_line(fits: &RelaxedTaylor<T, D, NB>) -> impl Iterator<Item = (T, T)> {
        fits.rule.weighted_line()
    }

    #[inline(always)]
    fn fit_batch<K: Packs<T>, Q: Field<T>>(
        fits: &RelaxedTaylor<T, D, NB>,
        k: K,
        (_cloud, cells): (&Cloud<'_, T, D>, Range<usize>),
        _conserve: bool,
        _kept: Kept<'_, T>,
        _value: &impl Values<T, Q>,
        sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus {
        let group = cells.start / LANES;
        if const { are_few::<T, Q, D>() } {
            hand_over(
                k,
                &fits.integrated::<K, Q, FEW_COMPONENTS>(k, group),
                Q::COMPONENTS,
                sink,
            );
        } else {
            hand_over(
                k,
                &fits.integrated::<K, Q, MOST_COMPONENTS>(k, group),
                Q::COMPONENTS,
                sink,
            );
        }
        fits.batch_status(cells)
    }

    #[cold]
    #[inline(never)]
    fn integrate_single<Q: Field<T>>(
        fits: &RelaxedTaylor<T, D, NB>,
        cloud: &Cloud<'_, T, D>,
        cell: usize,
        _conserve: bool,
        value: &dyn Fn(usize) -> Q,
        sink: &mut dyn FnMut(&Point<T, D>, Q),
    ) -> bool {
        if let Some(place) = cloud.bins.place_of(cell, 0) {
            fits.integrate_apart(cloud, place, value, sink);
        }
        true
    }
}
