//! Stage 3, momenta of the DOFs from the particles' velocities: from fits of densities, or from the particles themselves.

use nalgebra::SVector;

use super::lanes::{self, Bodies, Fits, at_fixed_points};
use super::spans::{Spans, share};
use super::velocity::sum;
use super::{Dofs, Stepper, cloud};
use crate::basis::BasisFamily;
use crate::field::MassMomentum;
use crate::grid::Grid;
use crate::law::ConstitutiveLaw;
use crate::mass::{VelocityMass, banded_row};
use crate::parallel::{Windows, add_up, each_span};
use crate::particles::Particles;
use crate::phase::Phase;
use crate::reconstruction::{Point, Reconstruction};
use crate::scalar::Scalar;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: ConstitutiveLaw<T, D>,
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
            momentum: self.dofs.velocity.iter().fold(SVector::zeros(), |s, q| s + q),
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
            let mut sink = |i: usize, q| momentum[i] += q;
            at_fixed_points!(B, basis, grid, sum_momenta(bodies, velocity, &mut sink));
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
            self.map_lumped_by_four();
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

    #[inline(never)]
    fn map_lumped_by_four(&mut self) {
        let cloud = cloud(&self.grid, &self.bins, &self.particles, &self.cuts);
        let density = densities(&self.particles);
        let (basis, grid, reconstruction) = (&self.basis, &self.grid, &self.reconstruction);
        let occupied = self.bins.occupied();
        let (lumped, momentum) = self.dofs.lumped_mut();
        let Spans {
            cells: spans,
            lengths,
            scalars,
            vectors,
            ..
        } = &mut self.spans;
        let (span, parallel) = share(spans, occupied.len(), lengths[1]);
        let work = (
            occupied,
            Windows::new(spans, scalars, lumped, 1),
            Windows::new(spans, vectors, momentum, 1),
        );
        each_span(parallel, span, work, &|place, (cells, mass, momentum)| {
            let ((first, mass), (_, momentum)) = (mass.one(), momentum.one());
            let momentum = &mut momentum[..mass.len()];
            let fits = Fits {
                moving: basis,
                reconstruction,
                cloud: &cloud,
                cells: place..place + cells.len(),
            };
            let mut sink = |i: usize, m, q| {
                mass[i - first] += m;
                momentum[i - first] += q;
            };
            at_fixed_points!(B, basis, grid, integrate_densities(fits, &density, &mut sink));
        });
        add_up(spans, scalars, lumped, 1);
        add_up(spans, vectors, momentum, 1);
    }

    /// Momentum and mass matrix from the reconstructed densities.
    fn map_consistent(&mut self) -> T {
        match (D > 1, const { lanes::fit::<T, D, B, R>() } && self.by_four()) {
            (true, true) => self.integrate_lattice_by_four(),
            (true, false) => self.integrate_lattice(),
            (false, true) => self.integrate_band_by_four(),
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

    #[inline(never)]
    fn integrate_lattice_by_four(&mut self) {
        let cloud = cloud(&self.grid, &self.bins, &self.particles, &self.cuts);
        let density = densities(&self.particles);
        let Dofs { matrix, velocity, .. } = &mut self.dofs;
        matrix.clear();
        velocity.fill(SVector::zeros());
        let fits = Fits {
            moving: &self.basis,
            reconstruction: &self.reconstruction,
            cloud: &cloud,
            cells: 0..self.bins.occupied().len(),
        };
        let mut sink = |i: usize, q: SVector<T, D>| velocity[i] += q;
        let mut pairs = |i: usize, j: usize, mass| matrix.add(i, j, mass);
        at_fixed_points!(
            B,
            &self.basis,
            &self.grid,
            integrate_pairs(fits, &density, &mut sink, &mut pairs)
        );
    }

    #[inline(never)]
    fn integrate_band_by_four(&mut self) {
        let half_band = self.dofs.matrix.band_mut().half_band();
        let cloud = cloud(&self.grid, &self.bins, &self.particles, &self.cuts);
        let density = densities(&self.particles);
        let (basis, grid, reconstruction) = (&self.basis, &self.grid, &self.reconstruction);
        let occupied = self.bins.occupied();
        let (rows, momentum) = self.dofs.band_mut();
        let Spans {
            cells: spans,
            lengths,
            matrices,
            vectors,
            ..
        } = &mut self.spans;
        let (span, parallel) = share(spans, occupied.len(), lengths[1]);
        let work = (
            occupied,
            Windows::new(spans, matrices, rows, half_band + 1),
            Windows::new(spans, vectors, momentum, 1),
        );
        each_span(parallel, span, work, &|place, (cells, rows, momentum)| {
            let ((first, rows), (_, momentum)) = (rows.one(), momentum.one());
            let fits = Fits {
                moving: basis,
                reconstruction,
                cloud: &cloud,
                cells: place..place + cells.len(),
            };
            let mut sink = |i: usize, q: SVector<T, D>| momentum[i - first] += q;
            let mut matrix = |i: usize, j: usize, mass| {
                banded_row(rows, i - first, half_band)[half_band + j - i] += mass;
            };
            at_fixed_points!(
                B,
                basis,
                grid,
                integrate_pairs(fits, &density, &mut sink, &mut matrix)
            );
        });
        add_up(spans, matrices, rows, half_band + 1);
        add_up(spans, vectors, momentum, 1);
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
        let (span, parallel) = share(spans, occupied.len(), lengths[1]);
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
    fn lumped_mut(&mut self) -> (&mut [T], &mut [SVector<T, D>]) {
        (&mut self.lumped, &mut self.velocity)
    }

    fn band_mut(&mut self) -> (&mut [T], &mut [SVector<T, D>]) {
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

/// Densities of mass and momentum at each particle.
fn densities<T: Scalar, const D: usize, S, Q>(
    particles: &Particles<T, D, S, Q>,
) -> impl Fn(usize) -> MassMomentum<T, D> + '_ {
    let Particles {
        mass,
        velocity,
        volume,
        ..
    } = particles;
    move |p| {
        let density = mass[p] / volume[p];
        MassMomentum {
            mass: density,
            momentum: velocity[p] * density,
        }
    }
}
