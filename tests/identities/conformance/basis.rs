//! Basis families.

use std::ops::Range;

use materialpoint::basis::{
    AxisBasis, AxisCell, BSpline, BasisFamily, DualDomain, FixedPoints, Functions, Linear, tensor,
};
use materialpoint::grid::{Cell, Face, Grid};
use materialpoint::scalar::Scalar;
use materialpoint::simd::{Lanes, One};
use materialpoint::testing::{BasisClaims, Expected, Failure, Property, check_basis};
use nalgebra::{SVector, vector};

use super::{Planted, planted};

/// Places within a cell: edges, middle, and some others.
const UNITS: [f64; 6] = [0.0, 0.125, 0.4, 0.5, 0.93, 1.0];

fn grid<T: Scalar, const D: usize>(cells: usize) -> Grid<T, D> {
    let min = SVector::repeat(T::lit(-0.7));
    let cells = std::array::from_fn(|a| (cells - a.min(cells - 1)).max(1));
    Grid::new(min, SVector::from_fn(|a, _| T::lit(1.9) + T::count(a)), cells).unwrap()
}

fn points<T: Scalar, const D: usize>(grid: &Grid<T, D>) -> Vec<SVector<T, D>> {
    let mut points = Vec::new();
    for number in 0..grid.cell_count() {
        let cell = grid.cell(number);
        for k in 0..UNITS.len() {
            points.push(SVector::from_fn(|a, _| {
                let (low, high) = (grid.edge(a, cell[a] as usize), grid.edge(a, cell[a] as usize + 1));
                (low + (high - low) * T::lit(UNITS[(k + 2 * a) % UNITS.len()])).min(high)
            }));
        }
    }
    points
}

/// The smoothed gradients; on a single cell there is nothing to smooth, and they are the linear ones.
fn dual_domain(cells: usize) -> BasisClaims {
    BasisClaims {
        gradients_are_derivatives: cells == 1,
        ..BasisClaims::of_degree(1)
    }
}

fn families<T: Scalar, const D: usize>(cells: usize) -> Result<(), Failure>
where
    BSpline<2>: BasisFamily<T, D>,
    BSpline<3>: BasisFamily<T, D>,
{
    let grid = grid::<T, D>(cells);
    let points = points(&grid);
    check_basis(&Linear, &grid, &points, &BasisClaims::of_degree(1))?;
    check_basis(&DualDomain::new(), &grid, &points, &dual_domain(cells))?;
    check_basis(&BSpline::<2>, &grid, &points, &BasisClaims::of_degree(2))?;
    check_basis(&BSpline::<3>, &grid, &points, &BasisClaims::of_degree(3))
}

#[test]
fn our_families_keep_their_claims() -> Result<(), Failure> {
    (1..7).try_for_each(families::<f64, 1>)?;
    (1..5).try_for_each(families::<f64, 2>)?;
    (2..4).try_for_each(families::<f64, 3>)
}

/// On more cells the fourth power is so nearly a cubic spline that round-off hides the difference.
#[test]
fn our_families_keep_their_claims_in_single_precision() -> Result<(), Failure> {
    (1..4).try_for_each(families::<f32, 1>)?;
    (1..3).try_for_each(families::<f32, 2>)
}

/// The property that `check_basis` finds violated on a line of `cells` cells.
fn verdict(basis: &impl BasisFamily<f64, 1>, claims: &BasisClaims) -> Option<Property> {
    let grid = grid::<f64, 1>(5);
    check_basis(basis, &grid, &points(&grid), claims)
        .err()
        .map(|failure| failure.property)
}

#[test]
fn claims_that_are_too_bold_or_too_shy_are_found() {
    let honest = BasisClaims::of_degree(2);
    let verdict = |claims| verdict(&BSpline::<2>, &claims);
    assert_eq!(verdict(honest), None);
    let with = |reproduces| BasisClaims { reproduces, ..honest };
    assert_eq!(verdict(with(1)), Some(Property::Reproduces(2)));
    assert_eq!(verdict(with(3)), Some(Property::Reproduces(3)));
    let shy = BasisClaims {
        gradients_are_derivatives: false,
        ..honest
    };
    assert_eq!(verdict(shy), Some(Property::GradientsAreDerivatives));
    let shy = BasisClaims {
        gradient_reproduces_linear: false,
        ..honest
    };
    assert_eq!(verdict(shy), Some(Property::GradientOfLinearField));
    let shy = BasisClaims {
        fixed_point_gradients_are_derivatives: false,
        ..honest
    };
    assert_eq!(verdict(shy), Some(Property::FixedPointGradients));
    // Dual domain's gradients are no derivatives.
    let bold = self::verdict(&DualDomain::new(), &BasisClaims::of_degree(1));
    assert_eq!(bold, Some(Property::GradientsAreDerivatives));
}

/// One mistake in a family that is otherwise dual domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mistake {
    /// Central difference at the ends too, as if the next node lay outside.
    CentralAtEnds,
    /// The slopes of a whole end are left out on one side only.
    OneSidedSum,
    /// Values scaled.
    NoUnity,
    /// A value that dips below zero, its neighbour above one.
    Negative,
    /// A DOF beyond the last.
    Range,
    /// A DOF that no point reaches.
    Unreached,
    /// Mass reaches farther than the degree says.
    Band,
    /// Half a cell's shift: a face sees its neighbours.
    Face,
    /// Other values at points that stand still.
    FixedValues,
    /// Two DOFs change places in the right half of a cell.
    Order,
    /// A window that ends before the last DOF of a cell.
    Window,
}

#[derive(Clone, Copy, Debug)]
struct Faulty(Mistake);

/// The functions of one cell, with their DOFs.
struct Row {
    dof: [usize; 4],
    value: [f64; 4],
    slope: [f64; 4],
}

impl Faulty {
    fn dofs_on_axis(&self, cells: usize) -> usize {
        cells + 1 + usize::from(self.0 == Mistake::Unreached)
    }

    /// Dual domain of the four nodes about a cell, at an end with a node named twice, and with the mistake.
    fn row(&self, cells: usize, cell: usize, unit: f64) -> Row {
        let mut row = Row {
            dof: [cell.saturating_sub(1), cell, cell + 1, (cell + 2).min(cells)],
            value: [0.0; 4],
            slope: [0.0; 4],
        };
        let (basis, at) = (DualDomain::new(), AxisCell { cells, cell });
        let first = AxisBasis::<f64, 4>::first_dof(&basis, at);
        let functions = basis.evaluate(One, at, unit);
        for k in 0..4 {
            // Nodes that the functions of the cell begin before it at an end have no part in it.
            let place = (first + k + 1).wrapping_sub(cell);
            if place < 4 {
                row.value[place] = functions.value[k];
                row.slope[place] = functions.slope[k];
            }
        }
        let smooth = (1.0 - 2.0 * unit * (1.0 - unit)) * (1.0 - unit);
        match self.0 {
            Mistake::CentralAtEnds if cell == 0 => {
                row.slope[1] += smooth / 2.0;
                row.slope[2] -= smooth / 2.0;
            }
            Mistake::OneSidedSum if cell == 0 => row.slope[1] += smooth / 2.0,
            Mistake::NoUnity => row.value[1] *= 1.0 + 1e-9,
            Mistake::Negative if cell == 1 => {
                row.value[0] -= 1e-9;
                row.value[1] += 1e-9;
            }
            Mistake::Order if unit > 0.5 => {
                row.dof.swap(1, 2);
                row.value.swap(1, 2);
                row.slope.swap(1, 2);
            }
            Mistake::Range if cell + 1 == cells => row.dof[3] = cells + 1,
            Mistake::Band if cell > 0 && cell + 1 < cells => {
                row.value[0] += 1e-3;
                row.value[1] *= 1.0 - 2e-3 / row.value[1].max(2e-3);
                row.value[3] += 1.0 - row.value.iter().sum::<f64>();
            }
            Mistake::Face => {
                let moved = 0.1 * row.value[1];
                row.value[1] -= moved;
                row.value[2] += moved;
            }
            _ => {}
        }
        row
    }
}

impl BasisFamily<f64, 1> for Faulty {
    const AT_FIXED_POINTS: FixedPoints = FixedPoints::Other;

    fn degree(&self) -> usize {
        1
    }

    fn dofs(&self, grid: &Grid<f64, 1>) -> [usize; 1] {
        [self.dofs_on_axis(grid.cells()[0])]
    }

    fn for_each(
        &self,
        grid: &Grid<f64, 1>,
        cell: &Cell<1>,
        x: &SVector<f64, 1>,
        mut f: impl FnMut(usize, f64, SVector<f64, 1>),
    ) {
        let unit = grid.unit_coordinate(0, cell[0], x[0]);
        let row = self.row(grid.cells()[0], cell[0] as usize, unit);
        for k in 0..4 {
            let slope = row.slope[k] * grid.inverse_cell_size()[0];
            f(row.dof[k], row.value[k], SVector::from([slope]));
        }
    }

    fn for_each_at_fixed_point(
        &self,
        grid: &Grid<f64, 1>,
        cell: &Cell<1>,
        x: &SVector<f64, 1>,
        f: impl FnMut(usize, f64, SVector<f64, 1>),
    ) {
        match self.0 {
            Mistake::FixedValues => Linear.for_each(grid, &[cell[0].min(2)], x, f),
            Mistake::Face => self.for_each(grid, cell, x, f),
            _ => Linear.for_each(grid, cell, x, f),
        }
    }

    fn dof_window(&self, grid: &Grid<f64, 1>, first: &Cell<1>, last: &Cell<1>) -> Range<usize> {
        let window = tensor::dof_window(self, grid, first, last);
        window.start..window.end - usize::from(self.0 == Mistake::Window)
    }

    fn for_each_on_face(&self, grid: &Grid<f64, 1>, face: Face, f: impl FnMut(usize)) {
        Linear.for_each_on_face(grid, face, f);
    }
}

const MISTAKES: [(Mistake, Property); 11] = [
    (Mistake::CentralAtEnds, Property::GradientOfLinearField),
    (Mistake::OneSidedSum, Property::GradientSum),
    (Mistake::NoUnity, Property::PartitionOfUnity),
    (Mistake::Negative, Property::NonNegative),
    (Mistake::Range, Property::DofInRange),
    (Mistake::Unreached, Property::EveryDofReached),
    (Mistake::Band, Property::HalfBand),
    (Mistake::Face, Property::FaceValues),
    (Mistake::FixedValues, Property::FixedPointValues),
    (Mistake::Order, Property::SameDofsInCell),
    (Mistake::Window, Property::DofWindow),
];

/// All mistakes of this file.
pub(super) fn mistakes() -> Vec<Planted> {
    let line = |mistake| verdict(&Faulty(mistake), &dual_domain(5));
    let lanes = |lanes| verdict(&Fast(lanes), &BasisClaims::of_degree(1));
    let fixed = |fixed| verdict(&Silent(DualDomain::new(), fixed), &dual_domain(5));
    let mut all = planted("family", MISTAKES, line);
    all.extend(planted("lanes", LANES, lanes));
    all.extend(planted("fixed points", FIXED, fixed));
    all.extend(planted("axis", SLIPS, slip));
    all.extend(planted("plane", IN_PLANE, in_plane));
    all
}

/// The mistake at the ends is one of a claim: with the claim withdrawn, the family passes.
#[test]
fn central_differences_at_the_ends_only_lose_the_gradient_of_linear_fields() {
    let claims = BasisClaims {
        gradient_reproduces_linear: false,
        ..dual_domain(5)
    };
    assert_eq!(verdict(&Faulty(Mistake::CentralAtEnds), &claims), None);
}

#[test]
fn a_failure_says_what_where_and_by_how_much() {
    let grid = grid::<f64, 1>(5);
    let failure =
        check_basis(&Faulty(Mistake::NoUnity), &grid, &[vector![0.0]], &dual_domain(5)).unwrap_err();
    assert!(matches!(failure.expected, Expected::Near { value: 1.0, allowed } if allowed < 1e-12));
    assert!((failure.found - 1.0).abs() > 1e-11);
    let text = failure.to_string();
    assert!(
        text.starts_with("values sum to one, at [0.0]: expected 1e0 within"),
        "{text}"
    );
    let outside = check_basis(&Linear, &grid, &[vector![9.0]], &BasisClaims::of_degree(1)).unwrap_err();
    assert_eq!(outside.property, Property::PointsInGrid);
}

/// What the fast ways of a uniform family can get wrong, in ways that the slow ones do not see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mistaken {
    Right,
    /// The slopes have the other sign.
    Slope,
    /// The values of the first two functions change places.
    Value,
    /// Every point is taken for the first one.
    Neighbour,
}

/// Hats with lanes of their own.
#[derive(Clone, Copy, Debug)]
struct Fast(Mistaken);

impl<T: Scalar> AxisBasis<T, 2> for Fast {
    fn dofs_on_axis(&self, cells: usize) -> usize {
        cells + 1
    }

    /// Right at the first of the points; a single one is.
    fn evaluate<K: Lanes<T>>(&self, k: K, _at: AxisCell, unit: K::V) -> Functions<K::V, 2> {
        let (one, mut first) = (T::one(), None);
        let [value, slope] = k.one_by_one(unit, |unit| {
            let (value, slope) = ([one - unit, unit], [-one, one]);
            let Some(first) = first else {
                first = Some(unit);
                return [value, slope];
            };
            match self.0 {
                Mistaken::Right => [value, slope],
                Mistaken::Slope => [value, [one, -one]],
                Mistaken::Value => [[unit, one - unit], slope],
                Mistaken::Neighbour => [[one - first, first], slope],
            }
        });
        Functions { value, slope }
    }
}

materialpoint::tensor_product_family!(Fast, width = 2, degree = 1);

const LANES: [(Mistaken, Property); 3] = [
    (Mistaken::Slope, Property::Factors),
    (Mistaken::Value, Property::Factors),
    (Mistaken::Neighbour, Property::Factors),
];

#[test]
fn lanes_that_say_something_else_than_rows_are_found_in_the_plane_too() {
    let wrong = LANES.map(|(lanes, property)| (lanes, Some(property)));
    for (lanes, expected) in [(Mistaken::Right, None)].into_iter().chain(wrong) {
        let claims = BasisClaims::of_degree(1);
        let plane = grid::<f64, 2>(3);
        let found = check_basis(&Fast(lanes), &plane, &points(&plane), &claims);
        assert_eq!(found.err().map(|failure| failure.property), expected, "{lanes:?}");
    }
    assert_eq!(verdict(&Fast(Mistaken::Right), &BasisClaims::of_degree(1)), None);
}

/// What a family says of points that stand still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Said {
    /// Nothing, so that four cells at once would see the functions of points that move.
    Nothing,
}

const FIXED: [(Said, Property); 1] = [(Said::Nothing, Property::FixedPointsAsSaid)];

/// Dual domain with other functions at points that stand still.
#[derive(Clone, Debug)]
struct Silent(DualDomain, Said);

impl BasisFamily<f64, 1> for Silent {
    fn degree(&self) -> usize {
        1
    }

    fn dofs(&self, grid: &Grid<f64, 1>) -> [usize; 1] {
        self.0.dofs(grid)
    }

    fn for_each(
        &self,
        grid: &Grid<f64, 1>,
        cell: &Cell<1>,
        x: &SVector<f64, 1>,
        f: impl FnMut(usize, f64, SVector<f64, 1>),
    ) {
        self.0.for_each(grid, cell, x, f);
    }

    fn for_each_at_fixed_point(
        &self,
        grid: &Grid<f64, 1>,
        cell: &Cell<1>,
        x: &SVector<f64, 1>,
        f: impl FnMut(usize, f64, SVector<f64, 1>),
    ) {
        match self.1 {
            Said::Nothing => Linear.for_each(grid, cell, x, f),
        }
    }
}

/// Slips in a family of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slip {
    Right,
    /// Slopes by a coordinate that runs from -1 to 1.
    HalfSlope,
    /// Slopes with the sign of the other end.
    SlopeSign,
    /// The last cell begins at the DOF before its own.
    FirstDofAtEnd,
    /// An inner cell does.
    FirstDofInside,
    /// Every cell has DOFs of its own.
    OwnDofs,
    /// The coordinate runs the other way.
    Mirrored,
    /// Values weighed by the square of the distance, which sum to one no more.
    Squares,
}

const SLIPS: [(Slip, Property); 7] = [
    (Slip::HalfSlope, Property::GradientsAreDerivatives),
    (Slip::SlopeSign, Property::GradientsAreDerivatives),
    (Slip::FirstDofAtEnd, Property::Continuous),
    (Slip::FirstDofInside, Property::Continuous),
    (Slip::OwnDofs, Property::Continuous),
    (Slip::Mirrored, Property::Continuous),
    (Slip::Squares, Property::PartitionOfUnity),
];

/// Hats with a slip, alike for single points and for several.
#[derive(Clone, Copy, Debug)]
struct Hats(Slip);

impl<T: Scalar> AxisBasis<T, 2> for Hats {
    fn dofs_on_axis(&self, cells: usize) -> usize {
        if self.0 == Slip::OwnDofs {
            2 * cells
        } else {
            cells + 1
        }
    }

    fn first_dof(&self, at: AxisCell) -> usize {
        match self.0 {
            Slip::FirstDofAtEnd if at.cell + 1 == at.cells => at.cell - 1,
            Slip::FirstDofInside if at.cell == 2 => 1,
            Slip::OwnDofs => 2 * at.cell,
            _ => at.cell,
        }
    }

    fn evaluate<K: Lanes<T>>(&self, k: K, _at: AxisCell, unit: K::V) -> Functions<K::V, 2> {
        let (zero, one) = (k.splat(T::zero()), k.splat(T::one()));
        let half = k.splat(T::lit(0.5));
        let (value, slope) = ([one - unit, unit], [zero - one, one]);
        let (value, slope) = match self.0 {
            Slip::HalfSlope => (value, [zero - half, half]),
            Slip::SlopeSign => (value, [one, zero - one]),
            Slip::Mirrored => ([unit, one - unit], [one, zero - one]),
            Slip::Squares => (value.map(|v| v * v), [zero - one, one]),
            _ => (value, slope),
        };
        Functions { value, slope }
    }
}

materialpoint::tensor_product_family!(Hats, width = 2, degree = 1);

fn slip(slip: Slip) -> Option<Property> {
    verdict(&Hats(slip), &BasisClaims::of_degree(1))
}

/// Slips in a family of the plane that is written out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum InPlane {
    Right,
    /// Gradients by the coordinate in cells.
    NotDivided,
    /// One cell size for both axes.
    OtherCellSize,
    /// The gradient along an axis without the values along the other.
    NoProduct,
    /// Axis 1 is numbered first.
    OtherAxisFirst,
    /// The degree of the products, not of the values along an axis.
    Degree,
}

const IN_PLANE: [(InPlane, Property); 5] = [
    (InPlane::NotDivided, Property::GradientsAreDerivatives),
    (InPlane::OtherCellSize, Property::GradientsAreDerivatives),
    (InPlane::NoProduct, Property::GradientsAreDerivatives),
    (InPlane::OtherAxisFirst, Property::FaceValues),
    (InPlane::Degree, Property::DegreeAsSaid),
];

/// Bilinear functions with a slip.
#[derive(Clone, Copy, Debug)]
struct Bilinear(InPlane);

impl BasisFamily<f64, 2> for Bilinear {
    fn degree(&self) -> usize {
        if self.0 == InPlane::Degree { 2 } else { 1 }
    }

    fn dofs(&self, grid: &Grid<f64, 2>) -> [usize; 2] {
        grid.cells().map(|cells| cells + 1)
    }

    fn for_each(
        &self,
        grid: &Grid<f64, 2>,
        cell: &Cell<2>,
        x: &SVector<f64, 2>,
        mut f: impl FnMut(usize, f64, SVector<f64, 2>),
    ) {
        let unit: [f64; 2] = std::array::from_fn(|a| grid.unit_coordinate(a, cell[a], x[a]));
        let value = unit.map(|u| [1.0 - u, u]);
        let (slope, shape) = ([-1.0, 1.0], self.dofs(grid));
        for corner in 0..4 {
            let (i, j) = (corner % 2, corner / 2);
            let (along, up) = (cell[0] as usize + i, cell[1] as usize + j);
            let dof = match self.0 {
                InPlane::OtherAxisFirst => along * shape[1] + up,
                _ => up * shape[0] + along,
            };
            let mut gradient = vector![slope[i] * value[1][j], value[0][i] * slope[j]];
            if self.0 == InPlane::NoProduct {
                gradient = vector![slope[i], slope[j]] / 2.0;
            }
            for a in 0..2 {
                gradient[a] *= match self.0 {
                    InPlane::NotDivided => 1.0,
                    InPlane::OtherCellSize => grid.inverse_cell_size()[0],
                    _ => grid.inverse_cell_size()[a],
                };
            }
            f(dof, value[0][i] * value[1][j], gradient);
        }
    }
}

fn in_plane(mistake: InPlane) -> Option<Property> {
    let grid = grid::<f64, 2>(3);
    check_basis(
        &Bilinear(mistake),
        &grid,
        &points(&grid),
        &BasisClaims::of_degree(1),
    )
    .err()
    .map(|failure| failure.property)
}

#[test]
fn families_without_their_slips_pass() {
    assert_eq!(slip(Slip::Right), None);
    assert_eq!(in_plane(InPlane::Right), None);
}
