//! Drucker-Prager at collapse against Mohr and Coulomb, and the rate of dilation against its angle.
//!
//! E = 10 MPa, nu = 0.3. Flow along the plastic potential itself brings a stress that no longer changes: the
//! limit state. Expected there, with the principal stresses s_1 >= s_3: (s_1 - s_3)/2 = c cos(phi) - (s_1 +
//! s_3)/2 sin(phi) in the state of strain the cone is matched to.

use super::{Specimen, moduli};
use materialpoint::law::{ConeMatch, DruckerPrager, Strength};
use nalgebra::{Matrix2, Matrix3, matrix};

const ANGLES: [(f64, f64); 5] = [(0.6, 0.6), (0.6, 0.3), (0.6, 0.0), (0.3, 0.1), (0.05, 0.0)];

fn law(cohesion: f64, angles: (f64, f64), matching: ConeMatch) -> DruckerPrager<f64> {
    let strength = Strength {
        cohesion,
        friction_angle: angles.0,
        dilation_angle: angles.1,
    };
    DruckerPrager::new(moduli(), &strength, matching).unwrap()
}

/// Excess of Mohr's circle over Coulomb's line, over its radius.
fn excess(greatest: f64, least: f64, cohesion: f64, friction: f64) -> f64 {
    let radius = (greatest - least) / 2.0;
    (radius - cohesion * friction.cos() + (greatest + least) / 2.0 * friction.sin()) / radius
}

#[test]
fn plane_strain_collapses_at_mohr_and_coulombs_strength() {
    for cohesion in [0.0, 1e4] {
        for angles in ANGLES {
            let law = law(cohesion, angles, ConeMatch::PlaneStrain);
            let mut specimen =
                Specimen::<2, _>::under(&law, Matrix2::from_diagonal_element(-1e5), Some(-1e5)).unwrap();
            specimen.volume = specimen.state.volume;
            // d_1 + d_2 = sin(psi) |d_1 - d_2|.
            let dilation = angles.1.sin();
            specimen.stretch([(dilation + 1.0) * 0.2, (dilation - 1.0) * 0.2], 4000);
            let tau = specimen.kirchhoff();
            let found = excess(tau[(0, 0)], tau[(1, 1)], cohesion, angles.0);
            assert!(found.abs() < 1e-9, "{cohesion} {angles:?}: {found:e}");
        }
    }
}

/// Axial compression and extension of a cylinder.
#[test]
fn triaxial_tests_end_at_mohr_and_coulombs_strength() {
    for cohesion in [0.0, 1e4] {
        for angles in ANGLES {
            for (matching, sign) in [
                (ConeMatch::TriaxialCompression, -1.0),
                (ConeMatch::TriaxialExtension, 1.0),
            ] {
                let law = law(cohesion, angles, matching);
                let start = Matrix3::from_diagonal_element(-1e5);
                let mut specimen = Specimen::<3, _>::under(&law, start, None).unwrap();
                specimen.volume = specimen.state.volume;
                // Flow of the edges of Mohr and Coulomb's potential: of the strains across and along, tr(d) =
                // sin(psi) times (extended ones - compressed ones).
                let s = angles.1.sin();
                let (axial, lateral) = if sign < 0.0 {
                    (-2.0 * (1.0 - s), 1.0 + s)
                } else {
                    (2.0 * (1.0 + s), s - 1.0)
                };
                specimen.stretch([axial * 0.1, lateral * 0.1, lateral * 0.1], 4000);
                let tau = specimen.kirchhoff();
                let (a, l) = (tau[(0, 0)], tau[(1, 1)]);
                let found = excess(a.max(l), a.min(l), cohesion, angles.0);
                assert!(
                    found.abs() < 1e-9,
                    "{matching:?} {cohesion} {angles:?}: {found:e}"
                );
            }
        }
    }
}

/// Direct shear under a constant normal stress (Davis 1968): at collapse sigma_xy / sigma_yy = sin(phi)
/// cos(psi) / (1 - sin(phi) sin(psi)), and the layer rises by tan(psi) per shear.
#[test]
fn direct_shear_dilates_by_the_angle_and_bears_what_davis_says() {
    for angles in [(0.6_f64, 0.6_f64), (0.6, 0.2), (0.5, 0.0)] {
        let law = law(0.0, angles, ConeMatch::PlaneStrain);
        let normal = -1e3;
        let mut specimen =
            Specimen::<2, _>::under(&law, matrix![-600.0, 0.0; 0.0, normal], Some(-600.0)).unwrap();
        let (shear, mut rise) = (1e-5, 0.0);
        for _ in 0..1000 {
            rise = lift(&mut specimen, shear, normal);
        }
        let (phi, psi) = angles;
        let strength = phi.sin() * psi.cos() / (1.0 - phi.sin() * psi.sin());
        let found = specimen.stress[(0, 1)] / -normal;
        assert!(
            (found / strength - 1.0).abs() < 2e-3,
            "{angles:?}: {found} {strength}"
        );
        assert!(
            (rise / shear - psi.tan()).abs() < 2e-3,
            "{angles:?}: {} {}",
            rise / shear,
            psi.tan()
        );
    }
}

/// One step of shear with the vertical strain that keeps the normal stress (secants); that strain.
fn lift(specimen: &mut Specimen<'_, 2, DruckerPrager<f64>>, shear: f64, normal: f64) -> f64 {
    let at = |rise: f64| {
        let mut there = *specimen;
        there.update(&matrix![0.0, shear; 0.0, rise]);
        there
    };
    let misses = |rise: f64| at(rise).stress[(1, 1)] - normal;
    let (mut a, mut b) = (0.0, shear);
    for _ in 0..50 {
        let (fa, fb) = (misses(a), misses(b));
        if fb.abs() < 1e-10 || fa == fb {
            break;
        }
        (a, b) = (b, b - fb * (b - a) / (fb - fa));
    }
    *specimen = at(b);
    b
}

/// Without friction the plane-strain cone is von Mises' cylinder of the radius `c`: Tresca's strength in
/// plane strain.
#[test]
fn without_friction_the_strength_is_the_cohesion() {
    let law = law(1e4, (0.0, 0.0), ConeMatch::PlaneStrain);
    let mut specimen = Specimen::<2, _>::new(&law);
    specimen.stretch([0.1, -0.1], 100);
    let tau = specimen.kirchhoff();
    assert!(((tau[(0, 0)] - tau[(1, 1)]) / 2e4 - 1.0).abs() < 1e-12);
    specimen.stretch([0.1, 0.1], 1);
    assert!(law.yield_function(&specimen.state).abs() < 1e-6);
}
