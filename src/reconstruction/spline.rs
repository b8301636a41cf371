//! Global cubic spline.

use nalgebra::SVector;

use super::{Anywhere, Cloud, NoFilter, Point, Reconstruction};
use crate::basis::BasisFamily;
use crate::field::Field;
use crate::mass::VelocityMass;
use crate::quadrature::gauss_legendre;
use crate::scalar::Scalar;

/// Cubic not-a-knot spline through all particle values (Tielen, Wobbes, Moller & Beuth 2017), 1-D only,
/// evaluated at Gauss points of the occupied cells (up to the surface in a cell that it cuts). Accurate, but
/// it keeps neither mass nor momentum.
///
/// Beyond the outermost particles the end polynomials are continued. Particles at one and the same position
/// enter with the mean of their values. With three distinct positions the spline is a parabola, with two a
/// line, with one a constant.
#[derive(Clone, Debug)]
pub struct CubicSpline<T> {
    pieces: usize,
    rule: Vec<(T, T)>,
    /// Particles by ascending position.
    order: Vec<u32>,
    /// Distinct positions, and where each one's particles start in `order`.
    knots: Vec<T>,
    start: Vec<u32>,
    /// Thomas factors of the tridiagonal system.
    factors: Vec<Factor<T>>,
    values: Vec<T>,
    curvatures: Vec<T>,
}

#[derive(Clone, Copy, Debug)]
struct Factor<T> {
    lower: T,
    inverse_pivot: T,
    upper: T,
}

impl<T: Scalar> CubicSpline<T> {
    /// For a basis, as [`CubicSpline::for_degree`] of its degree.
    pub fn for_basis<B: BasisFamily<T, 1>>(basis: &B) -> Self {
        Self::for_degree(basis.degree())
    }

    /// For a basis of degree `degree`: two Gauss points on each cell, or for B-splines of degree 2 and more
    /// on each half of it (Tielen et al.).
    pub fn for_degree(degree: usize) -> Self {
        Self::with_pieces(if degree > 1 { 2 } else { 1 })
    }

    /// Two Gauss points on each of `pieces >= 1` equal parts of a cell.
    pub fn with_pieces(pieces: usize) -> Self {
        Self {
            pieces: pieces.max(1),
            rule: gauss_legendre(2),
            order: Vec::new(),
            knots: Vec::new(),
            start: Vec::new(),
            factors: Vec::new(),
            values: Vec::new(),
            curvatures: Vec::new(),
        }
    }

    /// Keeps `order` sorted: an insertion sort, since from step to step it hardly changes. Particles at one
    /// position come by their index, so that the order depends on where they are now and not on how they came
    /// there: a resumed run, which does not know that, adds their values up in the same order.
    fn sort(&mut self, positions: &[SVector<T, 1>]) {
        let n = positions.len();
        if self.order.len() != n {
            self.order = (0..n as u32).collect();
            self.order.sort_by(|&a, &b| {
                let (a, b) = (positions[a as usize][0], positions[b as usize][0]);
                a.primal().total_cmp(&b.primal())
            });
            self.knots = Vec::with_capacity(n);
            self.start = Vec::with_capacity(n + 1);
            self.factors = Vec::with_capacity(n);
            return;
        }
        for i in 1..n {
            let moved = self.order[i];
            let x = positions[moved as usize][0];
            let mut j = i;
            let after = |other: u32| {
                let y = positions[other as usize][0];
                y > x || y == x && other > moved
            };
            while j > 0 && after(self.order[j - 1]) {
                self.order[j] = self.order[j - 1];
                j -= 1;
            }
            self.order[j] = moved;
        }
    }

    /// Collects the distinct positions; two closer than round-off of the grid's extent are one.
    fn find_knots(&mut self, cloud: &Cloud<'_, T, 1>) {
        let extent = cloud.grid.max()[0] - cloud.grid.min()[0];
        let same = extent * T::default_epsilon() * T::lit(4.0);
        self.knots.clear();
        self.start.clear();
        for (i, &p) in self.order.iter().enumerate() {
            let x = cloud.positions[p as usize][0];
            if self.knots.last().is_none_or(|&last| x - last > same) {
                self.knots.push(x);
                self.start.push(i as u32);
            }
        }
        self.start.push(self.order.len() as u32);
    }

    fn gap(&self, i: usize) -> T {
        self.knots[i + 1] - self.knots[i]
    }

    /// Factorises the equations of the inner second derivatives; the not-a-knot conditions
    /// (`S'''` continuous at the second and the last but one knot) have eliminated the outer two.
    fn factorise(&mut self) {
        self.factors.clear();
        let n = self.knots.len();
        if n < 4 {
            return;
        }
        let two = T::lit(2.0);
        let mut before = T::zero();
        for i in 1..n - 1 {
            let (left, right) = (self.gap(i - 1), self.gap(i));
            let (mut lower, mut diagonal, mut upper) = (left, two * (left + right), right);
            if i == 1 {
                diagonal += left + left * left / right;
                upper -= left * left / right;
                lower = T::zero();
            }
            if i == n - 2 {
                diagonal += right + right * right / left;
                lower -= right * right / left;
                upper = T::zero();
            }
            let inverse_pivot = T::one() / (diagonal - lower * before);
            before = upper * inverse_pivot;
            self.factors.push(Factor {
                lower,
                inverse_pivot,
                upper: before,
            });
        }
    }

    /// Splines through the components of the values: fills `curvatures` (second derivatives). All components
    /// of a knot before the next knot: the recurrences of one component wait for each other, those of several
    /// do not.
    #[inline(always)]
    fn interpolate(&mut self, stride: usize) {
        let n = self.knots.len();
        match n {
            0..=2 => self.curvatures[..n * stride].fill(T::zero()),
            3 => {
                let two = T::lit(2.0) / (self.knots[2] - self.knots[0]);
                for c in 0..stride {
                    let bend = two * (self.difference(1, stride, c) - self.difference(0, stride, c));
                    (0..n).for_each(|i| self.curvatures[i * stride + c] = bend);
                }
            }
            _ => {
                self.eliminate(stride);
                self.continue_ends(stride);
            }
        }
    }

    /// Divided difference of component `c` in interval `i`.
    #[inline(always)]
    fn difference(&self, i: usize, stride: usize, c: usize) -> T {
        (self.values[(i + 1) * stride + c] - self.values[i * stride + c]) / self.gap(i)
    }

    /// Thomas algorithm for the inner second derivatives.
    #[inline(always)]
    fn eliminate(&mut self, stride: usize) {
        let n = self.knots.len();
        let six = T::lit(6.0);
        self.curvatures[..stride].fill(T::zero());
        let mut left = six / self.gap(0);
        for i in 1..n - 1 {
            let factor = self.factors[i - 1];
            let right = six / self.gap(i);
            for c in 0..stride {
                let at = |i: usize| i * stride + c;
                let (before, here, after) =
                    (self.values[at(i - 1)], self.values[at(i)], self.values[at(i + 1)]);
                let jump = (after - here) * right - (here - before) * left;
                let lower = factor.lower * self.curvatures[at(i - 1)];
                self.curvatures[at(i)] = (jump - lower) * factor.inverse_pivot;
            }
            left = right;
        }
        for i in (1..n - 2).rev() {
            let upper = self.factors[i - 1].upper;
            for c in 0..stride {
                let above = self.curvatures[(i + 1) * stride + c];
                self.curvatures[i * stride + c] -= upper * above;
            }
        }
    }

    /// The outermost second derivatives, which the not-a-knot conditions give.
    #[inline(always)]
    fn continue_ends(&mut self, stride: usize) {
        let n = self.knots.len();
        let continued = |near: T, next: T, ratio: T| near + (near - next) * ratio;
        let first = self.gap(0) / self.gap(1);
        let last = self.gap(n - 2) / self.gap(n - 3);
        for c in 0..stride {
            let at = |i: usize| i * stride + c;
            self.curvatures[at(0)] = continued(self.curvatures[at(1)], self.curvatures[at(2)], first);
            self.curvatures[at(n - 1)] =
                continued(self.curvatures[at(n - 2)], self.curvatures[at(n - 3)], last);
        }
    }

    fn fit<Q: Field<T>>(&mut self, value: impl Fn(usize) -> Q) {
        let n = self.knots.len();
        let stride = Q::COMPONENTS;
        if self.values.len() < n * stride {
            // Sized for all particles, so that a later step never has to allocate.
            self.values.resize(self.order.len() * stride, T::zero());
            self.curvatures.resize(self.order.len() * stride, T::zero());
        }
        for i in 0..n {
            let here = &self.order[self.start[i] as usize..self.start[i + 1] as usize];
            let mut sum = Q::zero();
            for &p in here {
                sum.add_scaled(T::one() / T::count(here.len()), value(p as usize));
            }
            for component in 0..stride {
                self.values[i * stride + component] = sum.component(component);
            }
        }
        self.interpolate_field::<Q>();
    }

    /// Compiled once for a field, whatever its values come from; the number of components is known.
    #[inline(never)]
    fn interpolate_field<Q: Field<T>>(&mut self) {
        self.interpolate(Q::COMPONENTS);
    }

    /// Value at `x`, which lies in interval `i` or beyond the end it touches.
    #[inline(always)]
    fn evaluate<Q: Field<T>>(&self, i: usize, x: T) -> Q {
        let stride = Q::COMPONENTS;
        let mut result = Q::zero();
        for component in 0..stride {
            let at = |k: usize| k * stride + component;
            let value = if self.knots.len() == 1 {
                self.values[component]
            } else {
                let (h, six) = (self.gap(i), T::lit(6.0));
                let (a, b) = ((self.knots[i + 1] - x) / h, (x - self.knots[i]) / h);
                let bend =
                    (a * a * a - a) * self.curvatures[at(i)] + (b * b * b - b) * self.curvatures[at(i + 1)];
                a * self.values[at(i)] + b * self.values[at(i + 1)] + bend * h * h / six
            };
            result.set_component(component, value);
        }
        result
    }

    /// Spline of the field with the given `value`s, evaluated at `points` (ascending).
    pub fn at_points<Q: Field<T>>(
        &mut self,
        value: impl Fn(usize) -> Q,
        points: impl Iterator<Item = T>,
        mut sink: impl FnMut(T, Q),
    ) {
        self.fit(value);
        let last = self.knots.len().saturating_sub(2);
        let mut i = 0;
        for x in points {
            while i < last && x > self.knots[i + 1] {
                i += 1;
            }
            sink(x, self.evaluate(i, x));
        }
    }

    fn stream<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, 1>,
        value: impl Fn(usize) -> Q,
        mut sink: impl FnMut(&Point<T, 1>, Q),
    ) {
        self.fit(value);
        let last = self.knots.len().saturating_sub(2);
        let pieces = T::count(self.pieces);
        let mut i = 0;
        for &number in cloud.bins.occupied() {
            let patch = cloud.patch(number as usize);
            let (cell, centre, half) = (patch.cell, patch.centre[0], patch.half[0] / pieces);
            for piece in 0..self.pieces {
                let offset = T::count(2 * piece + 1) - pieces;
                for &(s, weight) in &self.rule {
                    let x = centre + half * (offset + s);
                    while i < last && x > self.knots[i + 1] {
                        i += 1;
                    }
                    let value: Q = self.evaluate(i, x);
                    let position = SVector::from([x]);
                    sink(&Point::fixed(cell, position), value.scaled(weight * half));
                }
            }
        }
    }
}

impl<T: Scalar> Reconstruction<T, 1> for CubicSpline<T> {
    type Points = Anywhere;
    type Mass = VelocityMass;
    type Filter = NoFilter;

    fn prepare(&mut self, cloud: &Cloud<'_, T, 1>) {
        self.sort(cloud.positions);
        self.find_knots(cloud);
        self.factorise();
    }

    fn integrate<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, 1>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, 1>, Q),
    ) {
        self.stream(cloud, value, sink);
    }

    fn integrate_conserved<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, 1>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, 1>, Q),
    ) {
        let density = |p: usize| amount(p).scaled(T::one() / cloud.volumes[p]);
        self.stream(cloud, density, sink);
    }

    fn bytes(&self) -> usize {
        let scalars = self.knots.capacity() + self.values.capacity() + self.curvatures.capacity();
        scalars * size_of::<T>()
            + self.factors.capacity() * size_of::<Factor<T>>()
            + (self.order.capacity() + self.start.capacity()) * size_of::<u32>()
    }
}
