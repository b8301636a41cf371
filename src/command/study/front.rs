//! The front: rows that no other beats in both time and error.

use super::Row;

/// Marks the rows on the front. A row without a finite error or time is not on it, and beats nobody.
pub(super) fn mark(rows: &mut [Row]) {
    let points: Vec<_> = rows
        .iter()
        .map(|row| point(row.wall_seconds, row.stress_error()?))
        .collect();
    for (row, point) in rows.iter_mut().zip(&points) {
        row.on_front = point.is_some_and(|point| !points.iter().flatten().any(|&other| beats(other, point)));
    }
}

fn point(seconds: f64, error: f64) -> Option<(f64, f64)> {
    (seconds.is_finite() && error.is_finite()).then_some((seconds, error))
}

/// Whether `a` is both faster and more accurate than `b`. Rows that tie in either do not beat each other.
fn beats(a: (f64, f64), b: (f64, f64)) -> bool {
    a.0 < b.0 && a.1 < b.1
}

#[cfg(test)]
mod tests {
    use super::super::tests::row;
    use super::*;

    #[test]
    fn only_faster_and_more_accurate_beats() {
        assert!(beats((1.0, 0.1), (2.0, 0.2)));
        assert!(!beats((1.0, 0.3), (2.0, 0.2)));
        assert!(!beats((1.0, 0.2), (1.0, 0.2)));
    }

    fn marked(points: &[(f64, f64)]) -> Vec<bool> {
        let mut rows: Vec<Row> = points
            .iter()
            .map(|&(seconds, error)| row(seconds, Some(error)))
            .collect();
        mark(&mut rows);
        rows.iter().map(|row| row.on_front).collect()
    }

    #[test]
    fn ties_stay_and_what_is_worse_in_both_goes() {
        let marks = marked(&[(1.0, 0.3), (1.0, 0.2), (2.0, 0.2), (2.0, 0.25), (3.0, 0.1)]);
        assert_eq!(marks, [true, true, true, false, true]);
    }

    #[test]
    fn a_row_without_a_number_is_not_on_the_front_and_beats_nobody() {
        let nan = f64::NAN;
        let marks = marked(&[
            (1.0, nan),
            (2.0, 0.2),
            (nan, 0.1),
            (3.0, f64::INFINITY),
            (0.5, nan),
        ]);
        assert_eq!(marks, [false, true, false, false, false]);
        let mut stopped = [row(nan, None), row(1.0, Some(0.5))];
        mark(&mut stopped);
        assert!(!stopped[0].on_front && stopped[1].on_front);
    }
}
