//! `KEY=VALUE`: replacing single values of a scene.

use toml::{Table, Value};

use super::SceneError;
use super::text::{quote, shorten, type_name};

/// Sets every `KEY=VALUE` in the order given. The key is dotted, a number counts the entries of a list from
/// 0; tables that do not exist yet are made, and whether the key makes sense is checked with the whole scene.
pub(super) fn apply(mut scene: Table, overrides: &[String]) -> Result<Table, SceneError> {
    for text in overrides {
        scene = set(scene, text).map_err(|reason| SceneError::Override {
            text: shorten(text),
            reason,
        })?;
    }
    Ok(scene)
}

fn set(scene: Table, text: &str) -> Result<Table, String> {
    let Some((key, value)) = text.split_once('=') else {
        return Err("there is no '='; expected KEY=VALUE, such as time.end=0.2".into());
    };
    let value = parse_value(value.trim())?;
    let mut root = Value::Table(scene);
    *place(&mut root, key.trim())? = value;
    match root {
        Value::Table(table) => Ok(table),
        _ => Err("a scene is a table".into()),
    }
}

/// A TOML value, or a plain word such as `taylor`: a shell takes the quotes away.
fn parse_value(text: &str) -> Result<Value, String> {
    let mut table: Table = toml::from_str(&format!("value = {text}\n")).unwrap_or_default();
    match table.remove("value") {
        Some(value) if table.is_empty() => Ok(value),
        _ if is_word(text) => Ok(Value::String(text.into())),
        _ => Err(format!(
            "{} is not a TOML value; expected a number, true, false, \"text\" or [a, list] (quoted for the shell)",
            quote(text)
        )),
    }
}

fn is_word(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_')
}

/// The place that a dotted key names.
fn place<'a>(root: &'a mut Value, key: &str) -> Result<&'a mut Value, String> {
    let mut value = root;
    let mut parent = String::from("the scene");
    for part in key.split('.') {
        if part.is_empty() {
            return Err("a part of the key is empty; expected a dotted key, such as body.0.jitter".into());
        }
        value = match value {
            Value::Table(table) => table.entry(part).or_insert_with(|| Value::Table(Table::new())),
            Value::Array(list) => entry(list, &parent, part)?,
            other => return Err(format!("{parent} is {}; it has no keys", type_name(other))),
        };
        parent = shorten(part);
    }
    Ok(value)
}

fn entry<'a>(list: &'a mut [Value], parent: &str, part: &str) -> Result<&'a mut Value, String> {
    let count = list.len();
    let index = part.parse().ok();
    let found = index.and_then(|index: usize| list.get_mut(index));
    found.ok_or_else(|| match count {
        0 => format!("{parent} is an empty list; set the whole list"),
        _ => format!(
            "{parent} is a list; expected an entry from 0 to {}, found {}",
            count - 1,
            quote(part)
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "title = \"a\"\n[time]\nend = 1\n[[body]]\nmin = [0.0]\n[[body]]\nmin = [1.0]";

    fn applied(overrides: &[&str]) -> Result<Table, SceneError> {
        let overrides: Vec<_> = overrides.iter().map(ToString::to_string).collect();
        apply(toml::from_str(SCENE).unwrap(), &overrides)
    }

    #[test]
    fn values_are_replaced_and_added() {
        let scene = applied(&[
            "time.end=2",
            "time.end = 3.5",
            "body.1.jitter=0.3",
            "body.0.min.0=-1",
            "body.0.velocity=[\"sin(x)\"]",
            "output.particles=none",
            "title=\"b = c\"",
            "material.law={hill={youngs_modulus=1e4}}",
        ])
        .unwrap();
        assert_eq!(scene["time"]["end"].as_float(), Some(3.5));
        assert_eq!(scene["body"][1]["jitter"].as_float(), Some(0.3));
        assert_eq!(scene["body"][0]["min"][0].as_integer(), Some(-1));
        assert_eq!(scene["body"][0]["velocity"][0].as_str(), Some("sin(x)"));
        assert_eq!(scene["output"]["particles"].as_str(), Some("none"));
        assert_eq!(scene["title"].as_str(), Some("b = c"));
        let modulus = &scene["material"]["law"]["hill"]["youngs_modulus"];
        assert_eq!(modulus.as_float(), Some(1e4));
    }

    #[test]
    fn a_word_is_text_unless_toml_knows_it() {
        let scene = applied(&["a=linear-elastic", "b=true", "c=inf", "d=nan", "e=x-min"]).unwrap();
        assert_eq!(scene["a"].as_str(), Some("linear-elastic"));
        assert_eq!(scene["b"].as_bool(), Some(true));
        assert!(scene["c"].as_float().is_some_and(f64::is_infinite));
        assert!(scene["d"].as_float().is_some_and(f64::is_nan));
        assert_eq!(scene["e"].as_str(), Some("x-min"));
    }

    #[test]
    fn what_cannot_be_applied_is_explained() {
        let cases = [
            ("time.end", "no '='"),
            ("time.end=", "not a TOML value"),
            ("time.end=1 2", "not a TOML value"),
            ("time.end=1\nstep=2", "not a TOML value"),
            ("title=two words", "not a TOML value"),
            ("=1", "empty"),
            ("time..end=1", "empty"),
            ("title.end=1", "title is text"),
            ("time.end.x=1", "end is a whole number"),
            (
                "body.min=[1]",
                "body is a list; expected an entry from 0 to 1, found \"min\"",
            ),
            ("body.2.min=[1]", "from 0 to 1, found \"2\""),
            ("body.-1.min=[1]", "from 0 to 1"),
        ];
        for (text, fragment) in cases {
            let message = applied(&[text]).unwrap_err().to_string();
            assert!(
                message.starts_with("--set ") && message.contains(fragment),
                "{message}"
            );
            assert!(!message.contains('\n') && message.len() < 250, "{message}");
        }
    }
}
