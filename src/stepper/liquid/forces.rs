//! Lumped masses, drag and forces of both phases.

use nalgebra::SVector;

use super::super::{Forcing, Stepper, cloud};
use crate::basis::BasisFamily;
use crate::field::Pair;
use crate::law::ConstitutiveLaw;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: ConstitutiveLaw<T, D>,
    P: Phase<T, D>,
{
    /// Sums over the particles of solid mass, liquid mass and drag, each times `phi_i`.
    pub(in super::super) fn lump_both_masses(&mut self) {
        let (solid, liquid, drag) = (&mut self.dofs.mass, &mut self.liquid.mass, &mut self.drag);
        for sums in [&mut *solid, &mut *liquid, &mut *drag] {
            sums.fill(T::zero());
        }
        for (p, x) in self.particles.position.iter().enumerate() {
            let (m, volume) = (self.particles.mass[p], self.particles.volume[p]);
            let (m_liquid, d) = (self.phase.liquid_mass(volume), self.phase.drag(m, volume));
            let cell = self.bins.cell_of(p);
            self.basis.for_each(&self.grid, cell, x, |i, phi, _| {
                solid[i] += m * phi;
                liquid[i] += m_liquid * phi;
                drag[i] += d * phi;
            });
        }
    }

    /// `-integral(sigma grad phi_i)` of the total stress and `-integral(p grad phi_i)` of the pressure, both less the even part
    /// of what loads the surfaces, and the rest of that load.
    pub(in super::super) fn assemble_both_forces(&mut self, forcing: &Forcing<T, D>) {
        let even = self.even_load(forcing);
        let cloud = cloud(&self.grid, &self.bins, &self.particles, &self.cuts);
        let (phase, data, effective) = (&self.phase, &self.particles.phase, &self.particles.stress);
        let (basis, whole, liquid) = (&self.basis, &mut self.dofs.force, &mut self.liquid.force);
        whole.fill(SVector::zeros());
        liquid.fill(SVector::zeros());
        let stresses = |p: usize| {
            let mut total = phase.total_stress(&effective[p], &data[p]);
            for a in 0..D {
                total[(a, a)] -= even.stress;
            }
            Pair(total, phase.liquid(&data[p]).pressure - even.pressure)
        };
        self.reconstruction
            .integrate(&cloud, stresses, |point, Pair(total, pressure)| {
                let add = |i: usize, _, gradient: SVector<T, D>| {
                    whole[i] -= total * gradient;
                    liquid[i] -= gradient * pressure;
                };
                if R::FIELDS_AT_PARTICLES {
                    basis.for_each(cloud.grid, &point.cell, &point.position, add);
                } else {
                    basis.for_each_at_fixed_point(cloud.grid, &point.cell, &point.position, add);
                }
            });
        self.add_uneven_loads(&even, forcing);
    }
}
