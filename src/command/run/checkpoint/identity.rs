//! What makes the numbers of a run: all of a scene but its title and output.

use std::fmt;

use crate::scene::{Scene, StepSize, TimeSpec};

/// Begins the line of an expression that says where it stands and how it was written.
const ORIGIN: &str = "origin: ";

/// The scene as text, line by line, in the words of its keys. The end of steps of a given size decides how
/// many there are and nothing else, and is left out.
pub(super) fn identity(scene: &Scene) -> String {
    format!("{:#?}", Identity(scene))
}

struct Identity<'a>(&'a Scene);

impl fmt::Debug for Identity<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Scene {
            title: _,
            grid,
            time: TimeSpec { step, end, half_kick },
            method,
            material,
            bodies,
            boundaries,
            body_force,
            reference,
            output: _,
        } = self.0;
        let mut text = f.debug_struct("scene");
        text.field("grid", grid)
            .field("time.step", step)
            .field("time.half_kick", half_kick);
        if let StepSize::Auto { .. } = step {
            text.field("time.end", end);
        }
        text.field("method", method)
            .field("material", material)
            .field("body", bodies)
            .field("boundary", boundaries)
            .field("load.body_force", body_force)
            .field("reference", reference)
            .finish()
    }
}

/// Where two scenes differ first.
#[derive(Debug, PartialEq)]
pub(super) struct Difference {
    pub(super) key: String,
    pub(super) there: String,
    pub(super) here: String,
}

/// The first difference of two identities, if there is one. How an expression was written does not count.
pub(super) fn difference(there: &str, here: &str) -> Option<Difference> {
    let (there, here): (Vec<_>, Vec<_>) = (there.lines().collect(), here.lines().collect());
    let longer = there.len().max(here.len());
    let [a, b] = [&there, &here].map(|lines| move |n: usize| lines.get(n).copied().unwrap_or_default());
    let differs = |n: &usize| a(*n) != b(*n) && !(is_origin(a(*n)) && is_origin(b(*n)));
    let line = (0..longer).find(differs)?;
    let (before, now) = (place(&there, line), place(&here, line));
    Some(Difference {
        key: now.key,
        there: before.value,
        here: now.value,
    })
}

fn is_origin(line: &str) -> bool {
    line.trim_start().starts_with(ORIGIN)
}

/// A key and its value.
struct Place {
    key: String,
    value: String,
}

/// What a line of an identity is about: the names of the blocks that it is in, or the expression that it is
/// part of.
fn place(lines: &[&str], line: usize) -> Place {
    let this = lines.get(line).copied().unwrap_or_default();
    let mut level = indentation(this);
    let (own, value) = named(this);
    let mut names: Vec<&str> = own.into_iter().collect();
    for outer in lines.iter().take(line).rev() {
        let indent = indentation(outer);
        if indent < level {
            level = indent;
            names.extend(named(outer).0);
        }
        if indent == level && is_origin(outer) {
            return expression(outer);
        }
    }
    names.reverse();
    Place {
        // Scenes have the constants of the phases beside their number.
        key: names.join(".").replace("material.phases.", "material."),
        value: value.to_owned(),
    }
}

fn indentation(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

/// Name and value of a line `name: value,`; blocks open with a bracket, and entries of lists have no name.
fn named(line: &str) -> (Option<&str>, &str) {
    let value = |text: &'_ str| -> usize { text.trim_end_matches([',', ' ', '{', '[', '(']).len() };
    let line = line.trim();
    let (name, text) = match line.split_once(": ") {
        Some((name, text)) => (Some(name), text),
        None => (None, line),
    };
    (name, text.get(..value(text)).unwrap_or(text))
}

/// Of the line that says where an expression stands: `origin: "KEY = \"TEXT\"",`.
fn expression(origin: &str) -> Place {
    let text = origin.trim().trim_start_matches(ORIGIN).trim_end_matches(',');
    let text = unquoted(text).replace("\\\"", "\"");
    let (key, value) = text.split_once(" = ").unwrap_or((&text, ""));
    Place {
        key: key.to_owned(),
        value: value.to_owned(),
    }
}

/// Without the quotes around it.
fn unquoted(text: &str) -> &str {
    let inner = text.strip_prefix('"').and_then(|text| text.strip_suffix('"'));
    inner.unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{BAR, scene};
    use super::*;

    fn found(set: &[&str]) -> Option<Difference> {
        difference(&identity(&scene(BAR, &[])), &identity(&scene(BAR, set)))
    }

    #[test]
    fn what_makes_no_numbers_makes_no_difference() {
        for set in [
            "title=another",
            "output={particles='none', every=3, checkpoint_every=7}",
            "time.end=3",
            "body.0.velocity=[\" 1 \"]",
        ] {
            assert_eq!(found(&[set]), None, "{set}");
        }
    }

    #[test]
    fn the_first_key_that_differs_is_named_with_both_values() {
        let cases = [
            ("grid.cells=[8]", "grid.cells", "4", "8"),
            ("time.step=0.05", "time.step", "0.1", "0.05"),
            ("time.half_kick=true", "time.half_kick", "false", "true"),
            ("method.basis=dual-domain", "method.basis", "Linear", "DualDomain"),
            ("method.scalar=f32", "method.scalar", "F64", "F32"),
            ("material.density=2", "material.density", "1.0", "2.0"),
            ("body.0.jitter=0.5", "body.jitter", "0.0", "0.5"),
            ("boundary=[{face='x-min', fixed=true}]", "boundary", "[]", ""),
        ];
        for (set, key, there, here) in cases {
            let found = found(&[set]).unwrap();
            assert_eq!([&*found.key, &found.there, &found.here], [key, there, here]);
        }
    }

    /// A process that resumes has its functions elsewhere.
    #[test]
    fn no_address_is_part_of_the_identity() {
        let set = ["body.0.velocity=[\"-max(sin(x), x^2) + 1\"]"];
        let text = identity(&scene(BAR, &set));
        assert!(
            text.contains("\"sin\"") && text.contains("\"max\"") && !text.contains("0x"),
            "{text}"
        );
    }

    #[test]
    fn an_expression_is_named_as_it_was_written() {
        let found = found(&["body.0.velocity=[\"2*1\"]"]).unwrap();
        let words = [&*found.key, &found.there, &found.here];
        assert_eq!(words, ["body.0.velocity.0", "\"1\"", "\"2*1\""]);
    }
}
