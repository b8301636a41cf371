//! The front: rows that no other beats in both time and error.

use super::Row;

/// Marks the rows on the front. A row without an error or a time is not on it.
pub(super) fn mark(rows: &mut [Row]) {
    let points: Vec<_> = rows
        .iter()
        .map(|row| row.stress_error().map(|error| (row.wall_seconds, error)))
        .collect();
    for (row, point) in rows.iter_mut().zip(&points) {
        row.on_front = point.is_some_and(|point| !points.iter().flatten().any(|&other| beats(other, point)));
    }
}

/// Whether `a` is both faster and more accurate than `b`.
fn beats(a: (f64, f64), b: (f64, f64)) -> bool {
    a.0 < b.0 && a.1 < b.1
}

#[cfg(test)]
mod tests {
    use super::beats;

    #[test]
    fn only_faster_and_more_accurate_beats() {
        assert!(beats((1.0, 0.1), (2.0, 0.2)));
        assert!(!beats((1.0, 0.3), (2.0, 0.2)));
        assert!(!beats((1.0, 0.2), (1.0, 0.2)));
    }
}
