//! Copies of a stepper.
//!
//! What is the same for all methods is copied by a function that knows nothing of them: the copies of two
//! dozen fields, and what frees those that are there already where the next one fails, are else compiled for
//! every stepper.

use nalgebra::{SMatrix, SVector};

use super::dofs::Dofs;
use super::order::Order;
use super::pairs::Pairs;
use super::spans::Spans;
use super::{Diagnostics, Stepper, SurfacePoint, balance, contact, diffusion, liquid};
use crate::grid::Grid;
use crate::law::LawSweep;
use crate::particles::Bins;
use crate::phase::Phase;
use crate::reconstruction::{CourantNumbers, Cut};
use crate::scalar::Scalar;
use crate::transfer::{DofPlaces, Transfer};

/// All but what particles are made of and the method.
struct State<T: Scalar, const D: usize> {
    grid: Grid<T, D>,
    bins: Bins<D>,
    order: Order,
    cuts: Vec<Cut<T>>,
    dofs: Dofs<T, D>,
    liquid: Dofs<T, D>,
    drag: Vec<T>,
    diffusion: diffusion::Diffusion<T>,
    joint: liquid::Joint<T, D>,
    seal: liquid::Seal<T>,
    places: DofPlaces<T, D>,
    spans: Spans<T, D>,
    crossed: Vec<CourantNumbers<T>>,
    relaxed: Vec<SMatrix<T, D, D>>,
    balance: balance::Balance<T, D>,
    contact: contact::WallContact<T, D>,
    pairs: Pairs<T, D>,
    body_forces: Vec<SVector<T, D>>,
    face_dofs: Vec<Vec<u32>>,
    left_out: Vec<Option<usize>>,
    surface: Vec<SurfacePoint<T>>,
    diagnostics: Diagnostics<T>,
}

/// The same, as a stepper has it.
struct Borrowed<'a, T: Scalar, const D: usize> {
    grid: &'a Grid<T, D>,
    bins: &'a Bins<D>,
    order: &'a Order,
    cuts: &'a Vec<Cut<T>>,
    dofs: &'a Dofs<T, D>,
    liquid: &'a Dofs<T, D>,
    drag: &'a Vec<T>,
    diffusion: &'a diffusion::Diffusion<T>,
    joint: &'a liquid::Joint<T, D>,
    seal: &'a liquid::Seal<T>,
    places: &'a DofPlaces<T, D>,
    spans: &'a Spans<T, D>,
    crossed: &'a Vec<CourantNumbers<T>>,
    relaxed: &'a Vec<SMatrix<T, D, D>>,
    balance: &'a balance::Balance<T, D>,
    contact: &'a contact::WallContact<T, D>,
    pairs: &'a Pairs<T, D>,
    body_forces: &'a Vec<SVector<T, D>>,
    face_dofs: &'a Vec<Vec<u32>>,
    left_out: &'a Vec<Option<usize>>,
    surface: &'a Vec<SurfacePoint<T>>,
    diagnostics: &'a Diagnostics<T>,
}

impl<T: Scalar, const D: usize> Borrowed<'_, T, D> {
    #[inline(never)]
    fn copied(&self) -> State<T, D> {
        State {
            grid: self.grid.clone(),
            bins: self.bins.clone(),
            order: self.order.clone(),
            cuts: self.cuts.clone(),
            dofs: self.dofs.clone(),
            liquid: self.liquid.clone(),
            drag: self.drag.clone(),
            diffusion: self.diffusion.clone(),
            joint: self.joint.clone(),
            seal: self.seal.clone(),
            places: self.places.clone(),
            spans: self.spans.clone(),
            crossed: self.crossed.clone(),
            relaxed: self.relaxed.clone(),
            balance: *self.balance,
            contact: self.contact.clone(),
            pairs: self.pairs.clone(),
            body_forces: self.body_forces.clone(),
            face_dofs: self.face_dofs.clone(),
            left_out: self.left_out.clone(),
            surface: self.surface.clone(),
            diagnostics: *self.diagnostics,
        }
    }
}

impl<T, const D: usize, B, R, L, P, X> Clone for Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: Clone,
    R: Clone,
    L: LawSweep<T, D> + Clone,
    P: Phase<T, D> + Clone,
    X: Transfer<T, D>,
{
    fn clone(&self) -> Self {
        let borrowed = Borrowed {
            grid: &self.grid,
            bins: &self.bins,
            order: &self.order,
            cuts: &self.cuts,
            dofs: &self.dofs,
            liquid: &self.liquid,
            drag: &self.drag,
            diffusion: &self.diffusion,
            joint: &self.joint,
            seal: &self.seal,
            places: &self.places,
            spans: &self.spans,
            crossed: &self.crossed,
            relaxed: &self.relaxed,
            balance: &self.balance,
            contact: &self.contact,
            pairs: &self.pairs,
            body_forces: &self.body_forces,
            face_dofs: &self.face_dofs,
            left_out: &self.left_out,
            surface: &self.surface,
            diagnostics: &self.diagnostics,
        };
        let state = borrowed.copied();
        Self {
            grid: state.grid,
            bins: state.bins,
            order: state.order,
            cuts: state.cuts,
            dofs: state.dofs,
            liquid: state.liquid,
            drag: state.drag,
            diffusion: state.diffusion,
            joint: state.joint,
            seal: state.seal,
            places: state.places,
            spans: state.spans,
            crossed: state.crossed,
            relaxed: state.relaxed,
            balance: state.balance,
            contact: state.contact,
            pairs: state.pairs,
            body_forces: state.body_forces,
            face_dofs: state.face_dofs,
            left_out: state.left_out,
            surface: state.surface,
            diagnostics: state.diagnostics,
            basis: self.basis.clone(),
            reconstruction: self.reconstruction.clone(),
            law: self.law.clone(),
            phase: self.phase.clone(),
            transfer: self.transfer.clone(),
            particles: self.particles.clone(),
            memory: self.memory.clone(),
            strayed: self.strayed,
            velocity_mass: self.velocity_mass,
            mass: self.mass,
            time: self.time,
            steps: self.steps,
        }
    }
}
