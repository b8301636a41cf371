//! The functions of exponential integrators.

/// Terms of the Taylor series, enough for arguments down to -1.
const TERMS: u32 = 18;

/// $\varphi_0 = e^z$ and $\varphi_{k+1} = (\varphi_k - 1/k!) / z$ up to $k = 3$, for $z \le 0$.
pub(super) fn phi(z: f64) -> [f64; 4] {
    if z < -1.0 {
        let zero = z.exp();
        let one = (zero - 1.0) / z;
        let two = (one - 1.0) / z;
        [zero, one, two, (two - 0.5) / z]
    } else {
        // Horner's scheme for the sum of z^j / (j + 3)!.
        let sum = (1..=TERMS)
            .rev()
            .fold(1.0, |sum, j| 1.0 + z * sum / f64::from(j + 3));
        let three = sum / 6.0;
        let two = 0.5 + z * three;
        let one = 1.0 + z * two;
        [1.0 + z * one, one, two, three]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The recurrence upwards is accurate for large arguments, the series everywhere with enough terms.
    #[test]
    fn both_branches_are_the_series() {
        for z in [0.0, -1e-9, -0.3, -0.999, -1.001, -2.5, -6.0] {
            let mut factorial = 1.0;
            for (k, value) in phi(z).into_iter().enumerate() {
                if k > 0 {
                    factorial *= k as f64;
                }
                let (mut sum, mut term) = (0.0, 1.0 / factorial);
                for j in 1..80 {
                    sum += term;
                    term *= z / (j + k) as f64;
                }
                assert!((value - sum).abs() < 2e-14, "phi_{k}({z}) = {value}, not {sum}");
            }
        }
    }

    #[test]
    fn stiff_limits() {
        let [zero, one, two, three] = phi(-1e12);
        assert_eq!(zero, 0.0);
        assert!((one / 1e-12 - 1.0).abs() < 1e-11);
        assert!((two / 1e-12 - 1.0).abs() < 1e-11);
        assert!((three / 0.5e-12 - 1.0).abs() < 1e-11);
    }
}
