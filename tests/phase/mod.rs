//! A phase of one's own: pore water that cannot move against the solid (the undrained limit).
//!
//! Water of bulk modulus K in pores of porosity n adds the pressure rate (K/n) tr d to the effective stress.
//! In uniaxial strain a bar of modulus E then behaves as a dry bar of modulus E + K/n: same displacements,
//! total stress shared as E to K/n.

use materialpoint::basis::BSpline;
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{OnePhase, Phase, PhaseStep};
use materialpoint::reconstruction::{Reconstruction, Relaxation, RelaxedTaylor, Shepard, Taylor};
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use nalgebra::{SMatrix, vector};

/// `stiffness` is K/n (Pa); a particle carries its pore pressure, tension positive (Pa).
#[derive(Clone, Copy, Debug)]
struct LockedWater {
    stiffness: f64,
}

impl<const D: usize> Phase<f64, D> for LockedWater {
    const COUPLED: bool = true;
    type Particle = f64;

    fn total_stress(&self, effective: &SMatrix<f64, D, D>, pressure: &f64) -> SMatrix<f64, D, D> {
        effective + SMatrix::identity() * *pressure
    }

    fn update(&self, step: &PhaseStep<'_, f64, D>, pressure: &mut f64) {
        *pressure += self.stiffness * step.solid.trace();
    }
}

fn fixed_ends() -> Forcing<f64, 1> {
    let ends = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
    ends.into_iter()
        .fold(Forcing::none(), |f, end| f.with_face(end, FaceCondition::fixed()))
}

fn bar<R: Reconstruction<f64, 1>, P: Phase<f64, 1>>(
    reconstruction: R,
    modulus: f64,
    phase: P,
) -> Stepper<f64, 1, BSpline<2>, R, LinearElastic<f64>, P> {
    let grid = Grid::new(vector![0.0], vector![1.0], [10]).unwrap();
    let points = lattice(&grid, grid.min(), grid.max(), [6]);
    let mut particles = Particles::at_rest(&points, 2e3);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        v[0] = 0.1 * (std::f64::consts::PI * x[0]).sin();
    }
    let moduli = Moduli::uniaxial(modulus).unwrap();
    Stepper::new(
        Setup::new(
            grid,
            BSpline::<2>,
            reconstruction,
            LinearElastic { moduli },
            phase,
            particles,
        )
        .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent)),
    )
    .unwrap()
}

fn compare<R: Reconstruction<f64, 1> + Clone>(reconstruction: R) {
    let (solid, water) = (3e6, 4e6);
    let mut wet = bar(reconstruction.clone(), solid, LockedWater { stiffness: water });
    let mut dry = bar(reconstruction, solid + water, OnePhase);
    let forcing = fixed_ends();
    let steps = [wet.critical_step(&forcing), dry.critical_step(&forcing)].map(|limit| limit.unwrap().step);
    approx::assert_relative_eq!(steps[0], steps[1], max_relative = 1e-6);
    // The step that a scene takes without being told one: it must feel the phase too.
    let automatic = [wet.largest_step(400.0), dry.largest_step(400.0)].map(|limit| limit.unwrap().step);
    approx::assert_relative_eq!(automatic[0], automatic[1], max_relative = 1e-12);
    for _ in 0..200 {
        wet.step(2e-5, &forcing).unwrap();
        dry.step(2e-5, &forcing).unwrap();
    }
    let (wet, dry) = (wet.particles(), dry.particles());
    for p in 0..dry.len() {
        let total = wet.stress[p][(0, 0)] + wet.phase[p];
        let size = 0.1 * (7e6_f64 * 2e3).sqrt();
        approx::assert_abs_diff_eq!(total, dry.stress[p][(0, 0)], epsilon = 1e-9 * size);
        approx::assert_abs_diff_eq!(
            wet.phase[p] / water,
            wet.stress[p][(0, 0)] / solid,
            epsilon = 1e-12
        );
    }
    assert!(wet.phase.iter().any(|p| p.abs() > 1e3), "the bar does swing");
}

#[test]
fn locked_pore_water_stiffens_the_bar_by_its_own_modulus() {
    compare(Shepard);
    compare(Taylor::<f64, 1, 3>::new());
}

/// Largest difference of displacement between a bar stiffened by its water and a dry one as stiff, and
/// largest displacement.
fn relaxed_difference(relaxation: Relaxation<f64>) -> (f64, f64) {
    let relaxed = || RelaxedTaylor::<f64, 1, 3>::for_degree(2).with_relaxation(relaxation);
    let mut wet = bar(relaxed(), 3e6, LockedWater { stiffness: 4e6 });
    let mut dry = bar(relaxed(), 7e6, OnePhase);
    for _ in 0..200 {
        wet.step(2e-5, &fixed_ends()).unwrap();
        dry.step(2e-5, &fixed_ends()).unwrap();
    }
    let (wet, dry) = (&wet.particles().displacement, &dry.particles().displacement);
    let most = |most: f64, u: f64| most.max(u.abs());
    let difference = wet.iter().zip(dry).map(|(a, b)| a[0] - b[0]).fold(0.0, most);
    (difference, dry.iter().map(|u| u[0]).fold(0.0, most))
}

/// The relaxation takes the effective stress towards its fit and leaves the pressure: the sum is the dry
/// bar's no longer, but the motion is still that of the stiffer bar. Towards the fit through neighbours there
/// is more to take, and the pressure does not go along: within a thousandth.
#[test]
fn a_relaxed_step_takes_a_second_phase_too() {
    let own = Relaxation {
        neighbours: 0.0,
        ..Relaxation::default()
    };
    let (difference, _) = relaxed_difference(own);
    assert!(difference < 1e-8, "{difference:e}");
    let (difference, displacement) = relaxed_difference(Relaxation::default());
    assert!(
        difference < 1e-3 * displacement,
        "{difference:e} of {displacement:e}"
    );
}

/// A phase that notes what it is told: time so far, last stress and volume, and the solid's strain so far.
#[derive(Clone, Copy, Debug)]
struct Notes;

impl Phase<f64, 1> for Notes {
    const COUPLED: bool = true;
    type Particle = [f64; 4];

    fn total_stress(&self, effective: &SMatrix<f64, 1, 1>, _: &[f64; 4]) -> SMatrix<f64, 1, 1> {
        *effective
    }

    fn update(&self, step: &PhaseStep<'_, f64, 1>, notes: &mut [f64; 4]) {
        assert_eq!(
            step.solid, step.liquid,
            "where no liquid flows it goes with the solid"
        );
        *notes = [
            notes[0] + step.dt,
            step.stress[(0, 0)],
            step.volume,
            notes[3] + step.solid.trace(),
        ];
    }
}

/// Stress and volume are those at the end of the step, and the law has seen the same strain.
#[test]
fn a_phase_is_told_of_time_stress_and_volume() {
    let mut stepper = bar(Shepard, 3e6, Notes);
    let forcing = fixed_ends();
    let (dt, steps) = (1e-5, 50);
    for _ in 0..steps {
        stepper.step(dt, &forcing).unwrap();
    }
    let particles = stepper.particles();
    let notes = particles.phase.iter().enumerate();
    let mut most = 0.0_f64;
    for (p, [time, stress, volume, strain]) in notes {
        assert!((time - f64::from(steps) * dt).abs() < 1e-12, "{time:e}");
        assert_eq!(
            (*stress, *volume),
            (particles.stress[p][(0, 0)], particles.volume[p])
        );
        assert!((3e6 * strain - stress).abs() <= 1e-9 * stress.abs() + 1e-6);
        most = most.max(stress.abs());
    }
    assert!(most > 100.0, "the bar is strained: {most:e}");
}
