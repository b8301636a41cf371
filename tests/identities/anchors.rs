//! Figures of the papers for the reconstruction alone.

use std::f64::consts::PI;

use materialpoint::grid::{Cell, Grid};
use materialpoint::particles::Bins;
use materialpoint::quadrature::gauss_legendre;
use materialpoint::reconstruction::{Cloud, Reconstruction, Taylor};
use materialpoint::taylor::taylor_functions;
use nalgebra::{SVector, vector};

/// Value at local coordinates `s` of a fit.
pub fn evaluate<const D: usize, const NB: usize>(coefficients: &[f64; NB], s: &SVector<f64, D>) -> f64 {
    let psi = taylor_functions::<f64, D, NB>(s);
    (0..NB).map(|k| coefficients[k] * psi[k]).sum()
}

/// Six points in each of the 25 unit cells of `[0, 5]^2`.
fn six_points_a_cell(grid: &Grid<f64, 2>) -> Vec<SVector<f64, 2>> {
    let mut points = Vec::new();
    for number in 0..grid.cell_count() {
        let [i, j] = grid.cell(number).map(f64::from);
        for x in [1.0 / 3.0, 2.0 / 3.0] {
            points.extend([0.25, 0.5, 0.75].map(|y| vector![i + x, j + y]));
        }
    }
    points
}

/// Mean of `sin x cos y` over a unit cell.
fn mean(cell: &Cell<2>) -> f64 {
    let [x, y] = cell.map(f64::from);
    (x.cos() - (x + 1.0).cos()) * ((y + 1.0).sin() - y.sin())
}

/// Journal section 5.3's method on the two-dimensional field; paper 6.17e-3, an independent prototype
/// 6.170989e-3.
#[test]
fn the_field_sin_x_cos_y_on_25_cells() {
    let grid = Grid::new(vector![0.0, 0.0], vector![5.0, 5.0], [5, 5]).unwrap();
    let positions = six_points_a_cell(&grid);
    let volumes = vec![1.0 / 6.0; positions.len()];
    let bins = Bins::new(&grid, &positions).unwrap();
    let cloud = Cloud::new(&grid, &bins, &positions, &volumes).unwrap();
    let mut taylor = Taylor::<f64, 2, 6>::new();
    taylor.prepare(&cloud);
    let field = |x: &SVector<f64, 2>| x[0].sin() * x[1].cos();
    let fits = taylor.coefficients_with_mean(&cloud, |p| field(&positions[p]), mean);
    let line = gauss_legendre::<f64>(2);
    let (mut square, mut integral, mut size) = (0.0, 0.0, 0.0);
    for (number, coefficients) in fits.iter().enumerate() {
        let cell = grid.cell(number);
        for (s, t) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let local = vector![line[s].0, line[t].0];
            let fitted = evaluate(coefficients, &local);
            square += (fitted - field(&(grid.centre(&cell) + local / 2.0))).powi(2);
            integral += fitted / 4.0;
            size += fitted.abs() / 4.0;
        }
    }
    let root_mean_square = (square / 100.0).sqrt();
    println!("sin x cos y: RMS {root_mean_square:.9e}");
    assert!(
        (root_mean_square - 6.170989e-3).abs() < 5e-10,
        "{root_mean_square:e}"
    );
    // Six functions on six points, which are dependent with the mean free and independent with it given.
    assert_eq!(taylor.reduced_cells(), 25);
    let exact = (1.0 - 5.0_f64.cos()) * 5.0_f64.sin();
    println!(
        "integral error relative to the integral of |f|: {:e}",
        (integral - exact).abs() / size
    );
    // A hundred values and as many roundings, of either sign: their root, ten.
    assert!(
        (integral - exact).abs() <= 10.0 * f64::EPSILON * size,
        "{integral} {exact}"
    );
}

/// The fit of sin x + 2 in `[pi, 2 pi]`, the second of four cells, through the given points, its mean exact.
fn second_cell(points: &[f64]) -> ([f64; 3], Taylor<f64, 1, 3>) {
    let grid = Grid::new(vector![0.0], vector![4.0 * PI], [4]).unwrap();
    let positions: Vec<_> = points.iter().map(|&x| vector![x]).collect();
    let bins = Bins::new(&grid, &positions).unwrap();
    let volumes = vec![1.0; points.len()];
    let cloud = Cloud::new(&grid, &bins, &positions, &volumes).unwrap();
    assert_eq!(cloud.bins.occupied(), [1]);
    let mut taylor = Taylor::<f64, 1, 3>::new();
    taylor.prepare(&cloud);
    let fits = taylor.coefficients_with_mean(&cloud, |p| points[p].sin() + 2.0, |_| 2.0 - 2.0 / PI);
    (fits[0], taylor)
}

/// The degenerate cell (journal figure 4): with points at pi and 5 pi/3 only, the quadratic function is -1/3
/// of the linear one there. It must be dropped, not fitted with garbage; the integral is kept all the same.
#[test]
fn the_degenerate_cell_is_not_distorted() {
    // Twice the second point: then three particles, so that it is not their number that drops the function.
    for points in [
        &[PI, 5.0 * PI / 3.0][..],
        &[PI, 5.0 * PI / 3.0, 5.0 * PI / 3.0][..],
    ] {
        let (a, taylor) = second_cell(points);
        assert_eq!(taylor.reduced_cells(), 1);
        assert_eq!(a[0], 2.0 - 2.0 / PI);
        assert_eq!(a[2], 0.0, "{a:?}");
        // Local coordinates -1 and 1/3: the slope is the least-squares one of a line through the mean.
        let weight = (points.len() - 1) as f64;
        let (left, right) = (2.0 - a[0], (5.0 * PI / 3.0).sin() + 2.0 - a[0]);
        let slope = (-left + weight * right / 3.0) / (1.0 + weight / 9.0);
        assert!((a[1] - slope).abs() <= 8.0 * f64::EPSILON, "{a:?} {slope}");
        let integral: f64 = gauss_legendre::<f64>(2)
            .iter()
            .map(|&(s, w)| w * evaluate(&a, &vector![s]))
            .sum();
        assert!((integral - 2.0 * a[0]).abs() <= 4.0 * f64::EPSILON * a[0]);
    }
}

/// With a third point that makes the functions independent again, all three are used.
#[test]
fn one_more_point_makes_the_degenerate_cell_whole() {
    let (a, _) = second_cell(&[PI, 5.0 * PI / 3.0, 1.9 * PI]);
    assert!(a[2] != 0.0);
    let worst = (0..=20)
        .map(|k| f64::from(k) / 10.0 - 1.0)
        .map(|s| (evaluate(&a, &vector![s]) - (1.5 * PI + s * PI / 2.0).sin() - 2.0).abs())
        .fold(0.0, f64::max);
    // Half a sine wave is a parabola up to 0.06 of its height (best fit); the points' unevenness doubles
    // that.
    assert!(worst < 0.12, "{worst}");
}
