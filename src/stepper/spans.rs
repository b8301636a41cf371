//! The spans of the passes over particles and cells, with the storage they need.

use nalgebra::SVector;

use super::diagnostics::Sums;
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::grid::{Cell, Grid};
use crate::parallel::{CELLS, PARTICLES, SpanWindow, fit, many_threads};
use crate::particles::Bins;
use crate::scalar::Scalar;

/// Windows of the spans of particles and of occupied cells, sums in them, and partial results.
#[derive(Clone, Debug)]
pub(super) struct Spans<T, const D: usize> {
    /// Of particles. A single one, the whole, where the particles are few or in no order.
    pub(super) particles: Vec<SpanWindow>,
    /// Of occupied cells; a single one where they are few.
    pub(super) cells: Vec<SpanWindow>,
    pub(super) stale: bool,
    pub(super) scalars: Vec<T>,
    pub(super) vectors: Vec<SVector<T, D>>,
    pub(super) matrices: Vec<T>,
    pub(super) sums: Vec<Sums<T, D>>,
    pub(super) moved: Vec<Moved<T>>,
}

/// What became of the particles of a span that moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moved<T> {
    pub(super) crossings: usize,
    pub(super) fault: Option<Fault<T>>,
}

impl<T> Default for Moved<T> {
    fn default() -> Self {
        Self {
            crossings: 0,
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
            stale: true,
            scalars: Vec::new(),
            vectors: Vec::new(),
            matrices: Vec::new(),
            sums: vec![Sums::zero(); spans],
            moved: vec![Moved::default(); spans],
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
        let dofs = basis.dof_count(grid);
        let bounds = bins.cells().chunks(PARTICLES).map(|cells| {
            let numbers = cells.iter().map(|cell| grid.linear(cell));
            numbers.fold((usize::MAX, 0), |(low, high), n| (low.min(n), high.max(n)))
        });
        lay(
            &mut self.particles,
            dofs,
            bounds.map(|(low, high)| window(basis, grid, low, high)),
        );
        if fits {
            let bounds = bins
                .occupied()
                .chunks(CELLS)
                .filter_map(|cells| Some((*cells.first()? as usize, *cells.last()? as usize)));
            lay(
                &mut self.cells,
                dofs,
                bounds.map(|(low, high)| window(basis, grid, low, high)),
            );
        }
    }

    /// Allocates what passes will need: sums of vectors over particles, over cells, or neither.
    pub(super) fn allocate(&mut self, particles: bool, cells: bool) {
        fit(&self.particles, &mut self.scalars, 1);
        if particles {
            fit(&self.particles, &mut self.vectors, 1);
        }
        if cells {
            fit(&self.cells, &mut self.vectors, 1);
        }
    }

    /// Bytes allocated.
    pub(super) fn bytes(&self) -> usize {
        size_of::<SpanWindow>() * (self.particles.capacity() + self.cells.capacity())
            + size_of::<T>() * (self.scalars.capacity() + self.matrices.capacity())
            + size_of::<SVector<T, D>>() * self.vectors.capacity()
            + size_of::<Sums<T, D>>() * self.sums.capacity()
            + size_of::<Moved<T>>() * self.moved.capacity()
    }

    /// The particles' momentum, added up span by span.
    pub(super) fn momentum(&self) -> Sums<T, D> {
        self.sums
            .iter()
            .fold(Sums::zero(), |total, sums| total.with(sums))
    }
}

/// Length of a span of `items` items whose windows are `spans`, and whether threads should share them.
pub(super) fn share(spans: &[SpanWindow], items: usize, length: usize) -> (usize, bool) {
    match spans.len() {
        0 | 1 => (items.max(1), false),
        _ => (length, many_threads()),
    }
}

fn window<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    low: usize,
    high: usize,
) -> std::ops::Range<usize> {
    let cell = |number: usize| -> Cell<D> { grid.cell(number) };
    basis.dof_window(grid, &cell(low), &cell(high))
}

/// Lays windows end to end, or takes the whole as one if they overlap so much that they would cost more than they bring.
fn lay(spans: &mut Vec<SpanWindow>, dofs: usize, windows: impl Iterator<Item = std::ops::Range<usize>>) {
    spans.clear();
    let mut offset = 0;
    for window in windows {
        let len = window.len();
        spans.push(SpanWindow {
            first: window.start,
            len,
            offset,
        });
        offset += len;
    }
    if spans.len() <= 1 || offset > 2 * dofs {
        spans.clear();
        spans.push(SpanWindow {
            first: 0,
            len: dofs,
            offset: 0,
        });
    }
}
