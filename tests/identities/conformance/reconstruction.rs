//! Reconstructions.

use std::ops::Range;

use materialpoint::field::Field;
use materialpoint::grid::Grid;
use materialpoint::mass::{ParticleMass, VelocityMass};
use materialpoint::reconstruction::{
    Anywhere, AtParticles, CellStream, Cloud, CubicSpline, InCells, NoFilter, Point, Reconstruction,
    RelaxedTaylor, Shepard, SubPoints, Taylor,
};
use materialpoint::scalar::Scalar;
use materialpoint::testing::{Failure, Measure, Property, ReconstructionClaims, check_reconstruction};
use nalgebra::{SVector, vector};

use super::{Planted, planted};

/// Particles of a layout without symmetry, four per cell and axis, that fill their cells.
struct Sample<T, const D: usize> {
    grid: Grid<T, D>,
    positions: Vec<SVector<T, D>>,
    volumes: Vec<T>,
}

/// Places along an axis of a cell; asymmetric, so that no odd function integrates to zero by luck.
const UNITS: [f64; 4] = [0.06, 0.37, 0.58, 0.97];

fn sample<T: Scalar, const D: usize>(cells: usize) -> Sample<T, D> {
    let max = SVector::from_fn(|a, _| T::lit(2.1) + T::count(a));
    let grid = Grid::new(SVector::repeat(T::lit(-0.4)), max, [cells; D]).unwrap();
    let per_cell = UNITS.len().pow(D as u32);
    let mut positions = Vec::new();
    for number in 0..grid.cell_count() {
        let cell = grid.cell(number);
        for index in 0..per_cell {
            positions.push(SVector::from_fn(|a, _| {
                let unit = UNITS[index / UNITS.len().pow(a as u32) % UNITS.len()];
                grid.edge(a, cell[a] as usize) + T::lit(unit) * grid.cell_size()[a]
            }));
        }
    }
    // Unequal, and together each cell's volume.
    let share = |p: usize| 1 + p % per_cell % 3;
    let total = (0..per_cell).map(share).sum();
    let volume = |p: usize| grid.cell_volume() * T::count(share(p)) / T::count(total);
    let volumes = (0..positions.len()).map(volume).collect();
    Sample {
        grid,
        positions,
        volumes,
    }
}

fn check<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    mut reconstruction: R,
    cells: usize,
    claims: ReconstructionClaims,
) -> Result<(), Failure> {
    let s = sample::<T, D>(cells);
    check_reconstruction(&mut reconstruction, &s.grid, &s.positions, &s.volumes, &claims)
}

const SHEPARD: ReconstructionClaims = ReconstructionClaims {
    conserves_amounts: true,
    measure: Measure::Particles,
    reproduces: 0,
    integrates: Some(0),
};

const TAYLOR: ReconstructionClaims = ReconstructionClaims {
    conserves_amounts: true,
    measure: Measure::OccupiedCells,
    reproduces: 2,
    integrates: Some(2),
};

/// The outermost domains reach into the neighbour's cell or out of the grid, so that no cell's own integral
/// is exact.
const SUB_POINTS: ReconstructionClaims = ReconstructionClaims {
    conserves_amounts: true,
    measure: Measure::AllParticles,
    reproduces: 0,
    integrates: None,
};

/// A global spline takes its particles as they come, whatever cell they are in.
const SPLINE: ReconstructionClaims = ReconstructionClaims {
    conserves_amounts: false,
    measure: Measure::OccupiedCells,
    reproduces: 3,
    integrates: Some(3),
};

fn ours<T: Scalar>() -> Result<(), Failure> {
    check::<T, 1, _>(Shepard, 4, SHEPARD)?;
    check::<T, 2, _>(Shepard, 2, SHEPARD)?;
    for sub_points in [2, 5] {
        let sub_points = SubPoints::new(sub_points).unwrap();
        check::<T, 1, _>(sub_points, 4, SUB_POINTS)?;
        check::<T, 2, _>(sub_points, 2, SUB_POINTS)?;
    }
    check::<T, 1, _>(Taylor::<T, 1, 3>::new(), 4, TAYLOR)?;
    check::<T, 1, _>(Taylor::<T, 1, 3>::with_gauss_points(3), 4, TAYLOR)?;
    check::<T, 2, _>(Taylor::<T, 2, 6>::new(), 2, TAYLOR)?;
    let linear = ReconstructionClaims {
        reproduces: 1,
        integrates: Some(1),
        ..TAYLOR
    };
    check::<T, 2, _>(Taylor::<T, 2, 3>::new(), 2, linear)
}

#[test]
fn our_reconstructions_keep_their_claims() -> Result<(), Failure> {
    ours::<f64>()?;
    check::<f64, 3, _>(Shepard, 1, SHEPARD)?;
    check::<f64, 3, _>(Taylor::<f64, 3, 10>::new(), 1, TAYLOR)?;
    check::<f64, 1, _>(RelaxedTaylor::<f64, 1, 3>::for_degree(2), 4, TAYLOR)?;
    check::<f64, 1, _>(CubicSpline::for_degree(1), 4, SPLINE)?;
    check::<f64, 1, _>(CubicSpline::for_degree(2), 4, SPLINE)
}

#[test]
fn our_reconstructions_keep_their_claims_in_single_precision() -> Result<(), Failure> {
    ours::<f32>()?;
    // On more cells the fourth power is so nearly cubic between particles that round-off hides the
    // difference.
    check::<f32, 1, _>(CubicSpline::for_degree(2), 2, SPLINE)
}

/// Particles that do not fill their cells: Shepard no longer integrates even constants.
#[test]
fn shepard_integrates_nothing_where_particles_do_not_fill_their_cells() {
    let mut s = sample::<f64, 1>(3);
    s.volumes.iter_mut().for_each(|v| *v *= 0.9);
    let verdict = |claims| check_reconstruction(&mut Shepard, &s.grid, &s.positions, &s.volumes, &claims);
    let unfilled = ReconstructionClaims {
        integrates: None,
        ..SHEPARD
    };
    assert_eq!(verdict(unfilled), Ok(()));
    assert_eq!(verdict(SHEPARD).unwrap_err().property, Property::Integrates(0));
}

/// What a cell's particles hold is not what its sub-points bring, and the sum over all cells is.
#[test]
fn the_weights_of_sub_points_sum_to_the_volume_in_all_cells_only() {
    let sub_points = SubPoints::new(4).unwrap();
    let each = ReconstructionClaims {
        measure: Measure::Particles,
        ..SUB_POINTS
    };
    let failure = check::<f64, 1, _>(sub_points, 4, each).unwrap_err();
    assert_eq!(failure.property, Property::Weights);
    let heavy = FaultyPoints(Faulty::new(Mistake::Weights));
    let all = ReconstructionClaims {
        measure: Measure::AllParticles,
        ..SHEPARD
    };
    let failure = check::<f64, 1, _>(heavy, 3, all).unwrap_err();
    assert_eq!(failure.property, Property::Weights);
}

#[test]
fn claims_that_are_too_bold_or_too_shy_are_found() {
    let verdict = |claims| {
        let outcome = check::<f64, 1, _>(Taylor::<f64, 1, 3>::new(), 4, claims);
        outcome.err().map(|failure| failure.property)
    };
    assert_eq!(verdict(TAYLOR), None);
    let with = |reproduces| ReconstructionClaims { reproduces, ..TAYLOR };
    assert_eq!(verdict(with(1)), Some(Property::Reproduces(2)));
    assert_eq!(verdict(with(3)), Some(Property::Reproduces(3)));
    let shy = ReconstructionClaims {
        conserves_amounts: false,
        ..TAYLOR
    };
    assert_eq!(verdict(shy), Some(Property::ConservesAmounts));
    let wrong = ReconstructionClaims {
        integrates: Some(3),
        ..TAYLOR
    };
    assert_eq!(verdict(wrong), Some(Property::Integrates(3)));
    let bold = ReconstructionClaims {
        conserves_amounts: true,
        ..SPLINE
    };
    let spline = check::<f64, 1, _>(CubicSpline::for_degree(1), 4, bold);
    assert_eq!(spline.unwrap_err().property, Property::ConservesAmounts);
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mistake {
    None,
    /// A thousandth of a millionth of each amount is lost.
    Leaks,
    /// A stream point names the cell before its own.
    Cell,
    /// Points that are not the particles.
    Moved,
    /// Weights too large.
    Weights,
    /// Values are squared in part.
    Nonlinear,
    /// The field moves the points.
    FieldMovesPoints,
    /// Something of the particles seen before stays.
    Remembers,
}

/// Shepard's stream with one mistake. It also keeps the smallest position it ever saw.
#[derive(Clone, Copy, Debug)]
struct Faulty {
    mistake: Mistake,
    smallest: f64,
}

/// It says that its points are the particles.
#[derive(Clone, Copy, Debug)]
struct FaultyParticles(Faulty);

/// It says that they are anywhere.
#[derive(Clone, Copy, Debug)]
struct FaultyPoints(Faulty);

impl Faulty {
    fn new(mistake: Mistake) -> Self {
        Self {
            mistake,
            smallest: f64::MAX,
        }
    }

    fn point(&self, cloud: &Cloud<'_, f64, 1>, p: usize) -> Point<f64, 1> {
        let (mut cell, mut position) = (*cloud.bins.cell_of(p), cloud.positions[p]);
        match self.mistake {
            Mistake::Cell => cell[0] = cell[0].saturating_sub(1),
            Mistake::Moved => position[0] += 1e-9,
            _ => {}
        }
        Point {
            cell,
            position,
            moves: true,
            particle: None,
        }
    }
}

impl Faulty {
    fn prepare(&mut self, cloud: &Cloud<'_, f64, 1>) {
        self.smallest = cloud.positions.iter().fold(self.smallest, |m, x| m.min(x[0]));
    }

    fn integrate<Q: Field<f64>>(
        &mut self,
        cloud: &Cloud<'_, f64, 1>,
        value: impl Fn(usize) -> Q,
        mut sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        for p in 0..cloud.positions.len() {
            let weighted = value(p).scaled(cloud.volumes[p]);
            let size = value(p).component(0).abs();
            let mut point = self.point(cloud, p);
            let factor = match self.mistake {
                Mistake::Nonlinear => 1.0 + 1e-6 * (size - 1.0),
                Mistake::Weights => 1.0 + 1e-9,
                // The mirrored sample begins nearer to the edge.
                Mistake::Remembers if self.smallest < -0.36 => 1.0 + 1e-9,
                _ => 1.0,
            };
            if self.mistake == Mistake::FieldMovesPoints {
                point.position[0] += 1e-9 * size;
            }
            sink(&point, weighted.scaled(factor));
        }
    }

    fn integrate_conserved<Q: Field<f64>>(
        &mut self,
        cloud: &Cloud<'_, f64, 1>,
        amount: impl Fn(usize) -> Q,
        mut sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        let kept = if self.mistake == Mistake::Leaks {
            1.0 - 1e-9
        } else {
            1.0
        };
        for p in 0..cloud.positions.len() {
            sink(&self.point(cloud, p), amount(p).scaled(kept));
        }
    }
}

macro_rules! faulty {
    ($name:ident, $points:ty, $mass:ty) => {
        impl Reconstruction<f64, 1> for $name {
            type Points = $points;
            type Mass = $mass;
            type Filter = NoFilter;

            fn prepare(&mut self, cloud: &Cloud<'_, f64, 1>) {
                self.0.prepare(cloud);
            }

            fn integrate<Q: Field<f64>>(
                &mut self,
                cloud: &Cloud<'_, f64, 1>,
                value: impl Fn(usize) -> Q,
                sink: impl FnMut(&Point<f64, 1>, Q),
            ) {
                self.0.integrate(cloud, value, sink);
            }

            fn integrate_conserved<Q: Field<f64>>(
                &mut self,
                cloud: &Cloud<'_, f64, 1>,
                amount: impl Fn(usize) -> Q,
                sink: impl FnMut(&Point<f64, 1>, Q),
            ) {
                self.0.integrate_conserved(cloud, amount, sink);
            }
        }
    };
}

faulty!(FaultyParticles, AtParticles, ParticleMass);
faulty!(FaultyPoints, Anywhere, VelocityMass);

fn at_particles(mistake: Mistake) -> Option<Property> {
    property(FaultyParticles(Faulty::new(mistake)))
}

fn elsewhere(mistake: Mistake) -> Option<Property> {
    property(FaultyPoints(Faulty::new(mistake)))
}

fn property(faulty: impl Reconstruction<f64, 1>) -> Option<Property> {
    check::<f64, 1, _>(faulty, 3, SHEPARD)
        .err()
        .map(|failure| failure.property)
}

const AT_PARTICLES: [(Mistake, Property); 4] = [
    (Mistake::Leaks, Property::StreamsParticles),
    (Mistake::Cell, Property::StreamInCell),
    (Mistake::Moved, Property::StreamsParticles),
    (Mistake::Remembers, Property::PrepareForgets),
];

const ELSEWHERE: [(Mistake, Property); 4] = [
    (Mistake::Leaks, Property::ConservesAmounts),
    (Mistake::Weights, Property::Weights),
    (Mistake::Nonlinear, Property::Linear),
    (Mistake::FieldMovesPoints, Property::SamePoints),
];

/// All mistakes of this file.
pub(super) fn mistakes() -> Vec<Planted> {
    let mut all = planted("particles", AT_PARTICLES, at_particles);
    all.extend(planted("points", ELSEWHERE, elsewhere));
    all.extend(planted("doors", DOORS, door));
    all.extend(planted("fit", SLIPS, slip));
    all
}

#[test]
fn reconstructions_without_their_mistakes_pass() {
    assert_eq!(at_particles(Mistake::None), None);
    // Of points that are the particles any field is reproduced, more than is claimed: the mistakes are found
    // before that is asked.
    assert_eq!(elsewhere(Mistake::None), Some(Property::Reproduces(1)));
    assert_eq!(door(Door::Right), None);
    assert_eq!(slip(Slip::Right), None);
}

/// The library's own, a thousand cells from the origin: positions are rounded there, and the check allows for
/// it.
#[test]
fn far_from_the_origin_the_claims_are_kept_too() {
    let grid = Grid::new(vector![1000.0], vector![1001.0], [4]).unwrap();
    let near = sample::<f64, 1>(4);
    let (from, size) = (near.grid.min()[0], near.grid.max()[0] - near.grid.min()[0]);
    let positions: Vec<_> = near
        .positions
        .iter()
        .map(|x| vector![1000.0 + (x[0] - from) / size])
        .collect();
    let volumes: Vec<_> = near.volumes.iter().map(|v| v / size).collect();
    let mut taylor = Taylor::<f64, 1, 3>::new();
    assert_eq!(
        check_reconstruction(&mut taylor, &grid, &positions, &volumes, &TAYLOR),
        Ok(())
    );
}

/// What streams of single cells can get wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Door {
    Right,
    /// Cells streamed alone leave out their last one.
    Cells,
    /// The same of amounts.
    Amounts,
}

/// Taylor least squares through wrong doors.
#[derive(Clone, Debug)]
struct Doors(Taylor<f64, 1, 3>, Door);

impl Reconstruction<f64, 1> for Doors {
    type Points = InCells;
    type Mass = VelocityMass;
    type Filter = NoFilter;

    fn prepare(&mut self, cloud: &Cloud<'_, f64, 1>) {
        self.0.prepare(cloud);
    }

    fn integrate<Q: Field<f64>>(
        &mut self,
        cloud: &Cloud<'_, f64, 1>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        self.0.integrate(cloud, value, sink);
    }

    fn integrate_conserved<Q: Field<f64>>(
        &mut self,
        cloud: &Cloud<'_, f64, 1>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        self.0.integrate_conserved(cloud, amount, sink);
    }
}

impl CellStream<f64, 1> for Doors {
    fn integrate_cells<Q: Field<f64>>(
        &self,
        cloud: &Cloud<'_, f64, 1>,
        cells: Range<usize>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        let end = cells.end - usize::from(self.1 == Door::Cells);
        self.0.integrate_cells(cloud, cells.start..end, value, sink);
    }

    fn integrate_conserved_cells<Q: Field<f64>>(
        &self,
        cloud: &Cloud<'_, f64, 1>,
        cells: Range<usize>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        let end = cells.end - usize::from(self.1 == Door::Amounts);
        self.0
            .integrate_conserved_cells(cloud, cells.start..end, amount, sink);
    }
}

const DOORS: [(Door, Property); 2] = [
    (Door::Cells, Property::CellsStreamTheSame),
    (Door::Amounts, Property::CellsStreamTheSame),
];

fn door(door: Door) -> Option<Property> {
    check::<f64, 1, _>(Doors(Taylor::new(), door), 5, TAYLOR)
        .err()
        .map(|failure| failure.property)
}

/// Slips in a fit of one's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slip {
    Right,
    /// Cells of a single particle, which determines no line, are left out of what is conserved.
    LosesLone,
    /// The half of the cell size is forgotten where the points are placed.
    OutOfCell,
    /// And where they are weighed.
    WholeWeights,
    /// The line leans the other way.
    SlopeSign,
    /// Values weighed by the volumes of their particles, whose sum is not divided by.
    WeightedSum,
    /// The mean of the values, and no line: a claim of the degree too many.
    MeanOnly,
    /// Amounts are taken for densities.
    AmountAsDensity,
    /// The fit of the densities is not moved to keep the sum.
    FreeFit,
}

const SLIPS: [(Slip, Property); 8] = [
    (Slip::LosesLone, Property::ConservesAmounts),
    (Slip::OutOfCell, Property::StreamInCell),
    (Slip::WholeWeights, Property::Weights),
    (Slip::SlopeSign, Property::Reproduces(1)),
    (Slip::WeightedSum, Property::Weights),
    (Slip::MeanOnly, Property::Reproduces(1)),
    (Slip::AmountAsDensity, Property::ConservesAmounts),
    (Slip::FreeFit, Property::ConservesAmounts),
];

/// A line through the values of each cell, streamed at two Gauss points.
#[derive(Clone, Copy, Debug)]
struct Lines(Slip);

impl Lines {
    /// Coefficients of the constant and of the coordinate from -1 to 1 that fit values in a cell, particle by
    /// particle.
    fn shares(self, cloud: &Cloud<'_, f64, 1>, cell: usize) -> Vec<(usize, f64, f64)> {
        let particles = cloud.bins.particles_in(cell);
        let (middle, half) = (
            cloud.grid.centre(&cloud.grid.cell(cell))[0],
            cloud.grid.cell_size()[0] / 2.0,
        );
        let count = particles.len() as f64;
        let place = |p: u32| (cloud.positions[p as usize][0] - middle) / half;
        let mean = particles.iter().map(|&p| place(p)).sum::<f64>() / count;
        let spread: f64 = particles.iter().map(|&p| (place(p) - mean).powi(2)).sum();
        let share = |&p: &u32| {
            let mut slope = if spread > 0.0 {
                (place(p) - mean) / spread
            } else {
                0.0
            };
            match self.0 {
                Slip::SlopeSign => slope = -slope,
                Slip::MeanOnly => slope = 0.0,
                _ => {}
            }
            let mut constant = 1.0 / count;
            if self.0 == Slip::WeightedSum {
                constant *= cloud.volumes[p as usize] * count / (3.0 * half);
            }
            (p as usize, constant - slope * mean, slope)
        };
        particles.iter().map(share).collect()
    }

    /// Positions and weights.
    fn points(self, cloud: &Cloud<'_, f64, 1>, cell: usize) -> [(f64, Point<f64, 1>, f64); 2] {
        let cell = cloud.grid.cell(cell);
        let (middle, half) = (cloud.grid.centre(&cell)[0], cloud.grid.cell_size()[0] / 2.0);
        let place = if self.0 == Slip::OutOfCell {
            2.0 * half
        } else {
            half
        };
        let weight = if self.0 == Slip::WholeWeights {
            2.0 * half
        } else {
            half
        };
        [-1.0, 1.0].map(|side| {
            let s = side / 3.0_f64.sqrt();
            (s, Point::fixed(cell, vector![middle + s * place]), weight)
        })
    }

    /// The constant and the slope of a field in a cell.
    fn line<Q: Field<f64>>(
        self,
        cloud: &Cloud<'_, f64, 1>,
        cell: usize,
        value: impl Fn(usize) -> Q,
    ) -> (Q, Q) {
        let (mut constant, mut slope) = (Q::zero(), Q::zero());
        for (p, c, s) in self.shares(cloud, cell) {
            constant.add_scaled(c, value(p));
            slope.add_scaled(s, value(p));
        }
        (constant, slope)
    }
}

impl Reconstruction<f64, 1> for Lines {
    type Points = Anywhere;
    type Mass = VelocityMass;
    type Filter = NoFilter;

    fn prepare(&mut self, _cloud: &Cloud<'_, f64, 1>) {}

    fn integrate<Q: Field<f64>>(
        &mut self,
        cloud: &Cloud<'_, f64, 1>,
        value: impl Fn(usize) -> Q,
        mut sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        for &cell in cloud.bins.occupied() {
            let (constant, slope) = self.line(cloud, cell as usize, &value);
            for (s, point, weight) in self.points(cloud, cell as usize) {
                let mut weighted = constant.scaled(weight);
                weighted.add_scaled(s * weight, slope);
                sink(&point, weighted);
            }
        }
    }

    fn integrate_conserved<Q: Field<f64>>(
        &mut self,
        cloud: &Cloud<'_, f64, 1>,
        amount: impl Fn(usize) -> Q,
        mut sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        for &cell in cloud.bins.occupied() {
            let particles = cloud.bins.particles_in(cell as usize);
            if self.0 == Slip::LosesLone && particles.len() < 2 {
                continue;
            }
            let density = |p: usize| match self.0 {
                Slip::AmountAsDensity => amount(p),
                _ => amount(p).scaled(1.0 / cloud.volumes[p]),
            };
            let (mut constant, slope) = self.line(cloud, cell as usize, density);
            if !matches!(self.0, Slip::FreeFit | Slip::AmountAsDensity) {
                constant = Q::zero();
                for &p in particles {
                    constant.add_scaled(1.0 / cloud.grid.cell_size()[0], amount(p as usize));
                }
            }
            for (s, point, weight) in self.points(cloud, cell as usize) {
                let mut weighted = constant.scaled(weight);
                weighted.add_scaled(s * weight, slope);
                sink(&point, weighted);
            }
        }
    }
}

fn slip(slip: Slip) -> Option<Property> {
    let claims = ReconstructionClaims {
        conserves_amounts: true,
        measure: Measure::OccupiedCells,
        reproduces: 1,
        integrates: Some(1),
    };
    check::<f64, 1, _>(Lines(slip), 4, claims)
        .err()
        .map(|failure| failure.property)
}
