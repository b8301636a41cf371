//! Relaxed Taylor least squares.

mod cells;
mod filling;

use std::ops::Range;

use super::gauss::{GaussRule, polynomial};
use super::taylor::local;
use super::{Cloud, Filling, Point, Reconstruction, Shepard};
use crate::field::Field;
use crate::scalar::Scalar;
use crate::taylor::{CellFit, default_tolerance, shift_sums, taylor_functions};
use cells::RelaxedCell;

/// Wave speeds in neighbouring cells that differ by more than this factor are those of two materials.
const ALIKE: f64 = 2.0;

/// Largest share towards the fit through neighbours. At a wall that fit extrapolates from one side: near the critical step,
/// where stresses change their sign from step to step, larger shares lower the limit (by 5 % where 0.1 was taken).
const MOST_FROM_NEIGHBOURS: f64 = 0.03;

/// Relaxation towards the fits, each a rate in units of one over the time in which a wave crosses a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxation<T> {
    /// Of stress and velocity towards the fit of the particle's own cell.
    pub own: T,
    /// Of the stress towards the fit through the neighbours too.
    pub neighbours: T,
}

impl<T: Scalar> Default for Relaxation<T> {
    /// That of one dimension.
    fn default() -> Self {
        Self::in_dimensions(1)
    }
}

impl<T: Scalar> Relaxation<T> {
    /// Along one axis 3 and 0.8: larger ones towards the neighbours damp a linear basis less and make it gain sooner. Beyond, 3
    /// and 0.05: what neighbours see otherwise than a cell itself is relaxed without being strained, so a body under a lasting load
    /// creeps, and there are more particles in a cell to keep its fit in bounds. See `docs/relaxed-tls.md`.
    pub fn in_dimensions(count: usize) -> Self {
        Self {
            own: T::lit(3.0),
            neighbours: T::lit(if count == 1 { 0.8 } else { 0.05 }),
        }
    }

    /// Shares of the difference to each fit that a step takes away, in which a wave crosses the part `crossed` of a cell.
    #[inline(always)]
    fn shares(&self, crossed: T) -> [T; 2] {
        let [own, neighbours] = [self.own * crossed, self.neighbours * crossed];
        let sum = T::one() + own + neighbours;
        [own / sum, (neighbours / sum).min(T::lit(MOST_FROM_NEIGHBOURS))]
    }
}

/// Taylor least squares for long runs, our own: published TLS gains energy wherever particles cross cell edges
/// or do not lie evenly in their cells.
///
/// Four things together: mass and momentum of the DOFs straight from the particles; their consistent mass matrix in both the
/// acceleration and the velocity; the stress by the free fit and Gauss quadrature, as published; and in every step each
/// particle's stress and velocity a little nearer to what their fits see,
///
/// $$v_p \mathrel{+}= \beta_o(\hat v(x_p) - v_p),\qquad
///   \sigma_p \mathrel{+}= \beta_o(\hat\sigma(x_p) - \sigma_p) + \beta_n(\bar\sigma(x_p) - \sigma_p).$$
///
/// $\hat v$ and $\hat\sigma$ are the fits of the particle's own cell, $\bar\sigma$ is the fit through the particles of the
/// cell *and* of those that share a face with it. Particles carry more than a cell's polynomial sees. What the fit does not
/// see does no work now, and returns when particles cross: the first term takes it away. What a cell's few particles determine
/// badly the neighbours know: the second term bounds it. The fit of the velocity is weighted with the masses: it keeps the momentum
/// exactly and never raises the kinetic energy, because it is a projection in the very product that measures it.
///
/// The shares follow from [`Relaxation`] rates, so that a smaller time step changes nothing. A cell whose particles do not
/// tell all functions apart takes the fit with its neighbours for the force too, if that one can. The
/// stress of a law with a state of its own (a deformation, plastic history) is moved by straining the state
/// ([`ConstitutiveLaw::strain_for`](crate::law::ConstitutiveLaw::strain_for)).
///
/// In one dimension a cell ends where a body's surface cuts it. Beyond, where material ends within a cell on any slant, the particles
/// themselves are the points of its force, nothing is relaxed there, and the stepper ties its functions to those of the next
/// cells ([`crate::mass::Penalty`]).
#[doc = include_str!("../../../docs/formulas.html")]
#[derive(Clone, Debug)]
pub struct RelaxedTaylor<T, const D: usize, const NB: usize> {
    rule: GaussRule<T, D, NB>,
    tolerance: T,
    relaxation: Relaxation<T>,
    cells: Vec<RelaxedCell<T, D, NB>>,
    /// Sums of the Taylor functions times the values over the particles of each cell, component by component.
    sums: Vec<T>,
    reduced: usize,
}

impl<T: Scalar, const D: usize, const NB: usize> RelaxedTaylor<T, D, NB> {
    /// For a basis of degree `degree`, with the default relaxation.
    pub fn for_degree(degree: usize) -> Self {
        Self {
            rule: GaussRule::new(GaussRule::<T, D, NB>::points_for_degree(degree)),
            tolerance: default_tolerance(D),
            relaxation: Relaxation::in_dimensions(D),
            cells: Vec::new(),
            sums: Vec::new(),
            reduced: 0,
        }
    }

    /// With other rates of relaxation.
    #[must_use]
    pub fn with_relaxation(mut self, relaxation: Relaxation<T>) -> Self {
        self.relaxation = relaxation;
        self
    }

    /// As [`Taylor::with_tolerance`](super::Taylor::with_tolerance).
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: T) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Numbers and fits of the occupied cells, ascending.
    fn each_cell(&self, cloud: &Cloud<'_, T, D>) -> impl Iterator<Item = (usize, &RelaxedCell<T, D, NB>)> {
        cloud.bins.occupied().iter().map(|&c| c as usize).zip(&self.cells)
    }

    /// Coefficients of the wide fit of the cell at `place`, from the particles themselves.
    fn wide_coefficients<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        place: usize,
        wide: &CellFit<T, NB>,
        value: &impl Fn(usize) -> Q,
    ) -> [Q; NB] {
        let frame = &self.cells[place].whole;
        let mut sums = [Q::zero(); NB];
        let mut add = |place: usize| {
            for (p, s) in local(cloud, cloud.bins.occupied()[place] as usize, frame) {
                let psi = taylor_functions::<T, D, NB>(&s);
                let value = value(p);
                (0..NB).for_each(|k| sums[k].add_scaled(psi[k], value));
            }
        };
        add(place);
        cloud
            .bins
            .for_each_neighbour(cloud.grid, place, |_, _, other| add(other));
        wide.coefficients_from_sums(sums)
    }

    /// Sums over the particles of every cell of the functions of the whole cell times the values.
    fn sum_values<Q: Field<T>>(&mut self, cloud: &Cloud<'_, T, D>, values: &[Q]) {
        self.sums.clear();
        let occupied = cloud.bins.occupied().iter();
        for (&cell, fits) in occupied.zip(&self.cells) {
            let mut sums = [Q::zero(); NB];
            for (p, s) in local(cloud, cell as usize, &fits.whole) {
                let psi = taylor_functions::<T, D, NB>(&s);
                (0..NB).for_each(|k| sums[k].add_scaled(psi[k], values[p]));
            }
            for sum in &sums {
                self.sums.extend((0..Q::COMPONENTS).map(|i| sum.component(i)));
            }
        }
    }

    /// The sums of [`RelaxedTaylor::sum_values`] of the cell at `place`.
    #[inline(always)]
    fn summed<Q: Field<T>>(&self, place: usize) -> [Q; NB] {
        let first = place * NB * Q::COMPONENTS;
        std::array::from_fn(|k| {
            let mut sum = Q::zero();
            for i in 0..Q::COMPONENTS {
                sum.set_component(i, self.sums[first + k * Q::COMPONENTS + i]);
            }
            sum
        })
    }

    /// Moves the values towards the fits of their own cell and through its neighbours.
    fn relax_towards_both<Q: Field<T>>(&mut self, cloud: &Cloud<'_, T, D>, crossed: &[T], values: &mut [Q]) {
        self.sum_values(cloud, values);
        for (place, (cell, fits)) in self.each_cell(cloud).enumerate() {
            let mut sums = self.summed::<Q>(place);
            let seen = fits.own_coefficients(cloud, cell, sums, |p| values[p]);
            let [mut slowest, mut fastest] = [crossed[place]; 2];
            cloud
                .bins
                .for_each_neighbour(cloud.grid, place, |axis, above, other| {
                    slowest = slowest.min(crossed[other]);
                    fastest = fastest.max(crossed[other]);
                    let mut theirs = self.summed::<Q>(other);
                    shift_sums::<T, D, NB, Q>(&mut theirs, axis, above);
                    (0..NB).for_each(|k| sums[k].add_scaled(T::one(), theirs[k]));
                });
            // Stress may jump where the material changes.
            let alike = fastest <= slowest * T::lit(ALIKE);
            let wide = fits
                .wide
                .filter(|_| alike)
                .map(|wide| wide.coefficients_from_sums(sums));
            let [own, neighbours] = self.relaxation.shares(crossed[place]);
            if fits.is_open() {
                continue;
            }
            for (p, s) in local(cloud, cell, &fits.patch) {
                let old = values[p];
                values[p].add_scaled(own, difference(&s, &seen, old));
                if let Some(wide) = &wide {
                    let s = fits.whole.local(&cloud.positions[p]);
                    values[p].add_scaled(neighbours, difference(&s, wide, old));
                }
            }
        }
    }

    /// Moves the values towards the weighted fit of their own cell.
    fn relax_towards_own<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        weights: &[T],
        crossed: &[T],
        values: &mut [Q],
    ) {
        for ((cell, fits), &crossed) in self.each_cell(cloud).zip(crossed) {
            if fits.is_open() {
                continue;
            }
            let [share, _] = self.relaxation.shares(crossed);
            let weight = weights[first(cloud, cell)];
            let equal = local(cloud, cell, &fits.patch).all(|(p, _)| weights[p] == weight);
            let samples = local(cloud, cell, &fits.patch);
            // Equal weights make the fit that is there already.
            let seen = if equal {
                let samples = samples.map(|(p, s)| (s, T::one(), values[p]));
                fits.own.coefficients(samples, Q::zero())
            } else {
                let points = samples.clone().map(|(p, s)| (s, weights[p]));
                let samples = samples.map(|(p, s)| (s, weights[p], values[p]));
                CellFit::weighted(points, 0, self.tolerance).coefficients(samples, Q::zero())
            };
            for (p, s) in local(cloud, cell, &fits.patch) {
                let unseen = difference(&s, &seen, values[p]);
                values[p].add_scaled(share, unseen);
            }
        }
    }
}

/// What takes the `value` at `s` to the polynomial.
#[inline(always)]
fn difference<T: Scalar, const D: usize, const NB: usize, Q: Field<T>>(
    s: &nalgebra::SVector<T, D>,
    coefficients: &[Q; NB],
    value: Q,
) -> Q {
    let mut difference = polynomial(&taylor_functions(s), coefficients);
    difference.add_scaled(-T::one(), value);
    difference
}

/// Streams the values at the particles of a cell.
#[inline(always)]
fn emit_particles<T: Scalar, const D: usize, Q: Field<T>>(
    cloud: &Cloud<'_, T, D>,
    cell: usize,
    value: &impl Fn(usize) -> Q,
    sink: &mut impl FnMut(&Point<T, D>, Q),
) {
    for &p in cloud.bins.particles_in(cell) {
        let p = p as usize;
        let point = Point {
            cell: *cloud.bins.cell_of(p),
            position: cloud.positions[p],
            moves: true,
        };
        sink(&point, value(p).scaled(cloud.volumes[p]));
    }
}

/// First particle of an occupied cell.
#[inline(always)]
fn first<T: Scalar, const D: usize>(cloud: &Cloud<'_, T, D>, cell: usize) -> usize {
    cloud.bins.particles_in(cell).first().map_or(0, |&p| p as usize)
}

impl<T: Scalar, const D: usize, const NB: usize> Reconstruction<T, D> for RelaxedTaylor<T, D, NB> {
    const FIELDS_AT_PARTICLES: bool = false;
    const AMOUNTS_AT_PARTICLES: bool = true;
    const PARTICLE_MATRIX: bool = true;
    const BY_CELLS: bool = true;
    const RELAXES: bool = true;

    fn prepare(&mut self, cloud: &Cloud<'_, T, D>) {
        let count = cloud.grid.cell_count();
        // One slot for each cell there is, so that a later step never has to allocate.
        self.cells.reserve(count - self.cells.len().min(count));
        self.sums.clear();
        self.sums.reserve(count * NB * D * D);
        self.cells.clear();
        let occupied = cloud.bins.occupied().iter();
        self.cells
            .extend(occupied.map(|&cell| RelaxedCell::alone(cloud, cell as usize, self.tolerance)));
        cells::join(&mut self.cells, cloud, self.tolerance);
        let reduced = |fits: &&RelaxedCell<T, D, NB>| !fits.is_open() && !fits.is_full();
        self.reduced = self.cells.iter().filter(reduced).count();
    }

    #[inline(always)]
    fn integrate<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        self.integrate_cells(cloud, 0..self.cells.len(), value, sink);
    }

    #[inline(always)]
    fn integrate_conserved<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, D>, Q),
    ) {
        Shepard.integrate_conserved(cloud, amount, sink);
    }

    #[inline(always)]
    fn integrate_cells<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cells: Range<usize>,
        value: impl Fn(usize) -> Q,
        mut sink: impl FnMut(&Point<T, D>, Q),
    ) {
        let numbers = cloud.bins.occupied()[cells.clone()].iter();
        for (place, (&cell, fits)) in cells.clone().zip(numbers.zip(&self.cells[cells])) {
            if fits.is_open() {
                emit_particles(cloud, cell as usize, &value, &mut sink);
                continue;
            }
            let samples = local(cloud, cell as usize, &fits.patch).map(|(p, s)| (s, T::one(), value(p)));
            let coefficients = match &fits.wide {
                Some(wide) if !fits.is_full() => {
                    // What the neighbours see, and on top of it what the own particles see beside that.
                    let seen = self.wide_coefficients(cloud, place, wide, &value);
                    self.rule
                        .emit_in_frame(&fits.patch, &fits.whole, &seen, &mut sink);
                    let rest = samples.map(|(s, weight, value)| {
                        let s_whole = fits.whole.local(&fits.patch.position(&s));
                        (s, weight, difference(&s_whole, &seen, value).scaled(-T::one()))
                    });
                    fits.own.coefficients(rest, Q::zero())
                }
                _ => fits.own.coefficients(samples, Q::zero()),
            };
            self.rule.emit(&fits.patch, &coefficients, &mut sink);
        }
    }

    fn relax<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        weights: Option<&[T]>,
        crossed: &[T],
        values: &mut [Q],
    ) {
        match weights {
            None => self.relax_towards_both(cloud, crossed, values),
            Some(weights) => self.relax_towards_own(cloud, weights, crossed, values),
        }
    }

    fn filling(&self, place: usize) -> Filling {
        self.cells.get(place).map_or(Filling::Full, |fits| fits.filling)
    }

    fn reduced_cells(&self) -> usize {
        self.reduced
    }

    fn bytes(&self) -> usize {
        self.cells.capacity() * size_of::<RelaxedCell<T, D, NB>>() + self.sums.capacity() * size_of::<T>()
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use nalgebra::vector;

    use super::*;
    use crate::grid::Grid;
    use crate::particles::Bins;

    /// Momentum and kinetic energy of unequal masses before and after: the one is kept, the other never raised, and a
    /// velocity that the fit sees is left alone.
    #[test]
    fn a_weighted_relaxation_keeps_the_momentum_and_never_raises_the_energy() {
        let grid = Grid::new(vector![0.0], vector![3.0], [3]).unwrap();
        let positions: Vec<_> = (0..17).map(|p| vector![0.05 + 0.17 * f64::from(p)]).collect();
        let mass: Vec<f64> = (0..17).map(|p| 1.0 + f64::from(p * 7 % 5)).collect();
        let volumes = vec![0.1; 17];
        let bins = Bins::new(&grid, &positions).unwrap();
        let cloud = Cloud::new(&grid, &bins, &positions, &volumes).unwrap();
        let momentum = |v: &[f64]| mass.iter().zip(v).map(|(m, v)| m * v).sum::<f64>();
        let energy = |v: &[f64]| mass.iter().zip(v).map(|(m, v)| m * v * v).sum::<f64>();
        for crossed in [0.1, 0.7, 1.0] {
            let mut fit = RelaxedTaylor::<f64, 1, 3>::for_degree(2);
            fit.prepare(&cloud);
            let rough: Vec<f64> = (0..17).map(|p| f64::from(p * 11 % 7) - 2.0).collect();
            let mut v = rough.clone();
            fit.relax(&cloud, Some(&mass), &[crossed; 3], &mut v);
            assert_relative_eq!(momentum(&v), momentum(&rough), max_relative = 1e-14);
            assert!(energy(&v) < 0.99 * energy(&rough));
            let smooth: Vec<f64> = positions.iter().map(|x| 1.0 + x[0] - 0.3 * x[0] * x[0]).collect();
            let mut v = smooth.clone();
            fit.relax(&cloud, Some(&mass), &[crossed; 3], &mut v);
            for (found, expected) in v.iter().zip(&smooth) {
                assert_relative_eq!(found, expected, epsilon = 1e-13);
            }
        }
    }
}
