//! A bound of the critical step that two passes over the particles give.
//!
//! # The bound and its proof
//!
//! With lumped masses $M_i = \sum_p m_p\phi_i(x_p)$ a step of plain MPM (Shepard) maps particle velocities
//! $v$ to the DOFs by $u_i = \sum_p m_p\phi_i(x_p) v_p / M_i$, strains the particles by $\sum_i
//! u_i\otimes\nabla\phi_i$, and maps forces back by the transposes of both. So its map $G$ (see
//! [`Stepper::critical_step`]) is symmetric in the scalar product of $m$, and $\langle v, G v\rangle_m =
//! \sum_q V_q\,|\sum_i u_i\otimes g_{iq}|^2_C$ with $g_{iq} = \nabla\phi_i(x_q)$ and the law's tangent $C$.
//!
//! 1. *One function.* $|u\otimes g|_C \le c\sqrt\varrho\,|g||u|$: that is what the speed $c$ of the fastest
//!    wave means.
//! 2. *One particle.* By the triangle inequality and Cauchy and Schwarz with the weights $|g_{iq}|$,
//!    $V_q|\sum_i u_i\otimes g_{iq}|_C^2 \le m_q c_q^2 A_q\sum_i|g_{iq}||u_i|^2$, $A_q = \sum_i|g_{iq}|$.
//! 3. *One DOF.* Summed over particles this is $\sum_i W_i|u_i|^2$ with $W_i = \sum_q m_q c_q^2 A_q|g_{iq}|$;
//!    and $u_i$ is a mean of the $v_p$, so that $|u_i|^2 \le \sum_p m_p\phi_i(x_p)|v_p|^2/M_i$ (Jensen; this
//!    asks for $\phi_i\ge0$).
//! 4. *Back at the particles:* $\langle v, G v\rangle_m \le \sum_p m_p|v_p|^2\sum_i\phi_i(x_p)W_i/M_i$, hence
//!
//! $$\lambda_{\max}(G) \le \max_p\sum_i\phi_i(x_p)\frac{W_i}{M_i} \le c^2\gamma.$$
//!
//! $\gamma$ (1/m2) is the same with $c = 1$: grid, basis and layout alone. Linear functions along one axis
//! give the classical $4/h^2$, $\Delta t\le h/c$, for any layout of a full cell. A DOF that hardly any mass
//! sees has a large $W_i/M_i$, but so small a $\phi_i$ at every particle that it counts no more than it does
//! in the scheme. Held DOFs drop out of all sums.

use nalgebra::SVector;

use super::spans::share;
use super::{CriticalStep, FaceCondition, Forcing, Mechanism, Stepper};
use crate::basis::BasisFamily;
use crate::grid::Face;
use crate::law::LawSweep;
use crate::parallel::{PARTICLES, PerSpan, Windows, add_up, each_span, many_threads};
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
    /// Bound (1/m2) of the largest eigenvalue of the scheme's inverse mass times stiffness for waves of 1
    /// m/s, with the particles where they are and the faces held that `forcing` holds: `4 / h^2` for linear
    /// functions in full cells along one axis. Two passes over the particles, about a step's work. For
    /// [`Stepper::largest_step`].
    ///
    /// Proved for plain MPM ([`Shepard`](crate::reconstruction::Shepard)) with every basis of values that are
    /// not negative, on every layout: `docs/verification/stability.md` has the proof. Of other
    /// reconstructions it bounds nothing: [`Stepper::stiffness`].
    pub fn stiffness_bound(&mut self, forcing: &Forcing<T, D>) -> T {
        self.prepare();
        let held = self.held_dofs(forcing);
        // With a liquid that flows of unit density, since its balances differ.
        let waves = match P::FLOWS {
            true => self.largest_ratio(&held, |p| [self.particles.volume[p]; 2]),
            false => self.largest_ratio(&held, |p| [self.particles.mass[p]; 2]),
        };
        match const { P::DIFFUSES } {
            true => waves.max(self.diffusion_geometry()),
            false => waves,
        }
    }

    /// The bound that the amounts of the particles give, of the mass and of the stiffness.
    pub(super) fn largest_ratio(&self, held: &[bool], amounts: impl Fn(usize) -> [T; 2] + Sync) -> T {
        let mut sums = self.sum_masses_and_slopes(held, amounts);
        for sum in &mut sums {
            if sum[0] > T::zero() {
                sum[1] /= sum[0];
            }
        }
        self.largest_mean(&sums)
    }

    /// Which DOFs are held in all components.
    fn held_dofs(&self, forcing: &Forcing<T, D>) -> Vec<bool> {
        let mut dofs = vec![false; self.dofs.mass.len()];
        for (face, on_face) in Face::all::<D>().zip(&self.face_dofs) {
            if matches!(forcing.face(face), FaceCondition::Held { held, .. } if held.iter().all(|&held| held))
            {
                for &dof in on_face {
                    if let Some(dof) = dofs.get_mut(dof as usize) {
                        *dof = true;
                    }
                }
            }
        }
        dofs
    }

    /// `M_i` and `W_i` of every DOF, for `m_p` and `m_p c_p^2` of every particle.
    fn sum_masses_and_slopes(&self, held: &[bool], amounts: impl Fn(usize) -> [T; 2] + Sync) -> Vec<[T; 2]> {
        let (basis, grid) = (&self.basis, &self.grid);
        let spans = &self.spans.particles[..];
        let (span, parallel) = share::<D>(spans, self.particles.len(), self.spans.lengths[0]);
        let (mut storage, mut sums) = (Vec::new(), vec![T::zero(); 2 * held.len()]);
        let work = (
            &self.particles.position[..],
            self.bins.cells(),
            Windows::new(spans, &mut storage, &mut sums, 2),
        );
        each_span(parallel, span, work, &|start, (positions, cells, sums)| {
            let (first, sums) = sums.one();
            let (sums, _) = sums.as_chunks_mut::<2>();
            for (p, (x, cell)) in (start..).zip(positions.iter().zip(cells)) {
                let [weight, stiffness] = amounts(p);
                let mut slopes = T::zero();
                basis.for_each(grid, cell, x, |i, _, gradient| {
                    if !held[i] {
                        slopes += length(&gradient);
                    }
                });
                slopes *= stiffness;
                basis.for_each(grid, cell, x, |i, phi, gradient| {
                    let [mass, bound] = &mut sums[i - first];
                    *mass += weight * phi;
                    if !held[i] {
                        *bound += slopes * length(&gradient);
                    }
                });
            }
        });
        add_up(spans, &storage, &mut sums, 2);
        sums.as_chunks::<2>().0.to_vec()
    }

    /// Largest mean of the DOFs' ratios at a particle.
    fn largest_mean(&self, ratios: &[[T; 2]]) -> T {
        let (basis, grid, positions) = (&self.basis, &self.grid, &self.particles.position[..]);
        let mut largest = vec![T::zero(); positions.len().div_ceil(PARTICLES)];
        let parallel = largest.len() > 1 && many_threads();
        let work = (positions, self.bins.cells(), PerSpan(&mut largest[..]));
        each_span(parallel, PARTICLES, work, &|_, (positions, cells, found)| {
            let mut most = T::zero();
            for (x, cell) in positions.iter().zip(cells) {
                let mut mean = T::zero();
                basis.for_each(grid, cell, x, |i, phi, _| mean += phi * ratios[i][1]);
                most = most.max(mean);
            }
            found.set(most);
        });
        largest.into_iter().fold(T::zero(), T::max)
    }

    /// Largest step (s) of a layout with this `stiffness` (1/m2, of [`Stepper::stiffness`]) for the waves and
    /// velocities that the particles have now: `1 / dt = c sqrt(stiffness) / 2 + max_a |v_a| / h_a` of the
    /// worst particle, so that neither a wave nor a particle, nor a wave in moving material, gets further
    /// than the scheme's stencil in a step. For linear functions along one axis that is the classical
    /// `dt = h / (c + |v|)`. With a liquid that flows also what its drag allows, and in a phase that diffuses
    /// no more than `2 / (D stiffness)`, `D` the diffusivity: `h^2 / (2 D)`. `None` if there is no wave, and
    /// nothing diffuses.
    pub fn largest_step(&self, stiffness: T) -> Option<CriticalStep<T>> {
        let count = self.particles.len().div_ceil(PARTICLES);
        let mut found = vec![None; count];
        let parallel = count > 1 && many_threads();
        // Only to be cut at spans; a particle's data are found by its number.
        let work = (&self.particles.position[..], PerSpan(&mut found[..]));
        each_span(parallel, PARTICLES, work, &|first, (positions, found)| {
            let limits = (first..first + positions.len()).filter_map(|p| self.largest_step_of(p, stiffness));
            found.set(limits.reduce(smaller));
        });
        let wave = found.into_iter().flatten().reduce(smaller);
        match const { P::DIFFUSES } {
            true => [wave, self.diffusion_limit(stiffness)]
                .into_iter()
                .flatten()
                .reduce(smaller),
            false => wave,
        }
    }

    fn largest_step_of(&self, p: usize, stiffness: T) -> Option<CriticalStep<T>> {
        let (particles, inverse) = (&self.particles, self.grid.inverse_cell_size());
        let crossing = |v: &SVector<T, D>| v.component_mul(inverse).amax();
        let mut speed = crossing(&particles.velocity[p]);
        let limit = if P::FLOWS {
            let liquid = self.phase.liquid(&particles.phase[p]);
            speed = speed.max(crossing(&liquid.velocity));
            self.coupled(p).stable_step(stiffness)?
        } else {
            let step = T::lit(2.0) / (self.wave_speed(p) * stiffness.sqrt());
            CriticalStep {
                step,
                mechanism: Mechanism::Wave,
            }
        };
        let step = T::one() / (T::one() / limit.step + speed);
        // Without waves, or with a stress of which the law knows none, there is no limit.
        let is_one = limit.step.is_finite() && step > T::zero();
        is_one.then_some(CriticalStep { step, ..limit })
    }
}

pub(super) fn smaller<T: Scalar>(a: CriticalStep<T>, b: CriticalStep<T>) -> CriticalStep<T> {
    if b.step < a.step { b } else { a }
}

#[inline(always)]
fn length<T: Scalar, const D: usize>(v: &SVector<T, D>) -> T {
    if D == 1 { v[0].abs() } else { v.norm() }
}
