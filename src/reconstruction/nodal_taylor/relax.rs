//! How far patches count, and stress and velocity moved towards what they see.

use super::NodalTaylor;
use super::nodes::local;
use crate::field::Field;
use crate::grid::Cell;
use crate::reconstruction::{Cloud, CourantNumbers};
use crate::scalar::Scalar;

/// Between these parts of its volume a patch begins to count and counts in full, if all cells around its
/// node hold particles; a few per cent less than full is round-off of a hat's sum over particles.
const FILLED: [f64; 2] = [0.5, 0.7];
/// The same where one of them is a hole that particles left between others.
const FILLED_BUT_ONE: [f64; 2] = [0.8, 0.95];

impl<T: Scalar, const D: usize, const NB: usize> NodalTaylor<T, D, NB> {
    /// How far patches are filled. Sides of the grid are no free sides. A patch that reaches a cell where
    /// material ends does not count: some DOFs there have no mass, and what acts on them would be lost.
    pub(super) fn measure_filling(&mut self, cloud: &Cloud<'_, T, D>) {
        let part = cloud.grid.cell_volume() / T::count(1 << D);
        self.filled.clear();
        for node in 0..self.nodes.len() {
            let (mut around, mut empty) = (0, 0);
            self.nodes.for_each_cell_around(cloud.grid, node, |cell| {
                if is_occupied(cloud, &cell) {
                    around += 1;
                } else if is_hole(cloud, &cell) {
                    (around, empty) = (around + 1, empty + 1);
                }
            });
            let inside = 1_usize << (D - self.nodes.halved(cloud.grid, node).count_ones() as usize);
            let [from, to] = match empty {
                0 if around == inside => FILLED,
                1 if around == inside => FILLED_BUT_ONE,
                _ => {
                    self.filled.push(T::zero());
                    continue;
                }
            };
            let part = self.patches.total(node) / (part * T::count(inside));
            self.filled.push(ramp(part, T::lit(from), T::lit(to)));
        }
    }

    /// How smooth the field of the last fit is.
    pub(super) fn measure_smoothness(&mut self) {
        let [from, to] = self.roughness;
        for (node, smooth) in self.smooth.iter_mut().enumerate() {
            *smooth = T::one() - ramp(self.patches.left(node), from, to);
        }
    }

    /// Moves the stress by what the particles cross: where nothing moves nothing creeps.
    pub(super) fn relax_stress<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        crossed: &[CourantNumbers<T>],
        values: &mut [Q],
    ) {
        self.measure_crossings(cloud, crossed);
        self.patches
            .fit(&self.nodes, cloud, cloud.volumes, &|p| values[p]);
        let rate = self.rates[1];
        self.shares.clear();
        for (node, crossed) in self.crossed.iter().enumerate() {
            let holds = self.filled[node] * self.smooth[node];
            self.shares.push(self.share(node, rate * crossed.motion) * holds);
        }
        self.relax(cloud, values);
    }

    /// Moves the velocity by what waves cross, in the product of the masses. Free sides count too: nothing is
    /// integrated there.
    pub(super) fn relax_velocity<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        masses: &[T],
        values: &mut [Q],
    ) {
        self.patches.take_in(&self.nodes, cloud, masses);
        self.patches.fit(&self.nodes, cloud, masses, &|p| values[p]);
        let rate = self.rates[0];
        self.shares.clear();
        for (node, crossed) in self.crossed.iter().enumerate() {
            self.shares
                .push(self.share(node, rate * crossed.wave) * self.smooth[node]);
        }
        self.relax(cloud, values);
    }

    /// Share of the difference that a rate takes away in a step. A patch without all linear functions would
    /// not keep the angular momentum.
    fn share(&self, node: usize, rate: T) -> T {
        match self.patches.is_linear(node) {
            true => rate / (T::one() + rate),
            false => T::zero(),
        }
    }

    /// Parts of a cell that are crossed in a step, means over the occupied cells of each patch.
    fn measure_crossings(&mut self, cloud: &Cloud<'_, T, D>, crossed: &[CourantNumbers<T>]) {
        let none = CourantNumbers {
            wave: T::zero(),
            motion: T::zero(),
        };
        self.crossed.clear();
        self.crossed.resize(self.nodes.len(), none);
        self.shares.clear();
        self.shares.resize(self.nodes.len(), T::zero());
        for (&cell, crossed) in cloud.bins.occupied().iter().zip(crossed) {
            let cell = cloud.grid.cell(cell as usize);
            for node in (0..1 << D).filter_map(|corner| self.nodes.at_corner(&cell, corner)) {
                self.crossed[node].wave += crossed.wave;
                self.crossed[node].motion += crossed.motion;
                self.shares[node] += T::one();
            }
        }
        for (crossed, &cells) in self.crossed.iter_mut().zip(&self.shares) {
            let cells = cells.max(T::one());
            crossed.wave /= cells;
            crossed.motion /= cells;
        }
    }

    /// `v_p += sum_a b_a chi_a (P_a v - v_p)`.
    fn relax<Q: Field<T>>(&self, cloud: &Cloud<'_, T, D>, values: &mut [Q]) {
        for (p, value) in values.iter_mut().enumerate() {
            let (cell, u) = local(cloud, p);
            let (own, mut change) = (*value, Q::zero());
            self.nodes.for_each_corner(&cell, &u, |corner| {
                let share = self.shares[corner.node] * corner.hat;
                if share > T::zero() {
                    self.patches.add_fit(&corner, share, &mut change);
                    change.add_scaled(-share, own);
                }
            });
            value.add_scaled(T::one(), change);
        }
    }
}

fn is_occupied<T: Scalar, const D: usize>(cloud: &Cloud<'_, T, D>, cell: &Cell<D>) -> bool {
    cloud.grid.has_numbers(cell, 0) && cloud.bins.count_in(cloud.grid.linear(cell)) > 0
}

/// Whether all cells that share a face with an empty one are occupied: every DOF of it has mass then.
fn is_hole<T: Scalar, const D: usize>(cloud: &Cloud<'_, T, D>, cell: &Cell<D>) -> bool {
    (0..D).all(|axis| {
        let (mut below, mut above) = (*cell, *cell);
        below[axis] = cell[axis].wrapping_sub(1);
        above[axis] = cell[axis] + 1;
        let ends_below = cell[axis] == 0;
        let ends_above = above[axis] as usize == cloud.grid.cells()[axis];
        (ends_below || is_occupied(cloud, &below)) && (ends_above || is_occupied(cloud, &above))
    })
}

/// From 0 at `from` to 1 at `to`.
fn ramp<T: Scalar>(x: T, from: T, to: T) -> T {
    ((x - from) / (to - from)).max(T::zero()).min(T::one())
}
