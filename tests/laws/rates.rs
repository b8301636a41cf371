//! The plastic laws against their rate equations, integrated apart.
//!
//! Principal axes that stand still, logarithmic strains (t - 3/2 t^2, t^2, -sin(2t)/2) times 2 %: the
//! direction turns while the material flows. The rates d tau = C (d e - d gamma M), d gamma = N C d e / (N C
//! M + h) are integrated by the midpoint rule in 2e5 steps. Expected: the law's implicit return converges to
//! that at first order (error 1e-4 of the strength at 1600 steps).

use super::{Specimen, moduli};
use materialpoint::law::{ConeMatch, ConstitutiveLaw, DruckerPrager, Strength, VonMises};
use nalgebra::{Matrix3, Vector3};

const STRAIN: f64 = 0.02;

fn path(t: f64) -> Vector3<f64> {
    Vector3::new(t - 1.5 * t * t, t * t, -(2.0 * t).sin() / 2.0) * STRAIN
}

/// Kirchhoff stress of principal strains.
fn hooke(e: &Vector3<f64>) -> Vector3<f64> {
    let m = moduli();
    e.map(|x| 2.0 * m.mu * x + m.lambda * e.sum())
}

fn deviator(s: &Vector3<f64>) -> Vector3<f64> {
    s.map(|x| x - s.sum() / 3.0)
}

/// Yield function, its normal, flow direction; hardening modulus.
struct Plasticity<F> {
    yields: F,
    hardening: f64,
}

impl<F: Fn(&Vector3<f64>, f64) -> (f64, Vector3<f64>, Vector3<f64>)> Plasticity<F> {
    /// Rates of elastic strain and hardening variable.
    fn rates(&self, e: &Vector3<f64>, alpha: f64, rate: &Vector3<f64>) -> (Vector3<f64>, f64) {
        let (phi, normal, flow) = (self.yields)(&hooke(e), alpha);
        let loading = normal.dot(&hooke(rate));
        if phi < -1e-9 || loading <= 0.0 {
            return (*rate, 0.0);
        }
        let gamma = loading / (normal.dot(&hooke(&flow)) + self.hardening);
        (rate - flow * gamma, gamma)
    }

    /// Kirchhoff stress at the end of the path.
    fn integrate(&self, start: Vector3<f64>, steps: u32) -> Vector3<f64> {
        let (mut e, mut alpha) = (start, 0.0);
        let dt = 1.0 / f64::from(steps);
        for k in 0..steps {
            let t = f64::from(k) * dt;
            let rate = (path(t + dt) - path(t)) / dt;
            let (half, half_alpha) = self.rates(&e, alpha, &rate);
            let (slope, slope_alpha) =
                self.rates(&(e + half * (dt / 2.0)), alpha + half_alpha * dt / 2.0, &rate);
            e += slope * dt;
            alpha += slope_alpha * dt;
        }
        hooke(&e)
    }
}

/// Kirchhoff stress of the law at the end of the path.
fn follow<L: ConstitutiveLaw<f64, 3>>(law: &L, start: Matrix3<f64>, steps: u32) -> Vector3<f64> {
    let mut specimen = Specimen::under(law, start, None).unwrap();
    specimen.volume = start_volume(&start);
    for k in 0..steps {
        let strain = path(f64::from(k + 1) / f64::from(steps)) - path(f64::from(k) / f64::from(steps));
        specimen.update(&Matrix3::from_diagonal(&strain.map(f64::exp_m1)));
    }
    specimen.kirchhoff().diagonal()
}

/// `J` of an isotropic initial stress, by iteration of ln J = J s / K.
fn start_volume(stress: &Matrix3<f64>) -> f64 {
    let s = stress.trace() / 3.0 / moduli().bulk();
    (0..200).fold(0.0, |x: f64, _| s * x.exp()).exp()
}

fn orders<L: ConstitutiveLaw<f64, 3>>(law: &L, start: Matrix3<f64>, exact: &Vector3<f64>, unit: f64) {
    let errors = [400, 800, 1600].map(|steps| (follow(law, start, steps) - exact).norm() / unit);
    let order = (errors[0] / errors[2]).log2() / 2.0;
    println!("errors {errors:?}, order {order:.2}");
    assert!(errors[2] < 1e-3 && (order - 1.0).abs() < 0.15, "{errors:?}");
}

#[test]
fn von_mises_converges_to_its_rates() {
    let (strength, hardening) = (5e4, 4e5);
    let law = VonMises::new(moduli(), strength, hardening).unwrap();
    let rates = Plasticity {
        yields: |s: &Vector3<f64>, alpha: f64| {
            let d = deviator(s);
            let q = (1.5 * d.norm_squared()).sqrt();
            let normal = d * (1.5 / q.max(1e-300));
            (q - strength - hardening * alpha, normal, normal)
        },
        hardening,
    };
    let exact = rates.integrate(Vector3::zeros(), 200_000);
    orders(&law, Matrix3::zeros(), &exact, strength);
}

#[test]
fn drucker_prager_converges_to_its_rates() {
    let (friction, dilation, cohesion) = (0.6_f64, 0.25_f64, 2e4);
    let strength = Strength {
        cohesion,
        friction_angle: friction,
        dilation_angle: dilation,
    };
    let law = DruckerPrager::new(moduli(), &strength, ConeMatch::TriaxialCompression).unwrap();
    let edge = |s: f64| 6.0 / (3.0_f64.sqrt() * (3.0 - s));
    let (eta, eta_bar) = (
        edge(friction.sin()) * friction.sin(),
        edge(dilation.sin()) * dilation.sin(),
    );
    let xi = edge(friction.sin()) * friction.cos();
    let rates = Plasticity {
        yields: |s: &Vector3<f64>, _: f64| {
            let d = deviator(s);
            let root = (d.norm_squared() / 2.0).sqrt();
            let along = d / (2.0 * root.max(1e-300));
            let phi = root + eta * s.sum() / 3.0 - xi * cohesion;
            (phi, along.add_scalar(eta / 3.0), along.add_scalar(eta_bar / 3.0))
        },
        hardening: 0.0,
    };
    let pressure = Matrix3::from_diagonal_element(-5e4);
    let volume = start_volume(&pressure);
    let exact = rates.integrate(Vector3::repeat(volume.ln() / 3.0), 200_000);
    orders(&law, pressure, &exact, exact.norm());
}
