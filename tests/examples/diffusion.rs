//! Diffusion, by the phase of `examples/heat.rs`, against exact solutions.

use std::f64::consts::PI;

use materialpoint::basis::{BSpline, BasisFamily, DualDomain, Linear};
use materialpoint::error::{SetupError, StepError};
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::particles::{Particles, lattice};
use materialpoint::reconstruction::{CubicSpline, Reconstruction, RelaxedTaylor, Shepard, Taylor};
use materialpoint::stepper::{DiffusionCondition, Forcing, Mechanism, Setup, Stepper};
use materialpoint::testing::{PhaseSample, check_phase};
use materialpoint_steppers::Build;
use nalgebra::{SVector, vector};

use crate::compiled::parts;

use super::derivative::dual::Dual;
use super::heat::{
    Body, CONDUCTIVITY, Conduction, DENSITY, EXPANSION, LENGTH, SPECIFIC_HEAT, Warmth, YOUNGS_MODULUS,
    aluminium, body, cosine, decayed, diffusivity, filled, run,
};

/// By which part of itself the amplitude is off.
fn error<const D: usize, B, R>(method: (B, R), cells: usize) -> f64
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D> + Clone,
{
    let left = decayed::<f64, D, _, _>(method, cells, aluminium(false)).unwrap();
    left.amplitude * 1.0_f64.exp() - 1.0
}

/// The scheme's own decay of `cos(k x)` along each axis, for hat functions and three particles a cell at the
/// places x of a cell of size 1. With `s = sin^2(k h/2)` a mean at the nodes leaves `b = 2/3 sum (1 - x)
/// cos(k h x)` of a wave of the particles and `m = 1 - 19/27 s` of one of the nodes, whose second difference
/// is `4 s/h^2`. So the nodes lose `nu = 4 D kappa dt s m^(2 D - 1)/h^2` in a step, and the particles
/// `(b^2/m)^D` of what is lost there.
fn scheme(dimension: i32, cells: usize, steps: usize) -> f64 {
    let angle = PI / cells as f64;
    let s = (angle / 2.0).sin().powi(2);
    let m = 1.0 - 19.0 / 27.0 * s;
    let means = [1.0, 3.0, 5.0].map(|x| (1.0 - x / 6.0) * (angle * x / 6.0).cos());
    let b = 2.0 / 3.0 * means.iter().sum::<f64>();
    // D kappa (pi/L)^2 dt = 1/steps.
    let lost = 4.0 * s * m.powi(2 * dimension - 1) / (angle * angle * steps as f64);
    1.0 - (b * b / m).powi(dimension) * (1.0 - (1.0 - lost).powi(steps as i32))
}

#[test]
fn a_cosine_decays_as_the_scheme_must() {
    fn compare<const D: usize>(cells: usize) {
        let found = decayed::<f64, D, _, _>((Linear, Shepard), cells, aluminium(false)).unwrap();
        let expected = scheme(D as i32, cells, found.steps);
        let error = found.amplitude / expected - 1.0;
        assert!(error.abs() < 1e-11, "{found:?} {expected} {error:e}");
    }
    compare::<1>(10);
    compare::<1>(20);
    compare::<2>(8);
}

/// The error of the rate is of second order in the cell's size: so is the grid's, and the step's, which is of
/// its square.
#[test]
fn a_cosine_decays_with_an_error_of_second_order() {
    fn orders<const D: usize, B>(basis: B, cells: usize)
    where
        B: BasisFamily<f64, D> + Copy,
    {
        let [coarse, middle, fine] = [1, 2, 4].map(|n| error::<D, _, _>((basis, Shepard), n * cells));
        for ratio in [coarse / middle, middle / fine] {
            assert!((3.7..4.3).contains(&ratio), "{coarse:e} {middle:e} {fine:e}");
        }
        let squared = (PI / (4 * cells) as f64).powi(2);
        assert!(fine.abs() < squared, "{fine:e}");
    }
    orders::<1, _>(Linear, 10);
    orders::<1, _>(BSpline::<2>, 10);
    orders::<2, _>(Linear, 8);
    orders::<2, _>(BSpline::<2>, 8);
    // Reconstructions fit stresses and velocities; what diffuses is the particles' in all.
    let of_fits = error::<1, _, _>((Linear, Taylor::<f64, 1, 3>::new()), 20);
    let of_sums = error::<1, _, _>((Linear, Shepard), 20);
    assert!(of_fits.abs() < (PI / 20.0).powi(2) && of_sums.abs() < (PI / 20.0).powi(2));
}

/// `d ln(amplitude)/d ln k = -1` where `1/e` is left, to the error of the method.
#[test]
fn the_decay_carries_its_derivative() {
    let phase = Conduction {
        conductivity: Dual::new(CONDUCTIVITY, 1.0),
        ..aluminium(false)
    };
    let found = decayed::<Dual, 1, _, _>((Linear, Shepard), 20, phase).unwrap();
    let plain = decayed::<f64, 1, _, _>((Linear, Shepard), 20, aluminium(false)).unwrap();
    let (found, plain) = (found.amplitude, plain.amplitude);
    assert!((found.value / plain - 1.0).abs() < 1e-12, "{found:?} {plain}");
    let logarithmic = found.derivative * CONDUCTIVITY / found.value;
    assert!((logarithmic + 1.0).abs() < (PI / 20.0).powi(2), "{logarithmic}");
}

/// Temperatures without order, between 0 and 1.
fn noise(p: usize) -> f64 {
    (p as f64 * 0.754_877_666).fract()
}

/// Heat (J) of a body that conducts, and its measure of disorder: the capacities times the squares of the
/// temperatures.
fn heat<const D: usize, B, R>(body: &Body<f64, D, B, R>) -> [f64; 2]
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
{
    let particles = body.particles();
    let all = particles.phase.iter().zip(&particles.mass);
    all.fold([0.0; 2], |[heat, square], (warmth, mass)| {
        let capacity = SPECIFIC_HEAT * mass;
        [
            heat + capacity * warmth.0,
            square + capacity * warmth.0 * warmth.0,
        ]
    })
}

/// A body in a larger grid, of other temperatures from particle to particle, that slides through cells.
fn sliding<const D: usize, B, R>(method: (B, R), temperature: impl Fn(usize) -> f64) -> Body<f64, D, B, R>
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
{
    let (min, max) = (SVector::repeat(0.0), SVector::repeat(2.0 * LENGTH));
    let grid = Grid::new(min, max, [16; D]).unwrap();
    let corners = [0.125, 1.0].map(|x| SVector::repeat(x * LENGTH));
    let points = lattice(&grid, &corners[0], &corners[1], [2; D]);
    let mut particles: Particles<f64, D, (), Warmth<f64>> = Particles::at_rest(&points, DENSITY);
    for (p, warmth) in particles.phase.iter_mut().enumerate() {
        warmth.0 = temperature(p);
    }
    particles
        .velocity
        .fill(SVector::from_fn(|a, _| 200.0 / (1 + a) as f64));
    // Soft, so that the waves of fits in partly filled cells, which nothing excites, bear the step.
    let law = LinearElastic {
        moduli: Moduli::uniaxial(1e-6 * YOUNGS_MODULUS).unwrap(),
    };
    let setup = Setup::new(grid, method.0, method.1, law, aluminium(false), particles);
    Stepper::new(setup).unwrap()
}

/// A step (s) within the bound of any layout seen here.
fn safe_step<const D: usize>() -> f64 {
    let h: f64 = 0.125 * LENGTH;
    0.1 * h * h / (D as f64 * diffusivity())
}

/// The total is kept to round-off, and the squares of the temperatures never grow.
fn keeps_heat<const D: usize, B, R>(body: &mut Body<f64, D, B, R>, steps: usize)
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
{
    let [total, mut square] = heat(body);
    let start = square;
    for _ in 0..steps {
        body.step(safe_step::<D>(), &Forcing::none()).unwrap();
        let [now, less] = heat(body);
        assert!((now / total - 1.0).abs() < 1e-13, "{now:e} {total:e}");
        assert!(less <= square * (1.0 + 1e-14), "{less:e} {square:e}");
        square = less;
    }
    assert!(square < (1.0 - 1e-3) * start, "{square:e} {start:e}");
}

#[test]
fn heat_is_kept_by_every_basis_and_reconstruction() {
    fn along_a_line<B, R>(basis: B, reconstruction: R)
    where
        B: BasisFamily<f64, 1>,
        R: Reconstruction<f64, 1>,
    {
        keeps_heat(&mut sliding::<1, _, _>((basis, reconstruction), noise), 100);
    }
    along_a_line(Linear, Shepard);
    along_a_line(BSpline::<2>, Shepard);
    along_a_line(BSpline::<3>, Shepard);
    along_a_line(DualDomain::new(), Shepard);
    along_a_line(Linear, Taylor::<f64, 1, 3>::new());
    along_a_line(Linear, CubicSpline::for_degree(1));
    along_a_line(Linear, RelaxedTaylor::<f64, 1, 3>::for_degree(1));
    keeps_heat(&mut sliding::<2, _, _>((Linear, Shepard), noise), 100);
    keeps_heat(&mut sliding::<2, _, _>((BSpline::<2>, Shepard), noise), 100);
    keeps_heat(&mut sliding::<3, _, _>((Linear, Shepard), noise), 20);
    keeps_heat(&mut sliding::<3, _, _>((BSpline::<3>, Shepard), noise), 20);
}

/// A constant is a mean of itself and has no gradient: only round-off changes it.
#[test]
fn a_block_that_slides_keeps_its_temperature() {
    fn slide<const D: usize, B: BasisFamily<f64, D>>(basis: B) {
        let mut body = sliding::<D, _, _>((basis, Shepard), |_| 1.0);
        for _ in 0..200 {
            body.step(safe_step::<D>(), &Forcing::none()).unwrap();
        }
        // Some tens of steps through a cell.
        assert!(body.diagnostics().grid_crossings > 0);
        for warmth in &body.particles().phase {
            assert!((warmth.0 - 1.0).abs() < 1e-12, "{:e}", warmth.0 - 1.0);
        }
    }
    slide::<1, _>(Linear);
    slide::<2, _>(Linear);
    slide::<2, _>(BSpline::<2>);
    slide::<3, _>(Linear);
}

/// What the example prints: heat makes the temperature even at 1 K, since `1 + cos` has the mean 1; between
/// walls the mean strain is zero and so the stress is `-E alpha theta`, held at one end there is none and the
/// strain is `alpha theta`. The mean over twenty periods is as good as the waves that are left are small.
#[test]
fn the_warmed_bar_is_stressed_or_expands() {
    let found = run().unwrap();
    for (dimension, left) in found.decayed.into_iter().enumerate() {
        let error = left.amplitude * 1.0_f64.exp() - 1.0;
        assert!(
            error.abs() < (PI / 20.0).powi(2),
            "{error:e} along {}",
            dimension + 1
        );
    }
    let [held, free] = found.warmed;
    for warmed in found.warmed {
        let [low, high] = warmed.temperature;
        assert!(
            (low - 1.0).abs() < 1e-2 && (high - 1.0).abs() < 1e-2,
            "{warmed:?}"
        );
    }
    let thermal = YOUNGS_MODULUS * EXPANSION;
    assert!((held.stress / thermal + 1.0).abs() < 1e-3, "{held:?}");
    assert!(free.stress.abs() < 1e-3 * thermal, "{free:?}");
    assert!((free.elongation / EXPANSION - 1.0).abs() < 1e-3, "{free:?}");
}

/// Between a warm and a cold face the temperature becomes linear, whatever it was. Within a few cells of the
/// faces particles are off by a part of what it changes across a cell, which falls by `2 - sqrt 3` from cell
/// to cell: the means at the face are those of the particles on one side of it.
#[test]
fn between_prescribed_values_the_temperature_becomes_linear() {
    let cells = 20;
    let mut bar = body(
        (Linear, Shepard),
        filled::<f64, 1>(cells).unwrap(),
        aluminium(false),
        |_| 0.3,
    )
    .unwrap();
    let [left, right] = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
    let forcing = Forcing::none()
        .with_diffusion(left, DiffusionCondition::Value(1.0))
        .with_diffusion(right, DiffusionCondition::Value(0.0));
    let limit = (LENGTH / cells as f64).powi(2) / (2.0 * diffusivity());
    let steps = (2.0 * LENGTH * LENGTH / diffusivity() / limit / 0.8) as usize;
    for _ in 0..steps {
        bar.step(0.8 * limit, &forcing).unwrap();
    }
    let particles = bar.particles();
    for (warmth, x) in particles.phase.iter().zip(&particles.initial_position) {
        let place = x[0] / LENGTH;
        let off = warmth.0 - (1.0 - place);
        let cells_away = (place.min(1.0 - place) * cells as f64).floor();
        // Twice what would come of the one-sided mean, a third of a cell.
        let allowed = 1e-6 + (2.0 - 3.0_f64.sqrt()).powf(cells_away) / cells as f64;
        assert!(off.abs() < allowed, "{off:e} at {place}");
    }
}

/// `h^2/(2 kappa)` for hat functions along one axis, by every way in which a step is found. At the bound
/// nothing grows, whatever the temperatures. Waves of length `2 pi/k` have the eigenvalue
/// `4 kappa s (1 - a s)/h^2`, `s = sin^2(k h/2)`, where `1 - a s` is what the means at the nodes leave of a
/// wave: with three particles a cell `a = 19/27`, the largest is `27/19 kappa/h^2`, and the scheme bears 2.81
/// times the bound, which is for layouts that smear nothing.
#[test]
fn the_step_that_heat_allows_is_found_and_bears() {
    let fast = Conduction {
        conductivity: 100.0 * CONDUCTIVITY,
        ..aluminium::<f64>(true)
    };
    let cells = 16;
    let mut bar = body((Linear, Shepard), filled::<f64, 1>(cells).unwrap(), fast, |x| {
        noise((x[0] * 1e9) as usize)
    })
    .unwrap();
    let h = LENGTH / cells as f64;
    let expected = h * h / (200.0 * diffusivity());
    let stiffness = bar.stiffness(&Forcing::none()).unwrap();
    let limits = [bar.largest_step(stiffness), bar.critical_step(&Forcing::none())];
    for limit in limits.map(Option::unwrap) {
        assert_eq!(limit.mechanism, Mechanism::Diffusion);
        assert!(
            (limit.step / expected - 1.0).abs() < 1e-6,
            "{limit:?} {expected:e}"
        );
    }
    // With the conductivity of aluminium a wave is faster than heat.
    let mut slow = body(
        (Linear, Shepard),
        filled::<f64, 1>(cells).unwrap(),
        aluminium(true),
        cosine,
    )
    .unwrap();
    let stiffness = slow.stiffness(&Forcing::none()).unwrap();
    assert_eq!(slow.largest_step(stiffness).unwrap().mechanism, Mechanism::Wave);

    let still = Conduction {
        thermal_stress: 0.0,
        ..fast
    };
    let grows = |factor: f64| {
        let mut bar = body((Linear, Shepard), filled::<f64, 1>(cells).unwrap(), still, |x| {
            noise((x[0] * 1e9) as usize)
        })
        .unwrap();
        let [_, start] = heat(&bar);
        for _ in 0..400 {
            bar.step(factor * expected, &Forcing::none()).unwrap();
        }
        heat(&bar)[1] > start
    };
    assert!(!grows(1.0) && !grows(2.7));
    assert!(grows(2.95));
}

/// Held faces leave nothing of the wave's stiffness in a single cell, but heat flows in it all the same.
#[test]
fn held_faces_do_not_hide_what_heat_allows() {
    let mut bar = body(
        (Linear, Shepard),
        filled::<f64, 1>(1).unwrap(),
        aluminium(true),
        cosine,
    )
    .unwrap();
    let fixed = materialpoint::stepper::FaceCondition::fixed();
    let forcing = Face::all::<1>().fold(Forcing::none(), |f, face| f.with_face(face, fixed));
    let bound = bar.stiffness_bound(&forcing);
    assert!((bound * LENGTH * LENGTH / 4.0 - 1.0).abs() < 1e-12, "{bound:e}");
}

/// The bits of one thread by three.
#[test]
fn threads_do_not_change_a_bit() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut plate = body(
                (BSpline::<2>, Shepard),
                filled::<f64, 2>(48).unwrap(),
                aluminium(true),
                |x| noise((x[0] * 1e9) as usize),
            )
            .unwrap();
            for _ in 0..5 {
                plate.step(1e-13, &Forcing::none()).unwrap();
            }
            let temperatures = plate.particles().phase.iter();
            temperatures.map(|warmth| warmth.0.to_bits()).collect::<Vec<_>>()
        })
    };
    assert!(run(1) == run(3));
}

/// A stepper that goes on from a file gives the bits of one that never stopped.
#[test]
fn a_checkpoint_keeps_the_temperatures() {
    let new = || sliding::<2, _, _>((Linear, Shepard), noise);
    let (mut whole, mut before, mut after) = (new(), new(), new());
    for _ in 0..30 {
        whole.step(safe_step::<2>(), &Forcing::none()).unwrap();
    }
    for _ in 0..15 {
        before.step(safe_step::<2>(), &Forcing::none()).unwrap();
    }
    let mut file = Vec::new();
    before.save(&mut file).unwrap();
    after.restore(&mut &file[..]).unwrap();
    for _ in 0..15 {
        after.step(safe_step::<2>(), &Forcing::none()).unwrap();
    }
    let all = |body: &Body<f64, 2, Linear, Shepard>| -> Vec<u64> {
        body.particles()
            .phase
            .iter()
            .map(|warmth| warmth.0.to_bits())
            .collect()
    };
    assert!(all(&whole) == all(&after));
}

/// On one thread, since rayon itself may allocate.
#[test]
fn no_step_that_conducts_heat_allocates() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        let mut plate = sliding::<2, _, _>((BSpline::<2>, Shepard), noise);
        let said = plate.bytes();
        let counted = allocation_counter::measure(|| {
            for _ in 0..20 {
                plate.step(safe_step::<2>(), &Forcing::none()).unwrap();
            }
        });
        assert_eq!((counted.count_total, plate.bytes()), (0, said));
    });
}

/// What cannot work is refused before anything has moved.
#[test]
fn what_heat_does_not_know_is_refused() {
    let face = Face {
        axis: 0,
        side: Side::Max,
    };
    let value = |told| Forcing::none().with_diffusion(face, DiffusionCondition::Value(told));
    let grid = || Grid::new(vector![0.0], vector![LENGTH], [4]).unwrap();
    let law = LinearElastic {
        moduli: Moduli::uniaxial(YOUNGS_MODULUS).unwrap(),
    };
    let points = lattice(&grid(), grid().min(), grid().max(), [2]);
    let particles = Particles::at_rest(&points, DENSITY);
    let method = Method::new(Basis::Linear, ReconstructionKind::Shepard);
    let mut dry = parts(grid(), law, particles).stepper(method).unwrap();
    let refused = StepError::ValueWithoutDiffusion { face };
    assert_eq!(dry.step(1e-12, &value(1.0)), Err(refused));

    let bar = |temperature: f64| {
        body(
            (Linear, Shepard),
            filled::<f64, 1>(4).unwrap(),
            aluminium(false),
            |_| temperature,
        )
    };
    let outcome = bar(0.0).unwrap().step(1e-12, &value(f64::NAN));
    assert!(
        matches!(outcome, Err(StepError::DiffusingValue { .. })),
        "{outcome:?}"
    );
    assert!(matches!(
        bar(f64::INFINITY).err(),
        Some(SetupError::Value { particle: 0, .. })
    ));
    // The same between two steps, and nothing has changed then.
    let mut edited = bar(1.0).unwrap();
    let outcome = edited.edit_particles(|particles| particles.phase[3].0 = f64::NAN);
    assert!(
        matches!(outcome, Err(SetupError::Value { particle: 3, .. })),
        "{outcome:?}"
    );
    edited.step(1e-12, &Forcing::none()).unwrap();
    // A step far beyond the stable one ends with the particle whose temperature is no number any more.
    let mut bar = body(
        (Linear, Shepard),
        filled::<f64, 1>(16).unwrap(),
        aluminium(false),
        |x| noise((x[0] * 1e9) as usize),
    )
    .unwrap();
    let outcome = (0..200).try_for_each(|_| bar.step(1e-3, &Forcing::none()));
    assert!(
        matches!(
            outcome,
            Err(StepError::Invalid {
                name: "value that diffuses",
                ..
            })
        ),
        "{outcome:?}"
    );
}

#[test]
fn the_phase_of_the_example_conforms() {
    let sample = PhaseSample {
        stress: 1e6,
        strain: 1e-3,
        density: DENSITY,
    };
    let coupled = Conduction {
        temperature: 293.0,
        ..aluminium(true)
    };
    check_phase::<f64, 1, _>(&coupled, &sample).unwrap();
    check_phase::<f64, 2, _>(&coupled, &sample).unwrap();
    check_phase::<f64, 3, _>(&coupled, &sample).unwrap();
}
