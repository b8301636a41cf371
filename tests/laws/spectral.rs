//! Principal values and axes: against the tensor they came from, known values, nalgebra's decomposition.
//!
//! Expected: A = Q L Q^T and Q^T Q = 1 to a few roundings, for equal, nearly equal and widely spread values
//! too; the small value of a positive definite tensor to its own rounding.

use super::random;
use materialpoint::tensor::Spectral;
use nalgebra::{Matrix1, Matrix2, Matrix3, SMatrix, Vector3, matrix};

/// Largest error of the decomposition over the size of the tensor.
fn error<const D: usize>(a: &SMatrix<f64, D, D>) -> f64 {
    let found = Spectral::of(a);
    let rebuilt = (found.map(|x| x) - a).norm() / a.norm().max(1e-300);
    let turned = (found.axes.transpose() * found.axes - SMatrix::<f64, D, D>::identity()).norm();
    rebuilt.max(turned)
}

#[test]
fn tensors_are_rebuilt_from_values_and_axes() {
    for seed in 0..2000 {
        let (a, b) = (random::<2>(seed), random::<3>(seed));
        assert!(error(&(a + a.transpose())) < 2e-15, "{seed}");
        assert!(error(&(b + b.transpose())) < 3e-15, "{seed}");
    }
    assert_eq!(Spectral::of(&Matrix1::new(-3.0)).values[0], -3.0);
}

#[test]
fn equal_and_nearly_equal_values_are_no_special_case() {
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, -1.1, 2.0).into_inner();
    for gap in [0.0, 1e-300, 1e-16, 1e-12, 1e-8, 1e-4] {
        for values in [
            Vector3::new(2.0, 2.0 + gap, 5.0),
            Vector3::new(2.0 + gap, 2.0, 2.0 - gap),
            Vector3::new(0.0, gap, -gap),
        ] {
            let a = turn * Matrix3::from_diagonal(&values) * turn.transpose();
            let a = (a + a.transpose()) / 2.0;
            if a.norm() > 0.0 {
                assert!(error(&a) < 3e-15, "{gap} {values}");
            }
        }
        assert!(error(&matrix![1.0, gap; gap, 1.0]) < 2e-15);
        assert!(error(&matrix![1.0 + gap, 0.0; 0.0, 1.0]) < 2e-15);
    }
    assert_eq!(Spectral::of(&Matrix3::<f64>::zeros()).values, Vector3::zeros());
    assert_eq!(
        Spectral::of(&Matrix2::<f64>::identity()).axes,
        Matrix2::identity()
    );
}

#[test]
fn small_values_keep_their_digits() {
    // (1 + e, 1; 1, 1): values 2 and e/2 to first order, determinant e.
    let small = 2.0_f64.powi(-40);
    let values = Spectral::of(&matrix![1.0 + small, 1.0; 1.0, 1.0]).values;
    let exact = small / (1.0 + small / 2.0 + (1.0 + small * small / 4.0).sqrt());
    assert!(
        (values.min() / exact - 1.0).abs() < 1e-3,
        "{}",
        values.min() / exact
    );
    // Scaled diagonally dominant: each value as good as its own size.
    let scale = Matrix3::from_diagonal(&Vector3::new(1.0, 1e-9, 1e-18));
    let a = scale * matrix![1.0, 0.3, -0.2; 0.3, 1.0, 0.1; -0.2, 0.1, 1.0] * scale;
    let found = Spectral::of(&a).values;
    let product: f64 = found.iter().product();
    // Determinant of the inner matrix, by hand.
    let inner = 1.0 - 0.01 - 0.3 * (0.3 + 0.02) - 0.2 * (0.03 + 0.2);
    assert!((product / (inner * 1e-54) - 1.0).abs() < 1e-13, "{product:e}");
}

#[test]
fn values_agree_with_another_decomposition() {
    for seed in 0..500 {
        let a = random::<3>(seed);
        let a = a + a.transpose();
        let mut ours: Vec<f64> = Spectral::of(&a).values.iter().copied().collect();
        let mut theirs: Vec<f64> = a.symmetric_eigen().eigenvalues.iter().copied().collect();
        ours.sort_by(f64::total_cmp);
        theirs.sort_by(f64::total_cmp);
        for (x, y) in ours.iter().zip(&theirs) {
            assert!((x - y).abs() < 4e-15 * a.norm().max(1.0), "{seed}: {x} {y}");
        }
    }
}

#[test]
fn what_is_not_a_number_ends() {
    let found = Spectral::of(&Matrix3::from_element(f64::NAN));
    assert!(found.values.iter().all(|v| v.is_nan()));
    let _ = Spectral::of(&Matrix3::from_element(f64::INFINITY));
}
