//! Densities that stay positive.

use nalgebra::vector;
use wide::f64x4;

use super::*;
use crate::field::MassMomentum;
use crate::grid::Grid;
use crate::lanes::LANES;
use crate::particles::Bins;

/// Four cells at once leave one whose density might be negative to the way that draws it towards its mean, where it is a mass.
#[test]
fn a_density_is_kept_positive_where_four_cells_are_streamed_at_once() {
    let grid = Grid::new(vector![0.0, 0.0], vector![2.0, 1.0], [2, 1]).unwrap();
    // The first cell is full, the second one at its left end only.
    let lattice = |width: f64| {
        (0..9).map(move |p| {
            vector![f64::from(p % 3) + 0.5, f64::from(p / 3) + 0.5].component_mul(&vector![width, 1.0]) / 3.0
        })
    };
    let positions: Vec<_> = lattice(1.0)
        .chain(lattice(0.3).map(|x| x + vector![1.0, 0.0]))
        .collect();
    let volumes: Vec<_> = (0..18)
        .map(|p| if p < 9 { 1.0 / 9.0 } else { 0.3 / 9.0 })
        .collect();
    let bins = Bins::new(&grid, &positions).unwrap();
    let cloud = Cloud::new(&grid, &bins, &positions, &volumes).unwrap();
    let taylor = Taylor::<f64, 2, 6>::new();
    let density = |_| MassMomentum {
        mass: 2.0,
        momentum: vector![1.0, 0.0],
    };
    let four = taylor.integrate_four::<f64x4, _>(&cloud, 0..2, true, &density, |_, _| ());
    assert_eq!(four.hard, [false, true, false, false]);
    let any = taylor.integrate_four::<f64x4, _>(&cloud, 0..2, true, &|p| density(p).momentum, |_, _| ());
    assert_eq!(any.hard, [false; LANES]);
    let (mut least, mut sum) = (f64::INFINITY, 0.0);
    let add = |_: &Point<f64, 2>, weighted: MassMomentum<f64, 2>| {
        least = weighted.mass.min(least);
        sum += weighted.mass;
    };
    // Particles at one end do not determine all functions.
    assert!(!taylor.integrate_hard(&cloud, 1, true, &density, add));
    // A hundredth of the mean at one of four points that weigh the same.
    assert!(
        (least - 0.6 / 400.0).abs() < 1e-15 && (sum - 0.6).abs() < 1e-15,
        "{least} {sum}"
    );
}
