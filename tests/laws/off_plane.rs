//! Stress off the plane of every law.
//!
//! Plane strain is space in which nothing moves along the third axis: the same law in three dimensions,
//! driven by the same increments, has as its third normal stress what the law in the plane must tell. Along
//! one axis both lateral stresses.

use super::{Specimen, moduli, random};
use materialpoint::law::{
    ConeMatch, ConstitutiveLaw, DruckerPrager, Hencky, Hill, LinearElastic, NeoHookean, NewtonianFluid,
    StVenantKirchhoff, Strength, VonMises,
};
use nalgebra::{Matrix2, Matrix3, SMatrix, matrix};

/// A tensor whose components off the plane are zero.
fn in_space<const D: usize>(tensor: &SMatrix<f64, D, D>) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| tensor.get((row, column)).copied().unwrap_or(0.0))
}

/// Drives a law in `D` dimensions and in space over the same path; the states must tell the same third stress
/// and plastic strain.
fn compare<const D: usize, L>(name: &str, law: &L, size: f64, start: Option<SMatrix<f64, D, D>>)
where
    L: ConstitutiveLaw<f64, D> + ConstitutiveLaw<f64, 3>,
{
    let mut plane = Specimen::<D, L>::new(law);
    let mut space = Specimen::<3, L>::new(law);
    if let Some(stress) = start {
        plane = Specimen::under(law, stress, None).unwrap();
        let off = law.off_plane_stress(&stress, &plane.state).unwrap();
        let mut whole = in_space(&stress);
        (D..3).for_each(|a| whole[(a, a)] = off);
        space = Specimen::under(law, whole, None).unwrap();
    }
    for seed in 0..30 {
        let increment = random::<D>(seed) * size;
        plane.update(&increment);
        space.update(&in_space(&increment));
        let told = ConstitutiveLaw::<f64, D>::off_plane_stress(law, &plane.stress, &plane.state).unwrap();
        let right = space.stress[(2, 2)];
        let scale = 1e-12 * moduli().p_wave() + 1e-10 * right.abs();
        assert!(
            (told - right).abs() < scale,
            "{name}, step {seed}: {told} for {right}"
        );
        let [a, b] = [
            ConstitutiveLaw::<f64, D>::plastic_strain(law, &plane.state),
            ConstitutiveLaw::<f64, 3>::plastic_strain(law, &space.state),
        ];
        assert_eq!(a.is_some(), b.is_some(), "{name}");
        assert!(
            a.zip(b).is_none_or(|(a, b)| (a - b).abs() < 1e-12),
            "{name}: {a:?} {b:?}"
        );
    }
    assert_eq!(
        ConstitutiveLaw::<f64, 3>::off_plane_stress(law, &space.stress, &space.state),
        None
    );
}

#[test]
fn every_law_knows_its_stress_off_the_plane() {
    fn of<const D: usize>() {
        let moduli = moduli();
        compare::<D, _>("linear-elastic", &LinearElastic { moduli }, 0.1, None);
        compare::<D, _>("Hill", &Hill { moduli }, 0.1, None);
        compare::<D, _>("neo-Hookean", &NeoHookean { moduli }, 0.1, None);
        compare::<D, _>("St. Venant-Kirchhoff", &StVenantKirchhoff { moduli }, 0.03, None);
        compare::<D, _>("Hencky", &Hencky { moduli }, 0.1, None);
        compare::<D, _>("von Mises", &VonMises::new(moduli, 1e5, 1e5).unwrap(), 0.05, None);
        let strength = Strength {
            cohesion: 1e5,
            friction_angle: 0.6,
            dilation_angle: 0.1,
        };
        let soil = DruckerPrager::new(moduli, &strength, ConeMatch::PlaneStrain).unwrap();
        compare::<D, _>("Drucker-Prager", &soil, 0.02, None);
        compare::<D, _>("fluid", &NewtonianFluid::new(1e6, 7.0, 0.0).unwrap(), 0.02, None);
    }
    of::<1>();
    of::<2>();
}

#[test]
fn so_does_material_that_started_under_stress() {
    let moduli = moduli();
    let stress = Some(matrix![-3e5, 1e5; 1e5, -7e5]);
    compare::<2, _>("linear-elastic", &LinearElastic { moduli }, 0.1, stress);
    compare::<2, _>("Hill", &Hill { moduli }, 0.1, stress);
    compare::<2, _>("neo-Hookean", &NeoHookean { moduli }, 0.1, stress);
    compare::<2, _>("Hencky", &Hencky { moduli }, 0.1, stress);
    compare::<2, _>(
        "von Mises",
        &VonMises::new(moduli, 1e6, 1e5).unwrap(),
        0.05,
        stress,
    );
}

/// `2 mu dev(d)` has no trace: a fluid that is only sheared or squeezed at constant volume feels no viscous
/// stress off the plane.
#[test]
fn a_viscous_fluid_too() {
    let fluid = NewtonianFluid::new(1e6, 7.0, 30.0).unwrap();
    let (mut plane, mut space) = (Matrix2::zeros(), Matrix3::zeros());
    let (mut own, mut full) = (Default::default(), Default::default());
    for seed in 0..20 {
        let increment = random::<2>(seed) * 0.01;
        fluid.update_over(1e-3, &increment, &mut plane, &mut own);
        fluid.update_over(1e-3, &in_space(&increment), &mut space, &mut full);
        let told = fluid.off_plane_stress(&plane, &own).unwrap();
        assert!(
            (told - space[(2, 2)]).abs() < 1e-7,
            "{told} for {}",
            space[(2, 2)]
        );
    }
}
