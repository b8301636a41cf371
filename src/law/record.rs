//! The histories of the laws as numbers.

use super::{DeformationGradient, DruckerPragerState, ElasticStretch, VolumeRatio, VonMisesState};
use crate::record::Record;
use crate::scalar::Scalar;
use nalgebra::SMatrix;

impl<T: Scalar, const D: usize> Record<T> for DeformationGradient<T, D> {
    fn put(&self, out: &mut impl FnMut(T)) {
        self.0.put(out);
    }

    fn take(from: &mut impl FnMut() -> T) -> Option<Self> {
        SMatrix::take(from).map(Self)
    }
}

impl<T: Scalar> Record<T> for VolumeRatio<T> {
    fn put(&self, out: &mut impl FnMut(T)) {
        out(self.0);
    }

    fn take(from: &mut impl FnMut() -> T) -> Option<Self> {
        Some(Self(from()))
    }
}

impl<T: Scalar, const D: usize> Record<T> for ElasticStretch<T, D> {
    fn put(&self, out: &mut impl FnMut(T)) {
        self.b.put(out);
        out(self.off_plane);
    }

    fn take(from: &mut impl FnMut() -> T) -> Option<Self> {
        Some(Self {
            b: Record::take(from)?,
            off_plane: from(),
        })
    }
}

impl<T: Scalar, const D: usize> Record<T> for VonMisesState<T, D> {
    fn put(&self, out: &mut impl FnMut(T)) {
        self.stretch.put(out);
        out(self.plastic_strain);
    }

    fn take(from: &mut impl FnMut() -> T) -> Option<Self> {
        Some(Self {
            stretch: Record::take(from)?,
            plastic_strain: from(),
        })
    }
}

impl<T: Scalar, const D: usize> Record<T> for DruckerPragerState<T, D> {
    fn put(&self, out: &mut impl FnMut(T)) {
        self.stretch.put(out);
        [self.volume, self.plastic_strain, self.gap].put(out);
    }

    fn take(from: &mut impl FnMut() -> T) -> Option<Self> {
        Some(Self {
            stretch: Record::take(from)?,
            volume: from(),
            plastic_strain: from(),
            gap: from(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers that all differ come back at their places, and none is left.
    fn comes_back<S: Record<f64> + PartialEq + std::fmt::Debug>(count: usize) {
        let numbers: Vec<f64> = (0..count).map(|k| (k as f64 + 0.1).sqrt()).collect();
        let mut given = numbers.iter().copied();
        let state = S::take(&mut || given.next().unwrap()).unwrap();
        assert_eq!(given.next(), None);
        let mut told = Vec::new();
        state.put(&mut |x| told.push(x));
        assert_eq!(told, numbers);
    }

    #[test]
    fn every_history_comes_back_with_each_number_at_its_place() {
        comes_back::<()>(0);
        comes_back::<f64>(1);
        comes_back::<[f64; 4]>(4);
        comes_back::<VolumeRatio<f64>>(1);
        comes_back::<DeformationGradient<f64, 3>>(9);
        comes_back::<ElasticStretch<f64, 2>>(5);
        comes_back::<VonMisesState<f64, 2>>(6);
        comes_back::<DruckerPragerState<f64, 3>>(13);
        comes_back::<crate::phase::PoreLiquid<f64, 3>>(4);
    }
}
