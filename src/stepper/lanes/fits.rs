//! Integrals of fits over cells, four cells at a time.
//!
//! The points of the fits are at the same places in every cell, so the functions there are the same in all cells but those
//! near the ends of the grid: they are computed once and kept until a cell of another kind comes.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use super::Pass;
use super::pairs::PairSums;
use super::sums::{Parts, Sums};
use crate::basis::{BasisFamily, Factors, MOST_WIDTH};
use crate::field::{Field, MassMomentum};
use crate::grid::Cell;
use crate::lanes::{LANES, Lanes, with_lanes_of};
use crate::reconstruction::{Cloud, Point, Reconstruction, Values, four_cells};
use crate::scalar::Scalar;
use crate::taylor::MOST_COMPONENTS;

/// Most points along an axis.
pub(in super::super) const MOST_POINTS: usize = LANES;

/// Values and slopes of the functions along an axis at one point, a cell in each lane.
type Along<V> = [[V; MOST_WIDTH]; 2];

/// Functions along each axis at each point of a line.
struct AtPoints<V, const D: usize> {
    kinds: Option<[[usize; D]; LANES]>,
    /// Whether they are those of cells of one line that all are far from the ends of the grid.
    inside: bool,
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
            inside: false,
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
        // Along one axis cells ascend: the first and the last one tell.
        let inside = D == 1 && pass.kind(&cells[0]) == [0; D] && pass.kind(&cells[LANES - 1]) == [0; D];
        if inside && self.inside {
            return;
        }
        self.inside = inside;
        let kinds = std::array::from_fn(|l| pass.kind(&cells[l]));
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
            if D == 1 {
                return &self.along[axis][number];
            }
            let point = number % self.points;
            number /= self.points;
            &self.along[axis][point]
        });
        let along: [&Along<V>; D] = along;
        Factors {
            value: std::array::from_fn(|axis| along[axis][0]),
            slope: std::array::from_fn(|axis| along[axis][1]),
        }
    }
}

/// What is to be integrated where.
pub(in super::super) struct Fits<'a, 'c, T, const D: usize, M, R> {
    /// The functions at points that move.
    pub(in super::super) moving: &'a M,
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
    pub(in super::super) fn integrate_stress<M: BasisFamily<T, D>, R: Reconstruction<T, D>>(
        &self,
        fits: Fits<'_, '_, T, D, M, R>,
        stress: &impl Values<T, SMatrix<T, D, D>>,
        sink: &mut impl FnMut(usize, SVector<T, D>),
    ) -> usize {
        with_lanes_of!(T, self.stress_in[_, _](fits, stress, sink))
    }

    #[inline(never)]
    fn stress_in<V: Lanes<T>, M: BasisFamily<T, D>, R: Reconstruction<T, D>>(
        &self,
        fits: Fits<'_, '_, T, D, M, R>,
        stress: &impl Values<T, SMatrix<T, D, D>>,
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
        self.integrate::<false, V, _, R, SMatrix<T, D, D>>(
            fits,
            stress,
            &parts,
            &mut |dof, _, force| sink(dof, force),
            &mut |_, _, _| (),
            &|_, weighted, gradient| (T::zero(), weighted * gradient),
        )
    }

    /// Hands `sink(dof, mass, momentum)` what the fits through the particles' densities of both add to the DOFs.
    pub(in super::super) fn integrate_densities<M: BasisFamily<T, D>, R: Reconstruction<T, D>>(
        &self,
        fits: Fits<'_, '_, T, D, M, R>,
        density: &impl Values<T, MassMomentum<T, D>>,
        sink: &mut impl FnMut(usize, T, SVector<T, D>),
    ) {
        with_lanes_of!(T, self.densities_in[_, _](fits, density, sink));
    }

    #[inline(never)]
    fn densities_in<V: Lanes<T>, M: BasisFamily<T, D>, R: Reconstruction<T, D>>(
        &self,
        fits: Fits<'_, '_, T, D, M, R>,
        density: &impl Values<T, MassMomentum<T, D>>,
        sink: &mut impl FnMut(usize, T, SVector<T, D>),
    ) {
        let parts = |value: &[V; MOST_COMPONENTS]| Parts {
            scalar: Some(value[0]),
            ..momentum_parts(value)
        };
        self.integrate::<false, V, _, R, MassMomentum<T, D>>(
            fits,
            density,
            &parts,
            sink,
            &mut |_, _, _| (),
            &amount_part,
        );
    }

    /// The same where the mass goes to the entries of the consistent matrix: `matrix(i, j, mass)`, `j <= i`.
    pub(in super::super) fn integrate_pairs<M: BasisFamily<T, D>, R: Reconstruction<T, D>>(
        &self,
        fits: Fits<'_, '_, T, D, M, R>,
        density: &impl Values<T, MassMomentum<T, D>>,
        sink: &mut impl FnMut(usize, SVector<T, D>),
        matrix: &mut impl FnMut(usize, usize, T),
    ) -> usize {
        with_lanes_of!(T, self.density_pairs_in[_, _](fits, density, sink, matrix))
    }

    #[inline(never)]
    fn density_pairs_in<V: Lanes<T>, M: BasisFamily<T, D>, R: Reconstruction<T, D>>(
        &self,
        fits: Fits<'_, '_, T, D, M, R>,
        density: &impl Values<T, MassMomentum<T, D>>,
        sink: &mut impl FnMut(usize, SVector<T, D>),
        matrix: &mut impl FnMut(usize, usize, T),
    ) -> usize {
        let mut sink = |dof: usize, _, momentum| sink(dof, momentum);
        self.integrate::<true, V, _, R, MassMomentum<T, D>>(
            fits,
            density,
            &momentum_parts,
            &mut sink,
            matrix,
            &amount_part,
        )
    }

    /// `parts` says what a value at a point adds, `part(phi, value, gradient)` the same for one DOF. Densities, whose first
    /// component is that of the mass, are conserved; with `PAIRS` their mass goes to the `matrix`.
    #[inline(always)]
    fn integrate<
        const PAIRS: bool,
        V: Lanes<T>,
        M: BasisFamily<T, D>,
        R: Reconstruction<T, D>,
        Q: Field<T>,
    >(
        &self,
        fits: Fits<'_, '_, T, D, M, R>,
        value: &impl Values<T, Q>,
        parts: &impl Fn(&[V; MOST_COMPONENTS]) -> Parts<V, D>,
        sink: &mut impl FnMut(usize, T, SVector<T, D>),
        matrix: &mut impl FnMut(usize, usize, T),
        part: &impl Fn(T, Q, SVector<T, D>) -> (T, SVector<T, D>),
    ) -> usize {
        let Fits {
            moving,
            reconstruction,
            cloud,
            cells,
        } = fits;
        let conserve = Q::DENSITIES != 0;
        let (points, units) = line::<T, V>(reconstruction.line());
        let mut functions = AtPoints::<V, D>::new(points);
        let mut sums = Sums::<V, D>::new();
        let mut pairs = PairSums::<V, D>::new();
        let occupied = cloud.bins.occupied();
        let mut reduced = 0;
        for first in cells.clone().step_by(LANES) {
            let places = first..cells.end.min(first + LANES);
            let four = four_cells(cloud, places.clone()).map(|(_, cell)| cell);
            functions.take(self, &four, units);
            let outcome = reconstruction.integrate_four::<V, Q>(
                cloud,
                places.clone(),
                conserve,
                value,
                #[inline(always)]
                |number, value| {
                    let factors = functions.at(number);
                    sums.add_to::<false, T, B>(self, &factors, &parts(value));
                    if PAIRS {
                        pairs.add_to::<T, B>(&factors, value[0]);
                    }
                },
            );
            reduced += outcome.reduced;
            if const { D == 1 } && places.len() == LANES && follow(&four) && outcome.hard == [false; LANES] {
                sums.spread_line(self, &four[0], sink);
                if PAIRS {
                    pairs.spread_line(self, &four[0], matrix);
                }
                continue;
            }
            sums.spread(self, &four[..places.len()], &outcome.hard, sink);
            if PAIRS {
                pairs.spread(self, &four[..places.len()], &outcome.hard, matrix);
            }
            let hard = places.zip(outcome.hard).filter(|&(_, hard)| hard);
            for (place, _) in hard {
                let cell = occupied[place] as usize;
                let add = |point: &Point<T, D>, value| {
                    let (cell, x) = (&point.cell, &point.position);
                    if point.moves {
                        return moving.for_each(self.grid, cell, x, |i, phi, gradient| {
                            let (scalar, vector) = part(phi, value, gradient);
                            sink(i, scalar, vector);
                        });
                    }
                    self.basis.for_each(self.grid, cell, x, |i, phi, gradient| {
                        let (scalar, vector) = part(phi, value, gradient);
                        sink(i, scalar, vector);
                        if PAIRS {
                            self.basis.for_each(self.grid, cell, x, |j, other, _| {
                                if j <= i {
                                    matrix(i, j, scalar * other);
                                }
                            });
                        }
                    });
                };
                let full = reconstruction.integrate_hard(cloud, cell, conserve, &|p| value.at(p), add);
                reduced += usize::from(!full);
            }
        }
        reduced
    }
}

/// Whether cells that ascend along one axis follow each other.
#[inline(always)]
fn follow<const D: usize>(cells: &[Cell<D>; LANES]) -> bool {
    cells[LANES - 1][0] - cells[0][0] == LANES as u32 - 1
}

/// What a mass and a momentum add to the momenta of the DOFs.
#[inline(always)]
fn momentum_parts<V: Copy, const D: usize>(value: &[V; MOST_COMPONENTS]) -> Parts<V, D> {
    Parts {
        scalar: None,
        vector: Some(std::array::from_fn(|c| value[1 + c])),
        tensor: None,
    }
}

/// What a mass and a momentum add to those of one DOF.
#[inline(always)]
fn amount_part<T: Scalar, const D: usize>(
    phi: T,
    amount: MassMomentum<T, D>,
    _gradient: SVector<T, D>,
) -> (T, SVector<T, D>) {
    (amount.mass * phi, amount.momentum * phi)
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
