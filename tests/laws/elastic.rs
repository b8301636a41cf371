//! Hyperelastic laws: stress against the derivative of the energy, closed forms, wave speed in every
//! direction.
//!
//! E = 10 MPa, nu = 0.3. Expected: J sigma = dW/dF F^T to the error of central differences (1e-8 of the
//! modulus); closed forms to round-off; no wave in any direction faster than `wave_speed` where stretches are
//! moderate.

use super::{Specimen, gradients, in_space, log_strain, moduli};
use materialpoint::law::{ConstitutiveLaw, Hencky, LinearElastic, NeoHookean, StVenantKirchhoff};
use nalgebra::{Matrix3, SMatrix, matrix};

/// Largest difference between `J sigma` and the derivative of the energy, over the modulus.
fn stress_is_derivative<const D: usize, L: ConstitutiveLaw<f64, D>>(law: &L, f: &SMatrix<f64, D, D>) -> f64 {
    let mut here = Specimen::new(law);
    here.update(&(f - SMatrix::identity()));
    let step = 1e-5;
    let mut worst = 0.0_f64;
    for k in 0..D * D {
        let energy = |size: f64| {
            let mut there = here;
            let mut increment = SMatrix::zeros();
            increment[k] = size;
            there.update(&increment);
            there.energy()
        };
        let slope = (energy(step) - energy(-step)) / (2.0 * step);
        worst = worst.max((slope - here.kirchhoff()[k]).abs());
    }
    worst / moduli().p_wave()
}

#[test]
fn stress_is_the_derivative_of_the_energy() {
    fn of<const D: usize>() {
        let moduli = moduli();
        for f in gradients::<D>() {
            let errors = [
                stress_is_derivative(&LinearElastic { moduli }, &f),
                stress_is_derivative(&NeoHookean { moduli }, &f),
                stress_is_derivative(&StVenantKirchhoff { moduli }, &f),
                stress_is_derivative(&Hencky { moduli }, &f),
            ];
            assert!(errors.iter().all(|&e| e < 1e-8), "{errors:?} {f}");
        }
    }
    of::<1>();
    of::<2>();
    of::<3>();
}

/// Stress in the plane of three-dimensional material that is strained in the plane only.
#[test]
fn plane_strain_is_three_dimensions_without_strain_off_the_plane() {
    fn same<L: ConstitutiveLaw<f64, 2> + ConstitutiveLaw<f64, 3> + ConstitutiveLaw<f64, 1>>(law: &L) {
        for f in gradients::<2>() {
            let mut plane = Specimen::<2, L>::new(law);
            let mut space = Specimen::<3, L>::new(law);
            plane.update(&(f - SMatrix::identity()));
            space.update(&(in_space(&f) - Matrix3::identity()));
            let difference = (space.stress.fixed_view::<2, 2>(0, 0) - plane.stress).norm();
            assert!(difference < 1e-14 * moduli().p_wave() * f.norm_squared().powi(2));
            let energies = plane.energy() - space.energy();
            assert!(energies.abs() < 1e-14 * moduli().p_wave() * f.norm_squared().powi(2));
        }
        for strain in [-0.4, 0.3] {
            let (mut line, mut plane) = (Specimen::<1, L>::new(law), Specimen::<2, L>::new(law));
            line.stretch([strain], 1);
            plane.stretch([strain, 0.0], 1);
            assert!((line.stress[0] - plane.stress[0]).abs() < 1e-14 * moduli().p_wave());
            assert!((line.energy() - plane.energy()).abs() < 1e-14 * moduli().p_wave());
        }
    }
    let moduli = moduli();
    same(&LinearElastic { moduli });
    same(&NeoHookean { moduli });
    same(&StVenantKirchhoff { moduli });
    same(&Hencky { moduli });
}

/// Uniaxial strain by the stretch l: sigma = (lambda + 2 mu) ln(l) / l for Hencky, (lambda + 2 mu) l
/// (l^2 - 1) / 2 for St. Venant and Kirchhoff, (lambda ln(l) + mu (l^2 - 1)) / l for the neo-Hookean solid,
/// whatever the steps.
#[test]
fn uniaxial_strain_has_its_closed_forms() {
    let m = moduli();
    for strain in [-0.7_f64, -0.1, 0.02, 0.5] {
        let l = strain.exp();
        let closed = [
            m.p_wave() * strain / l,
            m.p_wave() * l * (l * l - 1.0) / 2.0,
            (m.lambda * strain + m.mu * (l * l - 1.0)) / l,
        ];
        let (hencky, svk, neo) = (
            Hencky { moduli: m },
            StVenantKirchhoff { moduli: m },
            NeoHookean { moduli: m },
        );
        let (mut a, mut b, mut c) = (
            Specimen::<3, _>::new(&hencky),
            Specimen::<3, _>::new(&svk),
            Specimen::<3, _>::new(&neo),
        );
        a.stretch([0.0, strain, 0.0], 7);
        b.stretch([0.0, strain, 0.0], 7);
        c.stretch([0.0, strain, 0.0], 7);
        for (found, exact) in [a.stress[(1, 1)], b.stress[(1, 1)], c.stress[(1, 1)]]
            .iter()
            .zip(closed)
        {
            assert!(
                (found - exact).abs() < 1e-13 * m.p_wave(),
                "{strain}: {found} {exact}"
            );
        }
    }
}

/// Simple shear g. Hencky: sigma_12 = 4 mu asinh(g/2) / sqrt(4 + g^2), sigma_11 = g/2 sigma_12 (no stress off
/// the plane). St. Venant and Kirchhoff: S_12 = mu g, tr E = g^2/2, E_22 = g^2/2, sigma = F S F^T.
#[test]
fn simple_shear_has_its_closed_forms() {
    let m = moduli();
    for g in [0.01_f64, 0.5, 3.0] {
        let hencky = Hencky { moduli: m };
        let mut found = Specimen::<2, _>::new(&hencky);
        found.shear(g, 10);
        let shear = 4.0 * m.mu * (g / 2.0).asinh() / (4.0 + g * g).sqrt();
        let exact = matrix![g / 2.0, 1.0; 1.0, -g / 2.0] * shear;
        assert!(
            (found.stress - exact).norm() < 1e-13 * m.p_wave() * (1.0 + g * g),
            "{g}"
        );
        assert!(hencky.off_plane_stress(&found.state).abs() < 1e-12 * m.p_wave());
        let svk = StVenantKirchhoff { moduli: m };
        let mut found = Specimen::<2, _>::new(&svk);
        found.shear(g, 10);
        let volume = m.lambda * g * g / 2.0;
        let (s11, s22, s12) = (volume, volume + m.mu * g * g, m.mu * g);
        let exact = matrix![s11 + 2.0 * g * s12 + g * g * s22, s12 + g * s22; s12 + g * s22, s22];
        assert!(
            (found.stress - exact).norm() < 1e-13 * m.p_wave() * (1.0 + g.powi(4)),
            "{g}"
        );
    }
}

/// Hydrostatic: p = K ln(J) / J for Hencky.
#[test]
fn hydrostatic_strain_has_its_closed_form() {
    let hencky = Hencky { moduli: moduli() };
    for j in [0.3_f64, 0.99, 1.01, 4.0] {
        let mut found = Specimen::<3, _>::new(&hencky);
        found.stretch([j.ln() / 3.0; 3], 5);
        let exact = moduli().bulk() * j.ln() / j;
        let difference = found.stress - Matrix3::from_diagonal_element(exact);
        assert!(difference.norm() < 1e-13 * moduli().p_wave());
    }
}

/// Hencky's stress on random paths against the logarithm by nalgebra's decomposition of the final F.
#[test]
fn hencky_follows_the_logarithm_on_random_paths() {
    let m = moduli();
    let law = Hencky { moduli: m };
    for f in gradients::<3>() {
        let mut found = Specimen::<3, _>::new(&law);
        let steps = [f, random_rotation(3) * f.try_inverse().unwrap(), f];
        let mut total = Matrix3::identity();
        for step in steps {
            found.update(&(step - Matrix3::identity()));
            total = step * total;
        }
        let strain = log_strain(&total);
        let stress = Matrix3::identity() * (m.lambda * strain.trace()) + strain * (2.0 * m.mu);
        let difference = (found.stress - stress / total.determinant()).norm();
        assert!(difference < 1e-12 * m.p_wave(), "{difference:e}");
    }
}

fn random_rotation(seed: u32) -> Matrix3<f64> {
    let angles = super::random::<3>(seed) * 3.0;
    nalgebra::Rotation3::from_euler_angles(angles[0], angles[1], angles[2]).into_inner()
}

/// `rho c^2` of the fastest plane wave along `n`: the largest principal value of the acoustic tensor,
/// `A m = d(sigma n)/dh` under the increment `h m n^T` (Nanson: the nominal traction on the plane of a wave
/// is the true one).
fn fastest<L: ConstitutiveLaw<f64, 3>>(here: &Specimen<'_, 3, L>, n: &nalgebra::Vector3<f64>) -> f64 {
    let step = 1e-5;
    let column = |m: usize| {
        let after = |size: f64| {
            let mut there = *here;
            let mut direction = nalgebra::Vector3::zeros();
            direction[m] = size;
            there.update(&(direction * n.transpose()));
            there.stress * n
        };
        (after(step) - after(-step)) / (2.0 * step)
    };
    let acoustic = Matrix3::from_columns(&[column(0), column(1), column(2)]);
    assert!((acoustic - acoustic.transpose()).norm() < 1e-6 * acoustic.norm());
    ((acoustic + acoustic.transpose()) / 2.0)
        .symmetric_eigenvalues()
        .max()
}

/// Over strains of up to 20 % in every direction: the wave speed is a bound, and no more than 1.6 times too
/// great.
#[test]
fn no_wave_in_any_direction_is_faster_than_the_wave_speed() {
    fn ratio<L: ConstitutiveLaw<f64, 3>>(law: &L) -> (f64, f64) {
        let mut range = (f64::INFINITY, 0.0_f64);
        for seed in 0..60 {
            let mut here = Specimen::new(law);
            here.update(&(super::random::<3>(seed) * 0.2));
            let claimed = law.wave_speed(1.0, &here.stress, &here.state).powi(2);
            let mut most = 0.0_f64;
            for k in 0..60 {
                let n: nalgebra::Vector3<f64> = super::random::<3>(1000 + k).column(0).normalize();
                most = most.max(fastest(&here, &n));
            }
            range = (range.0.min(claimed / most), range.1.max(claimed / most));
        }
        range
    }
    let moduli = moduli();
    let ranges = [
        ratio(&NeoHookean { moduli }),
        ratio(&StVenantKirchhoff { moduli }),
        ratio(&Hencky { moduli }),
    ];
    println!("claimed over fastest, squared: {ranges:?}");
    assert!(ranges.iter().all(|r| r.0 > 1.0 - 1e-6 && r.1 < 2.6), "{ranges:?}");
}
