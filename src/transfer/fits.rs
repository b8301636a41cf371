//! Integrals of fits over cells, four cells at a time.
//!
//! The points of the fits are at the same places in every cell, so the functions there are the same in all
//! cells but those near the ends of the grid: they are computed once and kept until a cell of another kind
//! comes.

use std::ops::Range;

use super::Sweep;
use super::pairs::PairSums;
use super::polynomials::{CellMatrices, MOST_FUNCTIONS};
use super::stencil::{Look, Seer, Stencil};
use super::sums::{Parts, Sum, Sums};
use crate::basis::{BasisFamily, Factors, MOST_WIDTH};
use crate::field::{Field, MassMomentum, Pair, Symmetric, symmetric_component};
use crate::grid::Cell;
use crate::particles::Domains;
use crate::reconstruction::{Cloud, Kept, Point, Reconstruction, Values, batch_of_cells};
use crate::scalar::Scalar;
use crate::simd::{LANES, Number, Packs, dispatch_vectors, each, in_lanes, inlined};
use crate::taylor::MOST_COMPONENTS;

/// Most points along an axis.
pub(crate) const MOST_POINTS: usize = LANES;

/// Values and slopes of the functions along an axis at one point, a cell in each lane.
type Along<V> = [[V; MOST_WIDTH]; 2];

/// Of which kinds four cells are: those of one kind have the same functions.
pub(super) struct Kinds<const D: usize> {
    kinds: Option<[[usize; D]; LANES]>,
    /// Whether they are cells of one line that all are far from the ends of the grid.
    inside: bool,
}

impl<const D: usize> Kinds<D> {
    /// Of none yet.
    pub(super) fn new() -> Self {
        Self {
            kinds: None,
            inside: false,
        }
    }

    /// Takes in those of four cells; returns whether they are others than before.
    #[inline(always)]
    pub(super) fn change<T: Scalar, B: BasisFamily<T, D>>(
        &mut self,
        sweep: &Sweep<'_, T, D, B>,
        cells: &[Cell<D>; LANES],
    ) -> bool {
        // Along one axis cells ascend: the first and the last one tell.
        let inside = D == 1 && sweep.kind(&cells[0]) == [0; D] && sweep.kind(&cells[LANES - 1]) == [0; D];
        if inside && self.inside {
            return false;
        }
        self.inside = inside;
        let kinds = each(
            #[inline(always)]
            |l| sweep.kind(&cells[l]),
        );
        let changed = self.kinds != Some(kinds);
        if changed {
            self.kinds = Some(kinds);
        }
        changed
    }
}

/// Functions along each axis at each point of a line.
struct AtPoints<V, const D: usize> {
    kinds: Kinds<D>,
    points: usize,
    along: [[Along<V>; MOST_POINTS]; D],
}

impl<V: Copy, const D: usize> AtPoints<V, D> {
    #[inline(always)]
    fn new<T: Scalar, K: Packs<T, V = V>>(k: K, points: usize) -> Self {
        let nothing = [[k.splat(T::zero()); MOST_WIDTH]; 2];
        Self {
            kinds: Kinds::new(),
            points,
            along: [[nothing; MOST_POINTS]; D],
        }
    }

    /// Brings them up to date for four cells; `units` are the points' coordinates from 0 to 1 in a cell.
    #[inline(always)]
    fn take<T: Scalar, B: BasisFamily<T, D>, K: Packs<T, V = V>>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        cells: &[Cell<D>; LANES],
        units: V,
    ) {
        if self.kinds.change(sweep, cells) {
            self.compute(k, sweep, cells, units);
        }
    }

    #[inline(never)]
    fn compute<T: Scalar, B: BasisFamily<T, D>, K: Packs<T, V = V>>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        cells: &[Cell<D>; LANES],
        units: V,
    ) {
        let of_cells: [Factors<V, D>; LANES] = k.run(
            #[inline(always)]
            || {
                each(
                    #[inline(always)]
                    |l| sweep.basis.factors(k, sweep.grid, &cells[l], &[units; D]),
                )
            },
        );
        for axis in 0..D {
            for point in 0..self.points {
                for i in 0..B::WIDTH {
                    let pick = |of: fn(&Factors<V, D>) -> &[[V; MOST_WIDTH]; D]| {
                        k.pack(in_lanes(|l| k.array(of(&of_cells[l])[axis][i])[point]))
                    };
                    self.along[axis][point][0][i] = pick(|factors| &factors.value);
                    self.along[axis][point][1][i] = pick(|factors| &factors.slope);
                }
            }
        }
    }

    /// At the point with the given number, axis 0 fastest.
    #[inline(always)]
    fn at(&self, mut number: usize) -> Factors<V, D> {
        let along: [&Along<V>; D] = each(
            #[inline(always)]
            |axis| {
                if D == 1 {
                    return &self.along[axis][number];
                }
                let point = number % self.points;
                number /= self.points;
                &self.along[axis][point]
            },
        );
        Factors {
            value: each(
                #[inline(always)]
                |axis| along[axis][0],
            ),
            slope: each(
                #[inline(always)]
                |axis| along[axis][1],
            ),
        }
    }
}

/// Finds the functions at a point: as [`look_up`](super::look_up). Behind a pointer, so that fits are
/// integrated by one sweep for all bases with the same functions at points that stand still.
pub(crate) type LookUp<'a, T, const D: usize> =
    dyn Fn(&Point<T, D>, &mut Stencil<T, D>, usize) -> usize + Sync + 'a;

/// What is to be integrated where.
pub(crate) struct Fits<'a, 'c, T, const D: usize, R> {
    /// Looks up the functions at points that move, but so many first ones; returns how many there are.
    pub(crate) moving: &'a LookUp<'a, T, D>,
    pub(crate) reconstruction: &'a R,
    pub(crate) cloud: &'a Cloud<'c, T, D>,
    /// Places in the list of occupied cells.
    pub(crate) cells: Range<usize>,
    /// Whether what was kept of them is of these positions.
    pub(crate) fresh: bool,
}

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>> Sweep<'_, T, D, B> {
    /// Cells of one kind have the same functions.
    #[inline(always)]
    fn kind(&self, cell: &Cell<D>) -> [usize; D] {
        let cells = self.grid.cells();
        each(
            #[inline(always)]
            |axis| {
                let (below, above) = (cell[axis] as usize, cells[axis] - 1 - cell[axis] as usize);
                if below < MOST_WIDTH || above < MOST_WIDTH {
                    below + MOST_WIDTH
                } else {
                    0
                }
            },
        )
    }

    /// Whether cells that ascend follow each other along axis 0, and their DOFs too.
    #[inline(always)]
    fn follow(&self, cells: &[Cell<D>; LANES]) -> bool {
        let (first, last) = (&cells[0], &cells[LANES - 1]);
        last[0] == first[0] + (LANES as u32 - 1)
            && last[1..] == first[1..]
            && self.first_dof(last) == self.first_dof(first) + (LANES - 1)
    }

    /// Streams fields that are fitted in each cell to DOFs: what an [`Integrand`] makes of their values at
    /// points. `sink(dof, sum)` takes the sums, `matrix(q, i, j, mass)`, `j <= i`, what the `q`-th mass adds
    /// to its consistent matrix. Returns how many cells were fitted without the full set of functions.
    #[inline(always)]
    pub(crate) fn integrate<
        R: Reconstruction<T, D>,
        I: Integrand<T, D, S, C, G, W>,
        const S: usize,
        const C: usize,
        const G: usize,
        const W: usize,
    >(
        &self,
        fits: &Fits<'_, '_, T, D, R>,
        kept: &mut [[T; LANES]],
        value: &(impl Values<T, I::Field> + Copy),
        sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>),
        matrix: &mut impl FnMut(usize, usize, usize, T),
    ) -> usize {
        let (sweep, value) = (*self, *value);
        dispatch_vectors!(T, |k| sweep
            .integrate_in::<_, R, I, S, C, G, W>(k, fits, kept, &value, sink, matrix))
    }

    #[inline(always)]
    fn integrate_in<
        K: Packs<T>,
        R: Reconstruction<T, D>,
        I: Integrand<T, D, S, C, G, W>,
        const S: usize,
        const C: usize,
        const G: usize,
        const W: usize,
    >(
        &self,
        k: K,
        fits: &Fits<'_, '_, T, D, R>,
        kept: &mut [[T; LANES]],
        value: &impl Values<T, I::Field>,
        sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>),
        matrix: &mut impl FnMut(usize, usize, usize, T),
    ) -> usize {
        let (reconstruction, cells) = (fits.reconstruction, fits.cells.clone());
        // A copy: a compiler then knows that what is written leaves it alone.
        let cloud = &{ *fits.cloud };
        let (points, units) = line(k, reconstruction.line());
        let mut functions = AtPoints::<K::V, D>::new(k, points);
        let mut matrices = CellMatrices::<T, K::V, D>::new(k, reconstruction.weighted_line());
        let mut sums = Sums::<K::V, D, S, C, G>::new(k);
        let mut pairs = [PairSums::<K::V, D>::new(k); W];
        let slopes = self.inverse(k);
        let mut reduced = 0;
        let mut numbers = kept.chunks_exact_mut(R::KEPT.max(1));
        for first in cells.clone().step_by(LANES) {
            let places = first..cells.end.min(first + LANES);
            let batch = batch_of_cells(cloud, places.clone());
            let four = each(
                #[inline(always)]
                |l| batch[l].1,
            );
            let kept = Kept {
                numbers: numbers.next().unwrap_or_default(),
                fresh: fits.fresh,
            };
            // Matrices of masses want the values at the points.
            let outcome = if const { R::FITS_TAYLOR && W == 0 } {
                matrices.take(k, self, &four);
                let ones = [k.splat(T::one()); D];
                let nothing = I::parts(&[k.splat(T::zero()); MOST_COMPONENTS], &ones);
                let mut parts = [nothing; MOST_FUNCTIONS];
                let outcome = reconstruction.fit_batch::<K, I::Field>(
                    k,
                    (cloud, places.clone()),
                    I::CONSERVED,
                    kept,
                    value,
                    #[inline(always)]
                    |number, value| parts[number] = I::parts(value, &ones),
                );
                matrices.put::<B, S, C, G>(&parts, &mut sums);
                outcome
            } else {
                functions.take(k, self, &four, units);
                reconstruction.integrate_batch::<K, I::Field>(
                    k,
                    (cloud, places.clone()),
                    I::CONSERVED,
                    kept,
                    value,
                    #[inline(always)]
                    |number, value| {
                        let factors = functions.at(number);
                        let parts = I::parts(value, &slopes);
                        sums.add_to::<false, T, B, K>(k, self, &factors, &parts);
                        let masses = I::masses(value);
                        for q in 0..W {
                            pairs[q].add_to::<T, B>(&factors, masses[q]);
                        }
                    },
                )
            };
            reduced += outcome.reduced;
            let lines = const { D == 1 || W == 0 };
            if lines && places.len() == LANES && self.follow(&four) && outcome.hard == [false; LANES] {
                sums.scatter_line(k, self, &four[0], sink);
                for q in 0..W {
                    pairs[q].scatter_line(k, self, &four[0], &mut |i, j, mass| matrix(q, i, j, mass));
                }
                continue;
            }
            sums.spread(k, self, &four[..places.len()], &outcome.hard, sink);
            for q in 0..W {
                pairs[q].spread(
                    k,
                    self,
                    &four[..places.len()],
                    &outcome.hard,
                    &mut inlined(
                        #[inline(always)]
                        |i, j, mass| matrix(q, i, j, mass),
                    ),
                );
            }
            if outcome.hard.contains(&true) {
                reduced += self.integrate_single::<R, I, S, C, G, W>(
                    fits,
                    places,
                    &outcome.hard,
                    value,
                    sink,
                    matrix,
                );
            }
        }
        reduced
    }

    /// Cells at `places` that are `hard`, point by point; returns how many were fitted without the full set
    /// of functions.
    #[inline(never)]
    fn integrate_single<
        R: Reconstruction<T, D>,
        I: Integrand<T, D, S, C, G, W>,
        const S: usize,
        const C: usize,
        const G: usize,
        const W: usize,
    >(
        &self,
        fits: &Fits<'_, '_, T, D, R>,
        places: Range<usize>,
        hard: &[bool; LANES],
        value: &impl Values<T, I::Field>,
        sink: &mut impl FnMut(usize, Sum<T, D, S, C, G>),
        matrix: &mut impl FnMut(usize, usize, usize, T),
    ) -> usize {
        let (basis, grid, occupied) = (self.basis, self.grid, fits.cloud.bins.occupied());
        let (mut reduced, mut stencil) = (0, Stencil::new());
        // Points that stand still have no domains.
        let none = Domains::none();
        let none = none.views();
        for (place, _) in places.zip(hard).filter(|&(_, &hard)| hard) {
            let mut add = |point: &Point<T, D>, value| {
                let value = components_of::<T, I::Field>(&value);
                let parts = I::parts(&value, &[T::one(); D]);
                if point.moves {
                    let find = |stencil: &mut Stencil<T, D>, skip| (fits.moving)(point, stencil, skip);
                    return stencil.for_each_found(find, |i, phi, gradient| {
                        sink(i, Sum::of(&parts, phi, &gradient));
                    });
                }
                let (masses, place) = (I::masses(&value), (&point.cell, &point.position));
                let here = (basis, grid);
                stencil.for_each(here, &none, Seer::Moving, place, |i, phi, gradient| {
                    sink(i, Sum::of(&parts, phi, &gradient));
                });
                if W > 0 {
                    stencil.for_each_pair(here, Seer::Moving, place, |[i, j], [phi, other]| {
                        for q in 0..W {
                            matrix(q, i, j, masses[q] * phi * other);
                        }
                    });
                }
            };
            let cell = occupied[place] as usize;
            let full = fits.reconstruction.integrate_single(
                fits.cloud,
                cell,
                I::CONSERVED,
                &|p| value.at(p),
                &mut add,
            );
            reduced += usize::from(!full);
        }
        reduced
    }
}

/// The components of a value of a field.
#[inline(always)]
pub(crate) fn components_of<T: Scalar, Q: Field<T>>(value: &Q) -> [T; MOST_COMPONENTS] {
    let mut components = [T::zero(); MOST_COMPONENTS];
    for q in 0..Q::COMPONENTS {
        components[q] = value.component(q);
    }
    components
}

/// What the value of a fitted field at a point adds to DOFs: `S` scalars, `C` vectors and `G` tensors, and to
/// `W` mass matrices.
pub(crate) trait Integrand<
    T: Scalar,
    const D: usize,
    const S: usize,
    const C: usize,
    const G: usize,
    const W: usize,
>
{
    /// The field.
    type Field: Field<T>;

    /// Whether fits keep the integral of what particles hold.
    const CONSERVED: bool;

    /// The parts, `slopes` to be multiplied with the columns of tensors.
    fn parts<V: Number<T>>(value: &[V; MOST_COMPONENTS], slopes: &[V; D]) -> Parts<V, D, S, C, G>;

    /// Masses of the matrices.
    fn masses<V: Number<T>>(value: &[V; MOST_COMPONENTS]) -> [V; W];
}

/// The stress, of `G = 1`, or the total stress and the pressure of the liquid, of `G = 2`.
pub(crate) struct Stress;

impl<T: Scalar, const D: usize> Integrand<T, D, 0, 0, 1, 0> for Stress {
    type Field = Symmetric<T, D>;
    const CONSERVED: bool = false;

    #[inline(always)]
    fn parts<V: Number<T>>(value: &[V; MOST_COMPONENTS], slopes: &[V; D]) -> Parts<V, D, 0, 0, 1> {
        Parts {
            scalars: [],
            vectors: [],
            tensors: [tensor(value, slopes)],
        }
    }

    #[inline(always)]
    fn masses<V: Number<T>>(_value: &[V; MOST_COMPONENTS]) -> [V; 0] {
        []
    }
}

impl<T: Scalar, const D: usize> Integrand<T, D, 0, 0, 2, 0> for Stress {
    type Field = Pair<Symmetric<T, D>, T>;
    const CONSERVED: bool = false;

    #[inline(always)]
    fn parts<V: Number<T>>(value: &[V; MOST_COMPONENTS], slopes: &[V; D]) -> Parts<V, D, 0, 0, 2> {
        let total = tensor(value, slopes);
        // Packs have no zero without a token; where a stress is not finite, all is lost already.
        #[allow(clippy::eq_op)]
        let mut pressure = [[value[0] - value[0]; D]; D];
        for c in 0..D {
            pressure[c][c] = value[D * (D + 1) / 2] * slopes[c];
        }
        Parts {
            scalars: [],
            vectors: [],
            tensors: [total, pressure],
        }
    }

    #[inline(always)]
    fn masses<V: Number<T>>(_value: &[V; MOST_COMPONENTS]) -> [V; 0] {
        []
    }
}

/// Component `(c, a)`, times a slope, at `[c][a]`.
#[inline(always)]
fn tensor<T, V: Number<T>, const D: usize>(value: &[V; MOST_COMPONENTS], slopes: &[V; D]) -> [[V; D]; D] {
    each(
        #[inline(always)]
        |c| {
            each(
                #[inline(always)]
                |a| value[symmetric_component::<D>(c, a)] * slopes[a],
            )
        },
    )
}

/// Densities of mass and momentum, of one phase or two. `S` of the masses go to their row sums, `W` to
/// matrices.
pub(crate) struct MassesAndMomenta<Q>(std::marker::PhantomData<Q>);

impl<T: Scalar, const D: usize, const S: usize, const W: usize> Integrand<T, D, S, 1, 0, W>
    for MassesAndMomenta<MassMomentum<T, D>>
{
    type Field = MassMomentum<T, D>;
    const CONSERVED: bool = true;

    #[inline(always)]
    fn parts<V: Number<T>>(value: &[V; MOST_COMPONENTS], _slopes: &[V; D]) -> Parts<V, D, S, 1, 0> {
        Parts {
            scalars: [value[0]; S],
            vectors: [vector::<T, V, D>(value, 1)],
            tensors: [],
        }
    }

    #[inline(always)]
    fn masses<V: Number<T>>(value: &[V; MOST_COMPONENTS]) -> [V; W] {
        [value[0]; W]
    }
}

impl<T: Scalar, const D: usize, const S: usize, const W: usize> Integrand<T, D, S, 2, 0, W>
    for MassesAndMomenta<Pair<MassMomentum<T, D>, MassMomentum<T, D>>>
{
    type Field = Pair<MassMomentum<T, D>, MassMomentum<T, D>>;
    const CONSERVED: bool = true;

    #[inline(always)]
    fn parts<V: Number<T>>(value: &[V; MOST_COMPONENTS], _slopes: &[V; D]) -> Parts<V, D, S, 2, 0> {
        let mut scalars = [value[0]; S];
        if S > 1 {
            scalars[1] = value[D + 1];
        }
        Parts {
            scalars,
            vectors: [vector::<T, V, D>(value, 1), vector::<T, V, D>(value, D + 2)],
            tensors: [],
        }
    }

    #[inline(always)]
    fn masses<V: Number<T>>(value: &[V; MOST_COMPONENTS]) -> [V; W] {
        let mut masses = [value[0]; W];
        if W > 1 {
            masses[1] = value[D + 1];
        }
        masses
    }
}

/// The components of a vector, from one on.
#[inline(always)]
fn vector<T, V: Number<T>, const D: usize>(value: &[V; MOST_COMPONENTS], first: usize) -> [V; D] {
    each(
        #[inline(always)]
        |c| value[first + c],
    )
}

/// Number and coordinates from 0 to 1 of points given by theirs from -1 to 1.
#[inline(always)]
fn line<T: Scalar, K: Packs<T>>(k: K, points: impl Iterator<Item = T>) -> (usize, K::V) {
    let half = T::one() / T::lit(2.0);
    let mut units = [half; LANES];
    let mut count = 0;
    for (unit, point) in units.iter_mut().zip(points) {
        *unit = (point + T::one()) * half;
        count += 1;
    }
    (count, k.pack(units))
}
