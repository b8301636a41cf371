//! Drucker-Prager plasticity: consistency, apex, separation, dissipation, plane strain.
//!
//! E = 10 MPa, nu = 0.3, friction 0.6 rad. Expected: yield function not above zero after any step, no energy
//! given back, a free apex without cohesion that opens and closes without work and without piling up volume.

use super::{Specimen, in_space, moduli, random};
use materialpoint::law::{ConeMatch, ConstitutiveLaw, DruckerPrager, Hencky, Strength};
use nalgebra::{Matrix3, SMatrix};

const MATCHES: [ConeMatch; 3] = [
    ConeMatch::PlaneStrain,
    ConeMatch::TriaxialCompression,
    ConeMatch::TriaxialExtension,
];

fn law(cohesion: f64, dilation_angle: f64, matching: ConeMatch) -> DruckerPrager<f64> {
    let strength = Strength {
        cohesion,
        friction_angle: 0.6,
        dilation_angle,
    };
    DruckerPrager::new(moduli(), &strength, matching).unwrap()
}

#[test]
fn random_paths_stay_within_the_cone_and_never_give_energy_back() {
    let elastic = Hencky { moduli: moduli() };
    for matching in MATCHES {
        for (cohesion, dilation) in [(0.0, 0.0), (0.0, 0.6), (2e4, 0.0), (2e4, 0.3), (2e4, 0.6)] {
            let law = law(cohesion, dilation, matching);
            for seed in 0..20 {
                let start = Matrix3::from_diagonal_element(-1e5);
                let mut specimen = Specimen::<3, _>::under(&law, start, None).unwrap();
                specimen.volume = specimen.state.volume;
                for k in 0..40 {
                    let increment = random::<3>(seed * 100 + k) * 0.01;
                    let (mut trial, mut stress) = (specimen.state.stretch, specimen.stress);
                    elastic.update(&increment, &mut stress, &mut trial);
                    let open = specimen.state.gap > 0.0;
                    specimen.update(&increment);
                    let state = &specimen.state;
                    assert!(law.yield_function(state) <= 1e-12 * moduli().p_wave());
                    assert!((state.volume / specimen.volume - 1.0).abs() < 1e-13);
                    // The trial's energy per reference volume.
                    let j = (trial.b.determinant()).sqrt();
                    let released = elastic.energy_density(&stress, &trial) * j - specimen.energy();
                    assert!(open || released >= -1e-13 * moduli().p_wave(), "{released:e}");
                }
            }
        }
    }
}

/// In fine steps, work = stored + dissipated with the dissipation that the flow rule gives,
/// `d gamma (xi c - (eta - eta_bar) p)`: not negative in any step on the cone.
#[test]
fn every_step_dissipates() {
    for matching in MATCHES {
        for (cohesion, dilation) in [(0.0, 0.0), (0.0, 0.6), (2e4, 0.2), (2e4, 0.6)] {
            let law = law(cohesion, dilation, matching);
            let start = Matrix3::from_diagonal_element(-1e5);
            let mut specimen = Specimen::<3, _>::under(&law, start, None).unwrap();
            specimen.volume = specimen.state.volume;
            let stored = specimen.energy();
            let mut before = 0.0;
            for _ in 0..4000 {
                specimen.update(&Matrix3::new(-5e-6, 4e-6, 0.0, 0.0, 6e-6, 0.0, 0.0, 0.0, 2e-6));
                let dissipated = specimen.work - (specimen.energy() - stored);
                // Backward Euler against the trapezoidal rule, one step of 1e-5.
                assert!(
                    dissipated >= before - 1e-4 * 1e5 * 1e-5,
                    "{matching:?} {cohesion} {dilation}: {}",
                    dissipated - before
                );
                before = dissipated;
            }
            assert!(specimen.state.plastic_strain > 1e-3);
        }
    }
}

/// Tension beyond the apex: mean Kirchhoff stress c / tan(phi) for all but the extension cone's same ratio xi
/// / eta = cot(phi).
#[test]
fn tension_with_cohesion_ends_at_the_apex() {
    for matching in MATCHES {
        let law = law(2e4, 0.2, matching);
        let mut specimen = Specimen::<3, _>::new(&law);
        specimen.stretch([0.02, 0.01, 0.02], 50);
        let apex = Matrix3::from_diagonal_element(2e4 / 0.6_f64.tan());
        assert!((specimen.kirchhoff() - apex).norm() < 1e-9 * moduli().p_wave());
        assert_eq!(specimen.state.gap, 0.0);
        // The volume is plastic for good: pressure from the first closing on.
        specimen.stretch([-0.02, -0.01, -0.02], 50);
        assert!(specimen.stress.trace() / 3.0 < -1e4);
    }
}

#[test]
fn tension_without_cohesion_is_free_and_piles_up_no_volume() {
    fn cycles<const D: usize>(law: &DruckerPrager<f64>, steps: u32) {
        let mut specimen = Specimen::<D, _>::new(law);
        let closed = [-1e-3; D];
        let mut never_opened = Specimen::<D, _>::new(law);
        never_opened.stretch(closed, 1);
        let (mut open, mut close) = ([0.0; D], [0.0; D]);
        (open[0], close[0]) = (0.05, -0.05);
        for _ in 0..100 {
            specimen.stretch(open, steps);
            assert!(specimen.stress.norm() < 1e-9, "{}", specimen.stress);
            assert!((specimen.state.gap - specimen.volume.ln()).abs() < 1e-12);
            assert!(specimen.energy() < 1e-12);
            specimen.stretch(close, steps);
            specimen.stretch(closed, 1);
            let difference = (specimen.stress - never_opened.stress).norm();
            assert!(difference < 1e-11 * moduli().p_wave(), "{difference:e}");
            assert_eq!(specimen.state.gap, 0.0);
            specimen.stretch(closed.map(|e| -e), 1);
        }
    }
    for matching in MATCHES {
        // Volumetric dilation on the cone is no part of this.
        let law = law(0.0, 0.0, matching);
        cycles::<3>(&law, 1);
        cycles::<2>(&law, 1);
        cycles::<2>(&law, 7);
        cycles::<1>(&law, 1);
    }
}

/// Closing half-way: nothing; one step from open to pressed: the pressure of the closed volume.
#[test]
fn the_gap_closes_before_anything_is_borne() {
    let law = law(0.0, 0.3, ConeMatch::PlaneStrain);
    let mut specimen = Specimen::<3, _>::new(&law);
    specimen.stretch([0.01; 3], 1);
    specimen.stretch([-0.006; 3], 1);
    assert!(specimen.stress.norm() < 1e-9);
    assert!((specimen.state.gap - 0.012).abs() < 1e-15);
    specimen.stretch([-0.005; 3], 1);
    let pressure = -moduli().bulk() * -0.003 / (-0.003_f64).exp();
    assert!((specimen.stress.trace() / 3.0 + pressure).abs() < 1e-9 * pressure);
}

/// Of the closing step the part in contact counts, in shear too: the material is as if it had been pressed by
/// that part alone.
#[test]
fn closing_in_one_step_forgets_the_shear_of_the_gap() {
    let law = law(0.0, 0.3, ConeMatch::PlaneStrain);
    let (mut opened, mut pressed) = (Specimen::<2, _>::new(&law), Specimen::<2, _>::new(&law));
    opened.stretch([0.03, 0.0], 1);
    opened.stretch([-0.033, 0.0], 1);
    pressed.stretch([-0.003, 0.0], 1);
    assert!(pressed.stress[0] < -1e4);
    assert!((opened.stress - pressed.stress).norm() < 1e-12 * moduli().p_wave());
}

#[test]
fn plane_strain_is_three_dimensions_without_strain_off_the_plane() {
    for (cohesion, dilation) in [(0.0, 0.3), (2e4, 0.1)] {
        let law = law(cohesion, dilation, ConeMatch::PlaneStrain);
        for seed in 0..20 {
            let start = Matrix3::from_diagonal(&nalgebra::Vector3::new(-1e5, -1.2e5, -0.8e5));
            let in_plane = start.fixed_view::<2, 2>(0, 0).into_owned();
            let mut plane = Specimen::<2, _>::under(&law, in_plane, Some(-0.8e5)).unwrap();
            let mut space = Specimen::<3, _>::under(&law, start, None).unwrap();
            for k in 0..30 {
                let increment = random::<2>(seed * 50 + k) * 0.01;
                plane.update(&increment);
                space.update(&(in_space(&(SMatrix::identity() + increment)) - Matrix3::identity()));
                let difference = (space.stress.fixed_view::<2, 2>(0, 0) - plane.stress).norm();
                assert!(difference < 1e-11 * moduli().p_wave());
                let off = law.off_plane_stress(&plane.state) - space.stress[(2, 2)];
                assert!(off.abs() < 1e-11 * moduli().p_wave());
            }
        }
    }
}

#[test]
fn constants_without_sense_are_refused() {
    let bad = [
        (-1.0, 0.5, 0.1),
        (f64::INFINITY, 0.5, 0.1),
        (0.0, -0.1, -0.1),
        (0.0, 1.6, 0.1),
        (0.0, f64::NAN, 0.0),
        (0.0, 0.5, 0.6),
        (0.0, 0.5, -0.1),
    ];
    for (cohesion, friction_angle, dilation_angle) in bad {
        let strength = Strength {
            cohesion,
            friction_angle,
            dilation_angle,
        };
        assert!(DruckerPrager::new(moduli(), &strength, ConeMatch::PlaneStrain).is_err());
    }
}

/// A stretch that is no number is not taken for an apex.
#[test]
fn what_is_not_a_number_stays_so() {
    let law = law(0.0, 0.3, ConeMatch::PlaneStrain);
    let mut specimen = Specimen::<2, _>::new(&law);
    specimen.update(&SMatrix::from_element(f64::NAN));
    assert!(specimen.stress.iter().all(|s| s.is_nan()));
    assert_eq!((specimen.state.plastic_strain, specimen.state.gap), (0.0, 0.0));
    let energy = law.energy_density(&specimen.stress, &specimen.state);
    assert!(energy.is_nan());
}
