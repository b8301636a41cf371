//! Colours of values: viridis, which brightens evenly and which colour-blind readers can order.

use super::super::scale::Scale;

/// How many colours a map has.
pub(super) const LEVELS: usize = 64;

/// Viridis at equal distances (red, green, blue).
const STOPS: [[u8; 3]; 18] = [
    [68, 1, 84],
    [72, 23, 105],
    [71, 42, 122],
    [67, 61, 132],
    [61, 78, 138],
    [53, 94, 141],
    [46, 109, 142],
    [41, 123, 142],
    [35, 137, 142],
    [31, 151, 139],
    [33, 165, 133],
    [46, 179, 124],
    [70, 192, 111],
    [101, 203, 94],
    [137, 213, 72],
    [176, 221, 47],
    [216, 226, 25],
    [253, 231, 37],
];

/// The colour, from 0 to `LEVELS` - 1, of a value; `None` if it cannot be drawn.
pub(super) fn level(scale: &Scale, value: f64) -> Option<usize> {
    let fraction = scale.fraction(value)?.clamp(0.0, 1.0);
    Some(((fraction * LEVELS as f64) as usize).min(LEVELS - 1))
}

/// A colour in hexadecimal digits.
pub(super) fn colour(level: usize) -> String {
    let at = (STOPS.len() - 1) as f64 * level as f64 / (LEVELS - 1) as f64;
    let (low, part) = (at.floor() as usize, at.fract());
    let stop = |i: usize| STOPS.get(i).or(STOPS.last()).copied().unwrap_or_default();
    let (low, high) = (stop(low), stop(low + 1));
    let mixed = low
        .iter()
        .zip(high)
        .map(|(a, b)| f64::from(*a) + part * (f64::from(b) - f64::from(*a)));
    mixed.fold("#".to_owned(), |text, value| {
        text + &format!("{:02x}", value.round() as u8)
    })
}

#[cfg(test)]
mod tests {
    use super::{LEVELS, Scale, colour, level};

    /// Relative luminance (0 to 1) of a colour.
    fn luminance(colour: &str) -> f64 {
        let part = |i: usize| f64::from(u8::from_str_radix(&colour[i..i + 2], 16).unwrap()) / 255.0;
        let linear = |v: f64| {
            if v <= 0.04045 {
                v / 12.92
            } else {
                ((v + 0.055) / 1.055).powf(2.4)
            }
        };
        0.2126 * linear(part(1)) + 0.7152 * linear(part(3)) + 0.0722 * linear(part(5))
    }

    #[test]
    fn every_level_is_brighter_than_the_one_before() {
        let bright: Vec<f64> = (0..LEVELS).map(|i| luminance(&colour(i))).collect();
        assert!(bright.windows(2).all(|pair| pair[1] > pair[0]), "{bright:?}");
        assert_eq!(
            (colour(0).as_str(), colour(LEVELS - 1).as_str()),
            ("#440154", "#fde725")
        );
    }

    #[test]
    fn levels_reach_from_the_lowest_to_the_highest_value() {
        let scale = Scale {
            low: -2.0,
            high: 2.0,
            log: false,
        };
        let levels = [-2.0, 0.0, 2.0, 7.0, -7.0].map(|value| level(&scale, value));
        assert_eq!(levels, [0, LEVELS / 2, LEVELS - 1, LEVELS - 1, 0].map(Some));
        assert_eq!(level(&scale, f64::NAN), None);
    }
}
