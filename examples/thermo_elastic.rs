//! A phase of your own: heat that strain frees and binds in an elastic solid, in one file.
//!
//! Too fast a motion leaves heat no time to flow: a bar that is stretched cools, one that is compressed warms
//! (the Gough-Joule effect), and the thermal stress resists either. The solid is stiffer than in a slow test.
//!
//! `cargo run --release --example thermo_elastic`

use std::error::Error;
use std::f64::consts::PI;

use materialpoint::basis::Linear;
use materialpoint::error::SetupError;
use materialpoint::grid::{Face, Grid};
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{Phase, PhaseStep};
use materialpoint::reconstruction::{Reconstruction, Shepard, Taylor};
use materialpoint::scalar::Scalar;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use nalgebra::{SMatrix, SVector, vector};

/// Adiabatic linear thermo-elasticity: with the strain rate `d` and the change of temperature `theta`
///
/// `sigma_total = sigma - beta theta I`, `rho c theta' = -T0 beta tr d`,
///
/// where `sigma` is what the law makes of the strain at constant temperature.
#[derive(Clone, Copy, Debug)]
pub struct ThermoElastic<T> {
    /// Thermal stress `beta` per degree at constant strain (Pa/K).
    pub thermal_stress: T,
    /// Heat capacity `rho c` per volume at constant strain (J/(m3 K)).
    pub heat_capacity: T,
    /// Absolute temperature `T0` (K), from which the change is small.
    pub temperature: T,
}

impl<T: Scalar> ThermoElastic<T> {
    /// How much stiffer (Pa) the solid is against a change of volume when heat has no time to flow:
    /// `T0 beta^2/(rho c)`, added to Young's modulus of a bar and to the first constant of Lame of a solid.
    pub fn stiffening(&self) -> T {
        self.warming() * self.thermal_stress
    }

    /// By how much (K) a volume that shrinks to nothing, if it could, would warm: `T0 beta/(rho c)`.
    pub fn warming(&self) -> T {
        self.temperature * self.thermal_stress / self.heat_capacity
    }
}

/// Change of temperature (K) of a particle. Its default is none.
#[derive(Clone, Copy, Debug)]
pub struct Warmth<T>(pub T);

impl<T: Scalar> Default for Warmth<T> {
    fn default() -> Self {
        Self(T::zero())
    }
}

impl<T: Scalar, const D: usize> Phase<T, D> for ThermoElastic<T> {
    // There is more than the solid. No liquid flows through it, so `FLOWS` keeps its default.
    const COUPLED: bool = true;
    type Particle = Warmth<T>;

    fn total_stress(&self, effective: &SMatrix<T, D, D>, particle: &Warmth<T>) -> SMatrix<T, D, D> {
        effective - SMatrix::identity() * (self.thermal_stress * particle.0)
    }

    fn update(&self, step: &PhaseStep<'_, T, D>, particle: &mut Warmth<T>) {
        particle.0 -= self.warming() * step.solid.trace();
    }

    /// With the strain energy at constant temperature and that of motion it is constant.
    fn energy_density(&self, particle: &Warmth<T>) -> T {
        self.heat_capacity * particle.0 * particle.0 / (T::lit(2.0) * self.temperature)
    }

    fn validate(&self) -> Result<(), SetupError> {
        let positive = [
            ("heat_capacity", self.heat_capacity),
            ("temperature", self.temperature),
        ];
        let refuse = |name, value: T, allowed| {
            let value = value.primal();
            Err(SetupError::Constant { name, value, allowed })
        };
        for (name, value) in positive {
            if !(value.is_finite() && value > T::zero()) {
                return refuse(name, value, "it must be positive and finite");
            }
        }
        // Of either sign: water below 4 degrees shrinks when it is warmed, and so does stretched rubber.
        if !self.thermal_stress.is_finite() {
            return refuse("thermal_stress", self.thermal_stress, "it must be finite");
        }
        Ok(())
    }
}

// Aluminium at room temperature. A stress of 1 MPa along a bar cools it by `alpha T0/(rho c)`, 2.8 mK.
/// Young's modulus at constant temperature (Pa).
pub const YOUNGS_MODULUS: f64 = 70e9;
/// Poisson's ratio.
pub const POISSONS_RATIO: f64 = 0.33;
/// Coefficient `alpha` of linear thermal expansion (1/K).
pub const EXPANSION: f64 = 23e-6;
/// Density (kg/m3).
pub const DENSITY: f64 = 2700.0;
/// Heat capacity per volume (J/(m3 K)).
pub const HEAT_CAPACITY: f64 = 2.42e6;
/// Absolute temperature (K).
pub const TEMPERATURE: f64 = 293.0;

/// Largest velocity (m/s) at the start: strains of some 1e-5, to which the linear theory belongs.
pub const VELOCITY: f64 = 0.1;
/// Length (m) of the bar and of the sides of the plate.
pub const LENGTH: f64 = 1.0;
/// Particles in a cell along each axis.
pub const PER_CELL: usize = 3;
/// Steps in a period; Euler-Cromer shortens it by (2 pi/400)^2/24 of itself, 1e-5.
pub const STEPS: usize = 400;

/// The heat in a bar, `beta = E alpha` since its sides are free, or in a plate that cannot be strained
/// across, `beta = 3 K alpha = E alpha/(1 - 2 nu)`. If not `couples` it does not expand, and its temperature
/// stays.
pub fn aluminium(dimensions: usize, couples: bool) -> ThermoElastic<f64> {
    let expansion = if couples { EXPANSION } else { 0.0 };
    let stiffness = match dimensions {
        1 => YOUNGS_MODULUS,
        _ => YOUNGS_MODULUS / (1.0 - 2.0 * POISSONS_RATIO),
    };
    ThermoElastic {
        thermal_stress: stiffness * expansion,
        heat_capacity: HEAT_CAPACITY,
        temperature: TEMPERATURE,
    }
}

/// How the plate swings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// It is compressed and stretched and nowhere turned.
    Pressure,
    /// It is sheared at constant volume: no heat.
    Shear,
}

/// What was seen of a body in two periods.
#[derive(Clone, Copy, Debug)]
pub struct Swing {
    /// Period (s).
    pub period: f64,
    /// Step (s) of which a period was thought to have [`STEPS`].
    pub step: f64,
    /// Largest stable step (s).
    pub critical_step: f64,
    /// Largest root mean square (K) of the change of temperature.
    pub temperature: f64,
    /// Largest part of the energy that was in it.
    pub heat: f64,
    /// Largest change of the energy, as a part of it.
    pub drift: f64,
}

/// A bar between two walls: `u = sin(k x)`, `k = pi/L`. Along one axis the library knows one modulus; taken
/// for Young's it makes a bar with free sides.
pub fn bar<R>(reconstruction: R, cells: usize, couples: bool) -> Result<Swing, Box<dyn Error>>
where
    R: Reconstruction<f64, 1> + Clone,
{
    let (phase, wave) = (aluminium(1, couples), PI / LENGTH);
    let modulus = YOUNGS_MODULUS + phase.stiffening();
    let setup = Setup::new(
        Grid::new(vector![0.0], vector![LENGTH], [cells])?,
        Linear,
        reconstruction,
        LinearElastic {
            moduli: Moduli::uniaxial(YOUNGS_MODULUS)?,
        },
        phase,
        Particles::default(),
    )
    .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent));
    let frequency = wave * (modulus / DENSITY).sqrt();
    swing(setup, |x| vector![(wave * x[0]).sin()], frequency)
}

/// A square plate in plane strain with rollers on all sides: `u = (sin(k x) cos(k y), cos(k x) sin(k y))`, or
/// the same with another sign, `k = pi/L`.
pub fn plate<R>(reconstruction: R, cells: usize, couples: bool, mode: Mode) -> Result<Swing, Box<dyn Error>>
where
    R: Reconstruction<f64, 2> + Clone,
{
    let (phase, wave) = (aluminium(2, couples), PI / LENGTH);
    let moduli = Moduli::from_young(YOUNGS_MODULUS, POISSONS_RATIO)?;
    let (modulus, sign) = match mode {
        Mode::Pressure => (moduli.p_wave() + phase.stiffening(), 1.0),
        Mode::Shear => (moduli.mu, -1.0),
    };
    let setup = Setup::new(
        Grid::new(vector![0.0, 0.0], vector![LENGTH, LENGTH], [cells, cells])?,
        Linear,
        reconstruction,
        LinearElastic { moduli },
        phase,
        Particles::default(),
    )
    .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent));
    let shape = |x: &SVector<f64, 2>| {
        let ([sx, sy], [cx, cy]) = (
            [x[0], x[1]].map(|x| (wave * x).sin()),
            [x[0], x[1]].map(|x| (wave * x).cos()),
        );
        vector![sx * cy, sign * cx * sy]
    };
    let frequency = wave * (2.0 * modulus / DENSITY).sqrt();
    swing(setup, shape, frequency)
}

/// Fills the grid of `setup` and lets go with the velocities of `shape`, to swing at about `frequency` (1/s).
fn swing<R, const D: usize>(
    mut setup: Setup<f64, D, Linear, R, LinearElastic<f64>, ThermoElastic<f64>>,
    shape: impl Fn(&SVector<f64, D>) -> SVector<f64, D>,
    frequency: f64,
) -> Result<Swing, Box<dyn Error>>
where
    R: Reconstruction<f64, D> + Clone,
{
    let (grid, phase) = (&setup.grid, setup.phase);
    let points = lattice(grid, grid.min(), grid.max(), [PER_CELL; D]);
    setup.particles = Particles::at_rest(&points, DENSITY);
    for (v, x) in setup.particles.velocity.iter_mut().zip(&setup.particles.position) {
        *v = shape(x) * VELOCITY;
    }
    let mut stepper = Stepper::new(setup)?;
    let rollers = Face::all::<D>().fold(Forcing::none(), |f, face| {
        f.with_face(face, FaceCondition::roller(face.axis))
    });
    let critical_step = stepper
        .critical_step(&rollers)
        .ok_or("nothing resists a motion")?
        .step;
    let period = 2.0 * PI / frequency;
    let step = period / STEPS as f64;

    let (mut returns, mut before) = (Vec::new(), 0.0);
    let (mut temperature, mut heat, mut drift, mut start) = (0.0_f64, 0.0_f64, 0.0_f64, None);
    for _ in 0..2 * STEPS {
        let particles = stepper.particles();
        let squares = particles.phase.iter().map(|warmth| warmth.0 * warmth.0);
        temperature = temperature.max((squares.sum::<f64>() / particles.len() as f64).sqrt());
        let stored = particles.phase.iter().zip(&particles.volume);
        let stored: f64 = stored
            .map(|(warmth, volume)| Phase::<f64, D>::energy_density(&phase, warmth) * volume)
            .sum();
        // At the start of the step, as the heat is.
        let energy = stepper.step_and_measure(step, step, &rollers)?.total();
        let first = *start.get_or_insert(energy);
        heat = heat.max(stored / energy);
        drift = drift.max((energy / first - 1.0).abs());

        // The particles come in an order of the stepper's own: each tells where it was.
        let particles = stepper.particles();
        let moved = particles.displacement.iter().zip(&particles.initial_position);
        let now: f64 = moved.map(|(u, x0)| u.dot(&shape(x0))).sum();
        if now * before < 0.0 {
            returns.push(stepper.time() - step * now / (now - before));
        }
        before = now;
    }
    // Undeformed at the start, it comes back after half a period, a whole one and so on.
    let [first, _, third, ..] = returns[..] else {
        return Err("it does not swing as it should".into());
    };
    Ok(Swing {
        period: third - first,
        step,
        critical_step,
        temperature,
        heat,
        drift,
    })
}

/// What heat does to bar and plate.
#[derive(Clone, Copy, Debug)]
pub struct Findings {
    /// By which part of itself the period of the bar is shorter: `1 - sqrt(E/E_s)` with the adiabatic modulus
    /// `E_s = E + T0 beta^2/(rho c)`.
    pub bar: f64,
    /// The same of the plate, `1 - sqrt(M/M_s)` with the modulus `M` of pressure waves, and all but nothing
    /// if it is sheared.
    pub plate: [f64; 2],
    /// How the bar with heat swings.
    pub swing: Swing,
}

/// Lets bar and plate swing, with heat and without: the bar by plain MPM, the plate by Taylor least squares.
pub fn run() -> Result<Findings, Box<dyn Error>> {
    let (slow, swing) = (bar(Shepard, 20, false)?, bar(Shepard, 20, true)?);
    let shorter = |mode| -> Result<f64, Box<dyn Error>> {
        let plate = |couples| plate(Taylor::<f64, 2, 6>::new(), 10, couples, mode);
        Ok(1.0 - plate(true)?.period / plate(false)?.period)
    };
    Ok(Findings {
        bar: 1.0 - swing.period / slow.period,
        plate: [shorter(Mode::Pressure)?, shorter(Mode::Shear)?],
        swing,
    })
}

// The tests include this file as a module and call its functions themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    let Findings { bar, plate, swing } = run()?;
    println!("heat shortens the period of the bar by {:.3} %", 100.0 * bar);
    let [pressure, shear] = plate.map(|share| 100.0 * share);
    println!("that of the plate by {pressure:.3} %, and if sheared by {shear:.3} %");
    let (temperature, heat) = (1e3 * swing.temperature, 100.0 * swing.heat);
    println!("the bar warms and cools by {temperature:.2} mK, with {heat:.3} % of its energy");
    let courant = swing.step / swing.critical_step;
    println!(
        "energy is kept to {:.0e}, by {courant:.3} of the stable step",
        swing.drift
    );
    Ok(())
}
