//! What the converged solution refuses.

use super::super::super::{Hill, Linear};
use super::*;

const HILL: Hill = Hill { youngs_modulus: 4e4 };

fn problem() -> BarProblem<Hill> {
    BarProblem::new(1.0, 2e3, HILL)
}

fn error<L: UniaxialLaw>(problem: BarProblem<L>, elements: usize, degree: usize) -> Option<ReferenceError> {
    LagrangianBar::new(problem, Resolution { elements, degree }).err()
}

#[test]
fn bad_parameters() {
    assert_eq!(error(problem(), 4, 4), None);
    for (elements, degree) in [(0, 4), (2_000_000, 4), (4, 0), (4, 33)] {
        assert!(matches!(
            error(problem(), elements, degree),
            Some(ReferenceError::OutOfRange { .. })
        ));
    }
    assert!(error(BarProblem::new(-1.0, 2e3, HILL), 4, 4).is_some());
    assert!(error(BarProblem::new(1.0, f64::NAN, HILL), 4, 4).is_some());
    assert!(error(problem().origin(f64::INFINITY), 4, 4).is_some());
    assert!(error(problem().initial_velocity(|x| 1.0 / (x - x)), 4, 4).is_some());
    assert!(error(problem().body_force(|t| t, &[f64::NAN]), 4, 4).is_some());
    let soft = Linear { youngs_modulus: 0.0 };
    assert!(matches!(
        error(BarProblem::new(1.0, 2e3, soft), 4, 4),
        Some(ReferenceError::NotHyperbolic { .. })
    ));
    assert!(LagrangianBar::column(50.0, 1.0, -200.0, 0.0, HILL).is_err());
    assert!(LagrangianBar::vibrating_bar(1.0, 2e3, f64::NAN, HILL).is_err());
}

#[test]
fn bad_times() {
    let mut bar = LagrangianBar::vibrating_bar(1.0, 2e3, 0.8, HILL).unwrap();
    for time in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            bar.advance(time),
            Err(ReferenceError::InvalidTime { .. })
        ));
    }
}

#[test]
fn estimate_without_coarser_mesh() {
    let mut bar = LagrangianBar::new(
        problem(),
        Resolution {
            elements: 1,
            degree: 4,
        },
    )
    .unwrap();
    assert!(matches!(
        bar.error_estimate(0.1),
        Err(ReferenceError::OutOfRange { value: 0, .. })
    ));
}

/// The linear law lets a fast enough bar be pressed through itself: strains reach v0 / c.
#[test]
fn material_turned_inside_out() {
    let law = Linear { youngs_modulus: 4e4 };
    let mut bar = LagrangianBar::vibrating_bar(1.0, 2e3, 10.0, law).unwrap();
    let result = bar.advance(0.1);
    assert!(
        matches!(result, Err(ReferenceError::InvalidStretch { time, stretch, .. }) if time < 0.1 && stretch <= 0.0),
        "{result:?}"
    );
    assert!(bar.at(0.5).stress.is_finite());
}

#[test]
fn body_force_that_is_no_number() {
    let force = |t: f64| if t > 0.05 { f64::NAN } else { 1.0 };
    let mut bar = LagrangianBar::new(
        problem().body_force(force, &[]),
        Resolution {
            elements: 4,
            degree: 4,
        },
    )
    .unwrap();
    assert_eq!(bar.advance(0.04), Ok(()));
    assert!(matches!(
        bar.advance(0.1),
        Err(ReferenceError::NotFinite {
            name: "body force",
            ..
        })
    ));
}

/// A law whose stress overflows at once: the state is refused within the same `advance`.
#[test]
fn state_that_is_no_number() {
    #[derive(Clone)]
    struct Overflowing;
    impl UniaxialLaw for Overflowing {
        fn stress(&self, _stretch: f64) -> f64 {
            f64::INFINITY
        }
        fn stiffness(&self, _stretch: f64) -> f64 {
            1.0
        }
    }
    let problem = BarProblem::new(1.0, 1.0, Overflowing).ends(End::Fixed, End::Free);
    let mut bar = LagrangianBar::new(
        problem,
        Resolution {
            elements: 4,
            degree: 4,
        },
    )
    .unwrap();
    assert!(bar.advance(1e-6).is_err());
}

/// In one step of 1e-5 s the strain v0 pi t / L reaches 2.5e-5 in the last stage, whose stress only the
/// velocity sees.
#[test]
fn stress_that_is_no_number_in_the_last_stage() {
    struct Brittle;
    impl UniaxialLaw for Brittle {
        fn stress(&self, stretch: f64) -> f64 {
            if stretch > 1.0 + 2e-5 {
                f64::NAN
            } else {
                4e4 * (stretch - 1.0)
            }
        }
        fn stiffness(&self, _stretch: f64) -> f64 {
            4e4
        }
    }
    let mut bar = LagrangianBar::vibrating_bar(1.0, 2e3, 0.8, Brittle).unwrap();
    let result = bar.advance(1e-5);
    assert!(
        matches!(result, Err(ReferenceError::InvalidVelocity { .. })),
        "{result:?}"
    );
}

/// Waves of 1e150 m/s: no step that they allow moves the time on.
#[test]
fn steps_that_vanish() {
    let stiff = Linear {
        youngs_modulus: 1e300,
    };
    let mut bar = LagrangianBar::vibrating_bar(1.0, 1.0, 0.8, stiff).unwrap();
    assert!(matches!(
        bar.advance(1.0),
        Err(ReferenceError::StepTooSmall { .. })
    ));
}

#[test]
fn force_beyond_all_bounds() {
    let mut bar = LagrangianBar::new(
        problem().ends(End::Fixed, End::Free).body_force(|_| 1e308, &[]),
        Resolution {
            elements: 4,
            degree: 4,
        },
    )
    .unwrap();
    assert!(bar.advance(1.0).is_err());
}
