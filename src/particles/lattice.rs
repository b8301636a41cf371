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
    lattice_points(grid, min, max, per_cell).collect()
}

/// The same one by one; knows how many will come.
pub(crate) fn lattice_points<T: Scalar, const D: usize>(
    grid: &Grid<T, D>,
    min: &SVector<T, D>,
    max: &SVector<T, D>,
    per_cell: [usize; D],
) -> impl ExactSizeIterator<Item = (SVector<T, D>, T)> + use<T, D> {
    let min = *min;
    let extent = max - min;
    let counts: [usize; D] = std::array::from_fn(|a| {
        let wanted = (extent[a] / grid.cell_size()[a]).primal() * per_cell[a] as f64;
        wanted.round().max(1.0) as usize
    });
    let volume = (0..D).fold(T::one(), |v, a| v * extent[a] / T::count(counts[a]));
    let half = T::one() / T::lit(2.0);
    (0..counts.iter().product()).map(move |mut index| {
        let position = SVector::from_fn(|a, _| {
            let k = index % counts[a];
            index /= counts[a];
            min[a] + extent[a] * (T::count(k) + half) / T::count(counts[a])
        });
        (position, volume)
    })
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
    fn a_body_smaller_than_a_cell_still_gets_a_particle() {
        let grid = Grid::new(vector![0.0], vector![1.0], [4]).unwrap();
        let points: Vec<(SVector<f64, 1>, f64)> = lattice(&grid, &vector![0.3], &vector![0.31], [4]);
        assert_eq!(points.len(), 1);
        assert_relative_eq!(points[0].0[0], 0.305, max_relative = 1e-15);
    }
}
