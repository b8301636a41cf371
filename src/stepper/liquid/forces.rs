//! Lumped masses, drag and forces of both phases.

use nalgebra::{SMatrix, SVector};
use num_traits::Zero;

use super::super::cell_sums::CellSums;
use super::super::{Forcing, Stepper, cloud};
use super::dof::Sums;
use super::surface::EvenLoad;
use crate::basis::BasisFamily;
use crate::field::Pair;
use crate::law::LawSweep;
use crate::phase::Phase;
use crate::reconstruction::{Point, Reconstruction};
use crate::scalar::Scalar;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    /// Masses, drag and forces of both phases, and their velocities at the step's start.
    ///
    /// The forces are `-integral(sigma grad phi_i)` of the total stress and `-integral(p grad phi_i)` of the pressure, both less
    /// the even part of what loads the surfaces, and the rest of that load.
    pub(in super::super) fn assemble_both(&mut self, dt: T, forcing: &Forcing<T, D>) {
        let even = self.even_load(forcing);
        self.find_seals(forcing);
        if R::PLAIN {
            self.sum_everything(&even);
        } else {
            self.sum_masses(R::AMOUNTS_AT_PARTICLES);
            if R::PARTICLE_MATRIX {
                self.assemble_matrices();
            }
            self.integrate_forces(&even);
        }
        self.map_both_before(dt, forcing);
        self.add_uneven_loads(&even, forcing);
        if !self.body_forces.is_empty() {
            self.add_body_forces_to_both();
        }
    }

    /// Sums over the particles of solid mass, liquid mass and drag, each times `phi_i`; with `momenta` of both momenta too.
    pub(in super::super) fn sum_masses(&mut self, momenta: bool) {
        self.sums.fill(Sums::zero());
        let (basis, grid, phase, sums) = (&self.basis, &self.grid, &self.phase, &mut self.sums);
        let particles = &self.particles;
        for (p, x) in particles.position.iter().enumerate() {
            let (m_s, volume) = (particles.mass[p], particles.volume[p]);
            let (m_w, d) = (phase.liquid_mass(volume), phase.drag(m_s, volume));
            let (mut q_s, mut q_w) = (SVector::zeros(), SVector::zeros());
            if momenta {
                q_s = particles.velocity[p] * m_s;
                q_w = phase.liquid(&particles.phase[p]).velocity * m_w;
            }
            basis.for_each(grid, self.bins.cell_of(p), x, |i, phi, _| {
                let sums = &mut sums[i];
                sums.solid_mass += m_s * phi;
                sums.liquid_mass += m_w * phi;
                sums.drag += d * phi;
                if momenta {
                    sums.momenta[0] += q_s * phi;
                    sums.momenta[1] += q_w * phi;
                }
            });
        }
        self.take_sums();
    }

    /// All sums in one pass, where the particles are the points of every integral.
    #[inline(never)]
    fn sum_everything(&mut self, even: &EvenLoad<T>) {
        self.sums.fill(Sums::zero());
        let (basis, grid, phase, sums) = (&self.basis, &self.grid, &self.phase, &mut self.sums);
        let particles = &self.particles;
        let mut at_hand = CellSums::new(basis, grid);
        let mut sink = |i: usize, part| sums[i] = sums[i] + part;
        let bodies = particles.mass.iter().zip(&particles.volume);
        let motion = particles.velocity.iter().zip(&particles.stress);
        let places = particles.position.iter().zip(self.bins.cells());
        for ((((x, cell), (&m_s, &volume)), (velocity, stress)), data) in
            places.zip(bodies).zip(motion).zip(&particles.phase)
        {
            let (m_w, d) = (phase.liquid_mass(volume), phase.drag(m_s, volume));
            let (q_s, q_w) = (velocity * m_s, phase.liquid(data).velocity * m_w);
            let Pair(total, pressure) = even.rest(phase, stress, data);
            let (total, pressure) = (total * -volume, pressure * -volume);
            let part = |phi, gradient| Sums {
                solid_mass: m_s * phi,
                liquid_mass: m_w * phi,
                drag: d * phi,
                momenta: [q_s * phi, q_w * phi],
                forces: [total * gradient, gradient * pressure],
            };
            at_hand.add(cell, x, part, &mut sink);
        }
        at_hand.flush(&mut sink);
        self.take_sums();
    }

    #[inline(never)]
    fn integrate_forces(&mut self, even: &EvenLoad<T>) {
        let cloud = cloud(&self.grid, &self.bins, &self.particles, &self.cuts);
        let (phase, data, effective) = (&self.phase, &self.particles.phase, &self.particles.stress);
        let (basis, whole, liquid) = (&self.basis, &mut self.dofs.force, &mut self.liquid.force);
        let stresses = |p: usize| even.rest(phase, &effective[p], &data[p]);
        let sink = |point: &Point<T, D>, Pair(total, pressure): Pair<SMatrix<T, D, D>, T>| {
            let add = |i: usize, _, gradient: SVector<T, D>| {
                whole[i] -= total * gradient;
                liquid[i] -= gradient * pressure;
            };
            if point.moves {
                basis.for_each(cloud.grid, &point.cell, &point.position, add);
            } else {
                basis.for_each_at_fixed_point(cloud.grid, &point.cell, &point.position, add);
            }
        };
        if R::KEEPS_FITS {
            self.reconstruction.take_in_field(&cloud, &stresses);
            let cells = 0..self.bins.occupied().len();
            self.reconstruction.integrate_cells(&cloud, cells, stresses, sink);
        } else {
            self.reconstruction.integrate(&cloud, stresses, sink);
        }
    }
}
