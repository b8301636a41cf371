//! Whether the particles of a cell tell the functions of a basis apart.
//!
//! Masses come straight from the particles: a function that is zero at all of them has none, and what is
//! divided by it is made of nothing. Neighbours share functions, so that not all need be told apart in each
//! cell; what each must tell apart is measured here.

use nalgebra::SVector;

use crate::reconstruction::{Cloud, Filling, Patch};
use crate::scalar::Scalar;

/// Share of a function's mean square over the cell that must be left of it on the particles, after the
/// functions before it.
const SEEN: f64 = 0.02;
/// Functions in three dimensions: eight multilinear ones and three squares.
const MOST: usize = 11;

/// [`Filling::Underdetermined`] where the particles do not tell the multilinear functions apart, two along
/// each axis, which every basis wants; [`Filling::PartlyFilled`] where they do not see squares beyond one
/// axis, which a basis of higher degree wants there: rows of two particles along each axis determine its
/// masses, but so weakly that noise grows. Along one axis they bear it.
pub(super) fn seen_by_particles<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    cell: usize,
    degree: usize,
) -> Filling {
    let (multilinear, count) = (1_usize << D, cloud.bins.count_in(cell));
    let functions = multilinear + if D > 1 && degree > 1 { D } else { 0 };
    if functions > MOST {
        return Filling::Filled;
    }
    if count < multilinear {
        return Filling::Underdetermined;
    }
    let patch = Patch::whole(cloud.grid, cell);
    let mut gram = [[T::zero(); MOST]; MOST];
    for &p in cloud.bins.particles_in(cell) {
        let psi = functions_at(&patch.local(&cloud.positions[p as usize]));
        for (i, row) in gram.iter_mut().enumerate().take(functions) {
            for (sum, &other) in row.iter_mut().zip(&psi).take(i + 1) {
                *sum += psi[i] * other;
            }
        }
    }
    match large_pivots(&mut gram, functions, T::lit(SEEN) * T::count(count)) {
        found if found < multilinear => Filling::Underdetermined,
        found if found < functions => Filling::PartlyFilled,
        _ => Filling::Filled,
    }
}

/// Products of Legendre's first two functions along the axes, and the third of each, all of mean square one
/// over a cell.
fn functions_at<T: Scalar, const D: usize>(s: &SVector<T, D>) -> [T; MOST] {
    let [one, three, five] = [1.0, 3.0, 5.0].map(T::lit);
    let multilinear = 1_usize << D;
    std::array::from_fn(|k| match k.checked_sub(multilinear) {
        None => (0..D).fold(one, |product, axis| match k >> axis & 1 {
            0 => product,
            _ => product * three.sqrt() * s[axis],
        }),
        Some(axis) if axis < D => (three * s[axis] * s[axis] - one) * five.sqrt() / T::lit(2.0),
        Some(_) => T::zero(),
    })
}

/// How many of the first pivots of a symmetric matrix, of which there is the lower half, are at least so
/// large.
fn large_pivots<T: Scalar>(matrix: &mut [[T; MOST]; MOST], order: usize, least: T) -> usize {
    for k in 0..order {
        let pivot = matrix[k][k];
        // What is not a number is not large.
        if pivot.partial_cmp(&least).is_none_or(|order| order.is_lt()) {
            return k;
        }
        for i in k + 1..order {
            let factor = matrix[i][k] / pivot;
            for j in k + 1..=i {
                let product = factor * matrix[j][k];
                matrix[i][j] -= product;
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use crate::particles::{Bins, lattice};
    use nalgebra::vector;

    /// Of a cell whose shape does not matter with so many particles along each axis.
    fn seen(per_cell: [usize; 2], size: [f64; 2], degree: usize) -> Filling {
        let grid = Grid::<f64, 2>::new(vector![0.0, 0.0], size.into(), [1, 1]).unwrap();
        let points = lattice(&grid, grid.min(), grid.max(), per_cell);
        let (positions, volumes): (Vec<_>, Vec<_>) = points.into_iter().unzip();
        let bins = Bins::new(&grid, &positions).unwrap();
        seen_by_particles(
            &Cloud::new(&grid, &bins, &positions, &volumes).unwrap(),
            0,
            degree,
        )
    }

    #[test]
    fn each_axis_wants_two_particles_and_three_where_squares_count() {
        for size in [[1.0, 1.0], [8.0, 1.0], [1.0, 8.0]] {
            for per_cell in [[1, 1], [1, 4], [4, 1], [1, 9]] {
                assert_eq!(seen(per_cell, size, 1), Filling::Underdetermined, "{per_cell:?}");
                assert_eq!(seen(per_cell, size, 2), Filling::Underdetermined, "{per_cell:?}");
            }
            for per_cell in [[2, 2], [2, 4], [8, 2]] {
                assert_eq!(seen(per_cell, size, 1), Filling::Filled, "{per_cell:?}");
                assert_eq!(seen(per_cell, size, 2), Filling::PartlyFilled, "{per_cell:?}");
            }
            assert_eq!(seen([3, 3], size, 2), Filling::Filled);
        }
    }

    #[test]
    fn along_one_axis_two_particles_apart_do() {
        let grid = Grid::<f64, 1>::new(vector![0.0], vector![1.0], [1]).unwrap();
        for (apart, expected) in [
            (0.0, Filling::Underdetermined),
            (0.04, Filling::Underdetermined),
            (0.3, Filling::Filled),
        ] {
            let positions = [vector![0.4], vector![0.4 + apart]];
            let bins = Bins::new(&grid, &positions).unwrap();
            let cloud = Cloud::new(&grid, &bins, &positions, &[0.5, 0.5]).unwrap();
            assert_eq!(seen_by_particles(&cloud, 0, 2), expected, "{apart}");
        }
    }
}
