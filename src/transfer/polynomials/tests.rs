//! Coefficients straight to DOFs against values at points.

use nalgebra::SVector;
use proptest::collection::vec;
use proptest::prelude::*;

use crate::basis::{BSpline, BasisFamily, DualDomain, Linear};
use crate::field::{Field, MassMomentum, Symmetric};
use crate::grid::Grid;
use crate::particles::{Bins, Domains, lattice};
use crate::reconstruction::{Cloud, Densities, InFours, Point, Streams, Stresses, Taylor, Values};
use crate::transfer::{
    Fits, Integrand, MassesAndMomenta, Parts, Seer, Stress, Sum, Sweep, at_fixed_points, components_of,
    look_up,
};

/// A box of cells, particles in them, and the rule.
#[derive(Clone, Debug)]
struct Case {
    cells: [usize; 3],
    /// Particles along each axis of a cell.
    each: usize,
    points: usize,
    /// As many as are wanted, again and again.
    numbers: Vec<f64>,
}

fn cases() -> impl Strategy<Value = Case> {
    // Axes of one cell and of two, ends that do not touch, and cells that all have the same functions.
    let cells = [1..10_usize, 1..4, 1..3];
    (cells, 2..5_usize, 1..5_usize, vec(-1.0..1.0_f64, 97)).prop_map(|(cells, each, points, numbers)| Case {
        cells,
        each,
        points,
        numbers,
    })
}

/// The sums at the DOFs, number by number, by cell matrices and by a stream of points.
fn both<I, const D: usize, const NB: usize, B, const S: usize, const C: usize, const G: usize>(
    basis: &B,
    taylor: &Taylor<f64, D, NB>,
    cloud: &Cloud<'_, f64, D>,
    value: &(impl Values<f64, I::Field> + Copy),
) -> [Vec<f64>; 2]
where
    B: BasisFamily<f64, D>,
    I: Integrand<f64, D, S, C, G, 0>,
{
    let numbers = S + D * (C + G);
    let grid = cloud.grid;
    let mut found = [(); 2].map(|()| vec![0.0; basis.dof_count(grid) * numbers]);
    let add = |all: &mut Vec<f64>, dof: usize, sum: Sum<f64, D, S, C, G>| {
        let vectors = sum.vectors.iter().chain(&sum.forces);
        let parts = sum.scalars.iter().chain(vectors.flat_map(|vector| vector.iter()));
        let places = &mut all[dof * numbers..(dof + 1) * numbers];
        for (place, part) in places.iter_mut().zip(parts) {
            *place += part;
        }
    };
    let [by_matrices, by_points] = &mut found;
    let none = Domains::none();
    let fits = Fits {
        moving: &|point, stencil, skip| {
            let place = (&point.cell, &point.position);
            look_up(stencil, (basis, grid), &none.views(), Seer::Moving, place, skip)
        },
        reconstruction: taylor,
        cloud,
        cells: 0..cloud.bins.occupied().len(),
        fresh: false,
    };
    at_fixed_points!(B, basis, |basis| Sweep::new(basis, grid)
        .integrate::<_, I, S, C, G, 0>(
            &fits,
            &mut [],
            value,
            &mut |dof, sum| add(by_matrices, dof, sum),
            &mut |_, _, _, _| (),
        ));
    for &cell in cloud.bins.occupied() {
        let mut stream = |point: &Point<f64, D>, value: I::Field| {
            let components = components_of::<f64, I::Field>(&value);
            let parts: Parts<f64, D, S, C, G> = I::parts(&components, &[1.0; D]);
            basis.for_each_at_fixed_point(grid, &point.cell, &point.position, |dof, phi, gradient| {
                add(by_points, dof, Sum::of(&parts, phi, &gradient));
            });
        };
        InFours::integrate_single(
            taylor,
            cloud,
            cell as usize,
            I::CONSERVED,
            &|p| value.at(p),
            &mut stream,
        );
    }
    found
}

fn check<const D: usize, const NB: usize>(case: &Case) -> Result<(), TestCaseError>
where
    Linear: BasisFamily<f64, D>,
    BSpline<1>: BasisFamily<f64, D>,
    BSpline<2>: BasisFamily<f64, D>,
    BSpline<3>: BasisFamily<f64, D>,
    DualDomain: BasisFamily<f64, D>,
{
    check_basis::<D, NB, _>(&Linear, case)?;
    check_basis::<D, NB, _>(&BSpline::<1>, case)?;
    check_basis::<D, NB, _>(&BSpline::<2>, case)?;
    check_basis::<D, NB, _>(&BSpline::<3>, case)?;
    check_basis::<D, NB, _>(&DualDomain::new(), case)
}

fn check_basis<const D: usize, const NB: usize, B: BasisFamily<f64, D>>(
    basis: &B,
    case: &Case,
) -> Result<(), TestCaseError> {
    // No cubes, whose axes could be mistaken for each other.
    let max = SVector::from_fn(|a, _| case.cells[a] as f64 * [0.5, 0.7, 1.1][a]);
    let grid = Grid::new(SVector::zeros(), max, std::array::from_fn(|a| case.cells[a])).unwrap();
    let number = |n: usize| case.numbers[n % case.numbers.len()];
    let points = lattice(&grid, grid.min(), grid.max(), [case.each; D]);
    let mut positions: Vec<_> = points.into_iter().map(|(x, _)| x).collect();
    for (p, x) in positions.iter_mut().enumerate() {
        for a in 0..D {
            x[a] += 0.3 * number(7 * p + a) * grid.cell_size()[a] / case.each as f64;
        }
    }
    let count = positions.len();
    let share = grid.cell_volume() / (case.each as f64).powi(D as i32);
    let volumes: Vec<_> = (0..count)
        .map(|p| share * (1.0 + 0.2 * number(3 * p + 1)))
        .collect();
    let masses: Vec<_> = (0..count)
        .map(|p| volumes[p] * (2.0 + 0.5 * number(5 * p + 2)))
        .collect();
    let velocities: Vec<SVector<f64, D>> = (0..count)
        .map(|p| SVector::from_fn(|a, _| number(11 * p + a)))
        .collect();
    let stresses: Vec<_> = (0..count)
        .map(|p| {
            let mut stress = Symmetric::<f64, D>(nalgebra::SMatrix::zeros());
            for q in 0..Symmetric::<f64, D>::COMPONENTS {
                stress.set_component(q, number(13 * p + q));
            }
            stress.0
        })
        .collect();
    let bins = Bins::new(&grid, &positions).unwrap();
    let cloud = Cloud::new(&grid, &bins, &positions, &volumes).unwrap();
    let taylor = Taylor::<f64, D, NB>::with_gauss_points(case.points);
    let densities = Densities {
        masses: &masses,
        velocities: &velocities,
        volumes: &volumes,
    };
    let momenta =
        both::<MassesAndMomenta<MassMomentum<f64, D>>, D, NB, B, 1, 1, 0>(basis, &taylor, &cloud, &densities);
    let forces = both::<Stress, D, NB, B, 0, 0, 1>(basis, &taylor, &cloud, &Stresses(&stresses));
    for [by_matrices, by_points] in [momenta, forces] {
        let size = by_points.iter().fold(0.0_f64, |size, sum| size.max(sum.abs()));
        for (n, (a, b)) in by_matrices.iter().zip(&by_points).enumerate() {
            prop_assert!((a - b).abs() <= 1e-10 * size, "{n}: {a} {b} of {size}, {D} axes");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn sums_by_matrices_are_those_of_the_stream_of_points(case in cases()) {
        check::<1, 3>(&case)?;
        check::<2, 6>(&case)?;
        check::<3, 10>(&case)?;
    }

    /// Linear fits have no coefficients of squares and products.
    #[test]
    fn linear_fits_too(case in cases()) {
        check::<1, 2>(&case)?;
        check::<2, 3>(&case)?;
        check::<3, 4>(&case)?;
    }
}
