//! Domains of particles, for a basis that averages over them.

use nalgebra::{SMatrix, SVector};

use crate::parallel::Sliced;
use crate::scalar::Scalar;

/// Domains of particles, of the kind that the basis asks for ([`Domain`](crate::basis::Domain)); of the other
/// kind there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Domains<T, const D: usize> {
    /// Half lengths along each axis (m).
    pub half_lengths: Vec<SVector<T, D>>,
    /// Half edge vectors (m), one in each column.
    pub half_edges: Vec<SMatrix<T, D, D>>,
}

impl<T, const D: usize> Domains<T, D> {
    /// Of particles that are points.
    pub const fn none() -> Self {
        Self {
            half_lengths: Vec::new(),
            half_edges: Vec::new(),
        }
    }

    /// How many there are of each kind, with the kind's name.
    pub(crate) fn lengths(&self) -> impl Iterator<Item = (&'static str, usize)> + use<T, D> {
        [
            ("domains.half_lengths", self.half_lengths.len()),
            ("domains.half_edges", self.half_edges.len()),
        ]
        .into_iter()
    }

    pub(super) fn bytes(&self) -> usize {
        super::allocated(&self.half_lengths) + super::allocated(&self.half_edges)
    }
}

impl<T: Scalar, const D: usize> Domains<T, D> {
    /// Those of the given particles.
    pub(super) fn picked(&self, numbers: &[usize]) -> Self {
        let (lengths, edges) = (&self.half_lengths, &self.half_edges);
        Self {
            half_lengths: numbers.iter().filter_map(|&p| lengths.get(p)).copied().collect(),
            half_edges: numbers.iter().filter_map(|&p| edges.get(p)).copied().collect(),
        }
    }

    /// How far that of a particle reaches to each side along an axis (m); `None` of a point.
    pub(crate) fn half_extent(&self, p: usize, axis: usize) -> Option<T> {
        if let Some(half) = self.half_lengths.get(p) {
            return half.get(axis).copied();
        }
        let edges = self.half_edges.get(p)?;
        Some((0..D).fold(T::zero(), |sum, edge| sum + edges[(axis, edge)].abs()))
    }

    /// Exchanges those of two particles.
    pub(crate) fn swap(&mut self, a: usize, b: usize) {
        if !self.half_lengths.is_empty() {
            self.half_lengths.swap(a, b);
        }
        if !self.half_edges.is_empty() {
            self.half_edges.swap(a, b);
        }
    }

    pub(crate) fn views(&self) -> DomainViews<'_, T, D> {
        DomainViews {
            half_lengths: &self.half_lengths,
            half_edges: &self.half_edges,
        }
    }
}

/// Domains of particles that follow each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DomainViews<'a, T, const D: usize> {
    pub(crate) half_lengths: &'a [SVector<T, D>],
    pub(crate) half_edges: &'a [SMatrix<T, D, D>],
}

impl<T: Sync, const D: usize> Sliced for DomainViews<'_, T, D> {
    fn items(&self) -> usize {
        self.half_lengths.len().max(self.half_edges.len())
    }

    fn split(self, spans: usize, items: usize) -> (Self, Self) {
        let (half_lengths, later_half_lengths) = Sliced::split(self.half_lengths, spans, items);
        let (half_edges, later_half_edges) = Sliced::split(self.half_edges, spans, items);
        let first = Self {
            half_lengths,
            half_edges,
        };
        let rest = Self {
            half_lengths: later_half_lengths,
            half_edges: later_half_edges,
        };
        (first, rest)
    }
}
