//! Random layouts of particles and random increments for property tests with `proptest`
//! (feature `testing`).
//!
//! A layout lists, cell by cell, the particles' places within the cell. A place is a fraction of the cell, a
//! point very near one, or anywhere; a cell's list may be empty, spread, repeat one place, or crowd around
//! one. Each choice stands before the more exotic ones, because proptest shrinks towards the first.
//!
//! ```
//! use materialpoint::basis::BSpline;
//! use materialpoint::testing::{self, layout::layouts};
//! use proptest::prelude::*;
//!
//! proptest!(|(layout in layouts::<2>(3, 4))| {
//!     let body = layout.body::<f64>()?;
//!     let claims = testing::BasisClaims::of_degree(2);
//!     prop_assume!(!body.positions.is_empty());
//!     testing::check_basis(&BSpline::<2>, &body.grid, &body.positions, &claims)?;
//! });
//! ```

use nalgebra::{SMatrix, SVector};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use thiserror::Error;

use crate::error::GridError;
use crate::grid::Grid;
use crate::particles::{Bins, Outside};
use crate::reconstruction::Cloud;
use crate::scalar::Scalar;

/// Place along one axis, in cell sizes from the cell's lower edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Numerator and denominator. 0 and 1 are the edges.
    Fraction(u8, u8),
    /// A fraction, and this power of ten beside it.
    Near(u8, u8, i32),
    /// Any place.
    Anywhere(f64),
}

impl Place {
    /// The place, from 0 to 1.
    pub fn unit(self) -> f64 {
        match self {
            Self::Fraction(n, d) => f64::from(n) / f64::from(d),
            Self::Near(n, d, exponent) => {
                let beside = 10.0_f64.powi(exponent);
                let unit = f64::from(n) / f64::from(d);
                if unit < 1.0 { unit + beside } else { unit - beside }
            }
            Self::Anywhere(unit) => unit,
        }
    }
}

const FRACTIONS: [(u8, u8); 9] = [
    (1, 2),
    (0, 1),
    (1, 4),
    (3, 4),
    (1, 3),
    (2, 3),
    (1, 8),
    (7, 8),
    (1, 1),
];

/// A place along an axis; shrinks towards the middle of the cell.
pub fn place() -> impl Strategy<Value = Place> + Clone {
    let fraction = || select(&FRACTIONS[..]);
    prop_oneof![
        4 => fraction().prop_map(|(n, d)| Place::Fraction(n, d)),
        2 => (fraction(), 1..16_i32).prop_map(|((n, d), e)| Place::Near(n, d, -e)),
        4 => (0.0..1.0_f64).prop_map(Place::Anywhere),
    ]
}

/// Places of one particle, axis by axis.
pub type Spot<const D: usize> = [Place; D];

fn spot<const D: usize>() -> impl Strategy<Value = Spot<D>> + Clone {
    vec(place(), D).prop_map(|places| std::array::from_fn(|a| places[a]))
}

/// A regular lattice of `n` particles per axis, each moved by up to `jitter` of the spacing.
fn regular<const D: usize>(n: usize, jitter: &[f64]) -> Vec<Spot<D>> {
    (0..n.pow(D as u32))
        .map(|index| {
            std::array::from_fn(|a| {
                let k = index / n.pow(a as u32) % n;
                let moved = jitter[(index * D + a) % jitter.len()];
                Place::Anywhere((k as f64 + 0.5 + moved / 2.0) / n as f64)
            })
        })
        .collect()
}

/// The particles of one cell, `most` at most where they are listed singly.
pub fn cell<const D: usize>(most: usize) -> impl Strategy<Value = Vec<Spot<D>>> {
    let per_axis = 1..=4_usize.div_ceil(D);
    prop_oneof![
        6 => vec(spot::<D>(), 0..=most),
        1 => (spot::<D>(), 1..=most).prop_map(|(spot, n)| vec![spot; n]),
        1 => per_axis.clone().prop_map(|n| regular(n, &[0.0])),
        1 => (per_axis, vec(-0.9..0.9_f64, 1..30)).prop_map(|(n, jitter)| regular(n, &jitter)),
    ]
}

/// Particles of every cell of a grid that starts at `min`, with cells of size `h`.
#[derive(Clone, Debug)]
pub struct Layout<const D: usize> {
    /// Cells along each axis.
    pub cells: [usize; D],
    /// Lower end of the grid (m) along every axis.
    pub min: f64,
    /// Size of the cells (m).
    pub h: f64,
    /// Cell by cell, axis 0 fastest.
    pub particles: Vec<Vec<Spot<D>>>,
}

/// Layouts on grids of at most `side` cells along an axis, with 0 to `most` particles a cell.
pub fn layouts<const D: usize>(side: usize, most: usize) -> impl Strategy<Value = Layout<D>> {
    let grid = (
        vec(1..=side, D),
        select(&[0.0, -1.0, 0.3, 100.0][..]),
        select(&[1.0, 0.1, 7.3][..]),
    );
    grid.prop_flat_map(move |(cells, min, h)| {
        let cells: [usize; D] = std::array::from_fn(|a| cells[a]);
        vec(cell(most), cells.iter().product::<usize>()).prop_map(move |particles| Layout {
            cells,
            min,
            h,
            particles,
        })
    })
}

/// A layout that cannot be made.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum LayoutError {
    /// Its numbers are no grid.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// A particle is outside its cell.
    #[error("particle {0} is outside its cell")]
    Outside(usize),
}

/// A layout in the numbers of one scalar.
#[derive(Clone, Debug)]
pub struct Body<T: Scalar, const D: usize> {
    /// The grid.
    pub grid: Grid<T, D>,
    /// Positions (m).
    pub positions: Vec<SVector<T, D>>,
    /// Volumes (1-D: m, 2-D: m2, 3-D: m3).
    pub volumes: Vec<T>,
    /// Cells of the particles.
    pub bins: Bins<D>,
}

impl<const D: usize> Layout<D> {
    /// Number of particles.
    pub fn count(&self) -> usize {
        self.particles.iter().map(Vec::len).sum()
    }

    /// The particles, with volumes that differ by up to a factor of two and nearly fill their cell.
    ///
    /// # Errors
    /// If the numbers of a layout that [`layouts`] did not make are no grid, or a place is outside its cell.
    pub fn body<T: Scalar>(&self) -> Result<Body<T, D>, LayoutError> {
        let extent = |a: usize| T::lit(self.h) * T::count(self.cells[a]);
        let min = SVector::repeat(T::lit(self.min));
        let grid = Grid::new(min, SVector::from_fn(|a, _| min[a] + extent(a)), self.cells)?;
        let (mut positions, mut volumes) = (Vec::new(), Vec::new());
        for (number, spots) in self.particles.iter().enumerate() {
            let cell = grid.cell(number);
            for spot in spots {
                let share = T::lit(0.75) + T::count(positions.len() % 4) / T::lit(4.0);
                volumes.push(grid.cell_volume() * share / T::count(spots.len()));
                positions.push(SVector::from_fn(|a, _| {
                    let (low, high) = (grid.edge(a, cell[a] as usize), grid.edge(a, cell[a] as usize + 1));
                    // Both edges exactly, and never beyond them.
                    match spot[a].unit() {
                        unit if unit >= 1.0 => high,
                        unit => (low + (high - low) * T::lit(unit)).min(high),
                    }
                }));
            }
        }
        let bins =
            Bins::new(&grid, &positions).map_err(|Outside(particle)| LayoutError::Outside(particle))?;
        Ok(Body {
            grid,
            positions,
            volumes,
            bins,
        })
    }
}

impl<T: Scalar, const D: usize> Body<T, D> {
    /// The particles as a reconstruction sees them.
    pub fn cloud(&self) -> Cloud<'_, T, D> {
        // Not by its constructor, which compares lengths: those of a body are the same.
        Cloud {
            grid: &self.grid,
            bins: &self.bins,
            positions: &self.positions,
            volumes: &self.volumes,
            cuts: &[],
        }
    }
}

/// Displacement gradients `dt grad v` of a step with components of at most `size`: none, along one axis, a
/// rotation, or any. They shrink towards none.
pub fn increments<const D: usize>(size: f64) -> impl Strategy<Value = SMatrix<f64, D, D>> {
    let component = move || -size..=size;
    let single = (0..D, 0..D, component()).prop_map(|(row, column, value)| {
        let mut increment = SMatrix::zeros();
        increment[(row, column)] = value;
        increment
    });
    let any = vec(component(), D * D).prop_map(|values| SMatrix::from_fn(|i, j| values[i * D + j]));
    let turn = vec(component(), D * D).prop_map(|values| {
        let half = SMatrix::<f64, D, D>::from_fn(|i, j| values[i * D + j]) / 2.0;
        half - half.transpose()
    });
    prop_oneof![
        1 => Just(SMatrix::zeros()),
        2 => single,
        1 => turn,
        4 => any,
    ]
}
