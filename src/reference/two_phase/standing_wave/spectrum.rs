//! The quartic whose roots are the eigenvalues of one mode of a saturated soil.

use nalgebra::Complex;

/// Halvings of a logarithmic interval of 200, down to its rounding.
const HALVINGS: u32 = 64;
/// The interval, as factor `exp(-200)` from its upper end: the drag may exceed the frequency by 1e40.
const INTERVAL: f64 = 200.0;

/// The polynomial $z^4 + \delta z^3 + (1 + \gamma + g) z^2 + \delta z + \gamma$, all of whose coefficients
/// are positive.
///
/// It is $(z^2 + a_1) (z^2 + a_2) + \delta z (z^2 + 1)$ with $a_2 \le 1 \le a_1$: two undamped waves without
/// drag, which tie into one of frequency 1 when the drag $\delta$ grows. It splits into
///
/// $$(z^2 + 2 \mu z + 1 + y) \left(z^2 + (\delta - 2 \mu) z + \frac{\gamma}{1 + y}\right).$$
///
/// Comparing coefficients leaves one equation for $y$, whose every term is a product of quantities that do
/// not cancel; so $y$ and the damping $\mu$ come out with full relative precision even where they are 1e-15
/// of the frequency. Own derivation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spectrum {
    /// $\delta$
    pub(super) drag: f64,
    /// $g$, at least 0: how far the tied wave sets the liquid in motion relative to the solid.
    pub(super) coupling: f64,
    /// $\gamma$
    pub(super) product: f64,
}

/// A factor $z^2 + 2 \mu z + 1 + y$.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Factor {
    /// $\mu$
    pub(super) damping: f64,
    /// $y$
    pub(super) excess: f64,
}

impl Factor {
    pub(super) fn roots(self) -> [Complex<f64>; 2] {
        quadratic_roots(self.damping, 1.0 + self.excess)
    }
}

impl Spectrum {
    /// The factor of the pair that becomes $\pm i$ for large drag.
    pub(super) fn fast(&self) -> Factor {
        if self.coupling == 0.0 {
            return Factor {
                damping: 0.0,
                excess: 0.0,
            };
        }
        if self.product <= 1.0 {
            return self.upper();
        }
        // In 1/z the polynomial has the same form, and the lower pair is the upper one.
        let mirrored = Self {
            drag: self.drag / self.product,
            coupling: self.coupling / self.product,
            product: 1.0 / self.product,
        };
        let Factor { damping, excess } = mirrored.upper();
        Factor {
            damping: damping / (1.0 + excess),
            excess: -excess / (1.0 + excess),
        }
    }

    /// The factor with $0 \le y \le a_1 - 1$, for $\gamma \le 1$.
    fn upper(&self) -> Factor {
        let below = self.below_one();
        let [highest, depth] = self.undamped_distances();
        let square = self.drag * self.drag;
        let defect = |y: f64| {
            let waves = (highest - y) * (y + depth) * (below + y * (2.0 + y)).powi(2);
            waves - square * y * (1.0 + y).powi(2) * (below + y)
        };
        let (mut low, mut high) = (-INTERVAL, 0.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if defect(highest * f64::exp(middle)) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let excess = highest * f64::exp(0.5 * (low + high));
        Factor {
            damping: 0.5 * self.drag * (1.0 + excess) * excess / (below + excess * (2.0 + excess)),
            excess,
        }
    }

    /// $1 - \gamma$. Equal to 1, $\gamma$ makes the pairs ambiguous; then it is taken for less, by its
    /// rounding.
    fn below_one(&self) -> f64 {
        if self.product == 1.0 {
            f64::EPSILON
        } else {
            1.0 - self.product
        }
    }

    /// $a_1 - 1$ and $1 - a_2$: the roots of $h^2 - (g + \gamma - 1) h - g$, the second with its sign
    /// changed.
    fn undamped_distances(&self) -> [f64; 2] {
        let middle = self.coupling + self.product - 1.0;
        let larger = 0.5 * (middle.abs() + (middle * middle + 4.0 * self.coupling).sqrt());
        let smaller = self.coupling / larger;
        if middle > 0.0 {
            [larger, smaller]
        } else {
            [smaller, larger]
        }
    }

    /// The roots: first the pair of [`fast`](Self::fast), then the other one.
    pub(super) fn roots(&self) -> [Complex<f64>; 4] {
        let fast = self.fast();
        let Factor { excess, .. } = fast;
        let below = self.below_one();
        let part = if excess == 0.0 {
            1.0
        } else {
            (below + excess) / (below + excess * (2.0 + excess))
        };
        let [first, second] = fast.roots();
        let [third, fourth] = quadratic_roots(0.5 * self.drag * part, self.product / (1.0 + excess));
        [first, second, third, fourth]
    }
}

/// Roots of $z^2 + 2 m z + c$ for $m \ge 0$, $c > 0$: conjugate, the upper first, or real, the slower first.
fn quadratic_roots(half: f64, constant: f64) -> [Complex<f64>; 2] {
    // Neither square may overflow before the difference is taken.
    let root = constant.sqrt();
    let discriminant = (half - root) * (half + root);
    if discriminant < 0.0 {
        let upper = Complex::new(-half, (-discriminant).sqrt());
        [upper, upper.conj()]
    } else {
        let faster = -half - discriminant.sqrt();
        [Complex::from(constant / faster), Complex::from(faster)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(s: Spectrum, z: Complex<f64>) -> (Complex<f64>, f64) {
        let middle = 1.0 + s.product + s.coupling;
        let terms = [
            z.powu(4),
            z.powu(3) * s.drag,
            z * z * middle,
            z * s.drag,
            s.product.into(),
        ];
        (terms.iter().sum(), terms.iter().map(|t| t.norm()).sum())
    }

    /// Soft and stiff skeletons, light and heavy coupling, drag over 30 decades.
    #[test]
    fn roots_satisfy_the_polynomial() {
        for product in [1e-6, 0.1, 0.9, 1.0, 1.3, 40.0] {
            for coupling in [1e-9, 0.2, 3.0] {
                for exponent in -15..=15 {
                    let spectrum = Spectrum {
                        drag: 10_f64.powi(exponent),
                        coupling,
                        product,
                    };
                    let roots = spectrum.roots();
                    for z in roots {
                        let (residual, scale) = polynomial(spectrum, z);
                        assert!(residual.norm() < 1e-13 * scale, "{spectrum:?}: {residual} at {z}");
                        assert!(z.re <= 0.0, "{spectrum:?}: {z}");
                    }
                    // Vieta: the product of all, and the sum against the drag.
                    let all: Complex<f64> = roots.iter().product();
                    assert!((all / product - 1.0).norm() < 1e-12, "{spectrum:?}: {all}");
                    let sum: Complex<f64> = roots.iter().sum();
                    assert!(
                        (sum.re / spectrum.drag + 1.0).abs() < 1e-12,
                        "{spectrum:?}: {sum}"
                    );
                }
            }
        }
    }

    /// First orders: y = g (1 - gamma) / delta^2 and mu = g / (2 delta) for large drag, far below rounding
    /// of 1.
    #[test]
    fn weak_damping_keeps_its_digits() {
        let Factor { damping, excess } = Spectrum {
            drag: 1e12,
            coupling: 0.2,
            product: 0.1,
        }
        .fast();
        assert!((damping / 1e-13 - 1.0).abs() < 1e-12, "{damping}");
        assert!((excess / 0.18e-24 - 1.0).abs() < 1e-12, "{excess}");
    }

    /// Without coupling the tied wave is free of drag, and the other is the oscillator z^2 + delta z + gamma.
    #[test]
    fn uncoupled_wave_is_undamped() {
        let [fast, _, slow, decay] = Spectrum {
            drag: 2.5,
            coupling: 0.0,
            product: 1.0,
        }
        .roots();
        assert_eq!(fast, Complex::i());
        assert!((slow + 0.5).norm() < 1e-15 && (decay + 2.0).norm() < 1e-15);
    }
}
