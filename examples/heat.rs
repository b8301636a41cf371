//! A phase of your own that diffuses: heat conduction in a thermo-elastic solid, in one file.
//!
//! Bodies of a micrometre, where heat is about as fast as sound: a cosine of temperature decays in an
//! insulated bar and plate, and a bar that is warmed unevenly expands, or presses against walls.
//!
//! `cargo run --release --example heat`

use std::error::Error;
use std::f64::consts::PI;

use materialpoint::basis::{BasisFamily, Linear};
use materialpoint::error::{GridError, SetupError};
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{Phase, PhaseStep};
use materialpoint::reconstruction::{Reconstruction, Shepard};
use materialpoint::record::Record;
use materialpoint::scalar::Scalar;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use nalgebra::{SMatrix, SVector, vector};

/// Linear thermo-elasticity that conducts heat by Fourier's law: with the strain rate `d` and the change of
/// temperature `theta`
///
/// `sigma_total = sigma - beta theta I`, `rho c theta' = div(k grad theta) - T0 beta tr d`.
#[derive(Clone, Copy, Debug)]
pub struct Conduction<T> {
    /// Thermal stress `beta` per degree at constant strain (Pa/K).
    pub thermal_stress: T,
    /// Density `rho` (kg/m3).
    pub density: T,
    /// Heat capacity `c` per mass at constant strain (J/(kg K)).
    pub specific_heat: T,
    /// Conductivity `k` (W/(m K)).
    pub conductivity: T,
    /// Absolute temperature `T0` (K); 0 leaves out what strain does to the temperature.
    pub temperature: T,
}

/// Change of temperature (K) of a particle. Its default is none.
#[derive(Clone, Copy, Debug)]
pub struct Warmth<T>(pub T);

impl<T: Scalar> Default for Warmth<T> {
    fn default() -> Self {
        Self(T::zero())
    }
}

// For checkpoints.
impl<T: Scalar> Record<T> for Warmth<T> {
    fn put(&self, out: &mut impl FnMut(T)) {
        out(self.0);
    }

    fn take(from: &mut impl FnMut() -> T) -> Option<Self> {
        Some(Self(from()))
    }
}

impl<T: Scalar, const D: usize> Phase<T, D> for Conduction<T> {
    const COUPLED: bool = true;
    const DIFFUSES: bool = true;
    type Particle = Warmth<T>;

    fn total_stress(&self, effective: &SMatrix<T, D, D>, particle: &Warmth<T>) -> SMatrix<T, D, D> {
        effective - SMatrix::identity() * (self.thermal_stress * particle.0)
    }

    fn update(&self, step: &PhaseStep<'_, T, D>, particle: &mut Warmth<T>) {
        let warming = self.temperature * self.thermal_stress / (self.density * self.specific_heat);
        particle.0 -= warming * step.solid.trace();
    }

    fn capacity(&self, mass: T, _volume: T, _particle: &Warmth<T>) -> T {
        self.specific_heat * mass
    }

    fn value(&self, particle: &Warmth<T>) -> T {
        particle.0
    }

    fn add_to_value(&self, change: T, particle: &mut Warmth<T>) {
        particle.0 += change;
    }

    fn flux(&self, gradient: &SVector<T, D>, _particle: &Warmth<T>) -> SVector<T, D> {
        -gradient * self.conductivity
    }

    fn diffusivity(&self, mass: T, volume: T, _particle: &Warmth<T>) -> T {
        self.conductivity * volume / (self.specific_heat * mass)
    }

    fn validate(&self) -> Result<(), SetupError> {
        let refuse = |name, value: T, allowed| {
            let value = value.primal();
            Err(SetupError::Constant { name, value, allowed })
        };
        for (name, value) in [("density", self.density), ("specific_heat", self.specific_heat)] {
            if !(value.is_finite() && value > T::zero()) {
                return refuse(name, value, "it must be positive and finite");
            }
        }
        for (name, value) in [
            ("conductivity", self.conductivity),
            ("temperature", self.temperature),
        ] {
            if !(value.is_finite() && value >= T::zero()) {
                return refuse(name, value, "it must be finite and not negative");
            }
        }
        if !self.thermal_stress.is_finite() {
            return refuse("thermal_stress", self.thermal_stress, "it must be finite");
        }
        Ok(())
    }
}

/// Young's modulus of aluminium (Pa).
pub const YOUNGS_MODULUS: f64 = 70e9;
/// Coefficient `alpha` of linear thermal expansion (1/K).
pub const EXPANSION: f64 = 23e-6;
/// Density (kg/m3).
pub const DENSITY: f64 = 2700.0;
/// Heat capacity per mass (J/(kg K)).
pub const SPECIFIC_HEAT: f64 = 897.0;
/// Conductivity (W/(m K)).
pub const CONDUCTIVITY: f64 = 237.0;
/// Length (m) of the bar and of the sides of the plate.
pub const LENGTH: f64 = 1e-6;
/// Particles in a cell along each axis.
pub const PER_CELL: usize = 3;

/// Diffusivity `k/(rho c)` (m2/s).
pub fn diffusivity() -> f64 {
    CONDUCTIVITY / (DENSITY * SPECIFIC_HEAT)
}

/// Aluminium that conducts heat and, if it `expands`, feels it: `beta = E alpha` along a bar with free sides.
pub fn aluminium<T: Scalar>(expands: bool) -> Conduction<T> {
    let expansion = if expands { EXPANSION } else { 0.0 };
    Conduction {
        thermal_stress: T::lit(YOUNGS_MODULUS) * T::lit(expansion),
        density: T::lit(DENSITY),
        specific_heat: T::lit(SPECIFIC_HEAT),
        conductivity: T::lit(CONDUCTIVITY),
        temperature: T::zero(),
    }
}

/// A stepper of such a body.
pub type Body<T, const D: usize, B, R> = Stepper<T, D, B, R, LinearElastic<T>, Conduction<T>>;

/// The body between two corners of `grid`, with a `temperature` at the start.
pub fn body<T, const D: usize, B, R>(
    (basis, reconstruction): (B, R),
    (grid, corners): (Grid<T, D>, [SVector<T, D>; 2]),
    phase: Conduction<T>,
    temperature: impl Fn(&SVector<T, D>) -> T,
) -> Result<Body<T, D, B, R>, SetupError>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
{
    let points = lattice(&grid, &corners[0], &corners[1], [PER_CELL; D]);
    let mut particles = Particles::at_rest(&points, phase.density);
    for (warmth, x) in particles.phase.iter_mut().zip(&particles.position) {
        *warmth = Warmth(temperature(x));
    }
    Stepper::new(
        Setup::new(
            grid,
            basis,
            reconstruction,
            LinearElastic {
                moduli: Moduli::uniaxial(T::lit(YOUNGS_MODULUS))?,
            },
            phase,
            particles,
        )
        .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent)),
    )
}

/// A grid of so many cells along each side, and its corners: a body that fills it.
pub fn filled<T: Scalar, const D: usize>(
    cells: usize,
) -> Result<(Grid<T, D>, [SVector<T, D>; 2]), GridError> {
    let corners = [0.0, LENGTH].map(|x| SVector::repeat(T::lit(x)));
    let [min, max] = corners;
    Ok((Grid::new(min, max, [cells; D])?, corners))
}

/// `cos(pi x/L)` along each axis: no flux at the ends.
pub fn cosine<T: Scalar, const D: usize>(x: &SVector<T, D>) -> T {
    let wave = T::pi() / T::lit(LENGTH);
    x.iter().fold(T::one(), |product, &x| product * (wave * x).cos())
}

/// How much of the cosine is in the temperature: 1 at the start.
pub fn amplitude<T: Scalar, const D: usize, B, R>(body: &Body<T, D, B, R>) -> T
where
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
{
    let particles = body.particles();
    let (mut found, mut whole) = (T::zero(), T::zero());
    for (warmth, x) in particles.phase.iter().zip(&particles.initial_position) {
        let shape = cosine(x);
        found += warmth.0 * shape;
        whole += shape * shape;
    }
    found / whole
}

/// What is left of a cosine, and the steps that it took.
#[derive(Clone, Copy, Debug)]
pub struct Decayed<T> {
    /// 1 at the start.
    pub amplitude: T,
    /// See there.
    pub steps: usize,
}

/// What is left of the cosine, of an insulated body that fills so many cells along each side, after the time
/// in which that of aluminium decays to `1/e`: `D kappa (pi/L)^2 t = 1`.
pub fn decayed<T, const D: usize, B, R>(
    method: (B, R),
    cells: usize,
    phase: Conduction<T>,
) -> Result<Decayed<T>, Box<dyn Error>>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D> + Clone,
{
    let mut body = body(method, filled::<T, D>(cells)?, phase, cosine)?;
    let stiffness = body.stiffness(&Forcing::none()).ok_or("nothing moves")?;
    // Nothing pushes the body: only heat limits the step.
    let limit = 2.0 / (diffusivity() * stiffness.primal());
    let time = (LENGTH / PI).powi(2) / (D as f64 * diffusivity());
    let steps = (time / (0.2 * limit)).ceil() as usize;
    for _ in 0..steps {
        body.step(T::lit(time / steps as f64), &Forcing::none())?;
    }
    Ok(Decayed {
        amplitude: amplitude(&body),
        steps,
    })
}

/// What becomes of a bar that is warmed by `1 + cos(pi x/L)` kelvin, between walls or held at one end.
#[derive(Clone, Copy, Debug)]
pub struct Warmed {
    /// Range of the temperature (K) at the end.
    pub temperature: [f64; 2],
    /// Stress (Pa), and elongation of the whole, about which it swings.
    pub stress: f64,
    /// See there.
    pub elongation: f64,
}

/// Warms the bar and waits for ten times the period in which the bar swings.
pub fn warmed(between_walls: bool) -> Result<Warmed, Box<dyn Error>> {
    let cells = 20;
    let (grid, corners) = filled::<f64, 1>(cells)?;
    // Room to expand into.
    let grid = if between_walls {
        grid
    } else {
        Grid::new(vector![0.0], vector![1.1 * LENGTH], [cells + cells / 10])?
    };
    let temperature = |x: &SVector<f64, 1>| 1.0 + cosine(x);
    let phase = aluminium(true);
    let mut bar = body((Linear, Shepard), (grid, corners), phase, temperature)?;
    let [left, right] = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
    let mut forcing = Forcing::none().with_face(left, FaceCondition::fixed());
    if between_walls {
        forcing.set_face(right, FaceCondition::fixed());
    }
    let stiffness = bar.stiffness(&forcing).ok_or("nothing resists a motion")?;
    let limit = bar
        .largest_step(stiffness)
        .ok_or("nothing resists a motion")?
        .step;
    // Held at one end it swings in four times the time that a wave takes to the other.
    let period = 4.0 * LENGTH / (YOUNGS_MODULUS / DENSITY).sqrt();
    let (wait, swing) = (20.0 * period, 20.0 * period);
    let steps = (swing / (0.5 * limit)).ceil();
    let step = swing / steps;
    for _ in 0..(wait / step).ceil() as usize {
        bar.step(step, &forcing)?;
    }
    // The mean of what swings, with weights that forget where the swing began and ended.
    let (mut stress, mut elongation, mut weights) = (0.0, 0.0, 0.0);
    for n in 0..steps as usize {
        bar.step(step, &forcing)?;
        let weight = (PI * (n as f64 + 0.5) / steps).sin().powi(2);
        let particles = bar.particles();
        let last = particles.len() - 1;
        let middle = particles.len() / 2;
        let total = phase.total_stress(&particles.stress[middle], &particles.phase[middle])[(0, 0)];
        stress += weight * total;
        elongation += weight * particles.displacement[last][0] / particles.initial_position[last][0];
        weights += weight;
    }
    let temperatures = bar.particles().phase.iter().map(|warmth| warmth.0);
    let range = temperatures.fold([f64::MAX, f64::MIN], |[low, high], t| [low.min(t), high.max(t)]);
    Ok(Warmed {
        temperature: range,
        stress: stress / weights,
        elongation: elongation / weights,
    })
}

/// What was found.
#[derive(Clone, Copy, Debug)]
pub struct Findings {
    /// The cosine in the bar and in the plate when `1/e` is left.
    pub decayed: [Decayed<f64>; 2],
    /// The bar between walls, and held at one end.
    pub warmed: [Warmed; 2],
}

/// Lets the cosine decay and warms the bar.
pub fn run() -> Result<Findings, Box<dyn Error>> {
    Ok(Findings {
        decayed: [
            decayed::<f64, 1, _, _>((Linear, Shepard), 20, aluminium(false))?,
            decayed::<f64, 2, _, _>((Linear, Shepard), 20, aluminium(false))?,
        ],
        warmed: [warmed(true)?, warmed(false)?],
    })
}

// The tests include this file as a module and call its functions themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    let Findings { decayed, warmed } = run()?;
    for (body, Decayed { amplitude, steps }) in ["bar", "plate"].into_iter().zip(decayed) {
        let share = amplitude * 1.0_f64.exp();
        println!("after {steps} steps {share:.4} of what theory says is left of the cosine in the {body}");
    }
    let [held, free] = warmed;
    let [low, high] = held.temperature;
    println!("the temperature of the bar becomes even, {low:.4} to {high:.4} K");
    let (stress, expected) = (held.stress / 1e6, -YOUNGS_MODULUS * EXPANSION / 1e6);
    println!("between walls it is stressed by {stress:.4} MPa; -E alpha theta = {expected:.4}");
    let (elongation, expected) = (1e6 * free.elongation, 1e6 * EXPANSION);
    println!("held at one end it grows by {elongation:.3} millionths; alpha theta = {expected:.3}");
    Ok(())
}
