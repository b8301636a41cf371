//! G2P of accelerations, and P2G of the momenta that particles then have.

use nalgebra::SVector;

use super::spans::{Spans, Totals, share};
use super::sums::{InSpan, Targets, liquid_velocities};
use crate::basis::BasisFamily;
use crate::grid::Grid;
use crate::parallel::{PARTICLES, PerSpan, each_span, worth_sharing};
use crate::particles::{Bins, Particles};
use crate::phase::Phase;
use crate::scalar::Scalar;
use crate::simd::{Number, Packs, each};
use crate::transfer::{Group, Kick, Momentum, Sites, for_values, kick};

/// The velocities of the particles of a span, of `C` phases.
struct Velocities<'a, T: Scalar, const D: usize, P: Phase<T, D>> {
    dt: T,
    masses: &'a [T],
    volumes: &'a [T],
    velocities: &'a mut [SVector<T, D>],
    data: &'a mut [P::Particle],
    phase: &'a P,
    liquid_mass: T,
}

impl<T: Scalar, const D: usize, P: Phase<T, D>, const C: usize> Kick<T, D, C> for Velocities<'_, T, D, P> {
    #[inline(always)]
    fn cut(self, count: usize) -> Self {
        Self {
            masses: &self.masses[..count],
            volumes: &self.volumes[..count],
            velocities: &mut self.velocities[..count],
            data: &mut self.data[..count],
            ..self
        }
    }

    #[inline(always)]
    fn take<K: Packs<T, N>, const N: usize, const FULL: bool>(
        &mut self,
        k: K,
        group: Group<N>,
        accelerations: &[[K::V; D]; C],
    ) -> [[K::V; D]; C] {
        let before = group.vectors::<FULL, T, K, D>(k, self.velocities);
        let dt = k.splat(self.dt);
        let after: [K::V; D] = each(
            #[inline(always)]
            |c| accelerations[0][c].mul_add(dt, before[c]),
        );
        group.put::<FULL, T, K, D>(k, self.velocities, &after);
        let mass = group.amounts::<FULL, T, K>(k, self.masses);
        let mut momenta = [[mass; D]; C];
        for c in 0..D {
            momenta[0][c] = after[c] * mass;
        }
        if const { C > 1 } {
            momenta[C - 1] = self.kick_liquid(k, group, &accelerations[C - 1]);
        }
        momenta
    }
}

impl<T: Scalar, const D: usize, P: Phase<T, D>> Velocities<'_, T, D, P> {
    /// The liquid's velocities; returns its momenta.
    #[inline(always)]
    fn kick_liquid<K: Packs<T, N>, const N: usize>(
        &mut self,
        k: K,
        group: Group<N>,
        accelerations: &[K::V; D],
    ) -> [K::V; D] {
        let changes: [[T; N]; D] = each(
            #[inline(always)]
            |c| k.array(accelerations[c]),
        );
        for l in 0..group.count {
            let p = group.first + l;
            let change = SVector::from_fn(|c, _| changes[c][l] * self.dt);
            self.phase.accelerate_liquid(change, &mut self.data[p]);
            self.liquid_mass += self.phase.liquid_mass(self.volumes[p]);
        }
        let (phase, volumes) = (self.phase, self.volumes);
        let mass = group.amounts_of(
            k,
            #[inline(always)]
            |p| phase.liquid_mass(volumes[p]),
        );
        let velocity = liquid_velocities::<T, D, P, K, N>(k, group, phase, self.data);
        each(
            #[inline(always)]
            |c| velocity[c] * mass,
        )
    }
}

/// `v_p += dt sum_i phi_i(x_p) a_i` of `C` phases and, of the first `M` of them, the momenta of the DOFs from
/// the particles' new ones; returns the particles' totals.
///
/// Values are those of linear functions for all bases that have these: compiled for as few types as there are
/// sweeps, as [`sum_particles`](super::sums::sum_particles).
pub(super) fn kick_particles<T, const D: usize, B, N, P, const C: usize, const M: usize>(
    (basis, grid, bins): (&B, &Grid<T, D>, &Bins<D>),
    particles: &mut Particles<T, D, N, P::Particle>,
    (phase, dt): (&P, T),
    accelerations: [&[SVector<T, D>]; C],
    spans: &mut Spans<T, D>,
    momenta: Targets<'_, T, D, 0, M, 0>,
) -> Totals<T, D>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    P: Phase<T, D>,
{
    let sites = Sites {
        positions: &particles.position,
        cells: bins.cells(),
        domains: particles.domains.views(),
    };
    let velocities = Velocities {
        dt,
        masses: &particles.mass,
        volumes: &particles.volume,
        velocities: &mut particles.velocity,
        data: &mut particles.phase,
        phase,
        liquid_mass: T::zero(),
    };
    for_values!(B, basis, |basis| kick_sites::<_, D, _, _, C, M>(
        (basis, grid, sites),
        velocities,
        accelerations,
        spans,
        momenta
    ))
}

#[inline(never)]
fn kick_sites<T, const D: usize, B, P, const C: usize, const M: usize>(
    (basis, grid, sites): (&B, &Grid<T, D>, Sites<'_, T, D>),
    velocities: Velocities<'_, T, D, P>,
    accelerations: [&[SVector<T, D>]; C],
    spans: &mut Spans<T, D>,
    mut momenta: Targets<'_, T, D, 0, M, 0>,
) -> Totals<T, D>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    P: Phase<T, D>,
{
    let Velocities {
        dt,
        masses,
        volumes,
        velocities,
        data,
        phase,
        ..
    } = velocities;
    let Spans {
        particles: windows,
        lengths,
        store,
        totals,
        ..
    } = &mut *spans;
    let count = sites.positions.len();
    let (span, parallel) = match M {
        0 => (PARTICLES, worth_sharing::<D>(count, PARTICLES)),
        _ => share::<D>(windows, count, lengths[0]),
    };
    totals.fill(Totals::zero());
    let work = (
        sites,
        (masses, volumes),
        (velocities, data),
        store.windows(windows, &mut momenta),
        PerSpan(&mut totals[..]),
    );
    each_span(parallel, span, work, &|_,
                                      (
        places,
        (masses, volumes),
        (velocities, data),
        windows,
        found,
    )| {
        let velocities = Velocities {
            dt,
            masses,
            volumes,
            velocities,
            data,
            phase,
            liquid_mass: T::zero(),
        };
        let sink = InSpan::new(windows).into_sink();
        let (momenta, kicked): ([Momentum<T, D>; C], _) =
            kick::<M, _, D, _, _, C>(basis, grid, places, accelerations, velocities, sink);
        let mut total = Totals::zero();
        for q in 0..C {
            total.momenta[q] = momenta[q];
        }
        total.liquid_mass = kicked.liquid_mass;
        found.set(total);
    });
    if const { M > 0 } {
        store.add_up(windows, &mut momenta);
    }
    spans.total()
}
