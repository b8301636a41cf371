//! Bases that ask for the domains of particles: sizes (uniform GIMP, `examples/gimp.rs`) and edge vectors.
//!
//! Source: the closed forms of uniform GIMP (Bardenhagen & Kober 2004; Steffen, Kirby & Berzins 2008, their
//! three branches); bodies in balance, whose exact solution is known; what all methods promise.

mod bodies;
mod edges;
#[path = "../../examples/gimp.rs"]
mod gimp;
mod promises;
mod refused;

use materialpoint::basis::{AxisBasis, AxisCell, BasisFamily, Domain, Functions, Linear};
use materialpoint::grid::{Cell, Grid};
use materialpoint::scalar::Scalar;
use materialpoint::simd::{Lanes, Number};
use materialpoint::testing::{BasisClaims, Property, check_basis};
use nalgebra::{SMatrix, SVector, vector};

use gimp::Gimp;

/// Value and slope of the function of node 0 at a distance `x`, of a particle of length `l` in cells of size
/// `h`: equations of Steffen, Kirby & Berzins 2008.
fn closed_form(x: f64, l: f64, h: f64) -> (f64, f64) {
    let (away, sign) = (x.abs(), x.signum());
    if away < l / 2.0 {
        return (
            1.0 - (4.0 * x * x + l * l) / (4.0 * h * l),
            -8.0 * x / (4.0 * h * l),
        );
    }
    if away < h - l / 2.0 {
        return (1.0 - away / h, -sign / h);
    }
    if away < h + l / 2.0 {
        let rest = h + l / 2.0 - away;
        return (rest * rest / (2.0 * h * l), -sign * rest / (h * l));
    }
    (0.0, 0.0)
}

/// What the basis says of each DOF over a particle.
fn over<const D: usize>(
    basis: &impl BasisFamily<f64, D>,
    grid: &Grid<f64, D>,
    x: &SVector<f64, D>,
    domain: &SMatrix<f64, D, D>,
) -> Vec<(f64, SVector<f64, D>)> {
    let mut found = vec![(0.0, SVector::zeros()); basis.dof_count(grid)];
    let cell = grid.locate(x).unwrap();
    basis.for_each_over(grid, &cell, x, domain, |dof, value, gradient| {
        found[dof].0 += value;
        found[dof].1 += gradient;
    });
    found
}

#[test]
fn the_functions_are_those_of_the_literature() {
    let h = 0.5;
    let grid = Grid::new(vector![1.0], vector![4.0], [6]).unwrap();
    for (l, k) in [1.0, 0.7, 0.25, 1e-3]
        .into_iter()
        .flat_map(|l| (0..=400).map(move |k| (l * h, k)))
    {
        // Away from the walls, where none of the particles reaches beyond.
        let x = vector![1.5 + 2.0 * f64::from(k) / 400.0];
        for (node, (value, slope)) in over(&Gimp, &grid, &x, &SMatrix::from([[l / 2.0]]))
            .iter()
            .enumerate()
        {
            let (right, right_slope) = closed_form(x[0] - (1.0 + h * node as f64), l, h);
            assert!((value - right).abs() < 1e-14, "{x} {l} {node}: {value} {right}");
            // A branch's end belongs to both branches: round-off of the place counts by the bend there.
            let allowed = 1e-14 / (h * l);
            let slope = slope[0];
            assert!(
                (slope - right_slope).abs() < allowed,
                "{x} {l} {node}: {slope} {right_slope}"
            );
        }
    }
}

/// In the plane the product of both, each with its own length.
#[test]
fn so_are_the_products_in_the_plane() {
    let grid = Grid::new(vector![0.0, 0.0], vector![3.0, 8.0], [6, 4]).unwrap();
    let (h, l) = ([0.5, 2.0], [0.3, 1.7]);
    for k in 0..200 {
        let x = vector![0.5 + f64::from(k * 37 % 200) / 100.0, 2.0 + f64::from(k) / 50.0];
        let domain = SMatrix::from_diagonal(&vector![l[0] / 2.0, l[1] / 2.0]);
        for (node, (value, gradient)) in over(&Gimp, &grid, &x, &domain).iter().enumerate() {
            let place = [node % 7, node / 7];
            let [(a, da), (b, db)] =
                [0, 1].map(|axis| closed_form(x[axis] - h[axis] * place[axis] as f64, l[axis], h[axis]));
            assert!((value - a * b).abs() < 1e-14, "{x} {node}");
            assert!((gradient - vector![da * b, a * db]).norm() < 1e-12, "{x} {node}");
        }
    }
}

/// At a wall the functions of the end cell go on: at the wall, and wherever a particle lies in that cell with
/// its inner half, they are the linear ones.
#[test]
fn at_a_wall_they_are_linear() {
    let grid = Grid::new(vector![0.0], vector![3.0], [3]).unwrap();
    for (half, x) in [
        (0.5, 0.0),
        (0.5, 0.3),
        (0.25, 0.7),
        (0.5, 2.5),
        (0.5, 3.0),
        (0.1, 2.99),
    ] {
        let found = over(&Gimp, &grid, &vector![x], &SMatrix::from([[half]]));
        let mut linear = [(0.0, 0.0); 4];
        let cell = grid.locate(&vector![x]).unwrap();
        Linear.for_each(&grid, &cell, &vector![x], |dof, value, slope: SVector<f64, 1>| {
            linear[dof] = (value, slope[0]);
        });
        for ((value, slope), (right, right_slope)) in found.iter().zip(linear) {
            assert!(
                (value - right).abs() < 1e-15 && (slope[0] - right_slope).abs() < 1e-14,
                "{half} {x}"
            );
        }
    }
}

/// Points on edges, beside them and between, in a grid of so many cells that does not begin at zero.
fn check<T: Scalar, const D: usize>(basis: &impl BasisFamily<T, D>, cells: [usize; D]) {
    let min = SVector::from_fn(|a, _| T::lit(-0.5 - 0.25 * a as f64));
    let max = SVector::from_fn(|a, _| min[a] + T::lit((1 + a) as f64 * 0.5 * cells[a] as f64));
    let grid = Grid::new(min, max, cells).unwrap();
    let shares = [0.0, 0.02, 0.3, 0.5, 0.77, 0.98, 1.0];
    let points: Vec<_> = (0..40)
        .map(|k| {
            SVector::from_fn(|a, _| {
                let cell = (k * (a + 3) / 2) % cells[a];
                let share = shares[(k + a * (k / 7 + 1)) % shares.len()];
                let place = (cell as f64 + share) / cells[a] as f64;
                min[a] + (max[a] - min[a]) * T::lit(place)
            })
        })
        .collect();
    check_basis(basis, &grid, &points, &BasisClaims::of_degree(1)).unwrap();
}

#[test]
fn gimp_keeps_what_a_basis_promises() {
    for cells in 1..7 {
        check::<f64, 1>(&Gimp, [cells]);
        check::<f32, 1>(&Gimp, [cells]);
    }
    for cells in [[1, 1], [2, 3], [5, 4], [3, 6]] {
        check::<f64, 2>(&Gimp, cells);
    }
    check::<f64, 3>(&Gimp, [3, 2, 4]);
    check::<f64, 3>(&Gimp, [1, 5, 3]);
}

/// The stencils of end cells lie on one side of them: the numbers of their DOFs do not grow with their own.
#[test]
fn a_window_holds_the_dofs_of_every_cell_between() {
    let grid = Grid::new(vector![0.0, 0.0, 0.0], vector![3.0, 4.0, 3.0], [3, 4, 3]).unwrap();
    let dofs_of = |cell: &Cell<3>| {
        let (mut low, mut high) = (usize::MAX, 0);
        Gimp.for_each(&grid, cell, &grid.centre(cell), |dof, _, _| {
            (low, high) = (low.min(dof), high.max(dof));
        });
        (low, high)
    };
    let all: Vec<_> = (0..36).map(|number| dofs_of(&grid.cell(number))).collect();
    for (first, last) in (0..36).flat_map(|first| (first..36).map(move |last| (first, last))) {
        let window = Gimp.dof_window(&grid, &grid.cell(first), &grid.cell(last));
        for (low, high) in &all[first..=last] {
            assert!(window.contains(low) && window.contains(high), "{first} to {last}");
        }
    }
}

/// What a basis can do wrong over domains and right at points.
#[derive(Clone, Copy, Debug)]
enum Mistake {
    /// Values do not sum to one.
    Sum,
    /// Slopes are those of particles half as long.
    Slope,
    /// Particles are longer than they are.
    Longer,
    /// Particles in every other cell are shorter than they are.
    Jump,
    /// Boxes are cut off at the walls.
    CutOff,
}

#[derive(Clone, Copy, Debug)]
struct Faulty(Mistake);

impl<T: Scalar> AxisBasis<T, 4> for Faulty {
    const DOMAIN: Domain = Domain::Size { most: 0.5 };

    fn dofs_on_axis(&self, cells: usize) -> usize {
        cells + 1
    }

    fn first_dof(&self, at: AxisCell) -> usize {
        AxisBasis::<T, 4>::first_dof(&Gimp, at)
    }

    fn evaluate<K: Lanes<T>>(&self, k: K, at: AxisCell, u: K::V) -> Functions<K::V, 4> {
        Gimp.evaluate(k, at, u)
    }

    fn evaluate_over<K: Lanes<T>>(&self, k: K, at: AxisCell, u: K::V, l: K::V) -> Functions<K::V, 4> {
        let half = k.splat(T::lit(0.5));
        let mut right = Gimp.evaluate_over(k, at, u, l);
        match self.0 {
            Mistake::Sum => right.value[1] = right.value[1] + l * l,
            Mistake::Slope => right.slope = Gimp.evaluate_over(k, at, u, l * half).slope,
            Mistake::Longer => right = Gimp.evaluate_over(k, at, u, l + k.splat(T::lit(0.1))),
            Mistake::Jump if at.cell % 2 == 1 => right = Gimp.evaluate_over(k, at, u, l * half),
            Mistake::CutOff if at.cell == 0 => {
                // What is left lies about another centre.
                let less = (l - u) * (l - u).above(k.splat(T::zero())) * half;
                right = Gimp.evaluate_over(k, at, u + less, l - less);
            }
            _ => {}
        }
        right
    }
}

materialpoint::tensor_product_family!(Faulty, width = 4, degree = 1);

#[test]
fn mistakes_over_domains_are_found() {
    let grid = Grid::new(vector![0.0], vector![5.0], [5]).unwrap();
    let points: Vec<_> = (0..=50).map(|k| vector![f64::from(k) / 10.0]).collect();
    for (mistake, property) in [
        (Mistake::Sum, Property::PartitionOfUnity),
        (Mistake::Slope, Property::GradientsAreDerivatives),
        (Mistake::Longer, Property::VanishingDomain),
        (Mistake::Jump, Property::Continuous),
        (Mistake::CutOff, Property::Reproduces(1)),
    ] {
        let found = check_basis(&Faulty(mistake), &grid, &points, &BasisClaims::of_degree(1));
        assert_eq!(found.unwrap_err().property, property, "{mistake:?}");
    }
}
