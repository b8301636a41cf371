//! Stage 3, momenta of the DOFs from the particles' velocities: from fits of densities, or from the particles themselves.

use nalgebra::SVector;

use super::by_four::{self, ByFour};
use super::lanes::{self, Bodies};
use super::spans::{Spans, share};
use super::velocity::sum;
use super::{Dofs, Stepper, cloud};
use crate::basis::BasisFamily;
use crate::field::MassMomentum;
use crate::grid::Grid;
use crate::law::LawSweep;
use crate::mass::{VelocityMass, banded_row};
use crate::parallel::{Windows, add_up, each_span};
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
    /// Momentum and mass of the DOFs; returns their totals.
    pub(super) fn map_momentum(&mut self) -> MassMomentum<T, D> {
        let mass = if R::AMOUNTS_AT_PARTICLES {
            self.map_particles()
        } else if self.velocity_mass == VelocityMass::Lumped {
            self.map_lumped()
        } else {
            self.map_consistent()
        };
        self.mapped_totals(mass)
    }

    /// `mass` and the total momentum of the DOFs.
    pub(super) fn mapped_totals(&self, mass: T) -> MassMomentum<T, D> {
        MassMomentum {
            mass,
            momentum: sum(&self.dofs.velocity),
        }
    }

    /// Momentum straight from the particles; the masses are those of stage 1 already.
    fn map_particles(&mut self) -> T {
        self.dofs.velocity.fill(SVector::zeros());
        let (basis, grid, momentum) = (&self.basis, &self.grid, &mut self.dofs.velocity);
        let (mass, velocity) = (&self.particles.mass, &self.particles.velocity);
        if const { lanes::apply_to_values::<T, D, B>() && R::PARTICLE_MATRIX } {
            let bodies = Bodies {
                positions: &self.particles.position,
                cells: self.bins.cells(),
                masses: mass,
            };
            by_four::add_momenta(basis, grid, bodies, velocity, momentum);
        } else {
            let cloud = cloud(grid, &self.bins, &self.particles, &self.cuts);
            self.reconstruction.integrate_conserved(
                &cloud,
                |p| velocity[p] * mass[p],
                |point, amount| {
                    basis.for_each(grid, &point.cell, &point.position, |i, phi, _| {
                        momentum[i] += amount * phi;
                    });
                },
            );
        }
        if R::PARTICLE_MATRIX {
            self.dofs.matrix.total()
        } else {
            sum(&self.dofs.mass)
        }
    }

    /// Momentum and row sums of the mass from the reconstructed densities.
    fn map_lumped(&mut self) -> T {
        if const { lanes::fit::<T, D, B, R>() } && self.by_four() {
            self.by_four_parts().lump();
            return sum(&self.dofs.lumped);
        }
        let add = |(basis, grid): Places<'_, T, D, B>,
                   point: &Point<T, D>,
                   amount: Amount<T, D>,
                   dofs: DofSums<'_, T, D>| {
            basis.for_each_at_fixed_point(grid, &point.cell, &point.position, |i, phi, _| {
                dofs.mass[i - dofs.first] += amount.mass * phi;
                dofs.momentum[i - dofs.first] += amount.momentum * phi;
            });
        };
        self.integrate_amounts(1, Dofs::lumped_mut, &add);
        sum(&self.dofs.lumped)
    }

    /// What mapping four cells at a time wants.
    fn by_four_parts(&mut self) -> ByFour<'_, T, D, B, R> {
        let particles = &self.particles;
        ByFour {
            basis: &self.basis,
            reconstruction: &self.reconstruction,
            cloud: cloud(&self.grid, &self.bins, particles, &self.cuts),
            masses: &particles.mass,
            velocities: &particles.velocity,
            spans: &mut self.spans,
            dofs: &mut self.dofs,
        }
    }

    /// Momentum and mass matrix from the reconstructed densities.
    fn map_consistent(&mut self) -> T {
        match (D > 1, const { lanes::fit::<T, D, B, R>() } && self.by_four()) {
            (true, true) => self.by_four_parts().fill_lattice(),
            (true, false) => self.integrate_lattice(),
            (false, true) => self.by_four_parts().fill_band(),
            (false, false) => self.integrate_band(),
        }
        self.dofs.matrix.complete(None);
        self.dofs.matrix.total()
    }

    fn integrate_lattice(&mut self) {
        let (basis, grid, pairs) = (&self.basis, &self.grid, &mut self.pairs);
        let Dofs { matrix, velocity, .. } = &mut self.dofs;
        matrix.clear();
        velocity.fill(SVector::zeros());
        let cloud = cloud(grid, &self.bins, &self.particles, &self.cuts);
        let amounts = amounts(&self.particles.mass, &self.particles.velocity);
        self.reconstruction
            .integrate_conserved(&cloud, amounts, |point, amount| {
                let (cell, x) = (&point.cell, &point.position);
                pairs.turn_to(cell, matrix);
                basis.for_each_at_fixed_point(grid, cell, x, |i, phi, _| {
                    velocity[i] += amount.momentum * phi;
                    pairs.see(i, phi);
                });
                pairs.add(amount.mass);
            });
        pairs.flush(matrix);
    }

    fn integrate_band(&mut self) {
        let half_band = self.dofs.matrix.band_mut().half_band();
        let add = |(basis, grid): Places<'_, T, D, B>,
                   point: &Point<T, D>,
                   amount: Amount<T, D>,
                   dofs: DofSums<'_, T, D>| {
            let (cell, x) = (&point.cell, &point.position);
            basis.for_each_at_fixed_point(grid, cell, x, |i, phi_i, _| {
                dofs.momentum[i - dofs.first] += amount.momentum * phi_i;
                let m = amount.mass * phi_i;
                let row = banded_row(dofs.mass, i - dofs.first, half_band);
                basis.for_each_at_fixed_point(grid, cell, x, |j, phi_j, _| {
                    if j <= i {
                        row[half_band + j - i] += m * phi_j;
                    }
                });
            });
        };
        self.integrate_amounts(half_band + 1, Dofs::band_mut, &add);
    }

    /// Streams mass and momentum into sums of `width` numbers of mass and one momentum for each DOF.
    fn integrate_amounts(
        &mut self,
        width: usize,
        pick: PickSums<T, D>,
        add: &(impl Fn(Places<'_, T, D, B>, &Point<T, D>, Amount<T, D>, DofSums<'_, T, D>) + Sync),
    ) {
        let cloud = cloud(&self.grid, &self.bins, &self.particles, &self.cuts);
        let amounts = amounts(&self.particles.mass, &self.particles.velocity);
        let (mass, momentum) = pick(&mut self.dofs);
        let places = (&self.basis, &self.grid);
        if !R::BY_CELLS {
            mass.fill(T::zero());
            momentum.fill(SVector::zeros());
            return self
                .reconstruction
                .integrate_conserved(&cloud, amounts, |point, amount| {
                    add(
                        places,
                        point,
                        amount,
                        DofSums {
                            first: 0,
                            mass,
                            momentum,
                        },
                    );
                });
        }
        let reconstruction = &self.reconstruction;
        let occupied = self.bins.occupied();
        let Spans {
            cells: spans,
            lengths,
            matrices,
            vectors,
            ..
        } = &mut self.spans;
        let (span, parallel) = share::<D>(spans, occupied.len(), lengths[1]);
        let work = (
            occupied,
            Windows::new(spans, matrices, mass, width),
            Windows::new(spans, vectors, momentum, 1),
        );
        each_span(parallel, span, work, &|place, (cells, mass, momentum)| {
            let ((first, mass), (_, momentum)) = (mass.one(), momentum.one());
            let cells = place..place + cells.len();
            reconstruction.integrate_conserved_cells(&cloud, cells, &amounts, |point, amount| {
                add(
                    places,
                    point,
                    amount,
                    DofSums {
                        first,
                        mass,
                        momentum,
                    },
                );
            });
        });
        add_up(spans, matrices, mass, width);
        add_up(spans, vectors, momentum, 1);
    }
}

/// The DOFs' arrays that a mapping fills: mass and momentum.
type PickSums<T, const D: usize> = fn(&mut Dofs<T, D>) -> (&mut [T], &mut [SVector<T, D>]);
type Places<'a, T, const D: usize, B> = (&'a B, &'a Grid<T, D>);
type Amount<T, const D: usize> = MassMomentum<T, D>;

/// Sums of the DOFs from `first` on.
struct DofSums<'a, T, const D: usize> {
    first: usize,
    mass: &'a mut [T],
    momentum: &'a mut [SVector<T, D>],
}

impl<T: Scalar, const D: usize> Dofs<T, D> {
    pub(super) fn lumped_mut(&mut self) -> (&mut [T], &mut [SVector<T, D>]) {
        (&mut self.lumped, &mut self.velocity)
    }

    pub(super) fn band_mut(&mut self) -> (&mut [T], &mut [SVector<T, D>]) {
        (self.matrix.band_mut().rows_mut(), &mut self.velocity)
    }
}

/// Mass and momentum of each particle.
fn amounts<'a, T: Scalar, const D: usize>(
    mass: &'a [T],
    velocity: &'a [SVector<T, D>],
) -> impl Fn(usize) -> MassMomentum<T, D> + 'a {
    move |p| MassMomentum {
        mass: mass[p],
        momentum: velocity[p] * mass[p],
    }
}
