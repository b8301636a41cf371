//! Tangents of the laws that work in principal axes, by dual numbers: wherever values are equal or axes lie
//! along the grid's, axes have no derivative, or one that a value of zero hides, but the stress has one.
//!
//! Expected: closed forms, and extrapolated central differences of the stress in `f64`, whose own error is
//! some 1e-10 of the modulus.

use materialpoint::law::{
    ConeMatch, ConstitutiveLaw, DruckerPrager, Hencky, Moduli, NeoHookean, Strength, VonMises,
};
use materialpoint::scalar::Scalar;
use materialpoint::tensor::Spectral;
use nalgebra::{Matrix2, Matrix3, SMatrix, matrix};

use super::dual::Dual;

const LAMBDA: f64 = 3.0;
const MU: f64 = 2.0;

fn moduli<T: Scalar>() -> Moduli<T> {
    Moduli {
        lambda: T::lit(LAMBDA),
        mu: T::lit(MU),
    }
}

fn metal<T: Scalar>() -> VonMises<T> {
    VonMises::new(moduli(), T::lit(0.05), T::lit(0.5)).unwrap()
}

fn soil<T: Scalar>() -> DruckerPrager<T> {
    let strength = Strength {
        cohesion: T::lit(0.02),
        friction_angle: T::lit(0.5),
        dilation_angle: T::lit(0.2),
    };
    DruckerPrager::new(moduli(), &strength, ConeMatch::TriaxialCompression).unwrap()
}

/// Stress (Pa) after the increments of `path` and then `last`, from rest.
fn stress<T, L, const D: usize>(
    law: &L,
    path: &[SMatrix<f64, D, D>],
    last: &SMatrix<T, D, D>,
) -> SMatrix<T, D, D>
where
    T: Scalar,
    L: ConstitutiveLaw<T, D>,
{
    let (mut stress, mut state) = (SMatrix::zeros(), L::State::default());
    for increment in path {
        law.update(&increment.map(T::lit), &mut stress, &mut state);
    }
    law.update(last, &mut stress, &mut state);
    stress
}

fn unit<const D: usize>(i: usize, j: usize) -> SMatrix<f64, D, D> {
    let mut unit = SMatrix::zeros();
    unit[(i, j)] = 1.0;
    unit
}

/// Change of the stress with the component `(i, j)` of the last increment.
fn tangent<L, const D: usize>(
    law: &L,
    path: &[SMatrix<f64, D, D>],
    last: &SMatrix<f64, D, D>,
    (i, j): (usize, usize),
) -> SMatrix<f64, D, D>
where
    L: ConstitutiveLaw<Dual, D>,
{
    let mut dual = last.map(Dual::from);
    dual[(i, j)].derivative = 1.0;
    stress(law, path, &dual).map(|s| s.derivative)
}

/// Against central differences, in all components.
fn compare<A, B, const D: usize>(
    name: &str,
    (dual, plain): (&A, &B),
    path: &[SMatrix<f64, D, D>],
    last: SMatrix<f64, D, D>,
) where
    A: ConstitutiveLaw<Dual, D>,
    B: ConstitutiveLaw<f64, D>,
{
    let step = 1e-4;
    for (i, j) in (0..D).flat_map(|i| (0..D).map(move |j| (i, j))) {
        let at = |size: f64| stress(plain, path, &(last + unit(i, j) * size));
        let slope = |step: f64| (at(step) - at(-step)) / (2.0 * step);
        // Extrapolated: values that differ by 0.01 make the stress bend on that scale.
        let expected = (slope(step) * 4.0 - slope(2.0 * step)) / 3.0;
        let found = tangent(dual, path, &last, (i, j));
        let error = (found - expected).amax();
        assert!(
            error < 2e-9,
            "{name}, component ({i}, {j}): {found} instead of {expected}"
        );
    }
}

/// Of each law, elastic and plastic, where the last increment is along the grid's axes with distinct values,
/// with equal ones, and in general position.
fn at_every_kind_of_state<const D: usize>() {
    let diagonal =
        |values: [f64; 3]| SMatrix::<f64, D, D>::from_fn(|i, j| if i == j { values[i] } else { 0.0 });
    let general = SMatrix::<f64, D, D>::from_fn(|i, j| 0.01 * ((3 * i + 5 * j + 1) % 7) as f64 - 0.03);
    let states = [
        ("distinct", diagonal([0.04, -0.01, 0.02])),
        ("uniaxial", diagonal([0.05, 0.0, 0.0])),
        ("two equal", diagonal([-0.02, -0.02, 0.03])),
        ("all equal", diagonal([-0.02; 3])),
        ("general", general),
    ];
    for (name, last) in states {
        compare(
            name,
            (&Hencky { moduli: moduli() }, &Hencky { moduli: moduli() }),
            &[],
            last,
        );
        compare(name, (&metal(), &metal()), &[], last);
        // Pressed together first, so that the cone and not its apex is met.
        compare(name, (&soil(), &soil()), &[diagonal([-0.05; 3])], last);
        // And after a way that the axes turned on. Metal that is pressed evenly would stay where plastic flow
        // begins.
        if name != "all equal" {
            compare(name, (&metal(), &metal()), &[general], last);
        }
        compare(name, (&soil(), &soil()), &[diagonal([-0.05; 3]), general], last);
    }
    // Pulled to the apex, which bears its own stress: that over a volume that changes.
    compare("apex", (&soil(), &soil()), &[], diagonal([0.05, 0.04, 0.03]));
}

#[test]
fn tangents_are_those_of_differences() {
    at_every_kind_of_state::<2>();
    at_every_kind_of_state::<3>();
}

/// Hooke's law, wherever the axes of nothing point: at rest, turned as a whole, strained by next to nothing.
#[test]
fn unstrained_material_has_hooke_s_tangent() {
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, -1.1, 2.0).into_inner();
    let plane = nalgebra::Rotation2::new(0.7).into_inner();
    let some = matrix![0.3, 0.7, -0.2; -0.5, 0.1, 0.4; 0.9, -0.6, 0.2];
    let in_plane = some.fixed_view::<2, 2>(0, 0).into_owned();
    for size in [0.0, 1e-16, 1e-14, 1e-12, 1e-11] {
        hooke::<3>(&[some * size]);
        hooke::<3>(&[turn - Matrix3::identity(), some * size]);
        hooke::<2>(&[in_plane * size]);
        hooke::<2>(&[plane - Matrix2::identity(), in_plane * size]);
    }
}

fn hooke<const D: usize>(path: &[SMatrix<f64, D, D>]) {
    for (i, j) in (0..D).flat_map(|i| (0..D).map(move |j| (i, j))) {
        let strain = (unit::<D>(i, j) + unit(j, i)) / 2.0;
        let expected = SMatrix::identity() * (LAMBDA * strain.trace()) + strain * (2.0 * MU);
        for found in [
            tangent(&Hencky { moduli: moduli() }, path, &SMatrix::zeros(), (i, j)),
            tangent(&metal(), path, &SMatrix::zeros(), (i, j)),
            tangent(&soil(), path, &SMatrix::zeros(), (i, j)),
        ] {
            // Strains of 1e-11 change the tangent by some times as much, and differences over them lose as
            // little.
            assert!(
                (found - expected).amax() < 1e-9,
                "({i}, {j}): {found} instead of {expected}"
            );
        }
    }
}

/// Of values that differ: `(sigma_1 - sigma_2) / (b_1 - b_2)` times the change of `b_12`, here by shear of a
/// bar that is stretched, over the whole range from equal to far apart.
#[test]
fn shear_of_a_stretched_bar_has_its_closed_form() {
    for exponent in -16..0 {
        let e = 10.0_f64.powi(exponent) * 0.7;
        let found = tangent(
            &Hencky { moduli: moduli() },
            &[],
            &matrix![e, 0.0; 0.0, 0.0],
            (0, 1),
        )[(0, 1)];
        let (b, j, log) = ((1.0 + e) * (1.0 + e), 1.0 + e, e.ln_1p());
        // sigma_1 - sigma_2 = 2 mu ln(1 + e) / J; d b_12 = b_22 = 1.
        let expected = 2.0 * MU * log / j / (2.0 * e + e * e);
        assert!(
            (found / expected - 1.0).abs() < 1e-10,
            "{e:e}: {found} instead of {expected}, {b}"
        );
    }
}

/// A state made for a stress changes with it: the step after gives the stress back, and its change.
#[test]
fn a_start_under_stress_keeps_the_derivative_of_its_shear() {
    for base in [
        Matrix2::zeros(),
        matrix![-0.1, 0.0; 0.0, -0.1],
        matrix![-0.1, 0.0; 0.0, 0.05],
    ] {
        let mut given = base.map(Dual::from);
        given[(0, 1)].derivative = 1.0;
        given[(1, 0)].derivative = 1.0;
        kept(&Hencky { moduli: moduli() }, &given);
        kept(&NeoHookean { moduli: moduli() }, &given);
    }
}

fn kept<L: ConstitutiveLaw<Dual, 2>>(law: &L, given: &Matrix2<Dual>) {
    let mut state = law.start(given, None).unwrap();
    let mut stress = SMatrix::zeros();
    law.update(&SMatrix::zeros(), &mut stress, &mut state);
    for (found, given) in stress.iter().zip(given) {
        assert!((found.value - given.value).abs() < 1e-14);
        assert!(
            (found.derivative - given.derivative).abs() < 1e-12,
            "{found} {given}"
        );
    }
}

/// The function that applies `f` to each value, where those are equal: `f'` times the change of the tensor.
#[test]
fn a_function_of_a_tensor_keeps_its_derivative() {
    let change = matrix![0.3, 0.5, -0.7; 0.5, 0.2, 0.4; -0.7, 0.4, -0.6];
    let a = Matrix3::from_fn(|i, j| Dual::new(if i == j { 2.0 } else { 0.0 }, change[(i, j)]));
    let cubes = Spectral::of(&a).map(|x| x * x * x);
    for (found, change) in cubes.iter().zip(&change) {
        assert!(
            (found.derivative - 12.0 * change).abs() < 1e-13,
            "{found} {change}"
        );
    }
}
