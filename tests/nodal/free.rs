//! Source: free bodies that turn and meet. Goal: what they keep. Expected: momentum and angular momentum to
//! round-off whatever the number of terms, because the linear functions of a free body are those of the
//! matrix, and energy within some parts in a thousand; plain MPM loses 5.8 % of a disc's angular momentum in
//! a turn.

use super::*;

type Solid<const D: usize, const NB: usize> =
    Stepper<f64, D, BSpline<2>, NodalTaylor<f64, D, NB>, NeoHookean<f64>, OnePhase>;

/// Balls of radius one half about the centres, with so many particles of a cell along an axis.
fn balls<const D: usize, const NB: usize>(
    grid: Grid<f64, D>,
    centres: &[SVector<f64, D>],
    per_cell: usize,
    velocity: impl Fn(&SVector<f64, D>) -> SVector<f64, D>,
    terms: u8,
) -> Solid<D, NB> {
    let law = NeoHookean {
        moduli: Moduli::from_young(1e3, 0.3).unwrap(),
    };
    let mut points = lattice(&grid, grid.min(), grid.max(), [per_cell; D]);
    points.retain(|(x, _)| centres.iter().any(|centre| (x - centre).norm() < 0.5));
    let mut particles = Particles::at_rest(&points, 1.0);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        *v = velocity(x);
    }
    let fits = NodalTaylor::for_basis(&BSpline::<2>);
    let setup = Setup::new(grid, BSpline::<2>, fits, law, OnePhase, particles);
    Stepper::new(setup.with_velocity_mass(ParticleSeries::of(terms))).unwrap()
}

/// Components of the momentum and of the angular momentum about the origin, and the sums of the sizes of
/// what they add up.
fn momenta<const D: usize, const NB: usize>(stepper: &Solid<D, NB>) -> (Vec<f64>, f64) {
    let (particles, mut sums, mut scale) = (stepper.particles(), vec![0.0; 2 * D], 0.0_f64);
    for p in 0..particles.len() {
        let (x, v) = (particles.position[p], particles.velocity[p] * particles.mass[p]);
        for a in 0..D {
            sums[a] += v[a];
            let b = (a + 1) % D;
            sums[D + a] += x[a] * v[b] - x[b] * v[a];
        }
        scale += v.norm();
    }
    (sums, scale)
}

/// Largest change of a momentum over the first scale, and lowest and highest energy over the first.
fn kept<const D: usize, const NB: usize>(
    mut stepper: Solid<D, NB>,
    (dt, steps): (f64, usize),
) -> (f64, [f64; 2]) {
    let (start, scale) = momenta(&stepper);
    let energy = stepper.energy().total();
    let (mut change, mut range) = (0.0_f64, [1.0_f64; 2]);
    for _ in 0..steps {
        stepper.step(dt, &Forcing::none()).unwrap();
        for (now, start) in momenta(&stepper).0.iter().zip(&start) {
            change = change.max((now - start).abs() / scale);
        }
        let now = stepper.energy().total() / energy;
        range = [range[0].min(now), range[1].max(now)];
    }
    (change, range)
}

#[test]
fn a_disc_keeps_its_momenta_and_energy_with_any_number_of_terms() {
    for (per_cell, terms) in [(3, 1), (3, 2), (3, 8), (2, 8)] {
        let grid = Grid::new(SVector::repeat(-1.0), SVector::repeat(1.0), [16; 2]).unwrap();
        let spin = |x: &SVector<f64, 2>| SVector::from([-x[1], x[0]]);
        let disc: Solid<2, 6> = balls(grid, &[SVector::zeros()], per_cell, spin, terms);
        let (change, energy) = kept(disc, (4e-4, 2000));
        let what = format!("{per_cell} particles an axis, {terms} terms");
        assert!(change < 1e-13, "{what}: momenta {change:e}");
        assert!(energy[0] > 0.9995 && energy[1] < 1.0001, "{what}: {energy:?}");
    }
}

#[test]
fn a_ball_keeps_its_momenta_and_energy() {
    let grid = Grid::new(SVector::repeat(-1.0), SVector::repeat(1.0), [8; 3]).unwrap();
    let spin = |x: &SVector<f64, 3>| SVector::from([0.3, -0.2, 1.0]).cross(x);
    let ball: Solid<3, 10> = balls(grid, &[SVector::zeros()], 2, spin, 8);
    let (change, energy) = kept(ball, (1e-3, 100));
    assert!(change < 1e-13, "momenta {change:e}");
    assert!(energy[0] > 0.9995 && energy[1] < 1.0001, "{energy:?}");
}

/// Off the line of their centres: they take a spin from each other, and part.
#[test]
fn discs_that_meet_keep_their_momenta() {
    let grid = Grid::new(SVector::repeat(-2.0), SVector::repeat(2.0), [20; 2]).unwrap();
    let centres = [SVector::from([-0.6, -0.2]), SVector::from([0.6, 0.2])];
    let towards = |x: &SVector<f64, 2>| SVector::from([-2.0 * x[0].signum(), 0.0]);
    for terms in [2, 8] {
        let discs: Solid<2, 6> = balls(grid.clone(), &centres, 3, towards, terms);
        let (change, energy) = kept(discs, (5e-4, 1000));
        assert!(change < 1e-13, "{terms} terms: momenta {change:e}");
        assert!(energy[0] > 0.98 && energy[1] < 1.005, "{terms} terms: {energy:?}");
    }
}
