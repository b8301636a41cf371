//! The fits of each cell: of its own particles, and with those of its neighbours.

use crate::field::Field;
use crate::reconstruction::taylor::local;
use crate::reconstruction::{Cloud, Patch};
use crate::scalar::Scalar;
use crate::taylor::{CellFit, Gram};

/// Reach of the particles towards an open side, as a share of half the cell, from which on the cell counts as full there:
/// particles beside a wall need not fill their cell to the last digit.
const FULL: f64 = 0.9;

/// The fits of one occupied cell.
#[derive(Clone, Debug)]
pub(super) struct RelaxedCell<T, const D: usize, const NB: usize> {
    /// The whole cell: the frame of sums that neighbours exchange, and of the wide fit.
    pub(super) whole: Patch<T, D>,
    /// What the surface of a body leaves of it: the frame of its own fit, and what is integrated over.
    pub(super) patch: Patch<T, D>,
    pub(super) own: CellFit<T, NB>,
    /// With the particles of the neighbours; none where even they do not tell the functions apart.
    pub(super) wide: Option<CellFit<T, NB>>,
    /// Sums of the own particles, in the frame of the whole cell.
    gram: Gram<T, NB>,
}

impl<T: Scalar, const D: usize, const NB: usize> RelaxedCell<T, D, NB> {
    /// The cell with number `cell`, of its own particles only.
    #[inline(always)]
    pub(super) fn alone(cloud: &Cloud<'_, T, D>, cell: usize, tolerance: T) -> Self {
        let (whole, patch) = (Patch::whole(cloud.grid, cell), cloud.patch(cell));
        let points = |frame| local(cloud, cell, frame).map(|(_, s)| (s, T::one()));
        let gram = Gram::new(points(&whole));
        let own = if patch == whole {
            CellFit::with_gram(&gram, points(&whole), 0, tolerance)
        } else {
            CellFit::weighted(points(&patch), 0, tolerance)
        };
        Self {
            whole,
            patch,
            own,
            wide: None,
            gram,
        }
    }

    /// Cuts the cell on its `open` sides, beyond which there are no particles, to where its particles end: the outermost one and
    /// half its size.
    #[cold]
    #[inline(never)]
    fn end_where_particles_end(&mut self, cloud: &Cloud<'_, T, D>, open: &[[bool; 2]; D], tolerance: T) {
        let particles = || {
            cloud
                .bins
                .particles_in(cloud.grid.linear(&self.whole.cell))
                .iter()
        };
        let mut patch = self.whole;
        for (axis, sides) in open.iter().enumerate() {
            let centre = patch.centre[axis];
            let half = patch.half[axis];
            let ends = |sign: T| {
                let reach = particles().map(|&p| {
                    let p = p as usize;
                    let size = side(cloud.volumes[p], D);
                    (cloud.positions[p][axis] - centre) * sign + size / T::lit(2.0)
                });
                let reach = reach.fold(-half, T::max);
                if reach < half * T::lit(FULL) { reach } else { half }
            };
            let low = if sides[0] { ends(-T::one()) } else { half };
            let high = if sides[1] { ends(T::one()) } else { half };
            if low + high > T::zero() {
                patch.centre[axis] = centre + (high - low) / T::lit(2.0);
                patch.half[axis] = (low + high) / T::lit(2.0);
                patch.inverse_half[axis] = T::one() / patch.half[axis];
            }
        }
        if patch != self.whole {
            let points = local(cloud, cloud.grid.linear(&patch.cell), &patch).map(|(_, s)| (s, T::one()));
            self.own = CellFit::weighted(points, 0, tolerance);
            self.patch = patch;
        }
    }

    /// Whether its own particles determine all functions.
    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.own.functions() == NB
    }

    /// Coefficients of the own fit, from the sums in the frame of the whole cell where they serve.
    #[inline(always)]
    pub(super) fn own_coefficients<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        cell: usize,
        sums: [Q; NB],
        value: impl Fn(usize) -> Q,
    ) -> [Q; NB] {
        if self.own.is_well_spread() && self.patch == self.whole {
            return self.own.coefficients_from_sums(sums);
        }
        let samples = local(cloud, cell, &self.patch).map(|(p, s)| (s, T::one(), value(p)));
        self.own.coefficients(samples, Q::zero())
    }
}

/// Side of a cube of the given volume.
fn side<T: Scalar>(volume: T, dimensions: usize) -> T {
    match dimensions {
        1 => volume,
        2 => volume.sqrt(),
        _ => volume.cbrt(),
    }
}

/// Makes the wide fits.
pub(super) fn join<T: Scalar, const D: usize, const NB: usize>(
    cells: &mut [RelaxedCell<T, D, NB>],
    cloud: &Cloud<'_, T, D>,
    tolerance: T,
) {
    for place in 0..cells.len() {
        let (mut gram, mut open) = (cells[place].gram, [[true; 2]; D]);
        for_each_neighbour(cloud, place, |axis, above, other| {
            gram.add_neighbour::<D>(&cells[other].gram, axis, above);
            open[axis][usize::from(above)] = false;
        });
        let cell = &mut cells[place];
        cell.wide = CellFit::full::<D>(&gram, tolerance);
        if open != [[false; 2]; D] && cell.patch == cell.whole {
            cell.end_where_particles_end(cloud, &open, tolerance);
        }
    }
}

/// Calls `f(axis, above, place)` for the occupied cells that share a face with the one at `place` in the list of the
/// occupied: above or below it along an axis.
#[inline(always)]
pub(super) fn for_each_neighbour<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    place: usize,
    mut f: impl FnMut(usize, bool, usize),
) {
    let number = cloud.bins.occupied()[place] as usize;
    let cell = cloud.grid.cell(number);
    let window = cloud.grid.window();
    let (first, cells) = (window.first(), window.shape());
    let mut stride = 1;
    for axis in 0..D {
        let place_on_axis = (cell[axis] - first[axis]) as usize;
        if place_on_axis > 0
            && let Some(other) = cloud.bins.place_of(number - stride, place)
        {
            f(axis, false, other);
        }
        if place_on_axis + 1 < cells[axis]
            && let Some(other) = cloud.bins.place_of(number + stride, place)
        {
            f(axis, true, other);
        }
        stride *= cells[axis];
    }
}
