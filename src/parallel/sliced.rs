//! What can be cut at a span.

/// Slices of equal length, or one value a span, that are cut together.
pub(crate) trait Sliced: Sized + Send {
    /// Number of items.
    fn items(&self) -> usize;

    /// The first `spans` spans, which have `items` items, and the rest.
    fn split(self, spans: usize, items: usize) -> (Self, Self);
}

impl<T: Sync> Sliced for &[T] {
    fn items(&self) -> usize {
        self.len()
    }

    fn split(self, _spans: usize, items: usize) -> (Self, Self) {
        self.split_at(items.min(self.len()))
    }
}

impl<T: Send> Sliced for &mut [T] {
    fn items(&self) -> usize {
        self.len()
    }

    fn split(self, _spans: usize, items: usize) -> (Self, Self) {
        let middle = items.min(self.len());
        self.split_at_mut(middle)
    }
}

/// A slice that there need not be.
pub(crate) struct Maybe<'a, T>(pub(crate) Option<&'a [T]>);

impl<T: Sync> Sliced for Maybe<'_, T> {
    fn items(&self) -> usize {
        self.0.map_or(0, <[T]>::len)
    }

    fn split(self, _spans: usize, items: usize) -> (Self, Self) {
        let halves = self.0.map(|values| values.split_at(items.min(values.len())));
        (
            Self(halves.map(|(left, _)| left)),
            Self(halves.map(|(_, right)| right)),
        )
    }
}

/// One value for each span.
pub(crate) struct PerSpan<'a, T>(pub(crate) &'a mut [T]);

impl<T> PerSpan<'_, T> {
    /// Sets the value of the one span that is left.
    #[inline(always)]
    pub(crate) fn set(self, value: T) {
        if let [slot, ..] = self.0 {
            *slot = value;
        }
    }
}

impl<T: Send> Sliced for PerSpan<'_, T> {
    fn items(&self) -> usize {
        0
    }

    fn split(self, spans: usize, _items: usize) -> (Self, Self) {
        let middle = spans.min(self.0.len());
        let (left, right) = self.0.split_at_mut(middle);
        (Self(left), Self(right))
    }
}

/// So many values for each item; the last one may have fewer.
pub(crate) struct Rows<'a, T> {
    pub(crate) values: &'a mut [T],
    pub(crate) width: usize,
}

impl<T: Send> Sliced for Rows<'_, T> {
    fn items(&self) -> usize {
        self.values.len().div_ceil(self.width)
    }

    fn split(self, _spans: usize, items: usize) -> (Self, Self) {
        let width = self.width;
        let (left, right) = self.values.split_at_mut(self.values.len().min(items * width));
        let part = |values| Self { values, width };
        (part(left), part(right))
    }
}

/// All of them are cut, the first one is asked for the number of items.
impl<W: Sliced + Default, const N: usize> Sliced for [W; N] {
    fn items(&self) -> usize {
        self.first().map_or(0, Sliced::items)
    }

    fn split(self, spans: usize, items: usize) -> (Self, Self) {
        let mut rest = self.map(|part| Some(part.split(spans, items)));
        let later = std::array::from_fn(|n| match rest[n].take() {
            Some((first, later)) => {
                rest[n] = Some((first, W::default()));
                later
            }
            None => W::default(),
        });
        (
            rest.map(|part| part.map_or_else(W::default, |(first, _)| first)),
            later,
        )
    }
}

/// So many values for each group of items, which are never cut.
pub(crate) struct Groups<'a, T> {
    pub(crate) values: &'a mut [T],
    /// Items of a group, and values.
    pub(crate) sizes: [usize; 2],
}

impl<T: Send> Sliced for Groups<'_, T> {
    fn items(&self) -> usize {
        0
    }

    fn split(self, _spans: usize, items: usize) -> (Self, Self) {
        let sizes = self.sizes;
        let middle = (items.div_ceil(sizes[0]) * sizes[1]).min(self.values.len());
        let (left, right) = self.values.split_at_mut(middle);
        let part = |values| Self { values, sizes };
        (part(left), part(right))
    }
}

macro_rules! tuple {
    ($($name:ident $field:tt),+) => {
        /// The first one is asked for the number of items.
        impl<$($name: Sliced),+> Sliced for ($($name,)+) {
            fn items(&self) -> usize {
                self.0.items()
            }

            fn split(self, spans: usize, items: usize) -> (Self, Self) {
                let parts = ($(self.$field.split(spans, items),)+);
                (($(parts.$field.0,)+), ($(parts.$field.1,)+))
            }
        }
    };
}

tuple!(A 0, B 1);
tuple!(A 0, B 1, C 2);
tuple!(A 0, B 1, C 2, D 3);
tuple!(A 0, B 1, C 2, D 3, E 4);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7);
