//! Linear functions of free bodies, as the consistent matrix has them.
//!
//! A turning body's velocities are linear in space, and so is the work of a moment on them. A lumped mass, or
//! some terms of a series ([`super::series`]), are wrong for them at free sides, and angular momentum is lost.
//! With the columns $X$ of the places of a body's DOFs about its centre of mass and $q = X^T M X$, its second
//! moments of mass, the matrix
//!
//! $$N = X q^{-1} X^T + (1 - X q^{-1} X^T M)\, N_k\, (1 - M X q^{-1} X^T)$$
//!
//! is symmetric like $N_k$, and $X^T M N = X^T$: all components of the velocity take the same one, so that the
//! moment of all forces is the change of the angular momentum to round-off. A body is what shares DOFs; one
//! that a wall holds is left alone, and so is one whose particles lie in a point or, beyond one axis, on a
//! line.

use nalgebra::{SMatrix, SVector};

use crate::basis::BasisFamily;
use crate::grid::Grid;
use crate::particles::Bins;
use crate::scalar::Scalar;
use crate::tensor::determinant;
use crate::transfer::DofPlaces;

const NONE: u32 = u32::MAX;
/// Smallest determinant of the second moments, over the power of their trace, of a body that is deflated.
const FLAT: f64 = 1e-6;

/// The bodies of a step, and what is linear in them.
#[derive(Clone, Debug)]
pub(super) struct Deflation<T, const D: usize> {
    /// Number of the body of each DOF; while DOFs are joined, a DOF of the same body with a lower number, or
    /// itself.
    body: Vec<u32>,
    /// Numbers of bodies by their first DOFs.
    numbers: Vec<u32>,
    /// Places of the DOFs about the centre of mass of their body (m).
    places: Vec<SVector<T, D>>,
    /// The matrix times these (kg m).
    products: Vec<SVector<T, D>>,
    column: Vec<T>,
    product: Vec<T>,
    bodies: Vec<Body<T, D>>,
}

#[derive(Clone, Debug)]
struct Body<T, const D: usize> {
    mass: T,
    /// Sum of masses times places.
    moment: SVector<T, D>,
    /// Second moments of mass, and one over them; zero for a body that is left alone.
    moments: SMatrix<T, D, D>,
    inverse: SMatrix<T, D, D>,
    /// Slopes of the exact linear part, and sums for others.
    slopes: SVector<T, D>,
    sums: SVector<T, D>,
    held: bool,
}

impl<T: Scalar, const D: usize> Deflation<T, D> {
    /// With room for so many DOFs.
    pub(super) fn new(dofs: usize) -> Self {
        Self {
            body: vec![NONE; dofs],
            numbers: vec![NONE; dofs],
            places: vec![SVector::zeros(); dofs],
            products: vec![SVector::zeros(); dofs],
            column: vec![T::zero(); dofs],
            product: vec![T::zero(); dofs],
            bodies: Vec::with_capacity(dofs),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        let each = 2 * size_of::<u32>() + 2 * size_of::<SVector<T, D>>() + 2 * size_of::<T>();
        each * self.body.len() + size_of::<Body<T, D>>() * self.bodies.capacity()
    }

    /// Finds the bodies of the occupied cells, and where the DOFs lie in them.
    #[inline(never)]
    pub(super) fn find_bodies<B: BasisFamily<T, D>>(
        &mut self,
        (basis, grid, bins): (&B, &Grid<T, D>, &Bins<D>),
        dof_places: &DofPlaces<T, D>,
        masses: &[T],
    ) {
        self.body.fill(NONE);
        for &cell in bins.occupied() {
            let cell = grid.cell(cell as usize);
            let centre = grid.centre(&cell);
            let mut root = NONE;
            basis.for_each_at_fixed_point(grid, &cell, &centre, |dof, _, _| {
                if masses[dof] > T::zero() {
                    root = join(&mut self.body, dof as u32, root);
                }
            });
        }
        self.number_bodies();
        let first = grid.window().first();
        let corner = SVector::from_fn(|a, _| grid.edge(a, first[a] as usize));
        for (dof, (&body, &mass)) in self.body.iter().zip(masses).enumerate() {
            if let Some(body) = self.bodies.get_mut(body as usize) {
                let place = dof_places.offset(grid, dof, (&first, &corner));
                self.places[dof] = place;
                body.mass += mass;
                body.moment += place * mass;
            }
        }
        for (&body, place) in self.body.iter().zip(&mut self.places) {
            match self.bodies.get(body as usize) {
                Some(body) => *place -= body.moment / body.mass,
                None => *place = SVector::zeros(),
            }
        }
    }

    /// Numbers the bodies in the order of their first DOFs, which all others come to point at.
    fn number_bodies(&mut self) {
        self.bodies.clear();
        for dof in 0..self.body.len() {
            if self.body[dof] == NONE {
                continue;
            }
            let root = find(&mut self.body, dof as u32) as usize;
            if root == dof {
                self.numbers[dof] = self.bodies.len() as u32;
                self.bodies.push(Body::new());
            }
            self.numbers[dof] = self.numbers[root];
        }
        for (body, &number) in self.body.iter_mut().zip(&self.numbers) {
            if *body != NONE {
                *body = number;
            }
        }
    }

    /// Leaves alone the body of a DOF that is held.
    pub(super) fn hold(&mut self, dof: usize) {
        if let Some(body) = self.bodies.get_mut(self.body[dof] as usize) {
            body.held = true;
        }
    }

    /// Takes in the matrix by its products.
    pub(super) fn prepare(&mut self, multiply: &mut dyn FnMut(&[T], &mut [T])) {
        if self.bodies.iter().all(|body| body.held) {
            return;
        }
        for axis in 0..D {
            for (column, place) in self.column.iter_mut().zip(&self.places) {
                *column = place[axis];
            }
            multiply(&self.column, &mut self.product);
            for (products, &product) in self.products.iter_mut().zip(&self.product) {
                products[axis] = product;
            }
        }
        for (&body, (place, product)) in self.body.iter().zip(self.places.iter().zip(&self.products)) {
            if let Some(body) = self.bodies.get_mut(body as usize) {
                body.moments += place * product.transpose();
            }
        }
        for body in self.bodies.iter_mut().filter(|body| !body.held) {
            let trace = body.moments.trace();
            let flat = (0..D).fold(T::lit(FLAT), |product, _| product * trace);
            if determinant(&body.moments) > flat {
                body.inverse = inverse(&body.moments);
            }
        }
    }

    /// Takes the linear part out of a component of the right side: slopes `q^-1 X^T right`, to be put back.
    pub(super) fn take_out(&mut self, right: &mut [T]) {
        self.sum(right, true);
        for ((&body, product), right) in self.body.iter().zip(&self.products).zip(right) {
            if let Some(body) = self.bodies.get_mut(body as usize) {
                body.slopes = body.sums;
                *right -= product.dot(&body.sums);
            }
        }
    }

    /// Gives the solution for the rest the linear part that the matrix says, in place of its own.
    pub(super) fn put_back(&mut self, solution: &mut [T]) {
        self.sum(solution, false);
        for ((&body, place), solution) in self.body.iter().zip(&self.places).zip(solution) {
            if let Some(body) = self.bodies.get(body as usize) {
                *solution += place.dot(&(body.slopes - body.sums));
            }
        }
    }

    /// Sums over the DOFs of each body, `q^-1 X^T values` or `q^-1 X^T M values`.
    fn sum(&mut self, values: &[T], of_places: bool) {
        let columns = if of_places { &self.places } else { &self.products };
        for body in &mut self.bodies {
            body.sums = SVector::zeros();
        }
        for ((&body, column), &value) in self.body.iter().zip(columns).zip(values) {
            if let Some(body) = self.bodies.get_mut(body as usize) {
                body.sums += column * value;
            }
        }
        for body in &mut self.bodies {
            body.sums = body.inverse * body.sums;
        }
    }
}

impl<T: Scalar, const D: usize> Body<T, D> {
    fn new() -> Self {
        Self {
            mass: T::zero(),
            moment: SVector::zeros(),
            moments: SMatrix::zeros(),
            inverse: SMatrix::zeros(),
            slopes: SVector::zeros(),
            sums: SVector::zeros(),
            held: false,
        }
    }
}

/// Joins a DOF to the body with that first DOF, if there is one; returns the first DOF of both. It has the
/// lowest number, so that the bodies do not hang on the order of the cells.
fn join(body: &mut [u32], dof: u32, with: u32) -> u32 {
    if body[dof as usize] == NONE {
        body[dof as usize] = dof;
    }
    let own = find(body, dof);
    let first = own.min(with);
    body[own as usize] = first;
    if with != NONE {
        body[with as usize] = first;
    }
    first
}

/// The first DOF of the body of `dof`; the way there is halved.
fn find(body: &mut [u32], mut dof: u32) -> u32 {
    while body[dof as usize] != dof {
        let above = body[body[dof as usize] as usize];
        body[dof as usize] = above;
        dof = above;
    }
    dof
}

/// The inverse of a positive definite matrix (Gauss and Jordan, who need no pivots then).
fn inverse<T: Scalar, const D: usize>(matrix: &SMatrix<T, D, D>) -> SMatrix<T, D, D> {
    let (mut left, mut right) = (*matrix, SMatrix::<T, D, D>::identity());
    for i in 0..D {
        let pivot = left[(i, i)];
        for j in 0..D {
            left[(i, j)] /= pivot;
            right[(i, j)] /= pivot;
        }
        for k in (0..D).filter(|&k| k != i) {
            let factor = left[(k, i)];
            for j in 0..D {
                let (of_left, of_right) = (left[(i, j)], right[(i, j)]);
                left[(k, j)] -= factor * of_left;
                right[(k, j)] -= factor * of_right;
            }
        }
    }
    right
}

#[cfg(test)]
mod tests {
    use nalgebra::{SMatrix, matrix};

    use super::{NONE, find, inverse, join};

    #[test]
    fn the_inverse_of_second_moments_is_one_over_them() {
        let moments = matrix![4.0, 1.0, 0.5; 1.0, 3.0, 0.2; 0.5, 0.2, 2.0];
        let product: SMatrix<f64, 3, 3> = moments * inverse(&moments);
        assert!((product - SMatrix::identity()).norm() < 1e-15, "{product}");
    }

    #[test]
    fn dofs_that_cells_share_are_of_one_body_in_any_order() {
        for cells in [[[0, 1], [3, 4], [1, 2]], [[1, 2], [0, 1], [3, 4]]] {
            let mut body = [NONE; 6];
            for cell in cells {
                cell.into_iter()
                    .fold(NONE, |root, dof| join(&mut body, dof, root));
            }
            let first: Vec<u32> = (0..5).map(|dof| find(&mut body, dof)).collect();
            assert_eq!(first, [0, 0, 0, 3, 3]);
            assert_eq!(body[5], NONE);
        }
    }
}
