//! Checks of parameters that several solutions share.

use super::ReferenceError;

/// Passes a positive finite `value`.
pub(super) fn positive(name: &'static str, value: f64) -> Result<f64, ReferenceError> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(ReferenceError::NotPositive { name, value })
    }
}

/// Passes a finite `value`.
pub(super) fn finite(name: &'static str, value: f64) -> Result<f64, ReferenceError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(ReferenceError::NotFinite { name, value })
    }
}

/// Passes a `time` at which a solution exists.
pub(super) fn time(time: f64) -> Result<f64, ReferenceError> {
    if time >= 0.0 && time.is_finite() {
        Ok(time)
    } else {
        Err(ReferenceError::InvalidTime { time })
    }
}

/// Passes a `value` between `lowest` and `highest`.
pub(super) fn within(
    name: &'static str,
    value: usize,
    lowest: usize,
    highest: usize,
) -> Result<usize, ReferenceError> {
    if (lowest..=highest).contains(&value) {
        Ok(value)
    } else {
        Err(ReferenceError::OutOfRange {
            name,
            value,
            lowest,
            highest,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn accepts_what_is_sound_and_names_what_is_not() {
        assert_eq!(positive("density", 2.0), Ok(2.0));
        assert_eq!(finite("origin", -1.0), Ok(-1.0));
        assert_eq!(time(0.0), Ok(0.0));
        assert_eq!(within("elements", 2, 2, 9), Ok(2));

        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let message = positive("density", bad).map_err(|e| e.to_string());
            assert_eq!(
                message,
                Err(format!("density must be positive and finite, not {bad}"))
            );
        }
        assert!(finite("origin", f64::NEG_INFINITY).is_err());
        assert!(time(-1e-300).is_err());
        assert!(time(f64::NAN).is_err());
        assert!(within("elements", 1, 2, 9).is_err());
        assert!(within("elements", 10, 2, 9).is_err());
    }
}
