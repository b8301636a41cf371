//! How velocities reach the grid and come back: the trait, and FLIP.

use nalgebra::{SMatrix, SVector};

use crate::scalar::Scalar;

/// How the velocities of particles reach the DOFs and come back.
///
/// [`Flip`] is what the papers of Taylor least squares take: accelerations alone go to the particles, and
/// their new momenta to the DOFs. Transfers [from the grid](Transfer::FROM_GRID), PIC, APIC and their kin,
/// map the momenta first, accelerate the DOFs, and give the particles the velocities that these have then;
/// the same velocities move and strain the particles. They need DOF masses that are sums over the particles,
/// since what a fit of the density changed would be missing when the particles take their velocities back:
/// so [`Shepard`](crate::reconstruction::Shepard), [`SubPoints`](crate::reconstruction::SubPoints) or a
/// reconstruction of your own with
/// [`ParticleMass`](crate::mass::ParticleMass); one phase, and
/// walls that hold or let go but do not rub. Anything else is refused with an error when the stepper is made,
/// or the step taken.
///
/// `examples/apic.rs` has PIC and APIC.
pub trait Transfer<T: Scalar, const D: usize>: Clone + Send + Sync {
    /// Whether particles take their velocities from the DOFs ([`Transfer::take`]).
    const FROM_GRID: bool;

    /// Whether a particle's velocity is a linear function of place ([`Transfer::gradient`]). Only with
    /// [`Transfer::FROM_GRID`].
    const AFFINE: bool = false;

    /// What a particle remembers besides its velocity; `()` takes no memory.
    type Particle: Copy + Default + Send + Sync;

    /// Gradient (1/s) of the velocity that a particle shows the DOFs: it gives a DOF at `x_i` the momentum
    /// `m phi_i (v + G (x_i - x))`, component by axis. Only asked where [`Transfer::AFFINE`].
    fn gradient(&self, _particle: &Self::Particle) -> SMatrix<T, D, D> {
        const { assert!(!Self::AFFINE, "AFFINE wants an own `gradient`") };
        SMatrix::zeros()
    }

    /// Takes what a particle sees of the grid, after the accelerations of the step, into its velocity (m/s)
    /// and what it remembers. Only asked where [`Transfer::FROM_GRID`].
    fn take(
        &self,
        _seen: &GridVelocity<T, D>,
        _velocity: &mut SVector<T, D>,
        _particle: &mut Self::Particle,
    ) {
        const { assert!(!Self::FROM_GRID, "FROM_GRID wants an own `take`") };
    }
}

/// What constants of a transfer ask of each other; evaluated where a stepper is made.
pub(crate) const fn constants_agree<T: Scalar, const D: usize, X: Transfer<T, D>>() {
    assert!(X::FROM_GRID || !X::AFFINE, "AFFINE wants FROM_GRID");
}

/// Accelerations to the particles, then their momenta to the DOFs again: FLIP (Brackbill & Ruppel 1986) with
/// modified update stress last (Sulsky, Zhou & Schreyer 1995).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Flip;

impl<T: Scalar, const D: usize> Transfer<T, D> for Flip {
    const FROM_GRID: bool = false;
    type Particle = ();
}

/// What a particle sees of the velocities `v_i` of the DOFs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GridVelocity<T, const D: usize> {
    /// Length of the kick (s) that the DOFs had.
    pub dt: T,
    /// `sum_i phi_i v_i` (m/s).
    pub velocity: SVector<T, D>,
    /// `sum_i phi_i a_i` (m/s2): what the kick changed of it, walls included, over `dt`.
    pub acceleration: SVector<T, D>,
    /// `sum_i v_i grad phi_i` (1/s), component by axis.
    pub gradient: SMatrix<T, D, D>,
    /// `sum_i phi_i v_i (x_i - x)` (m2/s), component by axis: the particle's first moment, with the places
    /// `x_i` of the DOFs, about which linear functions are reproduced: nodes, or the Greville abscissae of
    /// splines.
    pub moment: SMatrix<T, D, D>,
    /// `sum_i phi_i (x_i - x)_a^2` (m2) along each axis `a`. Mixed second moments vanish for products of
    /// functions that reproduce linear ones.
    pub second_moment: SVector<T, D>,
    /// Size of a cell along each axis (m).
    pub cell_size: SVector<T, D>,
}

/// Share of a cell's size squared below which a second moment counts as nothing.
const NO_SPREAD: f64 = 1e-6;

impl<T: Scalar, const D: usize> GridVelocity<T, D> {
    /// Of no DOF yet.
    pub(crate) fn none(dt: T, cell_size: SVector<T, D>) -> Self {
        Self {
            dt,
            velocity: SVector::zeros(),
            acceleration: SVector::zeros(),
            gradient: SMatrix::zeros(),
            moment: SMatrix::zeros(),
            second_moment: SVector::zeros(),
            cell_size,
        }
    }

    /// Adds what is seen of a DOF with a velocity and an acceleration, `offset` (m) away from the particle.
    pub(crate) fn see(
        &mut self,
        phi: T,
        gradient: &SVector<T, D>,
        offset: &SVector<T, D>,
        (velocity, acceleration): (&SVector<T, D>, &SVector<T, D>),
    ) {
        self.velocity += velocity * phi;
        self.acceleration += acceleration * phi;
        self.gradient += velocity * gradient.transpose();
        self.moment += velocity * (offset * phi).transpose();
        self.second_moment += offset.component_mul(offset) * phi;
    }

    /// The linear velocity nearest to those of the DOFs (1/s): [`GridVelocity::moment`] over
    /// [`GridVelocity::second_moment`]. Where a particle lies on the only DOF that it sees along an axis,
    /// both vanish, and their limit is [`GridVelocity::gradient`]: for linear functions they are the same
    /// everywhere.
    pub fn affine(&self) -> SMatrix<T, D, D> {
        SMatrix::from_fn(|c, a| {
            let size = self.cell_size[a];
            let spread = self.second_moment[a];
            match spread > size * size * T::lit(NO_SPREAD) {
                true => self.moment[(c, a)] / spread,
                false => self.gradient[(c, a)],
            }
        })
    }
}
