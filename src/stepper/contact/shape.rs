//! The shape of particles at the start, which tells how far they reach towards a wall.

use nalgebra::SVector;

use crate::grid::Grid;
use crate::particles::Bins;
use crate::scalar::Scalar;

/// Share of a cell within which coordinates count as one.
const ALIKE: f64 = 1e-6;

/// Size of each particle along each axis over the `D`-th root of its volume, from the spacing of the
/// particles in its cell at the start: two by four to a cell are twice as wide as high. Particles in no order
/// are taken for pieces of the cell's shape.
pub(in crate::stepper) fn shapes<T: Scalar, const D: usize>(
    grid: &Grid<T, D>,
    initial: &[SVector<T, D>],
) -> Vec<SVector<T, D>> {
    let cell_shape = normalised(*grid.cell_size());
    let mut shapes = vec![cell_shape; initial.len()];
    // A caller's reference configuration may lie elsewhere.
    let Ok(bins) = Bins::without_lists(grid, initial) else {
        return shapes;
    };
    let mut order: Vec<usize> = (0..initial.len()).collect();
    order.sort_by_key(|&p| *bins.cell_of(p));
    let mut coordinates = Vec::new();
    for cell in order.chunk_by(|&a, &b| bins.cell_of(a) == bins.cell_of(b)) {
        let spacing: [Option<Spacing<T>>; D] = std::array::from_fn(|axis| {
            coordinates.clear();
            coordinates.extend(cell.iter().map(|&p| initial[p][axis]));
            spacing(&mut coordinates, grid.cell_size()[axis])
        });
        // In no order: every particle has coordinates of its own along every axis.
        let rows = spacing.map(|spacing| spacing.map(|spacing| spacing.rows));
        if D > 1 && cell.len() > 1 && rows.iter().all(|&rows| rows == Some(cell.len())) {
            continue;
        }
        let spacing = spacing.map(|spacing| spacing.map(|spacing| spacing.size));
        let known = spacing.iter().zip(grid.cell_size().iter());
        let shares: Vec<T> = known.filter_map(|(s, &h)| s.map(|s| s / h)).collect();
        if shares.is_empty() {
            continue;
        }
        // Along an axis with a single row of particles they are as long as along the others, in cells.
        let mean = shares.iter().fold(T::zero(), |sum, &share| sum + share) / T::count(shares.len());
        let size = SVector::from_fn(|axis, _| spacing[axis].unwrap_or(grid.cell_size()[axis] * mean));
        for &p in cell {
            shapes[p] = normalised(size);
        }
    }
    shapes
}

/// Different coordinates of the particles of a cell along an axis.
#[derive(Clone, Copy)]
struct Spacing<T> {
    /// How many there are.
    rows: usize,
    /// Their mean distance.
    size: T,
}

/// The spacing in a cell of size `cell`; `None` if all coordinates are alike.
fn spacing<T: Scalar>(coordinates: &mut [T], cell: T) -> Option<Spacing<T>> {
    coordinates.sort_by(|a, b| a.primal().total_cmp(&b.primal()));
    let alike = cell * T::lit(ALIKE);
    let gaps = coordinates
        .windows(2)
        .filter(|pair| pair[1] - pair[0] > alike)
        .count();
    let (first, last) = (coordinates.first()?, coordinates.last()?);
    (gaps > 0).then(|| Spacing {
        rows: gaps + 1,
        size: (*last - *first) / T::count(gaps),
    })
}

/// The vector over the `D`-th root of its components' product.
fn normalised<T: Scalar, const D: usize>(size: SVector<T, D>) -> SVector<T, D> {
    let volume = size.iter().fold(T::one(), |product, &h| product * h);
    size / volume.powf(T::one() / T::count(D))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::lattice;
    use nalgebra::vector;

    #[test]
    fn particles_of_a_lattice_have_its_spacing_whatever_the_cells() {
        for (extent, per_cell) in [([1.0, 1.0], [4, 2]), ([1.0, 8.0], [2, 4]), ([8.0, 1.0], [3, 3])] {
            let grid = Grid::<f64, 2>::new(vector![0.0, 0.0], vector![extent[0], extent[1]], [4, 4]).unwrap();
            let h = *grid.cell_size();
            let (low, high) = (vector![0.0, 0.0], vector![3.0 * h[0], 4.0 * h[1]]);
            let points = lattice(&grid, &low, &high, per_cell);
            let initial: Vec<_> = points.iter().map(|point| point.0).collect();
            for (shape, (_, volume)) in shapes(&grid, &initial).iter().zip(&points) {
                let size = shape * volume.sqrt();
                let expected = vector![h[0] / per_cell[0] as f64, h[1] / per_cell[1] as f64];
                assert!(
                    (size - expected).norm() < 1e-9 * expected.norm(),
                    "{size} {expected}"
                );
            }
        }
    }
}
