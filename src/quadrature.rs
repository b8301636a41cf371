//! Gauss-Legendre quadrature in any scalar.

use crate::scalar::Scalar;

/// Points and weights of the `n`-point Gauss-Legendre rule on `[-1, 1]`, exact for degree `2 n - 1`.
///
/// Newton's method on the Legendre polynomial in the scalar itself, so the rule is as exact as `T`.
pub fn gauss_legendre<T: Scalar>(n: usize) -> Vec<(T, T)> {
    // The lower half mirrors the upper one, so that odd functions integrate to exactly zero.
    let upper: Vec<(T, T)> = (0..n / 2).map(|i| point_and_weight(n, i)).collect();
    let lower = upper.iter().map(|&(x, w)| (-x, w));
    let middle = (n % 2 == 1).then(|| (T::zero(), point_and_weight(n, n / 2).1));
    lower.chain(middle).chain(upper.iter().rev().copied()).collect()
}

fn point_and_weight<T: Scalar>(n: usize, i: usize) -> (T, T) {
    let angle = std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5);
    let mut x = T::lit(angle.cos());
    // The start has three digits and each pass doubles them: six passes serve 100 digits.
    for _ in 0..6 {
        let (p, slope) = legendre(n, x);
        x -= p / slope;
    }
    let (_, slope) = legendre(n, x);
    (x, T::lit(2.0) / ((T::one() - x * x) * slope * slope))
}

/// Legendre polynomial of degree `n` and its derivative, `|x| < 1`.
fn legendre<T: Scalar>(n: usize, x: T) -> (T, T) {
    let (mut before, mut p) = (T::zero(), T::one());
    for k in 0..n {
        let next = (T::count(2 * k + 1) * x * p - T::count(k) * before) / T::count(k + 1);
        (before, p) = (p, next);
    }
    (p, T::count(n) * (before - x * p) / (T::one() - x * x))
}

#[cfg(test)]
mod tests {
    use super::gauss_legendre;

    #[test]
    fn the_rule_is_exact_up_to_its_degree_and_not_beyond() {
        for n in 1..8_usize {
            let rule = gauss_legendre::<f64>(n);
            let integral = |d: usize| rule.iter().map(|(x, w)| w * x.powi(d as i32)).sum::<f64>();
            for d in 0..2 * n {
                let exact = if d % 2 == 0 { 2.0 / (d as f64 + 1.0) } else { 0.0 };
                assert!((integral(d) - exact).abs() < 1e-14, "{n} points, degree {d}");
            }
            assert!((integral(2 * n) - 2.0 / (2.0 * n as f64 + 1.0)).abs() > 1e-6);
        }
    }

    #[test]
    fn two_points_are_symmetric_to_the_last_bit() {
        let rule = gauss_legendre::<f64>(2);
        assert_eq!(rule[0].0, -rule[1].0);
        assert!((rule[1].0 - 1.0 / 3.0_f64.sqrt()).abs() < 2e-16);
    }
}
