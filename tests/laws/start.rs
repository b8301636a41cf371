//! Material that starts under stress.
//!
//! E = 10 MPa, nu = 0.3. Expected: a first step without motion leaves the stress, to round-off of the
//! modulus; stress off the plane as given, or nu (sigma_xx + sigma_yy); what no state stands for is refused.

use super::{Specimen, moduli, random};
use materialpoint::basis::Linear;
use materialpoint::error::SetupError;
use materialpoint::grid::Grid;
use materialpoint::law::{
    ConeMatch, ConstitutiveLaw, DruckerPrager, Hencky, Hill, LinearElastic, NeoHookean, NewtonianFluid,
    StVenantKirchhoff, Strength, VonMises,
};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::Shepard;
use materialpoint::stepper::{Forcing, Setup, Stepper};
use nalgebra::{Matrix1, Matrix2, Matrix3, SMatrix, matrix, vector};

fn sand() -> DruckerPrager<f64> {
    let strength = Strength {
        cohesion: 0.0,
        friction_angle: 0.6,
        dilation_angle: 0.1,
    };
    DruckerPrager::new(moduli(), &strength, ConeMatch::PlaneStrain).unwrap()
}

/// Whether the stress survives an update without motion.
fn stays<const D: usize, L: ConstitutiveLaw<f64, D>>(
    law: &L,
    stress: SMatrix<f64, D, D>,
    off: Option<f64>,
) -> bool {
    let Some(mut specimen) = Specimen::under(law, stress, off) else {
        return false;
    };
    specimen.update(&SMatrix::zeros());
    let lost = (specimen.stress - stress).norm();
    assert!(
        lost < 1e-14 * moduli().p_wave() + 1e-13 * stress.norm(),
        "{lost:e} of {stress}"
    );
    true
}

#[test]
fn elastic_stress_survives() {
    fn of<const D: usize>() {
        let moduli = moduli();
        let scale = moduli.mu;
        for seed in 0..200 {
            let a = random::<D>(seed);
            // Pressed up to five times the shear modulus, pulled up to a fifth of it.
            let stress = (a + a.transpose()) * (0.1 * scale) - a * a.transpose() * (1.5 * scale);
            assert!(stays(&Hencky { moduli }, stress, None), "{stress}");
            assert!(stays(&NeoHookean { moduli }, stress, None), "{stress}");
            assert!(stays(&LinearElastic { moduli }, stress, None));
        }
    }
    of::<1>();
    of::<2>();
    of::<3>();
}

#[test]
fn plastic_stress_survives_within_the_strength() {
    let metal = VonMises::new(moduli(), 5e4, 1e5).unwrap();
    let sand = sand();
    let k0 = matrix![-0.5, 0.0; 0.0, -1.0];
    for depth in [1e-6, 1.0, 1e3, 1e5] {
        assert!(stays(&sand, k0 * depth, Some(-0.5 * depth)));
        assert!(stays(
            &sand,
            Matrix3::from_diagonal(&vector![-0.6, -0.5, -1.0]) * depth,
            None
        ));
        assert!(stays(&sand, Matrix1::new(-depth), Some(-0.5 * depth)));
        // Active failure at K_a, a little more is beyond it.
        let active = (1.0 - 0.6_f64.sin()) / (1.0 + 0.6_f64.sin());
        assert!(!stays(
            &sand,
            matrix![-active * 0.8, 0.0; 0.0, -1.0] * depth,
            Some(-0.5 * depth)
        ));
        assert!(!stays(&sand, Matrix2::identity() * depth, None));
    }
    assert!(stays(&metal, matrix![2e4, 1e4; 1e4, -2e4], None));
    assert!(stays(&metal, Matrix2::identity() * -1e6, Some(-1e6)));
    assert!(!stays(&metal, matrix![2e4, 3e4; 3e4, -2e4], None));
}

#[test]
fn stress_off_the_plane_is_as_told() {
    let stress = matrix![-3e4, 1e4; 1e4, -7e4];
    let (hencky, sand) = (Hencky { moduli: moduli() }, sand());
    let metal = VonMises::new(moduli(), 5e5, 0.0).unwrap();
    let told = hencky.off_plane_stress(&hencky.start(&stress, Some(-5e4)).unwrap());
    let free = hencky.off_plane_stress(&hencky.start(&stress, None).unwrap());
    assert!(
        (told + 5e4).abs() < 1e-7 && (free - 0.3 * -1e5).abs() < 1e-7,
        "{told} {free}"
    );
    assert_eq!(hencky.start(&stress, None).unwrap().off_plane, 1.0);
    let state = sand.start(&stress, Some(-5e4)).unwrap();
    assert!((sand.off_plane_stress(&state) + 5e4).abs() < 1e-7);
    let state = metal.start(&stress, Some(-5e4)).unwrap();
    assert!((metal.off_plane_stress(&state) + 5e4).abs() < 1e-7);
    // Uniaxial: nu / (1 - nu).
    let state = hencky.start(&Matrix1::new(-7e4), None).unwrap();
    assert!((hencky.off_plane_stress(&state) + 3e4).abs() < 1e-7);
}

/// The mean stress of Hencky's solid has a maximum, K / e.
#[test]
fn hencky_knows_no_mean_stress_above_its_maximum() {
    let law = Hencky { moduli: moduli() };
    let most = moduli().bulk() / std::f64::consts::E;
    assert!(stays(&law, Matrix3::from_diagonal_element(most * 0.999), None));
    assert!(!stays(&law, Matrix3::from_diagonal_element(most * 1.001), None));
    assert!(stays(&law, Matrix3::from_diagonal_element(-most * 1e3), None));
    assert!(!stays(&law, Matrix3::from_element(f64::NAN), None));
}

#[test]
fn fluid_starts_under_pressure_only() {
    let free = NewtonianFluid::new(2e6, 7.0, 0.0).unwrap();
    let whole = free.bearing_tension();
    assert!(stays(&free, Matrix2::identity() * -1e5, None));
    assert!(stays(&free, Matrix2::identity() * -1e5, Some(-1e5)));
    assert!(stays(&whole, Matrix2::identity() * 1e4, None));
    assert!(!stays(&free, Matrix2::identity() * 1e4, None));
    assert!(!stays(&free, Matrix2::identity() * -1e5, Some(-2e5)));
    assert!(!stays(&free, matrix![-1e5, 1e4; 1e4, -1e5], None));
    assert!(!stays(&whole, Matrix2::identity() * 1e6, None));
}

#[test]
fn laws_without_an_answer_start_from_rest_only() {
    let moduli = moduli();
    let stress = Matrix2::identity() * -1e3;
    assert!(StVenantKirchhoff { moduli }.start(&stress, None).is_none());
    assert!(
        StVenantKirchhoff { moduli }
            .start(&Matrix2::zeros(), None)
            .is_some()
    );
    assert!(NeoHookean { moduli }.start(&stress, Some(-1e3)).is_none());
    assert!(Hill { moduli }.start(&stress, None).is_some());
}

#[test]
fn particles_take_their_states_from_their_stresses() {
    let grid = Grid::new(vector![0.0, 0.0], vector![1.0, 1.0], [4, 4]).unwrap();
    let points = lattice(&grid, &vector![0.25, 0.25], &vector![0.75, 0.75], [2, 2]);
    let mut particles = Particles::at_rest(&points, 2e3);
    let told = matrix![-5e3, 0.0; 0.0, -1e4];
    particles.stress.fill(told);
    let law = sand();
    particles
        .start_under_stress(&law, |_, stress| Some(stress[(0, 0)]))
        .unwrap();
    let mut stepper = Stepper::new(Setup::new(grid, Linear, Shepard, law, OnePhase, particles)).unwrap();
    stepper.step(1e-9, &Forcing::none()).unwrap();
    for stress in &stepper.particles().stress {
        assert!((stress - told).norm() < 1e-3, "{stress}");
    }
    for state in &stepper.particles().state {
        assert!((stepper.law().off_plane_stress(state) + 5e3).abs() < 1e-3);
    }
    let mut particles = Particles::<_, 2, _, ()>::at_rest(&points, 2e3);
    particles.stress[3] = Matrix2::identity() * 1e3;
    let refused = particles.start_under_stress(&law, |_, _| None);
    let Err(SetupError::InitialStress {
        particle: 3,
        position,
        allowed,
        ..
    }) = refused
    else {
        panic!("{refused:?}");
    };
    assert_eq!(position, points[3].0.as_slice());
    assert!(allowed.contains("no such tension"), "{allowed}");
}

/// Without dilation `eta = sin(phi)`, and elastic stress off the plane is nu (xx + yy): the cone `J2 = eta^2
/// p^2` is reached at `(1 - K) / (1 + K) = r`, `r^2 = 4 (eta^2 (1 + nu)^2 / 9 - (1 - 2 nu)^2 / 12)`, K =
/// 0.463 for 30 degrees, and at 1 / K.
#[test]
fn what_is_borne_is_told_by_its_range() {
    let strength = Strength {
        cohesion: 0.0,
        friction_angle: 30_f64.to_radians(),
        dilation_angle: 0.0,
    };
    let law = DruckerPrager::new(moduli(), &strength, ConeMatch::PlaneStrain).unwrap();
    let mut particles = Particles::<_, 2, _, ()>::at_rest(&[(vector![0.0, 0.0], 1.0)], 2e3);
    particles.stress[0] = matrix![-2e4, 0.0; 0.0, -1e5];
    let Err(SetupError::InitialStress { allowed, .. }) = particles.start_under_stress(&law, |_, _| None)
    else {
        panic!("K0 = 0.2 is beyond the cone");
    };
    let numbers: Vec<f64> = allowed.split(' ').filter_map(|word| word.parse().ok()).collect();
    let r = 2.0 * (0.25 * 1.3_f64.powi(2) / 9.0 - 0.4_f64.powi(2) / 12.0).sqrt();
    let k = (1.0 - r) / (1.0 + r);
    // xx beside yy, then yy beside xx. Cauchy's stress differs from Kirchhoff's by the volume strain, under a
    // per cent.
    let right = [-1e5 / k, -1e5 * k, -2e4 / k, -2e4 * k];
    assert_eq!(numbers.len(), right.len(), "{allowed}");
    for (found, right) in numbers.iter().zip(right) {
        assert!((found / right - 1.0).abs() < 1e-3, "{allowed}");
    }
}
