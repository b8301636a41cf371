//! Random layouts of particles.
//!
//! A layout lists, cell by cell, the particles' places within the cell. A place is a fraction of the cell, a
//! point very near one, or anywhere; a cell's list may be empty, spread, repeat one place, or crowd around
//! one. Each choice stands before the more exotic ones, because proptest shrinks towards the first.

use materialpoint::grid::Grid;
use materialpoint::particles::Bins;
use materialpoint::reconstruction::Cloud;
use materialpoint::scalar::Scalar;
use nalgebra::SVector;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

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
    pub cells: [usize; D],
    pub min: f64,
    pub h: f64,
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

/// A layout in the numbers of one scalar.
#[derive(Clone, Debug)]
pub struct Body<T: Scalar, const D: usize> {
    pub grid: Grid<T, D>,
    pub positions: Vec<SVector<T, D>>,
    pub volumes: Vec<T>,
    pub bins: Bins<D>,
}

impl<const D: usize> Layout<D> {
    pub fn count(&self) -> usize {
        self.particles.iter().map(Vec::len).sum()
    }

    /// The particles, with volumes that differ by up to a factor of two and nearly fill their cell.
    pub fn body<T: Scalar>(&self) -> Body<T, D> {
        let extent = |a: usize| T::lit(self.h) * T::count(self.cells[a]);
        let min = SVector::repeat(T::lit(self.min));
        let grid = Grid::new(min, SVector::from_fn(|a, _| min[a] + extent(a)), self.cells).unwrap();
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
        let bins = Bins::new(&grid, &positions).unwrap();
        Body {
            grid,
            positions,
            volumes,
            bins,
        }
    }
}

impl<T: Scalar, const D: usize> Body<T, D> {
    pub fn cloud(&self) -> Cloud<'_, T, D> {
        Cloud::new(&self.grid, &self.bins, &self.positions, &self.volumes).unwrap()
    }
}

/// A value between -1 and 1 for each particle, without pattern.
pub fn uneven<T: Scalar>(p: usize) -> T {
    T::lit(((p * p * 7 + p * 3 + 5) % 31) as f64) / T::lit(15.0) - T::one()
}
