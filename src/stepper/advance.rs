//! Stage 4: positions, stresses and volumes of the particles.

use nalgebra::{SMatrix, SVector};

use super::Stepper;
use super::deform::{Motion, Outcome, advance_by_blocks};
use super::lanes::{self, Pass};
use super::spans::{Fault, Flaw};
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::grid::{Cell, Grid};
use crate::law::ConstitutiveLaw;
use crate::parallel::{PARTICLES, PerSpan, each_span, worth_sharing};
use crate::particles::{Movable, Movables};
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::tensor::determinant;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: ConstitutiveLaw<T, D>,
    P: Phase<T, D>,
{
    /// Moves and deforms every particle and looks its new cell up.
    #[inline(never)]
    pub(super) fn advance(&mut self, dt: T) -> Result<(), StepError> {
        let (basis, grid, law, phase) = (&self.basis, &self.grid, &self.law, &self.phase);
        let velocity = &self.dofs.velocity[..];
        let parallel = worth_sharing::<D>(self.particles.len(), PARTICLES);
        let work = (
            self.particles.movable(),
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
                let outcome = if const { lanes::apply::<T, D, B>() } {
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
    particles: Movables<'_, T, D, L::State, P::Particle>,
    cells: &mut [Cell<D>],
) -> Outcome<T>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    L: ConstitutiveLaw<T, D>,
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

impl<T: Scalar, const D: usize, S: Copy, Q> Movable<'_, T, D, S, Q> {
    /// Moves the particle by `path` and deforms it by `increment` within `dt`; the error is a volume that is no longer a positive number, or a stress
    /// that the law does not know.
    #[inline(always)]
    pub(super) fn advance<L: ConstitutiveLaw<T, D, State = S>>(
        &mut self,
        law: &L,
        dt: T,
        path: &SVector<T, D>,
        increment: &SMatrix<T, D, D>,
    ) -> Result<(), Flaw<T>> {
        *self.position += path;
        *self.displacement += path;
        law.update_over(dt, increment, self.stress, self.state);
        if !law.knows(self.stress, self.state) {
            return Err(Flaw::Stress(self.stress[(0, 0)]));
        }
        if law.large_strain() {
            let volume = *self.volume * determinant(&(SMatrix::identity() + increment));
            // Also refuses a volume that is not a number, or infinite.
            if !(volume > T::zero() && (volume * T::zero()).is_zero()) {
                return Err(Flaw::Volume(volume));
            }
            *self.volume = volume;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
