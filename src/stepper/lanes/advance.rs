//! Stage 4: positions, stresses and volumes of the particles.

use nalgebra::{SMatrix, SVector};

use super::{Group, Pass};
use crate::basis::BasisFamily;
use crate::grid::Cell;
use crate::lanes::{LANES, Lanes, with_lanes_of};
use crate::law::ConstitutiveLaw;
use crate::particles::Movables;
use crate::phase::Phase;
use crate::scalar::Scalar;
use crate::stepper::deform::{Motion, Outcome, advance_by_blocks};

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>> Pass<'_, T, D, B> {
    /// Moves and deforms the particles, the first of which has the number `first`.
    pub(in super::super) fn advance<L: ConstitutiveLaw<T, D>, P: Phase<T, D>>(
        &self,
        motion: &Motion<'_, T, D, L, P>,
        first: usize,
        particles: Movables<'_, T, D, L::State, P::Particle>,
        cells: &mut [Cell<D>],
    ) -> Outcome<T> {
        with_lanes_of!(T, self.advance_in[_, _](motion, first, particles, cells))
    }

    #[inline(never)]
    fn advance_in<V: Lanes<T>, L: ConstitutiveLaw<T, D>, P: Phase<T, D>>(
        &self,
        motion: &Motion<'_, T, D, L, P>,
        first: usize,
        particles: Movables<'_, T, D, L::State, P::Particle>,
        cells: &mut [Cell<D>],
    ) -> Outcome<T> {
        advance_by_blocks(
            motion,
            first,
            particles,
            cells,
            #[inline(always)]
            |p, block, particles, cells, outcome| {
                let group = Group::at(p, cells);
                let places = particles.places();
                let increments = self.shift::<V>(motion.velocity, motion.dt, group, places, cells, outcome);
                block.push(increments, group.count);
            },
        )
    }

    /// Moves the particles of a group, given their positions and displacements; returns their displacement gradients of the step.
    #[inline(always)]
    fn shift<V: Lanes<T>>(
        &self,
        velocity: &[SVector<T, D>],
        dt: T,
        group: Group,
        (positions, displacements): (&mut [SVector<T, D>], &mut [SVector<T, D>]),
        cells: &mut [Cell<D>],
        outcome: &mut Outcome<T>,
    ) -> [SMatrix<T, D, D>; LANES] {
        let cell = &cells[group.first];
        outcome.bound(self.grid.linear(cell));
        let x = group.vectors::<T, V, D>(positions);
        let (path, gradient) = self.increments(velocity, dt, cell, &x);
        let moved: [V; D] = std::array::from_fn(|c| x[c] + path[c]);
        group.put(positions, &moved);
        let displacement = group.vectors::<T, V, D>(displacements);
        group.put(displacements, &std::array::from_fn(|c| displacement[c] + path[c]));
        if !self.grid.clearly_holds_all(cell, &moved) {
            self.settle(group, positions, cells, outcome);
        }
        std::array::from_fn(|l| SMatrix::from_fn(|c, a| gradient[c][a][l]))
    }

    /// Of the particles of a group, their paths and the components of their displacement gradients.
    #[inline(always)]
    fn increments<V: Lanes<T>>(
        &self,
        velocity: &[SVector<T, D>],
        dt: T,
        cell: &Cell<D>,
        x: &[V; D],
    ) -> ([V; D], [[[T; LANES]; D]; D]) {
        let factors = self.factors(cell, x);
        let (v, slopes) = self.value_and_slopes(self.first_dof(cell), &factors, velocity);
        let inverse = self.grid.inverse_cell_size();
        let steps: [V; D] = std::array::from_fn(|a| V::splat(dt * inverse[a]));
        (
            std::array::from_fn(|c| v[c] * V::splat(dt)),
            std::array::from_fn(|c| std::array::from_fn(|a| (slopes[c][a] * steps[a]).array())),
        )
    }

    /// Looks up the cells of a group of which not all clearly stayed.
    #[inline(never)]
    fn settle(
        &self,
        group: Group,
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
