//! The spans of the passes over particles and cells, with the storage they need.

use std::ops::Range;

use nalgebra::SVector;

use super::diagnostics::Sums;
use super::lanes;
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::grid::Grid;
use crate::parallel::{CELLS, PARTICLES, SpanWindow, fit, worth_sharing};
use crate::particles::Bins;
use crate::scalar::Scalar;

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
    /// Of how many shortest spans those of particles and of cells are to be made, where that is known beforehand.
    pub(super) told: Option<[usize; 2]>,
    pub(super) scalars: Vec<T>,
    pub(super) vectors: Vec<SVector<T, D>>,
    pub(super) matrices: Vec<T>,
    pub(super) sums: Vec<Sums<T, D>>,
    pub(super) moved: Vec<Moved<T>>,
    /// Of spans of cells, how many were fitted without the full set of functions.
    pub(super) reduced: Vec<usize>,
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
    Material(usize, Flaw<T>),
    /// It left the grid.
    Left(usize),
}

/// What can go wrong with the material of a particle.
#[derive(Clone, Copy, Debug)]
pub(super) enum Flaw<T> {
    /// The volume is no longer a positive number.
    Volume(T),
    /// The law has no meaning at this stress.
    Stress(T),
    /// The pressure of the liquid in its pores is no number any more.
    Pressure(T),
}

impl<T: Scalar> Flaw<T> {
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
            scalars: Vec::new(),
            vectors: Vec::new(),
            matrices: Vec::new(),
            sums: vec![Sums::zero(); spans],
            moved: vec![Moved::default(); spans],
            reduced: Vec::new(),
        }
    }

    /// Windows for where the particles are now; `fits` says whether cells are passed over too.
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
        if std::mem::take(&mut self.unknown) || !lanes::apply::<T, D, B>() {
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

    /// Allocates what passes will need: sums of vectors over particles, over cells, or neither.
    pub(super) fn allocate(&mut self, particles: bool, cells: bool, dofs: usize) {
        fit(&self.particles, &mut self.scalars, 1);
        if particles {
            fit(&self.particles, &mut self.vectors, 1);
        }
        if cells {
            self.reduced = vec![0; self.sums.len() * PARTICLES / CELLS];
            fit(&self.cells, &mut self.vectors, 1);
        }
        // Beyond one dimension windows grow by whole rows when particles cross.
        if D > 1 {
            reserve(&mut self.scalars, MOST_OVERLAP * dofs);
            reserve(&mut self.vectors, MOST_OVERLAP * dofs);
        }
    }

    /// Bytes allocated.
    pub(super) fn bytes(&self) -> usize {
        size_of::<SpanWindow>() * (self.particles.capacity() + self.cells.capacity())
            + size_of::<[u32; 2]>() * self.bounds.capacity()
            + size_of::<T>() * (self.scalars.capacity() + self.matrices.capacity())
            + size_of::<SVector<T, D>>() * self.vectors.capacity()
            + size_of::<Sums<T, D>>() * self.sums.capacity()
            + size_of::<usize>() * self.reduced.capacity()
            + size_of::<Moved<T>>() * self.moved.capacity()
    }

    /// The particles' momentum, added up span by span.
    pub(super) fn momentum(&self) -> Sums<T, D> {
        self.sums
            .iter()
            .fold(Sums::zero(), |total, sums| total.with(sums))
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
    /// Lays the windows of spans end to end, given the bounds of `count` shortest ones. Where they overlap so much that they
    /// would cost more than they bring, spans are made of two, four, ... of the shortest ones, `joined` at least; returns of
    /// how many. A single one is the whole.
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
