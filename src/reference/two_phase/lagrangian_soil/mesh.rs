//! Equal spectral elements on a column.

use crate::reference::Resolution;
use crate::reference::lobatto::Lobatto;

/// Nodes are numbered from the base, and neighbouring elements share one. *Points* are the nodes of each element by
/// themselves, numbered element by element: values there may jump between elements.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    rule: Lobatto,
    /// Row `i` of an element: what the stress at each of its nodes contributes to the internal force on node `i`.
    weak_derivative: Vec<f64>,
    elements: usize,
    size: f64,
}

impl Mesh {
    pub(super) fn new(height: f64, resolution: Resolution) -> Self {
        let rule = Lobatto::new(resolution.degree);
        Self {
            weak_derivative: rule.weak_derivative(),
            rule,
            elements: resolution.elements,
            size: height / resolution.elements as f64,
        }
    }

    /// Nodes of one element.
    pub(super) fn width(&self) -> usize {
        self.rule.nodes().len()
    }

    pub(super) fn node_count(&self) -> usize {
        self.elements * self.rule.degree() + 1
    }

    pub(super) fn point_count(&self) -> usize {
        self.elements * self.width()
    }

    /// First node of each element.
    pub(super) fn first_nodes(&self) -> impl Iterator<Item = usize> {
        (0..self.elements).map(|element| element * self.rule.degree())
    }

    /// Height of a node above the base, m.
    pub(super) fn node(&self, node: usize) -> f64 {
        let (element, local) = (node / self.rule.degree(), node % self.rule.degree());
        self.coordinate(element, local)
    }

    /// Height of a point above the base, m.
    pub(super) fn point(&self, point: usize) -> f64 {
        self.coordinate(point / self.width(), point % self.width())
    }

    fn coordinate(&self, element: usize, local: usize) -> f64 {
        (element as f64 + 0.5 * (1.0 + self.rule.nodes()[local])) * self.size
    }

    /// Weights of an element's points, m.
    pub(super) fn weights(&self) -> impl Iterator<Item = f64> {
        self.rule.weights().iter().map(|weight| 0.5 * self.size * weight)
    }

    /// Heights, m, and weights, m, of all points.
    pub(super) fn quadrature(&self) -> impl Iterator<Item = (f64, f64)> {
        (0..self.point_count())
            .map(|point| self.point(point))
            .zip(std::iter::repeat_with(|| self.weights()).flatten())
    }

    /// Derivative of an element's nodal values at each of its points.
    pub(super) fn derivatives(&self, element: &[f64]) -> impl Iterator<Item = f64> {
        let scale = 2.0 / self.size;
        self.rule
            .derivative_rows()
            .map(move |row| scale * dot(row, element))
    }

    /// Subtracts an element's internal forces under the `stress` at its points.
    pub(super) fn subtract_forces(&self, stress: &[f64], forces: &mut [f64]) {
        for (force, row) in forces
            .iter_mut()
            .zip(self.weak_derivative.chunks_exact(self.width()))
        {
            *force -= dot(row, stress);
        }
    }

    /// Largest frequency of waves of unit speed, rad/s.
    pub(super) fn largest_wave_number(&self) -> f64 {
        2.0 / self.size * self.rule.largest_eigenvalue().sqrt()
    }

    /// The element and the coordinate in it, -1 to 1, of a height above the base, m; beyond the ends, of the end. The
    /// edge of two elements belongs to the upper one.
    pub(super) fn locate(&self, x: f64) -> (usize, f64) {
        let scaled = (x / self.size).clamp(0.0, self.elements as f64);
        let element = (scaled as usize).min(self.elements - 1);
        (element, 2.0 * (scaled - element as f64) - 1.0)
    }

    /// Value in an element of what has the given values at its nodes.
    pub(super) fn interpolate(&self, xi: f64, values: &[f64]) -> f64 {
        self.rule.interpolate(xi, |i| values[i])
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
