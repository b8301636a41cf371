//! Against exact solutions, its own convergence, and the settlements of the benchmark.

use std::f64::consts::PI;

use super::super::soil::tests::report_soil;
use super::super::testing::assert_close;
use super::super::{SaturatedColumn, StandingWave, XieLeo};
use super::*;
use crate::reference::{Hill, InvertibleLaw, Linear, Logarithmic, NeoHookean};

const LOGARITHMIC: Logarithmic = Logarithmic { youngs_modulus: 1e6 };

fn resolution(elements: usize, degree: usize) -> Resolution {
    Resolution { elements, degree }
}

/// Report 18-2's large-strain benchmark, of the given permeability.
fn benchmark(permeability: f64) -> LagrangianSoil<Logarithmic> {
    LagrangianSoil::consolidation(1.0, -5e5, report_soil(permeability, 3e7), LOGARITHMIC).unwrap()
}

/// Weak, medium and strong drag; the wave's velocities have a node at both ends and its stresses an extremum.
#[test]
fn follows_the_standing_wave() {
    for permeability in [1.0, 1e-3, 1e-5, 1e-9] {
        let soil = report_soil(permeability, 3e8);
        let mut exact = StandingWave::new(1.0, 1e7, soil, 2, 0.1).unwrap();
        let start = exact.amplitudes();
        let wave = 2.0 * PI;
        let problem = SoilProblem::new(1.0, soil, Linear { youngs_modulus: 1e7 })
            .small_strain()
            .ends(SoilEnd::Fixed, SoilEnd::Fixed)
            .initial_velocities(
                move |x| start.solid_velocity * (wave * x).sin(),
                move |x| start.liquid_velocity * (wave * x).sin(),
            )
            .initial_stresses(
                move |x| start.effective_stress * (wave * x).cos(),
                move |x| start.pore_pressure * (wave * x).cos(),
            );
        let mut column = LagrangianSoil::new(problem, resolution(16, 10)).unwrap();
        for time in [1e-3, 4.7e-3] {
            exact.advance(time).unwrap();
            column.advance(time).unwrap();
            for x in [0.0, 0.11, 0.5, 0.83] {
                let (a, b) = (column.at(x), exact.at(x));
                assert_close(a.solid_displacement, b.solid_displacement, 1e-8 * 0.1 / 3.9e3);
                assert_close(a.solid_velocity, b.solid_velocity, 1e-8 * 0.1);
                assert_close(a.liquid_velocity, b.liquid_velocity, 1e-8 * 0.1);
                assert_close(a.effective_stress, b.effective_stress, 1e-8 * 1.4e4);
                assert_close(a.pore_pressure, b.pore_pressure, 1e-8 * 1.2e5);
            }
        }
    }
}

/// The column that has settled stays, under its weight and a load, with its base anywhere.
#[test]
fn keeps_the_equilibrium_of_the_saturated_column() {
    let soil = report_soil(1e-4, 3e7);
    let exact = SaturatedColumn::new(2.0, 1e6, -3e3, soil).unwrap();
    let (effective, pore) = (exact.clone(), exact.clone());
    let problem = SoilProblem::new(2.0, soil, Linear { youngs_modulus: 1e6 })
        .origin(-7.0)
        .load(|_| -3e3)
        .body_force(|_| -9.81)
        .initial_stresses(
            move |x| effective.at(x).effective_stress,
            move |x| pore.at(x).pore_pressure,
        );
    let mut column = LagrangianSoil::new(problem, resolution(4, 5)).unwrap();
    column.advance(0.05).unwrap();
    for x in [0.0, 0.6, 2.0] {
        let (state, rest) = (column.at(x - 7.0), exact.at(x));
        assert_close(state.pore_pressure, rest.pore_pressure, 1e-6);
        assert_close(state.effective_stress, rest.effective_stress, 1e-6);
        assert_close(state.liquid_velocity, 0.0, 1e-11);
    }
    let estimate = column.error_estimate(0.0).unwrap();
    assert!(estimate < 1e-15, "{estimate}");
}

/// The exact solution without inertia settles by 5.4027e-2 m. Inertia sets off the undrained wave, which
/// still rings with 3e-5 m and 0.6 % of the pressure about it; at 0.4 s that makes 5.4040e-2 m. A
/// finite-volume solution on staggered cells, 200 of them, marched by an implicit method, gives 5.4039e-2 m.
#[test]
fn large_strain_consolidation_tends_to_the_exact_one() {
    let mut column = benchmark(3.68e-4);
    let exact = XieLeo::new(1.0, 1e6, -5e5, report_soil(3.68e-4, 3e7)).unwrap();
    let mut exact = exact.with_compressible_liquid();
    exact.advance(0.4).unwrap();
    column.advance(0.4).unwrap();

    assert_close(column.at(1.0).solid_displacement, -5.404e-2, 5e-6);
    let ratio = column.at(1.0).solid_displacement / exact.at(1.0).solid_displacement - 1.0;
    assert!((1e-4..4e-4).contains(&ratio), "{ratio}");
    for x in [0.3, 0.7, 0.9, 1.0] {
        let (a, b) = (column.at(x), exact.at(x));
        assert_close(a.effective_stress, b.effective_stress, 1e-3 * 5e5);
        assert_close(a.pore_pressure, b.pore_pressure, 8e-3 * 5e5);
        assert_close(a.liquid_velocity, b.liquid_velocity, 1e-2);
    }
}

/// The printed permeability of the benchmark, with the same k0 lambda^2.
#[test]
fn printed_permeability_settles_less() {
    let mut column = benchmark(1e-5).with_resolution(resolution(12, 6)).unwrap();
    column.advance(0.05).unwrap();
    let exact = XieLeo::new(1.0, 1e6, -5e5, report_soil(1e-5, 3e7)).unwrap();
    let mut exact = exact.with_compressible_liquid();
    exact.advance(0.05).unwrap();
    let ratio = column.at(1.0).solid_displacement / exact.at(1.0).solid_displacement;
    assert!((ratio - 1.0).abs() < 2e-3, "{ratio}");
}

/// A load that grows smoothly, and a layer beneath the drained end that 16 elements do not quite resolve: the
/// error falls exponentially there.
#[test]
fn converges_where_the_load_is_smooth() {
    let solve = |elements| {
        let law = NeoHookean { lambda: 4e5, mu: 3e5 };
        let problem = SoilProblem::new(
            1.0,
            Soil {
                permeability_exponent: 0.5,
                ..report_soil(5e-3, 3e7)
            },
            law,
        )
        .load(|t| -2e5 * (PI * t / 0.02).sin().powi(6))
        .pore_load(0.0);
        LagrangianSoil::new(problem, resolution(elements, 8)).unwrap()
    };
    let (coarse, fine) = (solve(16).error_estimate(0.01), solve(32).error_estimate(0.01));
    let (coarse, fine) = (coarse.unwrap(), fine.unwrap());
    assert!(fine < 1e-6 && fine < coarse / 100.0, "{coarse} and {fine}");
}

/// Until all pore pressure has gone, under Hill's law and another law of permeability; drained at the base,
/// too.
#[test]
fn ends_at_the_stretch_of_the_load() {
    let soil = Soil {
        permeability_exponent: 1.0,
        ..report_soil(1e-2, 3e7)
    };
    let law = Hill { youngs_modulus: 1e6 };
    let problem = SoilProblem::new(1.0, soil, law)
        .load(|t| -3e5 * (t / 0.02).min(1.0))
        .kinks(&[0.02])
        .pore_load(-1e5);
    let mut column = LagrangianSoil::new(problem, resolution(3, 6)).unwrap();
    column.advance(8.0).unwrap();
    let stretch = law.stretch(-2e5).unwrap();
    let top = column.at(1.0);
    assert_close(top.solid_displacement, stretch - 1.0, 1e-6);
    assert_close(top.effective_stress, -2e5, 1.0);
    assert_close(column.at(0.2).pore_pressure, -1e5, 1.0);
}

#[test]
fn going_back_starts_again() {
    let mut column = benchmark(3.68e-4).with_resolution(resolution(6, 4)).unwrap();
    column.advance(2e-3).unwrap();
    let once = column.at(0.98);
    column.advance(5e-3).unwrap();
    column.advance(2e-3).unwrap();
    assert_eq!(column.at(0.98), once);
    column.advance(2e-3).unwrap();
    assert_eq!(column.at(0.98), once);
}

#[test]
fn refuses_bad_problems_and_times() {
    let soil = report_soil(1e-3, 3e7);
    let problem = || SoilProblem::new(1.0, soil, LOGARITHMIC);
    let refused = |problem| LagrangianSoil::new(problem, resolution(4, 4)).is_err();
    assert!(refused(SoilProblem::new(0.0, soil, LOGARITHMIC)));
    assert!(refused(SoilProblem::new(
        1.0,
        Soil {
            gravity: -1.0,
            ..soil
        },
        LOGARITHMIC
    )));
    assert!(refused(problem().levels(31)));
    assert!(refused(problem().kinks(&[-1.0])));
    assert!(refused(problem().pore_load(f64::NAN)));
    assert!(refused(problem().initial_stresses(|_| f64::NAN, |_| 0.0)));
    assert!(refused(problem().initial_stresses(|_| 0.0, |_| f64::NAN)));
    assert!(refused(problem().initial_velocities(|_| f64::NAN, |_| 0.0)));
    assert!(LagrangianSoil::new(problem(), resolution(4, 40)).is_err());

    let mut column = LagrangianSoil::new(problem().load(|_| f64::NAN), resolution(4, 4)).unwrap();
    assert!(column.advance(-1.0).is_err());
    assert!(column.advance(1e-3).is_err());
    let mut crushed = LagrangianSoil::new(
        problem().initial_velocities(|x| -4e3 * x, |x| -4e3 * x),
        resolution(4, 4),
    )
    .unwrap();
    let result = crushed.advance(1.0);
    assert!(
        matches!(
            result,
            Err(ReferenceError::InvalidStretch { .. } | ReferenceError::StepTooSmall { .. })
        ),
        "{result:?}"
    );
}
