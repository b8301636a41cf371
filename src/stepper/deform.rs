//! Stage 4: particles that move and deform, a block of them at a time.
//!
//! How the particles of a block deform is noted when they move, and their law is asked in a loop of its own. Where a law is a few
//! operations, whoever wrote it, a compiler makes vectors of such a loop; among all that moves a particle it does not.

use nalgebra::{SMatrix, SVector};

use super::spans::{Fault, Flaw, Moved};
use super::window;
use crate::grid::{Cell, Grid};
use crate::lanes::{Lanes, MOST_LANES};
use crate::law::LawSweep;
use crate::particles::{Material, Movables, settle};
use crate::phase::Phase;
use crate::scalar::Scalar;
use crate::tensor::determinant;

/// Particles in a block, at most: enough for loops to be worth their start, and few enough for the nearest cache.
const BLOCK: usize = 128;

/// What moves particles.
pub(super) struct Motion<'a, T, const D: usize, L, P> {
    /// Velocities of the DOFs.
    pub(super) velocity: &'a [SVector<T, D>],
    pub(super) dt: T,
    pub(super) law: &'a L,
    pub(super) phase: &'a P,
}

/// Displacement gradients of the step of particles that follow each other.
pub(super) struct Block<T, const D: usize> {
    count: usize,
    increments: [SMatrix<T, D, D>; BLOCK],
}

impl<T: Scalar, const D: usize> Block<T, D> {
    /// Whether as many more fit in.
    #[inline(always)]
    pub(super) fn has_room(&self, more: usize) -> bool {
        self.count + more <= BLOCK
    }

    /// Notes those of the first `count` lanes, component `(c, a)` at `[c][a]`.
    #[inline(always)]
    pub(super) fn push<V: Lanes<T, N>, const N: usize>(&mut self, lanes: &[[V; D]; D], count: usize) {
        if let Some(next) = self.increments[self.count..].first_chunk_mut::<N>() {
            let components = lanes.map(|row| row.map(V::array));
            for l in 0..N {
                next[l] = SMatrix::from_fn(|c, a| components[c][a][l]);
            }
            self.count += count;
        }
    }

    /// Notes one.
    #[inline(always)]
    pub(super) fn push_one(&mut self, increment: SMatrix<T, D, D>) {
        if let Some(next) = self.increments.get_mut(self.count) {
            *next = increment;
            self.count += 1;
        }
    }
}

/// What becomes of the particles of a span.
pub(super) struct Outcome<T> {
    pub(super) moved: Moved<T>,
    /// Lowest and highest number of a cell that they are in.
    pub(super) bounds: [u32; 2],
    /// Index in the span of the first particle that left the grid.
    left: Option<usize>,
}

impl<T: Scalar> Outcome<T> {
    /// Takes in that particles are in the cell with this number.
    #[inline(always)]
    pub(super) fn bound(&mut self, number: usize) {
        self.bounds = with_number(self.bounds, number);
    }

    /// Whether a particle left the grid.
    #[inline(always)]
    pub(super) fn has_lost_one(&self) -> bool {
        self.left.is_some()
    }

    /// Takes in the bounds of others.
    #[inline(always)]
    pub(super) fn bound_by(&mut self, [low, high]: [u32; 2]) {
        self.bounds = [self.bounds[0].min(low), self.bounds[1].max(high)];
    }

    /// Looks up the cell of the particle with index `p`, which is at `x` now.
    #[inline(always)]
    pub(super) fn settle<const D: usize>(
        &mut self,
        grid: &Grid<T, D>,
        p: usize,
        cell: &mut Cell<D>,
        x: &mut SVector<T, D>,
    ) {
        match settle(grid, cell, x) {
            Some(false) => {}
            Some(true) => {
                self.moved.crossings += 1;
                if window::is_safe(grid, cell) {
                    self.bound(grid.linear(cell));
                } else {
                    self.moved.strayed = true;
                }
            }
            None => self.left = self.left.or(Some(p)),
        }
    }
}

/// Bounds of no numbers.
pub(super) const NO_BOUNDS: [u32; 2] = [u32::MAX, 0];

/// Lowest and highest number, with one more.
#[inline(always)]
pub(super) fn with_number([low, high]: [u32; 2], number: usize) -> [u32; 2] {
    [low.min(number as u32), high.max(number as u32)]
}

/// Moves and deforms the particles of a span, the first of which has the number `first`. `shift(p, block, particles, cells, outcome)`
/// is to move those from index `p` on, one at least and as many as it likes while the block has room, note their increments, and look up
/// their cells.
#[inline(always)]
pub(super) fn advance_by_blocks<T, const D: usize, L, P>(
    motion: &Motion<'_, T, D, L, P>,
    first: usize,
    mut particles: Movables<'_, T, D, L::Number, P::Particle>,
    cells: &mut [Cell<D>],
    mut shift: impl FnMut(
        usize,
        &mut Block<T, D>,
        &mut Movables<'_, T, D, L::Number, P::Particle>,
        &mut [Cell<D>],
        &mut Outcome<T>,
    ),
) -> Outcome<T>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    let mut outcome = Outcome {
        moved: Moved::default(),
        bounds: NO_BOUNDS,
        left: None,
    };
    let mut block = Block {
        count: 0,
        increments: [SMatrix::zeros(); BLOCK],
    };
    let mut p = 0;
    while p < cells.len() && outcome.moved.fault.is_none() {
        block.count = 0;
        while p + block.count < cells.len() && block.has_room(MOST_LANES) && outcome.left.is_none() {
            shift(p + block.count, &mut block, &mut particles, cells, &mut outcome);
        }
        let increments = &block.increments[..block.count];
        let flaw = deform(motion, increments, particles.material(p, block.count));
        outcome.moved.fault = match (flaw, outcome.left) {
            // Of particles at fault the first one is told.
            (Some((k, flaw)), left) if left.is_none_or(|left| p + k <= left) => {
                Some(Fault::Material(first + p + k, flaw))
            }
            (_, left) => left.map(|p| Fault::Left(first + p)),
        };
        p += block.count;
    }
    outcome
}

/// Deforms particles; returns the first one whose volume is no longer a positive number, whose stress the law does
/// not know or whose liquid has no pressure any more.
#[inline(always)]
fn deform<T: Scalar, const D: usize, L: LawSweep<T, D>, P: Phase<T, D>>(
    motion: &Motion<'_, T, D, L, P>,
    increments: &[SMatrix<T, D, D>],
    material: Material<'_, T, D, L::Number, P::Particle>,
) -> Option<(usize, Flaw<T>)> {
    let (law, phase) = (motion.law, motion.phase);
    if P::COUPLED && !P::FLOWS {
        for (increment, data) in increments.iter().zip(&mut *material.phase) {
            phase.update(increment, data);
        }
    }
    law.carry(motion.dt, increments, material.stress, material.state);
    let known = law.are_known(material.stress, material.state);
    let sound = !law.large_strain() || stretch(increments, material.volume);
    let finite = !P::FLOWS || have_pressures(phase, material.phase);
    if known && sound && finite {
        return None;
    }
    first_flaw(law, phase, &material)
}

// A function of its own, for the reason that the loops of a law are.

/// Lets volumes follow the increments; whether all are still sound.
#[inline(never)]
fn stretch<T: Scalar, const D: usize>(increments: &[SMatrix<T, D, D>], volumes: &mut [T]) -> bool {
    let bodies = increments.iter().zip(volumes);
    bodies.fold(true, |sound, (increment, volume)| {
        *volume *= determinant(&(SMatrix::identity() + increment));
        sound & is_sound(*volume)
    })
}

/// Whether the liquid of all has a pressure that is a number.
fn have_pressures<T: Scalar, const D: usize, P: Phase<T, D>>(phase: &P, data: &[P::Particle]) -> bool {
    data.iter().all(|data| phase.liquid(data).pressure.is_finite())
}

/// Whether a volume is a positive number, and finite.
#[inline(always)]
fn is_sound<T: Scalar>(volume: T) -> bool {
    (volume > T::zero()) & (volume * T::zero()).is_zero()
}

/// What is wrong with the first particle with which something is.
#[cold]
#[inline(never)]
fn first_flaw<T: Scalar, const D: usize, L: LawSweep<T, D>, P: Phase<T, D>>(
    law: &L,
    phase: &P,
    material: &Material<'_, T, D, L::Number, P::Particle>,
) -> Option<(usize, Flaw<T>)> {
    let bodies = material.stress.iter().zip(&*material.volume);
    bodies.enumerate().find_map(|(k, (stress, &volume))| {
        if P::FLOWS {
            let pressure = material
                .phase
                .get(k)
                .map_or_else(T::zero, |data| phase.liquid(data).pressure);
            if !pressure.is_finite() {
                return Some((k, Flaw::Pressure(pressure)));
            }
        }
        if !law.knows(stress, law.of(material.state, k)) {
            return Some((k, Flaw::Stress(stress[(0, 0)])));
        }
        let unsound = law.large_strain() && !is_sound(volume);
        unsound.then_some((k, Flaw::Volume(volume)))
    })
}
