//! Drucker and Prager's cone, its match to Mohr and Coulomb's pyramid, and the return to it.

use nalgebra::Vector3;

use super::super::Moduli;
use super::super::constant::{not_negative, require};
use super::super::elastic_stretch::length;
use super::super::von_mises::deviator;
use crate::error::SetupError;
use crate::scalar::Scalar;

/// Mohr-Coulomb constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength<T> {
    /// Cohesion (Pa); 0 for sand, which then separates.
    pub cohesion: T,
    /// Friction angle (rad).
    pub friction_angle: T,
    /// Dilation angle (rad); the flow is associated where it equals the friction angle.
    pub dilation_angle: T,
}

/// Which Drucker-Prager cone stands for Mohr and Coulomb's pyramid. No cone meets it everywhere.
///
/// With `s` the sine of the friction angle (de Souza Neto, Perić & Owen 2008, section 6.4.4):
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConeMatch {
    /// The strength of plane strain at collapse. For associated flow `eta = 3 s / sqrt(9 + 3 s^2)` (Drucker &
    /// Prager 1952); otherwise the cone depends on the dilation too, which decides the stress along the axis
    /// that is not strained. The dilation angle is that of plane strain, `sin(psi) = tr(d) / |d_1 - d_2|`.
    PlaneStrain,
    /// The outer edges, triaxial compression: circumscribed, `eta = 6 s / (sqrt(3) (3 - s))`.
    TriaxialCompression,
    /// The inner edges, triaxial extension: `eta = 6 s / (sqrt(3) (3 + s))`.
    TriaxialExtension,
}

/// Constants of the cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cone<T> {
    /// `eta`.
    friction: T,
    /// `eta` of the plastic potential.
    dilation: T,
    /// `xi c` (Pa).
    cohesion: T,
}

/// How a trial strain was returned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Yield {
    Elastic,
    Cone,
    Apex,
}

impl Yield {
    pub(super) fn is_plastic(self) -> bool {
        self != Self::Elastic
    }

    pub(super) fn is_at_apex(self) -> bool {
        self == Self::Apex
    }
}

/// `eta` and `xi` of a friction angle with the given sine and cosine, `eta` of the dilation.
fn constants<T: Scalar>(strength: &Strength<T>, matching: ConeMatch) -> [T; 3] {
    let (sine, cosine) = strength.friction_angle.sin_cos();
    let dilation = strength.dilation_angle.sin();
    let three = T::lit(3.0);
    // 6 s / (sqrt(3) (3 -+ s)), per s.
    let edge = |s: T| T::lit(6.0) / (three.sqrt() * (three + s));
    let [per_sine, per_dilation] = match matching {
        ConeMatch::TriaxialCompression => [edge(-sine), edge(-dilation)],
        ConeMatch::TriaxialExtension => [edge(sine), edge(dilation)],
        ConeMatch::PlaneStrain => {
            // No flow along the third axis: s_3 = -2/3 eta_bar sqrt(J2), which leaves k sqrt(J2) for the
            // radius of Mohr's circle.
            let k = (three / (three + dilation * dilation)).sqrt();
            [three / (k * (three + sine * dilation)), k]
        }
    };
    [per_sine * sine, per_sine * cosine, per_dilation * dilation]
}

impl<T: Scalar> Cone<T> {
    pub(super) fn new(strength: &Strength<T>, matching: ConeMatch) -> Result<Self, SetupError> {
        let Strength {
            cohesion,
            friction_angle,
            dilation_angle,
        } = *strength;
        not_negative("cohesion", cohesion)?;
        let right_angle = T::frac_pi_2();
        let inside = friction_angle >= T::zero() && friction_angle < right_angle;
        require(
            "friction_angle",
            friction_angle,
            inside,
            "it must lie within [0, pi/2)",
        )?;
        let inside = dilation_angle >= T::zero() && dilation_angle <= friction_angle;
        let allowed = "it must lie between 0 and the friction angle";
        require("dilation_angle", dilation_angle, inside, allowed)?;
        let [friction, per_cohesion, dilation] = constants(strength, matching);
        Ok(Self {
            friction,
            dilation,
            cohesion: per_cohesion * cohesion,
        })
    }

    /// Whether the apex is free of stress.
    #[inline(always)]
    pub(super) fn separates(&self) -> bool {
        self.cohesion.is_zero()
    }

    /// `Phi` (Pa) at principal elastic strains.
    pub(super) fn yield_function(&self, moduli: &Moduli<T>, strain: &Vector3<T>) -> T {
        let shear = shear_stress(moduli, &deviator(strain));
        shear + self.friction * moduli.bulk() * strain.sum() - self.cohesion
    }

    /// Returns principal trial strains to the cone or its apex; also says by what their deviator was scaled.
    #[inline(always)]
    pub(super) fn return_to(&self, moduli: &Moduli<T>, strain: &mut Vector3<T>) -> (Yield, T) {
        let (three, bulk) = (T::lit(3.0), moduli.bulk());
        let deviator = deviator(strain);
        let (shear, volume) = (shear_stress(moduli, &deviator), strain.sum());
        let excess = shear + self.friction * bulk * volume - self.cohesion;
        let yields = excess > T::zero();
        // Also leaves alone what is not a number.
        if !yields {
            return (Yield::Elastic, T::one());
        }
        let flow = excess / (moduli.mu + bulk * self.friction * self.dilation);
        let rest = shear - moduli.mu * flow;
        if rest > T::zero() || self.friction.is_zero() {
            let mean = (volume - self.dilation * flow) / three;
            let scale = (rest / shear).max(T::zero());
            *strain = deviator.map(|e| e * scale + mean);
            return (Yield::Cone, scale);
        }
        let mean = self.cohesion / (self.friction * bulk * three);
        *strain = Vector3::repeat(mean);
        (Yield::Apex, T::zero())
    }
}

/// `sqrt(s : s / 2)` (Pa) of a deviatoric strain, `s = 2 mu e`.
#[inline(always)]
fn shear_stress<T: Scalar>(moduli: &Moduli<T>, deviator: &Vector3<T>) -> T {
    T::lit(2.0).sqrt() * moduli.mu * length(deviator)
}
