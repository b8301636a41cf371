//! A layer that drains through one face: the heat equation that every consolidation here comes down to.

use std::f64::consts::PI;

/// Time from which on the Fourier series is summed, and before which the images: where both need few terms.
const SWITCH: f64 = 0.25;
/// Terms of either sum. At the switch the first neglected one is below exp(-49) against 1.
const TERMS: u8 = 5;

/// The solution $S(\xi, \tau)$ of $S_\tau = S_{\xi\xi}$ on $0 < \xi < 1$ with $S = 1$ at $\tau = 0$, $S_\xi =
/// 0$ at $\xi = 0$ and $S = 0$ at $\xi = 1$, with its integral and derivative.
///
/// For large $\tau$ the Fourier series, for small $\tau$ its dual, the sum over images of the drained face:
///
/// $$S = \frac4\pi \sum_{j \ge 1} \frac{(-1)^{j-1}}{2j-1} \cos\frac{(2j-1)\pi\xi}{2} e^{-(2j-1)^2 \pi^2 \tau
/// / 4}
///     = 1 - \sum_{m \ge 0} (-1)^m \left(\operatorname{erfc}\frac{2m+1-\xi}{2\sqrt\tau}
///     + \operatorname{erfc}\frac{2m+1+\xi}{2\sqrt\tau}\right).$$
///
/// Source: H. S. Carslaw and J. C. Jaeger, *Conduction of Heat in Solids*, Oxford 1959, section 3.3. At $\tau
/// = 0$ the layer is still as it was, its face included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layer {
    /// $1 - S$, without cancellation where it is small.
    pub(super) drained: f64,
    /// $S$.
    pub(super) remaining: f64,
    /// $\int_0^\xi (1 - S) d\xi$.
    pub(super) drained_below: f64,
    /// $-S_\xi$, which is also the rate of `drained_below`.
    pub(super) gradient: f64,
}

impl Layer {
    /// The state at `xi`, where beyond the faces that of the face counts, and `tau`, at least 0.
    pub(super) fn at(xi: f64, tau: f64) -> Self {
        let xi = xi.clamp(0.0, 1.0);
        if tau >= SWITCH {
            Self::series(xi, tau)
        } else if tau > 0.0 {
            Self::images(xi, tau)
        } else {
            Self {
                drained: 0.0,
                remaining: 1.0,
                drained_below: 0.0,
                gradient: 0.0,
            }
        }
    }

    fn series(xi: f64, tau: f64) -> Self {
        let (mut remaining, mut below, mut gradient) = (0.0, 0.0, 0.0);
        // The cosine with its sign is the sine of the distance from the drained face, which is exactly 0
        // there.
        for j in 0..TERMS {
            let sign = if j % 2 == 0 { 1.0 } else { -1.0 };
            let odd = f64::from(2 * j + 1);
            let frequency = 0.5 * PI * odd;
            let decay = (-frequency * frequency * tau).exp();
            remaining += decay / odd * (frequency * (1.0 - xi)).sin();
            below += sign * decay / (odd * odd) * (frequency * xi).sin();
            gradient += sign * decay * (frequency * xi).sin();
        }
        remaining *= 4.0 / PI;
        Self {
            drained: 1.0 - remaining,
            remaining,
            drained_below: xi - 8.0 / (PI * PI) * below,
            gradient: 2.0 * gradient,
        }
    }

    fn images(xi: f64, tau: f64) -> Self {
        let scale = 2.0 * tau.sqrt();
        let (mut drained, mut below, mut gradient) = (0.0, 0.0, 0.0);
        for m in 0..TERMS {
            let sign = if m % 2 == 0 { 1.0 } else { -1.0 };
            let face = f64::from(2 * m + 1);
            let (near, far) = ((face - xi) / scale, (face + xi) / scale);
            drained += sign * (libm::erfc(near) + libm::erfc(far));
            below += sign * (integrated_erfc(near) - integrated_erfc(far));
            gradient += sign * (gaussian(near) - gaussian(far));
        }
        Self {
            drained,
            remaining: 1.0 - drained,
            drained_below: scale * below,
            gradient: gradient * 2.0 / scale,
        }
    }
}

/// `exp(-z^2) / sqrt(pi)`.
fn gaussian(z: f64) -> f64 {
    (-z * z).exp() / PI.sqrt()
}

/// Integral of the complementary error function from `z`, at least 0, to infinity.
///
/// Loses the factor `2 z^2` of relative precision, so nothing where it is not small against 1.
fn integrated_erfc(z: f64) -> f64 {
    (gaussian(z) - z * libm::erfc(z)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [f64; 7] = [0.0, 0.1, 0.37, 0.5, 0.8, 0.99, 1.0];

    fn assert_same(a: Layer, b: Layer, tolerance: f64) {
        for (a, b) in [
            (a.drained, b.drained),
            (a.remaining, b.remaining),
            (a.drained_below, b.drained_below),
            (a.gradient, b.gradient),
        ] {
            assert!((a - b).abs() < tolerance, "{a} against {b}");
        }
    }

    /// Around the switch neither sum has been cut off yet.
    #[test]
    fn series_and_images_agree_where_they_overlap() {
        for tau in [0.16, 0.2, 0.25, 0.3, 0.45] {
            for xi in POINTS {
                assert_same(Layer::series(xi, tau), Layer::images(xi, tau), 1e-14);
            }
        }
    }

    /// The 100 000 terms that the report sums, in the order that rounds least.
    #[test]
    fn many_terms_of_the_series_give_the_same() {
        for tau in [1e-6, 1e-4, 1e-2, 0.2, 0.6] {
            for xi in POINTS {
                let (mut remaining, mut below, mut gradient) = (0.0, 0.0, 0.0);
                for j in (0..100_000_u32).rev() {
                    let (sign, odd) = (if j % 2 == 0 { 1.0 } else { -1.0 }, f64::from(2 * j + 1));
                    let decay = (-(0.5 * PI * odd).powi(2) * tau).exp();
                    let (sine, cosine) = (0.5 * PI * odd * xi).sin_cos();
                    remaining += 4.0 / PI * sign / odd * cosine * decay;
                    below += 8.0 / (PI * PI) * sign / (odd * odd) * sine * decay;
                    gradient += 2.0 * sign * sine * decay;
                }
                let many = Layer {
                    drained: 1.0 - remaining,
                    remaining,
                    drained_below: xi - below,
                    gradient,
                };
                assert_same(Layer::at(xi, tau), many, 1e-9 * (1.0 + 1.0 / tau.sqrt()) * 1e-2);
            }
        }
    }

    /// Expected values from a 30-digit evaluation of erfc; the deep layer has drained by 2e-45 only, and says
    /// so.
    #[test]
    fn early_times_keep_their_relative_precision() {
        let deep = Layer::at(0.5, 6.25e-4).drained;
        assert!(
            (deep / 2.088_487_583_762_544_6e-45 - 1.0).abs() < 1e-12,
            "{deep:e}"
        );
        assert_eq!(Layer::at(0.5, 1e-300).drained, 0.0);
        assert_eq!(Layer::at(1.0, 1e-300).remaining, 0.0);
    }

    #[test]
    fn keeps_its_boundary_and_initial_values() {
        for tau in [1e-9, 1e-3, 0.249, 0.251, 3.0] {
            assert!(Layer::at(1.0, tau).remaining.abs() < 1e-15);
            assert!(Layer::at(0.0, tau).gradient.abs() < 1e-15);
            assert!(Layer::at(0.0, tau).drained_below.abs() < 1e-15);
            assert_eq!(Layer::at(1.7, tau), Layer::at(1.0, tau));
        }
        for xi in POINTS {
            let Layer {
                drained,
                remaining,
                gradient,
                ..
            } = Layer::at(xi, 0.0);
            assert_eq!((drained, remaining, gradient), (0.0, 1.0, 0.0));
        }
    }
}
