//! A stepper's state, saved and restored to the bit.
//!
//! Saved is what a step finds and does not make anew:
//!
//! * the particles, in the order in which they are in memory (sums depend on it), and which of them bear
//!   surfaces;
//! * their cells: a particle at an edge stays in the cell that it came from, so that its position does not
//!   tell;
//! * the window of cells that have numbers, and whether it is to be laid anew ([`super::window`]);
//! * their first numbers, and how many have changed their cells since they were put in order;
//! * how sums are cut into spans, which the cells of earlier steps decide ([`spans`]);
//! * time, steps, diagnostics, the momentum after the last step.
//!
//! Not saved is what follows from the [`Setup`](super::Setup) (grid, law, phase, DOFs of the faces) or is
//! made anew before it is used: basis and reconstruction take in where the particles are at the start of a
//! step, as the lists of the cells and the cuts of the surfaces; impulses of walls are found from nothing in
//! each step; mass, forces, velocities, matrices and drag of the DOFs and the part of a cell that a wave
//! crosses are summed from the particles. Body forces ([`Stepper::set_body_forces`]) are loads, which the
//! caller sets again.

mod codec;
mod particles;
mod spans;

use std::io::{self, Read, Write};

use nalgebra::SVector;

use super::balance::Balance;
use super::diffusion::refuse_without_capacity;
use super::order::Order;
use super::spans::Spans;
use super::{Conservation, Diagnostics, Stepper, SurfacePoint, domain};
use crate::basis::BasisFamily;
use crate::error::RestoreError;
use crate::grid::{Grid, Window};
use crate::law::LawSweep;
use crate::particles::Bins;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::record::Record;
use crate::scalar::Scalar;
use crate::stepper::inner::Inner;
use crate::transfer::Transfer;
use codec::{In, Out};

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    L::Number: Record<T>,
    P: Phase<T, D>,
    P::Particle: Record<T>,
    X: Transfer<T, D>,
    X::Particle: Record<T>,
{
    /// Writes all that [`Stepper::restore`] needs to go on as this stepper will, to the bit; nothing is held
    /// twice in memory. The bytes bear no mark and no checksum of their own.
    ///
    /// # Errors
    /// Those of `out`, and [`io::ErrorKind::Unsupported`] for scalars other than `f64` and `f32`.
    pub fn save(&self, out: &mut dyn Write) -> io::Result<()> {
        self.inner.save(out)
    }

    /// Takes over what [`Stepper::save`] wrote, of a stepper with the same setup. DOF velocities are those of
    /// the next step once it is taken, and body forces must be set again.
    ///
    /// # Errors
    /// If it cannot be read, comes from a stepper of another kind or makes no sense. The state is then
    /// neither the old nor the new one: such a stepper is of no further use.
    pub fn restore(&mut self, from: &mut dyn Read) -> Result<(), RestoreError> {
        self.inner.restore(&self.basis, from)
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    L::Number: Record<T>,
    P: Phase<T, D>,
    P::Particle: Record<T>,
    X: Transfer<T, D>,
    X::Particle: Record<T>,
{
    /// See [`Stepper::save`].
    #[inline(never)]
    fn save(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut out = Out::new::<T>(out)?;
        let progress = (self.strayed, self.time, self.steps);
        let sums = (&self.diagnostics, &self.balance);
        save_progress(&mut out, self.shape(), &self.grid, progress, sums)?;
        self.particles.save(&mut out)?;
        out.records(&self.memory)?;
        save_places(&mut out, &self.surface, &self.bins, &self.order, &self.spans)
    }

    /// See [`Stepper::restore`].
    #[inline(never)]
    fn restore<B: BasisFamily<T, D>>(&mut self, basis: &B, from: &mut dyn Read) -> Result<(), RestoreError> {
        let mut from = In::new::<T>(from)?;
        let (window, strayed) = read_window(&mut from, self.shape())?;
        self.take_window(basis, window)?;
        self.strayed = strayed;
        let progress = (&mut self.time, &mut self.steps);
        restore_progress(&mut from, progress, &mut self.diagnostics, &mut self.balance)?;
        self.particles.restore(&mut from, self.law.numbers())?;
        from.records("what the transfer remembers of particle", &mut self.memory)?;
        refuse_without_capacity(&self.phase, &self.particles)?;
        domain::validate::<T, D, B, _, _>(&self.grid, &self.particles)?;
        // Windows overlap, and a matrix has so many numbers for each DOF.
        let width = 1 + basis.half_band(&self.grid);
        let most = 16 * width * (self.dofs.mass.len() + self.particles.len());
        let places = (&mut self.surface[..], &mut self.bins, &mut self.order);
        restore_places(
            &mut from,
            places,
            (&self.grid, self.strayed),
            &mut self.spans,
            most,
        )
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    L::Number: Record<T>,
    P: Phase<T, D>,
    P::Particle: Record<T>,
    X: Transfer<T, D>,
    X::Particle: Record<T>,
{
    fn shape(&self) -> Vec<(&'static str, usize)> {
        shape_of::<T, D>(&self.grid, self.particles.len(), self.surface.len())
    }

    /// Takes over the window of cells that was read.
    fn take_window<B: BasisFamily<T, D>>(
        &mut self,
        basis: &B,
        window: Window<D>,
    ) -> Result<(), RestoreError> {
        if window == *self.grid.window() {
            return Ok(());
        }
        self.grid = self.grid.clone().with_window(window);
        let refused = !B::FOLLOWS_WINDOW || *self.grid.window() != window || window.shape().contains(&0);
        if refused {
            let what = "the window of cells, axis";
            return Err(RestoreError::Invalid { what, index: 0 });
        }
        self.follow_window(basis);
        Ok(())
    }
}

const CELLS_ALONG: [&str; 3] = ["cells along x", "cells along y", "cells along z"];

/// What two steppers must have in common, by names.
fn shape_of<T: Scalar, const D: usize>(
    grid: &Grid<T, D>,
    particles: usize,
    surfaces: usize,
) -> Vec<(&'static str, usize)> {
    let mut shape = vec![("axes", D), ("bytes to a number", size_of::<T>())];
    shape.extend(CELLS_ALONG.into_iter().zip(grid.cells()));
    shape.extend([("particles", particles), ("surfaces", surfaces)]);
    shape
}

// Functions of what they look at: what follows is the same for all methods, and each `?` is code.

/// Writes what two steppers must have in common and how far this one is.
#[inline(never)]
fn save_progress<T: Scalar, const D: usize>(
    out: &mut Out<'_>,
    shape: Vec<(&'static str, usize)>,
    grid: &Grid<T, D>,
    (strayed, time, steps): (bool, T, usize),
    (diagnostics, balance): (&Diagnostics<T>, &Balance<T, D>),
) -> io::Result<()> {
    shape.into_iter().try_for_each(|(_, value)| out.count(value))?;
    save_window(grid, out)?;
    out.flag(strayed)?;
    out.numbers(&[time])?;
    out.count(steps)?;
    diagnostics.save(out)?;
    balance.save(out)
}

#[inline(never)]
fn restore_progress<T: Scalar, const D: usize>(
    from: &mut In<'_>,
    (time, steps): (&mut T, &mut usize),
    diagnostics: &mut Diagnostics<T>,
    balance: &mut Balance<T, D>,
) -> Result<(), RestoreError> {
    from.numbers(std::slice::from_mut(time))?;
    *steps = from.count()?;
    diagnostics.restore(from)?;
    balance.restore(from)
}

/// Writes where particles are, in which order, and how they are cut into spans.
#[inline(never)]
fn save_places<T: Scalar, const D: usize>(
    out: &mut Out<'_>,
    surface: &[SurfacePoint<T>],
    bins: &Bins<D>,
    order: &Order,
    spans: &Spans<T, D>,
) -> io::Result<()> {
    for point in surface {
        out.count(point.particle)?;
    }
    out.indices(bins.cells().as_flattened())?;
    order.save(out)?;
    spans.save(out)
}

#[inline(never)]
fn restore_places<T: Scalar, const D: usize>(
    from: &mut In<'_>,
    (surface, bins, order): (&mut [SurfacePoint<T>], &mut Bins<D>, &mut Order),
    (grid, strayed): (&Grid<T, D>, bool),
    spans: &mut Spans<T, D>,
    most: usize,
) -> Result<(), RestoreError> {
    restore_surface(surface, from, bins.len())?;
    restore_cells(bins, from, grid, strayed)?;
    order.load(from)?;
    spans.restore(from, (grid, bins), most)
}

#[inline(never)]
fn save_window<T: Scalar, const D: usize>(grid: &Grid<T, D>, out: &mut Out<'_>) -> io::Result<()> {
    let window = grid.window();
    out.indices(&window.first())?;
    for count in window.shape() {
        out.count(count)?;
    }
    Ok(())
}

/// Checks what two steppers must have in common, and reads the window and whether it is to be laid anew.
#[inline(never)]
fn read_window<const D: usize>(
    from: &mut In<'_>,
    shape: Vec<(&'static str, usize)>,
) -> Result<(Window<D>, bool), RestoreError> {
    for (what, expected) in shape {
        from.expect(what, expected)?;
    }
    let (mut first, mut shape) = ([0; D], [0; D]);
    from.indices(&mut first)?;
    for count in &mut shape {
        *count = from.count()?;
    }
    Ok((Window::new(first, shape), from.flag()?))
}

#[inline(never)]
fn restore_surface<T>(
    surface: &mut [SurfacePoint<T>],
    from: &mut In<'_>,
    particles: usize,
) -> Result<(), RestoreError> {
    for (index, point) in surface.iter_mut().enumerate() {
        point.particle = from.count_below(particles, "the particle of surface", index)?;
    }
    Ok(())
}

/// Cells of the particles, which have numbers unless some have `strayed`.
#[inline(never)]
fn restore_cells<T: Scalar, const D: usize>(
    bins: &mut Bins<D>,
    from: &mut In<'_>,
    grid: &Grid<T, D>,
    strayed: bool,
) -> Result<(), RestoreError> {
    let counts = grid.cells();
    for (index, cell) in bins.cells_mut().iter_mut().enumerate() {
        from.indices(cell)?;
        let outside = cell.iter().zip(counts).any(|(&c, count)| c as usize >= count);
        if outside || !strayed && !grid.has_numbers(cell, 0) {
            let what = "the cell of particle";
            return Err(RestoreError::Invalid { what, index });
        }
    }
    bins.note_crossings(1);
    Ok(())
}

impl<T: Scalar, const D: usize> Balance<T, D> {
    #[inline(never)]
    fn save(&self, out: &mut Out<'_>) -> io::Result<()> {
        out.flag(self.momentum.is_some())?;
        out.numbers(self.momentum.unwrap_or_else(SVector::zeros).as_slice())
    }

    #[inline(never)]
    fn restore(&mut self, from: &mut In<'_>) -> Result<(), RestoreError> {
        let known = from.flag()?;
        let mut momentum = SVector::<T, D>::zeros();
        from.numbers(momentum.as_mut_slice())?;
        self.momentum = known.then_some(momentum);
        Ok(())
    }
}

impl<T: Scalar> Diagnostics<T> {
    fn save(&self, out: &mut Out<'_>) -> io::Result<()> {
        let Self {
            conservation,
            liquid_conservation,
            grid_crossings,
            reduced_cells,
            virtual_cells,
            wall_work,
            wall_gain,
            unsolved_contacts,
            // Not of the setup alone: particles may have been edited since.
            total_mass,
        } = self;
        for errors in [Some(conservation), liquid_conservation.as_ref()]
            .into_iter()
            .flatten()
        {
            out.numbers(&[
                errors.mass,
                errors.momentum,
                errors.momentum_scaled,
                errors.impulse,
            ])?;
        }
        out.count(*grid_crossings)?;
        out.count(*reduced_cells)?;
        out.count(*virtual_cells)?;
        out.count(*unsolved_contacts)?;
        out.numbers(&[*wall_work, *wall_gain, *total_mass])
    }

    fn restore(&mut self, from: &mut In<'_>) -> Result<(), RestoreError> {
        let both = [Some(&mut self.conservation), self.liquid_conservation.as_mut()];
        for errors in both.into_iter().flatten() {
            let mut found = [T::zero(); 4];
            from.numbers(&mut found)?;
            let [mass, momentum, momentum_scaled, impulse] = found;
            *errors = Conservation {
                mass,
                momentum,
                momentum_scaled,
                impulse,
            };
        }
        self.grid_crossings = from.count()?;
        self.reduced_cells = from.count()?;
        self.virtual_cells = from.count()?;
        self.unsolved_contacts = from.count()?;
        from.numbers(std::slice::from_mut(&mut self.wall_work))?;
        from.numbers(std::slice::from_mut(&mut self.wall_gain))?;
        from.numbers(std::slice::from_mut(&mut self.total_mass))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests;
