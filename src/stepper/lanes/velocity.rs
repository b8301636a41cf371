//! Stage 3: particle velocities, and the DOFs' momenta where the particles are the points of the mapping.

use nalgebra::SVector;

use super::mass_and_force::Bodies;
use super::sums::{Parts, Sums};
use super::{EachGroup, Group, Pass, each_group, with_lanes_for};
use crate::basis::{BasisFamily, Factors};
use crate::grid::Cell;
use crate::lanes::{Lanes, SideBySide};
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
            with_lanes_for!(
                T,
                bodies.cells,
                self.accelerate_and_map_in(bodies, velocities, acceleration, sink)
            )
        } else {
            with_lanes_for!(
                T,
                bodies.cells,
                self.accelerate_in(bodies, velocities, acceleration)
            )
        }
    }

    #[inline(never)]
    fn accelerate_and_map_in<V: Lanes<T, N>, const N: usize>(
        &self,
        bodies: Bodies<'_, T, D>,
        velocities: &mut [SVector<T, D>],
        acceleration: Acceleration<'_, T, D>,
        sink: &mut impl FnMut(usize, SVector<T, D>),
    ) -> diagnostics::Sums<T, D> {
        let mut sums = Sums::<V, D>::new();
        let mut sink = |i: usize, _, q| sink(i, q);
        let total = self.each_accelerated(
            bodies,
            velocities,
            acceleration,
            // A compiler may think it too long to be called in two places, and the sums then go through memory.
            #[inline(always)]
            |cell, factors, momentum| {
                let parts = Parts {
                    scalar: None,
                    vector: Some(*momentum),
                    tensor: None,
                };
                sums.add(self, cell, factors, &parts, &mut sink);
            },
        );
        sums.flush(self, false, &mut sink);
        total
    }

    #[inline(never)]
    fn accelerate_in<V: Lanes<T, N>, const N: usize>(
        &self,
        bodies: Bodies<'_, T, D>,
        velocities: &mut [SVector<T, D>],
        acceleration: Acceleration<'_, T, D>,
    ) -> diagnostics::Sums<T, D> {
        self.each_accelerated::<V, N>(bodies, velocities, acceleration, |_, _, _| {})
    }

    /// Calls `f(cell, factors, momentum)` for each group when its velocities are new.
    #[inline(always)]
    fn each_accelerated<V: Lanes<T, N>, const N: usize>(
        &self,
        bodies: Bodies<'_, T, D>,
        velocities: &mut [SVector<T, D>],
        acceleration: Acceleration<'_, T, D>,
        f: impl FnMut(&Cell<D>, &Factors<V, D>, &[V; D]),
    ) -> diagnostics::Sums<T, D> {
        let bodies = bodies.even();
        let zero = V::splat(T::zero());
        let mut pass = Accelerating {
            pass: self,
            bodies,
            velocities: &mut velocities[..bodies.cells.len()],
            acceleration,
            momentum: [zero; D],
            scale: zero,
            f,
        };
        each_group(bodies.cells, &mut pass);
        let (momentum, scale) = (pass.momentum, pass.scale);
        let sums = V::sums(std::array::from_fn(|k| match k {
            3 => scale,
            _ if k < D => momentum[k],
            _ => zero,
        }));
        diagnostics::Sums::new(SVector::from_fn(|c, _| sums[c]), sums[3])
    }
}

/// The pass over velocities.
struct Accelerating<'a, T, V, const D: usize, B, F> {
    pass: &'a Pass<'a, T, D, B>,
    bodies: Bodies<'a, T, D>,
    velocities: &'a mut [SVector<T, D>],
    acceleration: Acceleration<'a, T, D>,
    /// Of all, and its size, lane by lane.
    momentum: [V; D],
    scale: V,
    f: F,
}

impl<T, V, const D: usize, const N: usize, B, F> EachGroup<N> for Accelerating<'_, T, V, D, B, F>
where
    T: Scalar,
    V: Lanes<T, N>,
    B: BasisFamily<T, D>,
    F: FnMut(&Cell<D>, &Factors<V, D>, &[V; D]),
{
    #[inline(always)]
    fn take<const FULL: bool>(&mut self, group: Group<N>) {
        let (pass, bodies) = (self.pass, &self.bodies);
        let cell = &bodies.cells[group.first];
        let factors = pass.factors(cell, &group.vectors::<FULL, T, V, D>(bodies.positions));
        let a = pass.value(pass.first_dof(cell), &factors, self.acceleration.dofs);
        let before = group.vectors::<FULL, T, V, D>(self.velocities);
        let dt = V::splat(self.acceleration.dt);
        let after: [V; D] = std::array::from_fn(|c| a[c].mul_add(dt, before[c]));
        group.put::<FULL, T, V, D>(self.velocities, &after);
        let mass = group.amounts::<FULL, T, V>(bodies.masses);
        let q: [V; D] = std::array::from_fn(|c| after[c] * mass);
        for c in 0..D {
            self.momentum[c] = self.momentum[c] + q[c];
        }
        self.scale = self.scale + size(&q);
        (self.f)(cell, &factors, &q);
    }
}

/// Sizes of vectors. Along one axis without the root, which takes as long as a dozen sums.
#[inline(always)]
fn size<T: Scalar, V: SideBySide<T>, const D: usize>(vectors: &[V; D]) -> V {
    if D == 1 {
        return vectors[0].abs();
    }
    let square = vectors[0] * vectors[0];
    (1..D)
        .fold(square, |sum, c| vectors[c].mul_add(vectors[c], sum))
        .sqrt()
}
