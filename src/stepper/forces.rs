//! The particles' consistent mass matrix, and tractions.

use nalgebra::SVector;

use super::ghost::lump_undetermined_cells;
use super::inner::Inner;
use super::matrix::MassMatrix;
use super::pairs::Pairs;
use super::{FaceCondition, Forcing, Stepper};
use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::law::LawSweep;
use crate::mass::MassModel;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::transfer::{Sites, Transfer, for_values, sum_pairs, sums_apply};

/// In one dimension: share of its mass that a DOF's diagonal must hold to be solved for with its neighbours.
/// The share is the mean value of its function over the particles: 2/3 in a full linear cell, nothing for a
/// DOF that the first particle of a free end has just come to see. Such a DOF would have to carry that
/// particle's whole acceleration, one over the function's value times as large, or round-off so magnified.
pub(super) const WEAK: f64 = 0.3;

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// `M_ij = sum_p m_p phi_i phi_j`, weak DOFs lumped or, beyond one dimension, tied; of both phases and
    /// the drag with a liquid that flows.
    pub(super) fn assemble_matrices(&mut self) {
        if P::FLOWS {
            self.assemble_joint_matrices();
        } else {
            self.assemble_particle_matrix();
        }
    }

    pub(super) fn assemble_particle_matrix(&mut self) {
        let bodies = self.inner.particles.sites(self.inner.bins.cells());
        let (masses, matrix) = (&self.inner.particles.mass[..], &mut self.inner.dofs.matrix);
        fill_with_pairs(
            &self.basis,
            &self.inner.grid,
            bodies,
            masses,
            &mut self.inner.pairs,
            matrix,
        );
        if const { R::Mass::SERIES } {
            if const { D > 1 } {
                let Inner {
                    grid,
                    bins,
                    dofs,
                    places,
                    ..
                } = &mut self.inner;
                let space = (&self.basis, &*grid, &*bins);
                if let Some(series) = &mut dofs.series {
                    series.deflation.find_bodies(space, places, &dofs.mass);
                }
            }
            return;
        }
        if const { D > 1 } {
            self.tie_partly_filled_cells();
        }
        let space = (&self.basis, &self.inner.grid, &self.inner.bins);
        lump_undetermined_cells(space, &self.reconstruction, &mut self.inner.dofs.matrix);
        self.inner.dofs.matrix.complete(Some(T::lit(WEAK)));
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Adds the tractions of faces to the forces.
    pub(super) fn add_tractions<B: BasisFamily<T, D>>(&mut self, basis: &B, forcing: &Forcing<T, D>) {
        for k in 0..self.surface.len() {
            let point = &self.surface[k];
            let FaceCondition::Traction(traction) = forcing.face(point.face) else {
                continue;
            };
            if !point.loaded {
                continue;
            }
            let (cell, x) = self.loaded_place(basis, point);
            let load = traction * point.area;
            self.balance.load += load;
            add_load((basis, &self.grid), (&cell, &x), &load, &mut self.dofs.force);
        }
    }
}

/// Adds a load at a point to the forces of the DOFs.
#[inline(never)]
pub(super) fn add_load<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    (basis, grid): (&B, &Grid<T, D>),
    (cell, x): (&Cell<D>, &SVector<T, D>),
    load: &SVector<T, D>,
    force: &mut [SVector<T, D>],
) {
    basis.for_each(grid, cell, x, |i, phi, _| force[i] += load * phi);
}

/// Calls `add(dof, phi)` for the DOFs that a point sees.
#[inline(never)]
pub(super) fn each_seen<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    (basis, grid): (&B, &Grid<T, D>),
    (cell, x): (&Cell<D>, &SVector<T, D>),
    add: &mut dyn FnMut(usize, T),
) {
    basis.for_each(grid, cell, x, |i, phi, _| add(i, phi));
}

/// `M_ij = sum_p m_p phi_i phi_j`, to be completed.
#[inline(never)]
pub(super) fn fill_with_pairs<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    sites: Sites<'_, T, D>,
    masses: &[T],
    pairs: &mut Pairs<T, D>,
    matrix: &mut MassMatrix<T, D>,
) {
    matrix.clear();
    for_values!(B, basis, |basis| {
        if sums_apply(basis, grid) {
            return sum_pairs(basis, grid, sites, masses, &mut |i, j, mass| {
                matrix.add(i, j, mass);
            });
        }
        for (p, (place, &mass)) in sites.cells.iter().zip(sites.positions).zip(masses).enumerate() {
            pairs.turn_to(place.0, matrix);
            let see = |i, phi, _| pairs.see(i, phi);
            sites.domains.for_each((basis, grid), p, place, see);
            pairs.add(mass);
        }
        pairs.flush(matrix);
    });
}
