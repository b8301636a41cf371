//! Diffusion of a scalar that particles carry, such as heat.
//!
//! For phases that [`Phase::DIFFUSES`]; of others nothing is compiled. With the capacities $c_p$ and the
//! values $\theta_p$ of the particles, at their positions at the start of the step:
//!
//! 1. P2G of capacities and contents, $C_i = \sum_p c_p\phi_i(x_p)$, $\theta_i = \sum_p
//!    c_p\theta_p\phi_i(x_p)/C_i$;
//! 2. G2P of $\nabla\theta = \sum_i\theta_i\nabla\phi_i(x_p)$, which drives the flux $q_p$, and P2G of $Q_i =
//!    \sum_p V_p\,q_p\cdot\nabla\phi_i(x_p)$;
//! 3. rates $r_i = Q_i/C_i$, on DOFs with a prescribed value $\bar\theta$ (Dirichlet) $(\bar\theta -
//!    \theta_i)/\Delta t$;
//! 4. G2P of $\theta_p \mathrel{+}= \Delta t\sum_i r_i\phi_i(x_p)$, a change as in FLIP: no value is smeared.
//!
//! `docs/theory/diffusion.md` proves what is conserved and the bound of the step.

use super::inner::Inner;
use super::spans::{Fault, InvalidState, Moved, share};
use super::sums::windows;
use super::sweeps::Sweeps;
use super::waves::smaller;
use super::{CriticalStep, DiffusionCondition, Forcing, Mechanism};
use crate::basis::BasisFamily;
use crate::error::{SetupError, StepError};
use crate::grid::Face;
use crate::law::LawSweep;
use crate::parallel::{PARTICLES, PerSpan, Windows, add_up, each_span, worth_sharing};
use crate::particles::Particles;
use crate::phase::Phase;
use crate::scalar::Scalar;
use crate::simd::{Packs, each, in_lanes};
use crate::transfer::{Contribution, Group, Parts, ScalarField, Sites, Transfer, for_values, g2p, p2g};
use nalgebra::SVector;

/// Scalars of a DOF that one sweep sums: capacity and content.
pub(super) const SCALARS: usize = 2;

/// What the DOFs know of a scalar that diffuses.
#[derive(Clone, Debug)]
pub(super) struct Diffusion<T> {
    /// `C_i` (J/K of heat).
    capacities: Vec<T>,
    /// `C_i theta_i` (J).
    contents: Vec<T>,
    /// `theta_i`, or what is prescribed (K).
    values: Vec<T>,
    /// `Q_i` (W), then `r_i` (K/s).
    rates: Vec<T>,
}

impl<T: Scalar> Diffusion<T> {
    /// Of no DOF.
    pub(super) fn none() -> Self {
        Self::new(0)
    }

    pub(super) fn new(dofs: usize) -> Self {
        let zeros = || vec![T::zero(); dofs];
        Self {
            capacities: zeros(),
            contents: zeros(),
            values: zeros(),
            rates: zeros(),
        }
    }

    /// Bytes allocated.
    pub(super) fn bytes(&self) -> usize {
        let all = [&self.capacities, &self.contents, &self.values, &self.rates];
        size_of::<T>() * all.into_iter().map(Vec::capacity).sum::<usize>()
    }

    /// Contents to values; a DOF that no particle sees has none.
    fn divide_contents(&mut self) {
        let sums = self.contents.iter().zip(&self.capacities);
        for (value, (&content, &capacity)) in self.values.iter_mut().zip(sums) {
            *value = ratio(content, capacity);
        }
    }

    /// What DOFs take in to rates.
    fn divide_rates(&mut self) {
        for (rate, &capacity) in self.rates.iter_mut().zip(&self.capacities) {
            *rate = ratio(*rate, capacity);
        }
    }

    /// Prescribes the values of DOFs.
    fn prescribe_values(&mut self, dofs: &[u32], told: T) {
        for &dof in dofs {
            if let Some(value) = self.values.get_mut(dof as usize) {
                *value = told;
            }
        }
    }

    /// Prescribes the rates that bring the same DOFs to that value within `dt`.
    fn prescribe_rates(&mut self, dofs: &[u32], told: T, dt: T) {
        for dof in dofs.iter().map(|&dof| dof as usize) {
            let sums = (self.contents.get(dof), self.capacities.get(dof));
            if let (Some(rate), (Some(&content), Some(&capacity))) = (self.rates.get_mut(dof), sums) {
                *rate = ratio(told * capacity - content, capacity) / dt;
            }
        }
    }
}

#[inline(always)]
fn ratio<T: Scalar>(amount: T, capacity: T) -> T {
    if capacity > T::zero() {
        amount / capacity
    } else {
        T::zero()
    }
}

/// Refuses a particle that takes in nothing, or whose value is no number.
pub(super) fn refuse_without_capacity<T: Scalar, const D: usize, S, P: Phase<T, D>>(
    phase: &P,
    particles: &Particles<T, D, S, P::Particle>,
) -> Result<(), SetupError> {
    if const { !P::DIFFUSES } {
        return Ok(());
    }
    let bodies = particles.mass.iter().zip(&particles.volume).zip(&particles.phase);
    for (place, ((&mass, &volume), data)) in bodies.enumerate() {
        let refuse = |name, value: T, allowed| SetupError::Value {
            particle: place,
            name,
            value: value.primal(),
            allowed,
        };
        let (capacity, value) = (phase.capacity(mass, volume, data), phase.value(data));
        if !(capacity > T::zero() && capacity.is_finite()) {
            return Err(refuse("capacity", capacity, "it must be positive and finite"));
        }
        if !value.is_finite() {
            return Err(refuse("value that diffuses", value, "it must be finite"));
        }
    }
    Ok(())
}

/// Capacities and contents of the particles of a span.
struct Contents<'a, T: Scalar, const D: usize, P: Phase<T, D>> {
    masses: &'a [T],
    volumes: &'a [T],
    data: &'a [P::Particle],
    phase: &'a P,
}

impl<T: Scalar, const D: usize, P: Phase<T, D>> Clone for Contents<'_, T, D, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Scalar, const D: usize, P: Phase<T, D>> Copy for Contents<'_, T, D, P> {}

impl<T: Scalar, const D: usize, P: Phase<T, D>> Contribution<T, D, SCALARS, 0, 0> for Contents<'_, T, D, P> {
    #[inline(always)]
    fn cut(self, count: usize) -> Self {
        Self {
            masses: &self.masses[..count],
            volumes: &self.volumes[..count],
            data: &self.data[..count],
            ..self
        }
    }

    #[inline(always)]
    fn parts<K: Packs<T, N>, const N: usize, const FULL: bool>(
        &self,
        k: K,
        group: Group<N>,
        _slopes: &[K::V; D],
    ) -> Parts<K::V, D, SCALARS, 0, 0> {
        let capacity = group.amounts_of(
            k,
            #[inline(always)]
            |p| {
                self.phase
                    .capacity(self.masses[p], self.volumes[p], &self.data[p])
            },
        );
        let value = group.amounts_of(
            k,
            #[inline(always)]
            |p| self.phase.value(&self.data[p]),
        );
        Parts {
            scalars: [capacity, capacity * value],
            vectors: [],
            tensors: [],
        }
    }
}

/// Fluxes of the particles of a span. Sums with gradients are those of tensors; a flux is the first row of
/// one.
struct Fluxes<'a, T: Scalar, const D: usize, B, P: Phase<T, D>> {
    field: ScalarField<'a, T, D, B>,
    volumes: &'a [T],
    data: &'a [P::Particle],
    phase: &'a P,
}

impl<T: Scalar, const D: usize, B, P: Phase<T, D>> Clone for Fluxes<'_, T, D, B, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Scalar, const D: usize, B, P: Phase<T, D>> Copy for Fluxes<'_, T, D, B, P> {}

impl<T, const D: usize, B, P> Contribution<T, D, 0, 0, 1> for Fluxes<'_, T, D, B, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    P: Phase<T, D>,
{
    #[inline(always)]
    fn cut(self, count: usize) -> Self {
        Self {
            field: self.field.cut(count),
            volumes: &self.volumes[..count],
            data: &self.data[..count],
            ..self
        }
    }

    #[inline(always)]
    fn parts<K: Packs<T, N>, const N: usize, const FULL: bool>(
        &self,
        k: K,
        group: Group<N>,
        slopes: &[K::V; D],
    ) -> Parts<K::V, D, 0, 0, 1> {
        let gradient = self.field.gradient::<K, N, FULL>(k, group);
        let gradient: [[T; N]; D] = each(
            #[inline(always)]
            |a| k.array(gradient[a]),
        );
        let fluxes: [SVector<T, D>; N] = each(
            #[inline(always)]
            |l| {
                let gradient = SVector::from_fn(|a, _| gradient[a][l]);
                self.phase.flux(&gradient, &self.data[group.particle(l)])
            },
        );
        let volume = group.amounts::<FULL, T, K>(k, self.volumes);
        let zero = k.splat(T::zero());
        let mut tensors = [[[zero; D]; D]; 1];
        for a in 0..D {
            let flux = k.pack(in_lanes(
                #[inline(always)]
                |l| fluxes[l][a],
            ));
            tensors[0][0][a] = flux * (volume * slopes[a]);
        }
        Parts {
            scalars: [],
            vectors: [],
            tensors,
        }
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// The stage: values of the particles one step later.
    pub(super) fn diffuse<B: BasisFamily<T, D>>(
        &mut self,
        basis: &B,
        dt: T,
        forcing: &Forcing<T, D>,
    ) -> Result<(), StepError> {
        if const { !P::DIFFUSES } {
            return Ok(());
        }
        self.map_contents(basis);
        self.diffusion.divide_contents();
        self.each_prescribed(forcing, |diffusion, dofs, told| {
            diffusion.prescribe_values(dofs, told);
        });
        self.map_fluxes(basis);
        self.diffusion.divide_rates();
        self.each_prescribed(forcing, |diffusion, dofs, told| {
            diffusion.prescribe_rates(dofs, told, dt);
        });
        self.take_in(basis, dt);
        self.find_fault()
    }

    /// Calls `prescribe` with the DOFs of each face that has a value, and with that value.
    fn each_prescribed(&mut self, forcing: &Forcing<T, D>, prescribe: impl Fn(&mut Diffusion<T>, &[u32], T)) {
        for (face, dofs) in Face::all::<D>().zip(&self.face_dofs) {
            if let DiffusionCondition::Value(told) = forcing.diffusion(face) {
                prescribe(&mut self.diffusion, dofs, told);
            }
        }
    }

    /// P2G of capacities and contents.
    #[inline(never)]
    fn map_contents<B: BasisFamily<T, D>>(&mut self, basis: &B) {
        let (basis, grid, phase, particles) = (basis, &self.grid, &self.phase, &self.particles);
        let (spans, store) = (&self.spans.particles[..], &mut self.spans.store);
        let (span, parallel) = share::<D>(spans, particles.position.len(), self.spans.lengths[0]);
        let Diffusion {
            capacities, contents, ..
        } = &mut self.diffusion;
        let targets: [&mut [T]; SCALARS] = [capacities, contents];
        let work = (
            particles.sites(self.bins.cells()),
            (&particles.mass[..], &particles.volume[..]),
            &particles.phase[..],
            windows(spans, &mut store.scalars, targets),
        );
        each_span(parallel, span, work, &|_,
                                          (
            places,
            (masses, volumes),
            data,
            sums,
        )| {
            let [(first, capacities), (_, contents)] = sums.map(Windows::one);
            let amounts = Contents {
                masses,
                volumes,
                data,
                phase,
            };
            for_values!(B, basis, |basis| p2g(basis, grid, places, amounts, |dof, sum| {
                capacities[dof - first] += sum.scalars[0];
                contents[dof - first] += sum.scalars[1];
            }));
        });
        let [of_capacities, of_contents, ..] = &store.scalars;
        add_up(spans, of_capacities, capacities, 1);
        add_up(spans, of_contents, contents, 1);
    }

    /// G2P of gradients and P2G of fluxes.
    #[inline(never)]
    fn map_fluxes<B: BasisFamily<T, D>>(&mut self, basis: &B) {
        let (basis, grid, phase, particles) = (basis, &self.grid, &self.phase, &self.particles);
        let (spans, store) = (&self.spans.particles[..], &mut self.spans.store.scalars[0]);
        let (span, parallel) = share::<D>(spans, particles.position.len(), self.spans.lengths[0]);
        let Diffusion { values, rates, .. } = &mut self.diffusion;
        let work = (
            particles.sites(self.bins.cells()),
            (&particles.volume[..], &particles.phase[..]),
            Windows::new(spans, store, rates, 1),
        );
        each_span(parallel, span, work, &|_, (places, (volumes, data), sums)| {
            let (first, rates) = sums.one();
            let fluxes = Fluxes {
                field: ScalarField::new(basis, grid, places, values),
                volumes,
                data,
                phase,
            };
            p2g(basis, grid, places, fluxes, |dof, sum| {
                rates[dof - first] += sum.forces[0][0];
            });
        });
        add_up(spans, store, rates, 1);
    }

    /// G2P of rates.
    #[inline(never)]
    fn take_in<B: BasisFamily<T, D>>(&mut self, basis: &B, dt: T) {
        let (basis, grid, phase, rates) = (basis, &self.grid, &self.phase, &self.diffusion.rates[..]);
        let particles = &mut self.particles;
        let parallel = worth_sharing::<D>(particles.position.len(), PARTICLES);
        let work = (
            Sites {
                positions: &particles.position,
                cells: self.bins.cells(),
                domains: particles.domains.views(),
            },
            &mut particles.phase[..],
            PerSpan(&mut self.spans.moved[..]),
        );
        each_span(parallel, PARTICLES, work, &|first, (places, data, found)| {
            let mut fault = None;
            for_values!(B, basis, |basis| g2p(
                basis,
                grid,
                places,
                rates,
                #[inline(always)]
                |p, rate| {
                    phase.add_to_value(rate * dt, &mut data[p]);
                    let value = phase.value(&data[p]);
                    if fault.is_none() && !value.is_finite() {
                        fault = Some(Fault::Material(first + p, InvalidState::Value(value)));
                    }
                }
            ));
            found.set(Moved {
                fault,
                ..Moved::default()
            });
        });
    }

    /// The error is that of the first particle whose value is no number any more.
    fn find_fault(&self) -> Result<(), StepError> {
        match self.spans.moved.iter().find_map(|span| span.fault) {
            Some(Fault::Material(p, flaw)) => {
                Err(flaw.error(self.steps + 1, self.order.number(p), self.law.limits()))
            }
            Some(Fault::Left(_)) | None => Ok(()),
        }
    }

    /// The largest stable step with a bound of that; `None` if nothing diffuses.
    pub(super) fn diffusion_limit(&self, geometry: T) -> Option<CriticalStep<T>> {
        let limits = (0..self.particles.len()).map(|p| limit(self.diffusivity(p) * geometry));
        limits.flatten().reduce(smaller)
    }

    fn capacity(&self, p: usize) -> T {
        let particles = &self.particles;
        self.phase
            .capacity(particles.mass[p], particles.volume[p], &particles.phase[p])
    }

    fn diffusivity(&self, p: usize) -> T {
        let particles = &self.particles;
        self.phase
            .diffusivity(particles.mass[p], particles.volume[p], &particles.phase[p])
    }
}

/// Bound (1/m2) of the largest eigenvalue for a diffusivity of 1 m2/s, of particles in their cells
/// ([`Sweeps::prepare`]).
pub(super) fn diffusion_geometry<T, const D: usize, L, P, X>(stepper: &mut dyn Sweeps<T, D, L, P, X>) -> T
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    let inner = stepper.inner();
    let held = vec![false; inner.diffusion.capacities.len()];
    let capacities: Vec<T> = (0..inner.particles.len()).map(|p| inner.capacity(p)).collect();
    stepper.largest_ratio(&held, Some([&capacities; 2]))
}

/// The largest stable step by the bound with the diffusivity of every particle.
pub(super) fn critical_diffusion<T, const D: usize, L, P, X>(
    stepper: &mut dyn Sweeps<T, D, L, P, X>,
) -> Option<CriticalStep<T>>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    stepper.prepare();
    let inner = stepper.inner();
    let held = vec![false; inner.diffusion.capacities.len()];
    let particles = 0..inner.particles.len();
    let capacities: Vec<T> = particles.clone().map(|p| inner.capacity(p)).collect();
    let conductances: Vec<T> = particles.map(|p| capacities[p] * inner.diffusivity(p)).collect();
    limit(stepper.largest_ratio(&held, Some([&capacities, &conductances])))
}

/// Twice one over an eigenvalue (1/s).
fn limit<T: Scalar>(eigenvalue: T) -> Option<CriticalStep<T>> {
    let step = T::lit(2.0) / eigenvalue;
    (eigenvalue > T::zero() && step > T::zero()).then_some(CriticalStep {
        step,
        mechanism: Mechanism::Diffusion,
    })
}
