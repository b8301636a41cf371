//! Check of a velocity transfer.

use nalgebra::{SMatrix, SVector};

use super::failure::{Failure, Place, Property, near};
use crate::basis::{BSpline, BasisFamily};
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;
use crate::transfer::{DofPlaces, GridVelocity, Transfer};

/// What a transfer claims.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TransferClaims {
    /// A velocity that is a linear function of place comes back as it was, as with APIC; if not claimed it
    /// must not.
    pub keeps_linear_velocities: bool,
}

/// Cells along each axis.
const CELLS: usize = 4;
/// Length of the kick (s).
const STEP: f64 = 0.01;

/// Checks that `transfer` gives particles no velocity that is not the grid's: a uniform motion stays one
/// under a uniform acceleration, and what particles remember then adds nothing to it; the momentum of the
/// particles is that of the DOFs; a linear velocity comes back if, and only if, that is claimed. A transfer
/// that is not [from the grid](Transfer::FROM_GRID) has nothing to be checked.
///
/// The particles lie in two cells an axis among quadratic B-splines, at uneven places and with uneven masses.
///
/// # Errors
/// The first property that does not hold, or holds although it is claimed not to.
pub fn check_transfer<T: Scalar, const D: usize, X: Transfer<T, D>>(
    transfer: &X,
    claims: &TransferClaims,
) -> Result<(), Failure>
where
    BSpline<2>: BasisFamily<T, D>,
{
    if !X::FROM_GRID {
        return Ok(());
    }
    let world = World::new().ok_or(Failure {
        property: Property::PointsInGrid,
        place: Place::Everywhere,
        expected: super::Expected::AtLeast(1.0),
        found: 0.0,
    })?;
    keeps_uniform(transfer, &world)?;
    keeps_momentum(transfer, &world)?;
    linear(transfer, &world, claims.keeps_linear_velocities)
}

/// Particles among DOFs.
struct World<T, const D: usize> {
    grid: Grid<T, D>,
    places: DofPlaces<T, D>,
    positions: Vec<SVector<T, D>>,
    cells: Vec<Cell<D>>,
    masses: Vec<T>,
}

/// Velocities of particles, with what a transfer remembers of each.
type State<T, const D: usize, X> = (Vec<SVector<T, D>>, Vec<<X as Transfer<T, D>>::Particle>);

impl<T: Scalar, const D: usize> World<T, D>
where
    BSpline<2>: BasisFamily<T, D>,
{
    /// `None` if the scalar cannot tell the particles' cells or the places of the DOFs: then nothing is
    /// checked.
    fn new() -> Option<Self> {
        let size = T::count(CELLS);
        let grid = Grid::new(SVector::zeros(), SVector::repeat(size), [CELLS; D]).ok()?;
        let places = DofPlaces::of(&BSpline::<2>, &grid)?;
        let count = 6_usize.pow(D as u32);
        // Six an axis in the inner half, each beside its place by a part of the spacing that repeats nowhere.
        let place = |p: usize, a: usize| {
            let along = p / 6_usize.pow(a as u32) % 6;
            let beside = ((p * p * 7 + 3 * p + 5 * a + 2) % 11) as f64 / 11.0;
            T::lit(1.0 + (along as f64 + beside) / 3.0)
        };
        let positions: Vec<_> = (0..count).map(|p| SVector::from_fn(|a, _| place(p, a))).collect();
        let cells = positions.iter().map(|x| grid.locate(x)).collect::<Option<_>>()?;
        let masses = (0..count).map(|p| T::lit(1.0 + (p % 5) as f64 / 4.0)).collect();
        Some(Self {
            grid,
            places,
            positions,
            cells,
            masses,
        })
    }

    fn each_dof(&self, p: usize, f: impl FnMut(usize, T, SVector<T, D>)) {
        BSpline::<2>.for_each(&self.grid, &self.cells[p], &self.positions[p], f);
    }

    /// Masses of the DOFs, and their velocities after a kick by the acceleration that `kick` says of each.
    fn mapped<X: Transfer<T, D>>(
        &self,
        transfer: &X,
        (velocities, memory): &State<T, D, X>,
        kick: impl Fn(usize) -> SVector<T, D>,
    ) -> (Vec<T>, Vec<SVector<T, D>>) {
        let count = BSpline::<2>.dof_count(&self.grid);
        let (mut masses, mut momenta) = (vec![T::zero(); count], vec![SVector::<T, D>::zeros(); count]);
        for p in 0..self.positions.len() {
            let affine = match X::AFFINE {
                true => transfer.gradient(&memory[p]),
                false => SMatrix::zeros(),
            };
            self.each_dof(p, |i, phi, _| {
                let offset = self.offset(p, i);
                masses[i] += phi * self.masses[p];
                momenta[i] += (velocities[p] + affine * offset) * (phi * self.masses[p]);
            });
        }
        for (i, (momentum, &mass)) in momenta.iter_mut().zip(&masses).enumerate() {
            let velocity = match mass > T::zero() {
                true => *momentum / mass,
                false => SVector::zeros(),
            };
            *momentum = velocity + kick(i) * T::lit(STEP);
        }
        (masses, momenta)
    }

    /// Lets each particle take its velocity.
    fn taken<X: Transfer<T, D>>(
        &self,
        transfer: &X,
        dofs: &[SVector<T, D>],
        kick: impl Fn(usize) -> SVector<T, D>,
        (velocities, memory): &mut State<T, D, X>,
    ) {
        for p in 0..self.positions.len() {
            let mut seen = GridVelocity::none(T::lit(STEP), *self.grid.cell_size());
            self.each_dof(p, |i, phi, gradient| {
                let offset = self.offset(p, i);
                seen.see(phi, &gradient, &offset, (&dofs[i], &kick(i)));
            });
            transfer.take(&seen, &mut velocities[p], &mut memory[p]);
        }
    }

    /// From a particle to a DOF.
    fn offset(&self, p: usize, dof: usize) -> SVector<T, D> {
        self.places
            .offset(&self.grid, dof, (&self.cells[p], &self.positions[p]))
    }

    fn state<X: Transfer<T, D>>(&self, velocity: impl Fn(&SVector<T, D>) -> SVector<T, D>) -> State<T, D, X> {
        let velocities = self.positions.iter().map(velocity).collect();
        (velocities, vec![X::Particle::default(); self.positions.len()])
    }

    fn compare(
        &self,
        property: Property,
        expected: &SVector<T, D>,
        found: &SVector<T, D>,
        p: usize,
    ) -> Result<(), Failure> {
        for a in 0..D {
            let place = || Place::point(&self.positions[p]);
            near(property, place, expected[a], found[a], round_off())?;
        }
        Ok(())
    }
}

/// Of sums over the DOFs of a particle, of velocities of size one.
fn round_off<T: Scalar>() -> T {
    T::lit(1024.0) * T::default_epsilon()
}

/// A velocity of size one.
fn uniform<T: Scalar, const D: usize>() -> SVector<T, D> {
    SVector::from_fn(|a, _| T::lit(0.75 - 0.5 * a as f64))
}

fn uneven<T: Scalar, const D: usize>(n: usize) -> SVector<T, D> {
    SVector::from_fn(|a, _| T::lit(((n * n * 5 + 3 * n + 7 * a + 1) % 13) as f64 / 6.0 - 1.0))
}

fn keeps_uniform<T: Scalar, const D: usize, X: Transfer<T, D>>(
    transfer: &X,
    world: &World<T, D>,
) -> Result<(), Failure>
where
    BSpline<2>: BasisFamily<T, D>,
{
    let (before, kick) = (uniform::<T, D>(), |_| uneven::<T, D>(1) * T::lit(10.0));
    let mut state = world.state::<X>(|_| before);
    let (_, dofs) = world.mapped(transfer, &state, kick);
    world.taken(transfer, &dofs, kick, &mut state);
    let after = before + kick(0) * T::lit(STEP);
    for p in 0..world.positions.len() {
        world.compare(Property::UniformVelocity, &after, &state.0[p], p)?;
        if X::AFFINE {
            let affine = transfer.gradient(&state.1[p]);
            for a in 0..D {
                let none = SVector::zeros();
                world.compare(
                    Property::UniformVelocity,
                    &none,
                    &affine.column(a).into_owned(),
                    p,
                )?;
            }
        }
    }
    Ok(())
}

fn keeps_momentum<T: Scalar, const D: usize, X: Transfer<T, D>>(
    transfer: &X,
    world: &World<T, D>,
) -> Result<(), Failure>
where
    BSpline<2>: BasisFamily<T, D>,
{
    let mut state = world.state::<X>(|_| SVector::zeros());
    for p in 0..world.positions.len() {
        state.0[p] = uneven(p);
    }
    // Twice, so that what particles remember is of a motion too.
    for round in 0..2 {
        let kick = |i: usize| uneven::<T, D>(i + round) * T::lit(10.0);
        let (masses, dofs) = world.mapped(transfer, &state, kick);
        world.taken(transfer, &dofs, kick, &mut state);
        let sum = |masses: &[T], velocities: &[SVector<T, D>]| {
            let each = masses.iter().zip(velocities);
            each.fold(SVector::<T, D>::zeros(), |sum, (&m, v)| sum + v * m)
        };
        let (of_dofs, of_particles) = (sum(&masses, &dofs), sum(&world.masses, &state.0));
        let total = world.masses.iter().fold(T::zero(), |sum, &m| sum + m);
        for a in 0..D {
            let place = || Place::Everywhere;
            let property = Property::TransferKeepsMomentum;
            near(
                property,
                place,
                of_dofs[a] / total,
                of_particles[a] / total,
                round_off(),
            )?;
        }
    }
    Ok(())
}

/// A linear velocity, three times: what is remembered of it in one round must come back in the next.
fn linear<T: Scalar, const D: usize, X: Transfer<T, D>>(
    transfer: &X,
    world: &World<T, D>,
    claimed: bool,
) -> Result<(), Failure>
where
    BSpline<2>: BasisFamily<T, D>,
{
    let gradient = SMatrix::<T, D, D>::from_fn(|c, a| T::lit(0.5 - 0.25 * c as f64 + 0.375 * a as f64));
    let field = |x: &SVector<T, D>| uniform::<T, D>() + gradient * x;
    let rest = |_| SVector::zeros();
    let mut state = world.state::<X>(field);
    let count = BSpline::<2>.dof_count(&world.grid);
    let origin = SVector::zeros();
    // The DOFs' own, which any mapping of it would give them.
    let dofs: Vec<_> = (0..count)
        .map(|i| field(&world.places.offset(&world.grid, i, (&[0; D], &origin))))
        .collect();
    world.taken(transfer, &dofs, rest, &mut state);
    for _ in 0..2 {
        let (_, dofs) = world.mapped(transfer, &state, rest);
        world.taken(transfer, &dofs, rest, &mut state);
    }
    let mut kept = Ok(());
    for (p, x) in world.positions.iter().enumerate() {
        kept = kept.and(world.compare(Property::LinearVelocity, &field(x), &state.0[p], p));
    }
    match (claimed, kept) {
        (true, kept) => kept,
        (false, Err(_)) => Ok(()),
        (false, Ok(())) => Err(Failure {
            property: Property::LinearVelocity,
            place: Place::Everywhere,
            expected: super::Expected::Violation { times: 1.0 },
            found: 0.0,
        }),
    }
}
