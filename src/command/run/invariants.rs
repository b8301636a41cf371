//! Mean and von Mises stress of all three axes.

use nalgebra::SMatrix;

/// Mean stress and von Mises stress (both Pa).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Invariants {
    /// A third of the trace in space, tension positive: minus the pressure.
    pub mean: f64,
    /// `sqrt(3/2 s : s)` of the deviator `s` in space.
    pub von_mises: f64,
}

impl Invariants {
    /// Of a stress (Pa) in `D` axes with `off_plane` (Pa) along each of the others; in space that is not
    /// looked at.
    pub fn of<const D: usize>(stress: &SMatrix<f64, D, D>, off_plane: f64) -> Self {
        let others = 3_usize.saturating_sub(D) as f64;
        let off_plane = if D < 3 { off_plane } else { 0.0 };
        let mean = (stress.trace() + others * off_plane) / 3.0;
        let deviator = stress - SMatrix::from_diagonal_element(mean);
        let squares = deviator.norm_squared() + others * (off_plane - mean).powi(2);
        Self {
            mean,
            von_mises: (1.5 * squares).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, matrix};

    #[test]
    fn the_third_axis_counts() {
        // Water at rest has its pressure and no shear.
        let water = Invariants::of(&matrix![-7.0, 0.0; 0.0, -7.0], -7.0);
        assert_eq!((water.mean, water.von_mises), (-7.0, 0.0));
        // A column that cannot widen, nu = 0.3: lateral stresses 3/7 of the vertical one.
        let lateral = -3.0 / 7.0;
        let column = Invariants::of(&matrix![lateral, 0.0; 0.0, -1.0], lateral);
        assert!((column.mean - (2.0 * lateral - 1.0) / 3.0).abs() < 1e-15);
        assert!((column.von_mises - 4.0 / 7.0).abs() < 1e-15);
        // Simple shear: sqrt(3) times it.
        let mut shear = Matrix3::zeros();
        (shear[(0, 2)], shear[(2, 0)]) = (2.0, 2.0);
        assert!((Invariants::of(&shear, f64::NAN).von_mises - 12.0_f64.sqrt()).abs() < 1e-15);
    }
}
