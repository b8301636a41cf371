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

use super::diffusion::diffusion_geometry;
use super::inner::Inner;
use super::spans::{Spans, share};
use super::sweeps::Sweeps;
use super::waves::smaller;
use super::{CriticalStep, FaceCondition, Forcing, Stepper};
use crate::basis::BasisFamily;
use crate::grid::{Face, Grid};
use crate::law::LawSweep;
use crate::parallel::{PARTICLES, PerSpan, Windows, add_up, each_span, many_threads};
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::transfer::{Sites, Transfer, for_values};

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Bound (1/m2) of the largest eigenvalue of the scheme's inverse mass times stiffness for waves of 1
    /// m/s, with the particles where they are and the faces held that `forcing` holds: `4 / h^2` for linear
    /// functions in full cells along one axis. Two passes over the particles, about a step's work. For
    /// [`Stepper::largest_step`].
    ///
    /// Proved for plain MPM ([`Shepard`](crate::reconstruction::Shepard)) with every basis of values that are
    /// not negative, on every layout: `docs/verification/stability.md` has the proof. Of other
    /// reconstructions it bounds nothing: [`Stepper::stiffness`].
    ///
    /// Infinite for a transfer from the grid ([`Transfer::FROM_GRID`]), for which it is not proved.
    pub fn stiffness_bound(&mut self, forcing: &Forcing<T, D>) -> T {
        if const { X::FROM_GRID } {
            return T::lit(f64::INFINITY);
        }
        stiffness_bound(self, forcing)
    }

    /// Largest step (s) of a layout with this `stiffness` (1/m2, of [`Stepper::stiffness`]) for the waves and
    /// velocities that the particles have now: `1 / dt = c sqrt(stiffness) / 2 + max_a |v_a| / h_a` of the
    /// worst particle, so that neither a wave nor a particle, nor a wave in moving material, gets further
    /// than the scheme's stencil in a step. For linear functions along one axis that is the classical
    /// `dt = h / (c + |v|)`. With a liquid that flows also what its drag allows, and in a phase that diffuses
    /// no more than `2 / (D stiffness)`, `D` the diffusivity: `h^2 / (2 D)`. `None` if there is no wave, and
    /// nothing diffuses.
    ///
    /// `None` too for a transfer from the grid, as [`Stepper::critical_step`].
    pub fn largest_step(&self, stiffness: T) -> Option<CriticalStep<T>> {
        self.inner.largest_step(stiffness)
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// See [`Stepper::largest_step`].
    #[inline(never)]
    fn largest_step(&self, stiffness: T) -> Option<CriticalStep<T>> {
        if const { X::FROM_GRID } {
            return None;
        }
        let wave = self
            .waves()
            .largest_step(self.grid.inverse_cell_size(), stiffness);
        match const { P::DIFFUSES } {
            true => [wave, self.diffusion_limit(stiffness)]
                .into_iter()
                .flatten()
                .reduce(smaller),
            false => wave,
        }
    }

    /// The bound that amounts of the particles give, of the mass and of the stiffness; their masses if none
    /// are given.
    #[inline(never)]
    pub(super) fn largest_ratio<B: BasisFamily<T, D>>(
        &self,
        basis: &B,
        held: &[bool],
        amounts: Option<[&[T]; 2]>,
    ) -> T {
        let amounts = amounts.unwrap_or_else(|| {
            // With a liquid that flows of unit density, since its balances differ.
            let weights = match P::FLOWS {
                true => &self.particles.volume[..],
                false => &self.particles.mass[..],
            };
            [weights; 2]
        });
        let space = (basis, &self.grid);
        let sites = self.particles.sites(self.bins.cells());
        let ratios = slopes_over_masses(space, sites, amounts, &self.spans, held);
        for_values!(B, space.0, |basis| largest_mean((basis, space.1), sites, &ratios))
    }
}

/// See [`Stepper::stiffness_bound`].
#[inline(never)]
fn stiffness_bound<T, const D: usize, L, P, X>(
    stepper: &mut dyn Sweeps<T, D, L, P, X>,
    forcing: &Forcing<T, D>,
) -> T
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    stepper.prepare();
    let inner = stepper.inner();
    let held = held_dofs(forcing, &inner.face_dofs, inner.dofs.mass.len());
    let waves = stepper.largest_ratio(&held, None);
    match const { P::DIFFUSES } {
        true => waves.max(diffusion_geometry(stepper)),
        false => waves,
    }
}

/// Which of `count` DOFs are held in all components.
#[inline(never)]
fn held_dofs<T: Scalar, const D: usize>(
    forcing: &Forcing<T, D>,
    face_dofs: &[Vec<u32>],
    count: usize,
) -> Vec<bool> {
    let mut dofs = vec![false; count];
    for (face, on_face) in Face::all::<D>().zip(face_dofs) {
        if matches!(forcing.face(face), FaceCondition::Held { held, .. } if held.iter().all(|&held| held)) {
            for &dof in on_face {
                if let Some(dof) = dofs.get_mut(dof as usize) {
                    *dof = true;
                }
            }
        }
    }
    dofs
}

/// `M_i` and `W_i / M_i` of every DOF, for `m_p` and `m_p c_p^2` of every particle.
#[inline(never)]
fn slopes_over_masses<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    (basis, grid): (&B, &Grid<T, D>),
    sites: Sites<'_, T, D>,
    [weights, stiffnesses]: [&[T]; 2],
    spans: &Spans<T, D>,
    held: &[bool],
) -> Vec<[T; 2]> {
    let (span, parallel) = share::<D>(&spans.particles, weights.len(), spans.lengths[0]);
    let spans = &spans.particles[..];
    let (mut storage, mut sums) = (Vec::new(), vec![T::zero(); 2 * held.len()]);
    let windows = Windows::new(spans, &mut storage, &mut sums, 2);
    let work = (sites, weights, stiffnesses, windows);
    each_span(parallel, span, work, &|_, (sites, weights, stiffnesses, sums)| {
        let (first, sums) = sums.one();
        let (sums, _) = sums.as_chunks_mut::<2>();
        for (p, &weight) in weights.iter().enumerate() {
            let mut slopes = T::zero();
            sites.for_each(basis, grid, p, |i, _, gradient| {
                if !held[i] {
                    slopes += length(&gradient);
                }
            });
            slopes *= stiffnesses[p];
            sites.for_each(basis, grid, p, |i, phi, gradient| {
                let [mass, bound] = &mut sums[i - first];
                *mass += weight * phi;
                if !held[i] {
                    *bound += slopes * length(&gradient);
                }
            });
        }
    });
    add_up(spans, &storage, &mut sums, 2);
    let mut ratios = sums.as_chunks::<2>().0.to_vec();
    for [mass, slopes] in &mut ratios {
        if *mass > T::zero() {
            *slopes /= *mass;
        }
    }
    ratios
}

/// Largest mean of the DOFs' ratios at a particle.
#[inline(never)]
fn largest_mean<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    (basis, grid): (&B, &Grid<T, D>),
    sites: Sites<'_, T, D>,
    ratios: &[[T; 2]],
) -> T {
    let mut largest = vec![T::zero(); sites.positions.len().div_ceil(PARTICLES)];
    let parallel = largest.len() > 1 && many_threads();
    let work = (sites, PerSpan(&mut largest[..]));
    each_span(parallel, PARTICLES, work, &|_, (sites, found)| {
        let mut most = T::zero();
        for p in 0..sites.positions.len() {
            let mut mean = T::zero();
            sites.for_each(basis, grid, p, |i, phi, _| mean += phi * ratios[i][1]);
            most = most.max(mean);
        }
        found.set(most);
    });
    largest.into_iter().fold(T::zero(), T::max)
}

#[inline(always)]
fn length<T: Scalar, const D: usize>(v: &SVector<T, D>) -> T {
    if const { D == 1 } { v[0].abs() } else { v.norm() }
}
