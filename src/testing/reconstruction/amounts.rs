//! Whether amounts are kept.

use crate::mass::MassModel;
use crate::particles::Bins;
use crate::reconstruction::{Cloud, Reconstruction};
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Place, Property};
use crate::testing::worst::Worst;

use super::stream::{Streamed, are_particles, in_cells, relative_error, uneven};

pub(super) fn check<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &mut R,
    cloud: &Cloud<'_, T, D>,
    claimed: bool,
) -> Result<(), Failure> {
    // Positive, as a mass is, and far from constant.
    let amount = |p: usize| cloud.volumes[p] * (uneven::<T>(p) + T::lit(2.0));
    let mut stream = Vec::new();
    reconstruction.integrate_conserved(cloud, amount, |point, weighted| {
        stream.push(Streamed {
            cell: point.cell,
            position: point.position,
            weighted,
        });
    });
    in_cells(cloud, &stream)?;
    if R::Mass::OF_PARTICLES {
        are_particles(cloud, &stream, amount)?;
    }
    cells(cloud, &stream, amount).judge(Property::ConservesAmounts, claimed)
}

/// The same where every other occupied cell has lost all but its first particle, which determines no fit but
/// has an amount all the same.
pub(super) fn thinned<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &mut R,
    cloud: &Cloud<'_, T, D>,
    claimed: bool,
) -> Result<(), Failure> {
    if !claimed {
        return Ok(());
    }
    let mut kept = vec![true; cloud.positions.len()];
    for &number in cloud.bins.occupied().iter().step_by(2) {
        for &p in cloud.bins.particles_in(number as usize).iter().skip(1) {
            kept[p as usize] = false;
        }
    }
    let left = || (0..kept.len()).filter(|&p| kept[p]);
    let positions: Vec<_> = left().map(|p| cloud.positions[p]).collect();
    let volumes: Vec<_> = left().map(|p| cloud.volumes[p]).collect();
    let Ok(bins) = Bins::new(cloud.grid, &positions) else {
        return Ok(());
    };
    let thin = Cloud {
        bins: &bins,
        positions: &positions,
        volumes: &volumes,
        ..*cloud
    };
    reconstruction.prepare(&thin);
    let found = check(reconstruction, &thin, true);
    reconstruction.prepare(cloud);
    found
}

/// Deviation of each cell's sum. What is streamed may be larger than the amounts and cancel, so its size
/// counts in the round-off.
fn cells<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    stream: &[Streamed<T, D>],
    amount: impl Fn(usize) -> T,
) -> Worst<T> {
    let mut worst = Worst::new();
    let error = relative_error(cloud);
    for number in 0..cloud.grid.cell_count() {
        let cell = cloud.grid.cell(number);
        let particles = cloud.bins.particles_in(number).iter();
        let held = particles.fold(T::zero(), |sum, &p| sum + amount(p as usize));
        let here = stream.iter().filter(|point| point.cell == cell);
        let (sum, size) = here.fold((T::zero(), held), |(sum, size), point| {
            (sum + point.weighted, size + point.weighted.abs())
        });
        if size > T::zero() {
            worst.record(sum - held, size * error, || Place::cell(&cell));
        }
    }
    worst
}
