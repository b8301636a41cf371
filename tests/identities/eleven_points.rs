//! The papers' one-dimensional example over many random layouts: sin x + 2 on `[0, 4 pi]`, four cells, eleven
//! points.
//!
//! ```text
//! 0        pi       2 pi      3 pi      4 pi
//! x  r     x r  r   |  u  u  u |  r  r r |        x given, u uniform, r random
//! ```
//! The point at pi serves both cells that it touches. The papers do not publish their random points, so their
//! single figures (RMS 3.9967e-2 for Taylor least squares, 6.0867e-2 for the spline) can only be placed in
//! the distribution.

use std::f64::consts::PI;

use materialpoint::grid::Grid;
use materialpoint::particles::Bins;
use materialpoint::quadrature::gauss_legendre;
use materialpoint::reconstruction::{Cloud, CubicSpline, Reconstruction, Taylor};
use nalgebra::{SVector, vector};

use super::anchors::evaluate;

const LAYOUTS: usize = 1000;

fn field(x: f64) -> f64 {
    x.sin() + 2.0
}

/// A generator of numbers in [0, 1) that anyone can repeat (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Eleven points with at least three distinct ones in each cell, which fixes how many of the six random ones
/// are where: one in the first, two in the second, three in the last.
fn eleven(random: &mut Random) -> Vec<f64> {
    let mut points = vec![0.0, PI];
    points.extend([0.25, 0.5, 0.75].map(|u| (2.0 + u) * PI));
    for cell in [0.0, 1.0, 1.0, 3.0, 3.0, 3.0] {
        points.push((cell + random.next()) * PI);
    }
    points
}

struct Outcome {
    root_mean_square: f64,
    integral_error: f64,
}

/// Errors of a reconstruction given at the `n` Gauss points of each cell.
fn root_mean_square(values: &[(f64, f64)]) -> f64 {
    let sum: f64 = values.iter().map(|&(x, value)| (value - field(x)).powi(2)).sum();
    (sum / values.len() as f64).sqrt()
}

/// `n` Gauss points of each cell, ascending, with weights.
fn gauss(n: usize) -> Vec<(f64, f64)> {
    let rule = gauss_legendre::<f64>(n);
    let on = |cell: usize| {
        rule.iter()
            .map(move |&(s, w)| ((cell as f64 + 0.5 + s / 2.0) * PI, w * PI / 2.0))
    };
    (0..4).flat_map(on).collect()
}

fn cloud<'a>(
    grid: &'a Grid<f64, 1>,
    bins: &'a Bins<1>,
    at: &'a [SVector<f64, 1>],
    v: &'a [f64],
) -> Cloud<'a, f64, 1> {
    Cloud::new(grid, bins, at, v).unwrap()
}

/// Taylor least squares, each cell's mean the exact one.
fn taylor(grid: &Grid<f64, 1>, points: &[f64], fine: &[(f64, f64)]) -> Outcome {
    // The number below pi lies in the first cell: the point at pi once more, for that cell.
    let below = [grid.edge(0, 1).next_down()];
    let positions: Vec<_> = points.iter().chain(&below).map(|&x| vector![x]).collect();
    let bins = Bins::new(grid, &positions).unwrap();
    let volumes = vec![1.0; positions.len()];
    let cloud = cloud(grid, &bins, &positions, &volumes);
    let mut taylor = Taylor::<f64, 1, 3>::new();
    taylor.prepare(&cloud);
    let integral = |cell: u32| {
        let (a, b) = (grid.edge(0, cell as usize), grid.edge(0, cell as usize + 1));
        a.cos() - b.cos() + 2.0 * PI
    };
    let fits =
        taylor.coefficients_with_mean(&cloud, |p| field(positions[p][0]), |cell| integral(cell[0]) / PI);
    let at = |cell: usize, x: f64| evaluate(&fits[cell], &vector![(x / PI - cell as f64) * 2.0 - 1.0]);
    let per_cell = fine.len() / 4;
    let values: Vec<_> = fine
        .iter()
        .enumerate()
        .map(|(k, &(x, _))| (x, at(k / per_cell, x)))
        .collect();
    let sum: f64 = gauss(2)
        .iter()
        .enumerate()
        .map(|(k, &(x, w))| w * at(k / 2, x))
        .sum();
    Outcome {
        root_mean_square: root_mean_square(&values),
        integral_error: (sum / (8.0 * PI) - 1.0).abs(),
    }
}

fn spline(grid: &Grid<f64, 1>, points: &[f64], fine: &[(f64, f64)]) -> Outcome {
    let positions: Vec<_> = points.iter().map(|&x| vector![x]).collect();
    let bins = Bins::new(grid, &positions).unwrap();
    let volumes = vec![1.0; positions.len()];
    let mut spline = CubicSpline::for_degree(1);
    spline.prepare(&cloud(grid, &bins, &positions, &volumes));
    let mut values = Vec::new();
    let value = |p: usize| field(points[p]);
    spline.at_points(value, fine.iter().map(|point| point.0), |x, v: f64| {
        values.push((x, v))
    });
    let (two, mut sum, mut k) = (gauss(2), 0.0, 0);
    spline.at_points(value, two.iter().map(|point| point.0), |_, v: f64| {
        sum += v * two[k].1;
        k += 1;
    });
    Outcome {
        root_mean_square: root_mean_square(&values),
        integral_error: (sum / (8.0 * PI) - 1.0).abs(),
    }
}

/// 5 %, 50 %, 95 % and the largest.
fn quantiles(mut values: Vec<f64>) -> [f64; 4] {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    [values[n / 20], values[n / 2], values[n - n / 20], values[n - 1]]
}

fn text(values: [f64; 4]) -> String {
    values.map(|v| format!("{v:.3e}")).join(" ")
}

/// A reconstruction of the field from the points, judged at the given fine Gauss points.
type Method = fn(&Grid<f64, 1>, &[f64], &[(f64, f64)]) -> Outcome;

/// Quantiles of the RMS error and of the integral's.
fn distribution(method: Method) -> ([f64; 4], [f64; 4]) {
    let grid = Grid::new(vector![0.0], vector![4.0 * PI], [4]).unwrap();
    let fine = gauss(100);
    let mut random = Random(2019);
    let (mut errors, mut integrals) = (Vec::new(), Vec::new());
    for _ in 0..LAYOUTS {
        let outcome = method(&grid, &eleven(&mut random), &fine);
        errors.push(outcome.root_mean_square);
        integrals.push(outcome.integral_error);
    }
    (quantiles(errors), quantiles(integrals))
}

#[test]
fn taylor_keeps_the_integral_in_every_layout() {
    let (errors, integrals) = distribution(taylor);
    println!(
        "TLS, 5 % 50 % 95 % max: RMS {}, integral {}",
        text(errors),
        text(integrals)
    );
    assert!(integrals[3] <= 1e-14, "{integrals:?}");
    // Measured 2.66e-2, 3.27e-2, 5.82e-2. The median's own scatter over seeds is some 2 %.
    assert!(errors[1] > 3.0e-2 && errors[1] < 3.6e-2, "{errors:?}");
    assert!(
        errors[0] < 3.9967e-2 && 3.9967e-2 < errors[2],
        "the papers' figure is a likely one"
    );
}

#[test]
fn the_spline_does_not() {
    let (errors, integrals) = distribution(spline);
    println!(
        "spline, 5 % 50 % 95 % max: RMS {}, integral {}",
        text(errors),
        text(integrals)
    );
    // Measured 4.16e-2, 8.95e-2, 3.12e-1 and for the integral 1.3e-3, 1.6e-2, 4.2e-2.
    assert!(errors[1] > 8.0e-2 && errors[1] < 1.0e-1, "{errors:?}");
    assert!(
        errors[0] < 6.0867e-2 && 6.0867e-2 < errors[2],
        "the papers' figure is a likely one"
    );
    assert!(integrals[1] > 1e-2 && integrals[1] < 2e-2, "{integrals:?}");
}
