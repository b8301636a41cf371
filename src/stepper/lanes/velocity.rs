//! Stage 3: particle velocities, and the DOFs' momenta where the particles are the points of the mapping.

use nalgebra::SVector;

use super::mass_and_force::Bodies;
use super::sums::{Parts, Sums};
use super::{Group, Pass};
use crate::basis::BasisFamily;
use crate::lanes::{Lanes, with_lanes_of};
use crate::scalar::Scalar;
use crate::stepper::diagnostics;

/// What accelerates particles.
#[derive(Clone, Copy)]
pub(in super::super) struct Acceleration<'a, T, const D: usize> {
    /// Of the DOFs.
    pub(in super::super) dofs: &'a [SVector<T, D>],
    pub(in super::super) dt: T,
}

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>> Pass<'_, T, D, B> {
    /// Accelerates the particles and, if `MAP`, hands `sink(dof, momentum)` what they then add to the DOFs; returns their
    /// momentum.
    pub(in super::super) fn accelerate<const MAP: bool>(
        &self,
        bodies: Bodies<'_, T, D>,
        velocities: &mut [SVector<T, D>],
        acceleration: Acceleration<'_, T, D>,
        sink: &mut impl FnMut(usize, SVector<T, D>),
    ) -> diagnostics::Sums<T, D> {
        if MAP {
            with_lanes_of!(
                T,
                self.accelerate_and_map_in(bodies, velocities, acceleration, sink)
            )
        } else {
            with_lanes_of!(T, self.accelerate_in(bodies, velocities, acceleration))
        }
    }

    #[inline(never)]
    fn accelerate_and_map_in<V: Lanes<T>>(
        &self,
        bodies: Bodies<'_, T, D>,
        velocities: &mut [SVector<T, D>],
        acceleration: Acceleration<'_, T, D>,
        sink: &mut impl FnMut(usize, SVector<T, D>),
    ) -> diagnostics::Sums<T, D> {
        let mut sums = Sums::<V, D>::new();
        let mut sink = |i: usize, _, q| sink(i, q);
        let total = self.each_accelerated(bodies, velocities, acceleration, |cell, factors, momentum| {
            let parts = Parts {
                scalar: None,
                vector: Some(*momentum),
                tensor: None,
            };
            sums.add(self, cell, factors, &parts, &mut sink);
        });
        sums.flush(self, false, &mut sink);
        total
    }

    #[inline(never)]
    fn accelerate_in<V: Lanes<T>>(
        &self,
        bodies: Bodies<'_, T, D>,
        velocities: &mut [SVector<T, D>],
        acceleration: Acceleration<'_, T, D>,
    ) -> diagnostics::Sums<T, D> {
        self.each_accelerated::<V>(bodies, velocities, acceleration, |_, _, _| {})
    }

    /// Calls `f(cell, factors, momentum)` for each group when its velocities are new.
    #[inline(always)]
    fn each_accelerated<V: Lanes<T>>(
        &self,
        bodies: Bodies<'_, T, D>,
        velocities: &mut [SVector<T, D>],
        acceleration: Acceleration<'_, T, D>,
        mut f: impl FnMut(&crate::grid::Cell<D>, &crate::basis::Factors<V, D>, &[V; D]),
    ) -> diagnostics::Sums<T, D> {
        let zero = V::splat(T::zero());
        let dt = V::splat(acceleration.dt);
        let (mut momentum, mut scale) = ([zero; D], zero);
        let mut p = 0;
        while p < bodies.cells.len() {
            let group = Group::at(p, bodies.cells);
            let cell = &bodies.cells[p];
            let factors = self.factors(cell, &group.vectors::<T, V, D>(bodies.positions));
            let a = self.value(self.first_dof(cell), &factors, acceleration.dofs);
            let before = group.vectors::<T, V, D>(velocities);
            let after: [V; D] = std::array::from_fn(|c| a[c].mul_add(dt, before[c]));
            group.put(velocities, &after);
            let mass = group.amounts::<T, V>(bodies.masses);
            let q: [V; D] = std::array::from_fn(|c| after[c] * mass);
            for c in 0..D {
                momentum[c] = momentum[c] + q[c];
            }
            scale = scale + size(&q);
            f(cell, &factors, &q);
            p += group.count;
        }
        let sums = V::sums(std::array::from_fn(|k| match k {
            3 => scale,
            _ if k < D => momentum[k],
            _ => zero,
        }));
        diagnostics::Sums::new(SVector::from_fn(|c, _| sums[c]), sums[3])
    }
}

/// Sizes of vectors. Along one axis without the root, which takes as long as a dozen sums.
#[inline(always)]
fn size<T: Scalar, V: Lanes<T>, const D: usize>(vectors: &[V; D]) -> V {
    if D == 1 {
        return vectors[0].abs();
    }
    let square = vectors[0] * vectors[0];
    (1..D)
        .fold(square, |sum, c| vectors[c].mul_add(vectors[c], sum))
        .sqrt()
}
