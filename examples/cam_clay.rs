//! Modified Cam-Clay as a law of your own: what a plastic soil with a history needs, in one file.
//!
//! The law is that of Roscoe & Burland (1968) at finite strain: the elastic stretch is carried as `b_e`,
//! stresses are Kirchhoff's `tau = J sigma`, the return is implicit in the elastic logarithmic strains (Borja
//! & Lee 1990; Borja & Tamagnini 1998), and both lines of isotropic compression are straight in `ln v` over
//! `ln p` (Butterfield 1979).
//!
//! `cargo run --release --example cam_clay`

use std::error::Error;

use materialpoint::basis::Linear;
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{AnyLaw, ConstitutiveLaw, ElasticStretch, Moduli, hooke_strain};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::Shepard;
use materialpoint::record::Record;
use materialpoint::scalar::Scalar;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use materialpoint::tensor::{Spectral, determinant, symmetric};
use nalgebra::{Matrix2, Matrix3, SMatrix, vector};

/// Most iterations of a return, a start or a secant method; Newton's method takes a handful, and a return
/// halves its bracket where that fails.
const ITERATIONS: usize = 60;

/// Modified Cam-Clay. With pressure `p`, Mises' stress `q` and logarithmic strains, pressure and compression
/// positive:
///
/// * elastic: `p = a exp(e_v / kappa)`, `q = 3 mu e_s`;
/// * yield surface: `f = q^2 + M^2 p (p - p_c) <= 0`, associated flow;
/// * hardening: `p_c = p_c0 exp(e_v^p / (lambda - kappa))`.
///
/// All pressures count from the attraction `a` (Janbu 1973), so that the mean stress is `a - p`: soil without
/// load is at `p = a`, has a stiffness there, and so has an undeformed state that is free of stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamClay<T> {
    /// Slope `lambda` of the line of virgin compression, `-d ln v / d ln p`.
    pub compression: T,
    /// Slope `kappa` of the lines of unloading, less than that.
    pub swelling: T,
    /// Slope `M` of the critical state line `q = M p`.
    pub critical_slope: T,
    /// Shear modulus `mu` (Pa). A constant one, because the energy of one that follows the pressure couples
    /// `p` to `e_s`.
    pub shear_modulus: T,
    /// Attraction `a` (Pa): cohesion over the tangent of the friction angle.
    pub attraction: T,
    /// Preconsolidation pressure `p_c0` (Pa) of the material before it moves.
    pub preconsolidation: T,
}

/// What a particle of [`CamClay`] remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClayState<T, const D: usize> {
    /// Elastic stretch from the unloaded material.
    pub stretch: ElasticStretch<T, D>,
    /// Volume over that of the unloaded material at the start, elastic and plastic.
    pub volume: T,
    /// `ln(p_c / p_c0)`: a default knows no constants of the law, so it keeps what scales with them as a
    /// ratio.
    pub hardening: T,
    /// Accumulated plastic strain: integral of `sqrt(2/3 e : e)` with the deviator `e` of the plastic strain
    /// rate.
    pub plastic_strain: T,
}

impl<T: Scalar, const D: usize> Default for ClayState<T, D> {
    fn default() -> Self {
        Self {
            stretch: ElasticStretch::default(),
            volume: T::one(),
            hardening: T::zero(),
            plastic_strain: T::zero(),
        }
    }
}

/// The state as numbers: for checkpoints, and for a law that is chosen at run time.
impl<T: Scalar, const D: usize> Record<T> for ClayState<T, D> {
    fn put(&self, out: &mut impl FnMut(T)) {
        self.stretch.put(out);
        [self.volume, self.hardening, self.plastic_strain].put(out);
    }

    fn take(from: &mut impl FnMut() -> T) -> Option<Self> {
        Some(Self {
            stretch: Record::take(from)?,
            volume: from(),
            hardening: from(),
            plastic_strain: from(),
        })
    }
}

/// Elastic logarithmic strain, tension positive: its trace, its deviator in the grid's axes, and the deviator
/// along each axis that the grid does not have.
///
/// The logarithm is taken of the tensor and not of principal values, which keeps derivatives by dual numbers
/// right where principal values are equal.
struct Strain<T, const D: usize> {
    volume: T,
    deviator: SMatrix<T, D, D>,
    off_plane: T,
}

/// Axes that the grid does not have.
fn missing<T: Scalar, const D: usize>() -> T {
    T::count(3 - D)
}

impl<T: Scalar, const D: usize> Strain<T, D> {
    fn of(stretch: &ElasticStretch<T, D>) -> Self {
        let half = T::one() / T::lit(2.0);
        let strain = Spectral::of(&stretch.b).map(|b| b.ln() * half);
        let off_plane = stretch.off_plane.ln() * half;
        let volume = strain.trace() + missing::<T, D>() * off_plane;
        let mean = volume / T::lit(3.0);
        Self {
            volume,
            deviator: strain - SMatrix::identity() * mean,
            off_plane: off_plane - mean,
        }
    }

    fn stretch(&self) -> ElasticStretch<T, D> {
        let mean = self.volume / T::lit(3.0);
        let strain = self.deviator + SMatrix::identity() * mean;
        let off_plane = self.off_plane + mean;
        ElasticStretch {
            b: Spectral::of(&strain).map(|e| (e + e).exp()),
            off_plane: if D < 3 {
                (off_plane + off_plane).exp()
            } else {
                T::one()
            },
        }
    }

    /// `e_s = sqrt(2/3 e : e)`; that of zero has no derivative, not one that is no number.
    fn shear(&self) -> T {
        let squared = self.deviator.norm_squared() + missing::<T, D>() * self.off_plane * self.off_plane;
        if squared.is_zero() {
            return T::zero();
        }
        (squared * T::lit(2.0) / T::lit(3.0)).sqrt()
    }
}

/// A trial state outside the yield surface, stresses over its preconsolidation pressure.
struct Trial<T> {
    /// `ln(p / p_c)`.
    log_pressure: T,
    /// `q / p_c`.
    mises: T,
    /// `mu / p_c`.
    shear_modulus: T,
}

/// Where a return ends.
struct Returned<T> {
    /// Plastic compression of this step, `ln` of the volume.
    compression: T,
    /// What is left of the deviator of the elastic strain.
    share: T,
}

impl<T: Scalar> CamClay<T> {
    /// Pressure over preconsolidation pressure, and that over what it was, after the plastic compression `x`.
    fn pressures(&self, trial: &Trial<T>, x: T) -> (T, T) {
        let pressure = (trial.log_pressure - x / self.swelling).exp();
        (pressure, (x / (self.compression - self.swelling)).exp())
    }

    /// What is left of the deviator by the flow rule, and its derivative by `x`. With the plastic multiplier
    /// `g`, `x = g M^2 (2 p - p_c)` and `q = q_trial / (1 + 6 mu g)`.
    fn share(&self, trial: &Trial<T>, x: T) -> (T, T) {
        let (pressure, limit) = self.pressures(trial, x);
        let (two, six_mu) = (T::lit(2.0), T::lit(6.0) * trial.shear_modulus);
        let square = self.critical_slope * self.critical_slope;
        let normal = square * (two * pressure - limit);
        let slope = -square * (two * pressure / self.swelling + limit / (self.compression - self.swelling));
        let all = normal + six_mu * x;
        (normal / all, six_mu * (slope * x - normal) / (all * all))
    }

    /// The yield function after the plastic compression `x`, and its derivative.
    fn excess(&self, trial: &Trial<T>, x: T) -> (T, T) {
        let (pressure, limit) = self.pressures(trial, x);
        let (share, share_slope) = self.share(trial, x);
        let (two, square) = (T::lit(2.0), self.critical_slope * self.critical_slope);
        let mises = trial.mises * trial.mises;
        let value = mises * share * share + square * pressure * (pressure - limit);
        let by_pressure = (two * pressure - limit) * (-pressure / self.swelling);
        let by_limit = -pressure * limit / (self.compression - self.swelling);
        let slope = two * mises * share * share_slope + square * (by_pressure + by_limit);
        (value, slope)
    }

    /// The implicit return as one equation for the plastic compression `x`; `None` inside the yield surface.
    ///
    /// It always has a solution between no flow (or, for trial pressures beyond `p_c`, isotropic flow alone)
    /// and the compression that leads to the critical state `2 p = p_c`: at the first end the yield function
    /// is not negative, at the second no deviator is left and it is not positive. Newton's steps that leave
    /// the bracket are replaced by halving it.
    fn return_of(&self, trial: &Trial<T>) -> Option<Returned<T>> {
        let (one, two) = (T::one(), T::lit(2.0));
        let square = self.critical_slope * self.critical_slope;
        let pressure = trial.log_pressure.exp();
        let excess = trial.mises * trial.mises + square * pressure * (pressure - one);
        // Also leaves alone what is not a number.
        let yields = excess > T::zero();
        if !yields {
            return None;
        }
        let both = one / self.swelling + one / (self.compression - self.swelling);
        let isotropic = (trial.log_pressure / both).max(T::zero());
        let critical = (trial.log_pressure + two.ln()) / both;
        let (mut outside, mut inside) = if critical > T::zero() {
            (isotropic, critical)
        } else {
            (T::zero(), critical)
        };
        let enough = T::default_epsilon() * self.swelling;
        let mut x = outside;
        for _ in 0..ITERATIONS {
            let (value, slope) = self.excess(trial, x);
            if value > T::zero() {
                outside = x;
            } else {
                inside = x;
            }
            let newton = x - value / slope;
            let within = (newton - outside) * (newton - inside) < T::zero();
            let next = if within { newton } else { (outside + inside) / two };
            let change = (next - x).abs();
            x = next;
            if change <= enough {
                break;
            }
        }
        // A last step of Newton's gives `x` the derivatives that halving does not know.
        let (value, slope) = self.excess(trial, x);
        let polish = value / slope;
        if polish.is_finite() {
            x -= polish;
        }
        let (pressure, limit) = self.pressures(trial, x);
        // Near the critical state the flow rule divides nothing by nothing, near isotropic stress the yield
        // surface has a root of nothing: each is used far from there.
        let share = if (two * pressure - limit).abs() * two > limit {
            self.share(trial, x).0
        } else {
            self.critical_slope * (pressure * (limit - pressure)).sqrt() / trial.mises
        };
        Some(Returned {
            compression: x,
            share,
        })
    }

    /// Kirchhoff's mean stress, `a - p`.
    fn mean(&self, volume: T) -> T {
        -self.attraction * (-volume / self.swelling).exp_m1()
    }

    /// Hooke's constants now, of Kirchhoff's stress.
    fn moduli(&self, log_volume: T) -> Moduli<T> {
        let bulk = self.attraction / self.swelling * (-log_volume / self.swelling).exp();
        let mu = self.shear_modulus;
        let lambda = bulk - (mu + mu) / T::lit(3.0);
        Moduli { lambda, mu }
    }

    /// Kirchhoff's stress in the grid's axes and along each of the others.
    fn kirchhoff<const D: usize>(&self, strain: &Strain<T, D>) -> (SMatrix<T, D, D>, T) {
        let (mean, two_mu) = (self.mean(strain.volume), self.shear_modulus + self.shear_modulus);
        (
            strain.deviator * two_mu + SMatrix::identity() * mean,
            strain.off_plane * two_mu + mean,
        )
    }

    fn trial<const D: usize>(&self, strain: &Strain<T, D>, hardening: T) -> Trial<T> {
        let limit = self.preconsolidation * hardening.exp();
        let at_rest = (self.attraction / self.preconsolidation).ln();
        Trial {
            log_pressure: at_rest - strain.volume / self.swelling - hardening,
            mises: T::lit(3.0) * self.shear_modulus * strain.shear() / limit,
            shear_modulus: self.shear_modulus / limit,
        }
    }

    /// Elastic logarithmic volume strain under a sum of `count` normal Cauchy stresses (Pa), of which the
    /// axes that are left out are not strained: `count (a - p) + (3 - count) 2/3 mu e_v = J sum`. Newton's
    /// method from where no deviator is.
    fn log_volume(&self, sum: T, count: usize) -> Option<T> {
        let counted = T::count(count);
        let others = T::lit(2.0) * self.shear_modulus * T::count(3 - count) / T::lit(3.0);
        let first = T::one() - sum / (counted * self.attraction);
        if first <= T::zero() {
            return None;
        }
        let mut volume = -self.swelling * first.ln();
        for _ in 0..ITERATIONS {
            let bulk = counted * self.attraction / self.swelling * (-volume / self.swelling).exp();
            let load = sum * volume.exp();
            let change = (counted * self.mean(volume) + others * volume - load) / (bulk + others - load);
            volume -= change;
            if change.abs() <= T::lit(4.0) * T::default_epsilon() * self.swelling.max(volume.abs()) {
                return Some(volume);
            }
        }
        None
    }
}

impl<T: Scalar, const D: usize> ConstitutiveLaw<T, D> for CamClay<T> {
    type State = ClayState<T, D>;

    fn large_strain(&self) -> bool {
        true
    }

    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, state: &mut Self::State) {
        // Elastic trial: the whole increment stretches the material elastically.
        let f = SMatrix::identity() + increment;
        state.stretch.b = symmetric(&(f * state.stretch.b * f.transpose()));
        state.volume *= determinant(&f);
        let mut strain = Strain::of(&state.stretch);
        if let Some(returned) = self.return_of(&self.trial(&strain, state.hardening)) {
            state.hardening += returned.compression / (self.compression - self.swelling);
            state.plastic_strain += (T::one() - returned.share) * strain.shear();
            strain.volume += returned.compression;
            strain.deviator *= returned.share;
            strain.off_plane *= returned.share;
            state.stretch = strain.stretch();
        }
        *stress = self.kirchhoff(&strain).0 / state.volume;
    }

    /// Material that lies on the yield surface or within; how far within says `preconsolidation`.
    fn start(&self, stress: &SMatrix<T, D, D>, off_plane: Option<T>) -> Option<Self::State> {
        let told = off_plane.filter(|_| D < 3);
        let sum = stress.trace() + told.map_or(T::zero(), |s| missing::<T, D>() * s);
        let log_volume = self.log_volume(sum, if told.is_some() { 3 } else { D })?;
        let volume = log_volume.exp();
        let (mean, two_mu) = (self.mean(log_volume), self.shear_modulus + self.shear_modulus);
        let strain = Strain {
            volume: log_volume,
            deviator: (symmetric(stress) * volume - SMatrix::identity() * mean) / two_mu,
            // Without strain along an axis its deviator is what takes the mean strain away.
            off_plane: told.map_or(-log_volume / T::lit(3.0), |s| (s * volume - mean) / two_mu),
        };
        let Trial {
            log_pressure, mises, ..
        } = self.trial(&strain, T::zero());
        let (pressure, square) = (log_pressure.exp(), self.critical_slope * self.critical_slope);
        let excess = mises * mises + square * pressure * (pressure - T::one());
        (excess <= T::default_epsilon().sqrt()).then(|| ClayState {
            stretch: strain.stretch(),
            volume,
            ..ClayState::default()
        })
    }

    fn elastic_constants(&self) -> Option<Moduli<T>> {
        Some(self.moduli(T::zero()))
    }

    /// By the stiffness now: under pressure the bulk modulus is many times that at rest, and the shear
    /// modulus is not.
    fn strain_for(
        &self,
        change: &SMatrix<T, D, D>,
        _density: T,
        _stress: &SMatrix<T, D, D>,
        state: &Self::State,
    ) -> Option<SMatrix<T, D, D>> {
        let moduli = self.moduli(log_elastic_volume(&state.stretch));
        Some(hooke_strain(&moduli, &(change * state.volume)))
    }

    /// That of elastic waves, which plastic ones never outrun: `(K + 4/3 mu)/J - sigma` along the most
    /// compressed axis.
    fn wave_speed(&self, density: T, stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        let values = Spectral::of(stress).values;
        let lowest = values.iter().fold(values[0], |lowest, &s| lowest.min(s));
        let p_wave = self.moduli(log_elastic_volume(&state.stretch)).p_wave();
        ((p_wave / state.volume - lowest).max(T::zero()) / density).sqrt()
    }

    fn off_plane_stress(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> Option<T> {
        (D < 3).then(|| self.kirchhoff(&Strain::of(&state.stretch)).1 / state.volume)
    }

    fn plastic_strain(&self, state: &Self::State) -> Option<T> {
        Some(state.plastic_strain)
    }

    /// The elastic energy, `a (e_v + kappa (exp(-e_v / kappa) - 1)) + mu e : e` per unloaded volume; what
    /// hardening stores is counted as dissipated.
    fn energy_density(&self, _stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
        let strain = Strain::of(&state.stretch);
        let (volume, shear) = (strain.volume, strain.shear());
        let bulk = volume + self.swelling * (-volume / self.swelling).exp_m1();
        let shear = T::lit(1.5) * self.shear_modulus * shear * shear;
        (self.attraction * bulk + shear) / state.volume
    }
}

/// Logarithm of the elastic volume ratio.
fn log_elastic_volume<T: Scalar, const D: usize>(stretch: &ElasticStretch<T, D>) -> T {
    (determinant(&stretch.b).ln() + missing::<T, D>() * stretch.off_plane.ln()) / T::lit(2.0)
}

/// A soft clay under 100 kPa, overconsolidated by `ratio`: `p_c0 = ratio p_0`.
pub fn clay(ratio: f64) -> CamClay<f64> {
    CamClay {
        compression: 0.1,
        swelling: 0.02,
        critical_slope: 1.0,
        shear_modulus: 5e6,
        attraction: 2e3,
        preconsolidation: ratio * CONFINEMENT,
    }
}

/// Pressure (Pa) at the start of all runs, from the attraction and in Kirchhoff's stress.
const CONFINEMENT: f64 = 1e5;

/// Pressure from the attraction and Mises' stress of a principal stress; both Kirchhoff's, as the law has
/// them.
#[derive(Clone, Copy, Debug)]
pub struct Invariants {
    /// `p` (Pa).
    pub pressure: f64,
    /// `q` (Pa).
    pub mises: f64,
}

impl Invariants {
    fn of(law: &CamClay<f64>, cauchy: &Matrix3<f64>, volume: f64) -> Self {
        let kirchhoff = cauchy * volume;
        let mean = kirchhoff.trace() / 3.0;
        let deviator = kirchhoff - Matrix3::identity() * mean;
        Self {
            pressure: law.attraction - mean,
            mises: 1.5_f64.sqrt() * deviator.norm(),
        }
    }
}

/// The isotropic Cauchy stress (Pa) that belongs to [`CONFINEMENT`], with the volume ratio of the clay under
/// it.
fn confined(law: &CamClay<f64>) -> (f64, f64) {
    let volume = (CONFINEMENT / law.attraction).powf(-law.swelling);
    ((law.attraction - CONFINEMENT) / volume, volume)
}

/// One piece of clay in space.
#[derive(Clone, Copy)]
struct Specimen {
    law: CamClay<f64>,
    stress: Matrix3<f64>,
    state: ClayState<f64, 3>,
}

impl Specimen {
    /// Under [`CONFINEMENT`].
    fn new(law: CamClay<f64>) -> Result<Self, Box<dyn Error>> {
        let stress = Matrix3::identity() * confined(&law).0;
        let state = law.start(&stress, None);
        let state = state.ok_or("the clay does not bear its confinement")?;
        Ok(Self { law, stress, state })
    }

    /// Stretched along the axes.
    fn stretch(&mut self, increments: [f64; 3]) {
        let increment = Matrix3::from_diagonal(&increments.into());
        self.law.update(&increment, &mut self.stress, &mut self.state);
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&self.law, &self.stress, self.state.volume)
    }

    /// `ln v` and `ln p`.
    fn point(&self) -> [f64; 2] {
        [self.state.volume.ln(), self.invariants().pressure.ln()]
    }
}

/// Slopes `-d ln v / d ln p` of a compression by a tenth of the volume and of the unloading by a hundredth
/// after it.
pub fn isotropic() -> Result<[f64; 2], Box<dyn Error>> {
    let mut clay = Specimen::new(clay(1.0))?;
    Ok([-1e-3, 1e-4].map(|increment| {
        let before = clay.point();
        (0..33).for_each(|_| clay.stretch([increment; 3]));
        let after = clay.point();
        (before[0] - after[0]) / (after[1] - before[1])
    }))
}

/// What an undrained shear leads to.
#[derive(Clone, Copy, Debug)]
pub struct Undrained {
    /// Stress at the end.
    pub end: Invariants,
    /// `p_0 (R/2)^(1 - kappa/lambda)`.
    pub expected_pressure: f64,
    /// Largest distance of the path on the yield surface, in `p`, from the closed one,
    /// `p = p_0 (R M^2 / (M^2 + (q/p)^2))^(1 - kappa/lambda)`, over `p_0`.
    pub path_error: f64,
    /// Largest distance of the plastic shear strain from the closed one,
    /// `kappa/M (1 - kappa/lambda) (ln((M + q/p)/(M - q/p)) - 2 atan(q/(M p)))`, over its scale
    /// `kappa/M (1 - kappa/lambda)`; of clay on the yield surface from the start.
    pub strain_error: f64,
}

/// Simple shear in plane strain through the stepper: a single cell, whose DOFs all move as they are told.
/// Nothing changes the volume, as in saturated clay that cannot drain, so that the stress must end at the
/// critical state.
pub fn undrained(ratio: f64, steps: u32) -> Result<Undrained, Box<dyn Error>> {
    let clay = clay(ratio);
    let (shear, density) = (0.5, 2e3);
    // The law chosen at run time: the stepper keeps its states as numbers.
    let law: AnyLaw<f64, 2> = AnyLaw::new(clay);
    let grid = Grid::new(vector![0.0, 0.0], vector![3.0, 1.0], [3, 1])?;
    let points = lattice(&grid, &vector![0.0, 0.0], &vector![1.0, 1.0], [2, 2]);
    let mut particles = Particles::at_rest(&points, density);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        v[0] = shear * x[1];
    }
    let (stress, volume) = confined(&clay);
    particles.stress.fill(Matrix2::identity() * stress);
    particles.state = law.at_rest(particles.len());
    particles.start_under_stress(&law, |_, _| Some(stress))?;
    let mut stepper = Stepper::new(Setup::new(grid, Linear, Shepard, law, OnePhase, particles))?;
    let face = |side| Face { axis: 1, side };
    let top = FaceCondition::moving(vector![shear, 0.0], vector![0.0, 0.0]);
    let forcing = Forcing::none()
        .with_face(face(Side::Min), FaceCondition::fixed())
        .with_face(face(Side::Max), top);

    let (m, kappa) = (clay.critical_slope, clay.swelling);
    let exponent = 1.0 - kappa / clay.compression;
    let scale = kappa * exponent / m;
    let mut found = Undrained {
        end: Invariants {
            pressure: CONFINEMENT,
            mises: 0.0,
        },
        expected_pressure: CONFINEMENT * (ratio / 2.0).powf(exponent),
        path_error: 0.0,
        strain_error: 0.0,
    };
    for _ in 0..steps {
        stepper.step(1.0 / f64::from(steps), &forcing)?;
        let fields = stepper.material_fields();
        let (Some(stress), Some(&off_plane), Some(&plastic)) = (
            stepper.particles().stress.first(),
            fields.off_plane_stress.first(),
            fields.plastic_strain.first(),
        ) else {
            return Err("the law knows no stress off the plane".into());
        };
        let mut cauchy = stress.fixed_resize(0.0);
        cauchy[(2, 2)] = off_plane;
        found.end = Invariants::of(&clay, &cauchy, volume);
        if plastic > 0.0 {
            let Invariants { pressure, mises } = found.end;
            let eta = mises / pressure;
            let closed = CONFINEMENT * (ratio * m * m / (m * m + eta * eta)).powf(exponent);
            found.path_error = found.path_error.max((pressure - closed).abs() / CONFINEMENT);
            // Where the logarithm of what is left to the critical state still has digits.
            if m - eta > 1e-3 * m {
                let closed = ((m + eta) / (m - eta)).ln() - 2.0 * (eta / m).atan();
                found.strain_error = found.strain_error.max((plastic / scale - closed).abs());
            }
        }
    }
    Ok(found)
}

/// What a drained triaxial compression leads to.
#[derive(Clone, Copy, Debug)]
pub struct Drained {
    /// Stress at the end.
    pub end: Invariants,
    /// Where the path `q = 3 (p - p_0)` of Cauchy's stress meets the critical state line.
    pub expected_pressure: f64,
    /// Logarithm of the volume over that at the start.
    pub log_volume: f64,
    /// The same on the critical state line: `-kappa ln(p/p_0) - (lambda - kappa) ln(2 p / p_c0)` at the
    /// expected pressure.
    pub expected_log_volume: f64,
}

/// Triaxial compression of a specimen to a quarter of its height, far beyond what a test in a laboratory
/// bears, under a constant stress at its sides: the path ends at the critical state.
pub fn drained(ratio: f64, steps: u32) -> Result<Drained, Box<dyn Error>> {
    let law = clay(ratio);
    let (side, volume) = confined(&law);
    let mut clay = Specimen::new(law)?;
    let axial = -4.0_f64.ln() / f64::from(steps);
    let mut lateral = 0.0;
    for _ in 0..steps {
        // The strain of the sides that keeps the stress there, by the secant method.
        let after = |lateral: f64| {
            let mut clay = clay;
            clay.stretch([axial.exp_m1(), lateral, lateral]);
            (clay, clay.stress[(1, 1)] - side)
        };
        let mut before = (lateral, after(lateral).1);
        lateral -= 0.1 * axial;
        let mut excess = after(lateral).1;
        for _ in 0..ITERATIONS {
            if excess.abs() <= 1e-12 * side.abs() || excess == before.1 {
                break;
            }
            let next = lateral - excess * (lateral - before.0) / (excess - before.1);
            before = (lateral, excess);
            lateral = next;
            excess = after(lateral).1;
        }
        if excess.is_nan() || excess.abs() > 1e-9 * side.abs() {
            return Err("no strain of the sides keeps the stress there".into());
        }
        clay = after(lateral).0;
    }
    // `q = 3 (p - p_0)` with the mean Cauchy stress, `J q = M (a - J tr(sigma)/3)`.
    let (m, kappa, current) = (law.critical_slope, law.swelling, clay.state.volume);
    let mean = (3.0 * side - m * law.attraction / current) / (3.0 - m);
    let pressure = law.attraction - current * mean;
    let hardening = (law.compression - kappa) * (2.0 * pressure / law.preconsolidation).ln();
    Ok(Drained {
        end: clay.invariants(),
        expected_pressure: pressure,
        log_volume: (current / volume).ln(),
        expected_log_volume: -kappa * (pressure / CONFINEMENT).ln() - hardening,
    })
}

/// All that the tests hold.
#[derive(Clone, Debug)]
pub struct Found {
    /// See [`isotropic`].
    pub slopes: [f64; 2],
    /// Overconsolidation ratios and what they lead to.
    pub undrained: Vec<(f64, Undrained)>,
    /// The same.
    pub drained: Vec<(f64, Drained)>,
}

/// Compresses clay, shears it without and with drainage.
pub fn run() -> Result<Found, Box<dyn Error>> {
    let ratios = [1.0, 2.0, 4.0];
    Ok(Found {
        slopes: isotropic()?,
        undrained: ratios
            .into_iter()
            .map(|ratio| Ok((ratio, undrained(ratio, 1000)?)))
            .collect::<Result<_, Box<dyn Error>>>()?,
        drained: ratios
            .into_iter()
            .map(|ratio| Ok((ratio, drained(ratio, 1000)?)))
            .collect::<Result<_, Box<dyn Error>>>()?,
    })
}

// The tests include this file as a module and call `run` themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    let found = run()?;
    let [virgin, unloading] = found.slopes;
    println!("slopes in ln v over ln p: {virgin:.6} (lambda = 0.1), {unloading:.6} (kappa = 0.02)");
    for (ratio, undrained) in &found.undrained {
        let Invariants { pressure, mises } = undrained.end;
        println!(
            "undrained, R = {ratio}: p = {:.3} kPa (closed form: {:.3}), q/p = {:.6} (M = 1), path {:.1e}, \
             plastic strain {:.1e}",
            pressure / 1e3,
            undrained.expected_pressure / 1e3,
            mises / pressure,
            undrained.path_error,
            undrained.strain_error
        );
    }
    for (ratio, drained) in &found.drained {
        let Invariants { pressure, mises } = drained.end;
        println!(
            "drained, R = {ratio}: p = {:.3} kPa (closed form: {:.3}), q/p = {:.6} (M = 1), ln v/v0 = {:.6} \
             (closed form: {:.6})",
            pressure / 1e3,
            drained.expected_pressure / 1e3,
            mises / pressure,
            drained.log_volume,
            drained.expected_log_volume
        );
    }
    Ok(())
}
