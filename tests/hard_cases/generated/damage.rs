//! Scenes with lines and values that somebody lost, doubled or mistyped.

use proptest::prelude::*;
use proptest::sample::Index;

use super::scene_text::Text;

/// Values that fit few keys.
const VALUES: [&str; 20] = [
    "",
    "0",
    "-1",
    "1e308",
    "-5e-324",
    "nan",
    "inf",
    "9223372036854775807",
    "99999999999999999999",
    "true",
    "\"\"",
    "\"auto\"",
    "[]",
    "[[]]",
    "[\"1/0\"]",
    "{}",
    "{ a = 1 }",
    "\"x^x^x\"",
    "'",
    "1979-05-27",
];

/// Characters that mean something, and some that do not belong.
const CHARACTERS: [char; 16] = [
    '=',
    '[',
    ']',
    '{',
    '}',
    '"',
    '\'',
    '#',
    '.',
    '-',
    '(',
    '^',
    '\0',
    '\r',
    '\u{fe0f}',
    '\u{1d54a}',
];

#[derive(Clone, Debug)]
enum Damage {
    DropLine(Index),
    DoubleLine(Index),
    MoveLine(Index, Index),
    Value(Index, &'static str),
    ValueOfAnother(Index, Index),
    Cut(Index, Index),
    Insert(Index, char),
}

fn damage() -> impl Strategy<Value = Damage> {
    use Damage::*;
    let at = any::<Index>;
    prop_oneof![
        at().prop_map(DropLine),
        at().prop_map(DoubleLine),
        (at(), at()).prop_map(|(from, to)| MoveLine(from, to)),
        (at(), prop::sample::select(&VALUES[..])).prop_map(|(line, value)| Value(line, value)),
        (at(), at()).prop_map(|(line, other)| ValueOfAnother(line, other)),
        (at(), at()).prop_map(|(from, to)| Cut(from, to)),
        (at(), prop::sample::select(&CHARACTERS[..])).prop_map(|(place, c)| Insert(place, c)),
    ]
}

/// Texts with one to five damages.
pub fn damaged(texts: impl Strategy<Value = Text>) -> impl Strategy<Value = Text> {
    (texts, prop::collection::vec(damage(), 1..=5))
        .prop_map(|(text, damages)| Text(damages.iter().fold(text.0, apply)))
}

fn apply(text: String, damage: &Damage) -> String {
    if text.is_empty() {
        return text;
    }
    match damage {
        Damage::Cut(from, to) => cut(&text, from, to),
        Damage::Insert(place, c) => {
            let mut characters: Vec<char> = text.chars().collect();
            characters.insert(place.index(characters.len()), *c);
            characters.into_iter().collect()
        }
        in_lines => {
            let mut lines: Vec<String> = text.split('\n').map(String::from).collect();
            change(&mut lines, in_lines);
            lines.join("\n")
        }
    }
}

/// Takes out at most eight characters.
fn cut(text: &str, from: &Index, length: &Index) -> String {
    let characters: Vec<char> = text.chars().collect();
    let from = from.index(characters.len());
    let to = (from + 1 + length.index(8)).min(characters.len());
    characters[..from].iter().chain(&characters[to..]).collect()
}

fn change(lines: &mut Vec<String>, damage: &Damage) {
    let value = |line: &str| line.split_once('=').map(|(_, value)| value.to_owned());
    let set = |line: &mut String, value: &str| {
        let key = line.split('=').next().unwrap_or_default().to_owned();
        *line = format!("{key}={value}");
    };
    let n = lines.len();
    match damage {
        Damage::DropLine(at) => drop(lines.remove(at.index(n))),
        Damage::DoubleLine(at) => lines.insert(at.index(n), lines[at.index(n)].clone()),
        Damage::MoveLine(from, to) => {
            let line = lines.remove(from.index(n));
            lines.insert(to.index(n), line);
        }
        Damage::Value(at, value) => set(&mut lines[at.index(n)], value),
        Damage::ValueOfAnother(at, other) => {
            let other = value(&lines[other.index(n)]).unwrap_or_default();
            set(&mut lines[at.index(n)], &other);
        }
        Damage::Cut(..) | Damage::Insert(..) => {}
    }
}
