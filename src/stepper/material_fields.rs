//! What the law knows of the particles besides their stress.

use super::Stepper;
use crate::basis::BasisFamily;
use crate::law::LawSweep;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::transfer::Transfer;

/// What the law knows of each particle besides its stress, in the order in which the particles were given; an
/// array is empty where the law does not know it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialFields {
    /// Stress (Pa) along the axes that the grid does not have; see
    /// [`crate::law::ConstitutiveLaw::off_plane_stress`].
    pub off_plane_stress: Vec<f64>,
    /// Accumulated plastic strain; see [`crate::law::ConstitutiveLaw::plastic_strain`].
    pub plastic_strain: Vec<f64>,
}

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// What the law knows of the particles besides their stress.
    pub fn material_fields(&self) -> MaterialFields {
        let (law, particles) = (&self.law, &self.particles);
        MaterialFields {
            off_plane_stress: self
                .in_first_order(|p| law.off_plane_stress(&particles.stress[p], law.of(&particles.state, p))),
            plastic_strain: self.in_first_order(|p| law.plastic_strain(law.of(&particles.state, p))),
        }
    }

    /// The values of all particles, in the order in which they were given; none if one of them has none.
    fn in_first_order(&self, value: impl Fn(usize) -> Option<T>) -> Vec<f64> {
        let count = self.particles.len();
        // A law that does not know the first one knows none: most arrays are never made.
        if count == 0 || value(0).is_none() {
            return Vec::new();
        }
        let mut values = vec![f64::NAN; count];
        for p in 0..count {
            let Some(value) = value(p) else {
                return Vec::new();
            };
            if let Some(place) = values.get_mut(self.order.number(p)) {
                *place = value.primal();
            }
        }
        values
    }
}
