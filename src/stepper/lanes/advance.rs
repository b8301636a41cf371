//! Stage 4: positions, stresses and volumes of the particles.

use nalgebra::{SMatrix, SVector};

use super::{Group, Pass};
use crate::basis::BasisFamily;
use crate::grid::Cell;
use crate::lanes::{LANES, Lanes, with_lanes_of};
use crate::law::ConstitutiveLaw;
use crate::particles::{Movables, settle};
use crate::phase::Phase;
use crate::scalar::Scalar;
use crate::stepper::spans::{Fault, Moved};
use crate::stepper::window;

/// What moves particles.
pub(in super::super) struct Motion<'a, T, const D: usize, L, P> {
    /// Velocities of the DOFs.
    pub(in super::super) velocity: &'a [SVector<T, D>],
    pub(in super::super) dt: T,
    pub(in super::super) law: &'a L,
    pub(in super::super) phase: &'a P,
}

/// Of the particles of a group, the path and the displacement gradient of the step.
type Increments<T, const D: usize> = [(SVector<T, D>, SMatrix<T, D, D>); LANES];

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>> Pass<'_, T, D, B> {
    /// Moves and deforms the particles, the first of which has the number `first`; returns also the lowest and the highest
    /// number of a cell that they are then in.
    pub(in super::super) fn advance<L: ConstitutiveLaw<T, D>, P: Phase<T, D>>(
        &self,
        motion: &Motion<'_, T, D, L, P>,
        first: usize,
        particles: Movables<'_, T, D, L::State, P::Particle>,
        cells: &mut [Cell<D>],
    ) -> (Moved<T>, [u32; 2]) {
        with_lanes_of!(T, self.advance_in[_, _](motion, first, particles, cells))
    }

    #[inline(never)]
    fn advance_in<V: Lanes<T>, L: ConstitutiveLaw<T, D>, P: Phase<T, D>>(
        &self,
        motion: &Motion<'_, T, D, L, P>,
        first: usize,
        mut particles: Movables<'_, T, D, L::State, P::Particle>,
        cells: &mut [Cell<D>],
    ) -> (Moved<T>, [u32; 2]) {
        let mut moved = Moved::default();
        let mut bounds = [u32::MAX, 0];
        let mut bound = |cell: &Cell<D>| {
            let number = self.grid.linear(cell) as u32;
            bounds = [bounds[0].min(number), bounds[1].max(number)];
        };
        let mut p = 0;
        while p < cells.len() && moved.fault.is_none() {
            let group = Group::at(p, cells);
            let x = group.vectors::<T, V, D>(particles.positions());
            bound(&cells[p]);
            let increments = self.increments(motion, &cells[p], &x);
            for l in 0..group.count {
                let (path, increment) = &increments[l];
                let mut particle = particles.at(p + l);
                if P::COUPLED {
                    motion.phase.update(increment, particle.phase);
                }
                if let Err(flaw) = particle.advance(motion.law, motion.dt, path, increment) {
                    moved.fault = Some(Fault::Material(first + p + l, flaw));
                    break;
                }
                match settle(self.grid, &mut cells[p + l], particle.position) {
                    Some(false) => {}
                    Some(true) => {
                        moved.crossings += 1;
                        if window::is_safe(self.grid, &cells[p + l]) {
                            bound(&cells[p + l]);
                        } else {
                            moved.strayed = true;
                        }
                    }
                    None => {
                        moved.fault = Some(Fault::Left(first + p + l));
                        break;
                    }
                }
            }
            p += group.count;
        }
        (moved, bounds)
    }

    #[inline(always)]
    fn increments<V: Lanes<T>, L, P>(
        &self,
        motion: &Motion<'_, T, D, L, P>,
        cell: &Cell<D>,
        x: &[V; D],
    ) -> Increments<T, D> {
        let factors = self.factors(cell, x);
        let (v, slopes) = self.value_and_slopes(self.first_dof(cell), &factors, motion.velocity);
        let dt = V::splat(motion.dt);
        let inverse = self.grid.inverse_cell_size();
        let steps: [V; D] = std::array::from_fn(|a| V::splat(motion.dt * inverse[a]));
        let path: [_; D] = std::array::from_fn(|c| (v[c] * dt).array());
        let gradient: [[_; D]; D] =
            std::array::from_fn(|c| std::array::from_fn(|a| (slopes[c][a] * steps[a]).array()));
        std::array::from_fn(|l| {
            (
                SVector::from_fn(|c, _| path[c][l]),
                SMatrix::from_fn(|c, a| gradient[c][a][l]),
            )
        })
    }
}
