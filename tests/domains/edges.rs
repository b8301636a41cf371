//! Edge vectors: the functions at the corners of the parallelepiped that a particle has become, averaged.

use std::array::from_fn;

use materialpoint::basis::{BasisFamily, Domain};
use materialpoint::grid::{Cell, Grid};
use materialpoint::law::ConstitutiveLaw;
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::Shepard;
use materialpoint::scalar::Scalar;
use materialpoint::stepper::{Forcing, Setup, Stepper};
use nalgebra::{DMatrix, SMatrix, SVector};

use super::bodies::{corner, particles, stepper};

/// Linear functions, the mean of those at the `2^D` corners. Along each axis the corners come so near to the
/// centre that they lie in the grid, and no further than in the next cell.
#[derive(Clone, Copy, Debug)]
pub struct Corners;

impl Corners {
    /// First of the four nodes along an axis.
    fn first(cells: usize, cell: usize) -> usize {
        cell.min((cells + 1).saturating_sub(3)).saturating_sub(1)
    }

    /// The domain about `x`, as far as it is felt.
    fn felt<T: Scalar, const D: usize>(
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        x: &SVector<T, D>,
        domain: &SMatrix<T, D, D>,
    ) -> SMatrix<T, D, D> {
        let share: [T; D] = from_fn(|a| {
            let own = cell[a] as usize;
            let low = grid.edge(a, own.saturating_sub(1));
            let high = grid.edge(a, (own + 2).min(grid.cells()[a]));
            let room = (x[a] - low).min(high - x[a]).max(T::zero());
            let reach = domain.row(a).iter().fold(T::zero(), |sum, edge| sum + edge.abs());
            if reach > room { room / reach } else { T::one() }
        });
        SMatrix::from_fn(|a, edge| domain[(a, edge)] * share[a])
    }

    /// Of a place in the cell or the next ones, relative to it, the lower node and both its functions.
    fn along<T: Scalar>(cells: usize, own: u32, unit: T) -> (usize, [T; 2]) {
        let own = own as usize;
        let (cell, u) = if unit < T::zero() && own > 0 {
            (own - 1, unit + T::one())
        } else if unit > T::one() && own + 1 < cells {
            (own + 1, unit - T::one())
        } else {
            (own, unit)
        };
        (cell, [T::one() - u, u])
    }
}

impl<T: Scalar, const D: usize> BasisFamily<T, D> for Corners {
    const DOMAIN: Domain = Domain::Edges;

    fn degree(&self) -> usize {
        1
    }

    fn reach(&self) -> usize {
        3
    }

    fn dofs(&self, grid: &Grid<T, D>) -> [usize; D] {
        grid.cells().map(|cells| cells + 1)
    }

    fn for_each(
        &self,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        x: &SVector<T, D>,
        f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        self.for_each_over(grid, cell, x, &SMatrix::zeros(), f);
    }

    fn for_each_over(
        &self,
        grid: &Grid<T, D>,
        cell: &Cell<D>,
        x: &SVector<T, D>,
        domain: &SMatrix<T, D, D>,
        mut f: impl FnMut(usize, T, SVector<T, D>),
    ) {
        let (cells, inverse) = (grid.cells(), grid.inverse_cell_size());
        let share = T::one() / T::count(1 << D);
        let felt = Self::felt(grid, cell, x, domain);
        let first: [usize; D] = from_fn(|a| Self::first(cells[a], cell[a] as usize));
        let shape: [usize; D] = from_fn(|a| (cells[a] + 1).min(4));
        for node in 0..shape.iter().product() {
            let (mut rest, mut dof, mut stride) = (node, 0, 1);
            let place: [usize; D] = from_fn(|a| {
                let along = first[a] + rest % shape[a];
                rest /= shape[a];
                dof += along * stride;
                stride *= cells[a] + 1;
                along
            });
            let (mut value, mut gradient) = (T::zero(), SVector::zeros());
            for number in 0..1 << D {
                let sides = SVector::<T, D>::from(corner::<D>(number).map(T::lit));
                let at = x + felt * sides;
                let of_axis: [(T, T); D] = from_fn(|a| {
                    let unit = (at[a] - grid.min()[a]) * inverse[a] - T::lit(f64::from(cell[a]));
                    let (low, [left, right]) = Self::along(cells[a], cell[a], unit);
                    match place[a] {
                        node if node == low => (left, -inverse[a]),
                        node if node == low + 1 => (right, inverse[a]),
                        _ => (T::zero(), T::zero()),
                    }
                });
                value += of_axis.iter().fold(share, |product, &(value, _)| product * value);
                gradient += SVector::from_fn(|a, _| {
                    of_axis
                        .iter()
                        .enumerate()
                        .fold(share, |product, (axis, &(value, slope))| {
                            product * if axis == a { slope } else { value }
                        })
                });
            }
            f(dof, value, gradient);
        }
    }
}

#[test]
fn the_corners_keep_what_a_basis_promises() {
    for cells in 1..6 {
        super::check::<f64, 1>(&Corners, [cells]);
    }
    super::check::<f64, 2>(&Corners, [5, 4]);
    super::check::<f64, 2>(&Corners, [1, 3]);
    super::check::<f64, 3>(&Corners, [3, 4, 2]);
}

/// A body without stiffness that keeps the deformation gradient.
#[derive(Clone, Copy, Debug)]
struct Dust;

#[derive(Clone, Copy, Debug)]
struct Gradient<const D: usize>(SMatrix<f64, D, D>);

impl<const D: usize> Default for Gradient<D> {
    fn default() -> Self {
        Self(SMatrix::identity())
    }
}

impl<const D: usize> ConstitutiveLaw<f64, D> for Dust {
    type State = Gradient<D>;

    fn large_strain(&self) -> bool {
        true
    }

    fn update(
        &self,
        increment: &SMatrix<f64, D, D>,
        _stress: &mut SMatrix<f64, D, D>,
        state: &mut Gradient<D>,
    ) {
        state.0 += increment * state.0;
    }

    fn wave_speed(&self, _density: f64, _stress: &SMatrix<f64, D, D>, _state: &Gradient<D>) -> f64 {
        0.0
    }

    fn energy_density(&self, _stress: &SMatrix<f64, D, D>, _state: &Gradient<D>) -> f64 {
        0.0
    }
}

/// Edges are those of the start times the deformation gradient, as their volume is, while particles change
/// their order; sizes stay.
#[test]
fn the_deformation_gradient_carries_the_edges() {
    fn run<const D: usize>(cells: usize) {
        let (grid, all) = particles::<D>(cells, 2);
        let count = all.len();
        let mut stepper = Stepper::new(Setup::new(
            grid,
            Corners,
            Shepard,
            Dust,
            OnePhase,
            all.with_states(vec![Gradient::default(); count]),
        ))
        .unwrap();
        for _ in 0..60 {
            stepper.step(0.02, &Forcing::none()).unwrap();
        }
        assert!(stepper.diagnostics().grid_crossings >= count / 2);
        let all = stepper.particles();
        let mut largest = 0.0_f64;
        for (p, edges) in all.domains.half_edges.iter().enumerate() {
            let f = all.state[p].0;
            let error = (edges - f * 0.25).norm();
            assert!(error < 1e-14, "{D}, particle {p}: {error:e}");
            let ratio = DMatrix::from_column_slice(D, D, f.as_slice()).determinant();
            let box_volume = ratio * 0.5_f64.powi(D as i32);
            assert!((all.volume[p] - box_volume).abs() < 1e-13, "{D}, particle {p}");
            largest = largest.max((f - SMatrix::identity()).norm());
        }
        assert!(largest > 0.05, "{largest}");
        let lengths = &all.domains.half_lengths;
        assert!(all.domains.half_edges.len() == count && lengths.is_empty());
    }
    run::<1>(8);
    run::<2>(7);
    run::<3>(5);
}

/// Of boxes of several shapes, each with its own.
#[test]
fn the_layout_gives_the_edges_at_the_start() {
    let edges = stepper(Corners, Shepard, particles::<2>(8, 3));
    for edges in &edges.particles().domains.half_edges {
        assert!(
            (edges - SMatrix::<f64, 2, 2>::identity() / 6.0).norm() < 1e-9,
            "{edges}"
        );
    }
}
