//! Against the equations, reference digits and both limits of the permeability.

use super::super::soil::tests::report_soil;
use super::super::testing::{assert_close, derivative};
use super::*;

const MODULUS: f64 = 1e7;

/// First mode of the report's small-strain column, 1 m high.
fn wave(permeability: f64) -> StandingWave {
    StandingWave::new(1.0, MODULUS, report_soil(permeability, 3e8), 1, 0.1).unwrap()
}

fn state(permeability: f64, time: f64, x: f64) -> TwoPhaseState {
    let mut wave = wave(permeability).with_origin(0.4).unwrap();
    wave.advance(time).unwrap();
    wave.at(x)
}

#[track_caller]
fn assert_relative(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{a:e} against {b:e}");
}

/// Eigenvalues from the roots of the unscaled quartic in 60 digits. Real and imaginary parts are compared
/// separately, so that the damping is tested where it is 4e-11 of the frequency.
#[test]
#[rustfmt::skip]
fn eigenvalues_have_the_reference_digits() {
    let cases = [
        (1e-12, [(-8.685_437_606_312_323e-8, 1_956.269_271_252_527_2), (-9.928_380_413_135_119e-9, 0.0),
            (-4_930_153_846_153.846, 0.0)]),
        (1e-5, [(-0.868_533_493_447_307, 1_956.272_480_692_356_6), (-0.099_283_828_599_469_77, 0.0),
            (-493_013.548_264_569_14, 0.0)]),
        (1e-3, [(-77.048_600_370_861_38, 1_985.698_477_803_560_3), (-9.952_969_752_305_348, 0.0),
            (-4_766.103_675_659_818, 0.0)]),
        (1e-1, [(-4.583_828_274_927_046, 2_166.110_786_591_357),
            (-20.066_940_955_842_185, 198.799_421_273_820_83),
            (-20.066_940_955_842_185, -198.799_421_273_820_83)]),
        (1.0, [(-0.458_540_975_591_272_4, 2_166.200_387_789_220_3),
            (-2.006_535_947_485_651, 199.791_741_852_067_67),
            (-2.006_535_947_485_651, -199.791_741_852_067_67)]),
    ];
    for (permeability, [fast, third, fourth]) in cases {
        let actual = wave(permeability).eigenvalues();
        assert_eq!(actual[1], actual[0].conj());
        for (s, (re, im)) in [actual[0], actual[2], actual[3]].into_iter().zip([fast, third, fourth]) {
            assert_relative(s.re, re, 1e-12);
            assert_relative(s.im, im, 1e-12);
        }
        assert_eq!(wave(permeability).fast_wave(), (actual[0].im, -actual[0].re));
    }
}

/// From the same evaluation, per velocity of the solid.
#[test]
fn eigenvectors_have_the_reference_digits() {
    let [liquid, effective, pore] = wave(0.1).eigenvector();
    let pairs = [
        (liquid, 2.563_612_456_008_667_3, 0.047_360_342_164_168_7),
        (effective, -30.691_275_454_218_463, -14_503.314_441_177_932),
        (pore, 16_864.934_556_664_823, -1_768_119.082_976_639_7),
    ];
    for (value, re, im) in pairs {
        assert_relative(value.re, re, 1e-11);
        assert_relative(value.im, im, 1e-12);
    }
    let [_, _, pore] = wave(1e-12).eigenvector();
    assert_relative(pore.re, 0.000_170_907_058_966_155_05, 1e-9);
    assert_relative(pore.im, -1_204_432.602_820_449_3, 1e-13);
}

/// Through the range in which the drag is resolvable by differences of the state.
#[test]
fn satisfies_its_equations() {
    for permeability in [1e-5, 1e-3, 1.0] {
        let soil = report_soil(permeability, 3e8);
        let n = soil.porosity;
        for (time, x) in [(1e-4, 0.7), (1.3e-3, 1.2)] {
            let here = state(permeability, time, x);
            let along =
                |f: fn(TwoPhaseState) -> f64| derivative(|x| f(state(permeability, time, x)), x, 5e-3);
            let rate = |f: fn(TwoPhaseState) -> f64| derivative(|t| f(state(permeability, t, x)), time, 5e-6);
            let (acceleration, pressure_rate) = (0.1 * 2e3, 0.1 * 3e8);

            assert_close(rate(|s| s.solid_displacement), here.solid_velocity, 1e-11);
            assert_close(
                rate(|s| s.effective_stress),
                MODULUS * along(|s| s.solid_velocity),
                1e-8 * pressure_rate,
            );
            let inflow = 0.6 * along(|s| s.solid_velocity) + n * along(|s| s.liquid_velocity);
            assert_close(rate(|s| s.pore_pressure), 3e8 / n * inflow, 1e-8 * pressure_rate);

            let drag = n * soil.unit_weight() / permeability * (here.liquid_velocity - here.solid_velocity);
            let liquid = 1e3 * rate(|s| s.liquid_velocity);
            assert_close(
                liquid,
                along(|s| s.pore_pressure) - drag,
                1e-8 * 1e3 * acceleration,
            );
            let mixture = 0.6 * 2.6e3 * rate(|s| s.solid_velocity) + n * liquid;
            let total = along(|s| s.effective_stress + s.pore_pressure);
            assert_close(mixture, total, 1e-8 * 1e3 * acceleration);
        }
    }
}

#[test]
fn starts_as_asked_and_keeps_its_ends() {
    let start = state(1e-3, 0.0, 0.9);
    assert_eq!(start.solid_displacement, 0.0);
    assert_relative(start.solid_velocity, 0.1, 1e-15);
    for end in [0.4, 1.4] {
        let end = state(1e-3, 7e-4, end);
        assert_close(end.solid_velocity, 0.0, 1e-16);
        assert_close(end.liquid_velocity, 0.0, 1e-16);
        assert!(end.pore_pressure.abs() > 1e3);
    }
    let third = StandingWave::new(1.0, MODULUS, report_soil(1e-3, 3e8), 3, 0.1).unwrap();
    assert_close(third.at(1.0 / 3.0).solid_velocity, 0.0, 1e-16);
}

/// Locked liquid: one wave of the saturated density on both stiffnesses.
#[test]
fn small_permeability_gives_the_undrained_wave() {
    let undrained = PI * ((MODULUS + 3e8 / 0.4) / 1960.0_f64).sqrt();
    let (frequency, damping) = wave(1e-12).fast_wave();
    assert_relative(frequency, undrained, 1e-14);
    assert!(damping > 0.0 && damping < 1e-9 * frequency);
    let amplitudes = wave(1e-12).amplitudes();
    assert_relative(amplitudes.liquid_velocity, amplitudes.solid_velocity, 1e-9);
}

/// Independent phases: kappa^2 times the generalised eigenvalues of C and M, by the quadratic formula.
#[test]
fn large_permeability_gives_independent_waves() {
    let (n, bulk) = (0.4, 3e8);
    let (liquid, solid) = (n * 1e3, 0.6 * 2.6e3);
    let (ww, ws, ss) = (bulk * n, bulk * 0.6, bulk * 0.36 / n + MODULUS);
    let half_trace = 0.5 * (ww / liquid + ss / solid);
    let determinant = (ww * ss - ws * ws) / (liquid * solid);
    let larger = half_trace + (half_trace * half_trace - determinant).sqrt();
    let [fast, _, slow, _] = wave(1e9).eigenvalues();
    assert_relative(fast.im, PI * larger.sqrt(), 1e-13);
    assert_relative(slow.im, PI * (determinant / larger).sqrt(), 1e-12);
    assert!(fast.re.abs() < 1e-9 && slow.re.abs() < 1e-8);
}

#[test]
fn refuses_bad_parameters_and_times() {
    let soil = report_soil(1e-3, 3e8);
    assert!(StandingWave::new(0.0, 1e7, soil, 1, 0.1).is_err());
    assert!(StandingWave::new(1.0, 0.0, soil, 1, 0.1).is_err());
    assert!(StandingWave::new(1.0, 1e7, soil, 0, 0.1).is_err());
    assert!(StandingWave::new(1.0, 1e7, soil, 1, f64::NAN).is_err());
    assert!(wave(1e-3).advance(-1.0).is_err());
}
