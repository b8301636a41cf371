//! Conjugate gradients over the contacts that are free to change, between sweeps.
//!
//! Where particles hardly resist an alternating motion of the DOFs at a wall, the operator is next to
//! singular, and what sweeps leave falls like one over their number. Once sweeps have found which contacts
//! press (or stick), the velocities of those are a linear problem, which conjugate gradients solve in as many
//! steps as it has distinct eigenvalues. The step is cut where the first contact would pull (or slip), so the
//! energy falls in it as it does in a sweep.

use nalgebra::SVector;

use super::delassus::Delassus;
use super::wall::WallDofs;
use crate::scalar::Scalar;

/// Vectors over the DOFs on walls, by component; components of contacts that are not free are zero in all but
/// the products.
#[derive(Clone, Debug)]
pub(super) struct Subspace<T, const D: usize> {
    /// One for components that are free, zero for others.
    pub(super) free: Vec<SVector<T, D>>,
    residual: Vec<SVector<T, D>>,
    direction: Vec<SVector<T, D>>,
    product: Vec<SVector<T, D>>,
    /// Change of the impulses (N s), and what it adds to the velocities (m/s).
    pub(super) step: Vec<SVector<T, D>>,
    pub(super) response: Vec<SVector<T, D>>,
}

impl<T: Scalar, const D: usize> Subspace<T, D> {
    pub(super) fn none() -> Self {
        Self {
            free: Vec::new(),
            residual: Vec::new(),
            direction: Vec::new(),
            product: Vec::new(),
            step: Vec::new(),
            response: Vec::new(),
        }
    }

    /// Makes room for so many DOFs.
    pub(super) fn lay(&mut self, places: usize) {
        for vector in self.vectors() {
            vector.clear();
            vector.resize(places, SVector::zeros());
        }
    }

    /// No contact is free.
    pub(super) fn clear(&mut self) {
        for vector in self.vectors() {
            vector.fill(SVector::zeros());
        }
    }

    fn vectors(&mut self) -> [&mut Vec<SVector<T, D>>; 6] {
        [
            &mut self.free,
            &mut self.residual,
            &mut self.direction,
            &mut self.product,
            &mut self.step,
            &mut self.response,
        ]
    }

    pub(super) fn bytes(&self) -> usize {
        let vectors = [
            &self.free,
            &self.residual,
            &self.direction,
            &self.product,
            &self.step,
            &self.response,
        ];
        size_of::<SVector<T, D>>() * vectors.map(Vec::capacity).iter().sum::<usize>()
    }

    /// Finds the step after which the free components of `velocity`, relative to walls that move with `wall`,
    /// are at most `least` (m/s), as far as `left` iterations lead, of which it takes those that it needs.
    pub(super) fn solve(
        &mut self,
        (dofs, delassus): (&WallDofs<T, D>, &Delassus<T, D>),
        velocity: &[SVector<T, D>],
        wall: impl Fn(usize) -> SVector<T, D>,
        least: T,
        left: &mut usize,
    ) {
        for (place, residual) in self.residual.iter_mut().enumerate() {
            *residual = (wall(place) - velocity[place]).component_mul(&self.free[place]);
        }
        let mut size = self.scaled_residual(delassus);
        for (direction, residual) in self.direction.iter_mut().zip(&self.residual) {
            *direction = *residual;
        }
        self.scale_direction(delassus);
        while *left > 0 && size > T::zero() {
            *left -= 1;
            self.multiply(dofs, delassus);
            let curvature = dot(&self.direction, &self.product);
            // Round-off of an operator that is singular.
            if curvature <= T::zero() {
                return;
            }
            let length = size / curvature;
            let mut largest = T::zero();
            for place in 0..self.step.len() {
                self.step[place] += self.direction[place] * length;
                self.response[place] += self.product[place] * length;
                let change = self.product[place].component_mul(&self.free[place]) * length;
                self.residual[place] -= change;
                largest = largest.max(self.residual[place].amax());
            }
            if largest <= least {
                return;
            }
            let before = std::mem::replace(&mut size, self.scaled_residual(delassus));
            let ratio = size / before;
            for place in 0..self.direction.len() {
                let own = scaled(&self.residual[place], &delassus.diagonal[place]);
                self.direction[place] = own + self.direction[place] * ratio;
            }
        }
    }

    /// The residual's square in the norm of the inverse diagonal.
    fn scaled_residual(&self, delassus: &Delassus<T, D>) -> T {
        let residuals = self.residual.iter().zip(&delassus.diagonal);
        residuals.fold(T::zero(), |sum, (residual, diagonal)| {
            sum + residual.dot(&scaled(residual, diagonal))
        })
    }

    fn scale_direction(&mut self, delassus: &Delassus<T, D>) {
        for (direction, diagonal) in self.direction.iter_mut().zip(&delassus.diagonal) {
            *direction = scaled(direction, diagonal);
        }
    }

    /// What the direction adds to the velocities.
    fn multiply(&mut self, dofs: &WallDofs<T, D>, delassus: &Delassus<T, D>) {
        self.product.fill(SVector::zeros());
        for (place, direction) in self.direction.iter().enumerate() {
            if direction.iter().all(|&part| part == T::zero()) {
                continue;
            }
            for k in dofs.row(place) {
                let there = dofs.neighbours()[k] as usize;
                self.product[there] += delassus.entries[k].component_mul(direction);
            }
        }
    }
}

/// A vector over the diagonal; nothing where that is none.
fn scaled<T: Scalar, const D: usize>(vector: &SVector<T, D>, diagonal: &SVector<T, D>) -> SVector<T, D> {
    vector.zip_map(
        diagonal,
        |part, own| if own > T::zero() { part / own } else { T::zero() },
    )
}

fn dot<T: Scalar, const D: usize>(a: &[SVector<T, D>], b: &[SVector<T, D>]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (a, b)| sum + a.dot(b))
}
