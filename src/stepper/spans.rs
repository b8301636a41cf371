//! The spans of the passes over particles and cells, with the storage they need.

use std::ops::Range;

use nalgebra::SVector;

use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::grid::Grid;
use crate::parallel::{CELLS, PARTICLES, SpanWindow, fit, worth_sharing};
use crate::particles::Bins;
use crate::scalar::Scalar;
use crate::simd::LANES;
use crate::transfer::{self, Momentum};

/// Windows of the spans of particles and of occupied cells, sums in them, and partial results.
#[derive(Clone, Debug)]
pub(super) struct Spans<T, const D: usize> {
    /// Of particles. A single one, the whole, where the particles are few or in no order.
    pub(super) particles: Vec<SpanWindow>,
    /// Of occupied cells; a single one where they are few.
    pub(super) cells: Vec<SpanWindow>,
    /// Length of the spans of particles and of cells.
    pub(super) lengths: [usize; 2],
    /// Lowest and highest number of a cell that holds one of [`PARTICLES`] particles that follow each other.
    pub(super) bounds: Vec<[u32; 2]>,
    pub(super) stale: bool,
    /// Whether particles have moved to other places since `bounds` were noted.
    pub(super) unknown: bool,
    /// Of how many shortest spans those of particles and of cells are to be made, where that is known
    /// beforehand.
    pub(super) told: Option<[usize; 2]>,
    pub(super) store: Store<T, D>,
    pub(super) totals: Vec<Totals<T, D>>,
    pub(super) moved: Vec<Moved<T>>,
    /// Of spans of cells, how many were fitted without the full set of functions.
    pub(super) reduced: Vec<usize>,
    /// What is kept of each four cells from the fit of the stress to that of the densities.
    pub(super) kept: Vec<[T; LANES]>,
    /// Whether no particle has moved since.
    pub(super) fresh: bool,
}

/// Room for the sums of windows: of so many scalars and vectors a DOF, and of rows of a matrix.
#[derive(Clone, Debug)]
pub(super) struct Store<T, const D: usize> {
    pub(super) scalars: [Vec<T>; SCALARS],
    pub(super) vectors: [Vec<SVector<T, D>>; VECTORS],
    pub(super) matrices: [Vec<T>; 2],
}

/// Scalars of a DOF: masses of two phases, and their drag.
pub(super) const SCALARS: usize = 3;
/// Vectors of a DOF: momenta of two phases, and forces on them.
pub(super) const VECTORS: usize = 4;

/// Momenta of the particles of a span, of both phases, and the mass of the liquid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Totals<T, const D: usize> {
    pub(super) momenta: [Momentum<T, D>; 2],
    pub(super) liquid_mass: T,
}

impl<T: Scalar, const D: usize> Totals<T, D> {
    pub(super) fn zero() -> Self {
        Self {
            momenta: [Momentum::zero(); 2],
            liquid_mass: T::zero(),
        }
    }

    fn with(self, other: &Self) -> Self {
        let [solid, liquid] = self.momenta;
        Self {
            momenta: [solid.with(&other.momenta[0]), liquid.with(&other.momenta[1])],
            liquid_mass: self.liquid_mass + other.liquid_mass,
        }
    }
}

/// What became of the particles of a span that moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moved<T> {
    pub(super) crossings: usize,
    /// Whether one came to a cell where the DOFs that it will see might have no numbers.
    pub(super) strayed: bool,
    pub(super) fault: Option<Fault<T>>,
}

impl<T> Default for Moved<T> {
    fn default() -> Self {
        Self {
            crossings: 0,
            strayed: false,
            fault: None,
        }
    }
}

/// What can go wrong with a particle that moves.
#[derive(Clone, Copy, Debug)]
pub(super) enum Fault<T> {
    /// Its material makes no sense any more.
    Material(usize, InvalidState<T>),
    /// It left the grid.
    Left(usize),
}

/// What can go wrong with the material of a particle.
#[derive(Clone, Copy, Debug)]
pub(super) enum InvalidState<T> {
    /// The volume is no longer a positive number.
    Volume(T),
    /// The law has no meaning at this stress.
    Stress(T),
    /// The pressure of the liquid in its pores is no number any more.
    Pressure(T),
    /// The value that diffuses is no number any more.
    Value(T),
}

impl<T: Scalar> InvalidState<T> {
    /// As an error; `allowed` is what the law asks of a stress.
    pub(super) fn error(self, step: usize, particle: usize, allowed: &'static str) -> StepError {
        match self {
            Self::Volume(volume) => StepError::Invalid {
                step,
                particle,
                name: "volume",
                value: volume.primal(),
            },
            Self::Pressure(pressure) => StepError::Invalid {
                step,
                particle,
                name: "pore pressure",
                value: pressure.primal(),
            },
            Self::Value(value) => StepError::Invalid {
                step,
                particle,
                name: "value that diffuses",
                value: value.primal(),
            },
            Self::Stress(stress) => StepError::Stress {
                step,
                particle,
                value: stress.primal(),
                allowed,
            },
        }
    }
}

impl<T: Scalar, const D: usize> Spans<T, D> {
    #[inline(never)]
    pub(super) fn new(particles: usize) -> Self {
        let spans = particles.div_ceil(PARTICLES);
        Self {
            particles: Vec::with_capacity(spans),
            cells: Vec::new(),
            lengths: [PARTICLES, CELLS],
            bounds: vec![[0, 0]; spans],
            stale: true,
            unknown: true,
            told: None,
            store: Store {
                scalars: [const { Vec::new() }; SCALARS],
                vectors: [const { Vec::new() }; VECTORS],
                matrices: [const { Vec::new() }; 2],
            },
            totals: vec![Totals::zero(); spans],
            moved: vec![Moved::default(); spans],
            reduced: Vec::new(),
            kept: Vec::new(),
            fresh: false,
        }
    }

    /// How many particles changed their cells, whether one strayed, and the first fault.
    #[inline(never)]
    pub(super) fn sum_moves(&mut self) -> (usize, bool, Option<Fault<T>>) {
        let (mut crossings, mut strayed, mut fault) = (0, false, None);
        for span in &self.moved {
            crossings += span.crossings;
            strayed |= span.strayed;
            fault = fault.or(span.fault);
        }
        self.stale |= crossings > 0;
        (crossings, strayed, fault)
    }

    /// Windows for where the particles are now; `fits` says whether cells are passed over too.
    #[inline(never)]
    pub(super) fn refresh<B: BasisFamily<T, D>>(
        &mut self,
        basis: &B,
        grid: &Grid<T, D>,
        bins: &Bins<D>,
        fits: bool,
    ) {
        if !self.stale {
            return;
        }
        self.stale = false;
        if std::mem::take(&mut self.unknown) || !transfer::in_packs::<T, D, B>() {
            self.bound(grid, bins);
        }
        let places = Places { basis, grid };
        let [particles, cells] = self.told.take().unwrap_or([1, 1]);
        let bounds = self.bounds.iter().copied();
        self.lengths[0] = PARTICLES * places.lay(&mut self.particles, self.bounds.len(), bounds, particles);
        if fits {
            let bounds = bins
                .occupied()
                .chunks(CELLS)
                .filter_map(|cells| Some([*cells.first()?, *cells.last()?]));
            let count = bins.occupied().len().div_ceil(CELLS);
            self.lengths[1] = CELLS * places.lay(&mut self.cells, count, bounds, cells);
        }
    }

    /// Particles have moved to other places.
    pub(super) fn forget(&mut self) {
        (self.stale, self.unknown, self.told) = (true, true, None);
    }

    fn bound(&mut self, grid: &Grid<T, D>, bins: &Bins<D>) {
        let spans = bins.cells().chunks(PARTICLES);
        for (bounds, cells) in self.bounds.iter_mut().zip(spans) {
            let numbers = cells.iter().map(|cell| grid.linear(cell) as u32);
            *bounds = numbers.fold([u32::MAX, 0], |[low, high], n| [low.min(n), high.max(n)]);
        }
    }

    /// Allocates what sweeps will need: so many scalars and vectors of each DOF, summed over particles and,
    /// for fits, over cells.
    #[inline(never)]
    pub(super) fn allocate(&mut self, [scalars, vectors]: [usize; 2], fits: bool, dofs: usize) {
        let Store {
            scalars: of_scalars,
            vectors: of_vectors,
            ..
        } = &mut self.store;
        for (n, store) in of_scalars.iter_mut().enumerate().take(scalars) {
            fit(&self.particles, store, 1);
            // Masses are fitted too, the drag is not.
            if fits && n + 1 < SCALARS {
                fit(&self.cells, store, 1);
            }
        }
        for store in of_vectors.iter_mut().take(vectors) {
            fit(&self.particles, store, 1);
            if fits {
                fit(&self.cells, store, 1);
            }
        }
        if fits {
            self.reduced = vec![0; self.totals.len() * PARTICLES / CELLS];
        }
        // Beyond one dimension windows grow by whole rows when particles cross.
        if const { D > 1 } {
            of_scalars
                .iter_mut()
                .for_each(|store| reserve(store, MOST_OVERLAP * dofs));
            of_vectors
                .iter_mut()
                .for_each(|store| reserve(store, MOST_OVERLAP * dofs));
        }
    }

    /// Bytes allocated.
    pub(super) fn bytes(&self) -> usize {
        size_of::<SpanWindow>() * (self.particles.capacity() + self.cells.capacity())
            + size_of::<[u32; 2]>() * self.bounds.capacity()
            + size_of::<T>() * self.store.scalars.iter().map(Vec::capacity).sum::<usize>()
            + size_of::<T>() * self.store.matrices.iter().map(Vec::capacity).sum::<usize>()
            + size_of::<SVector<T, D>>() * self.store.vectors.iter().map(Vec::capacity).sum::<usize>()
            + size_of::<Totals<T, D>>() * self.totals.capacity()
            + size_of::<usize>() * self.reduced.capacity()
            + size_of::<[T; LANES]>() * self.kept.capacity()
            + size_of::<Moved<T>>() * self.moved.capacity()
    }

    /// Totals of all particles, added up span by span.
    pub(super) fn total(&self) -> Totals<T, D> {
        self.totals.iter().fold(Totals::zero(), Totals::with)
    }
}

/// Makes room for so many values in all, if there are any.
fn reserve<Q>(values: &mut Vec<Q>, count: usize) {
    if !values.is_empty() {
        values.reserve_exact(count.saturating_sub(values.len()));
    }
}

/// How many windows may hold a DOF, on average.
const MOST_OVERLAP: usize = 2;

/// Length of a span of `items` items whose windows are `spans`, and whether threads should share them.
pub(super) fn share<const D: usize>(spans: &[SpanWindow], items: usize, length: usize) -> (usize, bool) {
    match spans.len() {
        0 | 1 => (items.max(1), false),
        _ => (length, worth_sharing::<D>(items, length)),
    }
}

/// Where the DOFs of cells are.
struct Places<'a, B, G> {
    basis: &'a B,
    grid: &'a G,
}

impl<B, T: Scalar, const D: usize> Places<'_, B, Grid<T, D>>
where
    B: BasisFamily<T, D>,
{
    /// Lays the windows of spans end to end, given the bounds of `count` shortest ones. Where they overlap so
    /// much that they would cost more than they bring, spans are made of two, four, ... of the shortest ones,
    /// `joined` at least; returns of how many. A single one is the whole.
    fn lay(
        &self,
        spans: &mut Vec<SpanWindow>,
        count: usize,
        bounds: impl Iterator<Item = [u32; 2]> + Clone,
        mut joined: usize,
    ) -> usize {
        let dofs = self.basis.dof_count(self.grid);
        while joined < count {
            if self.lay_joined(spans, joined, bounds.clone()) <= MOST_OVERLAP * dofs {
                return joined;
            }
            joined *= 2;
        }
        spans.clear();
        spans.push(SpanWindow {
            first: 0,
            len: dofs,
            offset: 0,
        });
        joined
    }

    /// Lays the windows of spans of so many shortest ones each; returns how many DOFs they have together.
    fn lay_joined(
        &self,
        spans: &mut Vec<SpanWindow>,
        joined: usize,
        mut bounds: impl Iterator<Item = [u32; 2]>,
    ) -> usize {
        spans.clear();
        spans.reserve(bounds.size_hint().0);
        let mut offset = 0;
        while let Some([mut low, mut high]) = bounds.next() {
            for [lower, higher] in bounds.by_ref().take(joined - 1) {
                (low, high) = (low.min(lower), high.max(higher));
            }
            let window = self.window(low as usize, high as usize);
            let (first, len) = (window.start, window.len());
            spans.push(SpanWindow { first, len, offset });
            offset += len;
        }
        offset
    }

    fn window(&self, low: usize, high: usize) -> Range<usize> {
        let (low, high) = (self.grid.cell(low), self.grid.cell(high));
        self.basis.dof_window(self.grid, &low, &high)
    }
}
