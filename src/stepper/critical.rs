//! The critical time step of the scheme as it stands.

use nalgebra::{SMatrix, SVector};

use super::acceleration::{Walls, accelerate};
use super::diffusion::{critical_diffusion, diffusion_geometry};
use super::inner::{Given, Inner};
use super::sweeps::Sweeps;
use super::velocity::divide_by_mass;
use super::waves::{Waves, smaller};
use super::{FaceCondition, Forcing, Stepper, SurfacePoint};
use crate::basis::BasisFamily;
use crate::grid::{Cell, Face, Grid};
use crate::law::LawSweep;
use crate::parallel::{PARTICLES, each_span, many_threads};
use crate::phase::Phase;
use crate::reconstruction::{Reconstruction, Streams};
use crate::scalar::Scalar;
use crate::transfer::Transfer;

/// What limits a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mechanism {
    /// A wave that crosses a cell.
    Wave,
    /// The drag between solid and liquid, taken explicitly.
    Drag,
    /// What diffuses gets from particle to particle.
    Diffusion,
}

/// The largest stable step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriticalStep<T> {
    /// Its size (s).
    pub step: T,
    /// What limits it.
    pub mechanism: Mechanism,
}

/// Strain by which the law's tangent is probed.
pub(super) const PROBE_STRAIN: f64 = 1e-3;
/// Iterations over which the eigenvalue must settle. The change in one is no sign: a mode of a partly filled
/// end cell, of which the start has little, grows unseen below the others for a while.
const STRIDE: usize = 40;
/// Share of `(c / h)^2`, `c` the wave speed, below which an eigenvalue is round-off: particles of which no
/// two share a DOF that strains them.
const ROUND_OFF: f64 = 1e-10;
/// Relative change over a stride below which it has settled.
const TOLERANCE: f64 = 1e-5;
const MOST_ITERATIONS: usize = 400;
/// Particles on which a stiffness is found that nothing bounds: less than a second's work in space.
const SAMPLE: usize = 4096;

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D> + Clone,
    L: LawSweep<T, D> + Clone,
    P: Phase<T, D> + Clone,
    X: Transfer<T, D>,
{
    /// Largest step (s) at which the linearised scheme does not grow, for the particles where they are.
    ///
    /// One step maps particle velocities to DOF velocities, strains, stress rates, forces and back to
    /// particle accelerations: `dv/dt = -G` applied to the time integral of `v`. Euler-Cromer is stable up
    /// to `2 / sqrt(lambda)`, `lambda` the largest eigenvalue of `G`, found here by power iteration on the
    /// scheme's own stages, so it holds for every basis, reconstruction, mass, law and layout. `None` if
    /// nothing resists a motion (no stiffness).
    ///
    /// With a liquid that flows the same iteration, with unit density and modulus, gives what grid, basis,
    /// reconstruction and layout contribute, and the two-phase problem is solved with it for every particle's
    /// material; the least step counts.
    ///
    /// In a phase that diffuses no more than twice one over the proved bound of its largest eigenvalue
    /// (`docs/theory/diffusion.md`).
    ///
    /// `None` too for a transfer from the grid ([`Transfer::FROM_GRID`]): what particles keep of a velocity
    /// decides there, and no bound of it is known here.
    pub fn critical_step(&self, forcing: &Forcing<T, D>) -> Option<CriticalStep<T>> {
        self.clone().into_critical_step(forcing)
    }

    /// [`Stepper::critical_step`] without a copy; the stepper is used up.
    // Out of line, as all that is asked once in a run: a stepper is compiled for every method.
    #[inline(never)]
    pub fn into_critical_step(mut self, forcing: &Forcing<T, D>) -> Option<CriticalStep<T>> {
        critical_step(&mut self, forcing)
    }

    /// Stiffness (1/m2) of the layout for [`Stepper::largest_step`]: [`Stepper::stiffness_bound`] where that
    /// is proved, otherwise the largest eigenvalue for waves of 1 m/s, by power iteration, of a sample of
    /// some thousand particles: those in the cells about a corner of the bodies, or all where they are few.
    /// `None` if nothing resists a motion. In a phase that diffuses at least what that contributes, so that
    /// [`Stepper::largest_step`] bounds it too.
    ///
    /// Fits and consistent masses have no bound that is of use: a cell of which particles fill a part may be
    /// a hundred times as stiff as a full one, or a mass matrix next to singular.
    ///
    /// `None` too for a transfer from the grid, as [`Stepper::critical_step`].
    pub fn stiffness(&mut self, forcing: &Forcing<T, D>) -> Option<T> {
        if const { X::FROM_GRID } {
            return None;
        }
        if const { R::Points::AT_PARTICLES } {
            return Some(self.stiffness_bound(forcing));
        }
        let waves = self.stiffness_of_sample(forcing);
        if const { !P::DIFFUSES } {
            return waves;
        }
        self.prepare();
        let diffusion = diffusion_geometry(self);
        Some(waves.map_or(diffusion, |waves| waves.max(diffusion)))
    }

    fn stiffness_of_sample(&self, forcing: &Forcing<T, D>) -> Option<T> {
        stiffness_of(&mut self.sample()?, forcing)
    }

    /// A stepper of the particles about a corner.
    fn sample(&self) -> Option<Self> {
        if self.inner.particles.position.len() <= SAMPLE {
            return Some(self.clone());
        }
        let given = self.inner.sampled()?;
        let (basis, reconstruction) = (self.basis.clone(), self.reconstruction.clone());
        Self::of_parts(basis, reconstruction, self.velocity_mass, given).ok()
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Change of the particles' total stress under the velocities of the DOFs in one second.
    pub(super) fn stress_rates<B: BasisFamily<T, D>>(&self, basis: &B) -> Vec<SMatrix<T, D, D>> {
        let space = (basis, &self.grid, self.bins.cells());
        stress_rates(space, &self.waves(), &self.dofs.velocity)
    }

    /// The particles with what they are made of.
    pub(super) fn waves(&self) -> Waves<'_, T, D, L, P> {
        Waves {
            law: &self.law,
            phase: &self.phase,
            particles: &self.particles,
        }
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D> + Clone,
    P: Phase<T, D> + Clone,
    X: Transfer<T, D>,
{
    /// What a stepper of the particles about a corner is made of.
    #[inline(never)]
    fn sampled(&self) -> Option<Given<T, D, L, P, X>> {
        let (numbers, surface) = about_corner(self.bins.cells(), &self.surface)?;
        Some(Given {
            grid: self.grid.clone(),
            law: self.law.clone(),
            phase: self.phase.clone(),
            transfer: self.transfer.clone(),
            particles: self.particles.picked(&numbers, self.law.numbers()),
            memory: Vec::new(),
            surface,
        })
    }
}

/// Any stepper.
type Any<'s, T, const D: usize, L, P, X> = &'s mut dyn Sweeps<T, D, L, P, X>;

/// See [`Stepper::critical_step`]; velocities and DOFs are used up.
#[inline(never)]
pub(super) fn critical_step<T, const D: usize, L, P, X>(
    stepper: Any<'_, T, D, L, P, X>,
    forcing: &Forcing<T, D>,
) -> Option<CriticalStep<T>>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    if const { X::FROM_GRID } {
        return None;
    }
    if const { P::FLOWS } {
        let geometry = eigenvalue_of_unit_density(stepper, forcing)?;
        return stepper.inner().waves().critical_step_of_both(geometry);
    }
    let diffusion = match const { P::DIFFUSES } {
        true => critical_diffusion(stepper),
        false => None,
    };
    let speed = stepper.inner().waves().largest_speed();
    let wave = largest_eigenvalue(stepper, forcing, speed).map(|eigenvalue| CriticalStep {
        step: T::lit(2.0) / eigenvalue.sqrt(),
        mechanism: Mechanism::Wave,
    });
    [wave, diffusion].into_iter().flatten().reduce(smaller)
}

/// Largest eigenvalue for waves of 1 m/s; velocities and DOFs are used up.
#[inline(never)]
fn stiffness_of<T, const D: usize, L, P, X>(
    stepper: Any<'_, T, D, L, P, X>,
    forcing: &Forcing<T, D>,
) -> Option<T>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    if const { P::FLOWS } {
        return eigenvalue_of_unit_density(stepper, forcing);
    }
    let speed = stepper.inner().waves().largest_speed();
    Some(largest_eigenvalue(stepper, forcing, speed)? / (speed * speed))
}

/// Largest eigenvalue for unit density and modulus; velocities and DOFs are used up.
fn eigenvalue_of_unit_density<T, const D: usize, L, P, X>(
    stepper: Any<'_, T, D, L, P, X>,
    forcing: &Forcing<T, D>,
) -> Option<T>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    let particles = &mut stepper.inner().particles;
    let unit_density = particles.volume.clone();
    let mass = std::mem::replace(&mut particles.mass, unit_density);
    let eigenvalue = largest_eigenvalue(stepper, forcing, T::one());
    stepper.inner().particles.mass = mass;
    eigenvalue
}

/// Largest eigenvalue of the map, `None` if it is nothing to a wave of the given `speed`; velocities and DOFs
/// are used up.
fn largest_eigenvalue<T, const D: usize, L, P, X>(
    stepper: Any<'_, T, D, L, P, X>,
    forcing: &Forcing<T, D>,
    speed: T,
) -> Option<T>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    let h = stepper.inner().grid.cell_size().min();
    let across = speed / h;
    let least = across * across * T::lit(ROUND_OFF);
    stepper.prepare();
    stepper.sum_solid_masses();
    let rest = at_rest(forcing);
    let scale = h.is_finite().then(|| h * T::lit(PROBE_STRAIN))?;
    excite(&mut stepper.inner().particles.velocity);
    let (mut before, mut eigenvalue) = (T::zero(), T::zero());
    for iteration in 0..MOST_ITERATIONS {
        normalise(&mut stepper.inner().particles.velocity, scale)?;
        eigenvalue = apply(stepper, &rest, scale)?;
        if iteration % STRIDE == STRIDE - 1 {
            if (eigenvalue - before).abs() <= T::lit(TOLERANCE) * eigenvalue {
                break;
            }
            before = eigenvalue;
        }
    }
    (eigenvalue > least).then_some(eigenvalue)
}

/// Replaces the velocities `v` by `G v` and returns `|G v| / |v|`, `|v| = size`.
fn apply<T, const D: usize, L, P, X>(
    stepper: Any<'_, T, D, L, P, X>,
    rest: &Forcing<T, D>,
    size: T,
) -> Option<T>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    stepper.map_solid();
    let inner = stepper.inner();
    let walls = Walls::of_solid(&inner.face_dofs, rest);
    divide_by_mass(&mut inner.dofs, inner.mass, &walls, true);
    stepper.map_stress_rates();
    let inner = stepper.inner();
    let walls = Walls::of_solid(&inner.face_dofs, rest);
    accelerate(&mut inner.dofs, inner.mass, &walls, &mut inner.balance);
    inner.particles.velocity.fill(SVector::zeros());
    stepper.kick_solid(-T::one());
    let eigenvalue = rms(&stepper.inner().particles.velocity) / size;
    eigenvalue.is_finite().then_some(eigenvalue)
}

/// The particles about a corner, and what of the surface is theirs.
#[inline(never)]
fn about_corner<T: Scalar, const D: usize>(
    cells: &[Cell<D>],
    surface: &[SurfacePoint<T>],
) -> Option<(Vec<usize>, Vec<SurfacePoint<T>>)> {
    // By coordinates: a particle that has just strayed is in a cell without a number.
    let last_axis_first = |cell: &&Cell<D>| {
        let mut order = **cell;
        order.reverse();
        order
    };
    let corner = cells.iter().min_by_key(last_axis_first)?;
    let distance = |cell: &Cell<D>| {
        cell.iter()
            .zip(corner)
            .map(|(a, b)| a.abs_diff(*b))
            .max()
            .unwrap_or(0)
    };
    let mut distances: Vec<u32> = cells.iter().map(distance).collect();
    let (_, &mut reach, _) = distances.select_nth_unstable(SAMPLE);
    // Cells at the distance that is reached last come in whole or not at all, and the corner's own in any case.
    let numbers: Vec<usize> = (0..cells.len())
        .filter(|&p| distance(&cells[p]) < reach.max(1))
        .collect();
    let mut surface = surface.to_vec();
    surface.retain_mut(|point| match numbers.binary_search(&point.particle) {
        Ok(number) => {
            point.particle = number;
            true
        }
        Err(_) => false,
    });
    Some((numbers, surface))
}

/// The same constraints with every told value zero, and no load.
pub(super) fn at_rest<T: Scalar, const D: usize>(forcing: &Forcing<T, D>) -> Forcing<T, D> {
    let mut rest = Forcing::none();
    for face in Face::all::<D>() {
        if let FaceCondition::Held { held, .. } = *forcing.face(face) {
            let zero = SVector::zeros();
            let (velocity, acceleration) = (zero, zero);
            rest.set_face(
                face,
                FaceCondition::Held {
                    held,
                    velocity,
                    acceleration,
                },
            );
        }
    }
    rest
}

/// Velocities of a fixed sequence of signs and sizes that excites every mode.
#[inline(never)]
fn excite<T: Scalar, const D: usize>(velocities: &mut [SVector<T, D>]) {
    let mut seed = 1_u32;
    for v in velocities {
        for component in v.iter_mut() {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *component = T::lit(f64::from(seed >> 8) / f64::from(1 << 23) - 1.0);
        }
    }
}

/// Scales velocities to the root mean square `size`.
#[inline(never)]
fn normalise<T: Scalar, const D: usize>(velocities: &mut [SVector<T, D>], size: T) -> Option<()> {
    let norm = rms(velocities);
    if !(norm > T::zero() && norm.is_finite()) {
        return None;
    }
    for v in velocities {
        *v *= size / norm;
    }
    Some(())
}

/// Change of the particles' total stress under the `velocities` of the DOFs in one second.
#[inline(never)]
fn stress_rates<T: Scalar, const D: usize, B, L, P>(
    space: (&B, &Grid<T, D>, &[Cell<D>]),
    waves: &Waves<'_, T, D, L, P>,
    velocities: &[SVector<T, D>],
) -> Vec<SMatrix<T, D, D>>
where
    B: BasisFamily<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    let (basis, grid, cells) = space;
    let sites = waves.particles.sites(cells);
    let mut rates = vec![SMatrix::zeros(); cells.len()];
    let parallel = rates.len() > PARTICLES && many_threads();
    each_span(parallel, PARTICLES, &mut rates[..], &|first, rates: &mut [_]| {
        let mut state = Vec::with_capacity(waves.law.numbers());
        for (p, rate) in (first..).zip(rates) {
            let mut gradient = SMatrix::<T, D, D>::zeros();
            sites.for_each(basis, grid, p, |i, _, grad_phi| {
                gradient += velocities[i] * grad_phi.transpose();
            });
            *rate = waves.stress_rate(p, &gradient, &mut state);
        }
    });
    rates
}

fn rms<T: Scalar, const D: usize>(values: &[SVector<T, D>]) -> T {
    let sum = values.iter().fold(T::zero(), |s, v| s + v.norm_squared());
    (sum / T::count(values.len())).sqrt()
}
