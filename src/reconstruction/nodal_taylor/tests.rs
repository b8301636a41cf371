use nalgebra::{SVector, Vector2, vector};

use super::super::{Cloud, CourantNumbers, Filters, NullSpace, Reconstruction};
use super::NodalTaylor;
use crate::basis::BSpline;
use crate::grid::Grid;
use crate::particles::{Bins, lattice};

type Fits = NodalTaylor<f64, 2, 6>;

/// Particles at uneven places of some of the cells of a box.
struct Layout {
    grid: Grid<f64, 2>,
    bins: Bins<2>,
    positions: Vec<Vector2<f64>>,
    volumes: Vec<f64>,
}

impl Layout {
    fn new(per_cell: usize, keep: impl Fn(&Vector2<f64>) -> bool) -> Self {
        let grid = Grid::new(vector![-1.0, 2.0], vector![3.0, 4.0], [4, 4]).unwrap();
        let points = lattice(&grid, grid.min(), grid.max(), [per_cell; 2]);
        let points: Vec<_> = points.into_iter().filter(|(x, _)| keep(x)).collect();
        let shift = |p: usize, a: usize| (((p * (7 + 6 * a)) % 11) as f64 / 11.0 - 0.5) * 0.1;
        let moved = points.iter().enumerate();
        let positions: Vec<_> = moved
            .map(|(p, (x, _))| x + vector![shift(p, 0), shift(p, 1)] * grid.cell_size()[1])
            .collect();
        let mut bins = Bins::new(&grid, &positions).unwrap();
        bins.list(&grid);
        Self {
            volumes: points.iter().map(|&(_, volume)| volume).collect(),
            grid,
            bins,
            positions,
        }
    }

    fn cloud(&self) -> Cloud<'_, f64, 2> {
        Cloud::new(&self.grid, &self.bins, &self.positions, &self.volumes).unwrap()
    }
}

fn quadratic(x: &Vector2<f64>) -> f64 {
    1.0 - 2.0 * x[0] + 0.3 * x[1] + 0.7 * x[0] * x[0] - 0.4 * x[0] * x[1] + 0.2 * x[1] * x[1]
}

#[test]
fn quadratics_are_integrated_exactly_wherever_the_particles_lie() {
    let layout = Layout::new(3, |_| true);
    let cloud = layout.cloud();
    let mut fits = Fits::for_basis(&BSpline::<2>);
    fits.prepare(&cloud);
    let (mut integral, mut moment) = (0.0, 0.0);
    fits.integrate(
        &cloud,
        |p| quadratic(&layout.positions[p]),
        |point, value: f64| {
            integral += value;
            moment += value * point.position[0];
        },
    );
    // Over [-1, 3] x [2, 4], term by term.
    let exact =
        8.0 - 2.0 * 8.0 + 0.3 * 24.0 + 0.7 * 2.0 * 28.0 / 3.0 - 0.4 * 4.0 * 6.0 + 0.2 * 4.0 * 56.0 / 3.0;
    let times_x = 8.0 - 2.0 * 2.0 * 28.0 / 3.0 + 0.3 * 24.0 + 0.7 * 2.0 * 20.0 - 0.4 * 6.0 * 28.0 / 3.0
        + 0.2 * 4.0 * 56.0 / 3.0;
    assert!(
        (integral / exact - 1.0).abs() < 1e-13,
        "{integral}, exact {exact}"
    );
    assert!(
        (moment / times_x - 1.0).abs() < 1e-13,
        "{moment}, exact {times_x}"
    );
}

#[test]
fn where_no_patch_is_filled_the_particles_are_all_there_is() {
    let layout = Layout::new(3, |x| x[0] < 0.0 && x[1] < 2.5);
    let cloud = layout.cloud();
    let mut fits = Fits::for_basis(&BSpline::<2>);
    fits.prepare(&cloud);
    // The corner of the grid is a full patch; away from it nothing is.
    let mut streamed = Vec::new();
    fits.integrate(
        &cloud,
        |p| quadratic(&layout.positions[p]),
        |point, value: f64| {
            streamed.push((point.particle, value));
        },
    );
    let particles = layout.positions.len();
    let filled: usize = fits.filled.iter().filter(|&&filled| filled > 0.0).count();
    assert_eq!(filled, 1, "{:?}", fits.filled);
    assert!(streamed.len() > particles);
    // With a field that no fit follows the patch fades too.
    fits.prepare(&cloud);
    streamed.clear();
    let rough = |p: usize| if p.is_multiple_of(2) { 1.0 } else { -1.0 };
    fits.integrate(&cloud, rough, |point, value: f64| {
        streamed.push((point.particle, value))
    });
    let plain = (0..particles).map(|p| (Some(p), rough(p) * layout.volumes[p]));
    assert_eq!(streamed, plain.collect::<Vec<_>>());
}

#[test]
fn relaxation_keeps_momenta_and_never_raises_the_energy() {
    let layout = Layout::new(3, |x| (x - vector![1.0, 3.0]).norm() < 0.9);
    let cloud = layout.cloud();
    let mut fits = Fits::for_basis(&BSpline::<2>);
    fits.prepare(&cloud);
    fits.integrate(&cloud, |_| 1.0, |_, _: f64| {});
    let count = layout.positions.len();
    let mass: Vec<f64> = (0..count).map(|p| 1.0 + (p % 5) as f64 * 0.3).collect();
    let mut velocity: Vec<_> = (0..count)
        .map(|p| vector![((p * 13) % 17) as f64 - 8.0, ((p * 5) % 19) as f64 - 9.0])
        .collect();
    let crossed = vec![
        CourantNumbers {
            wave: 0.7,
            motion: 0.4
        };
        layout.bins.occupied().len()
    ];
    let sums = |velocity: &[Vector2<f64>]| {
        let each = velocity.iter().zip(&mass).zip(&layout.positions);
        each.fold(([0.0; 3], 0.0), |([x, y, turn], energy), ((v, m), at)| {
            let moment = m * (at[0] * v[1] - at[1] * v[0]);
            (
                [x + m * v[0], y + m * v[1], turn + moment],
                energy + m * v.norm_squared(),
            )
        })
    };
    let before = sums(&velocity);
    let mut stress = vec![0.0; count];
    NullSpace::relax(&mut fits, &cloud, &crossed, &mut stress);
    NullSpace::relax_weighted(&mut fits, &cloud, &mass, &crossed, &mut velocity);
    let after = sums(&velocity);
    for (before, after) in before.0.iter().zip(after.0) {
        assert!(
            (before - after).abs() < 1e-12 * before.abs().max(100.0),
            "{before} {after}"
        );
    }
    assert!(after.1 < 0.99 * before.1, "{} {}", after.1, before.1);
}

#[test]
fn uniform_fields_are_left_alone() {
    let layout = Layout::new(2, |_| true);
    let cloud = layout.cloud();
    let mut fits = Fits::for_basis(&BSpline::<2>);
    fits.prepare(&cloud);
    fits.integrate(&cloud, |_| 5.0, |_, _: f64| {});
    let crossed = vec![
        CourantNumbers {
            wave: 1.0,
            motion: 1.0
        };
        layout.bins.occupied().len()
    ];
    let mut values = vec![SVector::<f64, 1>::repeat(5.0); layout.positions.len()];
    NullSpace::relax(&mut fits, &cloud, &crossed, &mut values);
    assert!(values.iter().all(|value| (value[0] - 5.0).abs() < 1e-13));
}
