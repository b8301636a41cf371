//! The laws of two and three dimensions whose stress follows from what a particle remembers, chosen at run time.

use crate::law::one_of::{Holds, one_of_laws};
use crate::law::{
    DeformationGradient, DruckerPrager, DruckerPragerState, ElasticStretch, Hencky, NeoHookean,
    NewtonianFluid, StVenantKirchhoff, VolumeRatio, VonMises, VonMisesState,
};
use crate::record::Record;
use crate::scalar::Scalar;

one_of_laws!(
    /// One of those laws. One type for all: another for each would multiply the steppers to compile, and they
    /// take seconds each. The price is memory: a particle has room for the longest history, Drucker-Prager's
    /// eight numbers in two dimensions, and a word that says whose it is.
    pub(super) enum HistoryLaw {
        NeoHookean,
        StVenantKirchhoff,
        Hencky,
        VonMises,
        DruckerPrager,
        NewtonianFluid,
    }
    impl [const D: usize] in D with History<T, D>
);

/// What a particle remembers: of its own law, or nothing yet.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum History<T, const D: usize> {
    #[default]
    None,
    Gradient(DeformationGradient<T, D>),
    Stretch(ElasticStretch<T, D>),
    VonMises(VonMisesState<T, D>),
    DruckerPrager(DruckerPragerState<T, D>),
    Volume(VolumeRatio<T>),
}

/// The first number says whose history follows.
impl<T: Scalar, const D: usize> Record<T> for History<T, D> {
    fn put(&self, out: &mut impl FnMut(T)) {
        let mut whose = |number: u8| out(T::lit(f64::from(number)));
        match self {
            Self::None => whose(0),
            Self::Gradient(own) => {
                whose(1);
                own.put(out);
            }
            Self::Stretch(own) => {
                whose(2);
                own.put(out);
            }
            Self::VonMises(own) => {
                whose(3);
                own.put(out);
            }
            Self::DruckerPrager(own) => {
                whose(4);
                own.put(out);
            }
            Self::Volume(own) => {
                whose(5);
                own.put(out);
            }
        }
    }

    fn take(from: &mut impl FnMut() -> T) -> Option<Self> {
        let whose = from().primal();
        match (0..=5_u8).find(|&number| f64::from(number) == whose)? {
            0 => Some(Self::None),
            1 => Record::take(from).map(Self::Gradient),
            2 => Record::take(from).map(Self::Stretch),
            3 => Record::take(from).map(Self::VonMises),
            4 => Record::take(from).map(Self::DruckerPrager),
            _ => Record::take(from).map(Self::Volume),
        }
    }
}

/// Each law's own history. That of another law, which no particle has, counts as none.
macro_rules! holds {
    ($($variant:ident: $own:ty),+ $(,)?) => {
        $(impl<T: Scalar, const D: usize> Holds<$own> for History<T, D> {
            #[inline(always)]
            fn own(&self) -> Option<&$own> {
                match self {
                    Self::$variant(own) => Some(own),
                    _ => None,
                }
            }

            #[inline(always)]
            fn of(own: $own) -> Self {
                Self::$variant(own)
            }
        })+
    };
}

holds!(
    Gradient: DeformationGradient<T, D>,
    Stretch: ElasticStretch<T, D>,
    VonMises: VonMisesState<T, D>,
    DruckerPrager: DruckerPragerState<T, D>,
    Volume: VolumeRatio<T>,
);
