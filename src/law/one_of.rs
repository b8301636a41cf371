//! Enums of laws, which answer as the law that they are: what chooses a law at run time and must lose nothing
//! of it.

/// The state of an enum of laws, as one of its laws sees it.
pub(crate) trait Holds<S>: Sized {
    /// That of the law; `None` if nothing has happened yet.
    fn own(&self) -> Option<&S>;

    /// From that of the law.
    fn of(own: S) -> Self;
}

/// Laws without a state need none of the enum.
impl Holds<()> for () {
    #[inline(always)]
    fn own(&self) -> Option<&()> {
        Some(self)
    }

    #[inline(always)]
    fn of((): ()) -> Self {}
}

/// What `ask` makes of the law's own state, the undeformed one where nothing has happened yet.
#[inline(always)]
pub(crate) fn ask_own<S: Default, R>(state: &impl Holds<S>, ask: impl FnOnce(&S) -> R) -> R {
    match state.own() {
        Some(own) => ask(own),
        None => ask(&S::default()),
    }
}

/// Changes the law's own state.
#[inline(always)]
pub(crate) fn change_own<S: Copy + Default, H: Holds<S>>(state: &mut H, change: impl FnOnce(&mut S)) {
    let mut own = state.own().copied().unwrap_or_default();
    change(&mut own);
    *state = H::of(own);
}

/// Defines an enum of laws `Name<T>` with the given generics and dimension of its `ConstitutiveLaw`, and a
/// state that [`Holds`] that of each law. **Every** item of the trait is forwarded, those with a default too;
/// an item that the trait gains and this macro does not is an error at compile time
/// (`EVERY_ITEM_IS_FORWARDED`).
macro_rules! one_of_laws {
    (
        $(#[$meta:meta])*
        $vis:vis enum $name:ident { $($law:ident),+ $(,)? }
        impl [$($generics:tt)*] in $dimension:tt with $state:ty
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug)]
        $vis enum $name<T> {
            $($law($law<T>)),+
        }

        impl<T: $crate::scalar::Scalar, $($generics)*>
            $crate::law::ConstitutiveLaw<T, $dimension> for $name<T> {
            type State = $state;

            fn limits(&self) -> &'static str {
                match self {
                    $(Self::$law(law) => $crate::law::ConstitutiveLaw::<T, $dimension>::limits(law)),+
                }
            }

            #[inline(always)]
            fn knows(
                &self,
                stress: &::nalgebra::SMatrix<T, $dimension, $dimension>,
                state: &Self::State,
            ) -> bool {
                match self {
                    $(Self::$law(law) => $crate::law::one_of::ask_own(state, |own| law.knows(stress, own))),+
                }
            }

            #[inline(always)]
            fn large_strain(&self) -> bool {
                match self {
                    $(Self::$law(law) => $crate::law::ConstitutiveLaw::<T, $dimension>::large_strain(law)),+
                }
            }

            #[inline(always)]
            fn update(
                &self,
                increment: &::nalgebra::SMatrix<T, $dimension, $dimension>,
                stress: &mut ::nalgebra::SMatrix<T, $dimension, $dimension>,
                state: &mut Self::State,
            ) {
                match self {
                    $(Self::$law(law) => {
                        $crate::law::one_of::change_own(state, |own| law.update(increment, stress, own));
                    })+
                }
            }

            #[inline(always)]
            fn update_over(
                &self,
                dt: T,
                increment: &::nalgebra::SMatrix<T, $dimension, $dimension>,
                stress: &mut ::nalgebra::SMatrix<T, $dimension, $dimension>,
                state: &mut Self::State,
            ) {
                match self {
                    $(Self::$law(law) => {
                        $crate::law::one_of::change_own(state, |own| {
                            law.update_over(dt, increment, stress, own);
                        });
                    })+
                }
            }

            fn start(
                &self,
                stress: &::nalgebra::SMatrix<T, $dimension, $dimension>,
                off_plane: Option<T>,
            ) -> Option<Self::State> {
                match self {
                    $(Self::$law(law) => law.start(stress, off_plane).map($crate::law::one_of::Holds::of)),+
                }
            }

            fn elastic_constants(&self) -> Option<$crate::law::Moduli<T>> {
                match self {
                    $(Self::$law(law) => {
                        $crate::law::ConstitutiveLaw::<T, $dimension>::elastic_constants(law)
                    })+
                }
            }

            fn strain_for(
                &self,
                change: &::nalgebra::SMatrix<T, $dimension, $dimension>,
                density: T,
                stress: &::nalgebra::SMatrix<T, $dimension, $dimension>,
                state: &Self::State,
            ) -> Option<::nalgebra::SMatrix<T, $dimension, $dimension>> {
                match self {
                    $(Self::$law(law) => {
                        $crate::law::one_of::ask_own(state, |own| {
                            law.strain_for(change, density, stress, own)
                        })
                    })+
                }
            }

            fn wave_speed(
                &self,
                density: T,
                stress: &::nalgebra::SMatrix<T, $dimension, $dimension>,
                state: &Self::State,
            ) -> T {
                match self {
                    $(Self::$law(law) => {
                        $crate::law::one_of::ask_own(state, |own| law.wave_speed(density, stress, own))
                    })+
                }
            }

            fn off_plane_stress(
                &self,
                stress: &::nalgebra::SMatrix<T, $dimension, $dimension>,
                state: &Self::State,
            ) -> Option<T> {
                match self {
                    $(Self::$law(law) => {
                        $crate::law::one_of::ask_own(state, |own| {
                            $crate::law::ConstitutiveLaw::off_plane_stress(law, stress, own)
                        })
                    })+
                }
            }

            fn plastic_strain(&self, state: &Self::State) -> Option<T> {
                match self {
                    $(Self::$law(law) => $crate::law::one_of::ask_own(state, |own| {
                        $crate::law::ConstitutiveLaw::<T, $dimension>::plastic_strain(law, own)
                    })),+
                }
            }

            fn energy_density(
                &self,
                stress: &::nalgebra::SMatrix<T, $dimension, $dimension>,
                state: &Self::State,
            ) -> T {
                match self {
                    $(Self::$law(law) => {
                        $crate::law::one_of::ask_own(state, |own| law.energy_density(stress, own))
                    })+
                }
            }
        }
    };
}
pub(crate) use one_of_laws;

/// An implementation has no items but its trait's, so as many of them are all of them.
const EVERY_ITEM_IS_FORWARDED: () = assert!(
    items(include_bytes!("mod.rs"), b"pub trait ConstitutiveLaw<")
        == items(
            include_bytes!("one_of.rs"),
            b"ConstitutiveLaw<T, $dimension> for $name<T> {"
        ),
    "`one_of_laws!` must forward every item of `ConstitutiveLaw`, also those that have a default"
);
const _: () = EVERY_ITEM_IS_FORWARDED;

/// Number of lines that begin a function, type or constant, from the line that holds `head` to the line that
/// closes its block.
const fn items(text: &[u8], head: &[u8]) -> usize {
    let mut at = 0;
    while !starts_with(text, at, head) {
        at += 1;
    }
    while text[at] != b'\n' {
        at += 1;
    }
    let (mut count, mut depth) = (0, 1);
    while depth > 0 {
        // At a line's end: what does the next one begin with?
        at += 1;
        while text[at] == b' ' {
            at += 1;
        }
        let begins = starts_with(text, at, b"fn ")
            || starts_with(text, at, b"type ")
            || starts_with(text, at, b"const ");
        if begins && depth == 1 {
            count += 1;
        }
        let comment = starts_with(text, at, b"//");
        while text[at] != b'\n' {
            if !comment && text[at] == b'{' {
                depth += 1;
            }
            if !comment && text[at] == b'}' {
                depth -= 1;
            }
            at += 1;
        }
    }
    count
}

/// Whether `text` has `word` at a place.
const fn starts_with(text: &[u8], at: usize, word: &[u8]) -> bool {
    let mut k = 0;
    while k < word.len() {
        if at + k >= text.len() || text[at + k] != word[k] {
            return false;
        }
        k += 1;
    }
    true
}
