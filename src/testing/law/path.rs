//! Material driven along a path of displacement gradients.

use nalgebra::SMatrix;

use super::LawSample;
use crate::law::ConstitutiveLaw;
use crate::scalar::Scalar;
use crate::tensor::{determinant, symmetric};

/// One particle of material, of volume 1 when undeformed.
pub(super) struct Material<'a, T, const D: usize, L, S> {
    law: &'a L,
    pub(super) stress: SMatrix<T, D, D>,
    pub(super) state: S,
    pub(super) volume: T,
    /// Work of the stress so far.
    pub(super) work: T,
}

// By hand: a derive would demand `L: Copy` although only a reference is held.
impl<T: Scalar, const D: usize, L, S: Copy> Clone for Material<'_, T, D, L, S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Scalar, const D: usize, L, S: Copy> Copy for Material<'_, T, D, L, S> {}

impl<'a, T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>> Material<'a, T, D, L, L::State> {
    /// Undeformed.
    pub(super) fn new(law: &'a L) -> Self {
        Self {
            law,
            stress: SMatrix::zeros(),
            state: L::State::default(),
            volume: T::one(),
            work: T::zero(),
        }
    }

    /// Strained by `sample.strain` along axis 0, in a hundred increments.
    pub(super) fn stretched(law: &'a L, strain: T) -> Self {
        let mut material = Self::new(law);
        material.follow(&(along::<T, D>(0) * strain), 100);
        material
    }

    /// One increment, work by the trapezoidal rule.
    pub(super) fn update(&mut self, increment: &SMatrix<T, D, D>) {
        self.update_over(None, increment);
    }

    /// One increment over a time (s), or without one.
    fn update_over(&mut self, dt: Option<T>, increment: &SMatrix<T, D, D>) {
        let strain = symmetric(increment);
        let power = |m: &Self| m.stress.dot(&strain) * m.volume / T::lit(2.0);
        self.work += power(self);
        match dt {
            Some(dt) => self
                .law
                .update_over(dt, increment, &mut self.stress, &mut self.state),
            None => self.law.update(increment, &mut self.stress, &mut self.state),
        }
        if self.law.large_strain() {
            self.volume *= determinant(&(SMatrix::identity() + increment));
        }
        self.work += power(self);
    }

    /// `total` in `steps` equal increments.
    pub(super) fn follow(&mut self, total: &SMatrix<T, D, D>, steps: usize) {
        self.follow_over(None, total, steps);
    }

    /// The same, each of them over a time (s), or without one.
    pub(super) fn follow_over(&mut self, dt: Option<T>, total: &SMatrix<T, D, D>, steps: usize) {
        let increment = total / T::count(steps);
        for _ in 0..steps {
            self.update_over(dt, &increment);
        }
    }

    /// Strain energy of the particle.
    pub(super) fn energy(&self) -> T {
        self.law.energy_density(&self.stress, &self.state) * self.volume
    }

    /// `density * wave_speed^2`.
    pub(super) fn wave_modulus(&self, sample: &LawSample<T>) -> T {
        let density = sample.density / self.volume;
        let speed = self.law.wave_speed(density, &self.stress, &self.state);
        density * speed * speed
    }
}

/// Modulus that makes stresses dimensionless: `density * wave_speed^2` at rest.
pub(super) fn modulus<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
) -> T {
    Material::new(law).wave_modulus(sample)
}

/// Uniaxial strain of size 1.
pub(super) fn along<T: Scalar, const D: usize>(axis: usize) -> SMatrix<T, D, D> {
    let mut gradient = SMatrix::zeros();
    gradient[(axis, axis)] = T::one();
    gradient
}

/// Displacement gradients of size 1: along each axis, each shear, and all mixed.
pub(super) fn directions<T: Scalar, const D: usize>() -> Vec<SMatrix<T, D, D>> {
    let single = (0..D * D).map(|k| {
        let mut gradient = SMatrix::zeros();
        gradient[k] = T::one();
        gradient
    });
    let mixed = SMatrix::from_fn(|i, j| T::lit(((3 * i + 5 * j + 2) % 7) as f64 - 3.0) / T::lit(4.0));
    single.chain([mixed]).collect()
}
