use super::vector::{Doubles, ManySingles, Singles, processor};
use super::*;
use crate::scalar::Scalar;

fn check<T: Scalar, K: Packs<T>>(k: K) {
    let numbers = [0.5, -2.0, 3.0, 4.0].map(T::lit);
    let halves_and_doubles = k.one_by_one(k.pack(numbers), |x| [[x / T::lit(2.0)], [x + x]]);
    let [[half], [double]] = halves_and_doubles;
    assert_eq!(k.array(half + half), numbers);
    assert_eq!(k.array(double)[3], T::lit(8.0));
    let (a, two) = (k.pack(numbers), k.splat(T::lit(2.0)));
    assert_eq!(k.array(a), numbers);
    assert_eq!(
        k.array(a.mul_add(two, a - two)),
        [-0.5, -8.0, 7.0, 10.0].map(T::lit)
    );
    assert_eq!(
        k.array((a / two).above(k.splat(T::zero()))),
        [1.0, 0.0, 1.0, 1.0].map(T::lit)
    );
    let between = |low: f64, high: f64| k.are_between(a, k.splat(T::lit(low)), k.splat(T::lit(high)));
    assert!(between(-2.5, 4.5) && !between(-2.0, 4.5) && !between(-2.5, 4.0));
    let none = k.splat(T::zero() / T::zero());
    assert!(!k.are_between(none, a - two, a) && !k.are_between(a, none, two));
    assert_eq!(k.array((a.abs() * two).sqrt())[1], T::lit(2.0));
    assert_eq!(
        k.sums([a, two, a + two, a * two]),
        [5.5, 8.0, 13.5, 11.0].map(T::lit)
    );
}

#[test]
fn all_packs_do_the_same() {
    check::<f64, _>(Plain);
    check::<f32, _>(Plain);
    if let Some(simd) = processor() {
        check::<f64, _>(Doubles(simd));
        check::<f32, _>(Singles(simd));
    }
}

#[test]
fn eight_lanes_do_what_four_do() {
    let Some(simd) = processor() else { return };
    let k = ManySingles(simd);
    let numbers = [0.5, -2.0, 3.0, 4.0, 5.0, -1.5, 0.25, 8.0_f32];
    let a = Packs::<f32, 8>::pack(k, numbers);
    assert_eq!(Packs::<f32, 8>::array(k, a), numbers);
    let one = Lanes::<f32>::splat(k, 1.0);
    assert_eq!(
        Packs::<f32, 8>::sums(k, [a, one, a + one, a * one]),
        [17.25, 8.0, 25.25, 17.25]
    );
}

/// What a run is given is computed with packs of the processor where it has them, and with plain ones
/// elsewhere.
#[test]
fn a_sweep_gets_the_packs_of_its_scalar() {
    fn sum<T: Scalar>(values: [T; 4]) -> T {
        dispatch!(T, |k| {
            let pack = k.pack(values);
            k.sums([pack, pack, pack, pack])[3]
        })
    }
    assert_eq!(sum([1.0, 2.0, 3.0, 4.0]), 10.0);
    assert_eq!(sum([1.0_f32, 2.0, 3.0, 4.0]), 10.0);
    assert_eq!(with_features(|| 3), 3);
}
