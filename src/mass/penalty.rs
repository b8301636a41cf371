//! The ghost penalty.

use super::jumps::AxisJumps;
use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;

/// Jumps of the highest derivative across faces of cells, squared and added to a matrix of masses.
///
/// A function that only the few particles of a partly filled cell see has next to no mass: what is divided by
/// it is magnified. Lumping such functions cures that and costs angular momentum. Instead (Burman 2010,
/// "Ghost penalty"; Sticko & Kreiss 2016 for mass matrices) the field in that cell is tied to the polynomial
/// in the next one. With $w_F$ a mass,
///
/// $$J(u, v) = \sum_F w_F\sum_j [h^p\partial_n^p u]_j\,[h^p\partial_n^p v]_j,$$
///
/// $F$ the faces that were named, $n$ their normal, $j$ the functions along the face. It vanishes if one of
/// $u$, $v$ is a polynomial of the basis's degree, so that neither sums (momentum) nor moments (angular
/// momentum) of a product with the matrix know of it.
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Debug)]
pub struct Penalty<T, const D: usize> {
    jumps: [AxisJumps<T>; D],
    shape: [usize; D],
    strides: [usize; D],
    /// For each axis, line between its cells and functions along the face the place of its form, [`NONE`]
    /// without one.
    places: [Vec<u32>; D],
    forms: [Vec<Form<T>>; D],
}

const NONE: u32 = u32::MAX;

/// A jump that is squared.
#[derive(Clone, Copy, Debug)]
struct Form<T> {
    /// Its first DOF.
    dof: u32,
    /// The cell below it along the axis.
    cell: u32,
    /// In [`Penalty::places`].
    slot: u32,
    weight: T,
}

impl<T: Scalar, const D: usize> Penalty<T, D> {
    /// For the DOFs of `basis` in the grid's window.
    #[inline(never)]
    pub fn new<B: BasisFamily<T, D>>(basis: &B, grid: &Grid<T, D>) -> Self {
        let shape = basis.dofs(grid);
        let jumps: [AxisJumps<T>; D] = std::array::from_fn(|axis| AxisJumps::new(basis, grid, axis));
        let slots: [usize; D] = std::array::from_fn(|axis| {
            let across = (0..D).filter(|&other| other != axis).map(|other| shape[other]);
            jumps[axis].lines() * across.product::<usize>()
        });
        Self {
            jumps,
            shape,
            strides: std::array::from_fn(|axis| shape[..axis].iter().product()),
            places: slots.map(|slots| vec![NONE; slots]),
            forms: slots.map(Vec::with_capacity),
        }
    }

    /// Of no DOF.
    pub fn none() -> Self {
        Self {
            jumps: std::array::from_fn(|_| AxisJumps::none()),
            shape: [0; D],
            strides: [0; D],
            places: std::array::from_fn(|_| Vec::new()),
            forms: std::array::from_fn(|_| Vec::new()),
        }
    }

    /// Bytes allocated.
    pub fn bytes(&self) -> usize {
        let of_axis = |axis: usize| {
            self.jumps[axis].bytes()
                + size_of::<u32>() * self.places[axis].capacity()
                + size_of::<Form<T>>() * self.forms[axis].capacity()
        };
        (0..D).map(of_axis).sum()
    }

    /// Forgets every face.
    pub fn clear(&mut self) {
        for (places, forms) in self.places.iter_mut().zip(&mut self.forms) {
            for form in forms.drain(..) {
                places[form.slot as usize] = NONE;
            }
        }
    }

    /// Adds the face above `cell` along `axis`, with a mass.
    pub fn add_face(&mut self, grid: &Grid<T, D>, cell: &Cell<D>, axis: usize, mass: T) {
        let start = grid.window().first();
        let place: [usize; D] = std::array::from_fn(|a| (cell[a] - start[a]) as usize);
        let first: [usize; D] = std::array::from_fn(|a| self.jumps[a].first(place[a]));
        let across = (0..D).filter(|&a| a != axis);
        let count: usize = across.clone().map(|a| self.jumps[a].seen(place[a])).product();
        for mut number in 0..count {
            let (mut dof, mut slot) = (first[axis] * self.strides[axis], 0);
            let mut stride = 1;
            for a in across.clone() {
                let seen = self.jumps[a].seen(place[a]);
                let along = first[a] + number % seen;
                number /= seen;
                dof += along * self.strides[a];
                slot += along * stride;
                stride *= self.shape[a];
            }
            slot += place[axis] * stride;
            self.add_form(axis, dof, place[axis], slot, mass);
        }
    }

    fn add_form(&mut self, axis: usize, dof: usize, cell: usize, slot: usize, weight: T) {
        let (place, forms) = (&mut self.places[axis][slot], &mut self.forms[axis]);
        if let Some(form) = forms.get_mut(*place as usize) {
            form.weight += weight;
            return;
        }
        *place = forms.len() as u32;
        forms.push(Form {
            dof: dof as u32,
            cell: cell as u32,
            slot: slot as u32,
            weight,
        });
    }

    /// Calls `f(weight, first, stride, coefficients)` for each form.
    #[inline(always)]
    fn for_each_form(&self, mut f: impl FnMut(T, usize, usize, &[T])) {
        for axis in 0..D {
            for form in &self.forms[axis] {
                let coefficients = self.jumps[axis].above(form.cell as usize);
                f(form.weight, form.dof as usize, self.strides[axis], coefficients);
            }
        }
    }

    /// Adds the diagonal.
    pub fn add_diagonal(&self, diagonal: &mut [T]) {
        self.for_each_form(|weight, first, stride, coefficients| {
            for (k, &c) in coefficients.iter().enumerate() {
                diagonal[first + k * stride] += weight * c * c;
            }
        });
    }

    /// `y += J x`.
    pub fn add_product(&self, x: &[T], y: &mut [T]) {
        self.for_each_form(|weight, first, stride, coefficients| {
            let terms = coefficients.iter().enumerate();
            let jump = terms
                .clone()
                .fold(T::zero(), |sum, (k, &c)| sum + c * x[first + k * stride]);
            let weighted = weight * jump;
            terms.for_each(|(k, &c)| y[first + k * stride] += weighted * c);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{BSpline, DualDomain, Linear};
    use approx::assert_relative_eq;
    use nalgebra::{SVector, vector};

    /// Coefficients whose function is the polynomial with these values: for a basis of degree 2 the blossom,
    /// for others the values at the nodes.
    fn coefficients<B: BasisFamily<f64, 2>>(
        basis: &B,
        grid: &Grid<f64, 2>,
        f: impl Fn(f64, f64) -> f64,
    ) -> Vec<f64> {
        let count = basis.dof_count(grid);
        // Least squares through many points: exact for what the basis holds.
        let (mut matrix, mut right) = (
            nalgebra::DMatrix::zeros(count, count),
            nalgebra::DVector::zeros(count),
        );
        for (x, _) in crate::particles::lattice(grid, grid.min(), grid.max(), [4; 2]) {
            let cell = grid.locate(&x).unwrap();
            basis.for_each_at_fixed_point(grid, &cell, &x, |i, a, _| {
                right[i] += a * f(x[0], x[1]);
                basis.for_each_at_fixed_point(grid, &cell, &x, |j, b, _| matrix[(i, j)] += a * b);
            });
        }
        matrix.lu().solve(&right).unwrap().iter().copied().collect()
    }

    fn all_faces<B: BasisFamily<f64, 2>>(basis: &B, grid: &Grid<f64, 2>) -> Penalty<f64, 2> {
        let mut penalty = Penalty::new(basis, grid);
        let [nx, ny] = grid.cells();
        for i in 0..nx as u32 {
            for j in 0..ny as u32 {
                if i + 1 < nx as u32 {
                    penalty.add_face(grid, &[i, j], 0, 1.0);
                }
                if j + 1 < ny as u32 {
                    penalty.add_face(grid, &[i, j], 1, 0.5);
                }
            }
        }
        penalty
    }

    fn grid() -> Grid<f64, 2> {
        Grid::new(vector![0.0, -1.0], vector![1.5, 1.0], [6, 5]).unwrap()
    }

    fn check<B: BasisFamily<f64, 2>>(basis: &B, polynomial: impl Fn(f64, f64) -> f64) {
        let grid = grid();
        let penalty = all_faces(basis, &grid);
        let x = coefficients(basis, &grid, polynomial);
        let mut y = vec![0.0; x.len()];
        penalty.add_product(&x, &mut y);
        let largest = y.iter().fold(0.0, |m: f64, y| m.max(y.abs()));
        // The coefficients are solved for, to ten digits or so.
        assert!(largest < 1e-9, "{largest:e}");
        // Another function is seen, and costs energy.
        let x: Vec<f64> = (0..x.len()).map(|i| (i * i % 7) as f64).collect();
        y.fill(0.0);
        penalty.add_product(&x, &mut y);
        assert!(x.iter().zip(&y).map(|(x, y)| x * y).sum::<f64>() > 1.0);
        assert_relative_eq!(y.iter().sum::<f64>(), 0.0, epsilon = 1e-10);
    }

    #[test]
    fn polynomials_do_not_feel_it_and_sums_are_kept() {
        check(&Linear, |x, y| 1.0 - 2.0 * x + y + 3.0 * x * y);
        check(&DualDomain::default(), |x, y| 0.5 + x - y);
        check(&BSpline::<2>, |x, y| 1.0 - x * x + 2.0 * x * y * y + y);
        check(&BSpline::<3>, |x, y| x * x * x * y - y * y * y + x);
    }

    #[test]
    fn the_diagonal_is_that_of_the_product_and_faces_are_forgotten() {
        let (basis, grid) = (BSpline::<2>, grid());
        let mut penalty = Penalty::new(&basis, &grid);
        penalty.add_face(&grid, &[2, 1], 0, 2.0);
        penalty.add_face(&grid, &[2, 2], 0, 1.0);
        penalty.add_face(&grid, &[3, 1], 1, 3.0);
        let count = basis.dof_count(&grid);
        let mut diagonal = vec![0.0; count];
        penalty.add_diagonal(&mut diagonal);
        for i in 0..count {
            let (mut unit, mut column) = (vec![0.0; count], vec![0.0; count]);
            unit[i] = 1.0;
            penalty.add_product(&unit, &mut column);
            assert_relative_eq!(column[i], diagonal[i], epsilon = 1e-12);
        }
        penalty.clear();
        let mut nothing = vec![0.0; count];
        penalty.add_diagonal(&mut nothing);
        assert!(nothing.iter().all(|&x| x == 0.0));
    }

    /// A window of the grid numbers other DOFs, the jump is the same.
    #[test]
    fn a_window_changes_nothing() {
        let basis = BSpline::<2>;
        let whole = Grid::new(vector![0.0, 0.0], vector![20.0, 20.0], [20, 20]).unwrap();
        let part = whole
            .clone()
            .with_window(crate::grid::Window::new([5, 7], [6, 5]));
        let energy = |grid: &Grid<f64, 2>| {
            let mut penalty = Penalty::new(&basis, grid);
            penalty.add_face(grid, &[7, 9], 0, 1.0);
            penalty.add_face(grid, &[8, 8], 1, 1.0);
            let x: Vec<f64> = (0..basis.dof_count(grid))
                .map(|dof| {
                    let x: SVector<f64, 2> = basis.interpolation_point(grid, dof);
                    (x[0] * 1.3).sin() + (x[0] * x[1]).cos()
                })
                .collect();
            let mut y = vec![0.0; x.len()];
            penalty.add_product(&x, &mut y);
            x.iter().zip(&y).map(|(x, y)| x * y).sum::<f64>()
        };
        assert_relative_eq!(energy(&whole), energy(&part), max_relative = 1e-12);
    }
}
