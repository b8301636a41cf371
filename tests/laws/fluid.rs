//! Newtonian fluid: pressure, energy, separation, shear, and the step it allows.
//!
//! K = 2 MPa, gamma = 1 and 7, mu = 0.5 Pa s. Expected: p = K/gamma (J^-gamma - 1) to round-off; the energy
//! is the work of the pressure; no tension; Couette shear stress mu du/dy, uniaxial viscous stress 4/3 mu d;
//! a stepper hands the time on.

use super::Specimen;
use crate::compiled::parts;
use materialpoint::grid::Grid;
use materialpoint::law::{ConstitutiveLaw, NewtonianFluid, VolumeRatio};
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::particles::{Particles, lattice};
use materialpoint::stepper::Forcing;
use materialpoint_steppers::Build;
use nalgebra::{Matrix1, Matrix2, Matrix3, matrix, vector};

const BULK: f64 = 2e6;
const VISCOSITY: f64 = 0.5;

fn fluid(gamma: f64) -> NewtonianFluid<f64> {
    NewtonianFluid::new(BULK, gamma, VISCOSITY).unwrap()
}

#[test]
fn pressure_follows_the_volume() {
    for gamma in [1.0, 1.4, 7.0] {
        let law = fluid(gamma).bearing_tension();
        for j in [0.8_f64, 0.999, 1.0 - 1e-9, 1.0, 1.001, 1.2] {
            let mut specimen = Specimen::<3, _>::new(&law);
            specimen.stretch([j.ln(), 0.2, -0.2], 3);
            let exact = BULK / gamma * (j.powf(-gamma) - 1.0);
            let difference = specimen.stress + Matrix3::from_diagonal_element(exact);
            assert!(difference.norm() < 1e-14 * BULK * j.powf(-gamma), "{gamma} {j}");
        }
    }
}

/// Spray that is a thousandth as dense as the fluid meets other fluid at the speed of sound of the fluid.
#[test]
fn separated_fluid_has_the_wave_it_will_have_on_contact() {
    let law = fluid(7.0);
    let speed = |j: f64| {
        let (stress, state) = (Matrix2::zeros(), VolumeRatio(j));
        ConstitutiveLaw::<f64, 2>::wave_speed(&law, 1000.0 / j, &stress, &state)
    };
    let sound = (BULK / 1000.0).sqrt();
    for j in [1.0, 1.1, 30.0, 1000.0] {
        assert!((speed(j) / sound - 1.0).abs() < 1e-14, "{j}: {}", speed(j));
    }
}

#[test]
fn energy_is_the_work_of_the_pressure() {
    for gamma in [1.0, 7.0] {
        let law = fluid(gamma).bearing_tension();
        for strain in [-0.1, -1e-3, 1e-3, 0.1] {
            let mut specimen = Specimen::<2, _>::new(&law);
            specimen.stretch([strain, 0.0], 4000);
            let error = specimen.energy() / specimen.work - 1.0;
            assert!(error.abs() < 1e-4, "{gamma} {strain}: {error:e}");
        }
    }
}

#[test]
fn free_fluid_bears_no_tension_and_piles_up_no_volume() {
    let law = fluid(7.0);
    let mut specimen = Specimen::<2, _>::new(&law);
    for _ in 0..100 {
        specimen.stretch([0.2, 0.1], 3);
        assert_eq!(specimen.stress, Matrix2::zeros());
        assert_eq!(specimen.energy(), 0.0);
        specimen.stretch([-0.2, -0.1], 3);
        specimen.stretch([-0.01, 0.0], 1);
        let exact = -BULK / 7.0 * (0.07_f64.exp() - 1.0);
        assert!((specimen.stress[0] - exact).abs() < 1e-11 * BULK);
        specimen.stretch([0.01, 0.0], 1);
    }
}

#[test]
fn shear_and_stretch_are_resisted_by_their_rates() {
    let law = fluid(7.0).bearing_tension();
    let (dt, rate) = (1e-3, 40.0);
    // Couette: mu du/dy and nothing else.
    let (mut stress, mut state) = (Matrix2::zeros(), VolumeRatio::default());
    law.update_over(dt, &matrix![0.0, rate * dt; 0.0, 0.0], &mut stress, &mut state);
    let exact = matrix![0.0, 1.0; 1.0, 0.0] * (VISCOSITY * rate);
    assert!((stress - exact).norm() < 1e-12 * VISCOSITY * rate);
    // The next step forgets it.
    law.update_over(dt, &Matrix2::zeros(), &mut stress, &mut state);
    assert!(stress.norm() < 1e-9);
    // Uniaxial: 4/3 mu d along, -2/3 mu d across, in one dimension as in three.
    let strain = rate * 1e-9;
    let pressure = -BULK / 7.0 * ((1.0 + strain).powf(-7.0) - 1.0);
    let (mut line, mut space) = (Matrix1::zeros(), Matrix3::zeros());
    law.update_over(
        1e-9,
        &Matrix1::new(strain),
        &mut line,
        &mut VolumeRatio::default(),
    );
    let increment = matrix![strain, 0.0, 0.0; 0.0, 0.0, 0.0; 0.0, 0.0, 0.0];
    law.update_over(1e-9, &increment, &mut space, &mut VolumeRatio::default());
    for (found, share) in [
        (line[0], 4.0),
        (space[(0, 0)], 4.0),
        (space[(1, 1)], -2.0),
        (space[(2, 2)], -2.0),
    ] {
        let exact = pressure + share / 3.0 * VISCOSITY * rate;
        assert!((found - exact).abs() < 1e-8, "{found} {exact}");
    }
}

/// Shear flow u = 3 y in a box of particles: after one step the stress in the middle is mu du/dy of the
/// mapped velocity.
#[test]
fn a_step_hands_its_time_to_the_law() {
    let grid = Grid::new(vector![0.0, 0.0], vector![1.0, 1.0], [4, 4]).unwrap();
    let points = lattice(&grid, &vector![0.0, 0.0], &vector![1.0, 1.0], [2, 2]);
    let mut particles = Particles::at_rest(&points, 1e3);
    for (velocity, x) in particles.velocity.iter_mut().zip(&particles.position) {
        *velocity = vector![3.0 * x[1], 0.0];
    }
    let law = fluid(7.0);
    let method = Method::new(Basis::Linear, ReconstructionKind::Shepard);
    let mut stepper = parts(grid, law, particles).stepper(method).unwrap();
    stepper.step(1e-6, &Forcing::none()).unwrap();
    let middle = stepper
        .particles()
        .initial_position
        .iter()
        .position(|x| (x - vector![0.4375, 0.4375]).norm() < 1e-9)
        .unwrap();
    // A lumped mass maps a linear velocity in the interior exactly.
    let found = stepper.particles().stress[middle][(0, 1)];
    assert!((found - VISCOSITY * 3.0).abs() < 1e-3 * VISCOSITY, "{found}");
}

/// A mass on a spring and a damper whose force lags a step, as in the stepper: the predicted step is the
/// boundary of growth.
#[test]
fn the_stable_step_is_where_a_damped_mode_starts_to_grow() {
    // Mode of frequency w: elastic = 2 / w; damping rate c = 4 D mu' / (rho h^2).
    for viscosity in [0.0, 1.0, 30.0, 1e4] {
        let law = NewtonianFluid::new(BULK, 7.0, viscosity).unwrap();
        let (density, cell, elastic) = (1e3, 0.01, 1e-3);
        let rate = 4.0 * 2.0 * (4.0 / 3.0 * viscosity) / (density * cell * cell);
        let predicted = law.stable_step::<2>(elastic, density, cell);
        let grows = |dt: f64| {
            let (mut x, mut v, w) = (1.0_f64, 0.3_f64, 2.0 / elastic);
            for _ in 0..20_000 {
                v -= dt * (w * w * x + rate * v);
                x += dt * v;
                if x.abs() > 1e6 {
                    return true;
                }
            }
            false
        };
        assert!(!grows(predicted * 0.99), "{viscosity}");
        assert!(grows(predicted * 1.01), "{viscosity}");
    }
}

#[test]
fn constants_without_sense_are_refused() {
    for (bulk, gamma, viscosity) in [
        (0.0, 7.0, 0.0),
        (f64::NAN, 7.0, 0.0),
        (1.0, 0.5, 0.0),
        (1.0, f64::INFINITY, 0.0),
        (1.0, 7.0, -1.0),
    ] {
        assert!(NewtonianFluid::new(bulk, gamma, viscosity).is_err());
    }
}
