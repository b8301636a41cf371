//! Gauss points of a cell, where the fits are integrated.

use nalgebra::SVector;

use super::{Patch, Point};
use crate::field::Field;
use crate::quadrature::gauss_legendre;
use crate::scalar::Scalar;
use crate::simd::{LANES, Number, Packs, each};
use crate::taylor::{MOST_COMPONENTS, Rights, taylor_functions};

/// Least share of its mean that a fitted density keeps at the points.
const LEAST_DENSITY: f64 = 1e-2;

/// Gauss-Legendre rule of the reference cell with the Taylor functions at its points.
#[derive(Clone, Debug)]
pub(super) struct GaussRule<T, const D: usize, const NB: usize> {
    nodes: Vec<Node<T, D, NB>>,
    /// Points along an axis with their weights, as shares of it.
    line: Vec<(T, T)>,
    /// Largest size of each function at the points.
    bounds: SVector<T, NB>,
}

/// Local coordinates, weight as share of the cell, Taylor functions.
#[derive(Clone, Debug)]
struct Node<T, const D: usize, const NB: usize> {
    s: SVector<T, D>,
    share: T,
    psi: SVector<T, NB>,
}

impl<T: Scalar, const D: usize, const NB: usize> GaussRule<T, D, NB> {
    /// With `n >= 1` points along each axis.
    pub(super) fn new(n: usize) -> Self {
        let line = gauss_legendre::<T>(n.max(1));
        let two = T::lit(2.0);
        let line: Vec<_> = line.into_iter().map(|(x, w)| (x, w / two)).collect();
        let nodes = (0..line.len().pow(D as u32)).map(|mut index| {
            let mut share = T::one();
            let s = SVector::from_fn(|_, _| {
                let (x, w) = line[index % line.len()];
                index /= line.len();
                share *= w;
                x
            });
            let psi = taylor_functions(&s);
            Node { s, share, psi }
        });
        let nodes: Vec<_> = nodes.collect();
        let bounds = SVector::from_fn(|k, _| {
            let sizes = nodes.iter().map(|node: &Node<T, D, NB>| node.psi[k].abs());
            sizes.fold(T::zero(), T::max)
        });
        Self { nodes, line, bounds }
    }

    /// Draws the fit of a density towards its mean, with all fields that are fitted beside it (so that the
    /// velocity that mass and momentum share stays), as far as it must for the density to be positive at the
    /// points: [`LEAST_DENSITY`] of its mean. Every function but the mean integrates to zero (by two points
    /// an axis and more), so the integral stays. Also says whether anything had to be done.
    #[inline(always)]
    pub(super) fn keep_positive<Q: Field<T>>(&self, coefficients: [Q; NB]) -> ([Q; NB], bool) {
        let clearly = (0..Q::COMPONENTS).all(|q| {
            let reach = (1..NB).fold(T::zero(), |sum, k| {
                sum + coefficients[k].component(q).abs() * self.bounds[k]
            });
            !is_density::<T, Q>(q) || reach <= coefficients[0].component(q) * may_lose::<T>()
        });
        if clearly {
            return (coefficients, false);
        }
        self.draw_to_mean(coefficients)
    }

    #[cold]
    #[inline(never)]
    fn draw_to_mean<Q: Field<T>>(&self, mut coefficients: [Q; NB]) -> ([Q; NB], bool) {
        let mut share = T::one();
        for q in (0..Q::COMPONENTS).filter(|&q| is_density::<T, Q>(q)) {
            let may = (coefficients[0].component(q) * may_lose::<T>()).max(T::zero());
            for node in &self.nodes {
                let loss = (1..NB).fold(T::zero(), |sum, k| {
                    sum - coefficients[k].component(q) * node.psi[k]
                });
                if loss * share > may {
                    share = may / loss;
                }
            }
        }
        let drawn = share < T::one();
        if drawn {
            for coefficient in &mut coefficients[1..] {
                *coefficient = coefficient.scaled(share);
            }
        }
        (coefficients, drawn)
    }

    /// In which of four cells that may have to be done.
    #[inline(always)]
    pub(super) fn may_be_negative<K: Packs<T>, Q: Field<T>, const C: usize>(
        &self,
        k: K,
        coefficients: &Rights<K::V, NB, C>,
    ) -> [bool; LANES] {
        let mut negative = [false; LANES];
        let zero = k.splat(T::zero());
        for q in (0..Q::COMPONENTS).filter(|&q| is_density::<T, Q>(q)) {
            let mut reach = zero;
            for n in 1..NB {
                reach = coefficients[n][q].abs().mul_add(k.splat(self.bounds[n]), reach);
            }
            let beyond = reach.above(coefficients[0][q] * k.splat(may_lose::<T>()));
            let half = k.splat(T::one() / T::lit(2.0));
            if D == 1 && k.are_between(beyond, zero - half, half) {
                continue;
            }
            let beyond = k.array(beyond);
            negative = each(
                #[inline(always)]
                |l| negative[l] || beyond[l] != T::zero(),
            );
        }
        negative
    }

    /// Points along each axis for a basis of degree `degree`: two as published for degrees 1 and 2,
    /// `degree + 1` beyond. Two points would make a cubic basis lose an order in the stress, because they
    /// integrate its mass matrix too crudely.
    pub(super) fn points_for_degree(degree: usize) -> usize {
        if degree > 2 { degree + 1 } else { 2 }
    }

    /// Local coordinates of the points along an axis.
    pub(super) fn line(&self) -> impl Iterator<Item = T> {
        let beyond = |node: &&Node<T, D, NB>| (1..D).all(|axis| node.s[axis] == self.nodes[0].s[axis]);
        self.nodes.iter().take_while(beyond).map(|node| node.s[0])
    }

    /// The same with their weights, as shares of the axis.
    pub(super) fn weighted_line(&self) -> impl Iterator<Item = (T, T)> {
        self.line.iter().copied()
    }

    /// Streams polynomials over four cells of the given volume: the number of the point, then the values
    /// times the weight.
    #[inline(always)]
    pub(super) fn emit_lanes<K: Packs<T>, const C: usize>(
        &self,
        k: K,
        volume: T,
        coefficients: &Rights<K::V, NB, C>,
        components: usize,
        sink: &mut impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) {
        for (number, node) in self.nodes.iter().enumerate() {
            let weight = k.splat(volume * node.share);
            let mut values = [k.splat(T::zero()); MOST_COMPONENTS];
            for n in (0..NB).rev() {
                let psi = k.splat(node.psi[n]);
                for q in 0..components {
                    values[q] = psi.mul_add(coefficients[n][q], values[q]);
                }
            }
            for q in 0..components {
                values[q] = values[q] * weight;
            }
            sink(number, &values);
        }
    }

    /// Streams the polynomial with the given coefficients in the functions of `patch`, over `patch`.
    #[inline(always)]
    pub(super) fn emit<Q: Field<T>>(
        &self,
        patch: &Patch<T, D>,
        coefficients: &[Q; NB],
        sink: &mut impl FnMut(&Point<T, D>, Q),
    ) {
        let volume = patch.volume();
        let cell = patch.cell;
        for node in &self.nodes {
            let value = polynomial(&node.psi, coefficients);
            let position = patch.position(&node.s);
            sink(&Point::fixed(cell, position), value.scaled(volume * node.share));
        }
    }

    /// The same where the coefficients are those of the functions of `frame`.
    pub(super) fn emit_in_frame<Q: Field<T>>(
        &self,
        patch: &Patch<T, D>,
        frame: &Patch<T, D>,
        coefficients: &[Q; NB],
        sink: &mut impl FnMut(&Point<T, D>, Q),
    ) {
        let volume = patch.volume();
        let cell = patch.cell;
        for node in &self.nodes {
            let position = patch.position(&node.s);
            let value = polynomial(&taylor_functions(&frame.local(&position)), coefficients);
            sink(&Point::fixed(cell, position), value.scaled(volume * node.share));
        }
    }
}

/// Whether component `q` is a density.
#[inline(always)]
const fn is_density<T, Q: Field<T>>(q: usize) -> bool {
    Q::DENSITIES >> q & 1 == 1
}

/// The share of its mean that a density may lose at a point.
#[inline(always)]
fn may_lose<T: Scalar>() -> T {
    T::one() - T::lit(LEAST_DENSITY)
}

/// `sum_k a_k psi_k`, the highest function first: the mean, usually the largest part, is rounded last.
#[inline(always)]
pub(super) fn polynomial<T: Scalar, const NB: usize, Q: Field<T>>(
    psi: &SVector<T, NB>,
    coefficients: &[Q; NB],
) -> Q {
    let mut value = Q::zero();
    for k in (0..NB).rev() {
        value.add_scaled(psi[k], coefficients[k]);
    }
    value
}
