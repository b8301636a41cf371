//! Stage 1: lumped mass and forces of the DOFs.

use nalgebra::{SMatrix, SVector};

use super::by_four;
use super::cell_sums::CellSums;
use super::ghost::lump_undetermined_cells;
use super::lanes::{self, Bodies, Fits, Pass, at_fixed_points};
use super::matrix::MassMatrix;
use super::pairs::Pairs;
use super::spans::{Spans, share};
use super::{FaceCondition, Forcing, Stepper, cloud};
use crate::basis::BasisFamily;
use crate::field::Pair;
use crate::grid::Grid;
use crate::law::LawSweep;
use crate::parallel::{PerSpan, Windows, add_up, each_span};
use crate::phase::Phase;
use crate::reconstruction::{Cloud, Point, Reconstruction, Stored, Values};
use crate::scalar::Scalar;

/// In one dimension: share of its mass that a DOF's diagonal must hold to be solved for with its neighbours. The share is the mean value of
/// its function over the particles: 2/3 in a full linear cell, nothing for a DOF that the first particle of a free end has
/// just come to see. Such a DOF would have to carry that particle's whole acceleration, one over the function's value
/// times as large, or round-off so magnified.
pub(super) const WEAK: f64 = 0.3;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    /// Masses and forces of the DOFs.
    pub(super) fn assemble(&mut self, forcing: &Forcing<T, D>) {
        if R::PLAIN {
            self.sum_masses_and_forces();
        } else {
            self.lump_mass();
            self.integrate_stress();
        }
        self.add_tractions(forcing);
        if !self.body_forces.is_empty() {
            self.add_body_forces();
        }
    }

    /// Both in one pass, where the particles are the points of both.
    #[inline(never)]
    fn sum_masses_and_forces(&mut self) {
        let (basis, grid, phase, particles) = (&self.basis, &self.grid, &self.phase, &self.particles);
        let Spans {
            particles: spans,
            lengths,
            scalars,
            vectors,
            ..
        } = &mut self.spans;
        let (span, parallel) = share::<D>(spans, particles.len(), lengths[0]);
        let work = (
            &particles.position[..],
            self.bins.cells(),
            (&particles.mass[..], &particles.volume[..]),
            (&particles.stress[..], &particles.phase[..]),
            Windows::new(spans, scalars, &mut self.dofs.mass, 1),
            Windows::new(spans, vectors, &mut self.dofs.force, 1),
        );
        each_span(parallel, span, work, &|_,
                                          (
            positions,
            cells,
            bodies,
            stresses,
            mass,
            force,
        )| {
            let ((first, mass), (_, force)) = (mass.one(), force.one());
            let force = &mut force[..mass.len()];
            if const { lanes::apply::<T, D, B>() } {
                let bodies_at = Bodies {
                    positions,
                    cells,
                    masses: bodies.0,
                };
                let felt = |p: usize, stress: &SMatrix<T, D, D>| {
                    if P::COUPLED {
                        phase.total_stress(stress, &stresses.1[p])
                    } else {
                        *stress
                    }
                };
                let material = (bodies.1, stresses.0);
                let mut sink = |i: usize, m, f| {
                    mass[i - first] += m;
                    force[i - first] -= f;
                };
                return Pass::new(basis, grid).sum_masses_and_forces(bodies_at, material, &felt, &mut sink);
            }
            let mut sums = CellSums::new(basis, grid);
            let mut sink = |i: usize, Pair(m, f)| {
                mass[i - first] += m;
                force[i - first] -= f;
            };
            let bodies = bodies.0.iter().zip(bodies.1);
            let stresses = stresses.0.iter().zip(stresses.1);
            let places = positions.iter().zip(cells);
            for (((x, cell), (&m, &volume)), (stress, data)) in places.zip(bodies).zip(stresses) {
                let weighted = if P::COUPLED {
                    phase.total_stress(stress, data) * volume
                } else {
                    *stress * volume
                };
                let part = |phi, gradient| Pair(m * phi, weighted * gradient);
                sums.add(cell, x, part, &mut sink);
            }
            sums.flush(&mut sink);
        });
        add_up(spans, scalars, &mut self.dofs.mass, 1);
        add_up(spans, vectors, &mut self.dofs.force, 1);
    }

    fn integrate_stress(&mut self) {
        let cloud = cloud(&self.grid, &self.bins, &self.particles, &self.cuts);
        let effective = &self.particles.stress;
        let by_four = self.by_four();
        let assembly = Assembly {
            by_four,
            basis: &self.basis,
            reconstruction: &mut self.reconstruction,
            cloud,
            spans: &mut self.spans,
            force: &mut self.dofs.force,
        };
        // Two closures rather than one with a branch: what a closure holds costs instructions even where it is not used.
        if P::COUPLED {
            let (phase, data) = (&self.phase, &self.particles.phase);
            assembly.internal_force(|p: usize| phase.total_stress(&effective[p], &data[p]));
        } else {
            assembly.internal_force(Stored(effective));
        }
        if by_four && !R::KEEPS_FITS {
            let reduced = self.spans.reduced.iter().sum();
            self.diagnostics.record_reduced(reduced);
        }
    }

    /// `m_i = sum_p m_p phi_i`, and `M_ij = sum_p m_p phi_i phi_j` where the reconstruction wants it, weak DOFs lumped or, beyond one
    /// dimension, tied.
    pub(super) fn lump_mass(&mut self) {
        if R::PARTICLE_MATRIX {
            self.assemble_particle_matrix();
        }
        if P::FLOWS {
            return self.sum_masses(false);
        }
        let (basis, grid, particles) = (&self.basis, &self.grid, &self.particles);
        let Spans {
            particles: spans,
            lengths,
            scalars,
            ..
        } = &mut self.spans;
        let (span, parallel) = share::<D>(spans, particles.len(), lengths[0]);
        let work = (
            &particles.position[..],
            self.bins.cells(),
            &particles.mass[..],
            Windows::new(spans, scalars, &mut self.dofs.mass, 1),
        );
        each_span(parallel, span, work, &|_, (positions, cells, masses, mass)| {
            let (first, mass) = mass.one();
            if const { lanes::apply_to_values::<T, D, B>() } {
                let bodies = Bodies {
                    positions,
                    cells,
                    masses,
                };
                return by_four::add_masses(basis, grid, bodies, first, mass);
            }
            let mut sink = |i: usize, m| mass[i - first] += m;
            let mut sums = CellSums::new(basis, grid);
            for ((x, cell), &m) in positions.iter().zip(cells).zip(masses) {
                sums.add(cell, x, |phi, _| m * phi, &mut sink);
            }
            sums.flush(&mut sink);
        });
        add_up(spans, scalars, &mut self.dofs.mass, 1);
    }

    fn assemble_particle_matrix(&mut self) {
        let bodies = Bodies {
            positions: &self.particles.position,
            cells: self.bins.cells(),
            masses: &self.particles.mass,
        };
        let matrix = &mut self.dofs.matrix;
        fill_with_pairs(&self.basis, &self.grid, bodies, &mut self.pairs, matrix);
        if D > 1 {
            self.tie_partly_filled_cells();
        }
        let space = (&self.basis, &self.grid, &self.bins);
        lump_undetermined_cells(space, &self.reconstruction, &mut self.dofs.matrix);
        self.dofs.matrix.complete(Some(T::lit(WEAK)));
    }

    fn add_tractions(&mut self, forcing: &Forcing<T, D>) {
        for k in 0..self.surface.len() {
            let point = &self.surface[k];
            let FaceCondition::Traction(traction) = forcing.face(point.face) else {
                continue;
            };
            if !point.loaded {
                continue;
            }
            let x = self.surface_position(point);
            let cell = self.bins.cell_of(point.particle);
            let load = traction * point.area;
            self.balance.load += load;
            let force = &mut self.dofs.force;
            self.basis
                .for_each(&self.grid, cell, &x, |i, phi, _| force[i] += load * phi);
        }
    }
}

/// `M_ij = sum_p m_p phi_i phi_j`, to be completed.
pub(super) fn fill_with_pairs<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    bodies: Bodies<'_, T, D>,
    pairs: &mut Pairs<T, D>,
    matrix: &mut MassMatrix<T, D>,
) {
    matrix.clear();
    if const { lanes::apply_to_values::<T, D, B>() } {
        return by_four::add_pairs(basis, grid, bodies, matrix);
    }
    let particles = bodies.positions.iter().zip(bodies.masses).zip(bodies.cells);
    for ((x, &mass), cell) in particles {
        pairs.turn_to(cell, matrix);
        basis.for_each(grid, cell, x, |i, phi, _| pairs.see(i, phi));
        pairs.add(mass);
    }
    pairs.flush(matrix);
}

/// What the internal force is made of.
pub(super) struct Assembly<'a, 'c, T: Scalar, const D: usize, B, R> {
    /// Four cells at a time.
    pub(super) by_four: bool,
    pub(super) basis: &'a B,
    pub(super) reconstruction: &'a mut R,
    pub(super) cloud: Cloud<'c, T, D>,
    pub(super) spans: &'a mut Spans<T, D>,
    pub(super) force: &'a mut [SVector<T, D>],
}

impl<T: Scalar, const D: usize, B: BasisFamily<T, D>, R: Reconstruction<T, D>> Assembly<'_, '_, T, D, B, R> {
    /// `f_i = -integral(sigma grad phi_i)`, the stress given per particle.
    pub(super) fn internal_force(self, stress: impl Values<T, SMatrix<T, D, D>> + Sync) {
        let (basis, cloud) = (self.basis, &self.cloud);
        let add =
            |point: &Point<T, D>, weighted: SMatrix<T, D, D>, force: &mut [SVector<T, D>], first: usize| {
                let sink = |i: usize, _, gradient| force[i - first] -= weighted * gradient;
                if point.moves {
                    basis.for_each(cloud.grid, &point.cell, &point.position, sink);
                } else {
                    basis.for_each_at_fixed_point(cloud.grid, &point.cell, &point.position, sink);
                }
            };
        if !R::BY_CELLS {
            let force = self.force;
            force.fill(SVector::zeros());
            return self.reconstruction.integrate(
                cloud,
                |p| stress.at(p),
                |point, weighted| add(point, weighted, force, 0),
            );
        }
        self.reconstruction.take_in_field(cloud, &stress);
        let reconstruction = &*self.reconstruction;
        let occupied = cloud.bins.occupied();
        let Spans {
            cells: spans,
            lengths,
            vectors,
            reduced,
            ..
        } = self.spans;
        let (span, parallel) = share::<D>(spans, occupied.len(), lengths[1]);
        reduced.fill(0);
        let work = (
            occupied,
            Windows::new(spans, vectors, self.force, 1),
            PerSpan(&mut reduced[..]),
        );
        let by_four = self.by_four;
        each_span(parallel, span, work, &|place, (cells, force, reduced)| {
            let (first, force) = force.one();
            if const { lanes::fit::<T, D, B, R>() } && by_four {
                let fits = Fits {
                    moving: basis,
                    reconstruction,
                    cloud,
                    cells: place..place + cells.len(),
                };
                // By value: a reference to the slice would be read anew for each DOF.
                let mut sink = move |i: usize, f| force[i - first] -= f;
                let found =
                    at_fixed_points!(B, basis, cloud.grid, integrate_stress(fits, &stress, &mut sink));
                return reduced.set(found);
            }
            reconstruction.integrate_cells(
                cloud,
                place..place + cells.len(),
                |p| stress.at(p),
                |point, weighted| {
                    add(point, weighted, force, first);
                },
            );
        });
        add_up(spans, vectors, self.force, 1);
    }
}
