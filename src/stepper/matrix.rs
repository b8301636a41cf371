//! The consistent mass matrix.

use nalgebra::SVector;

use super::acceleration::Walls;
use super::dofs::Dofs;
use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::mass::{Banded, ConjugateGradients, Divisor, Lattice, Penalty};
use crate::scalar::Scalar;

/// What is solved for, in place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unknown {
    /// From forces.
    Acceleration,
    /// From momenta.
    Velocity,
}

/// In one dimension a band that is factorised, beyond the diagonals of a lattice that are iterated with:
/// there a band would hold whole rows of the lattice.
#[derive(Clone, Debug)]
pub(super) struct MassMatrix<T, const D: usize> {
    band: Banded<T>,
    factor: Banded<T>,
    lattice: Lattice<T>,
    penalty: Penalty<T, D>,
    gradients: ConjugateGradients<T, D>,
}

impl<T: Scalar, const D: usize> MassMatrix<T, D> {
    /// Of no DOF.
    pub(super) fn none() -> Self {
        Self {
            band: Banded::zeros(0, 0),
            factor: Banded::zeros(0, 0),
            lattice: Lattice::none(),
            penalty: Penalty::none(),
            gradients: ConjugateGradients::none(),
        }
    }

    /// Of the DOFs of `basis`, which may be tied where material ends.
    #[inline(never)]
    pub(super) fn new<B: BasisFamily<T, D>>(basis: &B, grid: &Grid<T, D>, ties: bool) -> Self {
        let none = Self::none();
        if const { D == 1 } {
            let band = Banded::zeros(basis.dof_count(grid), basis.half_band(grid));
            Self {
                factor: band.clone(),
                band,
                ..none
            }
        } else {
            Self {
                lattice: Lattice::zeros(basis.dofs(grid), basis.reach()),
                penalty: if ties {
                    Penalty::new(basis, grid)
                } else {
                    none.penalty
                },
                gradients: ConjugateGradients::new(basis, grid),
                ..none
            }
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<T>() * 2 * self.band.len()
            + self.lattice.bytes()
            + self.penalty.bytes()
            + self.gradients.bytes()
    }

    /// The band of one dimension, to be filled.
    pub(super) fn band_mut(&mut self) -> &mut Banded<T> {
        &mut self.band
    }

    /// The band of one dimension, as it was filled.
    pub(super) fn band(&self) -> &Banded<T> {
        &self.band
    }

    pub(super) fn clear(&mut self) {
        self.band.clear();
        self.lattice.clear();
        self.penalty.clear();
    }

    /// Adds to the entry `(i, j)` of the lower half; the upper one, `i < j`, is the same and left out.
    #[inline(always)]
    pub(super) fn add(&mut self, i: usize, j: usize, value: T) {
        if const { D == 1 } {
            self.band.add(i, j, value);
        } else if j <= i {
            self.lattice.add(i, j, value);
        }
    }

    /// Ties the functions on both sides of the face above `cell` along `axis`, beyond one dimension.
    pub(super) fn tie(&mut self, grid: &Grid<T, D>, cell: &Cell<D>, axis: usize, mass: T) {
        self.penalty.add_face(grid, cell, axis, mass);
    }

    /// Lumps the row of a DOF.
    pub(super) fn lump(&mut self, dof: usize) {
        if const { D == 1 } {
            self.band.lump(dof);
        } else {
            self.lattice.lump(dof);
        }
    }

    /// Takes the sums as complete. In one dimension rows whose diagonal holds less than the share `weak` of
    /// their sum are lumped, if told so.
    #[inline(never)]
    pub(super) fn complete(&mut self, weak: Option<T>) {
        if const { D > 1 } {
            self.gradients.prepare(&self.lattice, &self.penalty);
        } else if let Some(least) = weak {
            self.band.lump_weak(least);
        }
    }

    /// Replaces `right`, which must be zero at held DOFs, by the solution with the factors of the last
    /// velocities; of one dimension.
    pub(super) fn solve_again(&self, right: &mut [SVector<T, D>]) {
        for axis in 0..D {
            self.factor.solve_again(right, axis);
        }
    }

    /// `y = M x`.
    #[inline(never)]
    pub(super) fn multiply(&self, x: &[T], y: &mut [T]) {
        if D == 1 {
            self.band.multiply_column(x, y);
        } else {
            self.lattice.multiply(x, y);
        }
    }

    /// Sum of all entries.
    pub(super) fn total(&self) -> T {
        if const { D == 1 } {
            self.band.total()
        } else {
            self.gradients.total()
        }
    }
}

impl<T: Scalar, const D: usize> Dofs<T, D> {
    /// `M x = right`. Out of line: it knows neither basis nor law. The held DOFs are eliminated if they are
    /// constraints; they may differ from axis to axis. `pick` says which of their told velocity and
    /// acceleration counts. Without `fresh` the matrix is the one of the last call.
    #[inline(never)]
    pub(super) fn solve(
        &mut self,
        unknown: Unknown,
        mass: Divisor,
        walls: &Walls<'_, T, D>,
        fresh: bool,
        pick: &dyn Fn(T, T) -> T,
    ) {
        if let Divisor::ParticleSeries(terms) = mass {
            return self.sum_series(unknown, terms, walls, pick);
        }
        if const { D > 1 } {
            return self.iterate(unknown, mass, walls, pick);
        }
        let right = match unknown {
            Unknown::Acceleration => &mut self.force,
            Unknown::Velocity => &mut self.velocity,
        };
        let MassMatrix { band, factor, .. } = &mut self.matrix;
        if !mass.is_constrained() {
            if fresh {
                factor.copy_from(band);
                factor.factorise_and_solve(right, 0);
            } else {
                factor.solve_again(right, 0);
            }
            return;
        }
        if fresh {
            factor.copy_from(band);
            walls.for_each_held(|dof, axis, velocity, acceleration| {
                factor.prescribe(dof, axis, pick(velocity, acceleration), right);
            });
            factor.factorise_and_solve(right, 0);
        } else {
            walls.for_each_held(|dof, axis, velocity, acceleration| {
                band.move_known(dof, axis, pick(velocity, acceleration), right);
            });
            // Only then: what is known of one DOF also moves to the equations of other known ones.
            walls.for_each_held(|dof, axis, velocity, acceleration| {
                right[dof][axis] = pick(velocity, acceleration);
            });
            factor.solve_again(right, 0);
        }
    }

    /// The same with the matrix of a lattice.
    fn iterate(
        &mut self,
        unknown: Unknown,
        mass: Divisor,
        walls: &Walls<'_, T, D>,
        pick: &dyn Fn(T, T) -> T,
    ) {
        let right = match unknown {
            Unknown::Acceleration => &mut self.force,
            Unknown::Velocity => &mut self.velocity,
        };
        let MassMatrix {
            lattice,
            penalty,
            gradients,
            ..
        } = &mut self.matrix;
        gradients.release();
        if mass.is_constrained() {
            walls.for_each_held(|dof, axis, velocity, acceleration| {
                gradients.hold(dof, axis);
                right[dof][axis] = pick(velocity, acceleration);
            });
        }
        gradients.solve(lattice, penalty, right);
    }
}
