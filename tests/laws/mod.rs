//! Every constitutive law alone, without grid or step.
//!
//! A law is driven by displacement gradients through [`Specimen`]; what it must give comes from closed forms,
//! from other decompositions (nalgebra's), from finite differences of an energy, or from rate equations
//! integrated in many small steps.

mod conformance;
mod derivatives;
mod drucker_prager;
mod elastic;
mod fluid;
mod invariance;
mod off_plane;
mod rates;
mod spectral;
mod start;
mod strain_for;
mod strength;
mod von_mises;

use crate::examples::derivative::dual;
use materialpoint::law::{ConstitutiveLaw, Moduli};
use nalgebra::{Matrix3, SMatrix};

/// Elastic constants of most tests: E = 10 MPa, nu = 0.3.
fn moduli() -> Moduli<f64> {
    Moduli::from_young(1e7, 0.3).unwrap()
}

/// One piece of material, of volume 1 at the start.
struct Specimen<'a, const D: usize, L: ConstitutiveLaw<f64, D>> {
    law: &'a L,
    stress: SMatrix<f64, D, D>,
    state: L::State,
    volume: f64,
    work: f64,
}

// By hand: a derive would demand `L: Copy` although only a reference is held.
impl<const D: usize, L: ConstitutiveLaw<f64, D>> Clone for Specimen<'_, D, L> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<const D: usize, L: ConstitutiveLaw<f64, D>> Copy for Specimen<'_, D, L> {}

impl<'a, const D: usize, L: ConstitutiveLaw<f64, D>> Specimen<'a, D, L> {
    fn new(law: &'a L) -> Self {
        Self {
            law,
            stress: SMatrix::zeros(),
            state: L::State::default(),
            volume: 1.0,
            work: 0.0,
        }
    }

    /// Under a stress at the start.
    fn under(law: &'a L, stress: SMatrix<f64, D, D>, off_plane: Option<f64>) -> Option<Self> {
        let state = law.start(&stress, off_plane)?;
        Some(Self {
            stress,
            state,
            ..Self::new(law)
        })
    }

    /// One increment; work by the trapezoidal rule.
    fn update(&mut self, increment: &SMatrix<f64, D, D>) {
        let power = |m: &Self| m.stress.dot(increment) * m.volume / 2.0;
        self.work += power(self);
        self.law.update(increment, &mut self.stress, &mut self.state);
        if self.law.large_strain() {
            let f = SMatrix::<f64, D, D>::identity() + increment;
            self.volume *= materialpoint::tensor::determinant(&f);
        }
        self.work += power(self);
    }

    /// Stretched along the axes by the logarithmic strains `strain` in `steps` steps.
    fn stretch(&mut self, strain: [f64; D], steps: u32) {
        let mut increment = SMatrix::zeros();
        for a in 0..D {
            increment[(a, a)] = (strain[a] / f64::from(steps)).exp_m1();
        }
        (0..steps).for_each(|_| self.update(&increment));
    }

    /// Sheared to `dx/dy = shear` in `steps` steps.
    fn shear(&mut self, shear: f64, steps: u32) {
        let mut increment = SMatrix::zeros();
        increment[(0, 1)] = shear / f64::from(steps);
        (0..steps).for_each(|_| self.update(&increment));
    }

    /// Strain energy.
    fn energy(&self) -> f64 {
        self.law.energy_density(&self.stress, &self.state) * self.volume
    }

    /// Kirchhoff's stress.
    fn kirchhoff(&self) -> SMatrix<f64, D, D> {
        self.stress * self.volume
    }
}

/// A matrix of numbers in [-1, 1) that look random, the same for each `seed`.
fn random<const D: usize>(seed: u32) -> SMatrix<f64, D, D> {
    let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(12_345);
    SMatrix::from_fn(|_, _| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 23) - 1.0
    })
}

/// Deformation gradients of positive determinant, stretches of 0.5 to 2 or so.
fn gradients<const D: usize>() -> impl Iterator<Item = SMatrix<f64, D, D>> {
    (0..40)
        .map(|seed| SMatrix::identity() + random(seed) * 0.45)
        .filter(|f| materialpoint::tensor::determinant(f) > 0.2)
}

/// Logarithmic strain `ln(F F^T) / 2` by nalgebra's decomposition, in three dimensions.
fn log_strain(f: &Matrix3<f64>) -> Matrix3<f64> {
    let eigen = (f * f.transpose()).symmetric_eigen();
    let logs = Matrix3::from_diagonal(&eigen.eigenvalues.map(|b| b.ln() / 2.0));
    eigen.eigenvectors * logs * eigen.eigenvectors.transpose()
}

/// `f` in the first axes of space.
fn in_space<const D: usize>(f: &SMatrix<f64, D, D>) -> Matrix3<f64> {
    let mut space = Matrix3::identity();
    for i in 0..D {
        for j in 0..D {
            space[(i, j)] = f[(i, j)];
        }
    }
    space
}

/// Cases of the property tests.
fn config() -> proptest::test_runner::Config {
    proptest::test_runner::Config {
        cases: 64,
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(2019),
        ..proptest::test_runner::Config::default()
    }
}
