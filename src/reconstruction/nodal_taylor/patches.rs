//! The fits of all patches.

use super::fit::PatchFit;
use super::functions;
use super::nodes::{Corner, Nodes, local};
use crate::field::Field;
use crate::grid::Cell;
use crate::quadrature::gauss_legendre;
use crate::reconstruction::Cloud;
use crate::scalar::Scalar;

/// Share of the stress that counts as seen whatever the fit says: round-off of a uniform stress is no
/// roughness.
const FLOOR: f64 = 0.03;

/// The fit of each node's patch.
#[derive(Clone, Debug)]
pub(super) struct Patches<T, const D: usize, const NB: usize> {
    fits: Vec<PatchFit<T, NB>>,
    /// Coefficients of the last field, by node and component.
    coefficients: Vec<[T; NB]>,
    /// Sum of weighted squares of the field, then the share of it that the fit leaves.
    left: Vec<T>,
    /// Pivots of a full patch, by the axes along which a side of the grid halves it.
    full: Vec<[T; NB]>,
}

impl<T: Scalar, const D: usize, const NB: usize> Patches<T, D, NB> {
    pub(super) fn none() -> Self {
        Self {
            fits: Vec::new(),
            coefficients: Vec::new(),
            left: Vec::new(),
            full: (0..1 << D).map(full_pivots::<T, D, NB>).collect(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<PatchFit<T, NB>>() * self.fits.capacity()
            + size_of::<[T; NB]>() * (self.coefficients.capacity() + self.full.capacity())
            + size_of::<T>() * self.left.capacity()
    }

    pub(super) fn reserve(&mut self, nodes: usize, components: usize) {
        super::make_room(&mut self.fits, nodes);
        super::make_room(&mut self.coefficients, nodes * components);
        super::make_room(&mut self.left, nodes);
    }

    /// Takes in where the particles are, and their weights.
    pub(super) fn take_in(&mut self, nodes: &Nodes<D>, cloud: &Cloud<'_, T, D>, weights: &[T]) {
        self.fits.clear();
        self.fits.resize(nodes.len(), PatchFit::zero());
        for (p, &weight) in weights.iter().enumerate() {
            let (cell, u) = local(cloud, p);
            nodes.for_each_corner(&cell, &u, |corner| {
                self.fits[corner.node].add(weight * corner.hat, &functions::<T, D, NB>(&corner.s));
            });
        }
        for (node, fit) in self.fits.iter_mut().enumerate() {
            fit.factorise(&self.full[nodes.halved(cloud.grid, node)]);
        }
    }

    /// Sum of the weights of a patch.
    pub(super) fn total(&self, node: usize) -> T {
        self.fits[node].total()
    }

    /// Whether a patch keeps all linear functions.
    pub(super) fn is_linear(&self, node: usize) -> bool {
        self.fits[node].keeps(D + 1)
    }

    /// Share of the last field that the fit of a patch leaves, from 0 to 1: the root of the squares of what
    /// is left over those of what varies.
    pub(super) fn left(&self, node: usize) -> T {
        self.left[node]
    }

    /// Fits a field, with the weights that were taken in.
    pub(super) fn fit<Q: Field<T>>(
        &mut self,
        nodes: &Nodes<D>,
        cloud: &Cloud<'_, T, D>,
        weights: &[T],
        value: &impl Fn(usize) -> Q,
    ) {
        let components = Q::COMPONENTS;
        self.coefficients.clear();
        self.coefficients
            .resize(nodes.len() * components, [T::zero(); NB]);
        self.left.clear();
        self.left.resize(nodes.len(), T::zero());
        for (p, &weight) in weights.iter().enumerate() {
            let (cell, u) = local(cloud, p);
            let value = value(p);
            let square = sum_of_squares::<T, D, Q>(|q| value.component(q) * value.component(q));
            nodes.for_each_corner(&cell, &u, |corner| {
                let psi = functions::<T, D, NB>(&corner.s);
                let weight = corner.hat * weight;
                self.left[corner.node] += weight * square;
                for q in 0..components {
                    let scaled = weight * value.component(q);
                    let sums = &mut self.coefficients[corner.node * components + q];
                    for k in 0..NB {
                        sums[k] += scaled * psi[k];
                    }
                }
            });
        }
        let each = self.coefficients.chunks_mut(components.max(1));
        for ((fit, left), sums) in self.fits.iter().zip(&mut self.left).zip(each) {
            *left = solve::<T, D, NB, Q>(fit, sums, *left);
        }
    }

    /// What the blended fits see of a field at a point of a cell.
    #[inline(always)]
    pub(super) fn blend<Q: Field<T>>(
        &self,
        nodes: &Nodes<D>,
        shares: &[T],
        (cell, u): (&Cell<D>, &[T; D]),
    ) -> Q {
        let mut value = Q::zero();
        nodes.for_each_corner(cell, u, |corner| {
            let share = shares[corner.node] * corner.hat;
            if share > T::zero() {
                self.add_fit(&corner, share, &mut value);
            }
        });
        value
    }

    /// Adds what the fit of a patch sees at a point, times `share`.
    #[inline(always)]
    pub(super) fn add_fit<Q: Field<T>>(&self, corner: &Corner<T, D>, share: T, value: &mut Q) {
        let psi = functions::<T, D, NB>(&corner.s);
        for q in 0..Q::COMPONENTS {
            let coefficients = &self.coefficients[corner.node * Q::COMPONENTS + q];
            // The highest function first: the constant one, usually the largest part, is rounded last.
            let seen = (0..NB)
                .rev()
                .fold(T::zero(), |sum, k| sum + coefficients[k] * psi[k]);
            value.set_component(q, value.component(q) + share * seen);
        }
    }
}

/// Replaces the sums of a patch by coefficients; returns the share of the field that they leave.
fn solve<T: Scalar, const D: usize, const NB: usize, Q: Field<T>>(
    fit: &PatchFit<T, NB>,
    sums: &mut [[T; NB]],
    squares: T,
) -> T {
    // Of a projection the squares of what is left are the difference of the squares.
    let rights = |sums: &[[T; NB]], q: usize| sums[q][0] * sums[q][0] / fit.total();
    let means = sum_of_squares::<T, D, Q>(|q| rights(sums, q));
    let mut seen = T::zero();
    for (q, sums) in sums.iter_mut().enumerate() {
        let right = *sums;
        fit.solve(sums);
        let product = (0..NB).fold(T::zero(), |sum, k| sum + right[k] * sums[k]);
        seen += product * weight_of::<T, D, Q>(q);
    }
    let left = (squares - seen).max(T::zero());
    let all = left + (seen - means).max(T::zero()) + T::lit(FLOOR) * squares;
    match all > T::zero() {
        true => (left / all).sqrt(),
        false => T::zero(),
    }
}

/// Sum over the components of a field; those of a symmetric tensor off the diagonal count twice.
fn sum_of_squares<T: Scalar, const D: usize, Q: Field<T>>(of: impl Fn(usize) -> T) -> T {
    (0..Q::COMPONENTS).fold(T::zero(), |sum, q| sum + of(q) * weight_of::<T, D, Q>(q))
}

fn weight_of<T: Scalar, const D: usize, Q: Field<T>>(component: usize) -> T {
    let is_shear = D <= component && component < D * (D + 1) / 2 && Q::COMPONENTS >= D * (D + 1) / 2;
    T::lit(if is_shear { 2.0 } else { 1.0 })
}

/// Pivots of a patch that is evenly filled, over the sum of its weights, where it ends at its node along the
/// axes that `halved` names.
fn full_pivots<T: Scalar, const D: usize, const NB: usize>(halved: usize) -> [T; NB] {
    // Exact for squares of the functions times the hat, of degree five.
    let (line, two) = (gauss_legendre::<T>(3), T::lit(2.0));
    let mut fit = PatchFit::<T, NB>::zero();
    for corner in (0..1_usize << D).filter(|corner| corner & halved == 0) {
        for mut number in 0..line.len().pow(D as u32) {
            let mut weight = T::one();
            let s = std::array::from_fn(|a| {
                let (x, share) = line[number % line.len()];
                number /= line.len();
                let u = (x + T::one()) / two;
                weight *= share * (T::one() - u);
                if corner >> a & 1 == 1 { -u } else { u }
            });
            fit.add(weight, &functions::<T, D, NB>(&s));
        }
    }
    fit.pivots()
}
