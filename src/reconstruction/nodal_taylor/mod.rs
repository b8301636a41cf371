//! Taylor least squares on the patches of the nodes, blended.

mod fit;
mod nodes;
mod patches;
mod relax;
#[cfg(test)]
mod tests;

use nalgebra::SVector;

use super::{Anywhere, Cloud, CourantNumbers, Filling, Filter, Filters, NullSpace, Point, Reconstruction};
use crate::basis::BasisFamily;
use crate::field::Field;
use crate::mass::ParticleSeries;
use crate::quadrature::gauss_legendre;
use crate::scalar::Scalar;
use nodes::Nodes;
use patches::Patches;

/// Taylor least squares that fade where a field is rough: plain MPM with the quadrature error of what is
/// smooth taken out. Our own.
///
/// Every node $a$ of the grid has a patch, the cells around it, weighted with its (multi)linear hat $\chi_a$.
/// The particles there, nine in four cells of a plane where a fit of a cell has but its own, determine a
/// quadratic polynomial $P_a\sigma$ by least squares weighted with $V_p\chi_a$. The force is that of the
/// particles and, where the fit holds, the difference between the integral of the fit and its sum over the
/// particles,
///
/// $$f_i = -\sum_p V_p\,\sigma_p\nabla\varphi_i(x_p) - \sum_a\theta_a\Bigl[\int\chi_a P_a\sigma\,
///   \nabla\varphi_i - \sum_p V_p\,(\chi_a P_a\sigma\,\nabla\varphi_i)(x_p)\Bigr].$$
///
/// With $\theta_a = 0$ that is plain MPM. $\theta_a$ goes there on its own, continuously as particles move:
/// where a patch is not filled (free sides), and where the fit leaves more than a share of the stress
/// (collisions, sand that flows, splashing water). Hats overlap and add up to one, so that nothing jumps as
/// particles cross from cell to cell.
///
/// Momenta are divided by terms of the series of the consistent matrix ([`ParticleSeries`]), and what the
/// patches do not see of stress and velocity is relaxed, by $\sum_a b_a\theta_a\chi_a(P_a - 1)$: an operator
/// that is self-adjoint in the product of the masses and never raises the kinetic energy; it keeps momentum
/// and angular momentum patch by patch.
///
/// It is not linear in the stress, so [`crate::testing::check_reconstruction`] does not serve it. One thread
/// streams it so far, and one phase only has it. Derivation and figures are in `docs/theory/nodal-tls.md`.
#[doc = include_str!("../../../docs/formulas.html")]
#[derive(Clone, Debug)]
pub struct NodalTaylor<T, const D: usize, const NB: usize> {
    /// Gauss points of a cell, coordinates from 0 to 1, with their shares of it.
    points: Vec<([T; D], T)>,
    /// Shares of a field that its fits leave: up to the first a patch is smooth, from the second on rough.
    roughness: [T; 2],
    /// Of the velocity for each cell that a wave crosses, of the stress for each that the particles cross.
    rates: [T; 2],
    nodes: Nodes<D>,
    patches: Patches<T, D, NB>,
    /// How far patches are filled.
    filled: Vec<T>,
    /// How smooth the stress is there.
    smooth: Vec<T>,
    /// Shares by which patches count, in the force and in a relaxation.
    shares: Vec<T>,
    /// Parts of a cell that are crossed in a step.
    crossed: Vec<CourantNumbers<T>>,
}

impl<T: Scalar, const D: usize, const NB: usize> NodalTaylor<T, D, NB> {
    /// For a basis: enough Gauss points for the products of a patch's polynomial, its hat and the gradients.
    /// Linear functions strain a stress that is nearly constant in a cell, which no fit follows: more counts
    /// as smooth there.
    pub fn for_basis<B: BasisFamily<T, D>>(basis: &B) -> Self {
        let roughness = match basis.degree() {
            0 | 1 => [0.25, 0.5],
            _ => [0.08, 0.15],
        };
        Self {
            points: gauss_points((basis.degree() + 5) / 2),
            roughness: roughness.map(T::lit),
            rates: [3.0, 2.0].map(T::lit),
            nodes: Nodes::none(),
            patches: Patches::none(),
            filled: Vec::new(),
            smooth: Vec::new(),
            shares: Vec::new(),
            crossed: Vec::new(),
        }
    }

    /// With other rates: of the velocity, for each cell that a wave crosses, and of the stress, for each that
    /// the particles cross. Weaker ones lose less energy in collisions, and let thin beams shear.
    #[must_use]
    pub fn with_rates(mut self, velocity: T, stress: T) -> Self {
        self.rates = [velocity, stress];
        self
    }

    /// With other shares of the stress that fits leave where a patch begins and ends to fade.
    #[must_use]
    pub fn with_roughness(mut self, from: T, to: T) -> Self {
        self.roughness = [from, to];
        self
    }

    /// Makes room for all nodes there are, so that no later step has to allocate.
    fn reserve(&mut self, nodes: usize, components: usize) {
        self.nodes.reserve(nodes);
        self.patches.reserve(nodes, components);
        for values in [&mut self.filled, &mut self.smooth, &mut self.shares] {
            make_room(values, nodes);
        }
        make_room(&mut self.crossed, nodes);
    }

    /// Streams the blended fit over the cells around the patches that count.
    fn integrate_blend<Q: Field<T>>(&self, cloud: &Cloud<'_, T, D>, sink: &mut impl FnMut(&Point<T, D>, Q)) {
        let (grid, shares) = (cloud.grid, &self.shares[..]);
        let counts = |node: usize| shares[node] > T::zero();
        for node in (0..self.nodes.len()).filter(|&node| counts(node)) {
            self.nodes.for_each_cell_around(grid, node, |cell| {
                // Each cell once: with the first of its nodes that counts.
                if self.nodes.first_corner(&cell, &counts) != Some(node) {
                    return;
                }
                let least = SVector::from_fn(|axis, _| grid.edge(axis, cell[axis] as usize));
                for (u, share) in &self.points {
                    let value: Q = self.patches.blend(&self.nodes, shares, (&cell, u));
                    let position = least + SVector::from(*u).component_mul(grid.cell_size());
                    sink(
                        &Point::fixed(cell, position),
                        value.scaled(grid.cell_volume() * *share),
                    );
                }
            });
        }
    }
}

/// Makes room for so many values in all.
fn make_room<A>(values: &mut Vec<A>, count: usize) {
    values.reserve(count.saturating_sub(values.len()));
}

/// Products of `count` Gauss points along each axis, from 0 to 1, with their shares.
fn gauss_points<T: Scalar, const D: usize>(count: usize) -> Vec<([T; D], T)> {
    let (line, two) = (gauss_legendre::<T>(count), T::lit(2.0));
    let points = (0..line.len().pow(D as u32)).map(|mut number| {
        let mut share = T::one();
        let point = std::array::from_fn(|_| {
            let (x, weight) = line[number % line.len()];
            number /= line.len();
            share *= weight / two;
            (T::one() + x) / two
        });
        (point, share)
    });
    points.collect()
}

/// The functions of a patch at coordinates relative to its node, in cells: 1; s, t, r; s^2/2, ...; s t, ...
#[inline(always)]
fn functions<T: Scalar, const D: usize, const NB: usize>(s: &[T; D]) -> [T; NB] {
    const {
        assert!(
            NB == (D + 1) * (D + 2) / 2,
            "a patch has 3, 6 or 10 functions in 1, 2 or 3 dimensions"
        )
    };
    let two = T::lit(2.0);
    let mut psi = [T::one(); NB];
    let mut k = 1 + 2 * D;
    for a in 0..D {
        psi[1 + a] = s[a];
        psi[1 + D + a] = s[a] * s[a] / two;
        for b in a + 1..D {
            psi[k] = s[a] * s[b];
            k += 1;
        }
    }
    psi
}

impl<T: Scalar, const D: usize, const NB: usize> Reconstruction<T, D> for NodalTaylor<T, D, NB> {
    type Points = Anywhere;
    type Mass = ParticleSeries;
    type Filter = NullSpace;

    fn prepare(&mut self, cloud: &Cloud<'_, T, D>) {
        let nodes = cloud.grid.window().shape().map(|cells| cells + 1);
        self.reserve(nodes.iter().product(), D * D);
        self.nodes.number(cloud);
        self.patches.take_in(&self.nodes, cloud, cloud.volumes);
        self.measure_filling(cloud);
        self.smooth.clear();
        self.smooth.resize(self.nodes.len(), T::one());
    }

    fn integrate<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        value: impl Fn(usize) -> Q,
        mut sink: impl FnMut(&Point<T, D>, Q),
    ) {
        self.patches.fit(&self.nodes, cloud, cloud.volumes, &value);
        self.measure_smoothness();
        self.shares.clear();
        let shares = self.filled.iter().zip(&self.smooth);
        self.shares
            .extend(shares.map(|(&filled, &smooth)| filled * smooth));
        for p in 0..cloud.positions.len() {
            let (cell, u) = nodes::local(cloud, p);
            let seen: Q = self.patches.blend(&self.nodes, &self.shares, (&cell, &u));
            let mut rest = value(p);
            rest.add_scaled(-T::one(), seen);
            sink(&Point::of_particle(cloud, p), rest.scaled(cloud.volumes[p]));
        }

        self.integrate_blend(cloud, &mut sink);
    }

    fn bytes(&self) -> usize {
        self.nodes.bytes()
            + self.patches.bytes()
            + size_of::<([T; D], T)>() * self.points.capacity()
            + size_of::<T>() * (self.filled.capacity() + self.smooth.capacity() + self.shares.capacity())
            + size_of::<CourantNumbers<T>>() * self.crossed.capacity()
    }
}

impl<T: Scalar, const D: usize, const NB: usize> Filter<T, D, NodalTaylor<T, D, NB>> for NullSpace {}

impl<T: Scalar, const D: usize, const NB: usize> Filters<T, D, NodalTaylor<T, D, NB>> for NullSpace {
    const FILTERS: bool = true;

    fn relax<Q: Field<T>>(
        fits: &mut NodalTaylor<T, D, NB>,
        cloud: &Cloud<'_, T, D>,
        crossed: &[CourantNumbers<T>],
        values: &mut [Q],
    ) {
        fits.relax_stress(cloud, crossed, values);
    }

    fn relax_weighted<Q: Field<T>>(
        fits: &mut NodalTaylor<T, D, NB>,
        cloud: &Cloud<'_, T, D>,
        weights: &[T],
        _crossed: &[CourantNumbers<T>],
        values: &mut [Q],
    ) {
        fits.relax_velocity(cloud, weights, values);
    }

    /// A series needs no function tied or lumped.
    fn filling(_fits: &NodalTaylor<T, D, NB>, _place: usize) -> Filling {
        Filling::Filled
    }
}
