//! How fast particles are moved towards the fits.

use crate::reconstruction::CourantNumbers;
use crate::scalar::Scalar;

/// Largest share towards the fit through neighbours. At a wall that fit extrapolates from one side: near the
/// critical step, where stresses change their sign from step to step, larger shares lower the limit (by 5 %
/// where 0.1 was taken).
const MOST_FROM_NEIGHBOURS: f64 = 0.03;

/// Relaxation towards the fits.
///
/// What neighbours see otherwise than a cell itself is relaxed without being strained: a body under a lasting
/// load creeps at a rate per time. It need not be relaxed where nothing moves, because only motion makes a
/// fit another one; so rates that are counted in cells crossed by the particles do without. See
/// `docs/theory/relaxed-tls.md`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxation<T> {
    /// Of stress and velocity towards the fit of the particle's own cell: a rate in units of one over the
    /// time in which a wave crosses a cell.
    pub own: T,
    /// Of the stress towards the fit through the neighbours too, in the same units.
    pub neighbours: T,
    /// The same towards the fit through the neighbours, for each cell that the particles cross.
    pub motion: T,
}

impl<T: Scalar> Default for Relaxation<T> {
    /// That of one dimension.
    fn default() -> Self {
        Self::in_dimensions(1)
    }
}

impl<T: Scalar> Relaxation<T> {
    fn new(own: f64, neighbours: f64, motion: f64) -> Self {
        Self {
            own: T::lit(own),
            neighbours: T::lit(neighbours),
            motion: T::lit(motion),
        }
    }

    /// Along one axis 3 and 0.8. Beyond, 3, none, and 2 for each cell crossed: there are more particles in a
    /// cell to keep its fit in bounds.
    pub fn in_dimensions(count: usize) -> Self {
        if count == 1 {
            Self::new(3.0, 0.8, 0.0)
        } else {
            Self::new(3.0, 0.0, 2.0)
        }
    }

    /// For gradients that are constant in a cell: 3 and 3. Slopes of the stress within a cell come from the
    /// neighbours alone there, late by one over their rate, and cost nothing because they leave the mean
    /// alone.
    pub fn with_constant_gradients() -> Self {
        Self::new(3.0, 3.0, 0.0)
    }

    /// With a liquid in the pores, along one axis. A draining layer lasts for 1e5 crossings of a wave, in
    /// which 0.8 would creep further than it settles: 0.003 gives linear functions and dual domain their
    /// slopes, B-splines strain them. What runs to and fro is bounded by 10 for each cell crossed, 40 with
    /// gradients that are constant in a cell.
    pub fn with_liquid(degree: usize, constant_gradients: bool) -> Self {
        let neighbours = if degree == 1 { 0.003 } else { 0.0 };
        let motion = if constant_gradients { 40.0 } else { 10.0 };
        Self::new(3.0, neighbours, motion)
    }

    /// Shares of the difference to each fit that a step takes away.
    #[inline(always)]
    pub(super) fn shares(&self, crossed: CourantNumbers<T>) -> [T; 2] {
        let own = self.own * crossed.wave;
        let neighbours = self.neighbours * crossed.wave + self.motion * crossed.motion;
        let sum = T::one() + own + neighbours;
        [own / sum, (neighbours / sum).min(T::lit(MOST_FROM_NEIGHBOURS))]
    }
}
