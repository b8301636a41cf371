//! Gauss-Lobatto-Legendre nodes on [-1, 1]: quadrature, differentiation, interpolation.

use std::f64::consts::PI;

use nalgebra::DMatrix;

/// The Gauss-Lobatto-Legendre rule of one polynomial degree, and the Lagrange polynomials on its nodes.
///
/// The nodes are -1, 1 and the zeros of the Legendre polynomial's derivative. The quadrature is exact for
/// polynomials of degree `2 p - 1`. Source: C. Canuto, M. Y. Hussaini, A. Quarteroni, T. A. Zang, *Spectral
/// Methods: Fundamentals in Single Domains*, Springer 2006, section 2.3.
#[derive(Clone, Debug)]
pub(super) struct Lobatto {
    nodes: Vec<f64>,
    weights: Vec<f64>,
    barycentric: Vec<f64>,
    /// Row `i`, column `j`: derivative of Lagrange polynomial `j` at node `i`, row by row.
    differentiation: Vec<f64>,
}

impl Lobatto {
    /// The rule with `degree + 1` nodes; `degree` is at least 1.
    pub(super) fn new(degree: usize) -> Self {
        let nodes: Vec<f64> = (0..=degree).map(|i| node(degree, i)).collect();
        let legendre_at: Vec<f64> = nodes.iter().map(|&x| legendre(degree, x).0).collect();
        let scale = 2.0 / (degree * (degree + 1)) as f64;
        let weights = legendre_at.iter().map(|p| scale / (p * p)).collect();
        let barycentric: Vec<f64> = legendre_at.iter().map(|p| 1.0 / p).collect();
        let differentiation = differentiation(&nodes, &barycentric);
        Self {
            nodes,
            weights,
            barycentric,
            differentiation,
        }
    }

    /// Polynomial degree p.
    pub(super) fn degree(&self) -> usize {
        self.nodes.len() - 1
    }

    /// Nodes, from -1 to 1.
    pub(super) fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// Quadrature weights, whose sum is 2.
    pub(super) fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// One row for each node: applied to nodal values it gives the derivative there.
    pub(super) fn derivative_rows(&self) -> impl Iterator<Item = &[f64]> {
        self.differentiation.chunks_exact(self.nodes.len())
    }

    /// One row for each node `i`: weight `j` times derivative of Lagrange polynomial `i` at node `j`. Applied
    /// to nodal values of a stress it gives the internal forces.
    pub(super) fn weak_derivative(&self) -> Vec<f64> {
        let n = self.nodes.len();
        let entry = |i: usize, j: usize| self.weights[j] * self.differentiation[j * n + i];
        (0..n * n).map(|k| entry(k / n, k % n)).collect()
    }

    /// Value at `xi` of the polynomial with the given value at each node, by the second barycentric formula.
    pub(super) fn interpolate(&self, xi: f64, value: impl Fn(usize) -> f64) -> f64 {
        let (mut numerator, mut denominator) = (0.0, 0.0);
        for (i, (node, weight)) in self.nodes.iter().zip(&self.barycentric).enumerate() {
            let distance = xi - node;
            if distance == 0.0 {
                return value(i);
            }
            numerator += weight / distance * value(i);
            denominator += weight / distance;
        }
        numerator / denominator
    }

    /// Largest eigenvalue of the stiffness matrix against the diagonal mass matrix, both on [-1, 1] and of
    /// unit coefficients.
    ///
    /// An assembled problem cannot exceed the largest eigenvalue of its elements (B. M. Irons and G. Treharne
    /// 1971; I. Fried 1972), because its Rayleigh quotient is a mean of theirs.
    pub(super) fn largest_eigenvalue(&self) -> f64 {
        let n = self.nodes.len();
        let root = |i: usize| self.weights[i].sqrt();
        let scaled = DMatrix::from_fn(n, n, |i, j| root(i) * self.differentiation[i * n + j] / root(j));
        (scaled.transpose() * scaled).symmetric_eigenvalues().max()
    }
}

/// Node `i` of the rule, by Newton's method on `(1 - x^2) P'(x)` from the Chebyshev node.
fn node(degree: usize, i: usize) -> f64 {
    let middle = 2 * i == degree;
    if middle {
        return 0.0;
    }
    let mut x = -(PI * i as f64 / degree as f64).cos();
    // Convergence is quadratic from the Chebyshev node; the count only guards against a last-bit cycle.
    for _ in 0..20 {
        let (value, previous) = legendre(degree, x);
        let correction = (x * value - previous) / ((degree + 1) as f64 * value);
        x -= correction;
        if correction.abs() < 1e-16 {
            break;
        }
    }
    x
}

/// Legendre polynomials of `degree` and of the degree below, at `x`; `degree` is at least 1.
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut value) = (1.0, x);
    for k in 1..degree {
        let k = k as f64;
        (previous, value) = (value, ((2.0 * k + 1.0) * x * value - k * previous) / (k + 1.0));
    }
    (value, previous)
}

/// Differentiation matrix, row by row, from the barycentric weights.
fn differentiation(nodes: &[f64], barycentric: &[f64]) -> Vec<f64> {
    let n = nodes.len();
    let mut matrix = vec![0.0; n * n];
    for (i, row) in matrix.chunks_exact_mut(n).enumerate() {
        let mut sum = 0.0;
        for j in (0..n).filter(|&j| j != i) {
            row[j] = barycentric[j] / barycentric[i] / (nodes[i] - nodes[j]);
            sum += row[j];
        }
        // A constant then has exactly no derivative, which keeps rounding out of the unstretched state.
        row[i] = -sum;
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(a: f64, b: f64, tolerance: f64) {
        assert!((a - b).abs() < tolerance, "{a} against {b}");
    }

    /// Tabulated rule of five points (Abramowitz and Stegun 1964, table 25.6).
    #[test]
    fn degree_four_is_the_tabulated_rule() {
        let rule = Lobatto::new(4);
        let inner = (3.0_f64 / 7.0).sqrt();
        for (node, expected) in rule.nodes().iter().zip([-1.0, -inner, 0.0, inner, 1.0]) {
            assert_close(*node, expected, 1e-15);
        }
        let (end, near, middle) = (0.1, 49.0 / 90.0, 32.0 / 45.0);
        for (weight, expected) in rule.weights().iter().zip([end, near, middle, near, end]) {
            assert_close(*weight, expected, 1e-15);
        }
    }

    /// Exact up to degree 2 p - 1, and not one degree further.
    #[test]
    fn quadrature_has_the_exact_degree() {
        for degree in [1_u8, 2, 5, 8, 16, 32] {
            let rule = Lobatto::new(usize::from(degree));
            let integral = |power: i32| -> f64 {
                rule.nodes()
                    .iter()
                    .zip(rule.weights())
                    .map(|(x, w)| w * x.powi(power))
                    .sum()
            };
            let exact = |power: i32| 2.0 / f64::from(power + 1);
            let highest = 2 * i32::from(degree);
            for power in (0..highest).step_by(2) {
                assert_close(integral(power), exact(power), 1e-14);
            }
            // The excess has a closed form, which falls below rounding at high degree.
            if degree <= 8 {
                assert!(
                    (integral(highest) - exact(highest)).abs() > 1e-6,
                    "degree {degree}"
                );
            }
        }
    }

    #[test]
    fn differentiation_and_interpolation_are_exact_on_polynomials() {
        for degree in [1_u8, 3, 8, 20] {
            let rule = Lobatto::new(usize::from(degree));
            let power = i32::from(degree);
            let values: Vec<f64> = rule.nodes().iter().map(|x| x.powi(power) + x).collect();
            for (row, x) in rule.derivative_rows().zip(rule.nodes()) {
                let derivative: f64 = row.iter().zip(&values).map(|(d, v)| d * v).sum();
                assert_close(derivative, f64::from(power) * x.powi(power - 1) + 1.0, 1e-11);
            }
            for xi in [-1.0, -0.77, 0.0, 0.3, 1.0] {
                assert_close(rule.interpolate(xi, |i| values[i]), xi.powi(power) + xi, 1e-13);
            }
        }
    }

    /// Summation by parts: the weak derivative of a stress is minus its strong one, but for the end terms.
    #[test]
    fn weak_derivative_integrates_by_parts() {
        let rule = Lobatto::new(6);
        let n = rule.nodes().len();
        let stress: Vec<f64> = rule.nodes().iter().map(|x| x.powi(3) - 0.2).collect();
        for (i, row) in rule.weak_derivative().chunks_exact(n).enumerate() {
            let weak: f64 = row.iter().zip(&stress).map(|(g, s)| g * s).sum();
            let strong = rule.weights()[i] * 3.0 * rule.nodes()[i].powi(2);
            let end = if i == 0 {
                -stress[0]
            } else if i == n - 1 {
                stress[i]
            } else {
                0.0
            };
            assert_close(weak, end - strong, 1e-13);
        }
    }

    /// By hand. Degree 1: masses 1, stiffness [1, -1; -1, 1] / 2. Degree 2: masses [1, 4, 1] / 3, stiffness
    /// [7, -8, 1; -8, 16, -8; 1, -8, 7] / 6; the largest eigenvector is (2, -1, 2).
    #[test]
    fn largest_eigenvalue_of_the_smallest_elements() {
        assert_close(Lobatto::new(1).largest_eigenvalue(), 1.0, 1e-14);
        assert_close(Lobatto::new(2).largest_eigenvalue(), 6.0, 1e-13);
    }
}
