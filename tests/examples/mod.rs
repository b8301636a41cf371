//! Every example runs, and what it prints is right.

#[path = "../../examples/fit_field.rs"]
mod fit_field;
#[path = "../../examples/own_basis.rs"]
mod own_basis;
#[path = "../../examples/own_law.rs"]
mod own_law;
#[path = "../../examples/vibrating_bar.rs"]
mod vibrating_bar;

#[test]
fn the_bar_meets_the_exact_solution() {
    let error = vibrating_bar::run().unwrap();
    assert!((3e-3..5e-3).contains(&error), "{error:e}");
}

/// Static strain of the pulled bar: ln J = sigma/E = 0.01, so u/L = e^0.01 - 1 = 0.01005; a sudden load swings about it.
#[test]
fn the_pulled_bar_swings_about_its_static_strain() {
    let mean = own_law::run().unwrap();
    assert!((mean - 0.01005).abs() < 2e-4, "{mean}");
}

#[test]
fn the_own_basis_keeps_the_energy() {
    let highest = own_basis::run().unwrap();
    assert!((1.0..1.01).contains(&highest), "{highest}");
}

/// The papers' Figure: RMS 6.17e-3 at the 2 x 2 Gauss points.
#[test]
fn six_functions_fit_the_field() {
    let quality = fit_field::run().unwrap();
    assert!((quality.rms - 6.170989e-3).abs() < 5e-10, "{:e}", quality.rms);
    assert!(quality.integral < 1e-15, "{:e}", quality.integral);
}
