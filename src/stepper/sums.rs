//! P2G: masses, momenta and forces of the DOFs, straight from the particles.
//!
//! Everything that a DOF is to know of the particles is summed in as few sweeps as possible: with plain
//! particles masses and forces in one, and with a liquid that flows both masses, the drag, both momenta and
//! both forces.

use nalgebra::{SMatrix, SVector};

use super::dofs::Dofs;
use super::liquid::UniformLoad;
use super::spans::{Spans, Store, share};
use crate::basis::BasisFamily;
use crate::grid::Grid;
use crate::parallel::{Maybe, SpanWindow, Windows, add_up, each_span};
use crate::particles::{Bins, Particles};
use crate::phase::{OnePhase, Phase};
use crate::scalar::Scalar;
use crate::simd::{Packs, each, in_lanes};
use crate::transfer::{Contribution, Group, Parts, Sites, Sum, for_values, p2g};

/// What particles add to DOFs: `S` of the solid's mass, the liquid's and the drag, `C` of both momenta, `G`
/// of the forces on the whole and on the liquid.
pub(super) struct Amounts<'a, T: Scalar, const D: usize, P: Phase<T, D>> {
    pub(super) masses: &'a [T],
    pub(super) volumes: &'a [T],
    pub(super) velocities: &'a [SVector<T, D>],
    pub(super) stresses: &'a [SMatrix<T, D, D>],
    pub(super) data: &'a [P::Particle],
    pub(super) phase: &'a P,
    /// Masses of the particles' liquid, where they are not to be those of their volumes now.
    pub(super) liquid_masses: Option<&'a [T]>,
    /// Taken from stress and pressure.
    pub(super) even: UniformLoad<T>,
}

impl<T, const D: usize, P, const S: usize, const C: usize, const G: usize> Contribution<T, D, S, C, G>
    for Amounts<'_, T, D, P>
where
    T: Scalar,
    P: Phase<T, D>,
{
    #[inline(always)]
    fn cut(self, count: usize) -> Self {
        Self {
            masses: &self.masses[..count],
            volumes: &self.volumes[..count],
            velocities: &self.velocities[..count],
            stresses: &self.stresses[..count],
            data: &self.data[..count],
            liquid_masses: self.liquid_masses.map(|masses| &masses[..count]),
            ..self
        }
    }

    #[inline(always)]
    fn parts<K: Packs<T, N>, const N: usize, const FULL: bool>(
        &self,
        k: K,
        group: Group<N>,
        slopes: &[K::V; D],
    ) -> Parts<K::V, D, S, C, G> {
        let zero = k.splat(T::zero());
        let mass = group.amounts::<FULL, T, K>(k, self.masses);
        let mut scalars = [mass; S];
        let mut liquid_mass = zero;
        if const { S > 1 || C > 1 } {
            liquid_mass = match self.liquid_masses {
                Some(masses) => group.amounts::<FULL, T, K>(k, masses),
                None => group.amounts_of(
                    k,
                    #[inline(always)]
                    |p| self.phase.liquid_mass(self.volumes[p]),
                ),
            };
        }
        if const { S > 1 } {
            scalars[1] = liquid_mass;
            scalars[S - 1] = group.amounts_of(
                k,
                #[inline(always)]
                |p| self.phase.drag(self.masses[p], self.volumes[p]),
            );
        }
        let mut vectors = [[zero; D]; C];
        if const { C > 0 } {
            let velocity = group.vectors::<FULL, T, K, D>(k, self.velocities);
            for c in 0..D {
                vectors[0][c] = velocity[c] * mass;
            }
        }
        if const { C > 1 } {
            let velocity = liquid_velocities::<T, D, P, K, N>(k, group, self.phase, self.data);
            for c in 0..D {
                vectors[C - 1][c] = velocity[c] * liquid_mass;
            }
        }
        let mut tensors = [[[zero; D]; D]; G];
        if const { G > 0 } {
            let volume = group.amounts::<FULL, T, K>(k, self.volumes);
            let along: [K::V; D] = each(
                #[inline(always)]
                |a| volume * slopes[a],
            );
            let stress: [[K::V; D]; D] = group.with::<FULL, _, _>(
                self.stresses,
                #[inline(always)]
                |lanes| {
                    let total: [SMatrix<T, D, D>; N] = each(
                        #[inline(always)]
                        |l| self.total_stress::<G>(&lanes[l], group.particle(l)),
                    );
                    Group::<N>::tensors(k, &total)
                },
            );
            for c in 0..D {
                for a in 0..D {
                    tensors[0][c][a] = stress[c][a] * along[a];
                }
            }
            if const { G > 1 } {
                let pressure = group.amounts_of(
                    k,
                    #[inline(always)]
                    |p| self.phase.liquid(&self.data[p]).pressure - self.even.pressure,
                );
                for c in 0..D {
                    tensors[G - 1][c][c] = pressure * along[c];
                }
            }
        }
        Parts {
            scalars,
            vectors,
            tensors,
        }
    }
}

impl<T: Scalar, const D: usize, P: Phase<T, D>> Clone for Amounts<'_, T, D, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Scalar, const D: usize, P: Phase<T, D>> Copy for Amounts<'_, T, D, P> {}

/// As many as anybody asks for; they take no memory.
const NOTHING: &[()] = &[(); usize::MAX];

impl<'a, T: Scalar, const D: usize, P: Phase<T, D>> Amounts<'a, T, D, P> {
    /// Those of a solid without pores.
    fn of_solid(self) -> Amounts<'a, T, D, OnePhase> {
        Amounts {
            masses: self.masses,
            volumes: self.volumes,
            velocities: self.velocities,
            stresses: self.stresses,
            data: &NOTHING[..self.data.len()],
            phase: &OnePhase,
            liquid_masses: None,
            even: self.even,
        }
    }

    /// What the balance of the whole feels of a particle's stress; with a liquid that flows less the even
    /// load.
    #[inline(always)]
    fn total_stress<const G: usize>(&self, effective: &SMatrix<T, D, D>, p: usize) -> SMatrix<T, D, D> {
        if !P::COUPLED {
            return *effective;
        }
        let mut total = self.phase.total_stress(effective, &self.data[p]);
        if const { G > 1 } {
            for a in 0..D {
                total[(a, a)] -= self.even.stress;
            }
        }
        total
    }
}

/// The components of the velocities of a group's liquid.
#[inline(always)]
pub(super) fn liquid_velocities<T: Scalar, const D: usize, P: Phase<T, D>, K: Packs<T, N>, const N: usize>(
    k: K,
    group: Group<N>,
    phase: &P,
    data: &[P::Particle],
) -> [K::V; D] {
    let velocities: [SVector<T, D>; N] = each(
        #[inline(always)]
        |l| phase.liquid(&data[group.particle(l)]).velocity,
    );
    each(
        #[inline(always)]
        |c| {
            k.pack(in_lanes(
                #[inline(always)]
                |l| velocities[l][c],
            ))
        },
    )
}

/// Where sums go: `S` scalars, `C` momenta and `G` forces of the DOFs.
pub(super) struct Targets<'a, T, const D: usize, const S: usize, const C: usize, const G: usize> {
    pub(super) scalars: [&'a mut [T]; S],
    pub(super) vectors: [&'a mut [SVector<T, D>]; C],
    pub(super) forces: [&'a mut [SVector<T, D>]; G],
}

impl<'a, T: Scalar, const D: usize, const S: usize, const C: usize, const G: usize>
    Targets<'a, T, D, S, C, G>
{
    /// Of the solid and, where there is one, of the liquid.
    pub(super) fn new(solid: &'a mut Dofs<T, D>, liquid: &'a mut Dofs<T, D>, drag: &'a mut [T]) -> Self {
        Self {
            scalars: first([&mut solid.mass[..], &mut liquid.mass[..], drag]),
            vectors: first([&mut solid.velocity[..], &mut liquid.velocity[..]]),
            forces: first([&mut solid.force[..], &mut liquid.force[..]]),
        }
    }

    /// Forces alone.
    pub(super) fn of_forces(forces: [&'a mut [SVector<T, D>]; G]) -> Targets<'a, T, D, 0, 0, G> {
        Targets {
            scalars: [],
            vectors: [],
            forces,
        }
    }

    /// Momenta alone.
    pub(super) fn of_momenta(vectors: [&'a mut [SVector<T, D>]; C]) -> Targets<'a, T, D, 0, C, 0> {
        Targets {
            scalars: [],
            vectors,
            forces: [],
        }
    }

    /// The same with the row sums of fitted masses in the place of those of the particles.
    pub(super) fn fitted(solid: &'a mut Dofs<T, D>, liquid: &'a mut Dofs<T, D>) -> Self {
        Self {
            scalars: first([&mut solid.lumped[..], &mut liquid.lumped[..]]),
            vectors: first([&mut solid.velocity[..], &mut liquid.velocity[..]]),
            forces: first([&mut solid.force[..], &mut liquid.force[..]]),
        }
    }
}

/// The first so many.
pub(super) fn first<A: Default, const M: usize, const N: usize>(all: [A; M]) -> [A; N] {
    let mut all = all.into_iter();
    std::array::from_fn(|_| all.next().unwrap_or_default())
}

/// Windows of spans for each of several targets.
pub(super) fn windows<'a, Q: Copy + num_traits::Zero + Send, const N: usize>(
    spans: &'a [SpanWindow],
    stores: &'a mut [Vec<Q>],
    targets: [&'a mut [Q]; N],
) -> [Windows<'a, Q>; N] {
    let mut stores = stores.iter_mut();
    targets.map(|target| match stores.next() {
        Some(store) => Windows::new(spans, store, target, 1),
        None => Windows::default(),
    })
}

/// Windows of spans for the targets of a sweep: first those of scalars, of momenta and of forces.
type AllWindows<'a, T, const D: usize, const S: usize, const C: usize, const G: usize> = (
    [Windows<'a, T>; S],
    [Windows<'a, SVector<T, D>>; C],
    [Windows<'a, SVector<T, D>>; G],
);

impl<T: Scalar, const D: usize> Store<T, D> {
    /// Windows for `targets`.
    pub(super) fn windows<'a, const S: usize, const C: usize, const G: usize>(
        &'a mut self,
        spans: &'a [SpanWindow],
        targets: &'a mut Targets<'_, T, D, S, C, G>,
    ) -> AllWindows<'a, T, D, S, C, G> {
        // Sweeps that have no momenta put forces where others put momenta.
        let (of_momenta, of_forces) = self.vectors.split_at_mut(C);
        (
            windows(spans, &mut self.scalars, lent(&mut targets.scalars)),
            windows(spans, of_momenta, lent(&mut targets.vectors)),
            windows(spans, of_forces, lent(&mut targets.forces)),
        )
    }

    /// Adds the sums of windows up in `targets`.
    pub(super) fn add_up<const S: usize, const C: usize, const G: usize>(
        &self,
        spans: &[SpanWindow],
        targets: &mut Targets<'_, T, D, S, C, G>,
    ) {
        let (of_momenta, of_forces) = self.vectors.split_at(C);
        for (store, target) in self.scalars.iter().zip(&mut targets.scalars) {
            add_up(spans, store, target, 1);
        }
        for (store, target) in of_momenta.iter().zip(&mut targets.vectors) {
            add_up(spans, store, target, 1);
        }
        for (store, target) in of_forces.iter().zip(&mut targets.forces) {
            add_up(spans, store, target, 1);
        }
    }
}

// Functions of the numbers that they look at: closures of those above them would be compiled for every sweep.

/// The windows of one span, which begin with the DOF `first`.
fn opened<'a, Q: Copy + num_traits::Zero + Send, const N: usize>(
    windows: [Windows<'a, Q>; N],
    first: &mut usize,
) -> [&'a mut [Q]; N] {
    windows.map(|window| {
        let (start, values) = window.one();
        *first = start;
        values
    })
}

/// The same slices, full of zeros.
fn emptied<Q: Copy + num_traits::Zero, const N: usize>(slices: [&mut [Q]; N]) -> [&mut [Q]; N] {
    slices.map(|values| {
        values.fill(Q::zero());
        values
    })
}

/// The same slices, borrowed for a while.
fn lent<'a, Q, const N: usize>(slices: &'a mut [&mut [Q]; N]) -> [&'a mut [Q]; N] {
    slices.each_mut().map(|values| &mut **values)
}

/// The windows of one span.
pub(super) struct InSpan<'a, T, const D: usize, const S: usize, const C: usize, const G: usize> {
    pub(super) first: usize,
    scalars: [&'a mut [T]; S],
    vectors: [&'a mut [SVector<T, D>]; C],
    forces: [&'a mut [SVector<T, D>]; G],
}

impl<T: Scalar, const D: usize> InSpan<'_, T, D, 0, 1, 0> {
    /// Adds a vector at a DOF.
    #[inline(always)]
    pub(super) fn add_vector(&mut self, dof: usize, vector: SVector<T, D>) {
        self.vectors[0][dof - self.first] += vector;
    }
}

impl<'a, T: Scalar, const D: usize, const S: usize, const C: usize, const G: usize>
    InSpan<'a, T, D, S, C, G>
{
    #[inline(always)]
    pub(super) fn new((scalars, vectors, forces): AllWindows<'a, T, D, S, C, G>) -> Self {
        let mut first = 0;
        Self {
            scalars: opened(scalars, &mut first),
            vectors: opened(vectors, &mut first),
            forces: opened(forces, &mut first),
            first,
        }
    }

    /// All DOFs, with nothing in them yet.
    pub(super) fn whole(targets: Targets<'a, T, D, S, C, G>) -> Self {
        let Targets {
            scalars,
            vectors,
            forces,
        } = targets;
        Self {
            first: 0,
            scalars: emptied(scalars),
            vectors: emptied(vectors),
            forces: emptied(forces),
        }
    }

    /// What adds the sum of a DOF. It holds the slices by value: references to them would be read anew for
    /// each DOF. A closure has the type parameters of the function that it stands in, and what it is handed
    /// to is compiled for each: this one has those of its sums only.
    #[inline(always)]
    pub(super) fn into_sink(mut self) -> impl FnMut(usize, Sum<T, D, S, C, G>) {
        #[inline(always)]
        move |dof, sum| self.add(dof, sum)
    }

    /// Adds the sum of a DOF; what tensors give with gradients is taken off: forces.
    #[inline(always)]
    pub(super) fn add(&mut self, dof: usize, sum: Sum<T, D, S, C, G>) {
        let i = dof - self.first;
        for q in 0..S {
            self.scalars[q][i] += sum.scalars[q];
        }
        for q in 0..C {
            self.vectors[q][i] += sum.vectors[q];
        }
        for q in 0..G {
            self.forces[q][i] -= sum.forces[q];
        }
    }
}

/// Sums over the particles, in as many spans as threads may share.
///
/// Compiled for as few types as there are sweeps: mass and momentum of the solid are the same whatever fills
/// its pores, and values are those of linear functions for all bases that have these.
pub(super) fn sum_particles<T, const D: usize, B, N, P, const S: usize, const C: usize, const G: usize>(
    (basis, grid, bins): (&B, &Grid<T, D>, &Bins<D>),
    particles: &Particles<T, D, N, P::Particle>,
    (phase, even, liquid_masses): (&P, UniformLoad<T>, Option<&[T]>),
    spans: &mut Spans<T, D>,
    targets: Targets<'_, T, D, S, C, G>,
) where
    T: Scalar,
    B: BasisFamily<T, D>,
    P: Phase<T, D>,
{
    let sites = particles.sites(bins.cells());
    let amounts = Amounts {
        masses: &particles.mass,
        volumes: &particles.volume,
        velocities: &particles.velocity,
        stresses: &particles.stress,
        data: &particles.phase,
        phase,
        liquid_masses,
        even,
    };
    if const { G > 0 } {
        sum_amounts((basis, grid), sites, amounts, spans, targets);
    } else if const { S <= 1 && C <= 1 } {
        let solid = amounts.of_solid();
        for_values!(B, basis, |basis| sum_amounts(
            (basis, grid),
            sites,
            solid,
            spans,
            targets
        ));
    } else {
        for_values!(B, basis, |basis| sum_amounts(
            (basis, grid),
            sites,
            amounts,
            spans,
            targets
        ));
    }
}

#[inline(never)]
fn sum_amounts<T, const D: usize, B, P, const S: usize, const C: usize, const G: usize>(
    (basis, grid): (&B, &Grid<T, D>),
    sites: Sites<'_, T, D>,
    amounts: Amounts<'_, T, D, P>,
    spans: &mut Spans<T, D>,
    mut targets: Targets<'_, T, D, S, C, G>,
) where
    T: Scalar,
    B: BasisFamily<T, D>,
    P: Phase<T, D>,
{
    let Spans {
        particles: spans,
        lengths,
        store,
        ..
    } = spans;
    let Amounts {
        masses,
        volumes,
        velocities,
        stresses,
        data,
        phase,
        liquid_masses,
        even,
    } = amounts;
    let (span, parallel) = share::<D>(spans, masses.len(), lengths[0]);
    let work = (
        sites,
        (masses, volumes),
        (velocities, stresses),
        (data, Maybe(liquid_masses)),
        store.windows(spans, &mut targets),
    );
    each_span(parallel, span, work, &|_,
                                      (
        sites,
        (masses, volumes),
        (velocities, stresses),
        (data, liquid),
        windows,
    )| {
        let sums = InSpan::new(windows);
        let amounts = Amounts {
            masses,
            volumes,
            velocities,
            stresses,
            data,
            phase,
            liquid_masses: liquid.0,
            even,
        };
        p2g(basis, grid, sites, amounts, sums.into_sink());
    });
    store.add_up(spans, &mut targets);
}
