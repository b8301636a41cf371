//! Stage 4: positions, stresses and volumes of the particles.

use nalgebra::{SMatrix, SVector};

use super::Stepper;
use super::lanes::{self, Motion, Pass};
use super::spans::{Fault, Flaw, Moved};
use super::window;
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::law::ConstitutiveLaw;
use crate::parallel::{PARTICLES, PerSpan, each_span, many_threads};
use crate::particles::{Movable, settle};
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
        let parallel = self.particles.len() > PARTICLES && many_threads();
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
                if const { lanes::apply::<T, D, B>() } {
                    let motion = Motion {
                        velocity,
                        dt,
                        law,
                        phase,
                    };
                    let (moved, span) = Pass::new(basis, grid).advance(&motion, first, particles, cells);
                    bounds.set(span);
                    return found.set(moved);
                }
                let (mut crossings, mut strayed) = (0, false);
                let moved =
                    particles
                        .each()
                        .zip(cells)
                        .enumerate()
                        .try_for_each(|(k, (mut particle, cell))| {
                            let mut v = SVector::zeros();
                            let mut gradient = SMatrix::<T, D, D>::zeros();
                            basis.for_each(grid, cell, particle.position, |i, phi, grad_phi| {
                                v += velocity[i] * phi;
                                gradient += velocity[i] * grad_phi.transpose();
                            });
                            let increment = gradient * dt;
                            if P::COUPLED {
                                phase.update(&increment, particle.phase);
                            }
                            particle
                                .advance(law, dt, &(v * dt), &increment)
                                .map_err(|flaw| Fault::Material(first + k, flaw))?;
                            let crossed =
                                settle(grid, cell, particle.position).ok_or(Fault::Left(first + k))?;
                            crossings += usize::from(crossed);
                            strayed |= crossed && !window::is_safe(grid, cell);
                            Ok(())
                        });
                let fault = moved.err();
                found.set(Moved {
                    crossings,
                    strayed,
                    fault,
                });
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
            Some(Fault::Material(p, flaw)) => Err(flaw.error(self.steps, self.order.number(p), L::LIMITS)),
            Some(Fault::Left(p)) => Err(self.left(p)),
        }
    }
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
