//! Velocities that come back from the grid: momenta to the DOFs, the kick there, G2P.
//!
//! $m_i v_i = \sum_p m_p\phi_i(x_p)\,(v_p + G_p(x_i - x_p))$, $v_i \mathrel{+}= \Delta t\,a_i$ or the wall's
//! velocity, and then each particle takes what it sees ([`Transfer::take`]). Mass and momentum are kept:
//! $\sum_i\phi_i = 1$ and $\sum_i\phi_i(x_i - x) = 0$.

use nalgebra::{SMatrix, SVector};

use super::acceleration::Walls;
use super::balance::Balance;
use super::dofs::Dofs;
use super::forcing::Forcing;
use super::inner::{Inner, Kind};
use super::spans::{Spans, Totals, share};
use super::sums::{InSpan, Targets};
use super::velocity::divide;
use super::{FaceCondition, Stepper};
use crate::basis::BasisFamily;
use crate::error::{SetupError, StepError};
use crate::grid::{Face, Grid};
use crate::law::LawSweep;
use crate::mass::Divisor;
use crate::parallel::{PARTICLES, PerSpan, each_span, worth_sharing};
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::simd::{Packs, each};
use crate::transfer::{
    Contribution, DofPlaces, GridVelocity, Group, Momentum, Parts, Receive, Seen, Sites, Transfer, gather,
    p2g,
};

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Velocities of the DOFs from those of the particles, kicked by the accelerations. Compares what was
    /// mapped with what the particles have.
    pub(super) fn map_and_kick_dofs(&mut self, dt: T, forcing: &Forcing<T, D>) {
        let before = self.inner.momentum_before();
        if const { X::AFFINE } {
            self.inner.sum_affine_momenta(&self.basis);
        } else {
            self.map_solid();
        }
        let mapped = self.inner.mapped_totals();
        self.inner.record(&before, mapped);
        let walls = Walls::of_solid(&self.inner.face_dofs, forcing);
        kick_dofs(&mut self.inner.dofs, dt, &walls, &mut self.inner.balance);
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Momentum of the particles before they take another, span by span as it will be summed again.
    fn momentum_before(&mut self) -> Totals<T, D> {
        let (velocities, masses) = (&self.particles.velocity[..], &self.particles.mass[..]);
        let parallel = worth_sharing::<D>(velocities.len(), PARTICLES);
        let totals = &mut self.spans.totals;
        totals.fill(Totals::zero());
        let work = (velocities, masses, PerSpan(&mut totals[..]));
        each_span(parallel, PARTICLES, work, &|_, (velocities, masses, found)| {
            let mut momentum = Momentum::zero();
            for (velocity, &mass) in velocities.iter().zip(masses) {
                momentum = momentum.with(&momentum_of(velocity, mass));
            }
            found.set(totals_of(momentum));
        });
        self.spans.total()
    }

    /// Momenta of the DOFs from velocities that are linear functions about each particle.
    #[inline(never)]
    fn sum_affine_momenta<B: BasisFamily<T, D>>(&mut self, basis: &B) {
        let Spans {
            particles: windows,
            lengths,
            store,
            ..
        } = &mut self.spans;
        let particles = &self.particles;
        let mut momenta = Targets::<'_, T, D, 0, 1, 0>::of_momenta([&mut self.dofs.velocity[..]]);
        let (span, parallel) = share::<D>(windows, particles.len(), lengths[0]);
        let (basis, grid, transfer, places) = (basis, &self.grid, &self.transfer, &self.places);
        let work = (
            particles.sites(self.bins.cells()),
            (&particles.mass[..], &particles.velocity[..], &self.memory[..]),
            store.windows(windows, &mut momenta),
        );
        each_span(parallel, span, work, &|_,
                                          (
            points,
            (masses, velocities, memory),
            windows,
        )| {
            let affine = Affine {
                masses,
                velocities,
                memory,
                transfer,
                places,
            };
            let mut sums = InSpan::<T, D, 0, 1, 0>::new(windows);
            p2g::<_, D, _, 0, 1, 1>(basis, grid, points, affine, move |dof, sum| {
                sums.add_vector(dof, sum.vectors[0] + sum.forces[0]);
            });
        });
        store.add_up(windows, &mut momenta);
    }

    /// Lets the particles take their velocities from the DOFs; returns their totals then.
    #[inline(never)]
    pub(super) fn take_from_grid<B: BasisFamily<T, D>>(&mut self, basis: &B, dt: T) -> Totals<T, D> {
        let particles = &mut self.particles;
        let parallel = worth_sharing::<D>(particles.position.len(), PARTICLES);
        let totals = &mut self.spans.totals;
        totals.fill(Totals::zero());
        let (basis, grid, transfer, places) = (basis, &self.grid, &self.transfer, &self.places);
        let fields = [&self.dofs.velocity[..], &self.dofs.force[..]];
        let work = (
            Sites {
                positions: &particles.position,
                cells: self.bins.cells(),
                domains: particles.domains.views(),
            },
            (
                &particles.mass[..],
                &mut particles.velocity[..],
                &mut self.memory[..],
            ),
            PerSpan(&mut totals[..]),
        );
        each_span(parallel, PARTICLES, work, &|_,
                                               (
            points,
            (masses, velocities, memory),
            found,
        )| {
            let takers = Takers {
                masses,
                velocities,
                memory,
                transfer,
                dt,
                cell_size: *grid.cell_size(),
                momentum: Momentum::zero(),
            };
            let takers = gather(basis, grid, points, fields, places, takers);
            found.set(totals_of(takers.momentum));
        });
        self.spans.total()
    }
}

/// Momenta of the DOFs to velocities, kicked by their accelerations or as walls prescribe; notes what the
/// walls gave, and what each DOF was accelerated by.
#[inline(never)]
fn kick_dofs<T: Scalar, const D: usize>(
    dofs: &mut Dofs<T, D>,
    dt: T,
    walls: &Walls<'_, T, D>,
    balance: &mut Balance<T, D>,
) {
    divide(&mut dofs.velocity, &dofs.mass);
    for (velocity, acceleration) in dofs.velocity.iter_mut().zip(&dofs.force) {
        *velocity += acceleration * dt;
    }
    walls.for_each_held(|dof, axis, velocity, _| {
        let jump = (velocity - dofs.velocity[dof][axis]) / dt;
        dofs.velocity[dof][axis] = velocity;
        dofs.force[dof][axis] += jump;
        balance.reaction[axis] += jump * dofs.mass[dof];
    });
}

fn momentum_of<T: Scalar, const D: usize>(velocity: &SVector<T, D>, mass: T) -> Momentum<T, D> {
    Momentum {
        momentum: velocity * mass,
        scale: velocity.norm() * mass,
    }
}

fn totals_of<T: Scalar, const D: usize>(momentum: Momentum<T, D>) -> Totals<T, D> {
    let mut total = Totals::zero();
    total.momenta[0] = momentum;
    total
}

/// Momenta of particles whose velocities are linear functions of place.
struct Affine<'a, T: Scalar, const D: usize, X: Transfer<T, D>> {
    masses: &'a [T],
    velocities: &'a [SVector<T, D>],
    memory: &'a [X::Particle],
    transfer: &'a X,
    places: &'a DofPlaces<T, D>,
}

impl<T: Scalar, const D: usize, X: Transfer<T, D>> Clone for Affine<'_, T, D, X> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Scalar, const D: usize, X: Transfer<T, D>> Copy for Affine<'_, T, D, X> {}

impl<T: Scalar, const D: usize, X: Transfer<T, D>> Contribution<T, D, 0, 1, 1> for Affine<'_, T, D, X> {
    #[inline(always)]
    fn cut(self, count: usize) -> Self {
        Self {
            masses: &self.masses[..count],
            velocities: &self.velocities[..count],
            memory: &self.memory[..count],
            ..self
        }
    }

    #[inline(always)]
    fn places(&self) -> Option<&DofPlaces<T, D>> {
        Some(self.places)
    }

    #[inline(always)]
    fn parts<K: Packs<T, N>, const N: usize, const FULL: bool>(
        &self,
        k: K,
        group: Group<N>,
        _slopes: &[K::V; D],
    ) -> Parts<K::V, D, 0, 1, 1> {
        let mass = group.amounts::<FULL, T, K>(k, self.masses);
        let velocity = group.vectors::<FULL, T, K, D>(k, self.velocities);
        let gradients: [SMatrix<T, D, D>; N] = each(
            #[inline(always)]
            |l| self.transfer.gradient(&self.memory[group.particle(l)]),
        );
        let gradient = Group::<N>::tensors(k, &gradients);
        Parts {
            scalars: [],
            vectors: [each(
                #[inline(always)]
                |c| velocity[c] * mass,
            )],
            tensors: [each(
                #[inline(always)]
                |c| {
                    each(
                        #[inline(always)]
                        |a| gradient[c][a] * mass,
                    )
                },
            )],
        }
    }
}

/// The particles of a span, which take their velocities from the grid.
struct Takers<'a, T: Scalar, const D: usize, X: Transfer<T, D>> {
    masses: &'a [T],
    velocities: &'a mut [SVector<T, D>],
    memory: &'a mut [X::Particle],
    transfer: &'a X,
    dt: T,
    cell_size: SVector<T, D>,
    momentum: Momentum<T, D>,
}

impl<T: Scalar, const D: usize, X: Transfer<T, D>> Receive<T, D> for Takers<'_, T, D, X> {
    #[inline(always)]
    fn cut(self, count: usize) -> Self {
        Self {
            masses: &self.masses[..count],
            velocities: &mut self.velocities[..count],
            memory: &mut self.memory[..count],
            ..self
        }
    }

    #[inline(always)]
    fn take<K: Packs<T, N>, const N: usize, const FULL: bool>(
        &mut self,
        k: K,
        group: Group<N>,
        seen: &Seen<K::V, D>,
    ) {
        let velocity = vector_lanes(k, &seen.velocity);
        let acceleration = vector_lanes(k, &seen.acceleration);
        let second_moment = vector_lanes(k, &seen.second_moment);
        let gradient = tensor_lanes(k, &seen.gradient);
        let moment = tensor_lanes(k, &seen.moment);
        for l in 0..group.count {
            let p = group.first + l;
            let seen = GridVelocity {
                dt: self.dt,
                velocity: velocity[l],
                acceleration: acceleration[l],
                gradient: gradient[l],
                moment: moment[l],
                second_moment: second_moment[l],
                cell_size: self.cell_size,
            };
            self.transfer
                .take(&seen, &mut self.velocities[p], &mut self.memory[p]);
            let own = momentum_of(&self.velocities[p], self.masses[p]);
            self.momentum = self.momentum.with(&own);
        }
    }
}

/// The vector of each lane.
#[inline(always)]
fn vector_lanes<T: Scalar, K: Packs<T, N>, const N: usize, const D: usize>(
    k: K,
    packs: &[K::V; D],
) -> [SVector<T, D>; N] {
    let components: [[T; N]; D] = each(
        #[inline(always)]
        |c| k.array(packs[c]),
    );
    each(
        #[inline(always)]
        |l| SVector::from_fn(|c, _| components[c][l]),
    )
}

/// The tensor of each lane.
#[inline(always)]
fn tensor_lanes<T: Scalar, K: Packs<T, N>, const N: usize, const D: usize>(
    k: K,
    packs: &[[K::V; D]; D],
) -> [SMatrix<T, D, D>; N] {
    let components: [[[T; N]; D]; D] = each(
        #[inline(always)]
        |c| {
            each(
                #[inline(always)]
                |a| k.array(packs[c][a]),
            )
        },
    );
    each(
        #[inline(always)]
        |l| SMatrix::from_fn(|c, a| components[c][a][l]),
    )
}

/// Places of the DOFs, where the transfer or the mass asks for them.
pub(super) fn dof_places<T, const D: usize, B, X>(
    basis: &B,
    grid: &Grid<T, D>,
    mass: Divisor,
) -> Result<DofPlaces<T, D>, SetupError>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    X: Transfer<T, D>,
{
    let reason = "a basis that is a product along the axes and reproduces linear functions";
    if const { X::FROM_GRID } {
        DofPlaces::of(basis, grid).ok_or(SetupError::FromGrid { reason })
    } else if const { D > 1 } && mass.is_series() {
        DofPlaces::of(basis, grid).ok_or(SetupError::NoPlaces)
    } else {
        Ok(DofPlaces::none())
    }
}

/// Refuses what a transfer from the grid does not serve.
pub(super) fn refuse_what_it_cannot<T, const D: usize, P, X>(kind: Kind) -> Result<(), SetupError>
where
    T: Scalar,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    let reason = if P::FLOWS {
        "one phase: a liquid that flows has velocities of its own"
    } else if kind.filters || kind.mass.is_in_acceleration() {
        "lumped masses and a velocity that nothing relaxes"
    } else if kind.mass != Divisor::Particles {
        "masses that are sums over the particles: these would not take back what a fit changed"
    } else {
        return Ok(());
    };
    match const { X::FROM_GRID } {
        true => Err(SetupError::FromGrid { reason }),
        false => Ok(()),
    }
}

/// Refuses walls whose impulses go to the particles.
pub(super) fn refuse_walls_that_rub<T: Scalar, const D: usize>(
    forcing: &Forcing<T, D>,
) -> Result<(), StepError> {
    let rubs = |face: &Face| matches!(forcing.face(*face), FaceCondition::Frictional { .. });
    match Face::all::<D>().find(rubs) {
        Some(face) => Err(StepError::FrictionFromGrid { face }),
        None => Ok(()),
    }
}
