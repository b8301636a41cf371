//! Reconstructions: from particle data to quadrature points with weights and values.
//!
//! A reconstruction streams *points with weighted values*; the weak form sums `weighted value * phi_i` or
//! `weighted value * grad phi_i` and never knows where the points came from. Shepard streams the particles
//! themselves, sub-points are spread over each particle's domain, Taylor least squares and the cubic spline
//! stream Gauss points.

mod gauss;
mod patch;
mod relaxed_taylor;
mod shepard;
mod spline;
mod sub_points;
mod taylor;
mod values;

pub use patch::{Cut, Patch};
pub use relaxed_taylor::{Relaxation, RelaxedTaylor};
pub use shepard::Shepard;
pub use spline::CubicSpline;
pub use sub_points::SubPoints;
pub use taylor::Taylor;
pub use values::{Densities, Stored, Stresses, Values};

use std::ops::Range;

use nalgebra::SVector;

use crate::error::SetupError;
use crate::field::Field;
use crate::grid::{Cell, Grid};
use crate::particles::Bins;
use crate::scalar::Scalar;
use crate::simd::{LANES, Packs, each};
use crate::taylor::MOST_COMPONENTS;

/// Where the particles are: all that a reconstruction needs to know besides the values.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Cloud<'a, T, const D: usize> {
    /// The grid.
    pub grid: &'a Grid<T, D>,
    /// Cells of the particles.
    pub bins: &'a Bins<D>,
    /// Positions (m).
    pub positions: &'a [SVector<T, D>],
    /// Volumes (1-D: m, 2-D: m2, 3-D: m3).
    pub volumes: &'a [T],
    /// Where bodies end within a cell; none if cells count as full.
    pub cuts: &'a [Cut<T>],
}

impl<'a, T: Scalar, const D: usize> Cloud<'a, T, D> {
    /// Particles at `positions`, with `bins` made for them on `grid`.
    ///
    /// # Errors
    /// If there are not as many volumes, or cells in `bins`, as positions.
    pub fn new(
        grid: &'a Grid<T, D>,
        bins: &'a Bins<D>,
        positions: &'a [SVector<T, D>],
        volumes: &'a [T],
    ) -> Result<Self, SetupError> {
        let expected = positions.len();
        let lengths = [("volumes", volumes.len()), ("bins", bins.len())];
        if let Some((name, found)) = lengths.into_iter().find(|&(_, found)| found != expected) {
            return Err(SetupError::Lengths {
                name,
                found,
                expected,
            });
        }
        Ok(Self {
            grid,
            bins,
            positions,
            volumes,
            cuts: &[],
        })
    }

    /// With the surfaces where bodies end.
    #[must_use]
    pub fn with_cuts(mut self, cuts: &'a [Cut<T>]) -> Self {
        self.cuts = cuts;
        self
    }

    /// What a fit of the cell with number `cell` covers.
    #[inline(always)]
    pub fn patch(&self, cell: usize) -> Patch<T, D> {
        if self.cuts.is_empty() {
            Patch::whole(self.grid, cell)
        } else {
            Patch::cut(self.grid, cell, self.cuts)
        }
    }

    /// Whether a surface cuts a cell.
    #[inline(always)]
    pub(crate) fn is_cut(&self, cell: &Cell<D>) -> bool {
        D == 1 && self.cuts.iter().any(|cut| cut.cell == cell[0])
    }
}

/// The occupied cells at the given places, four at most and one at least; the last one again in the place of
/// others.
#[inline(always)]
pub(crate) fn batch_of_cells<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    places: Range<usize>,
) -> [(usize, Cell<D>); LANES] {
    let occupied = &cloud.bins.occupied()[places];
    if let (1, &[a, b, c, d]) = (D, occupied) {
        // Numbers along the only axis are places on it.
        let first = cloud.grid.window().first()[0];
        return [a, b, c, d].map(|number| (number as usize, [first + number; D]));
    }
    each(
        #[inline(always)]
        |l| {
            let number = occupied[l.min(occupied.len() - 1)] as usize;
            (number, cloud.grid.cell(number))
        },
    )
}

/// What became of four cells that were streamed at once.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, Default)]
pub struct BatchStatus {
    /// Whether a cell could not be.
    pub hard: [bool; LANES],
    /// How many were fitted without the full set of functions.
    pub reduced: usize,
}

/// What is kept of four cells from the first fit of a step to the second.
#[doc(hidden)]
#[derive(Debug)]
pub struct Kept<'a, T> {
    /// As many numbers as [`Reconstruction::KEPT`], or none: nothing can be kept then.
    pub numbers: &'a mut [[T; LANES]],
    /// Whether particles have not moved since they were kept.
    pub fresh: bool,
}

impl<T> Kept<'_, T> {
    /// Nothing.
    pub fn nothing() -> Self {
        Self {
            numbers: &mut [],
            fresh: false,
        }
    }
}

/// A point of the stream.
#[derive(Clone, Copy, Debug)]
pub struct Point<T, const D: usize> {
    /// Cell that holds it.
    pub cell: Cell<D>,
    /// Position (m).
    pub position: SVector<T, D>,
    /// Whether it moves with the particles. There the basis gives gradients made for that
    /// ([`crate::basis::BasisFamily::for_each`]), elsewhere those for points that stand still.
    pub moves: bool,
    /// The particle that it is, if it is one: a basis that asks for domains ([`crate::basis::Domain`]) then
    /// has its domain; any other point has none.
    pub particle: Option<usize>,
}

impl<T: Copy, const D: usize> Point<T, D> {
    /// A particle.
    #[inline(always)]
    pub fn of_particle(cloud: &Cloud<'_, T, D>, p: usize) -> Self {
        Self {
            cell: *cloud.bins.cell_of(p),
            position: cloud.positions[p],
            moves: true,
            particle: Some(p),
        }
    }
}

impl<T, const D: usize> Point<T, D> {
    /// One that stands still.
    #[inline(always)]
    pub fn fixed(cell: Cell<D>, position: SVector<T, D>) -> Self {
        Self {
            cell,
            position,
            moves: false,
            particle: None,
        }
    }
}

/// How far the particles of a cell determine its functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filling {
    /// They fill it, as far as its functions can tell.
    Filled,
    /// They fill a part, or see all functions but squares.
    PartlyFilled,
    /// They do not, but better cells are near.
    Underdetermined,
    /// Neither do those near it.
    Isolated,
}

/// Parts of a cell that are crossed in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CourantNumbers<T> {
    /// By a wave.
    pub wave: T,
    /// By the particles.
    pub motion: T,
}

/// Turns particle data into quadrature points with weighted values.
///
/// Five items must be written. Each constant that says more goes with the methods that its words name: a
/// constant without its method, or constants that contradict each other, are errors at compile time, as soon
/// as a stepper is made of the type. [`crate::testing::check_reconstruction`] checks that all methods stream
/// what `integrate` and `integrate_conserved` do.
///
/// Items that are hidden from the documentation serve the sweeps of the library's own fits; nobody else needs
/// them, and they may change with any version.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not reconstruct scalar `{T}` in `{D}` dimensions",
    note = "CubicSpline is global and exists in 1-D only; Taylor<T, D, NB> takes NB = 3, 6, 10 for D = 1, 2, 3"
)]
pub trait Reconstruction<T: Scalar, const D: usize>: Send + Sync {
    /// Whether [`Reconstruction::integrate`] streams the particles.
    const FIELDS_AT_PARTICLES: bool;

    /// Whether [`Reconstruction::integrate_conserved`] streams the particles. The mass of the DOFs is then
    /// the sum over the particles, lumped unless [`Reconstruction::PARTICLE_MATRIX`].
    const AMOUNTS_AT_PARTICLES: bool;

    /// Whether everything is streamed once at each particle, with the volume or amount that it has: the step
    /// then sums over the particles in passes of its own.
    const PLAIN: bool = false;

    /// Whether both the acceleration and the velocity of the DOFs come from the consistent mass matrix of the
    /// particles, `sum_p m_p phi_i phi_j`. Only with [`Reconstruction::AMOUNTS_AT_PARTICLES`].
    const PARTICLE_MATRIX: bool = false;

    /// Whether each cell can be streamed alone, so that threads may share them
    /// ([`Reconstruction::integrate_cells`]).
    const CELLWISE: bool = false;

    /// Whether [`Reconstruction::relax`] does anything.
    const RELAXES: bool = false;

    /// Whether four cells can be streamed at once without [`Reconstruction::prepare`]
    /// ([`Reconstruction::integrate_batch`]).
    #[doc(hidden)]
    const BATCHED: bool = false;

    /// Numbers of each of four cells that [`Reconstruction::integrate_batch`] keeps where it does not
    /// conserve, and takes up again where it does.
    #[doc(hidden)]
    const KEPT: usize = 0;

    /// Whether [`Reconstruction::fit_batch`] hands over coefficients of Taylor functions.
    #[doc(hidden)]
    const FITS_TAYLOR: bool = false;

    /// Whether [`Reconstruction::integrate_batch`] wants what [`Reconstruction::prepare`] and
    /// [`Reconstruction::fit_field`] took in.
    #[doc(hidden)]
    const NON_LOCAL: bool = false;

    /// Takes in the geometry. Every field streamed until the next call shares it.
    fn prepare(&mut self, cloud: &Cloud<'_, T, D>);

    /// Streams a field given by its `value` at each particle (stress): sums of weighted values approximate
    /// integrals.
    fn integrate<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    );

    /// Streams a density given by the `amount` of it that each particle holds (mass, momentum).
    /// Conservative reconstructions keep the sum of the amounts, in every cell and to round-off.
    fn integrate_conserved<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    );

    /// A liquid flows: its pressure will be reconstructed with the stress.
    #[doc(hidden)]
    fn configure_for_saturated(&mut self) {}

    /// Takes in the field that [`Reconstruction::integrate_cells`] or [`Reconstruction::integrate_batch`]
    /// will stream next, where a cell's fit wants the values of its neighbours.
    #[doc(hidden)]
    fn fit_field<Q: Field<T>>(&mut self, _cloud: &Cloud<'_, T, D>, _value: &(impl Values<T, Q> + Sync)) {
        const { assert!(!Self::NON_LOCAL, "NON_LOCAL wants an own `fit_field`") };
    }

    /// What [`Reconstruction::integrate`] streams in the given `cells`, places in the list of occupied ones.
    /// Only asked where [`Reconstruction::CELLWISE`].
    fn integrate_cells<Q: Field<T>>(
        &self,
        _cloud: &Cloud<'_, T, D>,
        _cells: Range<usize>,
        _value: impl Fn(usize) -> Q,
        _sink: impl FnMut(&Point<T, D>, Q),
    ) {
        const { assert!(!Self::CELLWISE, "CELLWISE wants an own `integrate_cells`") };
    }

    /// What [`Reconstruction::integrate_conserved`] streams in the given `cells`, likewise, where not the
    /// particles are streamed.
    fn integrate_conserved_cells<Q: Field<T>>(
        &self,
        _cloud: &Cloud<'_, T, D>,
        _cells: Range<usize>,
        _amount: impl Fn(usize) -> Q,
        _sink: impl FnMut(&Point<T, D>, Q),
    ) {
        const {
            assert!(
                !Self::CELLWISE || Self::AMOUNTS_AT_PARTICLES,
                "CELLWISE wants an own `integrate_conserved_cells`"
            )
        };
    }

    /// Coordinates in a cell, each in `[-1, 1]`, of the points along an axis whose products
    /// [`Reconstruction::integrate_batch`] streams, axis 0 fastest; none if it cannot as it is set up.
    #[doc(hidden)]
    fn line(&self) -> impl Iterator<Item = T> {
        const { assert!(!Self::BATCHED, "BATCHED wants an own `line`") };
        std::iter::empty()
    }

    /// What [`Reconstruction::integrate_conserved`] streams, if `conserve`, or else
    /// [`Reconstruction::integrate`], in up to four `cells`, places in the list of occupied ones from a
    /// multiple of four on: one cell in each lane, the number of the point and the components of the value.
    /// `value` is that of a particle: in the first case its density. Only asked where
    /// [`Reconstruction::BATCHED`]; returns in which cells it failed (those that a surface cuts always), so
    /// that they must be streamed by [`Reconstruction::integrate_single`].
    #[doc(hidden)]
    fn integrate_batch<K: Packs<T>, Q: Field<T>>(
        &self,
        _k: K,
        _batch: (&Cloud<'_, T, D>, Range<usize>),
        _conserve: bool,
        _kept: Kept<'_, T>,
        _value: &impl Values<T, Q>,
        _sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus {
        const { assert!(!Self::BATCHED, "BATCHED wants an own `integrate_batch`") };
        BatchStatus::default()
    }

    /// What [`Reconstruction::integrate_batch`] streams, before it is evaluated at points: the number of a
    /// function of [`mod@crate::taylor`] and the components of its coefficient, each function once.
    #[doc(hidden)]
    fn fit_batch<K: Packs<T>, Q: Field<T>>(
        &self,
        _k: K,
        _batch: (&Cloud<'_, T, D>, Range<usize>),
        _conserve: bool,
        _kept: Kept<'_, T>,
        _value: &impl Values<T, Q>,
        _sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus {
        const { assert!(!Self::FITS_TAYLOR, "FITS_TAYLOR wants an own `fit_batch`") };
        BatchStatus::default()
    }

    /// The points of [`Reconstruction::line`] with their weights, as shares of the line; likewise.
    #[doc(hidden)]
    fn weighted_line(&self) -> impl Iterator<Item = (T, T)> {
        const { assert!(!Self::FITS_TAYLOR, "FITS_TAYLOR wants an own `weighted_line`") };
        std::iter::empty()
    }

    /// [`Reconstruction::integrate_batch`] in one cell that is given by its number, point by point; returns
    /// whether it was fitted with the full set of functions.
    #[doc(hidden)]
    fn integrate_single<Q: Field<T>>(
        &self,
        _cloud: &Cloud<'_, T, D>,
        _cell: usize,
        _conserve: bool,
        _value: &dyn Fn(usize) -> Q,
        _sink: &mut dyn FnMut(&Point<T, D>, Q),
    ) -> bool {
        const { assert!(!Self::BATCHED, "BATCHED wants an own `integrate_single`") };
        true
    }

    /// Moves the particles' `values` towards what the reconstruction sees of them. `crossed` says for each
    /// occupied cell which part of it a wave and its particles cross in this step: the measures of time for a
    /// relaxation. The stepper calls it for the stress right after the force is assembled; a law with a state
    /// is then strained towards the moved stress.
    fn relax<Q: Field<T>>(
        &mut self,
        _cloud: &Cloud<'_, T, D>,
        _crossed: &[CourantNumbers<T>],
        _values: &mut [Q],
    ) {
        const { assert!(!Self::RELAXES, "RELAXES wants an own `relax`") };
    }

    /// The same by a fit that keeps the sum weighted with `weights` (masses). The stepper calls it for the
    /// velocity, before it is mapped to the DOFs.
    fn relax_weighted<Q: Field<T>>(
        &mut self,
        _cloud: &Cloud<'_, T, D>,
        _weights: &[T],
        _crossed: &[CourantNumbers<T>],
        _values: &mut [Q],
    ) {
        const { assert!(!Self::RELAXES, "RELAXES wants an own `relax_weighted`") };
    }

    /// How far the particles of the occupied cell at `place` in the list of those determine its functions.
    /// Beyond one dimension the stepper ties the functions of cells that are not full to those of the next
    /// ones ([`crate::mass::Penalty`]); those of cells that are alone it lumps. Only asked where
    /// [`Reconstruction::PARTICLE_MATRIX`].
    fn filling(&self, _place: usize) -> Filling {
        const {
            assert!(
                D == 1 || !Self::PARTICLE_MATRIX,
                "PARTICLE_MATRIX wants an own `filling`"
            )
        };
        Filling::Filled
    }

    /// Cells that hold particles but, at the last [`Reconstruction::prepare`], could not be fitted with
    /// the full set of functions.
    fn reduced_cells(&self) -> usize {
        0
    }

    /// Cells that, at the last [`Reconstruction::prepare`], were fitted with virtual points: values that
    /// neighbouring cells lend because the particles do not determine a fit.
    fn virtual_cells(&self) -> usize {
        0
    }

    /// Cells in which the last [`Reconstruction::integrate_conserved`] had to keep a density positive
    /// ([`Field::DENSITIES`]), and drew all that it streamed towards its mean. What belongs to those
    /// densities must be streamed together with them there.
    fn limited_cells(&self) -> usize {
        0
    }

    /// Whether cells may borrow virtual points, where the reconstruction knows any
    /// ([`Taylor::with_virtual_points`]).
    #[doc(hidden)]
    fn lend_virtual_points(&mut self, _lent: bool) {}

    /// Bytes allocated, for the user's information.
    fn bytes(&self) -> usize {
        0
    }
}

/// What constants of a reconstruction ask of each other; evaluated where a stepper is made.
pub(crate) const fn constants_agree<T: Scalar, const D: usize, R: Reconstruction<T, D>>() {
    assert!(
        !R::PLAIN || R::FIELDS_AT_PARTICLES && R::AMOUNTS_AT_PARTICLES,
        "PLAIN wants FIELDS_AT_PARTICLES and AMOUNTS_AT_PARTICLES"
    );
    assert!(
        !R::PARTICLE_MATRIX || R::AMOUNTS_AT_PARTICLES,
        "PARTICLE_MATRIX wants AMOUNTS_AT_PARTICLES"
    );
    // Four at once are prepared by nobody, and are asked for only where cells are streamed alone.
    assert!(!R::BATCHED || R::CELLWISE, "BATCHED wants CELLWISE");
    assert!(!R::NON_LOCAL || R::CELLWISE, "NON_LOCAL wants CELLWISE");
    assert!(!R::FITS_TAYLOR || R::BATCHED, "FITS_TAYLOR wants BATCHED");
}

/// A constant without its method does not compile:
///
/// ```compile_fail,E0080
/// use materialpoint::field::Field;
/// use materialpoint::grid::Grid;
/// use materialpoint::particles::Bins;
/// use materialpoint::reconstruction::{Cloud, Point, Reconstruction, Shepard};
/// use nalgebra::{SVector, vector};
///
/// struct Forgetful;
///
/// impl Reconstruction<f64, 1> for Forgetful {
///     const FIELDS_AT_PARTICLES: bool = true;
///     const AMOUNTS_AT_PARTICLES: bool = true;
///     const CELLWISE: bool = true; // but no `integrate_cells`
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
///
///     fn integrate_conserved<Q: Field<f64>>(
///         &mut self,
///         cloud: &Cloud<'_, f64, 1>,
///         amount: impl Fn(usize) -> Q,
///         sink: impl FnMut(&Point<f64, 1>, Q),
///     ) {
///         Shepard.integrate_conserved(cloud, amount, sink);
///     }
/// }
///
/// let grid = Grid::new(vector![0.0], vector![1.0], [1]).unwrap();
/// let positions = [vector![0.5]];
/// let bins = Bins::new(&grid, &positions).unwrap();
/// let cloud = Cloud::new(&grid, &bins, &positions, &[1.0]).unwrap();
/// Forgetful.integrate_cells(&cloud, 0..1, |_| 1.0, |_, _| ());
/// ```
#[cfg(doctest)]
struct Forgotten;
