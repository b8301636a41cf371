//! Goal: whenever a stepper was saved, the restored one takes its steps to the bit; what is no such state is
//! refused.

use std::f64::consts::PI;
use std::io;

use nalgebra::{SVector, vector};

use crate::basis::{BSpline, BasisFamily, Linear};
use crate::error::RestoreError;
use crate::grid::Grid;
use crate::law::{ConstitutiveLaw, LinearElastic, Moduli, NeoHookean};
use crate::parallel::PARTICLES;
use crate::particles::Particles;
use crate::phase::OnePhase;
use crate::reconstruction::{Reconstruction, RelaxedTaylor, Shepard, Taylor};
use crate::record::Record;
use crate::stepper::{Forcing, Setup, Stepper};

/// Cells of the body: in the plane 16 384 particles, of which a span has two rows.
const CELLS: [usize; 2] = [512, 8];
/// One particle in so many is next to the edge of a row of cells.
const NEXT_TO_EDGE: usize = 20;

fn points() -> Vec<(SVector<f64, 2>, f64)> {
    let row = 2 * CELLS[0];
    let place = |k: usize| {
        let (x, y) = ((k % row) as f64 / 2.0 + 0.25, k / row);
        let row = y / 2;
        // At the floor and the ceiling on the side that is away from them.
        let below = row == 0 || row + 1 < CELLS[1] && (k / NEXT_TO_EDGE).is_multiple_of(2);
        let within = match (k % NEXT_TO_EDGE, below) {
            (0, true) => 0.99,
            (0, false) => 0.01,
            _ => (y % 2) as f64 / 2.0 + 0.25,
        };
        vector![x, row as f64 + within]
    };
    (0..row * 2 * CELLS[1]).map(|k| (place(k), 0.25)).collect()
}

fn setup<const D: usize, B, R, L>(
    grid: Grid<f64, D>,
    (basis, reconstruction, law): (B, R, L),
    particles: Particles<f64, D, L::State>,
) -> Stepper<f64, D, B, R, L, OnePhase>
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
    L: ConstitutiveLaw<f64, D>,
{
    Stepper::new(Setup::new(grid, basis, reconstruction, law, OnePhase, particles)).unwrap()
}

fn plane<R: Reconstruction<f64, 2>>(
    reconstruction: R,
) -> Stepper<f64, 2, BSpline<2>, R, NeoHookean<f64>, OnePhase> {
    let grid = Grid::new(
        vector![0.0, 0.0],
        vector![CELLS[0] as f64, CELLS[1] as f64],
        CELLS,
    );
    let law = NeoHookean {
        moduli: Moduli::from_young(1e-3, 0.3).unwrap(),
    };
    let mut particles = Particles::at_rest(&points(), 1.0);
    // In the end so many cross sideways that all are put in order again.
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        v[0] = 0.015 * (x[0] * PI / 32.0).sin();
    }
    setup(grid.unwrap(), (BSpline::<2>, reconstruction, law), particles)
}

/// Pushes rows of particles over the edge, stops them, lets them rest, and takes them back: some steps have
/// crossings and others none, and after the way back spans are as wide as they need not be.
fn push<const D: usize, B, R, L>(stepper: &mut Stepper<f64, D, B, R, L, OnePhase>, step: usize)
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
    L: ConstitutiveLaw<f64, D>,
{
    let sign = [1.0, -1.0, 0.0, -1.0, 1.0, 0.0][step % 6];
    stepper.set_body_forces(|x| {
        let mut force = SVector::zeros();
        // Nothing leaves through the floor or the ceiling of the plane.
        let within = if const { D == 1 } {
            0.75
        } else {
            (x[D - 1] * PI / CELLS[1] as f64).sin()
        };
        force[D - 1] = 0.04 * within * sign * (x[0] / 20.0).sin();
        force
    });
    stepper.step(1.0, &Forcing::none()).unwrap();
}

fn saved<const D: usize, B, R, L>(stepper: &Stepper<f64, D, B, R, L, OnePhase>) -> Vec<u8>
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
    L: ConstitutiveLaw<f64, D, State: Record<f64>>,
{
    let mut bytes = Vec::new();
    stepper.save(&mut bytes).unwrap();
    bytes
}

/// Saves after every step; a fresh stepper that is given the state takes the next two steps. The state is all
/// there is, so that states alike in every byte mean steppers alike.
fn goes_on_as_if_nothing_had_happened<const D: usize, B, R, L>(
    fresh: &Stepper<f64, D, B, R, L, OnePhase>,
    steps: usize,
    mut watch: impl FnMut(&Stepper<f64, D, B, R, L, OnePhase>),
) where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D> + Clone,
    L: ConstitutiveLaw<f64, D, State: Record<f64>> + Clone,
{
    let mut stepper = fresh.clone();
    let mut states = vec![saved(&stepper)];
    for step in 0..steps {
        push(&mut stepper, step);
        watch(&stepper);
        states.push(saved(&stepper));
    }
    assert!(stepper.diagnostics().grid_crossings > 0);
    for step in 0..steps - 1 {
        let mut resumed = fresh.clone();
        resumed.restore(&mut &states[step][..]).unwrap();
        assert!(saved(&resumed).len() == states[step].len());
        for ahead in 1..=2 {
            push(&mut resumed, step + ahead - 1);
            assert!(
                saved(&resumed) == states[step + ahead],
                "saved after {step} steps, {ahead} further"
            );
        }
    }
}

#[test]
fn the_plane_goes_on_from_any_step_though_its_spans_change() {
    let (mut wide, mut orders) = (0, Vec::new());
    goes_on_as_if_nothing_had_happened(&plane(Shepard), 34, |stepper| {
        let spans = &stepper.inner.spans;
        let narrow = spans
            .bounds
            .iter()
            .all(|[low, high]| high - low < 2 * CELLS[0] as u32);
        wide += usize::from(!spans.stale && narrow && spans.lengths[0] > PARTICLES);
        orders.push(stepper.numbers().map(<[u32]>::to_vec));
    });
    // Cut as no one would who knew the cells alone, and put in order again on the way: else the test would
    // show nothing of what it is for.
    orders.dedup();
    assert!(wide > 0 && orders.len() > 1, "{wide} {}", orders.len());
}

#[test]
fn fits_go_on_from_any_step() {
    goes_on_as_if_nothing_had_happened(&plane(Taylor::<f64, 2, 6>::for_degree(2)), 14, |_| ());
}

#[test]
fn a_line_goes_on_from_any_step() {
    let grid = Grid::new(vector![0.0], vector![3000.0], [3000]).unwrap();
    let place = |k: usize| match k % NEXT_TO_EDGE {
        0 => (k / 4) as f64 + 0.99,
        _ => (k / 4) as f64 + (k % 4) as f64 / 4.0 + 0.1,
    };
    // Room for a quarter of a cell at the ends.
    let points: Vec<_> = (4..11_996).map(|k| (vector![place(k)], 0.25)).collect();
    let law = LinearElastic {
        moduli: Moduli::uniaxial(1e-3).unwrap(),
    };
    let particles = Particles::at_rest(&points, 1.0);
    let relaxed = RelaxedTaylor::<f64, 1, 3>::for_degree(1);
    let bar = setup(grid, (Linear, relaxed, law), particles);
    goes_on_as_if_nothing_had_happened(&bar, 14, |_| ());
}

/// A small body in the middle of a grid, after some steps.
fn small() -> Stepper<f64, 2, BSpline<2>, Shepard, NeoHookean<f64>, OnePhase> {
    let grid = Grid::new(vector![-4.0, -4.0], vector![8.0, 8.0], [12, 12]).unwrap();
    let law = NeoHookean {
        moduli: Moduli::from_young(1e-3, 0.3).unwrap(),
    };
    let points: Vec<_> = points().into_iter().filter(|(x, _)| x.max() < 3.0).collect();
    setup(
        grid,
        (BSpline::<2>, Shepard, law),
        Particles::at_rest(&points, 1.0),
    )
}

#[test]
fn a_state_that_ends_early_or_is_anothers_is_refused() {
    let mut stepper = small();
    (0..3).for_each(|step| push(&mut stepper, step));
    let state = saved(&stepper);
    for length in (0..state.len()).step_by(7) {
        let error = small().restore(&mut &state[..length]).unwrap_err();
        assert!(matches!(&error, RestoreError::Read(e) if e.kind() == io::ErrorKind::UnexpectedEof));
    }
    let error = plane(Shepard).restore(&mut &state[..]).unwrap_err();
    let message = error.to_string();
    assert_eq!(message, "the state has 12 cells along x; expected 512");
}

/// As many cells in all, but along other axes.
#[test]
fn a_state_of_a_grid_of_another_shape_is_refused() {
    let grid = |cells: [usize; 2]| {
        let max = vector![cells[0] as f64, cells[1] as f64];
        let law = LinearElastic {
            moduli: Moduli::from_young(1e-3, 0.3).unwrap(),
        };
        let points = [(vector![2.2, 1.7], 0.25), (vector![2.7, 1.7], 0.25)];
        let particles = Particles::at_rest(&points, 1.0);
        let grid = Grid::new(vector![0.0, 0.0], max, cells).unwrap();
        setup(grid, (BSpline::<2>, Shepard, law), particles)
    };
    let (wide, mut high) = (grid([12, 4]), grid([4, 12]));
    let error = high.restore(&mut &saved(&wide)[..]).unwrap_err().to_string();
    assert_eq!(error, "the state has 12 cells along x; expected 4");
    grid([12, 4]).restore(&mut &saved(&wide)[..]).unwrap();
}

/// The mass that errors of conservation are compared with is that of the particles as they were edited.
#[test]
fn the_mass_of_edited_particles_is_restored() {
    let mut stepper = small();
    stepper
        .edit_particles(|particles| particles.mass.iter_mut().for_each(|m| *m *= 3.0))
        .unwrap();
    stepper.step(1.0, &Forcing::none()).unwrap();
    let mut resumed = small();
    resumed.restore(&mut &saved(&stepper)[..]).unwrap();
    let mass = |stepper: &Stepper<f64, 2, _, _, _, _>| stepper.diagnostics().total_mass;
    assert_eq!(mass(&resumed), mass(&stepper));
    assert!(mass(&small()) * 2.9 < mass(&resumed));
    for stepper in [&mut resumed, &mut stepper] {
        stepper.step(1.0, &Forcing::none()).unwrap();
        let conservation = &stepper.diagnostics().conservation;
        assert!(conservation.mass < 1e-12, "{conservation:?}");
    }
}

/// Also where a checksum would have told: whatever the bytes are, nothing panics, in restoring or in steps
/// from there.
#[test]
fn a_changed_state_is_refused_or_stepped_from_without_panic() {
    let mut stepper = small();
    (0..3).for_each(|step| push(&mut stepper, step));
    let state = saved(&stepper);
    let mut seed = 1_u64;
    let mut random = |end: usize| {
        // Knuth's generator; its upper bits are the good ones.
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % end
    };
    let (mut refused, mut stopped) = (0, 0);
    for case in 0..3000 {
        let mut bytes = state.clone();
        // Half of the cases in the numbers, cells, order and spans at the end.
        let from = if case % 2 == 0 { 0 } else { state.len() * 7 / 8 };
        for _ in 0..1 + random(3) {
            bytes[from + random(state.len() - from)] = random(256) as u8;
        }
        let mut other = small();
        if other.restore(&mut &bytes[..]).is_err() {
            refused += 1;
            continue;
        }
        let stops = |_| other.step(1.0, &Forcing::none()).is_err();
        stopped += usize::from((0..2).any(stops));
    }
    assert!(refused > 100 && refused + stopped < 3000, "{refused} {stopped}");
}
