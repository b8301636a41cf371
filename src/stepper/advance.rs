//! Stage 4: positions, stresses and volumes of the particles.

use nalgebra::{SMatrix, SVector};

use super::Stepper;
use super::deform::{Motion, Outcome, advance_by_blocks};
use super::lanes::{self, Pass};
use super::spans::Fault;
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::grid::{Cell, Grid};
use crate::law::LawSweep;
use crate::parallel::{PARTICLES, PerSpan, each_span, worth_sharing};
use crate::particles::Movables;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    /// Moves and deforms every particle and looks its new cell up.
    #[inline(never)]
    pub(super) fn advance(&mut self, dt: T) -> Result<(), StepError> {
        let (basis, grid, law, phase) = (&self.basis, &self.grid, &self.law, &self.phase);
        let (velocity, both) = (&self.dofs.velocity[..], &self.motion[..]);
        let parallel = worth_sharing::<D>(self.particles.len(), PARTICLES);
        let work = (
            self.particles.movable(law.numbers()),
            self.bins.cells_mut(),
            PerSpan(&mut self.spans.moved),
            PerSpan(&mut self.spans.bounds),
        );
        each_span(
            parallel,
            PARTICLES,
            work,
            &|first, (particles, cells, found, bounds)| {
                let motion = Motion {
                    velocity,
                    dt,
                    law,
                    phase,
                };
                let outcome = if const { P::FLOWS } {
                    advance_with_liquid(basis, grid, &motion, both, first, particles, cells)
                } else if const { lanes::apply::<T, D, B>() } {
                    Pass::new(basis, grid).advance(&motion, first, particles, cells)
                } else {
                    advance_one_by_one(basis, grid, &motion, first, particles, cells)
                };
                bounds.set(outcome.bounds);
                found.set(outcome.moved);
            },
        );
        self.account_for_moves()
    }

    /// Counts crossings; the error is that of the first particle at fault.
    pub(super) fn account_for_moves(&mut self) -> Result<(), StepError> {
        let moved = &self.spans.moved;
        let crossings = moved.iter().map(|span| span.crossings).sum();
        let fault = moved.iter().find_map(|span| span.fault);
        self.strayed |= moved.iter().any(|span| span.strayed);
        self.diagnostics.grid_crossings += crossings;
        self.bins.note_crossings(crossings);
        self.order.note_crossings(crossings);
        self.spans.stale |= crossings > 0;
        match fault {
            None => Ok(()),
            Some(Fault::Material(p, flaw)) => {
                Err(flaw.error(self.steps, self.order.number(p), self.law.limits()))
            }
            Some(Fault::Left(p)) => Err(self.left(p)),
        }
    }
}

/// Moves and deforms the particles of a span for any basis.
#[inline(always)]
fn advance_one_by_one<T, const D: usize, B, L, P>(
    basis: &B,
    grid: &Grid<T, D>,
    motion: &Motion<'_, T, D, L, P>,
    first: usize,
    particles: Movables<'_, T, D, L::Number, P::Particle>,
    cells: &mut [Cell<D>],
) -> Outcome<T>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    let (velocity, dt) = (motion.velocity, motion.dt);
    advance_by_blocks(
        motion,
        first,
        particles,
        cells,
        #[inline(always)]
        |p, block, particles, cells, outcome| {
            let (positions, displacements) = particles.places();
            let (x, cell) = (&mut positions[p], &mut cells[p]);
            let mut v = SVector::zeros();
            let mut gradient = SMatrix::<T, D, D>::zeros();
            basis.for_each(grid, cell, x, |i, phi, grad_phi| {
                v += velocity[i] * phi;
                gradient += velocity[i] * grad_phi.transpose();
            });
            let path = v * dt;
            *x += path;
            displacements[p] += path;
            block.push_one(gradient * dt);
            outcome.bound(grid.linear(cell));
            outcome.settle(grid, p, cell, x);
        },
    )
}

/// The same where a liquid flows: particles move with the solid, and the pressure follows the velocities of `both`.
#[inline(always)]
fn advance_with_liquid<T, const D: usize, B, L, P>(
    basis: &B,
    grid: &Grid<T, D>,
    motion: &Motion<'_, T, D, L, P>,
    both: &[[SVector<T, D>; 2]],
    first: usize,
    particles: Movables<'_, T, D, L::Number, P::Particle>,
    cells: &mut [Cell<D>],
) -> Outcome<T>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    let dt = motion.dt;
    advance_by_blocks(
        motion,
        first,
        particles,
        cells,
        #[inline(always)]
        |p, block, particles, cells, outcome| {
            let (positions, displacements, data) = particles.places_and_phase();
            let (x, cell) = (&mut positions[p], &mut cells[p]);
            let mut v = SVector::zeros();
            let mut gradient = SMatrix::<T, D, D>::zeros();
            let mut liquid_gradient = SMatrix::<T, D, D>::zeros();
            basis.for_each(grid, cell, x, |i, phi, grad_phi| {
                let [solid, liquid] = &both[i];
                v += solid * phi;
                gradient += solid * grad_phi.transpose();
                liquid_gradient += liquid * grad_phi.transpose();
            });
            let (path, increment) = (v * dt, gradient * dt);
            motion
                .phase
                .update_with_flow(&increment, &(liquid_gradient * dt), &mut data[p]);
            *x += path;
            displacements[p] += path;
            block.push_one(increment);
            outcome.bound(grid.linear(cell));
            outcome.settle(grid, p, cell, x);
        },
    )
}

#[cfg(test)]
mod tests;
