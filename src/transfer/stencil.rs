//! The functions at a point, looked up out of line: what sweeps do where no packs serve.
//!
//! Point by point a sweep is one of those that few machines take. Functions that are looked up within it
//! would be compiled into each sweep once more, for every basis; so they are looked up by a function of their
//! own, compiled once for a basis, and the sweep goes over what that found.

use nalgebra::SVector;

use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::particles::{DomainViews, Domains};
use crate::scalar::Scalar;

/// Functions that are found at once: those of a cell of cubic B-splines in three dimensions.
const AT_ONCE: usize = 64;

/// Whose functions are looked up: those of a particle, which is given by its number; those at a point that
/// moves as particles do, or at one that stands still.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Seer {
    Particle(usize),
    Moving,
    Fixed,
}

/// DOFs that a point sees, with values and gradients of their functions.
pub(crate) struct Stencil<T, const D: usize> {
    dofs: [usize; AT_ONCE],
    values: [T; AT_ONCE],
    gradients: [SVector<T, D>; AT_ONCE],
}

/// A way to look functions up.
pub(crate) trait Look<T: Scalar, const D: usize> {
    /// Calls `f(dof, phi, grad phi)` for the DOFs that are seen from `x` of `cell`.
    fn for_each<B: BasisFamily<T, D>>(
        &mut self,
        space: (&B, &Grid<T, D>),
        domains: &DomainViews<'_, T, D>,
        seer: Seer,
        place: (&Cell<D>, &SVector<T, D>),
        f: impl FnMut(usize, T, SVector<T, D>),
    );

    /// Calls `f([i, j], [phi_i, phi_j])` for each pair of the DOFs that are seen from a point that is no
    /// particle, `j <= i`.
    fn for_each_pair<B: BasisFamily<T, D>>(
        &mut self,
        space: (&B, &Grid<T, D>),
        seer: Seer,
        place: (&Cell<D>, &SVector<T, D>),
        f: impl FnMut([usize; 2], [T; 2]),
    );
}

/// Within the sweep: for those that steps usually take.
pub(crate) struct Here;

impl<T: Scalar, const D: usize> Look<T, D> for Here {
    #[inline(always)]
    fn for_each<B: BasisFamily<T, D>>(
        &mut self,
        (basis, grid): (&B, &Grid<T, D>),
        domains: &DomainViews<'_, T, D>,
        seer: Seer,
        (cell, x): (&Cell<D>, &SVector<T, D>),
        f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        match seer {
            Seer::Particle(p) => domains.for_each((basis, grid), p, (cell, x), f),
            Seer::Moving => basis.for_each(grid, cell, x, f),
            Seer::Fixed => basis.for_each_at_fixed_point(grid, cell, x, f),
        }
    }

    #[inline(always)]
    fn for_each_pair<B: BasisFamily<T, D>>(
        &mut self,
        space: (&B, &Grid<T, D>),
        seer: Seer,
        place: (&Cell<D>, &SVector<T, D>),
        mut f: impl FnMut([usize; 2], [T; 2]),
    ) {
        each_seen(space, seer, place, |i, phi| {
            each_seen(space, seer, place, |j, other| {
                if j <= i {
                    f([i, j], [phi, other]);
                }
            });
        });
    }
}

impl<T: Scalar, const D: usize> Stencil<T, D> {
    /// Of no point yet.
    pub(crate) fn new() -> Self {
        Self {
            dofs: [0; AT_ONCE],
            values: [T::zero(); AT_ONCE],
            gradients: [SVector::zeros(); AT_ONCE],
        }
    }
}

/// Out of line. A basis that is no product is asked within the sweep: point by point is the only way that it
/// knows.
impl<T: Scalar, const D: usize> Look<T, D> for Stencil<T, D> {
    #[inline(always)]
    fn for_each<B: BasisFamily<T, D>>(
        &mut self,
        (basis, grid): (&B, &Grid<T, D>),
        domains: &DomainViews<'_, T, D>,
        seer: Seer,
        (cell, x): (&Cell<D>, &SVector<T, D>),
        f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        if const { B::WIDTH == 0 } {
            return Here.for_each((basis, grid), domains, seer, (cell, x), f);
        }
        self.for_each_found(
            #[inline(always)]
            |stencil, skip| look_up(stencil, (basis, grid), domains, seer, (cell, x), skip),
            f,
        );
    }

    #[inline(always)]
    fn for_each_pair<B: BasisFamily<T, D>>(
        &mut self,
        (basis, grid): (&B, &Grid<T, D>),
        seer: Seer,
        (cell, x): (&Cell<D>, &SVector<T, D>),
        mut f: impl FnMut([usize; 2], [T; 2]),
    ) {
        if const { B::WIDTH == 0 } {
            return Here.for_each_pair((basis, grid), seer, (cell, x), f);
        }
        let none = Domains::none();
        let none = none.views();
        // The functions of a product are few enough to be found at once.
        let count = look_up(self, (basis, grid), &none, seer, (cell, x), 0).min(AT_ONCE);
        for n in 0..count {
            for m in 0..count {
                if self.dofs[m] <= self.dofs[n] {
                    f([self.dofs[n], self.dofs[m]], [self.values[n], self.values[m]]);
                }
            }
        }
    }
}

impl<T: Scalar, const D: usize> Stencil<T, D> {
    /// Calls `f(dof, phi, grad phi)` for the functions that `look_up` finds: all but so many first ones, as far as there is room;
    /// returns how many there are.
    #[inline(always)]
    pub(crate) fn for_each_found(
        &mut self,
        look_up: impl Fn(&mut Self, usize) -> usize,
        mut f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        let mut skip = 0;
        loop {
            let rest = look_up(self, skip).saturating_sub(skip);
            for n in 0..rest.min(AT_ONCE) {
                f(self.dofs[n], self.values[n], self.gradients[n]);
            }
            if rest <= AT_ONCE {
                return;
            }
            skip += AT_ONCE;
        }
    }
}

/// Calls `f(dof, phi)` for the DOFs that a point that is no particle sees.
#[inline(always)]
fn each_seen<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    (basis, grid): (&B, &Grid<T, D>),
    seer: Seer,
    (cell, x): (&Cell<D>, &SVector<T, D>),
    mut f: impl FnMut(usize, T),
) {
    match seer {
        Seer::Fixed => basis.for_each_at_fixed_point(grid, cell, x, |dof, phi, _| f(dof, phi)),
        _ => basis.for_each(grid, cell, x, |dof, phi, _| f(dof, phi)),
    }
}

/// Finds the functions but so many first ones; returns how many there are.
#[inline(never)]
pub(crate) fn look_up<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    stencil: &mut Stencil<T, D>,
    (basis, grid): (&B, &Grid<T, D>),
    domains: &DomainViews<'_, T, D>,
    seer: Seer,
    (cell, x): (&Cell<D>, &SVector<T, D>),
    skip: usize,
) -> usize {
    let mut count = 0_usize;
    let found = |dof: usize, phi: T, gradient: SVector<T, D>| {
        if let Some(place) = count.checked_sub(skip).filter(|&place| place < AT_ONCE) {
            stencil.dofs[place] = dof;
            stencil.values[place] = phi;
            stencil.gradients[place] = gradient;
        }
        count += 1;
    };
    match seer {
        Seer::Particle(p) => domains.for_each((basis, grid), p, (cell, x), found),
        Seer::Moving => basis.for_each(grid, cell, x, found),
        Seer::Fixed => basis.for_each_at_fixed_point(grid, cell, x, found),
    }
    count
}

#[cfg(test)]
mod tests {
    use nalgebra::vector;

    use super::*;
    use crate::basis::{BSpline, DualDomain};

    type Seen = Vec<(usize, f64, SVector<f64, 2>)>;

    fn seen<B: BasisFamily<f64, 2>>(mut look: impl Look<f64, 2>, basis: &B, seer: Seer) -> [Seen; 2] {
        let grid = Grid::new(vector![0.0, 0.0], vector![5.0, 4.0], [5, 4]).unwrap();
        let none = Domains::none();
        let place = (&[3, 1], &vector![3.3, 1.8]);
        let (mut functions, mut pairs) = (Vec::new(), Vec::new());
        look.for_each(
            (basis, &grid),
            &none.views(),
            seer,
            place,
            |dof, phi, gradient| {
                functions.push((dof, phi, gradient));
            },
        );
        look.for_each_pair((basis, &grid), seer, place, |[i, j], [phi, other]| {
            pairs.push((i * 1000 + j, phi * other, vector![phi, other]));
        });
        [functions, pairs]
    }

    #[test]
    fn functions_are_the_same_wherever_they_are_looked_up() {
        for seer in [Seer::Moving, Seer::Fixed] {
            assert_eq!(
                seen(Here, &BSpline::<2>, seer),
                seen(Stencil::new(), &BSpline::<2>, seer)
            );
            let basis = DualDomain::new();
            let [functions, pairs] = seen(Stencil::new(), &basis, seer);
            assert_eq!([&functions, &pairs], seen(Here, &basis, seer).each_ref());
            // Half of all pairs, and each function with itself.
            let count = functions.len();
            assert_eq!(pairs.len(), count * (count + 1) / 2);
        }
    }

    #[test]
    fn more_functions_than_there_is_room_for_come_in_parts() {
        for count in [0, 1, AT_ONCE, AT_ONCE + 1, 2 * AT_ONCE, 150] {
            let look_up = |stencil: &mut Stencil<f64, 1>, skip: usize| {
                for n in skip..count.min(skip + AT_ONCE) {
                    stencil.dofs[n - skip] = n;
                    stencil.values[n - skip] = n as f64;
                }
                count
            };
            let mut found = Vec::new();
            Stencil::new().for_each_found(look_up, |dof, phi, _| found.push((dof, phi)));
            let expected: Vec<_> = (0..count).map(|n| (n, n as f64)).collect();
            assert_eq!(found, expected);
        }
    }
}
