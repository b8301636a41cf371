//! Source: Terzaghi's principle with Coulomb's law; the series of one-dimensional consolidation. Goal: a wall
//! that rubs acts on a saturated solid by its effective stress, lets both phases go, and is one impulse in
//! the balance of momentum of both. Parameters: blocks and columns of soil of 10 MPa with porosity 0.4, four
//! to ten cells high, two particles per cell and axis; all bases with Shepard and TLS, one to three
//! dimensions. Expected: `v_x + mu v_y = g (sin a - mu cos a) t` of both phases to 1e-9 on a drained floor;
//! on a sealed one friction under buoyancy, `g (sin a - mu cos a (rho - rho_w) / rho)`, within 1 %; under a
//! load that comes at once to undrained soil friction `mu (q - p)` with the series' pressure within 2 % of
//! `mu q`; the change of momentum of both phases is that of all impulses to round-off.

use std::array::from_fn;
use std::f64::consts::PI;

use materialpoint::basis::{BSpline, BasisFamily, DualDomain, Linear};
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{Drag, PoreLiquid, TwoPhase};
use materialpoint::reconstruction::{Reconstruction, RelaxedTaylor, Shepard, Taylor};
use materialpoint::stepper::{FaceCondition, Forcing, PoreCondition, Setup, Stepper, SurfacePoint};
use nalgebra::{SMatrix, SVector};

const SOIL: TwoPhase<f64> = TwoPhase {
    porosity: 0.4,
    solid_density: 2.65e3,
    liquid_density: 1e3,
    liquid_bulk_modulus: 2e7,
    permeability: 2e-3,
    permeability_exponent: 0.0,
    gravity: 9.81,
    drag: Drag::Implicit,
};
const MODULUS: f64 = 1e7;

type Soil<const D: usize, B, R> = Stepper<f64, D, B, R, LinearElastic<f64>, TwoPhase<f64>>;

/// A block of soil in a box of cells.
#[derive(Clone, Copy)]
struct Block<const D: usize> {
    cells: [usize; D],
    /// Lowest and highest corner (cells).
    from: [f64; D],
    to: [f64; D],
    cell: f64,
    soil: TwoPhase<f64>,
}

impl<const D: usize> Block<D> {
    /// The block at rest, with the surfaces where it ends.
    fn stepper<B, R>(
        &self,
        basis: B,
        reconstruction: R,
        edit: impl Fn(&mut Particles<f64, D, (), PoreLiquid<f64, D>>),
    ) -> Soil<D, B, R>
    where
        B: BasisFamily<f64, D>,
        R: Reconstruction<f64, D>,
    {
        let corner = |at: [f64; D]| SVector::from_fn(|a, _| at[a] * self.cell);
        let max = corner(self.cells.map(|cells| cells as f64));
        let grid = Grid::new(SVector::zeros(), max, self.cells).unwrap();
        let points = lattice(&grid, &corner(self.from), &corner(self.to), [2; D]);
        let mut particles = Particles::at_rest(&points, self.soil.dry_density());
        edit(&mut particles);
        let spacing = self.cell / 2.0;
        let mut surface = Vec::new();
        for (particle, x) in points.iter().map(|point| point.0).enumerate() {
            for face in Face::all::<D>() {
                let end = match face.side {
                    Side::Min => x[face.axis] - self.from[face.axis] * self.cell,
                    Side::Max => self.to[face.axis] * self.cell - x[face.axis],
                };
                if end < 0.75 * spacing {
                    surface.push(SurfacePoint {
                        particle,
                        face,
                        area: spacing.powi(D as i32 - 1),
                        reach: 0.5,
                        loaded: true,
                    });
                }
            }
        }
        let law = LinearElastic {
            moduli: Moduli::from_young(MODULUS, 0.0).unwrap(),
        };
        let setup = Setup::new(grid, basis, reconstruction, law, self.soil, particles);
        let mass = VelocityMass::Lumped;
        Stepper::new(
            setup
                .with_velocity_mass(MassModel::preferring(mass))
                .with_surface(surface),
        )
        .unwrap()
    }
}

/// Momentum (kg m/s) of both phases, and mass (kg).
fn momentum<const D: usize, B, R>(stepper: &Soil<D, B, R>) -> (SVector<f64, D>, f64)
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
{
    let (particles, soil) = (stepper.particles(), stepper.phase());
    let mut sum = (SVector::zeros(), 0.0);
    for p in 0..particles.len() {
        let liquid = soil.porosity * soil.liquid_density * particles.volume[p];
        sum.0 += particles.velocity[p] * particles.mass[p] + particles.phase[p].velocity * liquid;
        sum.1 += particles.mass[p] + liquid;
    }
    sum
}

/// Takes steps until `end` (s), half the critical ones; `see(stepper, time, step)` after each. Every step's
/// change of momentum must be the impulses of weight, loads (N) and walls.
fn run<const D: usize, B, R>(
    stepper: &mut Soil<D, B, R>,
    end: f64,
    forcing: impl Fn(f64) -> (Forcing<f64, D>, SVector<f64, D>),
    mut see: impl FnMut(&Soil<D, B, R>, f64, f64),
) where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D> + Clone,
{
    let limit = stepper.critical_step(&forcing(end).0).unwrap().step;
    let steps = (end / (0.5 * limit)).ceil();
    let dt = end / steps;
    for n in 0..steps as usize {
        let (forcing, load) = forcing(n as f64 * dt);
        let (before, mass) = momentum(stepper);
        stepper.step(dt, &forcing).unwrap();
        let weight = (forcing.body_force * mass + load) * dt;
        let walls: SVector<f64, D> = Face::all::<D>()
            .map(|face| stepper.wall_impulse(face).whole)
            .sum();
        let after = momentum(stepper).0;
        // Of held faces the forces are not told.
        let free = |axis: usize| {
            !Face::all::<D>().any(|face| match forcing.face(face) {
                FaceCondition::Held { held, .. } => held[axis],
                _ => false,
            })
        };
        let scale = weight.norm() + walls.norm() + after.norm();
        for axis in (0..D).filter(|&axis| free(axis)) {
            let left = after[axis] - before[axis] - weight[axis] - walls[axis];
            assert!(left.abs() <= 1e-12 * scale, "step {n}: {left:e} of {scale:e}");
        }
        see(stepper, (n + 1) as f64 * dt, dt);
    }
    assert_eq!(stepper.diagnostics().unsolved_contacts, 0);
    // Walls at rest take energy; belts are no walls at rest, but are told relative to themselves.
    assert!(
        stepper.diagnostics().wall_gain < 1e-6,
        "{:?}",
        stepper.diagnostics()
    );
}

const SLOPE: f64 = 30.0 * PI / 180.0;
const G: f64 = 9.81;
/// Time (s) in which published TLS bears a body of two phases that moves through cells: it gains energy by
/// itself, in free flight as well.
const MOMENT: f64 = 0.01;

/// On a slope of 30 degrees, falling along axis 0; `up` is the floor's normal.
fn on_slope<const D: usize>(up: usize, friction: f64, pores: PoreCondition<f64>) -> Forcing<f64, D> {
    let mut weight = SVector::zeros();
    weight[(up + 1) % D] = G * SLOPE.sin();
    weight[up] = -G * SLOPE.cos();
    let below = floor(up);
    Forcing::none()
        .with_body_force(weight)
        .with_face(below, FaceCondition::frictional(friction))
        .with_pores(below, pores)
}

fn slab<const D: usize>(up: usize) -> Block<D> {
    let along = (up + 1) % D;
    let pick = |of: [f64; 3]| {
        from_fn(|axis| {
            if axis == up {
                of[0]
            } else if axis == along {
                of[1]
            } else {
                of[2]
            }
        })
    };
    Block {
        cells: pick([6.0, 14.0, 4.0]).map(|cells| cells as usize),
        from: pick([0.0, 2.0, 1.0]),
        to: pick([4.0, 10.0, 3.0]),
        cell: 0.125,
        soil: SOIL,
    }
}

/// Lets both phases slide along an axis by 1 m/s: then no part of the floor sticks.
fn slide<const D: usize>(particles: &mut Particles<f64, D, (), PoreLiquid<f64, D>>, along: usize) {
    for (v, liquid) in particles.velocity.iter_mut().zip(&mut particles.phase) {
        v[along] = 1.0;
        liquid.velocity[along] = 1.0;
    }
}

/// Where the liquid passes the floor all of the weight presses.
fn slides_drained<const D: usize, B, R>(basis: B, reconstruction: R, up: usize, end: f64)
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D> + Clone,
{
    for friction in [0.0, 0.1] {
        let forcing = on_slope(up, friction, PoreCondition::Pressure(0.0));
        let along = (up + 1) % D;
        // From rest the sides would bulge under the pressure that comes with the weight, one of them uphill.
        let slides = |particles: &mut _| slide(particles, along);
        let mut stepper = slab::<D>(up).stepper(basis.clone(), reconstruction.clone(), slides);
        run(&mut stepper, end, |_| (forcing, SVector::zeros()), |_, _, _| {});
        let (found, mass) = momentum(&stepper);
        let v = (found[along] + friction * found[up]) / mass - 1.0;
        let expected = G * (SLOPE.sin() - friction * SLOPE.cos()) * end;
        let error = v / expected - 1.0;
        println!("drained slide {D}, mu = {friction}: {error:e}");
        // In space they bulge across the slope too, and friction opposes all of the sliding.
        let tolerance = if D < 3 { 1e-9 } else { 1e-5 };
        assert!(error.abs() < tolerance, "mu = {friction}: {error:e}");
    }
}

#[test]
fn on_a_drained_slope_all_of_the_weight_rubs() {
    slides_drained::<2, _, _>(Linear, Shepard, 1, 0.05);
    slides_drained::<2, _, _>(DualDomain::new(), Shepard, 1, 0.05);
    slides_drained::<2, _, _>(BSpline::<2>, Shepard, 0, 0.05);
    slides_drained::<3, _, _>(Linear, Shepard, 2, 0.05);
    slides_drained::<3, _, _>(BSpline::<2>, Shepard, 0, 0.05);
    slides_drained::<2, _, _>(Linear, Taylor::<f64, 2, 6>::new(), 1, MOMENT);
    slides_drained::<2, _, _>(BSpline::<2>, Taylor::<f64, 2, 6>::for_degree(2), 1, MOMENT);
    slides_drained::<3, _, _>(Linear, Taylor::<f64, 3, 10>::new(), 1, MOMENT);
}

/// A slab that stands under its buoyant weight and the water's pressure, on a floor that the water does not
/// pass.
fn slides_buoyant<const D: usize, B, R>(basis: B, reconstruction: R, up: usize, end: f64)
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D> + Clone,
{
    let (rho, friction, height) = (SOIL.saturated_density(), 0.2, 0.5);
    let forcing = on_slope(up, friction, PoreCondition::Sealed).with_pores(
        Face {
            axis: up,
            side: Side::Max,
        },
        PoreCondition::Pressure(0.0),
    );
    let along = (up + 1) % D;
    let mut stepper = slab::<D>(up).stepper(basis, reconstruction, |particles| {
        slide(particles, along);
        for p in 0..particles.len() {
            let depth = height - particles.position[p][up];
            let pressing = G * SLOPE.cos() * depth;
            // Nothing loads the sides.
            particles.stress[p] = SMatrix::identity() * (1e3 * pressing);
            particles.stress[p][(up, up)] = -(rho - 1e3) * pressing;
            particles.phase[p].pressure = -1e3 * pressing;
        }
    });
    let mut pressed = 0.0;
    run(
        &mut stepper,
        end,
        |_| (forcing, SVector::zeros()),
        |stepper, _, _| {
            pressed += stepper.wall_impulse(floor(up)).effective;
        },
    );
    let (found, mass) = momentum(&stepper);
    let gained = found[along] - mass;
    let buoyant = mass * (rho - 1e3) / rho * G * SLOPE.cos() * end;
    assert!((pressed / buoyant - 1.0).abs() < 0.01, "{pressed} {buoyant}");
    let expected = G * (SLOPE.sin() - friction * SLOPE.cos() * (rho - 1e3) / rho) * end;
    let error = gained / mass / expected - 1.0;
    let law = (gained - mass * G * SLOPE.sin() * end + friction * pressed) / (mass * G * end);
    println!(
        "buoyant slide within {error:e}, presses {:e}, law {law:e}",
        pressed / buoyant - 1.0
    );
    assert!(error.abs() < 0.01, "{error:e}");
    assert!(law.abs() < if D < 3 { 1e-9 } else { 1e-5 }, "{law:e}");
}

fn floor(up: usize) -> Face {
    Face {
        axis: up,
        side: Side::Min,
    }
}

#[test]
fn on_a_sealed_slope_the_buoyant_weight_rubs() {
    slides_buoyant::<2, _, _>(Linear, Shepard, 1, 0.1);
    slides_buoyant::<2, _, _>(DualDomain::new(), Shepard, 0, 0.1);
    slides_buoyant::<2, _, _>(BSpline::<2>, Shepard, 1, 0.1);
    slides_buoyant::<3, _, _>(Linear, Shepard, 2, 0.05);
    slides_buoyant::<2, _, _>(Linear, Taylor::<f64, 2, 6>::new(), 1, MOMENT);
    slides_buoyant::<2, _, _>(BSpline::<2>, Taylor::<f64, 2, 6>::for_degree(2), 1, MOMENT);
    slides_buoyant::<3, _, _>(Linear, Taylor::<f64, 3, 10>::new(), 1, MOMENT);
}

/// A column between smooth walls, two cells wide, from its floor up to a drained top.
fn column<const D: usize>(up: usize) -> Block<D> {
    let to: [usize; D] = from_fn(|axis| if axis == up { 10 } else { 2 });
    Block {
        cells: from_fn(|axis| to[axis] + usize::from(axis == up)),
        from: [0.0; D],
        to: to.map(|cells| cells as f64),
        cell: 0.1,
        soil: SOIL,
    }
}

/// Load (Pa) on top of a column and the time (s) in which it comes.
const LOAD: f64 = 1e4;
const RAMP: f64 = 0.05;

fn load_at(time: f64) -> f64 {
    LOAD * (PI / 2.0 * (time / RAMP).min(1.0)).sin().powi(2)
}

fn loaded<const D: usize>(up: usize, floor_condition: FaceCondition<f64, D>, time: f64) -> Forcing<f64, D> {
    let mut forcing = Forcing::none();
    for axis in (0..D).filter(|&axis| axis != up) {
        for side in [Side::Min, Side::Max] {
            forcing.set_face(Face { axis, side }, FaceCondition::roller(axis));
        }
    }
    let top = Face {
        axis: up,
        side: Side::Max,
    };
    let mut traction = SVector::zeros();
    traction[up] = -load_at(time);
    forcing
        .with_face(floor(up), floor_condition)
        .with_face(top, FaceCondition::Traction(traction))
        .with_pores(top, PoreCondition::Pressure(0.0))
}

/// Share of a load that comes at once which the liquid at the floor bears after so long (s), by the series.
fn share_of_liquid(time: f64) -> f64 {
    let q = SOIL.liquid_bulk_modulus / SOIL.porosity;
    let unit_weight = SOIL.liquid_density * SOIL.gravity;
    let diffusivity = SOIL.permeability / unit_weight / (1.0 / MODULUS + 1.0 / q);
    let terms = (0..200).map(|m| {
        let wave = (f64::from(m) + 0.5) * PI;
        let sign = if m % 2 == 0 { 1.0 } else { -1.0 };
        2.0 * sign / wave * (-wave * wave * diffusivity * time).exp()
    });
    q / (q + MODULUS) * terms.sum::<f64>()
}

/// The same of a load that comes as [`load_at`] says: what pushes the grains of a column 1 m high against its
/// floor (Pa).
fn effective_at(time: f64) -> f64 {
    let parts = 400;
    let step = time.min(RAMP) / f64::from(parts);
    let pressure: f64 = (0..parts)
        .map(|k| {
            let (from, to) = (f64::from(k) * step, f64::from(k + 1) * step);
            (load_at(to) - load_at(from)) * share_of_liquid(time - (from + to) / 2.0)
        })
        .sum();
    load_at(time) - pressure
}

/// A belt under a column drags at it with what its grains press with: at first they press with a sixth of the
/// load, in the end with nearly all.
fn belt_drags<const D: usize, B, R>(basis: B, reconstruction: R, up: usize)
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D> + Clone,
{
    let (friction, along) = (0.2, (up + 1) % D);
    let mut velocity = SVector::zeros();
    velocity[along] = 5.0;
    let belt = FaceCondition::Frictional {
        coefficient: friction,
        velocity,
    };
    let block = column::<D>(up);
    let area = 0.2_f64.powi(D as i32 - 1);
    let mut stepper = block.stepper(basis, reconstruction, |_| {});
    let (mut worst, mut first) = (0.0_f64, 0.0);
    // Mean over a while, in which waves come and go.
    let mut mean = (0.0, 0.0, 0);
    run(
        &mut stepper,
        1.0,
        |time| {
            let mut load = SVector::zeros();
            load[up] = -load_at(time) * area;
            (loaded(up, belt, time), load)
        },
        |stepper, time, dt| {
            let found = stepper.wall_impulse(floor(up)).effective / dt / area;
            mean = (mean.0 + found, mean.1 + effective_at(time), mean.2 + 1);
            if mean.2 < 100 {
                return;
            }
            let [found, expected] = [mean.0, mean.1].map(|sum| sum / f64::from(mean.2) / LOAD);
            mean = (0.0, 0.0, 0);
            if time < 0.15 {
                first = found;
            }
            worst = worst.max((found - expected).abs());
        },
    );
    println!("belt in {D} dimensions within {worst:e}");
    assert!(first < 0.35, "{first}");
    assert!(worst < 0.02, "{worst}");
}

#[test]
fn a_belt_drags_at_a_column_as_its_pressure_leaves_it() {
    belt_drags::<2, _, _>(Linear, Shepard, 1);
    belt_drags::<2, _, _>(BSpline::<2>, Shepard, 0);
    belt_drags::<2, _, _>(DualDomain::new(), Shepard, 1);
    belt_drags::<2, _, _>(Linear, Taylor::<f64, 2, 6>::new(), 1);
    belt_drags::<3, _, _>(Linear, Shepard, 2);
}

/// What is pressed on a floor that may let go is what a fixed one holds.
fn rests_as_on_a_fixed_floor<const D: usize, B, R>(
    basis: B,
    reconstruction: R,
    pores: PoreCondition<f64>,
    tolerance: f64,
) where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D> + Clone,
{
    let up = D - 1;
    let pressures = [FaceCondition::roller(up), FaceCondition::frictional(0.3)].map(|condition| {
        let mut stepper = column::<D>(up).stepper(basis.clone(), reconstruction.clone(), |_| {});
        let area = 0.2_f64.powi(D as i32 - 1);
        let forcing = |time| {
            let mut load = SVector::zeros();
            load[up] = -load_at(time) * area;
            (loaded(up, condition, time).with_pores(floor(up), pores), load)
        };
        run(&mut stepper, 0.2, forcing, |_, _, _| {});
        let particles = stepper.into_setup().particles;
        let pairs = particles.phase.iter().zip(&particles.stress);
        pairs
            .map(|(liquid, stress)| [liquid.pressure, stress[(up, up)]])
            .collect::<Vec<_>>()
    });
    let pairs = pressures[0].iter().flatten().zip(pressures[1].iter().flatten());
    let off = pairs
        .map(|(held, rests)| (held - rests).abs())
        .fold(0.0, f64::max)
        / LOAD;
    println!("{D} dimensions: as on a fixed floor within {off:e}");
    assert!(off < tolerance, "{off:e}");
}

#[test]
fn what_is_pressed_on_a_floor_consolidates_as_on_a_fixed_one() {
    for pores in [PoreCondition::Sealed, PoreCondition::Pressure(0.0)] {
        rests_as_on_a_fixed_floor::<1, _, _>(Linear, Shepard, pores, 2e-3);
        rests_as_on_a_fixed_floor::<1, _, _>(BSpline::<2>, Taylor::<f64, 1, 3>::for_degree(2), pores, 2e-3);
        let relaxed = RelaxedTaylor::<f64, 1, 3>::for_basis(&Linear);
        rests_as_on_a_fixed_floor::<1, _, _>(Linear, relaxed, pores, 1e-2);
        rests_as_on_a_fixed_floor::<2, _, _>(BSpline::<2>, Shepard, pores, 2e-3);
        rests_as_on_a_fixed_floor::<2, _, _>(Linear, Taylor::<f64, 2, 6>::new(), pores, 2e-3);
        rests_as_on_a_fixed_floor::<3, _, _>(Linear, Shepard, pores, 2e-3);
    }
}

/// Away from a wall both phases fly on as they are; thrown at one they come back with no more energy.
fn comes_and_goes<const D: usize, B, R>(basis: B, reconstruction: R, pores: PoreCondition<f64>)
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D> + Clone,
{
    let up = D - 1;
    let block = Block {
        from: from_fn(|axis| if axis == up { 0.0 } else { 2.0 }),
        to: from_fn(|axis| if axis == up { 4.0 } else { 6.0 }),
        cells: [8; D],
        cell: 0.125,
        soil: SOIL,
    };
    let forcing = Forcing::none()
        .with_face(floor(up), FaceCondition::frictional(0.3))
        .with_pores(floor(up), pores);
    let thrown = |velocity: f64| {
        move |particles: &mut Particles<f64, D, (), PoreLiquid<f64, D>>| {
            for p in 0..particles.len() {
                particles.velocity[p][up] = velocity;
                particles.phase[p].velocity[up] = velocity;
            }
        }
    };
    let mut away = block.stepper(basis.clone(), reconstruction.clone(), thrown(1.0));
    run(&mut away, 0.1, |_| (forcing, SVector::zeros()), |_, _, _| {});
    for p in 0..away.particles().len() {
        for v in [away.particles().velocity[p], away.particles().phase[p].velocity] {
            assert!((v[up] - 1.0).abs() < 1e-12, "{v:?}");
        }
    }
    let mut falls = block.stepper(basis.clone(), reconstruction.clone(), thrown(-0.1));
    let before = falls.energy().total();
    let mut most = 0.0_f64;
    run(
        &mut falls,
        0.05,
        |_| (forcing, SVector::zeros()),
        |stepper, _, _| {
            most = most.max(stepper.energy().total() / before);
        },
    );
    let (back, mass) = momentum(&falls);
    println!("{D} dimensions: energy {most}, back with {}", back[up] / mass);
    assert!(most < 1.01, "{most}");
    assert!(back[up] > 0.01 * mass, "{back:?}");
}

#[test]
fn nothing_sticks_to_a_wall_and_what_hits_it_gains_nothing() {
    for pores in [PoreCondition::Sealed, PoreCondition::Pressure(0.0)] {
        comes_and_goes::<1, _, _>(Linear, Shepard, pores);
        comes_and_goes::<1, _, _>(BSpline::<2>, Shepard, pores);
        comes_and_goes::<2, _, _>(Linear, Shepard, pores);
        comes_and_goes::<2, _, _>(BSpline::<2>, Shepard, pores);
        comes_and_goes::<3, _, _>(Linear, Shepard, pores);
    }
}

/// A slab that slides in the plane, its floor at any face: positions, velocities of both phases, stresses and
/// pressures in a frame of its own, across and up.
fn on_face<B>(basis: B, face: Face, pores: PoreCondition<f64>) -> Vec<[f64; 8]>
where
    B: BasisFamily<f64, 2>,
{
    let (up, along) = (face.axis, (face.axis + 1) % 2);
    let mut block = slab::<2>(up);
    let mut forcing = on_slope(up, 0.2, pores);
    let (mut sign, mut zero) = (1.0, 0.0);
    if face.side == Side::Max {
        (sign, zero) = (-1.0, 6.0 * block.cell);
        (block.from[up], block.to[up]) = (2.0, 6.0);
        let condition = *forcing.face(floor(up));
        forcing = Forcing::none()
            .with_body_force(forcing.body_force)
            .with_face(face, condition)
            .with_pores(face, pores);
        forcing.body_force[up] *= -1.0;
    }
    let mut stepper = block.stepper(basis, Shepard, |particles| slide(particles, along));
    for _ in 0..100 {
        stepper.step(2e-4, &forcing).unwrap();
    }
    let particles = stepper.into_setup().particles;
    let mut found: Vec<[f64; 8]> = (0..particles.len())
        .map(|p| {
            let (x, v, liquid) = (particles.position[p], particles.velocity[p], particles.phase[p]);
            let stress = particles.stress[p];
            [
                x[along],
                zero + sign * x[up],
                v[along],
                sign * v[up],
                liquid.velocity[along],
                sign * liquid.velocity[up],
                stress[(up, up)] + stress[(along, along)],
                liquid.pressure,
            ]
        })
        .collect();
    let key = |row: &[f64; 8]| [row[0], row[1]].map(|x| (x * 1e6).round() as i64);
    found.sort_by_key(key);
    found
}

#[test]
fn a_floor_at_any_face_is_the_same() {
    for pores in [PoreCondition::Sealed, PoreCondition::Pressure(0.0)] {
        let expected = on_face(BSpline::<2>, floor(1), pores);
        let largest: [f64; 8] = from_fn(|k| expected.iter().map(|row| row[k].abs()).fold(0.0, f64::max));
        for face in Face::all::<2>().filter(|&face| face != floor(1)) {
            let found = on_face(BSpline::<2>, face, pores);
            for (found, expected) in found.iter().zip(&expected) {
                for k in 0..8 {
                    let off = (found[k] - expected[k]).abs() / largest[k];
                    assert!(off < 1e-8, "{face}, {k}: {} {}", found[k], expected[k]);
                }
            }
        }
    }
}

/// Water of any pressure all around changes nothing of what rubs.
#[test]
fn water_outside_rubs_nothing() {
    for pores in [PoreCondition::Sealed, PoreCondition::Pressure(0.0)] {
        let [dry, wet] = [0.0, -5e3].map(|outside| {
            let mut forcing = on_slope::<2>(1, 0.2, pores);
            if pores != PoreCondition::Sealed {
                forcing.set_pores(floor(1), PoreCondition::Pressure(outside));
            }
            for face in Face::all::<2>().filter(|&face| face != floor(1)) {
                let mut traction = SVector::zeros();
                traction[face.axis] = if face.side == Side::Max { outside } else { -outside };
                forcing.set_face(face, FaceCondition::Traction(traction));
                forcing.set_pores(face, PoreCondition::Pressure(outside));
            }
            let mut stepper = slab::<2>(1).stepper(Linear, Shepard, |particles| {
                slide(particles, 0);
                for liquid in &mut particles.phase {
                    liquid.pressure = outside;
                }
            });
            let mut pressed = [0.0; 2];
            for _ in 0..100 {
                stepper.step(2e-4, &forcing).unwrap();
                let wall = stepper.wall_impulse(floor(1));
                pressed[0] += wall.effective;
                pressed[1] += wall.whole[1];
            }
            (pressed, momentum(&stepper).0)
        });
        let ([effective, whole], moved) = wet;
        // The surfaces' loads are point loads against sums over particles.
        assert!((effective / dry.0[0] - 1.0).abs() < 1e-2, "{wet:?} {dry:?}");
        assert!((moved - dry.1).norm() < 1e-3 * moved.norm(), "{wet:?} {dry:?}");
        // Through a drained floor it is not the wall that bears it.
        let borne = if pores == PoreCondition::Sealed {
            5e3 * 1.0 * 0.02
        } else {
            0.0
        };
        let found = whole - dry.0[1];
        assert!((found - borne).abs() < 0.01 * whole, "{found} {borne}");
    }
}

/// A block whose floor holds it takes its water along: what the wall gives the solid the drag shares at once.
#[test]
fn the_water_of_a_block_that_sticks_does_not_creep() {
    let soil = TwoPhase {
        permeability: 1e-7,
        ..SOIL
    };
    let block = Block { soil, ..slab::<2>(1) };
    let mut stepper = block.stepper(Linear, Shepard, |_| {});
    let forcing = |time: f64| {
        let mut forcing = on_slope::<2>(1, 0.9, PoreCondition::Pressure(0.0));
        forcing.body_force *= (PI / 2.0 * (time / 0.05).min(1.0)).sin().powi(2);
        (forcing, SVector::zeros())
    };
    let mut steps = 0;
    let mut most = 0.0_f64;
    run(&mut stepper, 0.1, forcing, |stepper, _, _| {
        let particles = stepper.particles();
        let slips = particles.phase.iter().zip(&particles.velocity);
        let slip: f64 = slips.map(|(liquid, v)| liquid.velocity[0] - v[0]).sum();
        most = most.max(slip.abs() / particles.len() as f64);
        steps += 1;
    });
    println!("water creeps by {most:e} m/s");
    // Without, it would by some g sin(a) dt.
    assert!(most < 0.01 * G * SLOPE.sin() * 0.1 / f64::from(steps), "{most:e}");
}

/// A slab that lands on its floor, slides and lifts at its heel: contacts come and go, in room that is there.
#[test]
fn no_step_on_a_wall_allocates() {
    for pores in [PoreCondition::Sealed, PoreCondition::Pressure(0.0)] {
        let forcing = on_slope::<2>(1, 0.3, pores);
        let block = Block {
            from: [2.0, 0.3],
            to: [10.0, 4.3],
            ..slab::<2>(1)
        };
        let mut stepper = block.stepper(BSpline::<2>, Shepard, |particles| {
            slide(particles, 0);
            for (v, liquid) in particles.velocity.iter_mut().zip(&mut particles.phase) {
                v[1] = -1.0;
                liquid.velocity[1] = -1.0;
            }
        });
        stepper.step(2e-4, &forcing).unwrap();
        let mut met = 0;
        let steps = allocation_counter::measure(|| {
            for _ in 0..400 {
                stepper.step(2e-4, &forcing).unwrap();
                met += usize::from(stepper.wall_impulse(floor(1)).whole[1] > 0.0);
            }
        });
        assert!((50..400).contains(&met), "{met}");
        assert_eq!(steps.count_total, 0, "{pores:?}");
    }
}
