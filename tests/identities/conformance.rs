//! The crate's own families, reconstructions, laws, phases and transfers under the checks of
//! `materialpoint::testing`, and mistakes that the checks must find.

mod basis;
mod law;
mod phase;
mod reconstruction;
mod transfer;

use std::collections::BTreeSet;
use std::fmt::Debug;

use materialpoint::testing::Property;

/// A mistake planted in a type of the tests.
struct Planted {
    name: String,
    /// The property that names it.
    expected: Property,
    /// What the check finds.
    found: Option<Property>,
}

/// All mistakes of a table, looked at by `verdict`.
fn planted<M: Copy + Debug, const N: usize>(
    type_with_it: &str,
    table: [(M, Property); N],
    verdict: impl Fn(M) -> Option<Property>,
) -> Vec<Planted> {
    let look = |(mistake, expected)| Planted {
        name: format!("{type_with_it}: {mistake:?}"),
        expected,
        found: verdict(mistake),
    };
    table.into_iter().map(look).collect()
}

/// Each by the property that it is at odds with, and at least thirty of them.
#[test]
fn planted_mistakes_are_found_and_named() {
    let kinds = [
        basis::mistakes(),
        law::mistakes(),
        reconstruction::mistakes(),
        phase::mistakes(),
        transfer::mistakes(),
    ];
    let all = || kinds.iter().flatten();
    let wrong: Vec<_> = all()
        .filter(|planted| planted.found != Some(planted.expected))
        .map(|planted| {
            format!(
                "{}: expected {:?}, found {:?}",
                planted.name, planted.expected, planted.found
            )
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    let names: BTreeSet<_> = all().map(|planted| &planted.name).collect();
    assert_eq!(names.len(), all().count(), "a mistake is planted twice");
    assert!(names.len() >= 30, "{} mistakes", names.len());
    // None of the checks rests on the others' number.
    assert!(kinds.iter().all(|kind| kind.len() >= 10));
}
