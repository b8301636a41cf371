//! Reconstructions: from particle data to quadrature points with weights and values.
//!
//! A reconstruction streams *points with weighted values*; the weak form sums `weighted value * phi_i` or
//! `weighted value * grad phi_i` and never knows where the points came from. Shepard streams the particles
//! themselves, sub-points are spread over each particle's domain, Taylor least squares and the cubic spline
//! stream Gauss points.

mod filter;
mod four_cells;
mod gauss;
mod nodal_taylor;
mod patch;
mod points;
mod relaxed_taylor;
mod shepard;
mod spline;
mod sub_points;
mod taylor;
mod values;

pub(crate) use filter::sealed::Filters;
pub(crate) use filter::{CourantNumbers, Filling};
pub use filter::{Filter, NoFilter, NullSpace};
pub(crate) use four_cells::{BatchStatus, InFours, Kept, batch_of_cells};
pub use nodal_taylor::NodalTaylor;
pub use patch::{Cut, Patch};

pub(crate) use points::sealed::Streams;
pub use points::{Anywhere, AtParticles, CellStream, InCells, PointSet};
pub use relaxed_taylor::{Relaxation, RelaxedTaylor};
pub use shepard::Shepard;
pub use spline::CubicSpline;
pub use sub_points::SubPoints;
pub use taylor::Taylor;
pub(crate) use values::{Densities, Stored, Stresses, Values};

use nalgebra::SVector;

use crate::error::SetupError;
use crate::field::Field;
use crate::grid::{Cell, Grid};
use crate::mass::MassModel;
use crate::particles::Bins;
use crate::scalar::Scalar;

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

/// Turns particle data into quadrature points with weighted values.
///
/// Three types say what a step does with it: where its points are, what momenta are divided by, and what is
/// filtered. What goes with a type and is missing does not compile.
/// [`crate::testing::check_reconstruction`] checks that all methods stream what `integrate` and
/// `integrate_conserved` do. `examples/linear_taylor.rs` is one of a user's own.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not reconstruct scalar `{T}` in `{D}` dimensions",
    note = "CubicSpline is global and exists in 1-D only; Taylor<T, D, NB> takes NB = 3, 6, 10 for D = 1, 2, 3"
)]
pub trait Reconstruction<T: Scalar, const D: usize>: Sized + Send + Sync {
    /// Where its points are, and whether they can be had cell by cell: [`AtParticles`], [`InCells`] with
    /// [`CellStream`], or [`Anywhere`].
    type Points: PointSet<T, D, Self>;

    /// What momenta of DOFs are divided by: [`ParticleMass`](crate::mass::ParticleMass) or
    /// [`ParticleMatrix`](crate::mass::ParticleMatrix), masses of the particles as they are, or a choice of
    /// [`VelocityMass`](crate::mass::VelocityMass) where densities are fitted
    /// ([`Reconstruction::integrate_conserved`]).
    type Mass: MassModel;

    /// What a step takes from stress and velocity of the particles: [`NoFilter`], or the [`NullSpace`] of
    /// [`RelaxedTaylor`].
    type Filter: Filter<T, D, Self>;

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
    ///
    /// A fit of one's own where [`Reconstruction::Mass`] is a [`VelocityMass`](crate::mass::VelocityMass):
    /// without it that does not compile. Where the masses are those of the particles, these are streamed.
    #[inline(always)]
    fn integrate_conserved<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        amount: impl Fn(usize) -> Q,
        mut sink: impl FnMut(&Point<T, D>, Q),
    ) {
        const {
            assert!(
                Self::Mass::OF_PARTICLES,
                "a fitted mass wants an own `integrate_conserved`"
            )
        };
        for p in 0..cloud.positions.len() {
            sink(&Point::of_particle(cloud, p), amount(p));
        }
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

    /// Bytes allocated, for the user's information.
    fn bytes(&self) -> usize {
        0
    }
}

/// What constants of a reconstruction ask of each other; evaluated where a stepper is made.
pub(crate) const fn constants_agree<T: Scalar, const D: usize, R: Reconstruction<T, D>>() {
    assert!(
        D == 1 || !R::Mass::IN_ACCELERATION || R::Filter::FILTERS,
        "beyond one axis a matrix of the particles wants to know which cells they fill"
    );
}
