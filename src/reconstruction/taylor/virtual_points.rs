//! Virtual points (journal section 5.3): values that neighbouring cells lend to a cell whose particles do not
//! determine all functions.
//!
//! A *lender* is an occupied neighbour whose own particles determine its fit and whose patch reaches the
//! common edge. Its polynomial's value at the edge is one more point of the borrower's least squares. The
//! mean of a conserved fit is what the borrower's particles hold, as ever: a virtual point changes how an
//! amount is spread over the cell, not the amount.
//!
//! A cell without particles on one side borrows nothing: it may be filled in part only, so that its mean and
//! the density at its other edge do not belong together, and the slope between them would be none of the
//! field's.
//!
//! One dimension only: there an edge is a point. Lenders never borrow, so nothing depends on the order of
//! cells.

use nalgebra::SVector;

use super::{CellFits, Taylor, conserved, fit_about_mean, free, local, samples};
use crate::field::Field;
use crate::grid::Cell;
use crate::reconstruction::gauss::polynomial;
use crate::reconstruction::{Cloud, Patch};
use crate::scalar::Scalar;
use crate::taylor::{CellFit, taylor_functions};

/// Distance of two patches, as a share of half of one, up to which they have a common edge.
const TOUCH: f64 = 1e-3;

/// The sides of a cell, below and above, on which there is a virtual point.
type Sides = [bool; 2];

const NONE: Sides = [false; 2];

/// The virtual points of both fits of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lent {
    free: Sides,
    conserved: Sides,
}

impl Lent {
    #[inline(always)]
    pub(super) fn to_free(self) -> bool {
        self.free != NONE
    }

    #[inline(always)]
    pub(super) fn to_conserved(self) -> bool {
        self.conserved != NONE
    }
}

/// Local coordinate of a side.
#[inline(always)]
fn end<T: Scalar, const D: usize>(above: bool) -> SVector<T, D> {
    SVector::repeat(if above { T::one() } else { -T::one() })
}

/// Both sides.
const ENDS: [bool; 2] = [false, true];

/// Whether `lower` ends where `upper` begins.
fn touch<T: Scalar, const D: usize>(lower: &Patch<T, D>, upper: &Patch<T, D>) -> bool {
    let gap = upper.centre[0] - upper.half[0] - (lower.centre[0] + lower.half[0]);
    nalgebra::ComplexField::abs(gap) <= upper.half[0] * T::lit(TOUCH)
}

impl<T: Scalar, const D: usize, const NB: usize> CellFits<T, D, NB> {
    fn lends_free(&self) -> bool {
        self.free_is_full() && !self.lent.to_free()
    }

    fn lends_conserved(&self) -> bool {
        self.conserved_is_full() && !self.lent.to_conserved()
    }

    /// With virtual points on these sides.
    fn borrow(&mut self, cloud: &Cloud<'_, T, D>, cell: usize, tolerance: T, lent: Lent) {
        let own = local(cloud, cell, &self.patch).map(|(_, s)| s);
        let points = |sides: Sides| {
            let ends = ENDS.into_iter().zip(sides).filter(|&(_, lent)| lent);
            own.clone().chain(ends.map(|(above, _)| end(above)))
        };
        if lent.to_free() {
            self.free = CellFit::new(points(lent.free), 0, tolerance);
        }
        if lent.to_conserved() {
            self.conserved = CellFit::new(points(lent.conserved), 1, tolerance);
        }
        self.lent = lent;
    }
}

impl<T: Scalar, const D: usize, const NB: usize> Taylor<T, D, NB> {
    /// Gives virtual points to the cells that need some and have neighbours that can lend them.
    #[cold]
    #[inline(never)]
    pub(super) fn lend(&mut self, cloud: &Cloud<'_, T, D>) {
        for place in 0..self.cells.len() {
            if self.cells[place].is_full() {
                continue;
            }
            let lent = self.lenders(cloud, place);
            if lent != Lent::default() {
                let cell = cloud.bins.occupied()[place] as usize;
                self.cells[place].borrow(cloud, cell, self.tolerance, lent);
                self.lent += 1;
            }
        }
        self.reduced = self.cells.iter().filter(|fits| !fits.is_full()).count();
    }

    /// On which sides the cell at `place` can borrow.
    fn lenders(&self, cloud: &Cloud<'_, T, D>, place: usize) -> Lent {
        let mut lent = Lent::default();
        let [Some(below), Some(above)] = ENDS.map(|above| neighbour(cloud, place, above)) else {
            return lent;
        };
        let fits = &self.cells[place];
        let [below, above] = [below, above].map(|other| &self.cells[other]);
        let pairs = [(below, [below, fits]), (above, [fits, above])];
        for (side, (lender, [lower, upper])) in pairs.into_iter().enumerate() {
            let meet = touch(&lower.patch, &upper.patch);
            lent.free[side] = meet && !fits.free_is_full() && lender.lends_free();
            lent.conserved[side] = meet && !fits.conserved_is_full() && lender.lends_conserved();
        }
        lent
    }

    /// The virtual points of the cell at `place`; `coefficients(place)` are those of a lender.
    #[inline(always)]
    fn lent_values<Q: Field<T>>(
        cloud: &Cloud<'_, T, D>,
        place: usize,
        sides: Sides,
        coefficients: impl Fn(usize) -> [Q; NB],
    ) -> impl Iterator<Item = (SVector<T, D>, T, Q)> + Clone {
        let points: [Option<_>; 2] = std::array::from_fn(|side| {
            let above = side == 1;
            let lender = neighbour(cloud, place, above).filter(|_| sides[side])?;
            // At its other end.
            let value = polynomial(&taylor_functions(&end::<T, D>(!above)), &coefficients(lender));
            Some((end(above), T::one(), value))
        });
        points.into_iter().flatten()
    }

    /// Coefficients of the free fit where it has virtual points.
    #[cold]
    #[inline(never)]
    pub(super) fn free_with_lent<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        place: usize,
        value: &dyn Fn(usize) -> Q,
    ) -> [Q; NB] {
        let (fits, cell) = self.at(cloud, place);
        let value = &value;
        let lent = Self::lent_values(cloud, place, fits.lent.free, |lender| {
            let (fits, cell) = self.at(cloud, lender);
            free(fits, cloud, cell, value)
        });
        let own = samples(cloud, cell, &fits.patch, value);
        fits.free.coefficients(own.chain(lent), Q::zero())
    }

    /// The same of the conserved fit.
    #[cold]
    #[inline(never)]
    pub(super) fn conserved_with_lent<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        place: usize,
        amount: &dyn Fn(usize) -> Q,
    ) -> [Q; NB] {
        let (fits, cell) = self.at(cloud, place);
        let amount = &amount;
        let lent = Self::lent_values(cloud, place, fits.lent.conserved, |lender| {
            let (fits, cell) = self.at(cloud, lender);
            conserved(fits, cloud, cell, amount)
        });
        // The mean is the particles' alone.
        let particles = cloud.bins.particles_in(cell).iter();
        let total = particles.fold(Q::zero(), |sum, &p| sum + amount(p as usize));
        let mean = total.scaled(T::one() / fits.patch.volume());
        let density = |p: usize| amount(p).scaled(T::one() / cloud.volumes[p]);
        let own = samples(cloud, cell, &fits.patch, &density);
        let mut coefficients = fits.conserved.coefficients(own.chain(lent), mean);
        coefficients[0] = mean;
        coefficients
    }

    /// The same of the fit with a given mean.
    pub(super) fn about_mean_with_lent<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        place: usize,
        value: &impl Fn(usize) -> Q,
        mean: &impl Fn(&Cell<D>) -> Q,
    ) -> [Q; NB] {
        let (fits, cell) = self.at(cloud, place);
        let lent = Self::lent_values(cloud, place, fits.lent.conserved, |lender| {
            let (fits, cell) = self.at(cloud, lender);
            fit_about_mean(fits, cloud, cell, value, mean(&fits.patch.cell))
        });
        let own = samples(cloud, cell, &fits.patch, value);
        let mean = mean(&fits.patch.cell);
        let mut coefficients = fits.conserved.coefficients(own.chain(lent), mean);
        coefficients[0] = mean;
        coefficients
    }

    /// Fits and number of the cell at `place`.
    #[inline(always)]
    fn at(&self, cloud: &Cloud<'_, T, D>, place: usize) -> (&CellFits<T, D, NB>, usize) {
        (&self.cells[place], cloud.bins.occupied()[place] as usize)
    }
}

/// Place of the occupied neighbour along the line, if there is one: places ascend as cells do.
fn neighbour<T: Scalar, const D: usize>(cloud: &Cloud<'_, T, D>, place: usize, above: bool) -> Option<usize> {
    let occupied = cloud.bins.occupied();
    let other = if above { place + 1 } else { place.checked_sub(1)? };
    let (here, there) = (occupied[place], *occupied.get(other)?);
    (here.abs_diff(there) == 1).then_some(other)
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use nalgebra::vector;

    use super::*;
    use crate::grid::{Grid, Side};
    use crate::particles::Bins;
    use crate::reconstruction::{Cut, Reconstruction};

    /// Particles in the unit cells of a line.
    struct Line {
        grid: Grid<f64, 1>,
        bins: Bins<1>,
        positions: Vec<SVector<f64, 1>>,
        volumes: Vec<f64>,
    }

    impl Line {
        /// With this many particles in each cell.
        fn new(counts: &[usize]) -> Self {
            let grid = Grid::new(vector![0.0], vector![counts.len() as f64], [counts.len()]).unwrap();
            let places = |(cell, &n): (usize, &usize)| {
                (0..n).map(move |k| vector![cell as f64 + (k as f64 + 0.4) / n as f64])
            };
            let positions: Vec<_> = counts.iter().enumerate().flat_map(places).collect();
            Self {
                bins: Bins::new(&grid, &positions).unwrap(),
                volumes: vec![0.3; positions.len()],
                positions,
                grid,
            }
        }

        fn cloud<'a>(&'a self, cuts: &'a [Cut<f64>]) -> Cloud<'a, f64, 1> {
            let cloud = Cloud::new(&self.grid, &self.bins, &self.positions, &self.volumes).unwrap();
            cloud.with_cuts(cuts)
        }

        /// Cells with virtual points, and cells that still lack functions.
        fn counts(&self, cuts: &[Cut<f64>]) -> [usize; 2] {
            let mut taylor = Taylor::<f64, 1, 3>::new().with_virtual_points(true);
            taylor.prepare(&self.cloud(cuts));
            [taylor.virtual_cells(), taylor.reduced_cells()]
        }
    }

    #[test]
    fn cells_between_others_borrow_from_those_that_have_enough() {
        assert_eq!(Line::new(&[3, 1, 3]).counts(&[]), [1, 0]);
        // At the end of a body, and beside a gap.
        assert_eq!(Line::new(&[2, 3, 3]).counts(&[]), [0, 1]);
        assert_eq!(Line::new(&[3, 3, 2, 0, 3]).counts(&[]), [0, 1]);
        // One lender each: two points for three functions.
        assert_eq!(Line::new(&[3, 1, 1, 3]).counts(&[]), [2, 2]);
        assert_eq!(Line::new(&[3, 2, 2, 3]).counts(&[]), [2, 0]);
        assert_eq!(Line::new(&[3, 2, 2, 2, 3]).counts(&[]), [2, 1]);
        assert_eq!(Line::new(&[3, 4, 3]).counts(&[]), [0, 0]);
    }

    #[test]
    fn a_neighbour_whose_body_ends_before_the_edge_lends_nothing() {
        let line = Line::new(&[3, 2, 3]);
        let cut = |position| Cut {
            cell: 0,
            side: Side::Max,
            position,
        };
        assert_eq!(line.counts(&[cut(0.9)]), [1, 0]);
        let alone = Line::new(&[3, 1, 3]);
        assert_eq!(alone.counts(&[cut(1.0)]), [1, 0]);
        assert_eq!(alone.counts(&[cut(0.9)]), [1, 1]);
    }

    #[test]
    fn a_parabola_is_seen_by_one_particle_and_the_mean_is_what_it_holds() {
        let line = Line::new(&[3, 1, 3]);
        let cloud = line.cloud(&[]);
        let mut taylor = Taylor::<f64, 1, 3>::new().with_virtual_points(true);
        taylor.prepare(&cloud);
        let value = |p: usize| 2.0 + line.positions[p][0] - 3.0 * line.positions[p][0].powi(2);
        let free = taylor.free_coefficients(&cloud, value)[1];
        // At s = 2 (x - 3/2): 2 + 3/2 - 27/4 + (1/2 - 9/2) s - 3/4 s^2, of which -1/4 is the mean of the
        // last.
        for (found, expected) in free.into_iter().zip([-3.5, -4.0, -1.5]) {
            assert_relative_eq!(found, expected, max_relative = 1e-13);
        }
        let mean = taylor.conserved_coefficients(&cloud, |p| value(p) * line.volumes[p])[1][0];
        assert_eq!(mean, value(3) * line.volumes[3]);
    }
}
