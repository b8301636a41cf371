//! Integrals of fits over cells, four cells at a time.
//!
//! The points of the fits are at the same places in every cell, so the functions there are the same in all cells but those
//! near the ends of the grid: they are computed once and kept until a cell of another kind comes.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use super::Pass;
use super::sums::{Parts, Sums};
use crate::basis::{BasisFamily, Factors, MOST_WIDTH};
use crate::field::{Field, MassMomentum};
use crate::grid::Cell;
use crate::lanes::{LANES, Lanes, with_lanes_of};
use crate::reconstruction::{Cloud, Point, Reconstruction};
use crate::scalar::Scalar;
use crate::taylor::MOST_COMPONENTS;

/// Most points along an axis.
pub(in super::super) const MOST_POINTS: usize = LANES;

/// Values and slopes of the functions along an axis at one point, a cell in each lane.
type Along<V> = [[V; MOST_WIDTH]; 2];

/// Functions along each axis at each point of a line.
struct AtPoints<V, const D: usize> {
    kinds: Option<[[usize; D]; LANES]>,
    points: usize,
    along: [[Along<V>; MOST_POINTS]; D],
}

impl<V: Copy, const D: usize> AtPoints<V, D> {
    fn new<T: Scalar>(points: usize) -> Self
    where
        V: Lanes<T>,
    {
        let nothing = [[V::splat(T::zero()); MOST_WIDTH]; 2];
        Self {
            kinds: None,
            points,
            along: [[nothing; MOST_POINTS]; D],
        }
    }

    /// Brings them up to date for four cells; `units` are the points' coordinates from 0 to 1 in a cell.
    #[inline(always)]
    fn take<T: Scalar, B: BasisFamily<T, D>>(
        &mut self,
        pass: &Pass<'_, T, D, B>,
        cells: &[Cell<D>; LANES],
        units: V,
    ) where
        V: Lanes<T>,
    {
        let kinds = cells.map(|cell| pass.kind(&cell));
        if self.kinds != Some(kinds) {
            self.kinds = Some(kinds);
            self.compute(pass, cells, units);
        }
    }

    #[inline(never)]
    fn compute<T: Scalar, B: BasisFamily<T, D>>(
        &mut self,
        pass: &Pass<'_, T, D, B>,
        cells: &[Cell<D>; LANES],
        units: V,
    ) where
        V: Lanes<T>,
    {
        let of_cells = cells.map(|cell| pass.basis.factors(pass.grid, &cell, &[units; D]));
        for axis in 0..D {
            for point in 0..self.points {
                for k in 0..B::WIDTH {
                    let pick = |of: fn(&Factors<V, D>) -> &[[V; MOST_WIDTH]; D]| {
                        V::new(std::array::from_fn(|l| of(&of_cells[l])[axis][k].array()[point]))
                    };
                    self.along[axis][point][0][k] = pick(|factors| &factors.value);
                    self.along[axis][point][1][k] = pick(|factors| &factors.slope);
                }
            }
        }
    }

    /// At the point with the given number, axis 0 fastest.
    #[inline(always)]
    fn at(&self, mut number: usize) -> Factors<V, D> {
        let along = std::array::from_fn(|axis| {
            let point = number % self.points;
            number /= self.points;
            &self.along[axis][point]
        });
        let along: [&Along<V>; D] = along;
        Factors {
            value: along.map(|along| along[0]),
            slope: along.map(|along| along[1]),
        }
    }
}

/// What is to be integrated where.
pub(in super::super) struct Fits<'a, 'c, T, const D: usize, R> {
    pub(in super::super) reconstruction: &'a R,
    pub(in super::super) cloud: &'a Cloud<'c, T, D>,
    /// Places in the list of occupied cells.
    pub(in super::super) cells: Range<usize>,
}

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>> Pass<'_, T, D, B> {
    /// Cells of one kind have the same functions.
    #[inline(always)]
    fn kind(&self, cell: &Cell<D>) -> [usize; D] {
        let cells = self.grid.cells();
        std::array::from_fn(|axis| {
            let (below, above) = (cell[axis] as usize, cells[axis] - 1 - cell[axis] as usize);
            if below < MOST_WIDTH || above < MOST_WIDTH {
                below + MOST_WIDTH
            } else {
                0
            }
        })
    }

    /// Hands `sink(dof, integral of stress times gradient)` what the fits through the particles' stresses add to the DOFs;
    /// returns how many cells were fitted without the full set of functions.
    pub(in super::super) fn integrate_stress<R: Reconstruction<T, D>>(
        &self,
        fits: Fits<'_, '_, T, D, R>,
        stress: &impl Fn(usize) -> SMatrix<T, D, D>,
        sink: &mut impl FnMut(usize, SVector<T, D>),
    ) -> usize {
        with_lanes_of!(T, self.stress_in[_](fits, stress, sink))
    }

    #[inline(never)]
    fn stress_in<V: Lanes<T>, R: Reconstruction<T, D>>(
        &self,
        fits: Fits<'_, '_, T, D, R>,
        stress: &impl Fn(usize) -> SMatrix<T, D, D>,
        sink: &mut impl FnMut(usize, SVector<T, D>),
    ) -> usize {
        let inverse = self.grid.inverse_cell_size();
        let inverse: [V; D] = std::array::from_fn(|a| V::splat(inverse[a]));
        let parts = |value: &[V; MOST_COMPONENTS]| Parts {
            scalar: None,
            vector: None,
            tensor: Some(std::array::from_fn(|c| {
                std::array::from_fn(|a| value[c + a * D] * inverse[a])
            })),
        };
        self.integrate::<V, R, _>(
            fits,
            false,
            stress,
            &parts,
            &mut |dof, _, force| sink(dof, force),
            &mut |_, weighted, gradient| (T::zero(), weighted * gradient),
        )
    }

    /// Hands `sink(dof, mass, momentum)` what the fits through the particles' densities of both add to the DOFs.
    pub(in super::super) fn integrate_densities<R: Reconstruction<T, D>>(
        &self,
        fits: Fits<'_, '_, T, D, R>,
        density: &impl Fn(usize) -> MassMomentum<T, D>,
        sink: &mut impl FnMut(usize, T, SVector<T, D>),
    ) {
        with_lanes_of!(T, self.densities_in[_](fits, density, sink));
    }

    #[inline(never)]
    fn densities_in<V: Lanes<T>, R: Reconstruction<T, D>>(
        &self,
        fits: Fits<'_, '_, T, D, R>,
        density: &impl Fn(usize) -> MassMomentum<T, D>,
        sink: &mut impl FnMut(usize, T, SVector<T, D>),
    ) {
        let parts = |value: &[V; MOST_COMPONENTS]| Parts {
            scalar: Some(value[0]),
            vector: Some(std::array::from_fn(|c| value[1 + c])),
            tensor: None,
        };
        self.integrate::<V, R, _>(fits, true, density, &parts, sink, &mut |phi, amount, _| {
            (amount.mass * phi, amount.momentum * phi)
        });
    }

    /// `parts` says what a value at a point adds, `part(phi, value, gradient)` the same for one DOF.
    #[inline(always)]
    fn integrate<V: Lanes<T>, R: Reconstruction<T, D>, Q: Field<T>>(
        &self,
        fits: Fits<'_, '_, T, D, R>,
        conserve: bool,
        value: &impl Fn(usize) -> Q,
        parts: &impl Fn(&[V; MOST_COMPONENTS]) -> Parts<V, D>,
        sink: &mut impl FnMut(usize, T, SVector<T, D>),
        part: &mut impl FnMut(T, Q, SVector<T, D>) -> (T, SVector<T, D>),
    ) -> usize {
        let Fits {
            reconstruction,
            cloud,
            cells,
        } = fits;
        let (points, units) = line::<T, V>(reconstruction.line());
        let mut functions = AtPoints::<V, D>::new(points);
        let mut sums = Sums::<V, D>::new();
        let occupied = cloud.bins.occupied();
        let mut reduced = 0;
        for first in cells.clone().step_by(LANES) {
            let places = first..cells.end.min(first + LANES);
            let last = places.end - 1;
            let four: [Cell<D>; LANES] =
                std::array::from_fn(|l| self.grid.cell(occupied[last.min(first + l)] as usize));
            functions.take(self, &four, units);
            let outcome = reconstruction.integrate_four::<V, Q>(
                cloud,
                places.clone(),
                conserve,
                value,
                #[inline(always)]
                |number, value| sums.add_to::<false, T, B>(self, &functions.at(number), &parts(value)),
            );
            reduced += outcome.reduced;
            sums.spread(self, &four[..places.len()], &outcome.hard, sink);
            let hard = places.zip(outcome.hard).filter(|&(_, hard)| hard);
            for (place, _) in hard {
                let cell = occupied[place] as usize;
                let add = |point: &Point<T, D>, value| {
                    let (cell, x) = (&point.cell, &point.position);
                    self.basis.for_each(self.grid, cell, x, |dof, phi, gradient| {
                        let (scalar, vector) = part(phi, value, gradient);
                        sink(dof, scalar, vector);
                    });
                };
                let full = reconstruction.integrate_hard(cloud, cell, conserve, value, add);
                reduced += usize::from(!full);
            }
        }
        reduced
    }
}

/// Number and coordinates from 0 to 1 of points given by theirs from -1 to 1.
fn line<T: Scalar, V: Lanes<T>>(points: impl Iterator<Item = T>) -> (usize, V) {
    let half = T::one() / T::lit(2.0);
    let mut units = [half; LANES];
    let mut count = 0;
    for (unit, point) in units.iter_mut().zip(points) {
        *unit = (point + T::one()) * half;
        count += 1;
    }
    (count, V::new(units))
}
