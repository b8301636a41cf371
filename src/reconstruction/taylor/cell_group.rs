//! Four cells whose fits are made at once, one in each lane.

use std::ops::Range;

use crate::field::Field;
use crate::grid::Cell;
use crate::lanes::{LANES, Lanes};
use crate::reconstruction::Cloud;
use crate::scalar::Scalar;
use crate::taylor::MOST_COMPONENTS;

/// Up to four occupied cells with their particles; spare lanes repeat the last cell.
pub(in super::super) struct CellGroup<'a, const D: usize> {
    pub(in super::super) len: usize,
    pub(in super::super) cells: [Cell<D>; LANES],
    particles: [&'a [u32]; LANES],
    pub(in super::super) counts: [usize; LANES],
}

impl<'a, const D: usize> CellGroup<'a, D> {
    #[inline(always)]
    pub(in super::super) fn new<T: Scalar>(cloud: &Cloud<'a, T, D>, places: Range<usize>) -> Self {
        let occupied = &cloud.bins.occupied()[places];
        let numbers: [usize; LANES] = std::array::from_fn(|l| occupied[l.min(occupied.len() - 1)] as usize);
        let particles: [&[u32]; LANES] = std::array::from_fn(|l| cloud.bins.particles_in(numbers[l]));
        Self {
            len: occupied.len(),
            cells: std::array::from_fn(|l| cloud.grid.cell(numbers[l])),
            counts: std::array::from_fn(|l| particles[l].len()),
            particles,
        }
    }

    /// Most particles of a cell.
    pub(in super::super) fn longest(&self) -> usize {
        self.counts.iter().copied().max().unwrap_or(0)
    }

    /// The `k`-th particle of each cell, and one; the last particle and zero where there are fewer.
    #[inline(always)]
    pub(in super::super) fn points<T: Scalar, V: Lanes<T>>(&self, k: usize) -> ([usize; LANES], V) {
        let numbers = std::array::from_fn(|l| self.particles[l][k.min(self.counts[l] - 1)] as usize);
        let weights = std::array::from_fn(|l| if k < self.counts[l] { T::one() } else { T::zero() });
        (numbers, V::new(weights))
    }

    /// Local coordinates of one particle of each cell.
    #[inline(always)]
    pub(in super::super) fn local<T: Scalar, V: Lanes<T>>(
        &self,
        cloud: &Cloud<'_, T, D>,
        numbers: &[usize; LANES],
    ) -> [V; D] {
        let x: [_; LANES] = std::array::from_fn(|l| &cloud.positions[numbers[l]]);
        let (two, one) = (V::splat(T::lit(2.0)), V::splat(T::one()));
        std::array::from_fn(|a| {
            let x = V::new(std::array::from_fn(|l| x[l][a])) - V::splat(cloud.grid.min()[a]);
            let cell = V::new(std::array::from_fn(|l| T::lit(f64::from(self.cells[l][a]))));
            (x * V::splat(cloud.grid.inverse_cell_size()[a]) - cell) * two - one
        })
    }
}

/// The components of four values, the `l`-th of which is `value(l)`.
#[inline(always)]
pub(in super::super) fn lanes_of<T: Scalar, V: Lanes<T>, Q: Field<T>>(
    value: impl Fn(usize) -> Q,
) -> [V; MOST_COMPONENTS] {
    let values: [Q; LANES] = std::array::from_fn(value);
    let mut components = [V::splat(T::zero()); MOST_COMPONENTS];
    for q in 0..Q::COMPONENTS {
        components[q] = V::new(std::array::from_fn(|l| values[l].component(q)));
    }
    components
}
