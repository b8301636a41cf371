//! What is counted and measured along the way.

use nalgebra::SVector;

use super::Stepper;
use crate::basis::BasisFamily;
use crate::field::MassMomentum;
use crate::law::ConstitutiveLaw;
use crate::particles::Particles;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;

/// Largest errors, over all steps, of the mapped DOF totals against the particle totals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conservation<T> {
    /// Of mass, relative to the mass.
    pub mass: T,
    /// Of momentum, relative to the total momentum (as the papers report it; large where that passes zero).
    pub momentum: T,
    /// Of momentum, relative to `sum m |v|`.
    pub momentum_scaled: T,
}

/// Counts and measures since the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diagnostics<T> {
    /// Conservation by the mapping of mass and momentum.
    pub conservation: Conservation<T>,
    /// How often a particle changed its cell.
    pub grid_crossings: usize,
    /// Most cells in one step that could not be fitted with the full set of functions.
    pub reduced_cells: usize,
    /// Mass of all particles.
    pub total_mass: T,
}

/// Energy of the particles (1-D: J/m2, 2-D: J/m, 3-D: J).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy<T> {
    /// `sum m |v|^2 / 2`, half a step earlier than the strain energy.
    pub kinetic: T,
    /// Strain energy by the law.
    pub strain: T,
}

impl<T: Scalar> Energy<T> {
    /// Kinetic plus strain energy.
    pub fn total(&self) -> T {
        self.kinetic + self.strain
    }
}

impl<T: Scalar> Diagnostics<T> {
    pub(super) fn new(total_mass: T) -> Self {
        Self {
            conservation: Conservation {
                mass: T::zero(),
                momentum: T::zero(),
                momentum_scaled: T::zero(),
            },
            grid_crossings: 0,
            reduced_cells: 0,
            total_mass,
        }
    }

    pub(super) fn record_reduced(&mut self, cells: usize) {
        self.reduced_cells = self.reduced_cells.max(cells);
    }

    /// Compares the mapped totals with those of the particles.
    pub(super) fn record<const D: usize, S, P>(
        &mut self,
        particles: &Particles<T, D, S, P>,
        mapped: MassMomentum<T, D>,
    ) {
        let mut momentum = SVector::<T, D>::zeros();
        let mut scale = T::zero();
        for (&m, v) in particles.mass.iter().zip(&particles.velocity) {
            let part = v * m;
            momentum += part;
            scale += if D == 1 { part[0].abs() } else { part.norm() };
        }
        let errors = &mut self.conservation;
        let mass = (mapped.mass - self.total_mass).abs() / self.total_mass;
        errors.mass = errors.mass.max(mass);
        let difference = (mapped.momentum - momentum).norm();
        let total = momentum.norm();
        if total > T::zero() {
            errors.momentum = errors.momentum.max(difference / total);
        }
        if scale > T::zero() {
            errors.momentum_scaled = errors.momentum_scaled.max(difference / scale);
        }
    }
}

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: ConstitutiveLaw<T, D>,
    P: Phase<T, D>,
{
    /// Kinetic and strain energy of the particles as they are.
    pub fn energy(&self) -> Energy<T> {
        let particles = &self.particles;
        let half = T::one() / T::lit(2.0);
        let mut energy = Energy {
            kinetic: T::zero(),
            strain: T::zero(),
        };
        for p in 0..particles.len() {
            energy.kinetic += particles.velocity[p].norm_squared() * particles.mass[p] * half;
            let density = self.law.energy_density(&particles.stress[p], &particles.state[p]);
            energy.strain += density * particles.volume[p];
        }
        energy
    }
}
