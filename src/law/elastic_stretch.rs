//! Elastic stretch in principal axes: what Hencky's law and the plastic laws built on it share.

use nalgebra::{SMatrix, SVector, Vector3};

use super::Moduli;
use crate::scalar::Scalar;
use crate::tensor::{Spectral, is_plain, symmetric};

/// Newton steps for the volume that belongs to a stress; it takes about one per factor of e in the volume.
const NEWTON_STEPS: usize = 100;

/// Elastic left Cauchy-Green tensor `b_e = F_e F_e^T` in three dimensions, whatever the grid's; the default
/// is the identity.
///
/// Below 3-D the axes off the plane are principal and, if there are two of them, alike: one number holds
/// them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticStretch<T, const D: usize> {
    /// `b_e` in the grid's axes.
    pub b: SMatrix<T, D, D>,
    /// Squared elastic stretch along the axes that the grid does not have; 1 in 3-D.
    pub off_plane: T,
}

impl<T: Scalar, const D: usize> Default for ElasticStretch<T, D> {
    fn default() -> Self {
        Self {
            b: SMatrix::identity(),
            off_plane: T::one(),
        }
    }
}

impl<T: Scalar, const D: usize> ElasticStretch<T, D> {
    /// Elastic trial: the whole increment `dt grad v` stretches the material elastically.
    #[inline(always)]
    pub fn carry(&mut self, increment: &SMatrix<T, D, D>) {
        let f = SMatrix::identity() + increment;
        // Symmetric up to round-off, which must not pile up.
        self.b = symmetric(&(f * self.b * f.transpose()));
    }

    /// In principal axes.
    #[inline(always)]
    pub fn principal(&self) -> PrincipalStretch<T, D> {
        let spectral = Spectral::of(&self.b);
        let squared = in_space(&spectral.values, self.off_plane);
        PrincipalStretch {
            strain: squared.map(|b| b.ln() / T::lit(2.0)),
            // The divided difference of ln(b)/2, whose values are next to equal where anything is left.
            shear: between(|p, q| spectral.rest()[(p, q)] / (squared[p] + squared[q])),
            spectral,
        }
    }

    /// The stretch under the Cauchy stress `stress` (Pa), and `off_plane` along the other axes; see
    /// [`ConstitutiveLaw::start`](super::ConstitutiveLaw::start). `None` where Hencky's law knows no such
    /// stress.
    ///
    /// Kirchhoff's stress `J sigma` is linear in the logarithmic strain, which leaves one equation for the
    /// volume, `ln J = J tr(sigma) / (3 K)`. It has a solution up to the mean stress `K / e`.
    pub fn under_stress(moduli: &Moduli<T>, stress: &SMatrix<T, D, D>, off_plane: Option<T>) -> Option<Self> {
        let two = T::lit(2.0);
        let spectral = Spectral::of(&symmetric(stress));
        // Of no strain off the plane.
        let share = moduli.lambda / (T::count(D) * moduli.lambda + two * moduli.mu);
        let off_plane = off_plane.unwrap_or(share * stress.trace());
        let stress = in_space(&spectral.values, off_plane);
        let three = T::lit(3.0);
        let log_volume = log_volume(stress.sum() / (three * moduli.bulk()))?;
        let (volume, mean) = (log_volume.exp(), moduli.bulk() * log_volume);
        let strain = stress.map(|s| (volume * s - mean) / (two * moduli.mu) + log_volume / three);
        let shear = between(|p, q| spectral.rest()[(p, q)] * volume / (two * moduli.mu));
        let found = PrincipalStretch {
            spectral,
            strain,
            shear,
        }
        .stretch();
        let finite = found.b.iter().all(|b| b.is_finite()) && found.off_plane.is_finite();
        finite.then_some(found)
    }
}

/// Solves `x = s exp(x)` for the branch through zero. Newton's steps from zero never cross the root.
fn log_volume<T: Scalar>(s: T) -> Option<T> {
    let mut x = T::zero();
    for _ in 0..NEWTON_STEPS {
        let slope = T::one() - s * x.exp();
        let below_maximum = slope > T::zero();
        // Also refuses what is not a number.
        if !below_maximum {
            return None;
        }
        let change = (s * x.exp() - x) / slope;
        x += change;
        if change.abs() <= T::default_epsilon() * x.abs() {
            return Some(x);
        }
    }
    None
}

/// The values in the grid's principal axes, followed by those off the plane.
#[inline(always)]
fn in_space<T: Scalar, const D: usize>(values: &SVector<T, D>, off_plane: T) -> Vector3<T> {
    Vector3::from_fn(|i, _| if i < D { values[i] } else { off_plane })
}

/// Entries off the diagonal for each pair of axes; plain numbers have none.
#[inline(always)]
fn between<T: Scalar, const D: usize>(entry: impl Fn(usize, usize) -> T) -> SMatrix<T, D, D> {
    if is_plain::<T>() {
        return SMatrix::zeros();
    }
    SMatrix::from_fn(|p, q| if p == q { T::zero() } else { entry(p, q) })
}

/// Length of a vector; that of zero has no derivative, not one that is no number.
#[inline(always)]
pub fn length<T: Scalar>(vector: &Vector3<T>) -> T {
    if !is_plain::<T>() && vector.norm_squared() == T::zero() {
        return T::zero();
    }
    vector.norm()
}

/// An elastic stretch in its principal axes, where a plastic law of logarithmic strains returns it to its
/// yield surface. Perfect plasticity by von Mises' yield stress, for instance, scales the deviator:
///
/// ```
/// use materialpoint::law::{ElasticStretch, Moduli, deviator, length};
/// use nalgebra::{SMatrix, matrix};
///
/// /// Cauchy stress (Pa) after an increment, Mises' stress `sqrt(6) mu |dev e|` at most `strength` (Pa).
/// fn update(
///     moduli: &Moduli<f64>,
///     strength: f64,
///     increment: &SMatrix<f64, 2, 2>,
///     stretch: &mut ElasticStretch<f64, 2>,
/// ) -> SMatrix<f64, 2, 2> {
///     stretch.carry(increment);
///     let mut trial = stretch.principal();
///     let (shear, mean) = (deviator(&trial.strain), trial.strain.sum() / 3.0);
///     let mises = 6.0_f64.sqrt() * moduli.mu * length(&shear);
///     if mises > strength {
///         let share = strength / mises;
///         trial.strain = shear.map(|e| mean + share * e);
///         trial.scale_shear(share);
///         *stretch = trial.stretch();
///     }
///     trial.stress(moduli, trial.volume())
/// }
///
/// let moduli = Moduli::from_young(200e9, 0.3)?;
/// let mut stretch = ElasticStretch::default();
/// let stress = update(&moduli, 250e6, &matrix![0.0, 0.02; 0.0, 0.0], &mut stretch);
/// let shear = deviator(&stretch.principal().strain);
/// assert!((6.0_f64.sqrt() * moduli.mu * length(&shear) / 250e6 - 1.0).abs() < 1e-12);
/// assert!((stress[(0, 1)] / 250e6 * 3.0_f64.sqrt() - 1.0).abs() < 1e-2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct PrincipalStretch<T, const D: usize> {
    spectral: Spectral<T, D>,
    /// Elastic logarithmic strains, those in the grid's axes first.
    pub strain: Vector3<T>,
    /// Their shear in the principal axes, see [`Spectral::rest`].
    shear: SMatrix<T, D, D>,
}

impl<T: Scalar, const D: usize> PrincipalStretch<T, D> {
    /// The stretch with these principal strains.
    #[inline(always)]
    pub fn stretch(&self) -> ElasticStretch<T, D> {
        let squared = self.strain.map(|e| (e + e).exp());
        // The divided difference of exp(2 e) at values next to equal.
        let shear = |p: usize, q: usize| {
            let mean = (self.strain[p] + self.strain[q]).exp();
            (mean + mean) * self.shear[(p, q)]
        };
        ElasticStretch {
            b: self.in_plane(&squared, shear),
            off_plane: if const { D < 3 } { squared[2] } else { T::one() },
        }
    }

    /// Volume ratio of the elastic stretch.
    #[inline(always)]
    pub fn volume(&self) -> T {
        self.strain.sum().exp()
    }

    /// Cauchy stress (Pa) of material with the volume ratio `j`.
    #[inline(always)]
    pub fn stress(&self, moduli: &Moduli<T>, j: T) -> SMatrix<T, D, D> {
        let shear = |p: usize, q: usize| (moduli.mu + moduli.mu) * self.shear[(p, q)] / j;
        self.in_plane(&(kirchhoff(moduli, &self.strain) / j), shear)
    }

    /// Cauchy stress (Pa) along the axes that the grid does not have.
    pub fn off_plane_stress(&self, moduli: &Moduli<T>, j: T) -> T {
        kirchhoff(moduli, &self.strain)[2] / j
    }

    #[inline(always)]
    fn in_plane(&self, values: &Vector3<T>, shear: impl FnMut(usize, usize) -> T) -> SMatrix<T, D, D> {
        let values = SVector::from_fn(|i, _| values[i]);
        self.spectral.with_values_and_rest(&values, shear)
    }

    /// To be called where the deviator of [`PrincipalStretch::strain`] was scaled: scales its part off the
    /// diagonal, which only scalars with derivatives have.
    #[inline(always)]
    pub fn scale_shear(&mut self, factor: T) {
        if !is_plain::<T>() {
            self.shear *= factor;
        }
    }
}

/// PrincipalStretch Kirchhoff stresses (Pa) of principal logarithmic strains, `lambda tr(e) + 2 mu e`.
#[inline(always)]
fn kirchhoff<T: Scalar>(moduli: &Moduli<T>, strain: &Vector3<T>) -> Vector3<T> {
    let isotropic = moduli.lambda * strain.sum();
    strain.map(|e| isotropic + (moduli.mu + moduli.mu) * e)
}

/// Strain energy per reference volume (J/m3) of principal logarithmic strains.
pub fn stored_energy<T: Scalar>(moduli: &Moduli<T>, strain: &Vector3<T>) -> T {
    let trace = strain.sum();
    moduli.lambda * trace * trace / T::lit(2.0) + moduli.mu * strain.dot(strain)
}

/// `rho c^2` (Pa) of the fastest wave, from `J d sigma/dJ = (lambda + 2 mu)/J - sigma` along the most
/// compressed axis. The lowest principal stress is taken from Gershgorin: exact where it lies along an axis,
/// a bound elsewhere.
pub fn wave_modulus<T: Scalar, const D: usize>(moduli: &Moduli<T>, stress: &SMatrix<T, D, D>, j: T) -> T {
    let bound = |a: usize| {
        let row_sum = stress.row(a).iter().fold(T::zero(), |sum, s| sum + s.abs());
        stress[(a, a)] + stress[(a, a)].abs() - row_sum
    };
    let lowest = (1..D).fold(bound(0), |lowest, a| lowest.min(bound(a)));
    (moduli.p_wave() / j - lowest).max(T::zero())
}
