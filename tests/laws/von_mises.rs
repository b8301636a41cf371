//! Von Mises plasticity: consistency, hardening curve, limit in shear, dissipation, plane strain.
//!
//! E = 10 MPa, nu = 0.3, sigma_Y = 50 kPa, H = 0.4 MPa (0 where said). Expected: yield function 0 to
//! round-off after yielding, plastic volume exactly kept, dissipation not negative; Kirchhoff stress against
//! logarithmic strain of slope E H / (E + H).

use super::{Specimen, in_space, moduli, random};
use materialpoint::law::{ConstitutiveLaw, Hencky, VonMises};
use nalgebra::{Matrix3, SMatrix};

const YIELD: f64 = 5e4;
const HARDENING: f64 = 4e5;

fn law(hardening: f64) -> VonMises<f64> {
    VonMises::new(moduli(), YIELD, hardening).unwrap()
}

#[test]
fn random_paths_stay_within_yield_and_never_give_energy_back() {
    for hardening in [0.0, HARDENING] {
        let law = law(hardening);
        let elastic = Hencky { moduli: moduli() };
        for seed in 0..50 {
            let mut specimen = Specimen::<3, _>::new(&law);
            for k in 0..40 {
                let increment = random::<3>(seed * 100 + k) * 0.02;
                let (mut trial, mut stress) = (specimen.state.stretch, specimen.stress);
                elastic.update(&increment, &mut stress, &mut trial);
                let before = specimen.state.plastic_strain;
                specimen.update(&increment);
                let state = &specimen.state;
                assert!(law.yield_function(state) <= 1e-12 * moduli().p_wave());
                assert!(state.plastic_strain >= before);
                let released = elastic.energy_density(&stress, &trial) * specimen.volume - specimen.energy();
                assert!(released >= -1e-13 * moduli().p_wave(), "{released:e}");
                // Elastic volume is all volume.
                let b = state.stretch.b.determinant();
                assert!((b / specimen.volume.powi(2) - 1.0).abs() < 1e-12);
            }
            assert!(specimen.state.plastic_strain > 0.1);
        }
    }
}

/// Lateral strain of each step found such that the lateral stress vanishes (secants).
fn pull<const D: usize>(specimen: &mut Specimen<'_, D, VonMises<f64>>, axial: f64) {
    let at = |lateral: f64| {
        let mut there = *specimen;
        let mut increment = SMatrix::<f64, D, D>::zeros();
        increment[(0, 0)] = axial.exp_m1();
        (1..D).for_each(|a| increment[(a, a)] = lateral.exp_m1());
        there.update(&increment);
        there
    };
    let (mut a, mut b) = (-0.3 * axial, -0.5 * axial);
    for _ in 0..40 {
        let (fa, fb) = (at(a).stress[(1, 1)], at(b).stress[(1, 1)]);
        if (fb - fa).abs() < 1e-9 || fb.abs() < 1e-9 {
            break;
        }
        (a, b) = (b, b - fb * (b - a) / (fb - fa));
    }
    *specimen = at(b);
}

#[test]
fn uniaxial_tension_hardens_along_its_line() {
    let law = law(HARDENING);
    let e = 1e7;
    for sign in [1.0, -1.0] {
        let mut specimen = Specimen::<3, _>::new(&law);
        let step = sign * 1e-3;
        for k in 1..=100 {
            pull(&mut specimen, step);
            let strain = step * f64::from(k);
            let onset = YIELD / e;
            let tangent = e * HARDENING / (e + HARDENING);
            let expected = if strain.abs() < onset {
                e * strain
            } else {
                sign * (YIELD + tangent * (strain.abs() - onset))
            };
            let found = specimen.kirchhoff()[(0, 0)];
            assert!(
                (found - expected).abs() < 1e-6 * YIELD,
                "{strain}: {found} {expected}"
            );
        }
        let plastic = (specimen.kirchhoff()[(0, 0)].abs() - YIELD) / HARDENING;
        assert!((specimen.state.plastic_strain - plastic).abs() < 1e-10);
    }
}

/// Simple shear without hardening: sigma_12 = sigma_Y / sqrt(3) but for the turn of the stress, of the size
/// of the elastic strain.
#[test]
fn simple_shear_ends_at_the_strength_in_shear() {
    let law = law(0.0);
    let mut specimen = Specimen::<2, _>::new(&law);
    specimen.shear(0.5, 1000);
    let ratio = specimen.stress[(0, 1)] / (YIELD / 3.0_f64.sqrt());
    assert!((ratio - 1.0).abs() < 1e-4, "{ratio}");
    assert!((specimen.state.plastic_strain - 0.5 / 3.0_f64.sqrt()).abs() < 5e-3);
}

#[test]
fn plane_strain_is_three_dimensions_without_strain_off_the_plane() {
    let law = law(HARDENING);
    for seed in 0..20 {
        let (mut plane, mut space) = (Specimen::<2, _>::new(&law), Specimen::<3, _>::new(&law));
        for k in 0..30 {
            let increment = random::<2>(seed * 50 + k) * 0.02;
            plane.update(&increment);
            space.update(&(in_space(&(SMatrix::identity() + increment)) - Matrix3::identity()));
            let difference = (space.stress.fixed_view::<2, 2>(0, 0) - plane.stress).norm();
            assert!(difference < 1e-12 * moduli().p_wave());
            let off = law.off_plane_stress(&plane.state) - space.stress[(2, 2)];
            assert!(off.abs() < 1e-12 * moduli().p_wave());
        }
    }
    let (mut line, mut space) = (Specimen::<1, _>::new(&law), Specimen::<3, _>::new(&law));
    line.stretch([-0.1], 10);
    space.stretch([-0.1, 0.0, 0.0], 10);
    assert!((line.stress[0] - space.stress[0]).abs() < 1e-12 * moduli().p_wave());
    assert!(line.state.plastic_strain > 0.01);
}

/// Work = stored + dissipated, and the dissipation is that of the flow: sigma_Y alpha without hardening.
#[test]
fn dissipation_is_strength_times_plastic_strain() {
    let law = law(0.0);
    let mut specimen = Specimen::<3, _>::new(&law);
    specimen.stretch([0.1, -0.05, -0.05], 20_000);
    let dissipated = specimen.work - specimen.energy();
    let expected = YIELD * specimen.state.plastic_strain;
    assert!(
        (dissipated / expected - 1.0).abs() < 1e-4,
        "{dissipated} {expected}"
    );
}

#[test]
fn constants_without_sense_are_refused() {
    for (strength, hardening) in [
        (0.0, 0.0),
        (-1.0, 0.0),
        (f64::NAN, 0.0),
        (1.0, -1.0),
        (1.0, f64::INFINITY),
    ] {
        assert!(VonMises::new(moduli(), strength, hardening).is_err());
    }
}
