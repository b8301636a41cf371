//! Single precision: the same scheme, seven digits.
//!
//! The large bar's errors are those of the scheme, so f32 must show them too (within 3 %), and conservation
//! holds to the round-off of f32 over 160 particles and 1000 steps. That f32 was used at all shows in the
//! conservation errors, which are far above those of f64.

use super::*;

#[test]
fn single_precision_has_the_errors_of_the_scheme_and_its_own_round_off() {
    for method in Method::ALL {
        let [double, single] = ["f64", "f32"].map(|scalar| {
            summary(
                "vibrating-bar-large",
                method,
                &[&format!("method.scalar={scalar}")],
            )
        });
        let [a, b] = [&double, &single].map(|run| run.errors["stress"].relative_l2);
        assert_close(&format!("{method}"), b, a, 0.03);
        if method.reconstruction != SPLINE {
            let [a, b] = [&double, &single].map(|run| run.conservation["solid"].momentum_scaled);
            assert!(a < 1e-14 && b < 1e-5 && b > 1e-9, "{method}: {a:e} {b:e}");
        }
        // Of so many particles that the stepper's own few kilobytes do not count.
        let [double, single] = ["f64", "f32"].map(|scalar| {
            let scalar = format!("method.scalar={scalar}");
            let sets = ["grid.cells=[1000]", "time.step=1e-6", "time.end=1e-6", &scalar];
            summary("vibrating-bar-large", method, &sets).bytes_per_particle
        });
        assert!(single < 0.62 * double, "{method}: {single} {double}");
    }
}
