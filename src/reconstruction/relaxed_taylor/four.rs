//! The fits of four cells that follow each other in the list of occupied ones, a cell in each lane.

use std::ops::Range;

use super::filling::OpenSides;
use crate::lanes::{LANES, Lanes};
use crate::reconstruction::Cloud;
use crate::reconstruction::taylor::{self, CellGroup};
use crate::scalar::Scalar;
use crate::taylor::{Factor, Products, Rights, factorise, shift_lanes};

/// In place of a neighbour that there is not.
pub(super) const NONE: u32 = u32::MAX;

/// Products of four cells, kept.
pub(super) type KeptProducts<T, const NB: usize> = Products<[T; LANES], NB>;

/// Places of the occupied cells that share a face with four cells: along each axis below and above.
pub(super) type Neighbours<const D: usize> = [[[u32; LANES]; 2]; D];

/// The factors of the fits of four cells, and what became of them.
#[derive(Clone, Debug)]
pub(super) struct FourFits<T, const D: usize, const NB: usize> {
    pub(super) neighbours: Neighbours<D>,
    /// Of their own particles.
    own: KeptProducts<T, NB>,
    /// With the particles of the neighbours.
    wide: KeptProducts<T, NB>,
    /// Whether the own fits have all functions.
    pub(super) own_is_full: [bool; LANES],
    /// Whether the own fits are in doubt.
    pub(super) own_is_hard: [bool; LANES],
    wide_is_full: [bool; LANES],
}

/// Keeps the lower half.
#[inline(always)]
fn keep<T: Scalar, V: Lanes<T>, const NB: usize>(products: &Products<V, NB>, kept: &mut KeptProducts<T, NB>) {
    for i in 0..NB {
        for j in 0..=i {
            kept[i][j] = products[i][j].array();
        }
    }
}

/// The lower half of what was kept.
#[inline(always)]
fn load<T: Scalar, V: Lanes<T>, const NB: usize>(kept: &KeptProducts<T, NB>) -> Products<V, NB> {
    let mut products = [[V::splat(T::zero()); NB]; NB];
    for i in 0..NB {
        for j in 0..=i {
            products[i][j] = V::new(kept[i][j]);
        }
    }
    products
}

/// Numbers of points, given as sums of ones.
#[inline(always)]
fn counts<T: Scalar, V: Lanes<T>>(sums: V) -> [usize; LANES] {
    let sums = sums.array();
    std::array::from_fn(|l| sums[l].primal() as usize)
}

/// One or zero.
#[inline(always)]
fn mask<T: Scalar, V: Lanes<T>>(lanes: [bool; LANES]) -> V {
    V::new(std::array::from_fn(
        |l| if lanes[l] { T::one() } else { T::zero() },
    ))
}

/// Sums of products over the own particles of each of the cells at `places`, the lower half.
#[inline(always)]
pub(super) fn keep_gram<T: Scalar, V: Lanes<T>, const D: usize, const NB: usize>(
    cloud: &Cloud<'_, T, D>,
    places: Range<usize>,
    kept: &mut KeptProducts<T, NB>,
) {
    let nothing = |_: usize| T::zero();
    let group = CellGroup::new(cloud, places.clone());
    let sums = group.sums::<taylor::Products, T, V, T, NB, 1>(cloud, places, &nothing, cloud.volumes);
    keep::<T, V, NB>(&sums.gram, kept);
}

impl<T: Scalar, const D: usize, const NB: usize> FourFits<T, D, NB> {
    /// Of no particles.
    pub(super) fn empty() -> Self {
        let nothing = [[[T::zero(); LANES]; NB]; NB];
        Self {
            neighbours: [[[NONE; LANES]; 2]; D],
            own: nothing,
            wide: nothing,
            own_is_full: [false; LANES],
            own_is_hard: [true; LANES],
            wide_is_full: [false; LANES],
        }
    }

    /// On which sides the cell in a lane has no neighbour.
    pub(super) fn open_sides(&self, lane: usize) -> OpenSides<D> {
        self.neighbours
            .map(|sides| sides.map(|places| places[lane] == NONE))
    }

    /// Takes in the cells at `places`, given the sums of products of all.
    #[inline(always)]
    pub(super) fn take_in<V: Lanes<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        places: Range<usize>,
        grams: &[KeptProducts<T, NB>],
        tolerance: T,
    ) {
        self.neighbours = [[[NONE; LANES]; 2]; D];
        let neighbours = &mut self.neighbours;
        for (l, place) in places.clone().enumerate() {
            cloud
                .bins
                .for_each_neighbour(cloud.grid, place, |axis, above, other| {
                    neighbours[axis][usize::from(above)][l] = other as u32;
                });
        }
        let gram = load::<T, V, NB>(&grams[places.start / LANES]);
        let own_counts = counts::<T, V>(gram[0][0]);
        let own = factorise::<T, V, D, NB>(&gram, 0, &own_counts, tolerance);
        let all = with_neighbours::<T, V, D, NB>(gram, neighbours, grams);
        let all_counts = counts::<T, V>(all[0][0]);
        let wide = factorise::<T, V, D, NB>(&all, 0, &all_counts, tolerance);
        keep::<T, V, NB>(&own.factor.0, &mut self.own);
        keep::<T, V, NB>(&wide.factor.0, &mut self.wide);
        for l in 0..LANES {
            self.own_is_full[l] = own.functions[l] == NB;
            self.wide_is_full[l] = !wide.hard[l] && wide.functions[l] == NB;
        }
        self.own_is_hard = own.hard;
    }

    /// Coefficients of what is integrated, from the own sums: the own fit, and where that has not all functions the wide one with,
    /// on top of it, what the own particles see beside that.
    #[inline(always)]
    pub(super) fn integrated<V: Lanes<T>, const C: usize>(
        &self,
        group: usize,
        gram: &KeptProducts<T, NB>,
        sums: &KeptSums<'_, T>,
    ) -> Rights<V, NB, C> {
        let wants_wide: [bool; LANES] = std::array::from_fn(|l| !self.own_is_full[l] && self.wide_is_full[l]);
        if !wants_wide.contains(&true) {
            return self.own_coefficients(&sums.load::<V, NB, C>(group), sums.components);
        }
        let mut seen = self.wide_coefficients(group, sums);
        let mask = mask::<T, V>(wants_wide);
        for k in 0..NB {
            for q in 0..sums.components {
                seen[k][q] = seen[k][q] * mask;
            }
        }
        let rest = self.rest::<V, C>(group, gram, sums, &seen);
        for k in 0..NB {
            for q in 0..sums.components {
                seen[k][q] = seen[k][q] + rest[k][q];
            }
        }
        seen
    }

    /// Coefficients of the own fits of what polynomials leave of the values.
    #[inline(always)]
    fn rest<V: Lanes<T>, const C: usize>(
        &self,
        group: usize,
        gram: &KeptProducts<T, NB>,
        sums: &KeptSums<'_, T>,
        seen: &Rights<V, NB, C>,
    ) -> Rights<V, NB, C> {
        let mut right = sums.load::<V, NB, C>(group);
        let gram = load::<T, V, NB>(gram);
        for i in 0..NB {
            for j in 0..NB {
                let product = gram[i.max(j)][i.min(j)];
                for q in 0..sums.components {
                    right[i][q] = right[i][q] - product * seen[j][q];
                }
            }
        }
        self.own_coefficients(&right, sums.components)
    }

    /// Adds to the wide fits the constants with which their slopes leave the means of the cells' fits alone, wherever in the
    /// cell its particles are: a slope that changes turns about the middle of the cell, and not of the particles.
    #[inline(always)]
    pub(super) fn turn_about_the_middle<V: Lanes<T>, const C: usize>(
        &self,
        group: usize,
        gram: &KeptProducts<T, NB>,
        sums: &KeptSums<'_, T>,
        wide: &mut Rights<V, NB, C>,
    ) {
        let rest = self.rest::<V, C>(group, gram, sums, wide);
        for k in 1..=D {
            let middle = V::new(std::array::from_fn(|l| middle(gram[k][0][l], gram[0][0][l])));
            for q in 0..sums.components {
                wide[0][q] = wide[0][q] - rest[k][q] * middle;
            }
        }
    }

    /// Coefficients of the own fits from their sums.
    #[inline(always)]
    pub(super) fn own_coefficients<V: Lanes<T>, const C: usize>(
        &self,
        right: &Rights<V, NB, C>,
        components: usize,
    ) -> Rights<V, NB, C> {
        solve(&self.own, right, components)
    }

    /// Coefficients of the wide fits; zero where they have not all functions.
    #[inline(always)]
    pub(super) fn wide_coefficients<V: Lanes<T>, const C: usize>(
        &self,
        group: usize,
        sums: &KeptSums<'_, T>,
    ) -> Rights<V, NB, C> {
        let mut right = sums.load::<V, NB, C>(group);
        for axis in 0..D {
            for (side, places) in self.neighbours[axis].iter().enumerate() {
                let there: [bool; LANES] = std::array::from_fn(|l| places[l] != NONE);
                if !there.contains(&true) {
                    continue;
                }
                let mut theirs = sums.load_at::<V, NB, C>(places);
                shift_lanes::<T, V, D, NB, C>(&mut theirs, sums.components, axis, side > 0);
                let mask = mask::<T, V>(there);
                for k in 0..NB {
                    for q in 0..sums.components {
                        right[k][q] = theirs[k][q].mul_add(mask, right[k][q]);
                    }
                }
            }
        }
        let mask = mask::<T, V>(self.wide_is_full);
        let mut coefficients = solve(&self.wide, &right, sums.components);
        for k in 0..NB {
            for q in 0..sums.components {
                coefficients[k][q] = coefficients[k][q] * mask;
            }
        }
        coefficients
    }

    /// In which lanes the wide fits have all functions.
    pub(super) fn wide_is_full(&self) -> [bool; LANES] {
        self.wide_is_full
    }
}

/// Middle of so many points from the sum of their coordinates; of none that of the cell.
#[inline(always)]
pub(super) fn middle<T: Scalar>(sum: T, count: T) -> T {
    if count > T::zero() { sum / count } else { T::zero() }
}

#[inline(always)]
fn solve<T: Scalar, V: Lanes<T>, const NB: usize, const C: usize>(
    factor: &KeptProducts<T, NB>,
    right: &Rights<V, NB, C>,
    components: usize,
) -> Rights<V, NB, C> {
    let factor = Factor(load::<T, V, NB>(factor));
    let mut coefficients = [[V::splat(T::zero()); C]; NB];
    for q in 0..components {
        factor.solve(0, q, right, &mut coefficients);
    }
    coefficients
}

/// Adds the sums of products of the neighbours, in the frames of the cells themselves.
#[inline(always)]
fn with_neighbours<T: Scalar, V: Lanes<T>, const D: usize, const NB: usize>(
    mut gram: Products<V, NB>,
    neighbours: &Neighbours<D>,
    grams: &[KeptProducts<T, NB>],
) -> Products<V, NB> {
    for axis in 0..D {
        for (side, places) in neighbours[axis].iter().enumerate() {
            let there: [bool; LANES] = std::array::from_fn(|l| places[l] != NONE);
            if !there.contains(&true) {
                continue;
            }
            let at: [usize; LANES] =
                std::array::from_fn(|l| if places[l] == NONE { 0 } else { places[l] as usize });
            let of = at.map(|place| (&grams[place / LANES], place % LANES));
            let [a, b, c, d] = of;
            let mut rows = gram;
            for i in 0..NB {
                for j in 0..NB {
                    let (high, low) = (i.max(j), i.min(j));
                    rows[i][j] = V::new([
                        a.0[high][low][a.1],
                        b.0[high][low][b.1],
                        c.0[high][low][c.1],
                        d.0[high][low][d.1],
                    ]);
                }
            }
            shift_lanes::<T, V, D, NB, NB>(&mut rows, NB, axis, side > 0);
            let mut columns = rows;
            for i in 0..NB {
                for j in 0..NB {
                    columns[j][i] = rows[i][j];
                }
            }
            shift_lanes::<T, V, D, NB, NB>(&mut columns, NB, axis, side > 0);
            let mask = mask::<T, V>(there);
            for i in 0..NB {
                for j in 0..=i {
                    gram[i][j] = columns[j][i].mul_add(mask, gram[i][j]);
                }
            }
        }
    }
    gram
}

/// Sums of functions times components over the particles of all occupied cells, four cells after four: of each function each
/// component in four lanes.
#[derive(Clone, Copy)]
pub(super) struct KeptSums<'a, T> {
    pub(super) values: &'a [[T; LANES]],
    pub(super) components: usize,
}

impl<T: Scalar> KeptSums<'_, T> {
    /// Of four cells.
    #[inline(always)]
    pub(super) fn load<V: Lanes<T>, const NB: usize, const C: usize>(
        &self,
        group: usize,
    ) -> Rights<V, NB, C> {
        let mut rights = [[V::splat(T::zero()); C]; NB];
        let first = group * NB * self.components;
        let values = &self.values[first..first + NB * self.components];
        for k in 0..NB {
            for q in 0..self.components {
                rights[k][q] = V::new(values[k * self.components + q]);
            }
        }
        rights
    }

    /// Of the cells at four places, any where there is none.
    #[inline(always)]
    fn load_at<V: Lanes<T>, const NB: usize, const C: usize>(
        &self,
        places: &[u32; LANES],
    ) -> Rights<V, NB, C> {
        let mut rights = [[V::splat(T::zero()); C]; NB];
        let each = NB * self.components;
        let at: [usize; LANES] =
            std::array::from_fn(|l| if places[l] == NONE { 0 } else { places[l] as usize });
        let of: [&[[T; LANES]]; LANES] = std::array::from_fn(|l| {
            let first = at[l] / LANES * each;
            &self.values[first..first + each]
        });
        for k in 0..NB {
            for q in 0..self.components {
                rights[k][q] = V::new(std::array::from_fn(|l| {
                    of[l][k * self.components + q][at[l] % LANES]
                }));
            }
        }
        rights
    }

    /// Of one cell, as a field.
    pub(super) fn of_cell<Q: crate::field::Field<T>, const NB: usize>(&self, place: usize) -> [Q; NB] {
        let first = place / LANES * NB * self.components;
        std::array::from_fn(|k| {
            let mut sum = Q::zero();
            for q in 0..self.components {
                sum.set_component(q, self.values[first + k * self.components + q][place % LANES]);
            }
            sum
        })
    }
}

/// Puts the sums of four cells where they are kept.
#[inline(always)]
pub(super) fn keep_sums<T: Scalar, V: Lanes<T>, const NB: usize, const C: usize>(
    rights: &Rights<V, NB, C>,
    components: usize,
    kept: &mut [[T; LANES]],
) {
    for k in 0..NB {
        for q in 0..components {
            kept[k * components + q] = rights[k][q].array();
        }
    }
}
