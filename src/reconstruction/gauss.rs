//! Gauss points of a cell, where the fits are integrated.

use nalgebra::SVector;

use super::{Patch, Point};
use crate::field::Field;
use crate::lanes::Lanes;
use crate::quadrature::gauss_legendre;
use crate::scalar::Scalar;
use crate::taylor::{MOST_COMPONENTS, taylor_functions};

/// Gauss-Legendre rule of the reference cell with the Taylor functions at its points.
#[derive(Clone, Debug)]
pub(super) struct GaussRule<T, const D: usize, const NB: usize>(Vec<Node<T, D, NB>>);

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
        let nodes = (0..line.len().pow(D as u32)).map(|mut index| {
            let mut share = T::one();
            let s = SVector::from_fn(|_, _| {
                let (x, w) = line[index % line.len()];
                index /= line.len();
                share *= w / two;
                x
            });
            let psi = taylor_functions(&s);
            Node { s, share, psi }
        });
        Self(nodes.collect())
    }

    /// Points along each axis for a basis of degree `degree`: two as published for degrees 1 and 2, `degree + 1` beyond. Two
    /// points would make a cubic basis lose an order in the stress, because they integrate its mass matrix too crudely.
    pub(super) fn points_for_degree(degree: usize) -> usize {
        if degree > 2 { degree + 1 } else { 2 }
    }

    /// Local coordinates of the points along an axis.
    pub(super) fn line(&self) -> impl Iterator<Item = T> {
        let beyond = |node: &&Node<T, D, NB>| (1..D).all(|axis| node.s[axis] == self.0[0].s[axis]);
        self.0.iter().take_while(beyond).map(|node| node.s[0])
    }

    /// Streams polynomials over four cells of the given volume: the number of the point, then the values times the weight.
    #[inline(always)]
    pub(super) fn emit_lanes<V: Lanes<T>>(
        &self,
        volume: T,
        coefficients: &[[V; MOST_COMPONENTS]; NB],
        components: usize,
        sink: &mut impl FnMut(usize, &[V; MOST_COMPONENTS]),
    ) {
        for (number, node) in self.0.iter().enumerate() {
            let weight = V::splat(volume * node.share);
            let mut values = [V::splat(T::zero()); MOST_COMPONENTS];
            for k in (0..NB).rev() {
                let psi = V::splat(node.psi[k]);
                for q in 0..components {
                    values[q] = psi.mul_add(coefficients[k][q], values[q]);
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
        for node in &self.0 {
            let value = polynomial(&node.psi, coefficients);
            let position = patch.position(&node.s);
            sink(&Point { cell, position }, value.scaled(volume * node.share));
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
        for node in &self.0 {
            let position = patch.position(&node.s);
            let value = polynomial(&taylor_functions(&frame.local(&position)), coefficients);
            sink(&Point { cell, position }, value.scaled(volume * node.share));
        }
    }
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
