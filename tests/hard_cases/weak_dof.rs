//! A DOF that particles hardly see is lumped: sums of rows, hence mass and momentum, stay.

use materialpoint::mass::Banded;
use nalgebra::vector;

/// Masses of linear functions: unit particles at 0.5 of the first cell and just in the second one.
fn masses() -> Banded<f64> {
    let mut matrix = Banded::zeros(3, 1);
    for (first, value) in [(0, 0.5), (1, 1e-6)] {
        let shares = [(first, 1.0 - value), (first + 1, value)];
        for (i, a) in shares {
            shares.iter().for_each(|&(j, b)| matrix.add(i, j, a * b));
        }
    }
    matrix
}

#[test]
fn a_weak_row_becomes_its_sum_and_no_other_does() {
    let (before, mut after) = (masses(), masses());
    after.lump_weak(0.3);
    let ones = [vector![1.0]; 3];
    for (a, b) in before.multiply(&ones).iter().zip(after.multiply(&ones)) {
        assert!((a[0] - b[0]).abs() < 1e-16);
    }
    let column = |k: usize| {
        let mut unit = [vector![0.0]; 3];
        unit[k][0] = 1.0;
        after.multiply(&unit)
    };
    assert_eq!(column(2)[1][0], 0.0);
    assert!((column(2)[2][0] - 1e-6).abs() < 1e-21);
    assert_eq!(column(0)[1][0], 0.25);
}
