//! Whether two bodies share material.

use crate::scene::{Body, ExpressionError, FORGIVEN, GridSpec};

/// By how much two bodies overlap, in words; `None` if they at most touch. Boxes count as far as nothing says
/// where within them the bodies are; otherwise the particles of one that lie in the shape of the other.
pub(super) fn overlap(a: &Body, b: &Body, grid: &GridSpec) -> Result<Option<String>, ExpressionError> {
    let axes = 0..grid.cells.len();
    let common: Vec<[f64; 2]> = axes
        .map(|axis| {
            let at = |corner: &[f64]| corner.get(axis).copied().unwrap_or(f64::NAN);
            [at(&a.min).max(at(&b.min)), at(&a.max).min(at(&b.max))]
        })
        .collect();
    let rows = [Rows::of(a, grid), Rows::of(b, grid)];
    let touch = common.iter().enumerate().any(|(axis, [low, high])| {
        let spacing = rows.iter().filter_map(|rows| rows.spacing.get(axis));
        high - low <= FORGIVEN * spacing.fold(f64::INFINITY, |least, &s| least.min(s))
    });
    if touch {
        return Ok(None);
    }
    if a.inside.is_none() && b.inside.is_none() {
        let depth: Vec<String> = common
            .iter()
            .map(|[low, high]| format!("{:?}", high - low))
            .collect();
        return Ok(Some(format!("by a box of {} m", depth.join(" x "))));
    }
    let [of_a, of_b] =
        [(a, b, &rows[0]), (b, a, &rows[1])].map(|(own, other, rows)| rows.count_within(own, other));
    Ok(match (of_a?, of_b?) {
        (0, 0) => None,
        (own, theirs) => Some(format!(
            "where {own} of its particles lie in that body's shape and {theirs} of that body's in its own"
        )),
    })
}

/// The particles of a body as `particles::lattice` places them, without the random part.
struct Rows {
    spacing: Vec<f64>,
    counts: Vec<usize>,
}

impl Rows {
    fn of(body: &Body, grid: &GridSpec) -> Self {
        let mut rows = Self {
            spacing: Vec::new(),
            counts: Vec::new(),
        };
        let corners = body.min.iter().zip(&body.max).zip(&body.particles_per_cell);
        let cells = grid.min.iter().zip(&grid.max).zip(&grid.cells);
        for (((low, high), &per_cell), ((grid_low, grid_high), &count)) in corners.zip(cells) {
            let cell = (grid_high - grid_low) / count as f64;
            let count = ((high - low) / cell * per_cell as f64).round().max(1.0);
            rows.spacing.push((high - low) / count);
            rows.counts.push(count as usize);
        }
        rows
    }

    /// How many particles of the body lie in the other's shape.
    fn count_within(&self, own: &Body, other: &Body) -> Result<usize, ExpressionError> {
        let mut found = 0;
        for mut index in 0..self.counts.iter().product() {
            let axes = self.counts.iter().zip(&self.spacing).zip(&own.min);
            let place = axes.map(|((&count, spacing), low)| {
                let k = index % count;
                index /= count;
                low + spacing * (k as f64 + 0.5)
            });
            let place: Vec<f64> = place.collect();
            if other.holds(&place)? && own.holds(&place)? {
                found += 1;
            }
        }
        Ok(found)
    }
}
