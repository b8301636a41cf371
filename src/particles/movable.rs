//! What a step changes of particles when they move.

use nalgebra::{SMatrix, SVector};

use crate::parallel::Sliced;

/// What moves and deforms of particles.
pub(crate) struct Movables<'a, T, const D: usize, S, P> {
    pub(super) position: &'a mut [SVector<T, D>],
    pub(super) displacement: &'a mut [SVector<T, D>],
    pub(super) stress: &'a mut [SMatrix<T, D, D>],
    pub(super) volume: &'a mut [T],
    /// So many numbers for each.
    pub(super) state: &'a mut [S],
    pub(super) numbers_each: usize,
    pub(super) phase: &'a mut [P],
}

/// What deforms of particles.
pub(crate) struct Material<'a, T, const D: usize, S, P> {
    pub(crate) stress: &'a mut [SMatrix<T, D, D>],
    pub(crate) volume: &'a mut [T],
    pub(crate) state: &'a mut [S],
    pub(crate) phase: &'a mut [P],
}

impl<T, const D: usize, S, P> Movables<'_, T, D, S, P> {
    /// Where they are, and how far they have come since the start.
    #[inline(always)]
    pub(crate) fn places(&mut self) -> (&mut [SVector<T, D>], &mut [SVector<T, D>]) {
        (self.position, self.displacement)
    }

    /// The same, and the data of the second phase.
    #[inline(always)]
    pub(crate) fn places_and_phase(&mut self) -> (&mut [SVector<T, D>], &mut [SVector<T, D>], &mut [P]) {
        (self.position, self.displacement, self.phase)
    }

    /// What `count` of them are made of, from index `first` on.
    #[inline(always)]
    pub(crate) fn material(&mut self, first: usize, count: usize) -> Material<'_, T, D, S, P> {
        let these = first..first + count;
        Material {
            stress: &mut self.stress[these.clone()],
            volume: &mut self.volume[these.clone()],
            state: &mut self.state[first * self.numbers_each..][..count * self.numbers_each],
            phase: &mut self.phase[these],
        }
    }
}

impl<T: Send, const D: usize, S: Send, P: Send> Sliced for Movables<'_, T, D, S, P> {
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
        let numbers_each = self.numbers_each;
        let first = Self {
            position,
            displacement,
            stress,
            volume,
            state,
            numbers_each,
            phase,
        };
        let rest = Self {
            position: later_position,
            displacement: later_displacement,
            stress: later_stress,
            volume: later_volume,
            state: later_state,
            numbers_each,
            phase: later_phase,
        };
        (first, rest)
    }
}
