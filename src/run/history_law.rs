//! The laws of two and three dimensions whose stress follows from what a particle remembers, chosen at run time.

use nalgebra::SMatrix;

use crate::law::{
    ConstitutiveLaw, DeformationGradient, DruckerPrager, DruckerPragerState, ElasticStretch, Hencky,
    NeoHookean, NewtonianFluid, StVenantKirchhoff, VolumeRatio, VonMises, VonMisesState,
};
use crate::record::Record;
use crate::scalar::Scalar;

/// One of those laws. One type for all: another for each would multiply the steppers to compile, and they take seconds each.
/// The price is memory: a particle has room for the longest history, Drucker-Prager's eight numbers in two dimensions, and a
/// word that says whose it is.
#[derive(Clone, Copy, Debug)]
pub(super) enum HistoryLaw<T> {
    NeoHookean(NeoHookean<T>),
    StVenantKirchhoff(StVenantKirchhoff<T>),
    Hencky(Hencky<T>),
    VonMises(VonMises<T>),
    DruckerPrager(DruckerPrager<T>),
    NewtonianFluid(NewtonianFluid<T>),
}

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

/// Of each law of the enum its history. That of another law, which no particle has, counts as none.
macro_rules! each_law {
    ($($law:ident: $history:ident),+) => {
        impl<T: Scalar> HistoryLaw<T> {
            /// Carries stress and state by the law that it is, over a time if it is told.
            #[inline(always)]
            fn carry<const D: usize>(
                &self,
                dt: Option<T>,
                increment: &SMatrix<T, D, D>,
                stress: &mut SMatrix<T, D, D>,
                state: &mut History<T, D>,
            ) {
                match self {
                    $(Self::$law(law) => {
                        let mut own = match state {
                            History::$history(own) => *own,
                            _ => Default::default(),
                        };
                        match dt {
                            Some(dt) => law.update_over(dt, increment, stress, &mut own),
                            None => law.update(increment, stress, &mut own),
                        }
                        *state = History::$history(own);
                    })+
                }
            }
        }

        impl<T: Scalar, const D: usize> ConstitutiveLaw<T, D> for HistoryLaw<T> {
            type State = History<T, D>;

            #[inline(always)]
            fn large_strain(&self) -> bool {
                true
            }

            #[inline(always)]
            fn update(
                &self,
                increment: &SMatrix<T, D, D>,
                stress: &mut SMatrix<T, D, D>,
                state: &mut Self::State,
            ) {
                self.carry(None, increment, stress, state);
            }

            #[inline(always)]
            fn update_over(
                &self,
                dt: T,
                increment: &SMatrix<T, D, D>,
                stress: &mut SMatrix<T, D, D>,
                state: &mut Self::State,
            ) {
                self.carry(Some(dt), increment, stress, state);
            }

            fn start(&self, stress: &SMatrix<T, D, D>, off_plane: Option<T>) -> Option<Self::State> {
                match self {
                    $(Self::$law(law) => law.start(stress, off_plane).map(History::$history),)+
                }
            }

            fn strain_for(
                &self,
                change: &SMatrix<T, D, D>,
                density: T,
                stress: &SMatrix<T, D, D>,
                state: &Self::State,
            ) -> Option<SMatrix<T, D, D>> {
                match (self, state) {
                    $((Self::$law(law), History::$history(own)) => {
                        law.strain_for(change, density, stress, own)
                    })+
                    // Nothing has happened to it yet.
                    _ => None,
                }
            }

            fn wave_speed(&self, density: T, stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
                match (self, state) {
                    $((Self::$law(law), History::$history(own)) => law.wave_speed(density, stress, own),)+
                    $((Self::$law(law), _) => law.wave_speed(density, stress, &Default::default()),)+
                }
            }

            fn off_plane_stress(&self, stress: &SMatrix<T, D, D>, state: &Self::State) -> Option<T> {
                match (self, state) {
                    $((Self::$law(law), History::$history(own)) => {
                        ConstitutiveLaw::off_plane_stress(law, stress, own)
                    })+
                    $((Self::$law(law), _) => {
                        ConstitutiveLaw::off_plane_stress(law, stress, &Default::default())
                    })+
                }
            }

            fn plastic_strain(&self, state: &Self::State) -> Option<T> {
                match (self, state) {
                    $((Self::$law(law), History::$history(own)) => {
                        ConstitutiveLaw::<T, D>::plastic_strain(law, own)
                    })+
                    $((Self::$law(law), _) => {
                        ConstitutiveLaw::<T, D>::plastic_strain(law, &Default::default())
                    })+
                }
            }

            fn energy_density(&self, stress: &SMatrix<T, D, D>, state: &Self::State) -> T {
                match (self, state) {
                    $((Self::$law(law), History::$history(own)) => law.energy_density(stress, own),)+
                    $((Self::$law(law), _) => law.energy_density(stress, &Default::default()),)+
                }
            }
        }
    };
}

each_law!(
    NeoHookean: Gradient,
    StVenantKirchhoff: Gradient,
    Hencky: Stretch,
    VonMises: VonMises,
    DruckerPrager: DruckerPrager,
    NewtonianFluid: Volume
);
