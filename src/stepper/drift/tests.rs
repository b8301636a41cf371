//! Four particles at once, and blocks of them, against one after the other.

use nalgebra::{SMatrix, SVector};

use super::super::spans::{Fault, InvalidState, Moved, Spans};
use super::{Matter, move_particles};
use crate::basis::{BSpline, BasisFamily, Linear};
use crate::grid::{Cell, Grid};
use crate::law::{ConstitutiveLaw, Hill, LinearElastic, Moduli, NeoHookean};
use crate::parallel::Sliced;
use crate::particles::{Bins, Particles, settle};
use crate::phase::OnePhase;
use crate::tensor::determinant;
use crate::transfer::{Drift, drift};

/// Numbers from 0 to 1 without any order.
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 1_u64;
    move || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// What is moved.
#[derive(Clone)]
struct Body<const D: usize, S> {
    grid: Grid<f64, D>,
    particles: Particles<f64, D, S>,
    cells: Vec<Cell<D>>,
    velocity: Vec<SVector<f64, D>>,
}

impl<const D: usize, S: Copy + Default + PartialEq + std::fmt::Debug> Body<D, S> {
    /// Cells of one to nine particles in no order, more than a block of them, and DOFs with velocities up to
    /// 1 m/s.
    fn new(basis: &impl BasisFamily<f64, D>) -> Self {
        let n = [40, 6, 3][D - 1];
        let grid = Grid::new(SVector::zeros(), SVector::repeat(n as f64), [n; D]).unwrap();
        let mut number = numbers();
        let mut points = Vec::new();
        for cell in 0..grid.cell_count() {
            for _ in 0..1 + (9.0 * number()) as usize {
                let corner = grid.cell(cell).map(f64::from);
                points.push((SVector::from_fn(|a, _| corner[a] + number()), 0.2 + number()));
            }
        }
        points.rotate_left(3);
        let mut particles = Particles::at_rest(&points, 1.0);
        for stress in &mut particles.stress {
            *stress = SMatrix::from_fn(|i, j| if i == j { number() } else { 0.0 });
        }
        let inner = |x: &SVector<f64, D>| x.iter().all(|&x| x > 0.0 && x < n as f64);
        let points = (0..basis.dof_count(&grid)).map(|dof| basis.interpolation_point(&grid, dof));
        let velocity = points
            .map(|x| SVector::from_fn(|_, _| if inner(&x) { 2.0 * number() - 1.0 } else { 0.0 }))
            .collect();
        let cells = Bins::new(&grid, &particles.position).unwrap().cells().to_vec();
        Self {
            grid,
            particles,
            cells,
            velocity,
        }
    }

    /// Each particle by itself, as the law is written.
    fn move_plainly<L: ConstitutiveLaw<f64, D, State = S>>(
        &mut self,
        basis: &impl BasisFamily<f64, D>,
        law: &L,
        dt: f64,
    ) -> Moved<f64> {
        let mut moved = Moved::default();
        let all = &mut self.particles;
        for (p, cell) in self.cells.iter_mut().enumerate() {
            let (mut v, mut gradient) = (SVector::zeros(), SMatrix::zeros());
            basis.for_each(&self.grid, cell, &all.position[p], |i, phi, slope| {
                v += self.velocity[i] * phi;
                gradient += self.velocity[i] * slope.transpose();
            });
            all.position[p] += v * dt;
            all.displacement[p] += v * dt;
            let increment = gradient * dt;
            law.update_over(dt, &increment, &mut all.stress[p], &mut all.state[p]);
            all.volume[p] *= match law.large_strain() {
                true => determinant(&(SMatrix::identity() + increment)),
                false => 1.0,
            };
            let flaw = match law.knows(&all.stress[p], &all.state[p]) {
                false => Some(InvalidState::Stress(all.stress[p][(0, 0)])),
                true if all.volume[p] > 0.0 => None,
                true => Some(InvalidState::Volume(all.volume[p])),
            };
            if let Some(flaw) = flaw {
                moved.fault = Some(Fault::Material(p, flaw));
                return moved;
            }
            match settle(&self.grid, cell, &mut all.position[p]) {
                Some(crossed) => moved.crossings += usize::from(crossed),
                None => {
                    moved.fault = Some(Fault::Left(p));
                    return moved;
                }
            }
        }
        moved
    }

    /// As a step does.
    fn move_in_blocks<L: ConstitutiveLaw<f64, D, State = S>>(
        &mut self,
        basis: &impl BasisFamily<f64, D>,
        law: &L,
        dt: f64,
    ) -> (Moved<f64>, [u32; 2]) {
        let phase = &OnePhase;
        let motion = Drift {
            velocities: [&self.velocity[..]],
            dt,
        };
        let mut spans = Spans::new(self.particles.len());
        let mut bins = Bins::of_cells(self.cells.clone());
        let space = (basis, &self.grid, &mut bins);
        move_particles(
            space,
            &mut self.particles,
            &Matter { law, phase },
            &motion,
            &mut spans,
        );
        self.cells = bins.cells().to_vec();
        (spans.moved[0], spans.bounds[0])
    }

    fn assert_near(&self, other: &Self) {
        let (a, b) = (&self.particles, &other.particles);
        assert_eq!(self.cells, other.cells);
        for p in 0..a.len() {
            let near = |a: &[f64], b: &[f64]| {
                a.iter()
                    .zip(b)
                    .all(|(a, b)| (a - b).abs() <= 1e-13 * (1.0 + a.abs()))
            };
            assert!(
                near(a.position[p].as_slice(), b.position[p].as_slice()),
                "position {p}"
            );
            assert!(near(a.displacement[p].as_slice(), b.displacement[p].as_slice()));
            assert!(near(a.stress[p].as_slice(), b.stress[p].as_slice()), "stress {p}");
            assert!(near(&a.volume[p..=p], &b.volume[p..=p]), "volume {p}");
        }
    }
}

fn compare<const D: usize, L>(basis: &impl BasisFamily<f64, D>, law: &L)
where
    L: ConstitutiveLaw<f64, D, State: PartialEq + std::fmt::Debug>,
{
    let before = Body::<D, L::State>::new(basis);
    let (mut plain, mut four, mut one) = (before.clone(), before.clone(), before);
    for _ in 0..3 {
        let count = plain.move_plainly(basis, law, 0.15).crossings;
        assert!(count > 0, "particles cross: {count}");
        for (body, at_once) in [(&mut four, true), (&mut one, false)] {
            let (moved, [low, high]) = match at_once {
                true => body.move_in_blocks(basis, law, 0.15),
                false => body.move_in_blocks(&OneByOne(basis.clone()), law, 0.15),
            };
            assert_eq!(moved.crossings, count);
            assert!(moved.fault.is_none());
            let all = body.grid.cell_count() - 1;
            assert_eq!((low, high as usize), (0, all));
            body.assert_near(&plain);
        }
    }
}

#[test]
fn blocks_move_and_deform_as_each_particle_alone() {
    let moduli = Moduli::from_young(100.0, 0.3).unwrap();
    let (hill, elastic) = (Hill { moduli }, LinearElastic { moduli });
    compare::<1, _>(&Linear, &hill);
    compare::<1, _>(&BSpline::<2>, &elastic);
    compare::<1, _>(&BSpline::<3>, &NeoHookean { moduli });
    compare::<2, _>(&BSpline::<2>, &hill);
    compare::<2, _>(&Linear, &NeoHookean { moduli });
    compare::<3, _>(&BSpline::<2>, &elastic);
}

/// Faults of single particles, also of two in one group and one block.
#[test]
fn the_first_particle_at_fault_is_told() {
    let law = Hill {
        moduli: Moduli::uniaxial(100.0).unwrap(),
    };
    let before = Body::<1, ()>::new(&Linear);
    let last = before.particles.len() - 4;
    for places in [vec![0], vec![last], vec![2, 9], vec![150, 151], vec![77, 6, 130]] {
        for first_kind in 0..3 {
            let mut body = before.clone();
            for (k, &p) in places.iter().enumerate() {
                match (first_kind + k) % 3 {
                    0 => body.particles.stress[p][0] = 1e3,
                    1 => body.particles.volume[p] = f64::NAN,
                    _ => body.particles.position[p][0] = -1e3,
                }
            }
            let mut plain = body.clone();
            let expected = plain.move_plainly(&Linear, &law, 1e-3).fault;
            assert!(expected.is_some());
            for four in [true, false] {
                let found = match four {
                    true => body.clone().move_in_blocks(&Linear, &law, 1e-3).0.fault,
                    false => body.clone().move_in_blocks(&OneByOne(Linear), &law, 1e-3).0.fault,
                };
                match (found, expected) {
                    (Some(Fault::Left(a)), Some(Fault::Left(b))) => assert_eq!(a, b),
                    (Some(Fault::Material(a, found)), Some(Fault::Material(b, expected))) => {
                        assert_eq!(a, b);
                        let stress = |flaw| matches!(flaw, InvalidState::Stress(_));
                        assert_eq!(stress(found), stress(expected));
                    }
                    _ => panic!("{places:?}: {found:?} in place of {expected:?}"),
                }
            }
        }
    }
}

/// The same functions, of which nobody says that they are products.
#[derive(Clone)]
struct OneByOne<B>(B);

impl<const D: usize, B: BasisFamily<f64, D>> BasisFamily<f64, D> for OneByOne<B> {
    fn degree(&self) -> usize {
        self.0.degree()
    }

    fn dofs(&self, grid: &Grid<f64, D>) -> [usize; D] {
        self.0.dofs(grid)
    }

    fn for_each(
        &self,
        grid: &Grid<f64, D>,
        cell: &Cell<D>,
        x: &SVector<f64, D>,
        f: impl FnMut(usize, f64, SVector<f64, D>),
    ) {
        self.0.for_each(grid, cell, x, f);
    }
}

/// A block is no part of the result: particles move the same from wherever one begins.
#[test]
fn cuts_change_no_bit() {
    let whole = Body::<1, ()>::new(&BSpline::<2>);
    let moved = |parts: &[usize]| {
        let mut body = whole.clone();
        let motion = Drift {
            velocities: [&body.velocity[..]],
            dt: 0.03,
        };
        let (mut rest, mut cells) = (body.particles.movable(1), &mut body.cells[..]);
        let mut increments = Vec::new();
        for &part in parts {
            let (mut first, later) = rest.split(1, part);
            let (some, later_cells) = cells.split_at_mut(part);
            let (places, _) = first.places_and_material(some);
            drift(&BSpline::<2>, &body.grid, &motion, places, &mut |_, [some]| {
                increments.extend_from_slice(some);
                true
            });
            (rest, cells) = (later, later_cells);
        }
        (body.particles.position, increments)
    };
    let all = whole.cells.len();
    assert!(all > 200);
    assert_eq!(moved(&[all]), moved(&[61, all - 61]));
}
