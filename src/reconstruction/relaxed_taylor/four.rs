//! The fits of four cells that follow each other in the list of occupied ones, a cell in each lane.

use std::ops::Range;

use super::filling::OpenSides;
use crate::reconstruction::Cloud;
use crate::reconstruction::taylor::{self, CellGroup};
use crate::scalar::Scalar;
use crate::simd::{LANES, Number, Packs, each, in_lanes};
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
fn keep<T: Scalar, K: Packs<T>, const NB: usize>(
    k: K,
    products: &Products<K::V, NB>,
    kept: &mut KeptProducts<T, NB>,
) {
    for i in 0..NB {
        for j in 0..=i {
            kept[i][j] = k.array(products[i][j]);
        }
    }
}

/// The lower half of what was kept.
#[inline(always)]
fn load<T: Scalar, K: Packs<T>, const NB: usize>(k: K, kept: &KeptProducts<T, NB>) -> Products<K::V, NB> {
    let mut products = [[k.splat(T::zero()); NB]; NB];
    for i in 0..NB {
        for j in 0..=i {
            products[i][j] = k.pack(kept[i][j]);
        }
    }
    products
}

/// Numbers of points, given as sums of ones.
#[inline(always)]
fn counts<T: Scalar, K: Packs<T>>(k: K, sums: K::V) -> [usize; LANES] {
    let sums = k.array(sums);
    each(
        #[inline(always)]
        |l| sums[l].primal() as usize,
    )
}

/// One or zero.
#[inline(always)]
fn mask<T: Scalar, K: Packs<T>>(k: K, lanes: [bool; LANES]) -> K::V {
    k.pack(in_lanes(
        #[inline(always)]
        |l| if lanes[l] { T::one() } else { T::zero() },
    ))
}

/// Sums of products over the own particles of each of the cells at `places`, the lower half.
#[inline(always)]
pub(super) fn keep_gram<T: Scalar, K: Packs<T>, const D: usize, const NB: usize>(
    k: K,
    cloud: &Cloud<'_, T, D>,
    places: Range<usize>,
    kept: &mut KeptProducts<T, NB>,
) {
    let nothing = |_: usize| T::zero();
    let group = CellGroup::new(cloud, places.clone());
    let sums = group.sums::<taylor::Products, T, K, T, NB, 1>(k, cloud, places, &nothing, cloud.volumes);
    keep::<T, K, NB>(k, &sums.gram, kept);
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
    pub(super) fn take_in<K: Packs<T>>(
        &mut self,
        k: K,
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
        let gram = load::<T, K, NB>(k, &grams[places.start / LANES]);
        let own_counts = counts::<T, K>(k, gram[0][0]);
        let own = factorise::<T, K, D, NB>(k, &gram, 0, &own_counts, tolerance);
        let all = with_neighbours::<T, K, D, NB>(k, gram, neighbours, grams);
        let all_counts = counts::<T, K>(k, all[0][0]);
        let wide = factorise::<T, K, D, NB>(k, &all, 0, &all_counts, tolerance);
        keep::<T, K, NB>(k, &own.factor.0, &mut self.own);
        keep::<T, K, NB>(k, &wide.factor.0, &mut self.wide);
        for l in 0..LANES {
            self.own_is_full[l] = own.functions[l] == NB;
            self.wide_is_full[l] = !wide.hard[l] && wide.functions[l] == NB;
        }
        self.own_is_hard = own.hard;
    }

    /// Coefficients of what is integrated, from the own sums: the own fit, and where that has not all
    /// functions the wide one with, on top of it, what the own particles see beside that.
    #[inline(always)]
    pub(super) fn integrated<K: Packs<T>, const C: usize>(
        &self,
        k: K,
        group: usize,
        gram: &KeptProducts<T, NB>,
        sums: &KeptSums<'_, T>,
    ) -> Rights<K::V, NB, C> {
        let wants_wide: [bool; LANES] = each(
            #[inline(always)]
            |l| !self.own_is_full[l] && self.wide_is_full[l],
        );
        if !wants_wide.contains(&true) {
            return self.own_coefficients(k, &sums.load::<K, NB, C>(k, group), sums.components);
        }
        let mut seen = self.wide_coefficients(k, group, sums);
        let mask = mask::<T, K>(k, wants_wide);
        for n in 0..NB {
            for q in 0..sums.components {
                seen[n][q] = seen[n][q] * mask;
            }
        }
        let rest = self.rest::<K, C>(k, group, gram, sums, &seen);
        for n in 0..NB {
            for q in 0..sums.components {
                seen[n][q] = seen[n][q] + rest[n][q];
            }
        }
        seen
    }

    /// Coefficients of the own fits of what polynomials leave of the values.
    #[inline(always)]
    fn rest<K: Packs<T>, const C: usize>(
        &self,
        k: K,
        group: usize,
        gram: &KeptProducts<T, NB>,
        sums: &KeptSums<'_, T>,
        seen: &Rights<K::V, NB, C>,
    ) -> Rights<K::V, NB, C> {
        let mut right = sums.load::<K, NB, C>(k, group);
        let gram = load::<T, K, NB>(k, gram);
        for i in 0..NB {
            for j in 0..NB {
                let product = gram[i.max(j)][i.min(j)];
                for q in 0..sums.components {
                    right[i][q] = right[i][q] - product * seen[j][q];
                }
            }
        }
        self.own_coefficients(k, &right, sums.components)
    }

    /// Adds to the wide fits the constants with which their slopes leave the means of the cells' fits alone,
    /// wherever in the cell its particles are: a slope that changes turns about the middle of the cell, and
    /// not of the particles.
    #[inline(always)]
    pub(super) fn keep_means_of_cells<K: Packs<T>, const C: usize>(
        &self,
        k: K,
        group: usize,
        gram: &KeptProducts<T, NB>,
        sums: &KeptSums<'_, T>,
        wide: &mut Rights<K::V, NB, C>,
    ) {
        let rest = self.rest::<K, C>(k, group, gram, sums, wide);
        for n in 1..=D {
            let middle = k.pack(in_lanes(
                #[inline(always)]
                |l| middle(gram[n][0][l], gram[0][0][l]),
            ));
            for q in 0..sums.components {
                wide[0][q] = wide[0][q] - rest[n][q] * middle;
            }
        }
    }

    /// Coefficients of the own fits from their sums.
    #[inline(always)]
    pub(super) fn own_coefficients<K: Packs<T>, const C: usize>(
        &self,
        k: K,
        right: &Rights<K::V, NB, C>,
        components: usize,
    ) -> Rights<K::V, NB, C> {
        solve(k, &self.own, right, components)
    }

    /// Coefficients of the wide fits; zero where they have not all functions.
    #[inline(always)]
    pub(super) fn wide_coefficients<K: Packs<T>, const C: usize>(
        &self,
        k: K,
        group: usize,
        sums: &KeptSums<'_, T>,
    ) -> Rights<K::V, NB, C> {
        let mut right = sums.load::<K, NB, C>(k, group);
        for axis in 0..D {
            for (side, places) in self.neighbours[axis].iter().enumerate() {
                let there: [bool; LANES] = each(
                    #[inline(always)]
                    |l| places[l] != NONE,
                );
                if !there.contains(&true) {
                    continue;
                }
                let mut theirs = sums.load_at::<K, NB, C>(k, places);
                shift_lanes::<T, K, D, NB, C>(k, &mut theirs, sums.components, axis, side > 0);
                let mask = mask::<T, K>(k, there);
                for n in 0..NB {
                    for q in 0..sums.components {
                        right[n][q] = theirs[n][q].mul_add(mask, right[n][q]);
                    }
                }
            }
        }
        let mask = mask::<T, K>(k, self.wide_is_full);
        let mut coefficients = solve(k, &self.wide, &right, sums.components);
        for n in 0..NB {
            for q in 0..sums.components {
                coefficients[n][q] = coefficients[n][q] * mask;
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
fn solve<T: Scalar, K: Packs<T>, const NB: usize, const C: usize>(
    k: K,
    factor: &KeptProducts<T, NB>,
    right: &Rights<K::V, NB, C>,
    components: usize,
) -> Rights<K::V, NB, C> {
    let factor = Factor(load::<T, K, NB>(k, factor));
    let mut coefficients = [[k.splat(T::zero()); C]; NB];
    for q in 0..components {
        factor.solve::<T, C>(k.splat(T::zero()), 0, q, right, &mut coefficients);
    }
    coefficients
}

/// Adds the sums of products of the neighbours, in the frames of the cells themselves.
#[inline(always)]
fn with_neighbours<T: Scalar, K: Packs<T>, const D: usize, const NB: usize>(
    k: K,
    mut gram: Products<K::V, NB>,
    neighbours: &Neighbours<D>,
    grams: &[KeptProducts<T, NB>],
) -> Products<K::V, NB> {
    for axis in 0..D {
        for (side, places) in neighbours[axis].iter().enumerate() {
            let there: [bool; LANES] = each(
                #[inline(always)]
                |l| places[l] != NONE,
            );
            if !there.contains(&true) {
                continue;
            }
            let at: [usize; LANES] = each(
                #[inline(always)]
                |l| if places[l] == NONE { 0 } else { places[l] as usize },
            );
            let of = at.map(|place| (&grams[place / LANES], place % LANES));
            let [a, b, c, d] = of;
            let mut rows = gram;
            for i in 0..NB {
                for j in 0..NB {
                    let (high, low) = (i.max(j), i.min(j));
                    rows[i][j] = k.pack([
                        a.0[high][low][a.1],
                        b.0[high][low][b.1],
                        c.0[high][low][c.1],
                        d.0[high][low][d.1],
                    ]);
                }
            }
            shift_lanes::<T, K, D, NB, NB>(k, &mut rows, NB, axis, side > 0);
            let mut columns = rows;
            for i in 0..NB {
                for j in 0..NB {
                    columns[j][i] = rows[i][j];
                }
            }
            shift_lanes::<T, K, D, NB, NB>(k, &mut columns, NB, axis, side > 0);
            let mask = mask::<T, K>(k, there);
            for i in 0..NB {
                for j in 0..=i {
                    gram[i][j] = columns[j][i].mul_add(mask, gram[i][j]);
                }
            }
        }
    }
    gram
}

/// Sums of functions times components over the particles of all occupied cells, four cells after four: of
/// each function each component in four lanes.
#[derive(Clone, Copy)]
pub(super) struct KeptSums<'a, T> {
    pub(super) values: &'a [[T; LANES]],
    pub(super) components: usize,
}

impl<T: Scalar> KeptSums<'_, T> {
    /// Of four cells.
    #[inline(always)]
    pub(super) fn load<K: Packs<T>, const NB: usize, const C: usize>(
        &self,
        k: K,
        group: usize,
    ) -> Rights<K::V, NB, C> {
        let mut rights = [[k.splat(T::zero()); C]; NB];
        let first = group * NB * self.components;
        let values = &self.values[first..first + NB * self.components];
        for n in 0..NB {
            for q in 0..self.components {
                rights[n][q] = k.pack(values[n * self.components + q]);
            }
        }
        rights
    }

    /// Of the cells at four places, any where there is none.
    #[inline(always)]
    fn load_at<K: Packs<T>, const NB: usize, const C: usize>(
        &self,
        k: K,
        places: &[u32; LANES],
    ) -> Rights<K::V, NB, C> {
        let mut rights = [[k.splat(T::zero()); C]; NB];
        let count = NB * self.components;
        let at: [usize; LANES] = each(
            #[inline(always)]
            |l| if places[l] == NONE { 0 } else { places[l] as usize },
        );
        let of: [&[[T; LANES]]; LANES] = each(
            #[inline(always)]
            |l| {
                let first = at[l] / LANES * count;
                &self.values[first..first + count]
            },
        );
        for n in 0..NB {
            for q in 0..self.components {
                rights[n][q] = k.pack(in_lanes(
                    #[inline(always)]
                    |l| of[l][n * self.components + q][at[l] % LANES],
                ));
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
pub(super) fn keep_sums<T: Scalar, K: Packs<T>, const NB: usize, const C: usize>(
    k: K,
    rights: &Rights<K::V, NB, C>,
    components: usize,
    kept: &mut [[T; LANES]],
) {
    for n in 0..NB {
        for q in 0..components {
            kept[n * components + q] = k.array(rights[n][q]);
        }
    }
}
