//! Mandel's series.

use super::{FORCE, LIQUID, POISSON, POROSITY, START, YOUNG};

/// Terms of the series: the exponential of the next one is 4e-14 at the start.
const TERMS: usize = 12;

/// Mandel's series for a half width of 1 m. Pressure is positive in tension, as in the code.
pub(super) struct Mandel {
    shear: f64,
    /// Poisson's ratios, drained and undrained.
    nu: [f64; 2],
    /// Permeability over the unit weight (m2/(Pa s)).
    mobility: f64,
    roots: Vec<f64>,
    /// Twice the pressure (Pa) in the first moment.
    pub(super) scale: f64,
}

impl Mandel {
    pub(super) fn new() -> Self {
        let shear = YOUNG / (2.0 * (1.0 + POISSON));
        let lame = 2.0 * shear * POISSON / (1.0 - 2.0 * POISSON);
        let storage = LIQUID / POROSITY;
        let undrained = (lame + storage) / (2.0 * (lame + storage + shear));
        let ratio = (1.0 - POISSON) / (undrained - POISSON);
        Self {
            shear,
            nu: [POISSON, undrained],
            // c_v = 1 m2/s.
            mobility: 1.0 / storage + 1.0 / (lame + 2.0 * shear),
            roots: (0..TERMS).map(|i| root(i, ratio)).collect(),
            scale: FORCE * storage / (storage + lame + shear),
        }
    }

    /// Permeability (m/s) for gravity 9.81 m/s2.
    pub(super) fn permeability(&self) -> f64 {
        self.mobility * 9810.0
    }

    /// `sum f(alpha) exp(-alpha^2 t) / (alpha - sin alpha cos alpha)`, term by term.
    fn terms(&self, t: f64, f: impl Fn(f64) -> f64) -> Vec<f64> {
        let term = |&a: &f64| f(a) * (-a * a * t).exp() / (a - a.sin() * a.cos());
        self.roots.iter().map(term).collect()
    }

    fn sum(&self, t: f64, f: impl Fn(f64) -> f64) -> f64 {
        self.terms(t, f).iter().sum()
    }

    pub(super) fn pressure(&self, x: f64, t: f64) -> f64 {
        -self.scale * self.sum(t, |a| a.sin() * ((a * x).cos() - a.cos()))
    }

    /// Effective stress along y.
    pub(super) fn stress(&self, x: f64, t: f64) -> f64 {
        let [nu, undrained] = self.nu;
        let along = (undrained - nu) / (1.0 - nu) * 2.0 * FORCE;
        let total = self.sum(t, |a| {
            2.0 * FORCE * a.sin() * a.cos() - along * a.sin() * (a * x).cos()
        });
        total - FORCE - self.pressure(x, t)
    }

    pub(super) fn side(&self, t: f64) -> f64 {
        let [nu, undrained] = self.nu;
        let change = self.sum(t, |a| (1.0 - undrained) * a.sin() * a.cos());
        FORCE / self.shear * (nu / 2.0 + change)
    }

    /// Velocity along y over y.
    pub(super) fn pressing(&self, t: f64) -> f64 {
        let share = FORCE * (1.0 - self.nu[1]) / self.shear;
        -share * self.sum(t, |a| a * a * a.sin() * a.cos())
    }

    /// The state at the start, as keys of a body; velocities half a step before.
    pub(super) fn state(&self, dt: f64) -> [String; 4] {
        let before = START - dt / 2.0;
        let series = |parts: Vec<f64>, function: &str| {
            let parts = parts.iter().zip(&self.roots);
            let parts: Vec<String> = parts
                .map(|(c, a)| format!("({c:?})*{function}({a:?}*x)"))
                .collect();
            parts.join("+")
        };
        let [nu, undrained] = self.nu;
        let even = self.scale * self.sum(START, |a| a.sin() * a.cos());
        let pressure = format!(
            "{even:?}+{}",
            series(self.terms(START, |a| -self.scale * a.sin()), "cos")
        );
        let along = (undrained - nu) / (1.0 - nu) * 2.0 * FORCE;
        let rest = self.sum(START, |a| 2.0 * FORCE * a.sin() * a.cos()) - FORCE;
        let total = format!(
            "{rest:?}+{}",
            series(self.terms(START, |a| -along * a.sin()), "cos")
        );
        let strain = self.sum(before, |a| undrained * a * a * a.sin() * a.cos()) * FORCE / self.shear;
        let solid = self.terms(before, |a| -FORCE / self.shear * a * a * a.cos());
        let solid = format!("{strain:?}*x+{}", series(solid, "sin"));
        let slip = self.terms(before, |a| self.mobility / POROSITY * self.scale * a * a.sin());
        let up = format!("{:?}*y", self.pressing(before));
        [
            format!("body.0.pore_pressure=\"{pressure}\""),
            format!("body.0.stress={{ xx = \"-({pressure})\", yy = \"{total}-({pressure})\" }}"),
            format!("body.0.velocity=[\"{solid}\", \"{up}\"]"),
            format!(
                "body.0.liquid_velocity=[\"{solid}+{}\", \"{up}\"]",
                series(slip, "sin")
            ),
        ]
    }
}

/// The root of `tan(alpha) / alpha = ratio` between `i pi` and `(i + 1/2) pi`, by halving.
fn root(i: usize, ratio: f64) -> f64 {
    let (mut low, mut high) = (
        std::f64::consts::PI * i as f64 + if i == 0 { 1e-3 } else { 0.0 },
        std::f64::consts::PI * (i as f64 + 0.5),
    );
    for _ in 0..200 {
        let middle = (low + high) / 2.0;
        if middle.tan() < ratio * middle {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
