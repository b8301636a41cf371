//! Stage 1: masses, and forces where the particles are their points.

use nalgebra::{SMatrix, SVector};

use super::pairs::PairSums;
use super::sums::{Parts, Sums};
use super::{EachGroup, Group, Pass, each_group, tensors, with_lanes_for};
use crate::basis::BasisFamily;
use crate::grid::Cell;
use crate::lanes::Lanes;
use crate::scalar::Scalar;

/// Particles of a span; as many of everything as there are cells.
#[derive(Clone, Copy)]
pub(in super::super) struct Bodies<'a, T, const D: usize> {
    pub(in super::super) positions: &'a [SVector<T, D>],
    pub(in super::super) cells: &'a [Cell<D>],
    pub(in super::super) masses: &'a [T],
}

impl<T, const D: usize> Bodies<'_, T, D> {
    /// The same with lengths that a compiler sees to be equal, so that one test of an index does for all arrays.
    #[inline(always)]
    pub(super) fn even(self) -> Self {
        let count = self.cells.len();
        Self {
            positions: &self.positions[..count],
            masses: &self.masses[..count],
            ..self
        }
    }
}

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>> Pass<'_, T, D, B> {
    /// Hands `sink(dof, mass)` what the particles add to the DOFs.
    pub(in super::super) fn sum_masses(&self, bodies: Bodies<'_, T, D>, sink: &mut impl FnMut(usize, T)) {
        with_lanes_for!(T, bodies.cells, self.masses_in(bodies, sink));
    }

    #[inline(never)]
    fn masses_in<V: Lanes<T, N>, const N: usize>(
        &self,
        bodies: Bodies<'_, T, D>,
        sink: &mut impl FnMut(usize, T),
    ) {
        let bodies = bodies.even();
        let mut pass = Masses {
            pass: self,
            bodies,
            sums: Sums::<V, D>::new(),
            sink: |i: usize, m: T, _| sink(i, m),
        };
        each_group(bodies.cells, &mut pass);
        pass.sums.flush(self, true, &mut pass.sink);
    }

    /// Hands `matrix(i, j, mass)`, `j <= i`, what the particles add to the entries of the consistent mass matrix.
    pub(in super::super) fn sum_pairs(
        &self,
        bodies: Bodies<'_, T, D>,
        matrix: &mut impl FnMut(usize, usize, T),
    ) {
        with_lanes_for!(T, bodies.cells, self.pairs_in(bodies, matrix));
    }

    #[inline(never)]
    fn pairs_in<V: Lanes<T, N>, const N: usize>(
        &self,
        bodies: Bodies<'_, T, D>,
        matrix: &mut impl FnMut(usize, usize, T),
    ) {
        let bodies = bodies.even();
        let mut pass = PairsOfMasses {
            pass: self,
            bodies,
            sums: PairSums::<V, D>::new(),
            matrix,
        };
        each_group(bodies.cells, &mut pass);
        pass.sums.flush(self, pass.matrix);
    }

    /// Hands `sink(dof, momentum)` what the particles add to the DOFs.
    pub(in super::super) fn sum_momenta(
        &self,
        bodies: Bodies<'_, T, D>,
        velocities: &[SVector<T, D>],
        sink: &mut impl FnMut(usize, SVector<T, D>),
    ) {
        with_lanes_for!(T, bodies.cells, self.momenta_in(bodies, velocities, sink));
    }

    #[inline(never)]
    fn momenta_in<V: Lanes<T, N>, const N: usize>(
        &self,
        bodies: Bodies<'_, T, D>,
        velocities: &[SVector<T, D>],
        sink: &mut impl FnMut(usize, SVector<T, D>),
    ) {
        let bodies = bodies.even();
        let mut pass = Momenta {
            pass: self,
            bodies,
            velocities: &velocities[..bodies.cells.len()],
            sums: Sums::<V, D>::new(),
            sink: |i: usize, _, q| sink(i, q),
        };
        each_group(bodies.cells, &mut pass);
        pass.sums.flush(self, false, &mut pass.sink);
    }

    /// Hands `sink(dof, mass, integral of stress times gradient)` what the particles add to the DOFs, given volumes and stresses; `felt(p, stress)` says what the
    /// momentum balance feels of the stress of particle `p`.
    pub(in super::super) fn sum_masses_and_forces(
        &self,
        bodies: Bodies<'_, T, D>,
        material: (&[T], &[SMatrix<T, D, D>]),
        felt: &impl Fn(usize, &SMatrix<T, D, D>) -> SMatrix<T, D, D>,
        sink: &mut impl FnMut(usize, T, SVector<T, D>),
    ) {
        with_lanes_for!(
            T,
            bodies.cells,
            self.masses_and_forces_in(bodies, material, felt, sink)
        );
    }

    #[inline(never)]
    fn masses_and_forces_in<V: Lanes<T, N>, const N: usize>(
        &self,
        bodies: Bodies<'_, T, D>,
        (volumes, stresses): (&[T], &[SMatrix<T, D, D>]),
        felt: &impl Fn(usize, &SMatrix<T, D, D>) -> SMatrix<T, D, D>,
        sink: &mut impl FnMut(usize, T, SVector<T, D>),
    ) {
        let bodies = bodies.even();
        let mut pass = MassesAndForces {
            pass: self,
            bodies,
            volumes: &volumes[..bodies.cells.len()],
            stresses: &stresses[..bodies.cells.len()],
            felt,
            sums: Sums::<V, D>::new(),
            sink,
        };
        each_group(bodies.cells, &mut pass);
        pass.sums.flush(self, true, pass.sink);
    }
}

/// The pass over masses.
struct Masses<'a, T, V, const D: usize, B, S> {
    pass: &'a Pass<'a, T, D, B>,
    bodies: Bodies<'a, T, D>,
    sums: Sums<V, D>,
    sink: S,
}

impl<T, V, const D: usize, const N: usize, B, S> EachGroup<N> for Masses<'_, T, V, D, B, S>
where
    T: Scalar,
    V: Lanes<T, N>,
    B: BasisFamily<T, D>,
    S: FnMut(usize, T, SVector<T, D>),
{
    #[inline(always)]
    fn take<const FULL: bool>(&mut self, group: Group<N>) {
        let (pass, bodies) = (self.pass, &self.bodies);
        let cell = &bodies.cells[group.first];
        let factors = pass.factors(cell, &group.vectors::<FULL, T, V, D>(bodies.positions));
        let parts = Parts {
            scalar: Some(group.amounts::<FULL, T, V>(bodies.masses)),
            vector: None,
            tensor: None,
        };
        self.sums.add(pass, cell, &factors, &parts, &mut self.sink);
    }
}

/// The pass over masses that go to the consistent matrix.
struct PairsOfMasses<'a, T, V, const D: usize, B, M> {
    pass: &'a Pass<'a, T, D, B>,
    bodies: Bodies<'a, T, D>,
    sums: PairSums<V, D>,
    matrix: &'a mut M,
}

impl<T, V, const D: usize, const N: usize, B, M> EachGroup<N> for PairsOfMasses<'_, T, V, D, B, M>
where
    T: Scalar,
    V: Lanes<T, N>,
    B: BasisFamily<T, D>,
    M: FnMut(usize, usize, T),
{
    #[inline(always)]
    fn take<const FULL: bool>(&mut self, group: Group<N>) {
        let (pass, bodies) = (self.pass, &self.bodies);
        let cell = &bodies.cells[group.first];
        let factors = pass.factors(cell, &group.vectors::<FULL, T, V, D>(bodies.positions));
        let mass = group.amounts::<FULL, T, V>(bodies.masses);
        self.sums.add(pass, cell, &factors, mass, self.matrix);
    }
}

/// The pass over momenta.
struct Momenta<'a, T, V, const D: usize, B, S> {
    pass: &'a Pass<'a, T, D, B>,
    bodies: Bodies<'a, T, D>,
    velocities: &'a [SVector<T, D>],
    sums: Sums<V, D>,
    sink: S,
}

impl<T, V, const D: usize, const N: usize, B, S> EachGroup<N> for Momenta<'_, T, V, D, B, S>
where
    T: Scalar,
    V: Lanes<T, N>,
    B: BasisFamily<T, D>,
    S: FnMut(usize, T, SVector<T, D>),
{
    #[inline(always)]
    fn take<const FULL: bool>(&mut self, group: Group<N>) {
        let (pass, bodies) = (self.pass, &self.bodies);
        let cell = &bodies.cells[group.first];
        let factors = pass.factors(cell, &group.vectors::<FULL, T, V, D>(bodies.positions));
        let mass = group.amounts::<FULL, T, V>(bodies.masses);
        let velocities = group.vectors::<FULL, T, V, D>(self.velocities);
        let parts = Parts {
            scalar: None,
            vector: Some(std::array::from_fn(|c| velocities[c] * mass)),
            tensor: None,
        };
        self.sums.add(pass, cell, &factors, &parts, &mut self.sink);
    }
}

/// The pass over masses and stresses.
struct MassesAndForces<'a, T, V, const D: usize, B, F, S> {
    pass: &'a Pass<'a, T, D, B>,
    bodies: Bodies<'a, T, D>,
    volumes: &'a [T],
    stresses: &'a [SMatrix<T, D, D>],
    felt: &'a F,
    sums: Sums<V, D>,
    sink: &'a mut S,
}

impl<T, V, const D: usize, const N: usize, B, F, S> EachGroup<N> for MassesAndForces<'_, T, V, D, B, F, S>
where
    T: Scalar,
    V: Lanes<T, N>,
    B: BasisFamily<T, D>,
    F: Fn(usize, &SMatrix<T, D, D>) -> SMatrix<T, D, D>,
    S: FnMut(usize, T, SVector<T, D>),
{
    #[inline(always)]
    fn take<const FULL: bool>(&mut self, group: Group<N>) {
        let (pass, bodies) = (self.pass, &self.bodies);
        let inverse = pass.grid.inverse_cell_size();
        let cell = &bodies.cells[group.first];
        let factors = pass.factors(cell, &group.vectors::<FULL, T, V, D>(bodies.positions));
        let volume = group.amounts::<FULL, T, V>(self.volumes);
        let along: [V; D] = std::array::from_fn(|a| volume * V::splat(inverse[a]));
        let felt = self.felt;
        let tensor: [[V; D]; D] = group.with::<FULL, _, _>(self.stresses, |lanes| {
            let particle = |l: usize| group.first + l.min(group.count - 1);
            tensors(&std::array::from_fn(|l| felt(particle(l), &lanes[l])))
        });
        let weighted = std::array::from_fn(|c| std::array::from_fn(|a| tensor[c][a] * along[a]));
        let parts = Parts {
            scalar: Some(group.amounts::<FULL, T, V>(bodies.masses)),
            vector: None,
            tensor: Some(weighted),
        };
        self.sums.add(pass, cell, &factors, &parts, self.sink);
    }
}
