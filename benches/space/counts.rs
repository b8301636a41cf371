//! Bytes and floating-point operations of a particle-step, by formula.

/// Of one particle and step.
#[derive(Clone, Copy)]
pub struct Counts {
    pub bytes: f64,
    pub flops: f64,
}

const NUMBER: usize = 8;
/// Functions along an axis.
const WIDTH: usize = 3;
/// Values and slopes of the three functions along one axis, from the position.
const FUNCTIONS: usize = 13;
/// Values alone.
const VALUES: usize = 9;

/// Of plain MPM in three passes, small strain.
///
/// *Bytes* are those of the particle arrays, each counted once for every pass that reads and once for every
/// pass that writes it; DOFs are shared by the particles of some rows of cells and stay in the cache.
///
/// *Operations* (a multiplication and an addition each count) are those of sums along one axis after the
/// other, the cheapest way known here: [`interpolation`]; a sum at the DOFs is the same the other way round.
pub fn plain<const D: usize>() -> Counts {
    let vector = NUMBER * D;
    let (tensor, cell) = (vector * D, 4 * D);
    let sum = vector + cell + 2 * NUMBER + tensor;
    let accelerate = vector + cell + NUMBER + 2 * vector;
    let advance = cell + 2 * (2 * vector + tensor);
    let (value, all) = (interpolation::<D>(0), interpolation::<D>(1));
    let slopes = all - 2 * WIDTH;
    let first = D * FUNCTIONS + value + D * D + D * slopes;
    let second = D * VALUES + 2 * D * value + 3 * D;
    let law = 4 * D * D + 2 * D;
    let third = D * FUNCTIONS + D * all + D * D + 4 * D + law;
    Counts {
        bytes: (sum + accelerate + advance) as f64,
        flops: (first + second + third) as f64,
    }
}

/// Operations of interpolating a scalar, and `slopes` times its slopes, from `W^D` DOFs: along axis `k` its
/// value and the slopes along the axes so far, for `W^(D - 1 - k)` rows.
fn interpolation<const D: usize>(slopes: usize) -> usize {
    let along = |k: usize| (1 + slopes * (k + 1)) * WIDTH.pow((D - 1 - k) as u32);
    2 * WIDTH * (0..D).map(along).sum::<usize>()
}
