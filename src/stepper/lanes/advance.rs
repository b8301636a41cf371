//! Stage 4: positions, stresses and volumes of the particles.

use nalgebra::SVector;

use super::{Group, Pass, with_lanes_for};
use crate::basis::BasisFamily;
use crate::grid::Cell;
use crate::lanes::{Lanes, SideBySide};
use crate::law::LawSweep;
use crate::particles::Movables;
use crate::phase::Phase;
use crate::scalar::Scalar;
use crate::stepper::deform::{Motion, NO_BOUNDS, Outcome, advance_by_blocks, with_number};

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>> Pass<'_, T, D, B> {
    /// Moves and deforms the particles, the first of which has the number `first`.
    pub(in super::super) fn advance<L: LawSweep<T, D>, P: Phase<T, D>>(
        &self,
        motion: &Motion<'_, T, D, L, P>,
        first: usize,
        particles: Movables<'_, T, D, L::Number, P::Particle>,
        cells: &mut [Cell<D>],
    ) -> Outcome<T> {
        with_lanes_for!(T, cells, self.advance_in[_, _](motion, first, particles, cells))
    }

    #[inline(never)]
    fn advance_in<V: Lanes<T, N>, const N: usize, L: LawSweep<T, D>, P: Phase<T, D>>(
        &self,
        motion: &Motion<'_, T, D, L, P>,
        first: usize,
        particles: Movables<'_, T, D, L::Number, P::Particle>,
        cells: &mut [Cell<D>],
    ) -> Outcome<T> {
        advance_by_blocks(
            motion,
            first,
            particles,
            cells,
            #[inline(always)]
            |mut p, block, particles, cells, outcome| {
                let (velocity, dt) = (motion.velocity, motion.dt);
                // Not those of the outcome, which other functions are given: these stay in registers.
                let mut bounds = NO_BOUNDS;
                while p < cells.len() && block.has_room(N) && !outcome.has_lost_one() {
                    if D == 1 {
                        while let (true, Some(group)) = (block.has_room(N), Group::<N>::full_at(p, cells)) {
                            bounds = with_number(bounds, self.grid.linear(&cells[p]));
                            let places = particles.places();
                            let increments =
                                self.shift::<true, V, N>(velocity, dt, group, places, cells, outcome);
                            block.push(&increments, N);
                            p += N;
                        }
                        if !block.has_room(N) || p >= cells.len() {
                            break;
                        }
                    }
                    let group = Group::<N>::at(p, cells);
                    bounds = with_number(bounds, self.grid.linear(&cells[p]));
                    let places = particles.places();
                    let increments = self.shift::<false, V, N>(velocity, dt, group, places, cells, outcome);
                    block.push(&increments, group.count);
                    p += group.count;
                }
                outcome.bound_by(bounds);
            },
        )
    }

    /// Moves the particles of a group, given their positions and displacements; returns their displacement gradients of the step.
    #[inline(always)]
    fn shift<const FULL: bool, V: Lanes<T, N>, const N: usize>(
        &self,
        velocity: &[SVector<T, D>],
        dt: T,
        group: Group<N>,
        (positions, displacements): (&mut [SVector<T, D>], &mut [SVector<T, D>]),
        cells: &mut [Cell<D>],
        outcome: &mut Outcome<T>,
    ) -> [[V; D]; D] {
        let cell = &cells[group.first];
        let x = group.vectors::<FULL, T, V, D>(positions);
        let (path, gradient) = self.increments(velocity, dt, cell, &x);
        let moved: [V; D] = std::array::from_fn(|c| x[c] + path[c]);
        group.put::<FULL, T, V, D>(positions, &moved);
        let displacement = group.vectors::<FULL, T, V, D>(displacements);
        let displacement = std::array::from_fn(|c| displacement[c] + path[c]);
        group.put::<FULL, T, V, D>(displacements, &displacement);
        if !self.grid.clearly_holds_all(cell, &moved) {
            self.settle(group, positions, cells, outcome);
        }
        gradient
    }

    /// Of the particles of a group, their paths and the components of their displacement gradients.
    #[inline(always)]
    fn increments<V: SideBySide<T>>(
        &self,
        velocity: &[SVector<T, D>],
        dt: T,
        cell: &Cell<D>,
        x: &[V; D],
    ) -> ([V; D], [[V; D]; D]) {
        let factors = self.factors(cell, x);
        let (v, slopes) = self.value_and_slopes(self.first_dof(cell), &factors, velocity);
        let inverse = self.grid.inverse_cell_size();
        let steps: [V; D] = std::array::from_fn(|a| V::splat(dt * inverse[a]));
        (
            std::array::from_fn(|c| v[c] * V::splat(dt)),
            std::array::from_fn(|c| std::array::from_fn(|a| slopes[c][a] * steps[a])),
        )
    }

    /// Looks up the cells of a group of which not all clearly stayed.
    #[inline(never)]
    fn settle<const N: usize>(
        &self,
        group: Group<N>,
        positions: &mut [SVector<T, D>],
        cells: &mut [Cell<D>],
        outcome: &mut Outcome<T>,
    ) {
        let bodies = positions.iter_mut().zip(cells).enumerate();
        for (p, (x, cell)) in bodies.skip(group.first).take(group.count) {
            outcome.settle(self.grid, p, cell, x);
        }
    }
}
