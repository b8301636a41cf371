//! Text in pictures: escaping, widths, powers of ten.

use std::borrow::Cow;

/// Width of a character relative to the font size (-): that of DejaVu Sans, the widest font we ask for.
const WIDTH: f64 = 0.61;
/// Below this size (px) text is cut rather than shrunk further.
const SMALLEST: f64 = 10.0;

/// Text as XML; characters that XML cannot hold become blanks.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => escaped.push(' '),
            c if c.is_control() => escaped.push(' '),
            c => escaped.push(c),
        }
    }
    escaped
}

/// Width of a text (px), on the safe side.
pub(super) fn width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * size * WIDTH
}

/// The text and the font size (px) at which it stays within a width (px): shrunk first, then cut.
pub(super) fn fit(text: &str, size: f64, available: f64) -> (Cow<'_, str>, f64) {
    let needed = width(text, size);
    if needed <= available {
        return (text.into(), size);
    }
    let shrunk = size * available / needed;
    if shrunk >= SMALLEST {
        return (text.into(), shrunk);
    }
    let kept = (available / (SMALLEST * WIDTH)).max(1.0) as usize - 1;
    let mut cut: String = text.chars().take(kept).collect();
    cut.push('…');
    (cut.into(), SMALLEST)
}

/// A power of ten, such as `10⁻³`.
pub(super) fn power_of_ten(exponent: i32) -> String {
    match exponent {
        0 => "1".into(),
        1 => "10".into(),
        _ => format!(
            "10{}",
            exponent.to_string().chars().map(raised).collect::<String>()
        ),
    }
}

fn raised(c: char) -> char {
    match c {
        '-' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        other => other,
    }
}

/// A quantity with its unit, and the power of ten that its tick labels leave out: `stress [10³ Pa]`.
pub(super) fn with_unit(name: &str, unit: &str, exponent: i32) -> String {
    match (exponent, unit) {
        (0, "") => name.into(),
        (0, unit) => format!("{name} [{unit}]"),
        (exponent, "" | "-") => format!("{name} [{}]", power_of_ten(exponent)),
        (exponent, unit) => format!("{name} [{} {unit}]", power_of_ten(exponent)),
    }
}

/// Splits `time [s]` into name and unit; text without brackets at its end is all name.
pub(super) fn split_unit(label: &str) -> (&str, &str) {
    let inner = label.trim_end().strip_suffix(']');
    match inner.and_then(|inner| inner.rsplit_once('[')) {
        Some((name, unit)) => (name.trim_end(), unit),
        None => (label, ""),
    }
}

#[cfg(test)]
mod tests {
    use super::{escape, fit, power_of_ten, split_unit, with_unit};

    #[test]
    fn markup_and_control_characters_cannot_break_the_picture() {
        assert_eq!(escape("a<b & \"c\"\u{1}>"), "a&lt;b &amp; &quot;c&quot; &gt;");
    }

    #[test]
    fn text_is_shrunk_then_cut() {
        assert_eq!(fit("short", 14.0, 200.0), ("short".into(), 14.0));
        assert!(fit("a longer name", 14.0, 95.0).1 < 14.0);
        assert!(fit("a name that is far too long", 14.0, 60.0).0.ends_with('…'));
        assert_eq!(fit("no room", 14.0, 0.0).0, "…");
    }

    #[test]
    fn units_carry_the_power_of_ten() {
        assert_eq!(power_of_ten(-12), "10⁻¹²");
        assert_eq!(with_unit("stress", "Pa", 3), "stress [10³ Pa]");
        assert_eq!(with_unit("porosity", "-", 0), "porosity [-]");
        assert_eq!(split_unit("time per step [s]"), ("time per step", "s"));
        assert_eq!(split_unit("cells"), ("cells", ""));
    }
}
