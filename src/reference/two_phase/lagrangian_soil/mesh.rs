//! Equal spectral elements on a column.

use crate::reference::Resolution;
use crate::reference::lobatto::Lobatto;

/// Nodes are numbered from the base, and neighbouring elements share one. *Points* are the nodes of each
/// element by themselves, numbered element by element: values there may jump between elements.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    rule: Lobatto,
    /// Row `i` of an element: what the stress at each of its nodes contributes to the internal force on node
    /// `i`.
    weak_derivative: Vec<f64>,
    /// Heights above the base at which elements end, m.
    edges: Vec<f64>,
    /// The root of the largest eigenvalue of an element of length 2.
    largest_eigenvalue: f64,
}

impl Mesh {
    /// Equal elements, of which those at `refined` ends are halved `level` times towards their ends.
    pub(super) fn new(height: f64, resolution: Resolution, refined: [bool; 2], level: usize) -> Self {
        let size = height / resolution.elements as f64;
        let parts = || {
            (0..level).scan(size, |part, _| {
                *part *= 0.5;
                Some(*part)
            })
        };
        let mut edges: Vec<f64> = (1..resolution.elements)
            .map(|element| element as f64 * size)
            .collect();
        edges.extend([0.0, height]);
        let [base, top] = refined;
        edges.extend(parts().filter(|_| base));
        edges.extend(parts().filter(|_| top).map(|part| height - part));
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let rule = Lobatto::new(resolution.degree);
        Self {
            weak_derivative: rule.weak_derivative(),
            largest_eigenvalue: rule.largest_eigenvalue().sqrt(),
            rule,
            edges,
        }
    }

    /// Nodes of one element.
    pub(super) fn width(&self) -> usize {
        self.rule.nodes().len()
    }

    fn element_count(&self) -> usize {
        self.edges.len() - 1
    }

    /// Length of an element, m.
    fn size(&self, element: usize) -> f64 {
        self.edges[element + 1] - self.edges[element]
    }

    pub(super) fn node_count(&self) -> usize {
        self.element_count() * self.rule.degree() + 1
    }

    pub(super) fn point_count(&self) -> usize {
        self.element_count() * self.width()
    }

    /// First node of each element.
    pub(super) fn first_nodes(&self) -> impl Iterator<Item = usize> {
        (0..self.element_count()).map(|element| element * self.rule.degree())
    }

    /// Height of a node above the base, m.
    pub(super) fn node(&self, node: usize) -> f64 {
        let element = (node / self.rule.degree()).min(self.element_count() - 1);
        self.coordinate(element, node - element * self.rule.degree())
    }

    /// Height of a point above the base, m.
    pub(super) fn point(&self, point: usize) -> f64 {
        self.coordinate(point / self.width(), point % self.width())
    }

    fn coordinate(&self, element: usize, local: usize) -> f64 {
        let xi = self.rule.nodes()[local];
        0.5 * ((1.0 - xi) * self.edges[element] + (1.0 + xi) * self.edges[element + 1])
    }

    /// Weights of the points of an element, m.
    pub(super) fn weights(&self, element: usize) -> impl Iterator<Item = f64> {
        let half = 0.5 * self.size(element);
        self.rule.weights().iter().map(move |weight| half * weight)
    }

    /// Heights, m, and weights, m, of all points.
    pub(super) fn quadrature(&self) -> impl Iterator<Item = (f64, f64)> {
        let weights = (0..self.element_count()).flat_map(|element| self.weights(element));
        (0..self.point_count())
            .map(|point| self.point(point))
            .zip(weights)
    }

    /// Derivative of the nodal `values` of an element at each of its points.
    pub(super) fn derivatives(&self, element: usize, values: &[f64]) -> impl Iterator<Item = f64> {
        let scale = 2.0 / self.size(element);
        self.rule
            .derivative_rows()
            .map(move |row| scale * dot(row, values))
    }

    /// Subtracts the internal forces of an element, of any, under the `stress` at its points.
    pub(super) fn subtract_forces(&self, stress: &[f64], forces: &mut [f64]) {
        for (force, row) in forces
            .iter_mut()
            .zip(self.weak_derivative.chunks_exact(self.width()))
        {
            *force -= dot(row, stress);
        }
    }

    /// Largest frequency that an element gives waves of unit speed, rad/s.
    pub(super) fn largest_wave_number(&self, element: usize) -> f64 {
        2.0 / self.size(element) * self.largest_eigenvalue
    }

    /// The element and the coordinate in it, -1 to 1, of a height above the base, m; beyond the ends, of the
    /// end. The edge of two elements belongs to the upper one.
    pub(super) fn locate(&self, x: f64) -> (usize, f64) {
        let below = self.edges.partition_point(|edge| *edge <= x);
        let element = below.saturating_sub(1).min(self.element_count() - 1);
        let (low, high) = (self.edges[element], self.edges[element + 1]);
        let x = x.clamp(low, high);
        (element, ((x - low) - (high - x)) / (high - low))
    }

    /// Value in an element of what has the given values at its nodes.
    pub(super) fn interpolate(&self, xi: f64, values: &[f64]) -> f64 {
        self.rule.interpolate(xi, |i| values[i])
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(refined: [bool; 2], level: usize) -> Mesh {
        let resolution = Resolution {
            elements: 2,
            degree: 3,
        };
        Mesh::new(4.0, resolution, refined, level)
    }

    #[test]
    fn refined_ends_are_halved() {
        assert_eq!(mesh([true; 2], 0).edges, [0.0, 2.0, 4.0]);
        assert_eq!(mesh([false, true], 2).edges, [0.0, 2.0, 3.0, 3.5, 4.0]);
        assert_eq!(mesh([true, true], 1).edges, [0.0, 1.0, 2.0, 3.0, 4.0]);
    }

    /// On unequal elements: a cubic is integrated, differentiated and interpolated exactly.
    #[test]
    fn cubics_are_exact() {
        let mesh = mesh([true, false], 3);
        let integral: f64 = mesh.quadrature().map(|(x, weight)| weight * x.powi(3)).sum();
        assert!((integral - 64.0).abs() < 1e-12, "{integral}");
        let nodal: Vec<f64> = (0..mesh.node_count())
            .map(|node| mesh.node(node).powi(3))
            .collect();
        for (element, first) in mesh.first_nodes().enumerate() {
            let values = &nodal[first..first + mesh.width()];
            for (q, slope) in mesh.derivatives(element, values).enumerate() {
                let x = mesh.point(element * mesh.width() + q);
                assert!((slope - 3.0 * x * x).abs() < 1e-12, "{slope} at {x}");
            }
        }
        for (x, expected) in [(-1.0, 0.0), (0.25, 0.25), (0.3, 0.3), (3.9, 3.9), (9.0, 4.0)] {
            let (element, xi) = mesh.locate(x);
            let first = element * (mesh.width() - 1);
            let value = mesh.interpolate(xi, &nodal[first..first + mesh.width()]);
            assert!((value - f64::powi(expected, 3)).abs() < 1e-12, "{value} at {x}");
        }
    }
}
