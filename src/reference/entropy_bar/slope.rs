//! Differences across a cell that do not overshoot.

/// The limited difference across a cell from those to its neighbours: van Albada's average (G. D. van Albada,
/// B. van Leer, W. W. Roberts, Astron. Astrophys. 108, 1982),
///
/// `((b^2 + e) a + (a^2 + e) b) / (a^2 + b^2 + 2 e)`.
///
/// Where `a` and `b` are alike it is their mean, beside a jump the smaller one. `floor` is `e`: differences
/// that are small against its root are averaged whatever their signs, so that smooth extrema, where they are
/// of the order of the cell's square, are not clipped.
pub(super) fn limited(a: f64, b: f64, floor: f64) -> f64 {
    let (square_a, square_b) = (a * a + floor, b * b + floor);
    let sum = square_a + square_b;
    // Without any motion there is no floor and no difference.
    if sum > 0.0 {
        (square_b * a + square_a * b) / sum
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::limited;

    #[test]
    fn alike_they_are_averaged_beside_a_jump_the_smaller_one_counts() {
        assert_eq!(limited(2.0, 2.0, 0.0), 2.0);
        assert!((limited(1.0, 1.1, 0.0) - 1.05).abs() < 6e-3);
        assert!(limited(1e-3, 1.0, 0.0) < 1.1e-3);
        assert_eq!(limited(-1.0, 1.0, 0.0), 0.0);
        assert_eq!(limited(0.0, 0.0, 0.0), 0.0);
        // A jump is seen through the floor, an extremum is not clipped.
        assert!(limited(0.0, 1.0, 1e-6) < 2e-6);
        assert!((limited(-1e-6, 2e-6, 1e-6) - 0.5e-6).abs() < 1e-11);
    }
}
