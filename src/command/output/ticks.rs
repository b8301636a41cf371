//! Tick marks at round numbers.

use super::scale::Scale;
use super::text::power_of_ten;

/// The ticks of one axis.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Ticks {
    /// Place as a fraction of the axis, and label.
    pub labelled: Vec<(f64, String)>,
    /// Places of marks without labels.
    pub minor: Vec<f64>,
    /// Power of ten that all labels leave out.
    pub exponent: i32,
}

/// About as many ticks as wanted.
pub(super) fn ticks(scale: &Scale, wanted: usize) -> Ticks {
    let wanted = wanted.clamp(2, 20);
    if !scale.log {
        return linear(scale, wanted);
    }
    let decades = whole_numbers(scale.low, scale.high);
    if decades.len() > 1 {
        return powers(scale, &decades, wanted);
    }
    let between = one_two_five(scale);
    if between.labelled.len() > 1 {
        between
    } else {
        narrow(scale, wanted)
    }
}

fn linear(scale: &Scale, wanted: usize) -> Ticks {
    let step = round_step((scale.high - scale.low) / wanted as f64);
    let size = scale.low.abs().max(scale.high.abs());
    let exponent = shared_exponent(size);
    let unit = 10f64.powi(exponent);
    let digits = (-(step / unit).log10() - 1e-9).ceil().clamp(0.0, 15.0) as usize;
    let labelled = whole_numbers(scale.low / step, scale.high / step)
        .into_iter()
        .map(|i| {
            let i = i as f64;
            (
                place(scale, i * step),
                format!("{:.digits$}", i * (step / unit)).replace('-', "−"),
            )
        });
    Ticks {
        labelled: labelled.collect(),
        minor: Vec::new(),
        exponent,
    }
}

/// The step 1, 2 or 5 times a power of ten that is at least `step`.
fn round_step(step: f64) -> f64 {
    let decade = 10f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|factor| factor * decade >= step * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * decade
}

/// A multiple of three, so that it reads as milli, kilo, mega; zero for numbers that are short as they are.
fn shared_exponent(size: f64) -> i32 {
    if (1e-2..1e4).contains(&size) {
        return 0;
    }
    3 * (size.log10() / 3.0).floor() as i32
}

fn powers(scale: &Scale, decades: &[i64], wanted: usize) -> Ticks {
    let stride = decades.len().div_ceil(wanted);
    let labelled = decades.iter().filter(|k| k.rem_euclid(stride as i64) == 0);
    let labelled = labelled
        .map(|&k| (place(scale, k as f64), power_of_ten(k as i32)))
        .collect();
    let minor = if stride == 1 {
        multiples(scale, 2..=9)
    } else {
        Vec::new()
    };
    Ticks {
        labelled,
        minor,
        exponent: 0,
    }
}

/// Less than two powers of ten in sight: 1, 2 and 5 times powers of ten.
fn one_two_five(scale: &Scale) -> Ticks {
    let mut labelled = Vec::new();
    for k in around(scale) {
        for m in [1, 2, 5] {
            let inner = f64::from(k) + f64::from(m).log10();
            if (scale.low..=scale.high).contains(&inner) {
                labelled.push((place(scale, inner), multiple(m, k)));
            }
        }
    }
    Ticks {
        labelled,
        minor: multiples(scale, 1..=9),
        exponent: 0,
    }
}

/// Not even those: evenly spaced numbers, at logarithmic places.
fn narrow(scale: &Scale, wanted: usize) -> Ticks {
    let even = Scale {
        low: 10f64.powf(scale.low),
        high: 10f64.powf(scale.high),
        log: false,
    };
    let mut ticks = linear(&even, wanted);
    for (at, _) in &mut ticks.labelled {
        *at = place(scale, (even.low + *at * (even.high - even.low)).log10());
    }
    ticks
}

/// `2×10⁻⁵`, or `0.02` where that is short.
fn multiple(m: i32, k: i32) -> String {
    match k {
        0..=3 => (m * 10i32.pow(k.unsigned_abs())).to_string(),
        -3..0 => format!("{:.*}", k.unsigned_abs() as usize, f64::from(m) * 10f64.powi(k)),
        _ if m == 1 => power_of_ten(k),
        _ => format!("{m}×{}", power_of_ten(k)),
    }
}

fn multiples(scale: &Scale, factors: std::ops::RangeInclusive<i32>) -> Vec<f64> {
    let inner = around(scale).flat_map(|k| factors.clone().map(move |m| f64::from(k) + f64::from(m).log10()));
    inner
        .filter(|v| (scale.low..=scale.high).contains(v))
        .map(|v| place(scale, v))
        .collect()
}

/// The decades that overlap a logarithmic axis.
fn around(scale: &Scale) -> std::ops::RangeInclusive<i32> {
    scale.low.floor() as i32..=scale.high.floor() as i32
}

fn place(scale: &Scale, inner: f64) -> f64 {
    (inner - scale.low) / (scale.high - scale.low)
}

/// All whole numbers from `low` to `high`, a little round-off allowed.
fn whole_numbers(low: f64, high: f64) -> Vec<i64> {
    let slack = 1e-9 * (high - low);
    ((low - slack).ceil() as i64..=(high + slack).floor() as i64).collect()
}

#[cfg(test)]
mod tests {
    use super::ticks;
    use crate::output::scale::Scale;

    fn labels(low: f64, high: f64, log: bool) -> (Vec<String>, i32) {
        let ticks = ticks(&Scale { low, high, log }, 5);
        assert!(
            ticks
                .labelled
                .iter()
                .all(|(at, _)| (-1e-6..=1.000001).contains(at))
        );
        (
            ticks.labelled.into_iter().map(|(_, label)| label).collect(),
            ticks.exponent,
        )
    }

    #[test]
    fn linear_labels_are_short_and_share_a_power_of_ten() {
        assert_eq!(
            labels(0.0, 1.0, false).0,
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        let (stress, exponent) = labels(-2.1e5, 1.9e5, false);
        assert_eq!((stress.join(" ").as_str(), exponent), ("−200 −100 0 100", 3));
        let (small, exponent) = labels(0.0, 1.23e-7, false);
        assert_eq!((small.join(" ").as_str(), exponent), ("0 50 100", -9));
    }

    #[test]
    fn logarithmic_labels_follow_the_width_of_the_range() {
        assert_eq!(labels(-3.1, 0.1, true).0, ["10⁻³", "10⁻²", "10⁻¹", "1"]);
        assert_eq!(labels(-1.8, -0.9, true).0, ["0.02", "0.05", "0.1"]);
        assert_eq!(
            labels(0.0, 0.02, true).0.first().map(String::as_str),
            Some("1.00")
        );
        assert!(labels(-250.0, 250.0, true).0.len() < 7);
    }

    #[test]
    fn neighbouring_labels_differ_on_every_scale() {
        for (low, span) in [(0.0, 1e-290), (1e9, 2.0), (-1e299, 2e299), (-3.0, 7e-8)] {
            let (labels, _) = labels(low, low + span, false);
            assert!(
                labels.len() > 1 && labels.windows(2).all(|pair| pair[0] != pair[1]),
                "{labels:?}"
            );
        }
    }
}
