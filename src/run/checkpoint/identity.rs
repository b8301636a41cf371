//! What makes the numbers of a run: all of a scene but its title and output.

use std::fmt;

use crate::scene::{Scene, StepSize, TimeSpec};

/// Begins the line of an expression that says where it stands and how it was written.
const ORIGIN: &str = "origin: ";

/// The scene as text, line by line, in the words of its keys. The end of steps of a given size decides how many there are and
/// nothing else, and is left out.
pub(super) fn identity(scene: &Scene) -> String {
    format!("{:#?}", Identity(scene))
}

struct Identity<'a>(&'a Scene);

impl fmt::Debug for Identity<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Scene {
            title: _,
            grid,
            time: TimeSpec { step, end },
            method,
            material,
            bodies,
            boundaries,
            body_force,
            reference,
            output: _,
        } = self.0;
        let mut text = f.debug_struct("scene");
        text.field("grid", grid).field("time.step", step);
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

/// What a line of an identity is about: the names of the blocks that it is in, or the expression that it is part of.
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
        key: names.join("."),
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
    let text = text.trim_matches('"').replace("\\\"", "\"");
    let (key, value) = text.split_once(" = ").unwrap_or((&text, ""));
    Place {
        key: key.to_owned(),
        value: format!("\"{}\"", value.trim_matches('"')),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(set: &[&str]) -> Option<Difference> {
        let text = Scene::builtin("vibrating-bar-large").unwrap();
        let scene = |set: &[&str]| {
            let set: Vec<_> = set.iter().map(ToString::to_string).collect();
            Scene::from_toml(text, &set).unwrap()
        };
        difference(&identity(&scene(&[])), &identity(&scene(set)))
    }

    #[test]
    fn what_makes_no_numbers_makes_no_difference() {
        for set in [
            "title=another",
            "output={particles='none', every=3, checkpoint_every=7}",
            "time.end=0.2",
            "body.0.velocity=[\" 0.8 * sin( pi*x )\"]",
        ] {
            assert_eq!(found(&[set]), None, "{set}");
        }
    }

    #[test]
    fn the_first_key_that_differs_is_named_with_both_values() {
        let cases: [(&[&str], _, _); 6] = [
            (&["grid.cells=[40]"], "grid.cells", "40"),
            (&["time.step=2e-5"], "time.step", "2e-5"),
            (&["method.basis=bspline"], "method.basis", "BSpline"),
            (&["method.scalar=f32"], "method.scalar", "F32"),
            (&["body.0.jitter=0.5"], "body.jitter", "0.5"),
            (
                &[
                    "boundary.1.fixed=false",
                    "boundary=[{face='x-min', fixed=true}]",
                    "reference={}",
                ],
                "boundary",
                "",
            ),
        ];
        for (set, key, here) in cases {
            let difference = found(set).unwrap();
            assert!(difference.key.starts_with(key), "{set:?}: {difference:?}");
            assert!(
                difference.here.contains(here) && difference.here != difference.there,
                "{difference:?}"
            );
        }
    }

    #[test]
    fn an_expression_is_named_as_it_was_written() {
        let set = ["body.0.velocity=[\"0.7*sin(pi*x)\"]", "reference={}"];
        let difference = found(&set).unwrap();
        assert_eq!(difference.key, "body.0.velocity.0");
        assert_eq!(difference.here, "\"0.7*sin(pi*x)\"");
        assert_eq!(difference.there, "\"0.8*sin(pi*x)\"");
    }
}
