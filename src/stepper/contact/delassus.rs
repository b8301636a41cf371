//! The Delassus operator: how impulses at the walls' DOFs change the velocities mapped to them afterwards.

use nalgebra::SVector;

use super::wall::WallDofs;
use crate::scalar::Scalar;

/// `W`, column after column: what an impulse at a DOF adds to the velocities of its neighbours, by component.
#[derive(Clone, Debug)]
pub(super) struct Delassus<T, const D: usize> {
    pub(super) entries: Vec<SVector<T, D>>,
    /// `S_ij = sum_p m_p phi_i phi_j`.
    sums: Vec<T>,
    /// What an impulse adds to the velocity of its own DOF.
    pub(super) diagonal: Vec<SVector<T, D>>,
    /// The DOFs on walls that a particle sees.
    seen: Vec<(usize, T)>,
}

impl<T: Scalar, const D: usize> Delassus<T, D> {
    pub(super) fn none() -> Self {
        Self {
            entries: Vec::new(),
            sums: Vec::new(),
            diagonal: Vec::new(),
            seen: Vec::new(),
        }
    }

    /// Makes room for the neighbours of `dofs`; `width` is the most DOFs that a particle sees.
    pub(super) fn lay(&mut self, dofs: &WallDofs<T, D>, width: usize) {
        let count = dofs.neighbours().len();
        self.entries = vec![SVector::zeros(); count];
        self.sums = vec![T::zero(); count];
        self.diagonal = vec![SVector::zeros(); dofs.dofs.len()];
        self.seen = Vec::with_capacity(width);
    }

    /// No particle yet.
    pub(super) fn clear(&mut self) {
        self.sums.fill(T::zero());
    }

    /// Takes in that the next particle sees a DOF.
    #[inline(always)]
    pub(super) fn see(&mut self, place: usize, phi: T) {
        self.seen.push((place, phi));
    }

    /// Adds the particle that sees what was shown since the last one; returns whether that was anything.
    pub(super) fn add_particle(&mut self, dofs: &WallDofs<T, D>, mass: T) -> bool {
        let Self { sums, seen, .. } = self;
        for &(i, phi_i) in seen.iter() {
            let row = dofs.row(i);
            let neighbours = &dofs.neighbours()[row.clone()];
            let sums = &mut sums[row];
            for &(j, phi_j) in seen.iter() {
                if let Some(k) = neighbours.iter().position(|&place| place as usize == j) {
                    sums[k] += mass * phi_i * phi_j;
                }
            }
        }
        let any = !seen.is_empty();
        seen.clear();
        any
    }

    /// `W = N S N`, `inverse` the diagonal of `N` by component: zero where another face holds it.
    pub(super) fn sum_up(&mut self, dofs: &WallDofs<T, D>, inverse: &[SVector<T, D>]) {
        for (j, from) in inverse.iter().enumerate() {
            for k in dofs.row(j) {
                let to = &inverse[dofs.neighbours()[k] as usize];
                self.entries[k] = to.component_mul(from) * self.sums[k];
            }
        }
    }

    /// Takes the entries as complete.
    pub(super) fn complete(&mut self, dofs: &WallDofs<T, D>) {
        for (place, own) in self.diagonal.iter_mut().enumerate() {
            let mut row = dofs.row(place);
            let found = row.find(|&k| dofs.neighbours()[k] as usize == place);
            *own = found.map_or(SVector::zeros(), |k| self.entries[k]);
        }
    }

    /// Makes each diagonal at least the sum of what couples to it. An operator that is not quite symmetric,
    /// or was asked for at some DOFs only, may otherwise have no solution that sweeps find.
    pub(super) fn dominate(&mut self, dofs: &WallDofs<T, D>) {
        for (place, own) in self.diagonal.iter_mut().enumerate() {
            let row = dofs.row(place);
            let couplings = dofs.neighbours()[row.clone()].iter().zip(&mut self.entries[row]);
            let (mut sum, mut at) = (SVector::zeros(), None);
            for (&neighbour, entry) in couplings {
                match neighbour as usize == place {
                    true => at = Some(entry),
                    false => sum += entry.abs(),
                }
            }
            // Components that another face holds respond to nothing.
            let larger = own.zip_map(&sum, |own, sum| if own > T::zero() { own.max(sum) } else { own });
            *own = larger;
            if let Some(entry) = at {
                *entry = larger;
            }
        }
    }

    /// Makes all entries larger.
    pub(super) fn enlarge(&mut self, by: T) {
        for entry in self.entries.iter_mut().chain(&mut self.diagonal) {
            *entry *= by;
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<SVector<T, D>>() * (self.entries.capacity() + self.diagonal.capacity())
            + size_of::<T>() * self.sums.capacity()
            + size_of::<(usize, T)>() * self.seen.capacity()
    }
}
