//! What a step changes of particles when they move.

use nalgebra::{SMatrix, SVector};

use crate::grid::Cell;
use crate::parallel::Sliced;

/// What moves and deforms of particles.
pub(crate) struct ParticleViews<'a, T, const D: usize, S, P> {
    pub(super) position: &'a mut [SVector<T, D>],
    pub(super) displacement: &'a mut [SVector<T, D>],
    pub(super) stress: &'a mut [SMatrix<T, D, D>],
    pub(super) volume: &'a mut [T],
    /// So many numbers for each.
    pub(super) state: &'a mut [S],
    pub(super) numbers_each: usize,
    pub(super) phase: &'a mut [P],
    /// Of domains, where there are any.
    pub(super) half_lengths: &'a [SVector<T, D>],
    pub(super) half_edges: &'a mut [SMatrix<T, D, D>],
}

/// What deforms of particles.
pub(crate) struct Material<'a, T, const D: usize, S, P> {
    pub(crate) stress: &'a mut [SMatrix<T, D, D>],
    pub(crate) volume: &'a mut [T],
    pub(crate) state: &'a mut [S],
    pub(crate) phase: &'a mut [P],
}

/// Where particles are, and how far they have come since the start.
pub(crate) struct Places<'a, T, const D: usize> {
    pub(crate) positions: &'a mut [SVector<T, D>],
    pub(crate) displacements: &'a mut [SVector<T, D>],
    pub(crate) cells: &'a mut [Cell<D>],
    /// Of domains, where there are any.
    pub(crate) half_lengths: &'a [SVector<T, D>],
    pub(crate) half_edges: &'a mut [SMatrix<T, D, D>],
}

/// What all of them are made of, so many numbers a state.
pub(crate) struct AllMaterial<'a, T, const D: usize, S, P> {
    all: Material<'a, T, D, S, P>,
    numbers_each: usize,
}

impl<T, const D: usize, S, P> AllMaterial<'_, T, D, S, P> {
    /// What `count` of them are made of, from index `first` on.
    #[inline(always)]
    pub(crate) fn some(&mut self, first: usize, count: usize) -> Material<'_, T, D, S, P> {
        let these = first..first + count;
        Material {
            stress: &mut self.all.stress[these.clone()],
            volume: &mut self.all.volume[these.clone()],
            state: &mut self.all.state[first * self.numbers_each..][..count * self.numbers_each],
            phase: &mut self.all.phase[these],
        }
    }
}

impl<T, const D: usize, S, P> ParticleViews<'_, T, D, S, P> {
    /// Where they are, in these cells, and how far they have come since the start; and what they are made of.
    pub(crate) fn places_and_material<'b>(
        &'b mut self,
        cells: &'b mut [Cell<D>],
    ) -> (Places<'b, T, D>, AllMaterial<'b, T, D, S, P>) {
        let places = Places {
            positions: self.position,
            displacements: self.displacement,
            cells,
            half_lengths: self.half_lengths,
            half_edges: self.half_edges,
        };
        let all = Material {
            stress: self.stress,
            volume: self.volume,
            state: self.state,
            phase: self.phase,
        };
        let numbers_each = self.numbers_each;
        (places, AllMaterial { all, numbers_each })
    }
}

impl<T: Send + Sync, const D: usize, S: Send, P: Send> Sliced for ParticleViews<'_, T, D, S, P> {
    fn items(&self) -> usize {
        self.position.len()
    }

    fn split(self, _spans: usize, items: usize) -> (Self, Self) {
        let middle = items.min(self.position.len());
        let (position, later_position) = self.position.split_at_mut(middle);
        let (displacement, later_displacement) = self.displacement.split_at_mut(middle);
        let (stress, later_stress) = self.stress.split_at_mut(middle);
        let (volume, later_volume) = self.volume.split_at_mut(middle);
        let (state, later_state) = self.state.split_at_mut(middle * self.numbers_each);
        let (phase, later_phase) = self.phase.split_at_mut(middle);
        let of_domains = middle.min(self.half_lengths.len());
        let (half_lengths, later_half_lengths) = self.half_lengths.split_at(of_domains);
        let of_domains = middle.min(self.half_edges.len());
        let (half_edges, later_half_edges) = self.half_edges.split_at_mut(of_domains);
        let numbers_each = self.numbers_each;
        let first = Self {
            position,
            displacement,
            stress,
            volume,
            state,
            numbers_each,
            phase,
            half_lengths,
            half_edges,
        };
        let rest = Self {
            position: later_position,
            displacement: later_displacement,
            stress: later_stress,
            volume: later_volume,
            state: later_state,
            numbers_each,
            phase: later_phase,
            half_lengths: later_half_lengths,
            half_edges: later_half_edges,
        };
        (first, rest)
    }
}
