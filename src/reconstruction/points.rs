//! Where the points of a stream are, and whether the stream can be had in parts: as types, so that a step
//! asks a reconstruction for what it has, and what it says without having it does not compile.

use std::ops::Range;

use super::{Cloud, Point, Reconstruction};
use crate::field::Field;
use crate::mass::{MassModel, ParticleMass};
use crate::scalar::Scalar;
use sealed::Streams;

/// Where the points of the streams of a reconstruction `R` are: [`AtParticles`], [`InCells`] or
/// [`Anywhere`]. Nobody else can implement it.
pub trait PointSet<T: Scalar, const D: usize, R>: Streams<T, D, R> {}

/// Everything is streamed once at each particle, with the volume or the amount that it has, as
/// [`Shepard`](super::Shepard) does: a step then sums over the particles itself and asks for no stream. Goes
/// with [`ParticleMass`].
#[derive(Clone, Copy, Debug)]
pub struct AtParticles;

/// Each cell can be streamed alone, so that threads may share them: goes with [`CellStream`].
#[derive(Clone, Copy, Debug)]
pub struct InCells;

/// The points are anywhere, and a stream is had as a whole.
#[derive(Clone, Copy, Debug)]
pub struct Anywhere;

impl<T, const D: usize, R> PointSet<T, D, R> for AtParticles
where
    T: Scalar,
    R: Reconstruction<T, D, Mass = ParticleMass>,
{
}

impl<T: Scalar, const D: usize, R: CellStream<T, D>> PointSet<T, D, R> for InCells {}

impl<T: Scalar, const D: usize, R> PointSet<T, D, R> for Anywhere {}

impl<T: Scalar, const D: usize, R> Streams<T, D, R> for AtParticles {
    const AT_PARTICLES: bool = true;
}

impl<T: Scalar, const D: usize, R> Streams<T, D, R> for Anywhere {}

impl<T: Scalar, const D: usize, R: CellStream<T, D>> Streams<T, D, R> for InCells {
    const IN_CELLS: bool = true;

    #[inline(always)]
    fn cells<Q: Field<T>>(
        reconstruction: &R,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        reconstruction.integrate_cells(cloud, cells, value, sink);
    }

    #[inline(always)]
    fn conserved_cells<Q: Field<T>>(
        reconstruction: &R,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        reconstruction.integrate_conserved_cells(cloud, cells, amount, sink);
    }
}

/// The streams of single cells, for a reconstruction that says [`InCells`]:
///
/// ```compile_fail,E0277
/// use materialpoint::field::Field;
/// use materialpoint::mass::ParticleMass;
/// use materialpoint::reconstruction::{Cloud, InCells, NoFilter, Point, Reconstruction, Shepard};
///
/// struct Forgetful;
///
/// impl Reconstruction<f64, 1> for Forgetful {
///     type Points = InCells; // but no `CellStream`
///     type Mass = ParticleMass;
///     type Filter = NoFilter;
///
///     fn prepare(&mut self, _cloud: &Cloud<'_, f64, 1>) {}
///
///     fn integrate<Q: Field<f64>>(
///         &mut self,
///         cloud: &Cloud<'_, f64, 1>,
///         value: impl Fn(usize) -> Q,
///         sink: impl FnMut(&Point<f64, 1>, Q),
///     ) {
///         Shepard.integrate(cloud, value, sink);
///     }
/// }
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not stream single cells of scalar `{T}` in `{D}` dimensions",
    note = "`type Points = InCells` goes with an implementation of `CellStream`; `Anywhere` asks for nothing"
)]
pub trait CellStream<T: Scalar, const D: usize>: Reconstruction<T, D> {
    /// What [`Reconstruction::integrate`] streams in the given `cells`, places in the list of occupied ones.
    fn integrate_cells<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    );

    /// What [`Reconstruction::integrate_conserved`] streams there, likewise. Of one's own where densities are
    /// fitted: without it that does not compile.
    fn integrate_conserved_cells<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        amount: impl Fn(usize) -> Q,
        mut sink: impl FnMut(&Point<T, D>, Q),
    ) {
        const {
            assert!(
                Self::Mass::OF_PARTICLES,
                "a fitted mass wants an own `integrate_conserved_cells`"
            )
        };
        for &cell in &cloud.bins.occupied()[cells] {
            for p in cloud.bins.particles_in(cell as usize).iter().map(|&p| p as usize) {
                sink(&Point::of_particle(cloud, p), amount(p));
            }
        }
    }
}

/// Out of reach of other crates.
pub(crate) mod sealed {
    use std::ops::Range;

    use crate::field::Field;
    use crate::reconstruction::{BatchStatus, Cloud, Kept, Point, Values};
    use crate::scalar::Scalar;
    use crate::simd::Packs;
    use crate::taylor::MOST_COMPONENTS;

    /// How a step streams a reconstruction `R`. Each constant goes with the functions below it; what a set of
    /// points does not have is never called.
    pub trait Streams<T: Scalar, const D: usize, R> {
        /// Whether a step sums over the particles in passes of its own.
        const AT_PARTICLES: bool = false;

        /// Whether cells are streamed alone, in parts that threads share.
        const IN_CELLS: bool = false;

        /// Whether four cells are fitted at once, without [`Reconstruction::prepare`] unless
        /// [`Streams::NON_LOCAL`].
        ///
        /// [`Reconstruction::prepare`]: crate::reconstruction::Reconstruction::prepare
        const IN_FOURS: bool = false;

        /// Numbers of each of four cells that [`Streams::fit_batch`] keeps where it does not conserve, and
        /// takes up again where it does.
        const KEPT: usize = 0;

        /// Whether a cell's fit wants what `prepare` and [`Streams::take_in_field`] took in.
        const NON_LOCAL: bool = false;

        /// Streams what `integrate` does in some cells.
        fn cells<Q: Field<T>>(
            _reconstruction: &R,
            _cloud: &Cloud<'_, T, D>,
            _cells: Range<usize>,
            _value: impl Fn(usize) -> Q,
            _sink: impl FnMut(&Point<T, D>, Q),
        ) {
            const { assert!(!Self::IN_CELLS) };
        }

        /// Streams what `integrate_conserved` does in some cells.
        fn conserved_cells<Q: Field<T>>(
            _reconstruction: &R,
            _cloud: &Cloud<'_, T, D>,
            _cells: Range<usize>,
            _amount: impl Fn(usize) -> Q,
            _sink: impl FnMut(&Point<T, D>, Q),
        ) {
            const { assert!(!Self::IN_CELLS) };
        }

        /// Takes in the field that will be streamed next, where a cell's fit wants the values of its
        /// neighbours.
        fn take_in_field<Q: Field<T>>(
            _reconstruction: &mut R,
            _cloud: &Cloud<'_, T, D>,
            _value: &(impl Values<T, Q> + Sync),
        ) {
            const { assert!(!Self::NON_LOCAL) };
        }

        /// Coordinates in a cell, each in `[-1, 1]`, of the points along an axis whose products
        /// [`Streams::integrate_batch`] streams, axis 0 fastest; none if it cannot as it is set up.
        fn line(_reconstruction: &R) -> impl Iterator<Item = T> {
            const { assert!(!Self::IN_FOURS) };
            std::iter::empty()
        }

        /// The same points with their weights, as shares of the line.
        fn weighted_line(_reconstruction: &R) -> impl Iterator<Item = (T, T)> {
            const { assert!(!Self::IN_FOURS) };
            std::iter::empty()
        }

        /// What `integrate_conserved` streams, if `conserve`, or else `integrate`, in up to four `cells`,
        /// places in the list of occupied ones from a multiple of four on: one cell in each lane, the number
        /// of the point and the components of the value. `value` is that of a particle: in the first case its
        /// density. Returns in which cells it failed (those that a surface cuts always), so that they must be
        /// streamed by [`Streams::integrate_single`].
        fn integrate_batch<K: Packs<T>, Q: Field<T>>(
            _reconstruction: &R,
            _k: K,
            _batch: (&Cloud<'_, T, D>, Range<usize>),
            _conserve: bool,
            _kept: Kept<'_, T>,
            _value: &impl Values<T, Q>,
            _sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
        ) -> BatchStatus {
            const { assert!(!Self::IN_FOURS) };
            BatchStatus::default()
        }

        /// What [`Streams::integrate_batch`] streams, before it is evaluated at points: the number of a
        /// function of [`mod@crate::taylor`] and the components of its coefficient, each function once.
        fn fit_batch<K: Packs<T>, Q: Field<T>>(
            _reconstruction: &R,
            _k: K,
            _batch: (&Cloud<'_, T, D>, Range<usize>),
            _conserve: bool,
            _kept: Kept<'_, T>,
            _value: &impl Values<T, Q>,
            _sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
        ) -> BatchStatus {
            const { assert!(!Self::IN_FOURS) };
            BatchStatus::default()
        }

        /// [`Streams::integrate_batch`] in one cell that is given by its number, point by point; returns
        /// whether it was fitted with the full set of functions.
        fn integrate_single<Q: Field<T>>(
            _reconstruction: &R,
            _cloud: &Cloud<'_, T, D>,
            _cell: usize,
            _conserve: bool,
            _value: &dyn Fn(usize) -> Q,
            _sink: &mut dyn FnMut(&Point<T, D>, Q),
        ) -> bool {
            const { assert!(!Self::IN_FOURS) };
            true
        }
    }
}
