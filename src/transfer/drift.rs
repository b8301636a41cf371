//! G2P of velocities and their gradients: particles move, and what deforms them is noted for a block of them
//! at a time.
//!
//! How the particles of a block deform is noted when they move, and their law is asked in a loop of its own.
//! Where a law is a few operations, whoever wrote it, a compiler makes vectors of such a loop; among all that
//! moves a particle it does not. The call through a pointer for each block cannot be seen, and the sweep is
//! compiled once for all laws and phases.

use nalgebra::{SMatrix, SVector};

use super::Sweep;
use super::group::{Group, come_in_eights};
use super::stencil::{Look, Seer, Stencil};
use crate::basis::{BasisFamily, Domain};
use crate::grid::{Cell, Grid};
use crate::particles::{DomainViews, Places, settle};
use crate::scalar::Scalar;
use crate::simd::{MOST_LANES, Packs, dispatch_for, each, inlined};

/// Particles in a block, at most: enough for loops to be worth their start, and few enough for the nearest
/// cache.
const BLOCK: usize = 128;

/// What moves particles: the velocities of the DOFs of `C` fields, the first of which carries them.
#[derive(Clone, Copy)]
pub(crate) struct Drift<'a, T, const D: usize, const C: usize> {
    pub(crate) velocities: [&'a [SVector<T, D>]; C],
    pub(crate) dt: T,
}

/// Takes in the displacement gradients of the step, field by field, of particles from an index on; whether to
/// go on.
pub(crate) type Deform<'a, T, const D: usize, const C: usize> =
    dyn FnMut(usize, [&[SMatrix<T, D, D>]; C]) -> bool + 'a;

/// Displacement gradients of particles that follow each other, of each field.
struct Block<T, const D: usize, const C: usize> {
    count: usize,
    increments: [[SMatrix<T, D, D>; BLOCK]; C],
}

impl<T: Scalar, const D: usize, const C: usize> Block<T, D, C> {
    /// Notes those of as many lanes as there are from place `at` on, component `(c, a)` at `[c][a]` of each
    /// field.
    #[inline(always)]
    fn note<K: Packs<T, N>, const N: usize>(&mut self, k: K, lanes: &[[[K::V; D]; D]; C], at: usize) {
        for q in 0..C {
            if let Some(next) = self.increments[q][at..].first_chunk_mut::<N>() {
                let components: [[[T; N]; D]; D] = each(
                    #[inline(always)]
                    |c| {
                        each(
                            #[inline(always)]
                            |a| k.array(lanes[q][c][a]),
                        )
                    },
                );
                for l in 0..N {
                    next[l] = SMatrix::from_fn(|c, a| components[c][a][l]);
                }
            }
        }
    }
}

/// What becomes of the particles of a span.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outcome {
    pub(crate) crossings: usize,
    /// Whether one came to a cell where the DOFs that it will see might have no numbers.
    pub(crate) strayed: bool,
    /// Lowest and highest number of a cell that they are in.
    pub(crate) bounds: [u32; 2],
    /// Index in the span of the first particle that left the grid.
    pub(crate) left: Option<usize>,
}

impl Outcome {
    /// Takes in that particles are in the cell with this number.
    #[inline(always)]
    fn bound(&mut self, number: usize) {
        self.bounds = with_number(self.bounds, number);
    }

    /// Looks up the cell of the particle with index `p`, which is at `x` now.
    #[inline(always)]
    fn settle<T: Scalar, const D: usize>(
        &mut self,
        grid: &Grid<T, D>,
        p: usize,
        cell: &mut Cell<D>,
        x: &mut SVector<T, D>,
    ) {
        match settle(grid, cell, x) {
            Some(false) => {}
            Some(true) => {
                self.crossings += 1;
                if grid.is_safe(cell) {
                    self.bound(grid.linear(cell));
                } else {
                    self.strayed = true;
                }
            }
            None => self.left = self.left.or(Some(p)),
        }
    }
}

/// Bounds of no numbers.
pub(crate) const NO_BOUNDS: [u32; 2] = [u32::MAX, 0];

/// Lowest and highest number, with one more.
#[inline(always)]
pub(crate) fn with_number([low, high]: [u32; 2], number: usize) -> [u32; 2] {
    [low.min(number as u32), high.max(number as u32)]
}

/// Moves the particles of a span and hands their increments to `deform`, block by block.
#[inline(never)]
pub(crate) fn drift<T: Scalar, const D: usize, B: BasisFamily<T, D>, const C: usize>(
    basis: &B,
    grid: &Grid<T, D>,
    motion: &Drift<'_, T, D, C>,
    mut places: Places<'_, T, D>,
    deform: &mut Deform<'_, T, D, C>,
) -> Outcome {
    let sweep = Sweep::new(basis, grid);
    let mut outcome = Outcome {
        crossings: 0,
        strayed: false,
        bounds: NO_BOUNDS,
        left: None,
    };
    let mut block = Block {
        count: 0,
        increments: [[SMatrix::zeros(); BLOCK]; C],
    };
    let (mut p, mut sound) = (0, true);
    while p < places.cells.len() && sound && outcome.left.is_none() {
        block.count = 0;
        if sweep.is_in_packs() {
            let (block, places, outcome) = (&mut block, &mut places, &mut outcome);
            dispatch_for!(T, come_in_eights(&places.cells[p..]), |k| fill(
                k, &sweep, *motion, p, block, places, outcome
            ));
        } else {
            fill_by_points(basis, grid, motion, p, &mut block, &mut places, &mut outcome);
        }
        if const { matches!(B::DOMAIN, Domain::Edges) } {
            carry_edges(&block.increments[0][..block.count], &mut places.half_edges[p..]);
        }
        let increments = each(|q| &block.increments[q][..block.count]);
        sound = deform(p, increments);
        p += block.count;
    }
    outcome
}

/// Lets edge vectors follow the displacement gradients of the step: `e = (1 + dt grad v) e`.
fn carry_edges<T: Scalar, const D: usize>(
    increments: &[SMatrix<T, D, D>],
    half_edges: &mut [SMatrix<T, D, D>],
) {
    for (edges, increment) in half_edges.iter_mut().zip(increments) {
        *edges += increment * *edges;
    }
}

/// Moves particles from index `p` on until the block is full.
#[inline(always)]
fn fill<T: Scalar, const D: usize, B: BasisFamily<T, D>, K: Packs<T, N>, const N: usize, const C: usize>(
    k: K,
    sweep: &Sweep<'_, T, D, B>,
    motion: Drift<'_, T, D, C>,
    p: usize,
    block: &mut Block<T, D, C>,
    places: &mut Places<'_, T, D>,
    outcome: &mut Outcome,
) {
    let count = places.cells.len();
    let places = Places {
        positions: &mut places.positions[..count],
        displacements: &mut places.displacements[..count],
        cells: &mut *places.cells,
        half_lengths: places.half_lengths,
        half_edges: &mut *places.half_edges,
    };
    let (start, mut p) = (p, p);
    let has_room = inlined(
        #[inline(always)]
        |p: usize, more: usize| p - start + more <= BLOCK,
    );
    // Not those of the outcome, which other functions are given: these stay in registers.
    let mut bounds = outcome.bounds;
    while p < places.cells.len() && has_room(p, MOST_LANES) && outcome.left.is_none() {
        if const { D == 1 } {
            while let (true, Some(group)) = (has_room(p, N), Group::<N>::full_at(p, places.cells)) {
                bounds = with_number(bounds, sweep.grid.linear(&places.cells[p]));
                let increments = sweep.shift::<true, K, N, C>(
                    k,
                    &motion,
                    group,
                    (places.positions, places.displacements, places.cells),
                    places.half_lengths,
                    outcome,
                );
                block.note(k, &increments, p - start);
                p += N;
            }
            if !has_room(p, MOST_LANES) || p >= places.cells.len() {
                break;
            }
        }
        let group = Group::<N>::at(p, places.cells);
        bounds = with_number(bounds, sweep.grid.linear(&places.cells[p]));
        let increments = sweep.shift::<false, K, N, C>(
            k,
            &motion,
            group,
            (places.positions, places.displacements, places.cells),
            places.half_lengths,
            outcome,
        );
        block.note(k, &increments, p - start);
        p += group.count;
    }
    block.count = p - start;
    let [low, high] = outcome.bounds;
    outcome.bounds = [low.min(bounds[0]), high.max(bounds[1])];
}

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>> Sweep<'_, T, D, B> {
    /// Moves the particles of a group; returns their displacement gradients of the step, field by field.
    #[inline(always)]
    fn shift<const FULL: bool, K: Packs<T, N>, const N: usize, const C: usize>(
        &self,
        k: K,
        motion: &Drift<'_, T, D, C>,
        group: Group<N>,
        (positions, displacements, cells): (&mut [SVector<T, D>], &mut [SVector<T, D>], &mut [Cell<D>]),
        half_lengths: &[SVector<T, D>],
        outcome: &mut Outcome,
    ) -> [[[K::V; D]; D]; C] {
        let cell = &cells[group.first];
        let x = group.vectors::<FULL, T, K, D>(k, positions);
        let factors = self.factors::<FULL, K, N>(k, group, (cell, &x), half_lengths);
        let first = self.first_dof(cell);
        let (dt, inverse) = (k.splat(motion.dt), self.grid.inverse_cell_size());
        let steps: [K::V; D] = each(
            #[inline(always)]
            |a| k.splat(motion.dt * inverse[a]),
        );
        let fields: [_; C] = each(
            #[inline(always)]
            |q| self.value_and_slopes(k, first, &factors, motion.velocities[q]),
        );
        let path: [K::V; D] = each(
            #[inline(always)]
            |c| fields[0].0[c] * dt,
        );
        let moved: [K::V; D] = each(
            #[inline(always)]
            |c| x[c] + path[c],
        );
        group.put::<FULL, T, K, D>(k, positions, &moved);
        let before = group.vectors::<FULL, T, K, D>(k, displacements);
        let displacement: [K::V; D] = each(
            #[inline(always)]
            |c| before[c] + path[c],
        );
        group.put::<FULL, T, K, D>(k, displacements, &displacement);
        if !self.grid.strictly_contains_all(k, cell, &moved) {
            settle_group(self.grid, group, positions, cells, outcome);
        }
        each(
            #[inline(always)]
            |q| {
                each(
                    #[inline(always)]
                    |c| {
                        each(
                            #[inline(always)]
                            |a| fields[q].1[c][a] * steps[a],
                        )
                    },
                )
            },
        )
    }
}

/// Looks up the cells of a group of which not all clearly stayed.
#[inline(never)]
fn settle_group<T: Scalar, const D: usize, const N: usize>(
    grid: &Grid<T, D>,
    group: Group<N>,
    positions: &mut [SVector<T, D>],
    cells: &mut [Cell<D>],
    outcome: &mut Outcome,
) {
    let bodies = positions.iter_mut().zip(cells).enumerate();
    for (p, (x, cell)) in bodies.skip(group.first).take(group.count) {
        outcome.settle(grid, p, cell, x);
    }
}

/// The same for a basis that is no product.
fn fill_by_points<T: Scalar, const D: usize, B: BasisFamily<T, D>, const C: usize>(
    basis: &B,
    grid: &Grid<T, D>,
    motion: &Drift<'_, T, D, C>,
    first: usize,
    block: &mut Block<T, D, C>,
    places: &mut Places<'_, T, D>,
    outcome: &mut Outcome,
) {
    let (velocities, dt) = (motion.velocities, motion.dt);
    let (mut p, mut stencil) = (first, Stencil::new());
    while p < places.cells.len() && block.count < BLOCK && outcome.left.is_none() {
        let (x, cell) = (&mut places.positions[p], &mut places.cells[p]);
        let mut v = SVector::zeros();
        let mut gradients = [SMatrix::<T, D, D>::zeros(); C];
        let domains = DomainViews {
            half_lengths: places.half_lengths,
            half_edges: places.half_edges,
        };
        stencil.for_each(
            (basis, grid),
            &domains,
            Seer::Particle(p),
            (&*cell, &*x),
            #[inline(always)]
            |i, phi, grad_phi| {
                v += velocities[0][i] * phi;
                for q in 0..C {
                    gradients[q] += velocities[q][i] * grad_phi.transpose();
                }
            },
        );
        let path = v * dt;
        *x += path;
        places.displacements[p] += path;
        for q in 0..C {
            block.increments[q][block.count] = gradients[q] * dt;
        }
        block.count += 1;
        outcome.bound(grid.linear(cell));
        outcome.settle(grid, p, cell, x);
        p += 1;
    }
}
