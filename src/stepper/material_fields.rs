//! What the law knows of the particles besides their stress.

use super::Stepper;
use super::order::Order;
use crate::basis::BasisFamily;
use crate::law::LawSweep;
use crate::particles::Particles;
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
        known_to(&self.inner.law, &self.inner.particles, &self.inner.order)
    }
}

#[inline(never)]
fn known_to<T: Scalar, const D: usize, L: LawSweep<T, D>, Q>(
    law: &L,
    particles: &Particles<T, D, L::Number, Q>,
    order: &Order,
) -> MaterialFields {
    let count = particles.position.len();
    MaterialFields {
        off_plane_stress: in_first_order(count, order, &|p| {
            law.off_plane_stress(&particles.stress[p], law.of(&particles.state, p))
        }),
        plastic_strain: in_first_order(count, order, &|p| law.plastic_strain(law.of(&particles.state, p))),
    }
}

/// The values of all particles, in the order in which they were given; none if one of them has none.
fn in_first_order<T: Scalar>(count: usize, order: &Order, value: &dyn Fn(usize) -> Option<T>) -> Vec<f64> {
    // A law that does not know the first one knows none: most arrays are never made.
    if count == 0 || value(0).is_none() {
        return Vec::new();
    }
    let mut values = vec![f64::NAN; count];
    for p in 0..count {
        let Some(value) = value(p) else {
            return Vec::new();
        };
        if let Some(place) = values.get_mut(order.number(p)) {
            *place = value.primal();
        }
    }
    values
}
