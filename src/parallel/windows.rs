//! The part of the DOFs that each span contributes to.

use num_traits::Zero;

use super::Sliced;
use crate::simd::with_features;

/// DOFs `first .. first + len` of one span; its values start at `offset` of all windows laid end to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SpanWindow {
    pub(crate) first: usize,
    pub(crate) len: usize,
    pub(crate) offset: usize,
}

/// Windows of consecutive spans with their values, `width` for each DOF.
pub(crate) struct Windows<'a, Q> {
    spans: &'a [SpanWindow],
    values: &'a mut [Q],
    width: usize,
}

impl<Q> Default for Windows<'_, Q> {
    fn default() -> Self {
        Self {
            spans: &[],
            values: &mut [],
            width: 0,
        }
    }
}

impl<'a, Q: Copy + Zero + Send> Windows<'a, Q> {
    /// Empty sums for all of `spans`: in `storage`, or right in the DOFs' `sums` where there is a single
    /// span.
    pub(crate) fn new(
        spans: &'a [SpanWindow],
        storage: &'a mut Vec<Q>,
        sums: &'a mut [Q],
        width: usize,
    ) -> Self {
        let values = if spans.len() > 1 {
            fit(spans, storage, width);
            &mut storage[..]
        } else {
            sums
        };
        values.fill(Q::zero());
        Self { spans, values, width }
    }

    /// Of a single span: its first DOF and its values.
    #[inline(always)]
    pub(crate) fn one(self) -> (usize, &'a mut [Q]) {
        let first = self.spans.first().map_or(0, |span| span.first);
        (first, self.values)
    }
}

impl<Q: Send> Sliced for Windows<'_, Q> {
    fn items(&self) -> usize {
        0
    }

    fn split(self, spans: usize, _items: usize) -> (Self, Self) {
        let (left, right) = self.spans.split_at(spans.min(self.spans.len()));
        let length: usize = left.iter().map(|span| span.len).sum();
        let (a, b) = self.values.split_at_mut(length * self.width);
        let width = self.width;
        let part = |spans, values| Self { spans, values, width };
        (part(left, a), part(right, b))
    }
}

/// Room in windows for DOFs that spans come to share when their particles move apart.
const SLACK: usize = 8;

/// Gives `storage` the length that the windows of `spans` need together, none where there is a single span.
pub(crate) fn fit<Q: Copy + Zero>(spans: &[SpanWindow], storage: &mut Vec<Q>, width: usize) {
    let count = match spans {
        [.., last] if spans.len() > 1 => (last.offset + last.len) * width,
        _ => 0,
    };
    if count > storage.capacity() {
        storage.clear();
        storage.reserve_exact(count + SLACK * spans.len() * width);
    }
    storage.resize(count, Q::zero());
}

/// Adds the `values` of the windows, span by span, up in the DOFs' `sums`; nothing to do where there is a
/// single span.
pub(crate) fn add_up<Q: Copy + Zero>(spans: &[SpanWindow], values: &[Q], sums: &mut [Q], width: usize) {
    if spans.len() <= 1 {
        return;
    }
    sums.fill(Q::zero());
    for span in spans {
        let window = &values[span.offset * width..(span.offset + span.len) * width];
        let dofs = &mut sums[span.first * width..(span.first + span.len) * width];
        with_features(
            #[inline(always)]
            move || add(dofs, window),
        );
    }
}

#[inline(always)]
fn add<Q: Copy + Zero>(sums: &mut [Q], values: &[Q]) {
    for (sum, &value) in sums.iter_mut().zip(values) {
        *sum = *sum + value;
    }
}
