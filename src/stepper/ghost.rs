//! Functions that only a partly filled cell's particles see, tied to those of the next cells.

use super::Stepper;
use super::matrix::MassMatrix;
use crate::basis::BasisFamily;
use crate::grid::Grid;
use crate::law::LawSweep;
use crate::particles::{Bins, Particles};
use crate::phase::Phase;
use crate::reconstruction::{Filling, Filters, Reconstruction};
use crate::scalar::Scalar;
use crate::transfer::Transfer;

/// Strength of the tie, as a share of what the jump would change the kinetic energy of a full cell by.
/// Between 0.2 and 1 the energy of a spinning disc does not differ; weaker ones bear free sides for a shorter
/// time, stronger ones take more iterations.
const SHARE: f64 = 0.3;

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Puts a penalty on the jumps across those faces between occupied cells at which one of them is not
    /// full, beyond one dimension.
    pub(super) fn tie_partly_filled_cells(&mut self) {
        let (grid, bins, reconstruction) = (&self.inner.grid, &self.inner.bins, &self.reconstruction);
        let is_full = |place: usize| R::Filter::filling(reconstruction, place) == Filling::Filled;
        let full_mass = |place: usize| density(&self.inner.particles, bins, place) * grid.cell_volume();
        let share = share::<T, D>(self.basis.degree());
        for place in 0..bins.occupied().len() {
            let own_is_full = is_full(place);
            bins.for_each_neighbour(grid, place, |axis, above, other| {
                if above && !(own_is_full && is_full(other)) {
                    let cell = grid.cell(bins.occupied()[place] as usize);
                    // The lighter of two bodies must not be tied as if it were the heavier.
                    let mass = full_mass(place).min(full_mass(other)) * share;
                    self.inner.dofs.matrix.tie(grid, &cell, axis, mass);
                }
            });
        }
    }
}

/// Lumps the masses of cells that nothing determines: drops, splinters, bodies with one particle a cell. A
/// matrix that particles do not determine has no inverse, and no tie helps where the next cells know no more.
#[inline(never)]
pub(super) fn lump_undetermined_cells<T, const D: usize, B, R>(
    (basis, grid, bins): (&B, &Grid<T, D>, &Bins<D>),
    reconstruction: &R,
    matrix: &mut MassMatrix<T, D>,
) where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
{
    let occupied = bins.occupied().iter().enumerate();
    for (_, &number) in
        occupied.filter(|&(place, _)| R::Filter::filling(reconstruction, place) == Filling::Isolated)
    {
        let cell = grid.cell(number as usize);
        let x = grid.centre(&cell);
        basis.for_each_at_fixed_point(grid, &cell, &x, |dof, _, _| matrix.lump(dof));
    }
}

/// Weight of a jump `[h^p d^p u]` over the mass of a cell. The next cell's polynomial, continued, differs
/// from the own one by `[h^p d^p u] s^p / p!`, `s` from 0 to 1, whose mean square is
/// `[...]^2 / ((2 p + 1) (p!)^2)`; there are `p + 1` functions along each axis of the face.
fn share<T: Scalar, const D: usize>(degree: usize) -> T {
    let factorial: f64 = (1..=degree).map(|k| k as f64).product();
    let mean_square = 1.0 / ((2 * degree + 1) as f64 * factorial * factorial);
    T::lit(SHARE * mean_square / ((degree + 1) as f64).powi(D as i32 - 1))
}

/// Mean density of the particles in an occupied cell.
fn density<T: Scalar, const D: usize, S, Q>(
    particles: &Particles<T, D, S, Q>,
    bins: &Bins<D>,
    place: usize,
) -> T {
    let (mut mass, mut volume) = (T::zero(), T::zero());
    for &p in bins.particles_in(bins.occupied()[place] as usize) {
        mass += particles.mass[p as usize];
        volume += particles.volume[p as usize];
    }
    mass / volume
}
