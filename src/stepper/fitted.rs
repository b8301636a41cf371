//! P2G from fits: forces, and masses and momenta of the DOFs, from polynomials fitted in each cell.
//!
//! Cells are fitted and integrated four at a time where reconstruction and basis can ([`transfer::fit`]),
//! else streamed point by point: cell by cell where threads may share them, in one go otherwise.

use nalgebra::SMatrix;

use super::dofs::Dofs;
use super::liquid::UniformLoad;
use super::matrix::MassMatrix;
use super::spans::{Spans, share};
use super::sums::{InSpan, Targets};
use crate::basis::BasisFamily;
use crate::field::{Field, MassMomentum, Pair, Symmetric};
use crate::mass::banded_row;
use crate::parallel::{Groups, PerSpan, Windows, add_up, each_span};
use crate::particles::{DomainViews, Domains, Particles};
use crate::phase::Phase;
use crate::reconstruction::{Cloud, Densities, Point, Reconstruction, Streams, Values};
use crate::scalar::Scalar;
use crate::simd::LANES;
use crate::transfer::{
    self, Fits, Here, Integrand, Look, MassesAndMomenta, Parts, Seer, Stencil, Stress, Sum, Sweep,
    at_fixed_points, for_values, look_up,
};

/// What is fitted, and in which functions it ends up.
pub(super) struct Fitted<'a, 'c, T: Scalar, const D: usize, B, R> {
    pub(super) basis: &'a B,
    pub(super) reconstruction: &'a mut R,
    pub(super) cloud: Cloud<'c, T, D>,
    /// Of the particles, where the basis asks for them.
    pub(super) domains: DomainViews<'c, T, D>,
    pub(super) spans: &'a mut Spans<T, D>,
    /// Whether four cells are fitted at a time.
    pub(super) batched: bool,
}

impl<'a, 'c, T: Scalar, const D: usize, B, R> Fitted<'a, 'c, T, D, B, R> {
    /// The same in the functions of another basis of the same DOFs.
    fn in_functions_of<M>(self, basis: &'a M) -> Fitted<'a, 'c, T, D, M, R> {
        Fitted {
            basis,
            reconstruction: self.reconstruction,
            cloud: self.cloud,
            domains: self.domains,
            spans: self.spans,
            batched: self.batched,
        }
    }
}

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>, R: Reconstruction<T, D>> Fitted<'_, '_, T, D, B, R> {
    /// `f_i = -integral(sigma grad phi_i)` of the stress, or of total stress and pressure, given at each
    /// particle.
    pub(super) fn forces<const G: usize>(
        self,
        stress: impl Values<T, <Stress as Integrand<T, D, 0, 0, G, 0>>::Field> + Copy + Sync,
        targets: Targets<'_, T, D, 0, 0, G>,
    ) where
        Stress: Integrand<T, D, 0, 0, G, 0>,
    {
        R::Points::take_in_field(self.reconstruction, &self.cloud, &stress);
        self.integrate::<Stress, 0, 0, G>(&stress, targets);
    }

    /// Masses and momenta of one phase or two, to row sums; `S` of the masses, zero where they are known
    /// already.
    pub(super) fn lumped<Q: Field<T>, const S: usize, const C: usize>(
        self,
        densities: impl Values<T, Q> + Copy + Sync,
        targets: Targets<'_, T, D, S, C, 0>,
    ) where
        MassesAndMomenta<Q>: Integrand<T, D, S, C, 0, 0, Field = Q>,
    {
        for_values!(B, self.basis, |basis| {
            let fitted = self.in_functions_of(basis);
            fitted.integrate::<MassesAndMomenta<Q>, S, C, 0>(&densities, targets);
        });
    }

    fn integrate<I, const S: usize, const C: usize, const G: usize>(
        self,
        value: &(impl Values<T, I::Field> + Copy + Sync),
        mut targets: Targets<'_, T, D, S, C, G>,
    ) where
        I: Integrand<T, D, S, C, G, 0>,
    {
        let (basis, cloud, domains) = (self.basis, &self.cloud, self.domains);
        let amount = amounts(value, I::CONSERVED, cloud.volumes);
        if const { !R::Points::IN_CELLS } {
            let sums = InSpan::whole(targets);
            let sink = stream::<I, _, D, _, S, C, G>(basis, cloud, domains, Here, sums);
            if const { I::CONSERVED } {
                self.reconstruction.integrate_conserved(cloud, amount, sink);
            } else {
                self.reconstruction.integrate(cloud, amount, sink);
            }
            return;
        }
        let reconstruction = &*self.reconstruction;
        let occupied = cloud.bins.occupied();
        let Spans {
            cells: spans,
            lengths,
            store,
            reduced,
            kept,
            fresh,
            ..
        } = self.spans;
        let (span, parallel) = share::<D>(spans, occupied.len(), lengths[1]);
        reduced.fill(0);
        let is_fresh = *fresh;
        *fresh |= self.batched && !I::CONSERVED;
        let work = (
            occupied,
            store.windows(spans, &mut targets),
            PerSpan(&mut reduced[..]),
            room::<T, D, R>(kept, occupied.len(), self.batched),
        );
        let batched = self.batched;
        each_span(parallel, span, work, &|place, (cells, windows, reduced, kept)| {
            let sums = InSpan::new(windows);
            let cells = place..place + cells.len();
            if const { transfer::fit::<T, D, B, R>() } && batched {
                let fits = Fits {
                    moving: &|point, stencil, skip| {
                        at_moving_point((basis, cloud, domains), point, stencil, skip)
                    },
                    reconstruction,
                    cloud,
                    cells,
                    fresh: is_fresh,
                };
                let mut sink = sums.into_sink();
                let found = at_fixed_points!(B, basis, |basis| Sweep::new(basis, cloud.grid)
                    .integrate::<_, I, S, C, G, 0>(
                        &fits,
                        kept.values,
                        value,
                        &mut sink,
                        &mut no_matrix::<T>()
                    ));
                return reduced.set(found);
            }
            let sink = stream::<I, _, D, _, S, C, G>(basis, cloud, domains, Stencil::new(), sums);
            if const { I::CONSERVED } {
                R::Points::conserved_cells(reconstruction, cloud, cells, amount, sink);
            } else {
                R::Points::cells(reconstruction, cloud, cells, amount, sink);
            }
        });
        store.add_up(spans, &mut targets);
    }

    /// Momenta and mass matrices of one phase or two.
    pub(super) fn matrices<Q: Field<T>, const C: usize>(
        self,
        densities: impl Values<T, Q> + Copy + Sync,
        dofs: [&mut Dofs<T, D>; C],
    ) where
        MassesAndMomenta<Q>: Integrand<T, D, 0, C, 0, C, Field = Q>,
    {
        // Of the matrix, which is as wide as the gradients reach.
        let half_band = self.basis.half_band(self.cloud.grid);
        for_values!(B, self.basis, |basis| {
            let fitted = self.in_functions_of(basis);
            if const { D == 1 } {
                fitted.bands(half_band, &densities, dofs);
            } else {
                fitted.lattices(&densities, dofs);
            }
        });
    }

    /// The same along one axis.
    fn bands<Q: Field<T>, const C: usize>(
        self,
        half_band: usize,
        densities: &(impl Values<T, Q> + Copy + Sync),
        dofs: [&mut Dofs<T, D>; C],
    ) where
        MassesAndMomenta<Q>: Integrand<T, D, 0, C, 0, C, Field = Q>,
    {
        let (basis, cloud, domains) = (self.basis, &self.cloud, self.domains);
        let width = half_band + 1;
        let amount = amounts(densities, true, cloud.volumes);
        let mut momenta = [const { None }; C];
        let mut bands = [const { None }; C];
        for (q, dofs) in dofs.into_iter().enumerate() {
            let Dofs { matrix, velocity, .. } = dofs;
            (bands[q], momenta[q]) = (Some(matrix.band_mut().rows_mut()), Some(&mut velocity[..]));
        }
        let mut rows: [&mut [T]; C] = bands.map(Option::unwrap_or_default);
        let targets = Targets {
            scalars: [],
            vectors: momenta.map(Option::unwrap_or_default),
            forces: [],
        };
        let mut targets: Targets<'_, T, D, 0, C, 0> = targets;
        if const { !R::Points::IN_CELLS } {
            rows.iter_mut().for_each(|rows| rows.fill(T::zero()));
            let sink = stream_pairs::<MassesAndMomenta<Q>, _, D, _, C>(
                basis,
                cloud,
                Here,
                InSpan::whole(targets).into_sink(),
                into_rows(rows, 0, half_band),
            );
            return self.reconstruction.integrate_conserved(cloud, amount, sink);
        }
        let reconstruction = &*self.reconstruction;
        let occupied = cloud.bins.occupied();
        let Spans {
            cells: spans,
            lengths,
            store,
            kept,
            fresh,
            ..
        } = self.spans;
        let is_fresh = *fresh;
        let (span, parallel) = share::<D>(spans, occupied.len(), lengths[1]);
        let super::spans::Store {
            vectors, matrices, ..
        } = store;
        let mut stores = matrices.iter_mut();
        let of_rows: [Windows<'_, T>; C] = rows.each_mut().map(|rows| match stores.next() {
            Some(store) => Windows::new(spans, store, rows, width),
            None => Windows::default(),
        });
        let of_momenta = super::sums::windows(spans, vectors, targets.vectors.each_mut().map(|t| &mut **t));
        let batched = self.batched;
        let kept = room::<T, D, R>(kept, occupied.len(), batched);
        let work = (occupied, of_rows, of_momenta, kept);
        each_span(parallel, span, work, &|place, (cells, rows, momenta, kept)| {
            let mut first = 0;
            let rows: [&mut [T]; C] = rows.map(|window| {
                let (start, rows) = window.one();
                first = start;
                rows
            });
            let sums = InSpan::new(([], momenta, []));
            let cells = place..place + cells.len();
            let mut sink = sums.into_sink();
            let mut matrix = into_rows(rows, first, half_band);
            if const { transfer::fit::<T, D, B, R>() } && batched {
                let fits = Fits {
                    moving: &|point, stencil, skip| {
                        at_moving_point((basis, cloud, domains), point, stencil, skip)
                    },
                    reconstruction,
                    cloud,
                    cells,
                    fresh: is_fresh,
                };
                Sweep::new(basis, cloud.grid).integrate::<_, MassesAndMomenta<Q>, 0, C, 0, C>(
                    &fits,
                    kept.values,
                    densities,
                    &mut sink,
                    &mut matrix,
                );
                return;
            }
            let sink =
                stream_pairs::<MassesAndMomenta<Q>, _, D, _, C>(basis, cloud, Stencil::new(), sink, matrix);
            R::Points::conserved_cells(reconstruction, cloud, cells, amount, sink);
        });
        for (store, rows) in matrices.iter().zip(&mut rows) {
            add_up(spans, store, rows, width);
        }
        for (store, momenta) in vectors.iter().zip(&mut targets.vectors) {
            add_up(spans, store, momenta, 1);
        }
    }

    /// The same beyond one axis.
    fn lattices<Q: Field<T>, const C: usize>(
        self,
        densities: &(impl Values<T, Q> + Copy + Sync),
        dofs: [&mut Dofs<T, D>; C],
    ) where
        MassesAndMomenta<Q>: Integrand<T, D, 0, C, 0, C, Field = Q>,
    {
        let (basis, cloud, domains) = (self.basis, &self.cloud, self.domains);
        let mut momenta = [const { None }; C];
        let mut matrices = [const { None }; C];
        for (q, dofs) in dofs.into_iter().enumerate() {
            let Dofs { matrix, velocity, .. } = dofs;
            matrix.clear();
            (matrices[q], momenta[q]) = (Some(matrix), Some(&mut velocity[..]));
        }
        let matrices: [Option<&mut MassMatrix<T, D>>; C] = matrices;
        let targets: Targets<'_, T, D, 0, C, 0> = Targets {
            scalars: [],
            vectors: momenta.map(Option::unwrap_or_default),
            forces: [],
        };
        let mut sink = InSpan::whole(targets).into_sink();
        let mut matrix = into_matrices(matrices);
        if const { transfer::fit::<T, D, B, R>() } && self.batched {
            let fits = Fits {
                moving: &|point, stencil, skip| {
                    at_moving_point((basis, cloud, domains), point, stencil, skip)
                },
                reconstruction: &*self.reconstruction,
                cloud,
                cells: 0..cloud.bins.occupied().len(),
                fresh: self.spans.fresh,
            };
            let kept = room::<T, D, R>(&mut self.spans.kept, cloud.bins.occupied().len(), true);
            Sweep::new(basis, cloud.grid).integrate::<_, MassesAndMomenta<Q>, 0, C, 0, C>(
                &fits,
                kept.values,
                densities,
                &mut sink,
                &mut matrix,
            );
            return;
        }
        let amount = amounts(densities, true, cloud.volumes);
        let sink =
            stream_pairs::<MassesAndMomenta<Q>, _, D, _, C>(basis, cloud, Stencil::new(), sink, matrix);
        self.reconstruction.integrate_conserved(cloud, amount, sink);
    }
}

/// Room for what is kept of so many cells.
fn room<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    kept: &mut Vec<[T; LANES]>,
    cells: usize,
    batched: bool,
) -> Groups<'_, [T; LANES]> {
    let groups = if batched { cells.div_ceil(LANES) } else { 0 };
    // What was kept stays where the cells are the same.
    kept.resize(groups * R::Points::KEPT, [T::zero(); LANES]);
    Groups {
        values: kept,
        sizes: [LANES, R::Points::KEPT],
    }
}

/// Values of the particles, or the amounts that particles of these volumes hold of a density. A function of
/// what it uses, as [`InSpan::into_sink`].
#[inline(always)]
fn amounts<'a, T: Scalar, Q: Field<T>>(
    value: &'a (impl Values<T, Q> + Copy + Sync),
    conserved: bool,
    volumes: &'a [T],
) -> impl Fn(usize) -> Q + Copy + Sync + 'a {
    #[inline(always)]
    move |p| {
        let value = value.at(p);
        if conserved {
            value.scaled(volumes[p])
        } else {
            value
        }
    }
}

/// Where masses go that are for no matrix.
fn no_matrix<T>() -> impl FnMut(usize, usize, usize, T) {
    |_, _, _, _| ()
}

/// Adds `(q, i, j, mass)` to the rows of banded matrices, which begin with the row of DOF `first`. A function
/// of what it uses, as [`InSpan::into_sink`].
fn into_rows<T: Scalar, const C: usize>(
    rows: [&mut [T]; C],
    first: usize,
    half_band: usize,
) -> impl FnMut(usize, usize, usize, T) {
    #[inline(always)]
    move |q, i, j, mass| {
        let (i, j) = (i - first, j - first);
        banded_row(rows[q], i, half_band)[half_band + j - i] += mass;
    }
}

/// The same to matrices of any kind.
fn into_matrices<T: Scalar, const D: usize, const C: usize>(
    mut matrices: [Option<&mut MassMatrix<T, D>>; C],
) -> impl FnMut(usize, usize, usize, T) {
    #[inline(always)]
    move |q, i, j, mass| {
        if let Some(matrix) = &mut matrices[q] {
            matrix.add(i, j, mass);
        }
    }
}

/// Looks up the functions at a point that moves.
#[inline(always)]
fn at_moving_point<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    (basis, cloud, domains): (&B, &Cloud<'_, T, D>, DomainViews<'_, T, D>),
    point: &Point<T, D>,
    stencil: &mut Stencil<T, D>,
    skip: usize,
) -> usize {
    let place = (&point.cell, &point.position);
    look_up(
        stencil,
        (basis, cloud.grid),
        &domains,
        seer_of(point),
        place,
        skip,
    )
}

/// Who looks up functions at a point.
#[inline(always)]
fn seer_of<T, const D: usize>(point: &Point<T, D>) -> Seer {
    match (point.moves, point.particle) {
        (true, Some(p)) => Seer::Particle(p),
        (true, None) => Seer::Moving,
        (false, _) => Seer::Fixed,
    }
}

/// What a point of a stream adds to DOFs.
#[inline(always)]
fn stream<'a, I, T, const D: usize, B, const S: usize, const C: usize, const G: usize>(
    basis: &'a B,
    cloud: &'a Cloud<'_, T, D>,
    domains: DomainViews<'a, T, D>,
    mut look: impl Look<T, D> + 'a,
    mut sums: InSpan<'a, T, D, S, C, G>,
) -> impl FnMut(&Point<T, D>, I::Field) + 'a
where
    T: Scalar,
    B: BasisFamily<T, D>,
    I: Integrand<T, D, S, C, G, 0>,
{
    move |point, value| {
        let parts = I::parts(&transfer::components_of::<T, I::Field>(&value), &[T::one(); D]);
        let (here, place) = ((basis, cloud.grid), (&point.cell, &point.position));
        look.for_each(here, &domains, seer_of(point), place, |dof, phi, gradient| {
            sums.add(dof, Sum::of(&parts, phi, &gradient));
        });
    }
}

/// The same with masses that go to matrices: `matrix(q, i, j, mass)`, `j <= i`.
#[inline(always)]
fn stream_pairs<'a, I, T, const D: usize, B, const C: usize>(
    basis: &'a B,
    cloud: &'a Cloud<'_, T, D>,
    mut look: impl Look<T, D> + 'a,
    mut sink: impl FnMut(usize, Sum<T, D, 0, C, 0>) + 'a,
    mut matrix: impl FnMut(usize, usize, usize, T) + 'a,
) -> impl FnMut(&Point<T, D>, I::Field) + 'a
where
    T: Scalar,
    B: BasisFamily<T, D>,
    I: Integrand<T, D, 0, C, 0, C>,
{
    move |point, value| {
        let value = transfer::components_of::<T, I::Field>(&value);
        let parts: Parts<T, D, 0, C, 0> = I::parts(&value, &[T::one(); D]);
        let masses: [T; C] = I::masses(&value);
        let (here, place) = ((basis, cloud.grid), (&point.cell, &point.position));
        let none = Domains::none();
        look.for_each(here, &none.views(), Seer::Fixed, place, |i, phi, gradient| {
            sink(i, Sum::of(&parts, phi, &gradient));
        });
        look.for_each_pair(here, Seer::Fixed, place, |[i, j], [phi, other]| {
            for q in 0..C {
                matrix(q, i, j, masses[q] * phi * other);
            }
        });
    }
}

/// Densities of mass and momentum of one phase.
pub(super) fn densities<'a, T: Scalar, const D: usize, N, P>(
    particles: &'a Particles<T, D, N, P>,
) -> Densities<'a, T, D> {
    Densities {
        masses: &particles.mass,
        velocities: &particles.velocity,
        volumes: &particles.volume,
    }
}

/// Densities of mass and momentum of solid and liquid.
pub(super) struct DensitiesOfBoth<'a, T: Scalar, const D: usize, P: Phase<T, D>> {
    pub(super) solid: Densities<'a, T, D>,
    pub(super) data: &'a [P::Particle],
    pub(super) phase: &'a P,
}

impl<T: Scalar, const D: usize, P: Phase<T, D>> Clone for DensitiesOfBoth<'_, T, D, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Scalar, const D: usize, P: Phase<T, D>> Copy for DensitiesOfBoth<'_, T, D, P> {}

/// Of solid and liquid.
type Both<T, const D: usize> = Pair<MassMomentum<T, D>, MassMomentum<T, D>>;

impl<T: Scalar, const D: usize, P: Phase<T, D>> Values<T, Both<T, D>> for DensitiesOfBoth<'_, T, D, P> {
    #[inline(always)]
    fn at(&self, p: usize) -> Both<T, D> {
        let volume = self.solid.volumes[p];
        let mass = self.phase.liquid_mass(volume) / volume;
        let liquid = MassMomentum {
            mass,
            momentum: self.phase.liquid(&self.data[p]).velocity * mass,
        };
        Pair(self.solid.at(p), liquid)
    }
}

/// Total stress and pressure of the particles, each less an even load.
pub(super) struct StressesAndPressures<'a, T: Scalar, const D: usize, P: Phase<T, D>> {
    pub(super) even: UniformLoad<T>,
    pub(super) phase: &'a P,
    pub(super) effective: &'a [SMatrix<T, D, D>],
    pub(super) data: &'a [P::Particle],
}

impl<T: Scalar, const D: usize, P: Phase<T, D>> Clone for StressesAndPressures<'_, T, D, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Scalar, const D: usize, P: Phase<T, D>> Copy for StressesAndPressures<'_, T, D, P> {}

impl<T: Scalar, const D: usize, P: Phase<T, D>> Values<T, Pair<Symmetric<T, D>, T>>
    for StressesAndPressures<'_, T, D, P>
{
    #[inline(always)]
    fn at(&self, p: usize) -> Pair<Symmetric<T, D>, T> {
        self.even.rest(self.phase, &self.effective[p], &self.data[p])
    }
}
