//! What a law bears at the start, found by asking it.

use nalgebra::SMatrix;

use super::start::starts;
use crate::law::LawSweep;
use crate::scalar::Scalar;

/// Halvings of an interval: to the last digits of a double.
const HALVINGS: usize = 60;
/// Doublings after which a law is taken to bear any stress that way.
const DOUBLINGS: usize = 60;

/// Names of the normal stresses.
const NAMES: [&str; 3] = ["xx", "yy", "zz"];

/// What `law` bears in place of a stress that it cannot start under, in words: for each normal stress the
/// range beside the others.
pub(super) fn bearable<T: Scalar, const D: usize, L: LawSweep<T, D>>(
    law: &L,
    stress: &SMatrix<T, D, D>,
    off_plane: Option<T>,
) -> String {
    let ranges: Vec<String> = (0..D)
        .filter_map(|axis| {
            let search = Search {
                law,
                stress,
                off_plane,
                axis,
            };
            let name = if const { D == 1 } {
                "a stress"
            } else {
                NAMES.get(axis)?
            };
            Some(format!("{name} {}", search.range()?))
        })
        .collect();
    if !ranges.is_empty() {
        let beside = if const { D == 1 } {
            ""
        } else {
            " beside the other components"
        };
        return format!("the law bears {}{beside}", ranges.join(", or "));
    }
    let bears = |factor: f64| {
        let mut state = vec![L::Number::default(); law.numbers()];
        starts(law, &(stress * T::lit(factor)), off_plane, &mut state)
    };
    if bears(1e-6) {
        "that is beyond its strength, whichever one of the normal stresses is changed".to_owned()
    } else if bears(-1e-6) {
        "the law bears no such tension; of a compression the normal stresses are negative".to_owned()
    } else {
        "the law starts free of stress, or under a stress of another kind".to_owned()
    }
}

/// One normal stress that is looked for.
struct Search<'a, T, const D: usize, L> {
    law: &'a L,
    stress: &'a SMatrix<T, D, D>,
    off_plane: Option<T>,
    axis: usize,
}

impl<T: Scalar, const D: usize, L: LawSweep<T, D>> Search<'_, T, D, L> {
    fn is_borne(&self, value: T) -> bool {
        let mut stress = *self.stress;
        stress[(self.axis, self.axis)] = value;
        let mut state = vec![L::Number::default(); self.law.numbers()];
        starts(self.law, &stress, self.off_plane, &mut state)
    }

    /// The range around the mean of the other normal stresses, if that is borne: strength is least where they
    /// differ most.
    fn range(&self) -> Option<String> {
        let (axis, stress) = (self.axis, self.stress);
        let others = stress.trace() - stress[(axis, axis)];
        let middle = if const { D == 1 } {
            T::zero()
        } else {
            others / T::count(D - 1)
        };
        if !self.is_borne(middle) {
            return None;
        }
        let scale = stress.iter().fold(T::zero(), |most, s| most.max(s.abs()));
        let [low, high] = [-scale, scale].map(|step| self.end(middle, step));
        let show = |value: T| format!("{:.4e} Pa", value.primal());
        Some(match (low, high) {
            (Some(low), Some(high)) if (high - low).abs() <= scale * T::lit(1e-6) => {
                format!("of {}", show(middle))
            }
            (Some(low), Some(high)) => format!("from {} to {}", show(low), show(high)),
            (Some(low), None) => format!("from {} on", show(low)),
            (None, Some(high)) => format!("up to {}", show(high)),
            (None, None) => format!("of {}", show(middle)),
        })
    }

    /// The last value that is borne from `borne` on in the direction of `step`; `None` if there seems to be
    /// no end.
    fn end(&self, mut borne: T, mut step: T) -> Option<T> {
        let mut beyond = None;
        for _ in 0..DOUBLINGS {
            let next = borne + step;
            if !self.is_borne(next) {
                beyond = Some(next);
                break;
            }
            borne = next;
            step += step;
        }
        let mut beyond = beyond?;
        for _ in 0..HALVINGS {
            let middle = (borne + beyond) / T::lit(2.0);
            match self.is_borne(middle) {
                true => borne = middle,
                false => beyond = middle,
            }
        }
        Some(borne)
    }
}
