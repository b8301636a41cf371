//! Densities that stay positive.

use nalgebra::vector;

use super::*;
use crate::field::MassMomentum;
use crate::grid::Grid;
use crate::particles::Bins;
use crate::reconstruction::Densities;
use crate::simd::{Four, LANES, Plain};

/// Four cells at once leave one whose density might be negative to the way that draws it towards its mean,
/// where it is a mass.
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
    let density = |_: usize| MassMomentum {
        mass: 2.0,
        momentum: vector![1.0, 0.0],
    };
    let four = InFours::integrate_batch::<Plain, MassMomentum<f64, 2>>(
        &taylor,
        Plain,
        (&cloud, 0..2),
        true,
        Kept::nothing(),
        &density,
        |_, _| (),
    );
    assert_eq!(four.hard, [false, true, false, false]);
    let momentum = |p: usize| density(p).momentum;
    let any = InFours::integrate_batch::<Plain, SVector<f64, 2>>(
        &taylor,
        Plain,
        (&cloud, 0..2),
        true,
        Kept::nothing(),
        &momentum,
        |_, _| (),
    );
    assert_eq!(any.hard, [false; LANES]);
    let (mut least, mut sum) = (f64::INFINITY, 0.0);
    let mut add = |_: &Point<f64, 2>, weighted: MassMomentum<f64, 2>| {
        least = weighted.mass.min(least);
        sum += weighted.mass;
    };
    // Particles at one end do not determine all functions.
    assert!(!InFours::integrate_single(
        &taylor, &cloud, 1, true, &density, &mut add
    ));
    // A hundredth of the mean at one of four points that weigh the same.
    assert!(
        (least - 0.6 / 400.0).abs() < 1e-15 && (sum - 0.6).abs() < 1e-15,
        "{least} {sum}"
    );
}

/// Particles that follow each other in their cells are summed in another way than those that do not: the
/// integrals are the same, however many particles there are in a cell.
#[test]
fn the_order_of_particles_does_not_matter() {
    let grid = Grid::new(vector![0.0], vector![7.0], [7]).unwrap();
    let mut positions = Vec::new();
    for (cell, count) in [3, 8, 5, 4, 11, 1, 2].into_iter().enumerate() {
        let place = |p: usize| (p as f64 + 0.4 + 0.1 * (p % 3) as f64) / count as f64;
        positions.extend((0..count).map(|p| vector![cell as f64 + place(p)]));
    }
    let apart: Vec<_> = (0..2)
        .flat_map(|odd| positions.iter().skip(odd).step_by(2).copied())
        .collect();
    let integrals = |positions: &[SVector<f64, 1>], conserve| {
        let volumes: Vec<f64> = positions.iter().map(|x| 0.2 + 0.01 * x[0]).collect();
        let masses: Vec<f64> = positions.iter().map(|x| 1.0 + 0.3 * x[0]).collect();
        let velocities: Vec<_> = positions.iter().map(|x| vector![x[0].sin()]).collect();
        let density = Densities {
            masses: &masses,
            velocities: &velocities,
            volumes: &volumes,
        };
        let bins = Bins::new(&grid, positions).unwrap();
        let cloud = Cloud::new(&grid, &bins, positions, &volumes).unwrap();
        let taylor = Taylor::<f64, 1, 3>::new();
        let mut found = Vec::new();
        for cells in [0..4, 4..7] {
            let add = |_: usize, value: &[Four<f64>; MOST_COMPONENTS]| {
                found.extend(value[..2].iter().flat_map(|q| q.0));
            };
            let four = InFours::integrate_batch::<Plain, _>(
                &taylor,
                Plain,
                (&cloud, cells),
                conserve,
                Kept::nothing(),
                &density,
                add,
            );
            assert_eq!(four.hard, [false; LANES]);
        }
        found
    };
    for conserve in [false, true] {
        let (in_order, apart) = (integrals(&positions, conserve), integrals(&apart, conserve));
        assert_eq!(in_order.len(), 2 * 2 * 2 * LANES);
        for (a, b) in in_order.iter().zip(&apart) {
            assert!((a - b).abs() < 1e-13, "{a} {b}");
        }
    }
}

/// Short arrays hold the components of the fields of a step along one axis; a user's may have more.
#[test]
fn a_field_of_many_components_is_streamed_along_one_axis_too() {
    let grid = Grid::new(vector![0.0], vector![4.0], [4]).unwrap();
    let positions: Vec<_> = (0..20).map(|p| vector![0.2 * p as f64 + 0.07]).collect();
    let volumes = vec![0.2; 20];
    let bins = Bins::new(&grid, &positions).unwrap();
    let cloud = Cloud::new(&grid, &bins, &positions, &volumes).unwrap();
    let component = |p: usize, c: usize| (1.0 + c as f64) * positions[p][0];
    let taylor = Taylor::<f64, 1, 3>::new();
    let (mut single, mut all) = (Vec::new(), Vec::new());
    for c in 0..3 {
        let one = |p: usize| component(p, c);
        InFours::integrate_batch::<Plain, f64>(
            &taylor,
            Plain,
            (&cloud, 0..4),
            false,
            Kept::nothing(),
            &one,
            |point, value| {
                single.push((point, c, value[0].0));
            },
        );
    }
    let three = |p: usize| SVector::<f64, 3>::from_fn(|c, _| component(p, c));
    InFours::integrate_batch::<Plain, SVector<f64, 3>>(
        &taylor,
        Plain,
        (&cloud, 0..4),
        false,
        Kept::nothing(),
        &three,
        |point, value| {
            all.extend((0..3).map(|c| (point, c, value[c].0)));
        },
    );
    all.sort_by_key(|&(point, c, _)| (c, point));
    assert_eq!(single, all);
}
