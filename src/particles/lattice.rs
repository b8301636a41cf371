//! Filling a box with particles.

use nalgebra::SVector;

use crate::grid::Grid;
use crate::scalar::Scalar;

/// Particles at the midpoints of equal sub-boxes of the body `[min, max]`, with the sub-boxes' volumes:
/// as near to `per_cell` of them per cell and axis as whole numbers allow (exactly that many in a body whose
/// ends are cell edges). Axis 0 runs fastest.
pub fn lattice<T: Scalar, const D: usize>(
    grid: &Grid<T, D>,
    min: &SVector<T, D>,
    max: &SVector<T, D>,
    per_cell: [usize; D],
) -> Vec<(SVector<T, D>, T)> {
    let lattice = Lattice::new(grid, min, max, per_cell);
    let volume = lattice.volume();
    (0..lattice.len())
        .map(|k| (lattice.position(k), volume))
        .collect()
}

/// The lattice of [`lattice`], particle by particle.
#[derive(Clone, Copy, Debug)]
pub struct Lattice<T, const D: usize> {
    min: SVector<T, D>,
    extent: SVector<T, D>,
    counts: [usize; D],
}

impl<T: Scalar, const D: usize> Lattice<T, D> {
    /// Of the box from `min` to `max` (m), with so many particles a cell along each axis.
    pub fn new(grid: &Grid<T, D>, min: &SVector<T, D>, max: &SVector<T, D>, per_cell: [usize; D]) -> Self {
        let extent = max - min;
        let counts = std::array::from_fn(|a| {
            let wanted = (extent[a] / grid.cell_size()[a]).primal() * per_cell[a] as f64;
            wanted.round().max(1.0) as usize
        });
        Self {
            min: *min,
            extent,
            counts,
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.counts.iter().product()
    }

    /// Whether there is no particle: never.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Distance of neighbours along each axis (m).
    pub fn spacing(&self) -> SVector<T, D> {
        SVector::from_fn(|a, _| self.extent[a] / T::count(self.counts[a]))
    }

    /// Volume of each particle.
    pub fn volume(&self) -> T {
        (0..D).fold(T::one(), |v, a| v * self.extent[a] / T::count(self.counts[a]))
    }

    /// Place of a particle along each axis.
    pub fn place(&self, mut index: usize) -> [usize; D] {
        self.counts.map(|count| {
            let k = index % count;
            index /= count;
            k
        })
    }

    /// The next particle along `axis`, upwards or downwards; `None` at the end of the box.
    pub fn neighbour(&self, index: usize, axis: usize, upwards: bool) -> Option<usize> {
        let stride: usize = self.counts.iter().take(axis).product();
        let count = self.counts.get(axis).copied()?;
        let place = index / stride % count;
        match upwards {
            true => (place + 1 < count).then(|| index + stride),
            false => (place > 0).then(|| index - stride),
        }
    }

    /// Position of a particle (m).
    pub fn position(&self, index: usize) -> SVector<T, D> {
        let half = T::one() / T::lit(2.0);
        let place = self.place(index);
        SVector::from_fn(|a, _| {
            self.min[a] + self.extent[a] * (T::count(place[a]) + half) / T::count(self.counts[a])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::vector;

    #[test]
    fn a_body_on_cell_edges_gets_exactly_the_asked_number_and_its_own_volume() {
        let grid = Grid::new(vector![0.0, 0.0], vector![1.0, 2.0], [10, 7]).unwrap();
        let points = lattice(&grid, grid.min(), grid.max(), [3, 2]);
        assert_eq!(points.len(), 30 * 14);
        let volume: f64 = points.iter().map(|p| p.1).sum();
        assert_relative_eq!(volume, 2.0, max_relative = 1e-13);
        assert!((points[0].0 - vector![1.0 / 60.0, 2.0 / 28.0]).norm() < 1e-15);
    }

    #[test]
    fn neighbours_are_a_spacing_away_and_end_with_the_box() {
        let grid = Grid::new(vector![0.0, 0.0], vector![3.0, 2.0], [3, 2]).unwrap();
        let lattice = Lattice::new(&grid, &vector![0.0, 0.0], &vector![3.0, 2.0], [1, 1]);
        assert_eq!(
            [0, 2, 4].map(|k| lattice.neighbour(k, 0, true)),
            [Some(1), None, Some(5)]
        );
        assert_eq!(
            [0, 2, 4].map(|k| lattice.neighbour(k, 1, true)),
            [Some(3), Some(5), None]
        );
        assert_eq!(
            [0, 2, 4].map(|k| lattice.neighbour(k, 1, false)),
            [None, None, Some(1)]
        );
    }

    #[test]
    fn a_body_smaller_than_a_cell_still_gets_a_particle() {
        let grid = Grid::new(vector![0.0], vector![1.0], [4]).unwrap();
        let points: Vec<(SVector<f64, 1>, f64)> = lattice(&grid, &vector![0.3], &vector![0.31], [4]);
        assert_eq!(points.len(), 1);
        assert_relative_eq!(points[0].0[0], 0.305, max_relative = 1e-15);
    }
}
