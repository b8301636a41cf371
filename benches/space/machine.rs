//! What the machine can do: bandwidth of memory and floating-point operations a second, of one thread,
//! measured.

use std::hint::black_box;
use std::time::Instant;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch, f64x4};

/// Numbers in each of the three arrays: 100 MB together, as much as a million particles take.
const NUMBERS: usize = 4_200_000;
/// Independent sums: enough to hide the latency of a fused multiply-add in both units.
const SUMS: usize = 12;
const REPEATS: usize = 7;

/// Bytes a second read and written by `a = b + 3 c` (24 bytes an element, as in STREAM's triad), the best of
/// several.
pub fn bandwidth() -> f64 {
    let (mut a, b, c) = (vec![0.0; NUMBERS], vec![1.0; NUMBERS], vec![2.0; NUMBERS]);
    let seconds = best(|| {
        for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
            *a = b + 3.0 * c;
        }
        black_box(&mut a);
    });
    24.0 * NUMBERS as f64 / seconds
}

/// Floating-point operations a second of fused multiply-adds on vectors of four, the best of several.
pub fn peak() -> f64 {
    let level = Level::new();
    let seconds = best(|| dispatch!(level, simd => multiply_and_add(simd)));
    (2 * 4 * SUMS * ROUNDS) as f64 / seconds
}

/// Rounds of as many operations as there are sums.
const ROUNDS: usize = 2_000_000;

#[inline(always)]
fn multiply_and_add<S: Simd>(simd: S) {
    let splat = |value: f64| black_box(f64x4::splat(simd, value));
    let (factor, term) = (splat(0.999), splat(1e-3));
    let mut sums = [f64x4::splat(simd, 1.0); SUMS];
    for _ in 0..ROUNDS {
        for sum in &mut sums {
            *sum = sum.mul_add(factor, term);
        }
    }
    black_box(&mut sums);
}

fn best(mut f: impl FnMut()) -> f64 {
    let times = (0..REPEATS).map(|_| {
        let begun = Instant::now();
        f();
        begun.elapsed().as_secs_f64()
    });
    times.fold(f64::INFINITY, f64::min)
}
