//! What a particle carries of its liquid as numbers.

use super::PoreLiquid;
use crate::record::Record;
use crate::scalar::Scalar;

impl<T: Scalar, const D: usize> Record<T> for PoreLiquid<T, D> {
    fn put(&self, out: &mut impl FnMut(T)) {
        self.velocity.put(out);
        out(self.pressure);
    }

    fn take(from: &mut impl FnMut() -> T) -> Option<Self> {
        Some(Self {
            velocity: Record::take(from)?,
            pressure: from(),
        })
    }
}
