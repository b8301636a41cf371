//! Whether shrinking leads to the layout that is to blame.

use proptest::test_runner::{TestError, TestRunner};

use super::config;
use super::layout::{Layout, Place, layouts};

/// The layout that shrinking finds for a property that fails where `bad` holds.
fn smallest<const D: usize>(bad: impl Fn(&Layout<D>) -> bool) -> Layout<D> {
    let mut runner = TestRunner::new(config());
    let strategy = layouts::<D>(3, 8);
    loop {
        let outcome = runner.run(&strategy, |layout| {
            proptest::prop_assert!(!bad(&layout));
            Ok(())
        });
        // So rare a layout may not come in one run's cases.
        if let Err(TestError::Fail(_, layout)) = outcome {
            return layout;
        }
    }
}

/// Particles of a cell with equal positions.
fn coincident<const D: usize>(layout: &Layout<D>) -> usize {
    let same = |cell: &Vec<[Place; D]>| {
        let equal = |a: &[Place; D]| cell.iter().filter(|&b| a == b).count();
        cell.iter().map(equal).max().unwrap_or(0)
    };
    layout.particles.iter().map(same).max().unwrap_or(0)
}

#[test]
fn two_coincident_particles_are_found_alone() {
    let layout = smallest::<2>(|layout| coincident(layout) >= 2);
    assert_eq!(layout.count(), 2, "{layout:?}");
    assert_eq!(coincident(&layout), 2);
}

#[test]
fn an_empty_cell_beside_a_full_one_is_found() {
    let layout = smallest::<1>(|layout| {
        layout
            .particles
            .windows(2)
            .any(|pair| pair[0].is_empty() && pair[1].len() >= 3)
    });
    assert_eq!(layout.count(), 3, "{layout:?}");
}

#[test]
fn a_particle_on_an_edge_is_found_alone_and_named_as_a_fraction() {
    let layout = smallest::<1>(|layout| {
        layout
            .particles
            .iter()
            .flatten()
            .any(|spot| spot[0].unit() == 1.0 && layout.count() > 0)
    });
    assert_eq!(layout.count(), 1, "{layout:?}");
    assert_eq!(layout.particles.concat(), [[Place::Fraction(1, 1)]]);
}
