//! Accelerations of both phases with the particles' consistent matrices, one dimension.
//!
#![doc = include_str!("../../../docs/formulas.html")]
//!
//! With $M_s$, $\bar M$ the matrices of the solid's and the liquid's mass and $D = n\sum_p d_p\phi\phi^T$
//! that of the drag, the balances of the whole and, times the porosity, of the liquid are
//!
//! $$(M_s + \bar M) a_s + \bar M r = f + (M_s + \bar M) b,$$
//! $$\bar M a_s + (\bar M + \Delta t D) r = n f_w + \bar M b - D (v_w - v_s),$$
//!
//! $r = a_w - a_s$ the change of the slip ($\Delta t D$ on the left only where the drag is felt at the step's
//! end). The matrix is symmetric and positive, and since the drag stands beside the slip alone, the momentum
//! of the whole keeps all its digits however strong it is: in $a_s$ and $a_w$ it would be a difference of
//! numbers the size of the drag.

use nalgebra::{SMatrix, SVector};

use super::super::acceleration::Walls;
use super::super::matrix::MassMatrix;
use super::seal::Components;
use crate::basis::BasisFamily;
use crate::field::Pair;
use crate::grid::Grid;
use crate::mass::Banded;
use crate::scalar::Scalar;

/// What two phases need besides where the particles' matrices are used.
#[derive(Clone, Debug)]
pub(in super::super) struct Joint<T, const D: usize> {
    /// Mass of each particle's liquid at the step's start.
    pub(super) liquid_mass: Vec<T>,
    /// Drag of each particle times the porosity.
    pub(super) drag_of: Vec<T>,
    /// Stress and pressure of each particle, and the velocity of its liquid, as they are relaxed.
    pub(super) state: Vec<Pair<SMatrix<T, D, D>, T>>,
    pub(super) liquid_velocity: Vec<SVector<T, D>>,
    pub(super) drag: MassMatrix<T, D>,
    /// Unknown `2 i` is the acceleration of DOF `i`, `2 i + 1` that of its slip over `slip_scale`.
    matrix: Banded<T>,
    slip_scale: T,
    pub(super) right: Vec<SVector<T, D>>,
    /// Answer to a pressure on a sealed surface.
    pub(super) response: Vec<SVector<T, D>>,
}

impl<T: Scalar, const D: usize> Joint<T, D> {
    /// Where it is not needed.
    pub(in super::super) fn none() -> Self {
        Self {
            liquid_mass: Vec::new(),
            drag_of: Vec::new(),
            state: Vec::new(),
            liquid_velocity: Vec::new(),
            drag: MassMatrix::none(),
            matrix: Banded::zeros(0, 0),
            slip_scale: T::one(),
            right: Vec::new(),
            response: Vec::new(),
        }
    }

    /// Mass of each particle's liquid at the step's start.
    pub(in super::super) fn liquid_masses(&self) -> &[T] {
        &self.liquid_mass
    }

    /// For so many particles and the DOFs of `basis`.
    pub(in super::super) fn new<B: BasisFamily<T, D>>(
        basis: &B,
        grid: &Grid<T, D>,
        particles: usize,
    ) -> Self {
        let count = basis.dof_count(grid);
        Self {
            liquid_mass: vec![T::zero(); particles],
            drag_of: vec![T::zero(); particles],
            state: vec![Pair(SMatrix::zeros(), T::zero()); particles],
            liquid_velocity: vec![SVector::zeros(); particles],
            drag: MassMatrix::new(basis, grid, false),
            matrix: Banded::zeros(2 * count, 2 * basis.half_band(grid) + 1),
            slip_scale: T::one(),
            right: vec![SVector::zeros(); 2 * count],
            response: vec![SVector::zeros(); 2 * count],
        }
    }

    pub(in super::super) fn bytes(&self) -> usize {
        let scalars = self.liquid_mass.len() + self.drag_of.len() + self.matrix.len();
        let vectors = self.liquid_velocity.len() + self.right.len() + self.response.len();
        size_of::<T>() * scalars
            + size_of::<SVector<T, D>>() * vectors
            + size_of::<Pair<SMatrix<T, D, D>, T>>() * self.state.len()
            + self.drag.bytes()
    }

    /// Takes in the matrices of both masses; `dt` is zero where the drag of the step's start is felt.
    pub(super) fn assemble(&mut self, solid: &Banded<T>, liquid: &Banded<T>, dt: T) {
        let drag = self.drag.band();
        // The slip in units in which its part of the matrix is as large as the others, so that no pivot seems
        // to vanish.
        let mass = liquid.total();
        self.slip_scale = if mass > T::zero() {
            (mass / (mass + drag.total() * dt)).sqrt()
        } else {
            T::one()
        };
        let scale = self.slip_scale;
        self.matrix.clear();
        for i in 0..self.right.len() / 2 {
            for j in i.saturating_sub(solid.half_band())..=i {
                let (m_s, m_w, d) = (solid.get(i, j), liquid.get(i, j), drag.get(i, j));
                self.matrix.add(2 * i, 2 * j, m_s + m_w);
                self.matrix.add(2 * i + 1, 2 * j, m_w * scale);
                if j < i {
                    self.matrix.add(2 * i, 2 * j + 1, m_w * scale);
                }
                self.matrix
                    .add(2 * i + 1, 2 * j + 1, (m_w + d * dt) * (scale * scale));
            }
        }
    }

    /// Solves, with the told accelerations at held DOFs.
    pub(super) fn solve(&mut self, [of_solid, of_liquid]: [Walls<'_, T, D>; 2]) {
        let (matrix, right) = (&mut self.matrix, &mut self.right);
        for slip in right.iter_mut().skip(1).step_by(2) {
            *slip *= self.slip_scale;
        }
        of_solid.for_each_held(|dof, axis, _, told| matrix.prescribe(2 * dof, axis, told, right));
        // What holds the liquid holds the solid too, and tells both the same.
        of_liquid.for_each_held(|dof, axis, _, _| matrix.prescribe(2 * dof + 1, axis, T::zero(), right));
        matrix.factorise();
        for axis in 0..D {
            matrix.solve(right, axis);
        }
        for slip in right.iter_mut().skip(1).step_by(2) {
            *slip *= self.slip_scale;
        }
    }

    /// Makes `response` the answer to the force of sealed surfaces on the liquid.
    pub(super) fn respond_to(&mut self, components: &Components<T>, walls: [Walls<'_, T, D>; 2]) {
        self.response.fill(SVector::zeros());
        for ((dof, axis), &force) in components.places::<D>().zip(&components.force) {
            self.response[2 * dof + 1][axis] = force;
        }
        self.respond(walls);
    }

    /// Makes `response` the answer to the right-hand side that it holds, which must not load what is held.
    fn respond(&mut self, [of_solid, of_liquid]: [Walls<'_, T, D>; 2]) {
        let response = &mut self.response;
        for slip in response.iter_mut().skip(1).step_by(2) {
            *slip *= self.slip_scale;
        }
        of_solid.for_each_held(|dof, axis, _, _| response[2 * dof][axis] = T::zero());
        of_liquid.for_each_held(|dof, axis, _, _| response[2 * dof + 1][axis] = T::zero());
        for axis in 0..D {
            self.matrix.solve(response, axis);
        }
        for slip in response.iter_mut().skip(1).step_by(2) {
            *slip *= self.slip_scale;
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use nalgebra::vector;

    use super::*;
    use crate::basis::Linear;
    use crate::stepper::Forcing;

    /// Of a chain of five DOFs, with the shares of a linear mass matrix.
    fn fill(matrix: &mut Banded<f64>, mass: f64) {
        for i in 0..5 {
            matrix.add(i, i, mass * if i % 4 == 0 { 2.0 } else { 4.0 });
            if i > 0 {
                matrix.add(i, i - 1, mass);
            }
        }
    }

    /// Both equations with every entry, for drags from none to 1e12 masses; the sum of the first is the
    /// momentum of the whole.
    #[test]
    fn the_momentum_of_the_whole_keeps_its_digits_under_any_drag() {
        let grid = Grid::new(vector![0.0], vector![4.0], [4]).unwrap();
        let (mut solid, mut liquid) = (Banded::zeros(5, 1), Banded::zeros(5, 1));
        fill(&mut solid, 3.0);
        fill(&mut liquid, 0.7);
        for drag in [0.0, 1.0, 1e6, 1e12] {
            let mut joint = Joint::<f64, 1>::new(&Linear, &grid, 0);
            fill(joint.drag.band_mut(), drag);
            let right: Vec<_> = (0..10).map(|k| vector![f64::from(k * k % 7) - 2.5]).collect();
            joint.right.copy_from_slice(&right);
            joint.assemble(&solid, &liquid, 0.5);
            let forcing = Forcing::none();
            joint.solve([Walls::of_solid(&[], &forcing), Walls::of_liquid(&[], &forcing)]);
            let of =
                |first: usize| -> Vec<_> { joint.right.iter().skip(first).step_by(2).copied().collect() };
            let (acceleration, slip) = (of(0), of(1));
            let [s, w, d] = [
                solid.multiply(&acceleration),
                liquid.multiply(&acceleration),
                liquid.multiply(&slip),
            ];
            let (mut whole, mut wished) = (0.0, 0.0);
            for i in 0..5 {
                let found = s[i][0] + w[i][0] + d[i][0];
                assert_relative_eq!(found, right[2 * i][0], epsilon = 1e-13);
                whole += found;
                wished += right[2 * i][0];
            }
            assert_relative_eq!(whole, wished, epsilon = 1e-13);
            let resisted = joint.drag.band().multiply(&slip);
            for i in 0..5 {
                let found = w[i][0] + d[i][0] + 0.5 * resisted[i][0];
                assert_relative_eq!(found, right[2 * i + 1][0], epsilon = 1e-12);
            }
        }
    }
}
