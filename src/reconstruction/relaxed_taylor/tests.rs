//! Relaxation: what it keeps, and that both its ways are one.

use approx::assert_relative_eq;
use nalgebra::vector;

use super::*;
use crate::basis::Linear;
use crate::grid::Grid;
use crate::particles::{Bins, lattice};

/// By a wave; the particles rest.
fn crossed(wave: f64) -> CourantNumbers<f64> {
    CourantNumbers { wave, motion: 0.0 }
}

/// Momentum and kinetic energy of unequal masses before and after: the one is kept, the other never raised,
/// and a velocity that the fit sees is left alone.
#[test]
fn a_weighted_relaxation_keeps_the_momentum_and_never_raises_the_energy() {
    let grid = Grid::new(vector![0.0], vector![3.0], [3]).unwrap();
    let positions: Vec<_> = (0..17).map(|p| vector![0.05 + 0.17 * f64::from(p)]).collect();
    let mass: Vec<f64> = (0..17).map(|p| 1.0 + f64::from(p * 7 % 5)).collect();
    let volumes = vec![0.1; 17];
    let bins = Bins::new(&grid, &positions).unwrap();
    let cloud = Cloud::new(&grid, &bins, &positions, &volumes).unwrap();
    let momentum = |v: &[f64]| mass.iter().zip(v).map(|(m, v)| m * v).sum::<f64>();
    let energy = |v: &[f64]| mass.iter().zip(v).map(|(m, v)| m * v * v).sum::<f64>();
    for crossed in [0.1, 0.7, 1.0].map(crossed) {
        let mut fit = RelaxedTaylor::<f64, 1, 3>::for_degree(2);
        fit.prepare(&cloud);
        let rough: Vec<f64> = (0..17).map(|p| f64::from(p * 11 % 7) - 2.0).collect();
        let mut v = rough.clone();
        NullSpace::relax_weighted(&mut fit, &cloud, &mass, &[crossed; 3], &mut v);
        assert_relative_eq!(momentum(&v), momentum(&rough), max_relative = 1e-14);
        assert!(energy(&v) < 0.99 * energy(&rough));
        let smooth: Vec<f64> = positions.iter().map(|x| 1.0 + x[0] - 0.3 * x[0] * x[0]).collect();
        let mut v = smooth.clone();
        NullSpace::relax_weighted(&mut fit, &cloud, &mass, &[crossed; 3], &mut v);
        for (found, expected) in v.iter().zip(&smooth) {
            assert_relative_eq!(found, expected, epsilon = 1e-13);
        }
    }
}

/// Five cells, whose particles all lie a tenth of a cell off the middle.
fn off_the_middle(per_cell: usize) -> (Grid<f64, 1>, Vec<nalgebra::SVector<f64, 1>>) {
    let grid = Grid::new(vector![0.0], vector![5.0], [5]).unwrap();
    let place = |p: usize| (p % per_cell) as f64 / per_cell as f64 * 0.8 + (p / per_cell) as f64;
    let first = 0.6 - 0.4 * (1.0 - 1.0 / per_cell as f64);
    let positions = (0..5 * per_cell).map(|p| vector![first + place(p)]).collect();
    (grid, positions)
}

/// Linear functions leave stairs where the stress has a slope. The neighbours see the slope, and giving it to
/// the particles of a cell must not change what the cell pulls with.
#[test]
fn a_slope_from_the_neighbours_leaves_the_mean_of_a_cell_alone() {
    for per_cell in [2, 3, 4, 8] {
        let (grid, positions) = off_the_middle(per_cell);
        let volumes = vec![1.0 / per_cell as f64; positions.len()];
        let bins = Bins::new(&grid, &positions).unwrap();
        let cloud = Cloud::new(&grid, &bins, &positions, &volumes).unwrap();
        let change = |mut fit: RelaxedTaylor<f64, 1, 3>| {
            fit.prepare(&cloud);
            let pull = |fit: &mut RelaxedTaylor<f64, 1, 3>, stress: &[f64]| {
                let mut sum = 0.0;
                fit.sum_field(&cloud, &Stored(stress));
                fit.integrate_cells(&cloud, 2..3, |p| stress[p], |_, weighted| sum += weighted);
                sum
            };
            let mut stress: Vec<f64> = positions.iter().map(|x| x[0].floor()).collect();
            let before = pull(&mut fit, &stress);
            assert_relative_eq!(before, 2.0, epsilon = 1e-12);
            NullSpace::relax(&mut fit, &cloud, &[crossed(0.01); 5], &mut stress);
            let middle = &stress[2 * per_cell..3 * per_cell];
            assert!(middle[0] < 2.0 && middle[per_cell - 1] > 2.0, "{middle:?}");
            (pull(&mut fit, &stress) - before).abs()
        };
        let kept = change(RelaxedTaylor::for_basis(&Linear));
        let moved = change(RelaxedTaylor::for_degree(1));
        assert!(kept < 1e-13 && moved > 1e-4, "{per_cell}: {kept:e}, {moved:e}");
    }
}

/// Rough values are moved alike, whether four cells are fitted at once or each alone.
#[test]
fn cells_alone_are_relaxed_as_four_at_once() {
    for per_cell in [1, 2, 3, 8] {
        let (grid, positions) = off_the_middle(per_cell);
        let volumes = vec![1.0 / per_cell as f64; positions.len()];
        let bins = Bins::new(&grid, &positions).unwrap();
        let cloud = Cloud::new(&grid, &bins, &positions, &volumes).unwrap();
        let relaxed = |kind: Kind| {
            let mut fit = RelaxedTaylor::<f64, 1, 3>::for_basis(&Linear);
            fit.prepare(&cloud);
            fit.cells.iter_mut().for_each(|cell| cell.kind = kind);
            let mut values: Vec<f64> = (0..positions.len()).map(|p| (p * 11 % 7) as f64).collect();
            NullSpace::relax(&mut fit, &cloud, &[crossed(0.3); 5], &mut values);
            values
        };
        let (four, alone) = (relaxed(Kind::Batch), relaxed(Kind::Fallback));
        // The body ends within the outer cells, which are of another size alone.
        for p in per_cell..4 * per_cell {
            assert_relative_eq!(four[p], alone[p], epsilon = 1e-11);
        }
    }
}

/// A cell that material ends in is told from a whole one by comparing patches: no rounding may make the two
/// differ.
#[test]
fn no_cell_of_a_full_box_counts_as_ended_within() {
    for cells in [47, 49, 98, 105, 107] {
        let grid = Grid::<f64, 2>::new(vector![0.0, 0.0], vector![1.0, 1.0], [cells; 2]).unwrap();
        let points = lattice(&grid, grid.min(), grid.max(), [3, 3]);
        let (positions, volumes): (Vec<_>, Vec<_>) = points.into_iter().unzip();
        let bins = Bins::new(&grid, &positions).unwrap();
        let cloud = Cloud::new(&grid, &bins, &positions, &volumes).unwrap();
        let mut fit = RelaxedTaylor::<f64, 2, 6>::for_degree(2);
        fit.prepare(&cloud);
        for place in 0..cells * cells {
            assert_eq!(NullSpace::filling(&fit, place), Filling::Filled, "{cells}");
        }
    }
}
