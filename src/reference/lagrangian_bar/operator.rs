//! The semi-discrete equation of motion on spectral elements.

use super::super::{ReferenceError, State, UniaxialLaw, lobatto::Lobatto};
use super::resolution::HIGHEST_DEGREE;
use super::{BarProblem, End, Resolution};

/// Mesh, masses and derivatives: all that does not change in time.
///
/// Nodes are numbered from the left; neighbouring elements share one.
#[derive(Clone, Debug)]
pub(super) struct Operator {
    rule: Lobatto,
    /// Row `i` of an element: what the stress at each of its nodes contributes to the internal force on node
    /// `i`.
    weak_derivative: Vec<f64>,
    /// Mass of each node, kg/m2.
    mass: Vec<f64>,
    largest_eigenvalue: f64,
    elements: usize,
    element_size: f64,
    length: f64,
    density: f64,
    ends: [End; 2],
}

impl Operator {
    /// The equation of `problem` on the mesh of `resolution`, both of them checked.
    pub(super) fn new<L>(problem: &BarProblem<L>, resolution: Resolution) -> Self {
        let rule = Lobatto::new(resolution.degree);
        let element_size = problem.length / resolution.elements as f64;
        Self {
            weak_derivative: rule.weak_derivative(),
            mass: assemble_mass(&rule, resolution.elements, 0.5 * element_size * problem.density),
            largest_eigenvalue: rule.largest_eigenvalue(),
            rule,
            elements: resolution.elements,
            element_size,
            length: problem.length,
            density: problem.density,
            ends: problem.ends,
        }
    }

    /// Mass of each node, kg/m2.
    pub(super) fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// Number of nodes.
    pub(super) fn node_count(&self) -> usize {
        self.mass.len()
    }

    /// Distance of a node from the left end, m.
    pub(super) fn coordinate(&self, node: usize) -> f64 {
        let (element, local) = (node / self.rule.degree(), node % self.rule.degree());
        (element as f64 + 0.5 * (1.0 + self.rule.nodes()[local])) * self.element_size
    }

    /// Sets the values of a motion at fixed ends to 0.
    pub(super) fn hold(&self, values: &mut [f64]) {
        let [left, right] = self.ends;
        for (end, value) in [(left, 0), (right, self.node_count() - 1)] {
            if end == End::Fixed {
                values[value] = 0.0;
            }
        }
    }

    /// Writes the acceleration, m/s2, of each node under `displacement`, m, and `body_force`, N/kg.
    pub(super) fn acceleration(
        &self,
        law: &impl UniaxialLaw,
        time: f64,
        displacement: &[f64],
        body_force: f64,
        out: &mut [f64],
    ) -> Result<(), ReferenceError> {
        let nodes = self.rule.nodes().len();
        let stress = &mut [0.0; HIGHEST_DEGREE + 1][..nodes];
        out.fill(0.0);
        for (index, element) in self.elements_of(displacement).enumerate() {
            let mut sound = true;
            for (stress, stretch) in stress.iter_mut().zip(self.stretches(element)) {
                sound &= is_valid_volume(stretch);
                *stress = law.stress(stretch);
            }
            if !sound {
                return Err(self.invalid_stretch(index, element, time));
            }
            let first = index * self.rule.degree();
            let forces = &mut out[first..first + nodes];
            for (force, row) in forces.iter_mut().zip(self.weak_derivative.chunks_exact(nodes)) {
                *force -= dot(row, stress);
            }
        }
        for (acceleration, mass) in out.iter_mut().zip(&self.mass) {
            *acceleration = *acceleration / mass + body_force;
        }
        self.hold(out);
        Ok(())
    }

    /// Bound, rad/s, of the largest frequency of small motions about `displacement`.
    pub(super) fn largest_frequency(
        &self,
        law: &impl UniaxialLaw,
        time: f64,
        displacement: &[f64],
    ) -> Result<f64, ReferenceError> {
        let mut largest = 0.0_f64;
        for (index, element) in self.elements_of(displacement).enumerate() {
            for stretch in self.stretches(element) {
                if !is_valid_volume(stretch) {
                    return Err(self.invalid_stretch(index, element, time));
                }
                let stiffness = law.stiffness(stretch);
                if !is_valid_volume(stiffness) {
                    return Err(ReferenceError::NotHyperbolic { stretch, stiffness });
                }
                largest = largest.max(stiffness);
            }
        }
        Ok(2.0 / self.element_size * (self.largest_eigenvalue * largest / self.density).sqrt())
    }

    /// Integral over the bar of `f`, a function of the stretch, by the quadrature of the scheme.
    pub(super) fn integrate(&self, displacement: &[f64], f: impl Fn(f64) -> f64) -> f64 {
        let sum_of = |element| -> f64 {
            self.stretches(element)
                .zip(self.rule.weights())
                .map(|(stretch, weight)| weight * f(stretch))
                .sum()
        };
        0.5 * self.element_size * self.elements_of(displacement).map(sum_of).sum::<f64>()
    }

    /// Points of the quadrature, as distances from the left end, m, and their weights, m.
    pub(super) fn quadrature(&self) -> impl Iterator<Item = (f64, f64)> {
        let half = 0.5 * self.element_size;
        (0..self.elements).flat_map(move |element| {
            let points = self.rule.nodes().iter().zip(self.rule.weights());
            points.map(move |(xi, weight)| ((2.0 * element as f64 + 1.0 + xi) * half, weight * half))
        })
    }

    /// State at the distance `x`, m, from the left end; beyond the ends, the state of the end.
    ///
    /// The stress is the law's at the interpolated stretch, which at the edge of two elements is the right
    /// one's.
    pub(super) fn state(
        &self,
        law: &impl UniaxialLaw,
        displacement: &[f64],
        velocity: &[f64],
        x: f64,
    ) -> State {
        let scaled = x.clamp(0.0, self.length) / self.element_size;
        let element = (scaled as usize).min(self.elements - 1);
        let xi = 2.0 * (scaled - element as f64) - 1.0;

        let first = element * self.rule.degree();
        let nodes = first..=first + self.rule.degree();
        let (displacement, velocity) = (&displacement[nodes.clone()], &velocity[nodes]);
        let mut stretch = [0.0; HIGHEST_DEGREE + 1];
        for (slot, value) in stretch.iter_mut().zip(self.stretches(displacement)) {
            *slot = value;
        }
        State {
            displacement: self.rule.interpolate(xi, |i| displacement[i]),
            velocity: self.rule.interpolate(xi, |i| velocity[i]),
            stress: law.stress(self.rule.interpolate(xi, |i| stretch[i])),
        }
    }

    /// The nodal values of each element.
    fn elements_of<'a>(&self, values: &'a [f64]) -> impl Iterator<Item = &'a [f64]> {
        values
            .windows(self.rule.nodes().len())
            .step_by(self.rule.degree())
    }

    /// Stretch at each node of an element.
    fn stretches(&self, element: &[f64]) -> impl Iterator<Item = f64> {
        let scale = 2.0 / self.element_size;
        self.rule
            .derivative_rows()
            .map(move |row| 1.0 + scale * dot(row, element))
    }

    /// Says where in an element the stretch is invalid.
    fn invalid_stretch(&self, index: usize, element: &[f64], time: f64) -> ReferenceError {
        let (local, stretch) = self
            .stretches(element)
            .enumerate()
            .find(|(_, stretch)| !is_valid_volume(*stretch))
            .unwrap_or((0, f64::NAN));
        let position = self.coordinate(index * self.rule.degree() + local);
        ReferenceError::InvalidStretch {
            time,
            position,
            stretch,
        }
    }
}

/// Whether a stretch or a stiffness is one that the equation can go on with.
fn is_valid_volume(value: f64) -> bool {
    value > 0.0 && value < f64::INFINITY
}

/// Masses of the nodes: quadrature weights times `scale`, added where elements meet.
fn assemble_mass(rule: &Lobatto, elements: usize, scale: f64) -> Vec<f64> {
    let mut mass = vec![0.0; elements * rule.degree() + 1];
    for element in 0..elements {
        for (local, weight) in rule.weights().iter().enumerate() {
            mass[element * rule.degree() + local] += scale * weight;
        }
    }
    mass
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::super::super::Linear;
    use super::*;

    const LAW: Linear = Linear { youngs_modulus: 3.0 };

    fn operator(ends: [End; 2]) -> Operator {
        let problem = BarProblem::new(2.0, 5.0, LAW).ends(ends[0], ends[1]);
        Operator::new(
            &problem,
            Resolution {
                elements: 3,
                degree: 4,
            },
        )
    }

    fn nodal(operator: &Operator, f: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..operator.node_count())
            .map(|node| f(operator.coordinate(node)))
            .collect()
    }

    #[test]
    fn masses_and_quadrature_measure_the_bar() {
        let operator = operator([End::Fixed, End::Free]);
        assert!((operator.mass().iter().sum::<f64>() - 10.0).abs() < 1e-13);
        let moment: f64 = operator.quadrature().map(|(x, weight)| weight * x.powi(3)).sum();
        assert!((moment - 4.0).abs() < 1e-13, "{moment}");
        let squares = operator.integrate(&nodal(&operator, |x| 0.1 * x * x), |stretch| stretch * stretch);
        let exact = 2.0 + 0.4 * 2.0 + 0.04 * 8.0 / 3.0;
        assert!((squares - exact).abs() < 1e-13, "{squares} against {exact}");
    }

    /// Under u = X^3 - 12 X the free right end, at 2, bears no stress, and E u_XX / rho = 18 X / 5
    /// everywhere.
    #[test]
    fn acceleration_is_the_divergence_of_the_stress() {
        let operator = operator([End::Fixed, End::Free]);
        let displacement = nodal(&operator, |x| 0.01 * (x.powi(3) - 12.0 * x));
        let mut acceleration = vec![0.0; operator.node_count()];
        operator
            .acceleration(&LAW, 0.0, &displacement, 7.0, &mut acceleration)
            .unwrap();
        assert_eq!(acceleration[0], 0.0);
        for (node, a) in acceleration.iter().enumerate().skip(1) {
            let exact = 0.036 * operator.coordinate(node) + 7.0;
            assert!((a - exact).abs() < 1e-12, "{a} against {exact} at node {node}");
        }
    }

    /// The frequency bound lies above the largest eigenfrequency, which power iteration finds, but not far.
    #[test]
    fn frequency_bound_is_sharp() {
        let operator = operator([End::Free, End::Free]);
        let rest = vec![0.0; operator.node_count()];
        let bound = operator.largest_frequency(&LAW, 0.0, &rest).unwrap();
        let mut mode = nodal(&operator, |x| 1e-3 * (40.0 * x).sin());
        let mut image = rest;
        let mut growth = 0.0;
        for _ in 0..500 {
            operator.acceleration(&LAW, 0.0, &mode, 0.0, &mut image).unwrap();
            growth = norm(&image) / norm(&mode);
            let scale = 1e-3 / norm(&image);
            mode = image.iter().map(|a| a * scale).collect();
        }
        let largest = growth.sqrt();
        assert!(
            largest <= bound * (1.0 + 1e-12) && largest > 0.9 * bound,
            "{largest} against {bound}"
        );
    }

    fn norm(values: &[f64]) -> f64 {
        dot(values, values).sqrt()
    }

    #[test]
    fn inverted_element_is_refused_and_located() {
        let operator = operator([End::Fixed, End::Free]);
        let displacement = nodal(&operator, |x| -0.3 * x * x);
        let mut acceleration = vec![0.0; operator.node_count()];
        let result = operator.acceleration(&LAW, 4.0, &displacement, 0.0, &mut acceleration);
        let Err(ReferenceError::InvalidStretch {
            time,
            position,
            stretch,
        }) = result
        else {
            panic!("{result:?}");
        };
        assert_eq!(time, 4.0);
        // J = 1 - 0.6 X is first negative at the first node beyond 5/3.
        assert!(
            position > 5.0 / 3.0 && position < 1.9 && stretch <= 0.0,
            "{position} {stretch}"
        );
        assert!((stretch - (1.0 - 0.6 * position)).abs() < 1e-12);
    }
}
