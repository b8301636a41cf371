//! From data to a fraction of an axis, linear or logarithmic.

/// Beyond this size differences overflow; below its inverse logarithms lose digits.
const LARGEST: f64 = 1e300;
/// Spans below this fraction of the values are round-off: the axis shows one value.
const ROUND_OFF: f64 = 1e-9;

/// One axis: its range in data, or in the decimal logarithm of data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    pub low: f64,
    pub high: f64,
    pub log: bool,
}

impl Scale {
    /// A linear axis over all drawable values, with a margin (fraction of the span).
    pub fn linear(values: impl Iterator<Item = f64>, margin: f64) -> Scale {
        let (low, high) = match range(values.filter(|v| drawable(*v))) {
            None => (0.0, 1.0),
            Some((low, high)) => widened(low, high),
        };
        let margin = margin * (high - low);
        Scale {
            low: low - margin,
            high: high + margin,
            log: false,
        }
    }

    /// A logarithmic axis over all positive drawable values, with a margin.
    pub fn log(values: impl Iterator<Item = f64>, margin: f64) -> Scale {
        let (low, high) = match range(values.filter(|v| positive(*v)).map(f64::log10)) {
            None => (0.0, 1.0),
            // Half a decade around a single value.
            Some((low, high)) if high - low < 1e-6 => (low - 0.5, high + 0.5),
            Some(found) => found,
        };
        let margin = margin * (high - low);
        Scale {
            low: low - margin,
            high: high + margin,
            log: true,
        }
    }

    /// Where a value lies: 0 at the low end, 1 at the high end; `None` if it cannot be drawn.
    pub fn fraction(&self, value: f64) -> Option<f64> {
        let inner = match self.log {
            false => drawable(value).then_some(value)?,
            true => positive(value).then(|| value.log10())?,
        };
        Some((inner - self.low) / (self.high - self.low))
    }
}

/// Finite, and small enough that differences of such values are finite.
pub(super) fn drawable(value: f64) -> bool {
    value.abs() < LARGEST
}

/// Has a place on a logarithmic axis.
pub(super) fn positive(value: f64) -> bool {
    value > 1.0 / LARGEST && drawable(value)
}

/// Smallest and largest value.
pub(super) fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |range, v| match range {
        None => Some((v, v)),
        Some((low, high)) => Some((v.min(low), v.max(high))),
    })
}

/// A range that spans more than round-off.
fn widened(low: f64, high: f64) -> (f64, f64) {
    let size = low.abs().max(high.abs());
    if size < 1.0 / LARGEST {
        return (-1.0, 1.0);
    }
    if high - low > ROUND_OFF * size {
        return (low, high);
    }
    (low - 0.5 * size, high + 0.5 * size)
}

#[cfg(test)]
mod tests {
    use super::Scale;

    #[test]
    fn ends_map_to_zero_and_one() {
        let scale = Scale::linear([2.0, f64::NAN, 4.0, f64::INFINITY].into_iter(), 0.0);
        assert_eq!((scale.fraction(2.0), scale.fraction(4.0)), (Some(0.0), Some(1.0)));
        let scale = Scale::log([1e-3, -1.0, 0.0, 1e3].into_iter(), 0.0);
        assert_eq!(scale.fraction(1.0), Some(0.5));
    }

    #[test]
    fn values_without_a_place_have_no_fraction() {
        let scale = Scale::log([1.0, 10.0].into_iter(), 0.0);
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(scale.fraction(value), None);
        }
    }

    #[test]
    fn every_range_has_an_extent() {
        let cases: [&[f64]; 6] = [
            &[],
            &[0.0],
            &[5.0, 5.0],
            &[1e-320, 0.0],
            &[-9e299, 9e299],
            &[2e9, 2e9 + 1e-6],
        ];
        for values in cases {
            for scale in [
                Scale::linear(values.iter().copied(), 0.05),
                Scale::log(values.iter().copied(), 0.05),
            ] {
                assert!(
                    (scale.high - scale.low).is_normal() && scale.high > scale.low,
                    "{values:?}: {scale:?}"
                );
            }
        }
    }
}
