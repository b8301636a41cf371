//! How values appear in messages: on one line, and short.

use toml::Value;

/// Longest piece of the user's own text that a message repeats, in characters.
const LONGEST: usize = 60;

/// A TOML value as it may be typed.
pub(super) fn show(value: &Value) -> String {
    let text = match value {
        Value::String(text) => return quote(text),
        // Without an exponent 1e300 would fill three lines.
        Value::Float(number) => format!("{number:?}"),
        Value::Array(list) => {
            let entries: Vec<_> = list.iter().take(LONGEST).map(show).collect();
            format!("[{}]", entries.join(", "))
        }
        Value::Table(table) => {
            let entries = table.iter().take(LONGEST);
            let entries: Vec<_> = entries
                .map(|(key, value)| format!("{key} = {}", show(value)))
                .collect();
            format!("{{ {} }}", entries.join(", "))
        }
        other => other.to_string(),
    };
    shorten(&text)
}

/// Text in quotes.
pub(super) fn quote(text: &str) -> String {
    format!("\"{}\"", shorten(text))
}

/// One line of at most [`LONGEST`] characters; what cannot be printed is escaped.
pub(super) fn shorten(text: &str) -> String {
    let printable: String = text
        .chars()
        .take(LONGEST + 1)
        .flat_map(|c| match c {
            c if c.is_control() => c.escape_default().collect::<Vec<_>>(),
            c => vec![c],
        })
        .collect();
    if printable.chars().count() <= LONGEST {
        return printable;
    }
    printable.chars().take(LONGEST - 3).chain("...".chars()).collect()
}

/// The type of a value, for "found".
pub(super) fn type_name(value: &Value) -> &'static str {
    match value {
        Value::String(_) => "text",
        Value::Integer(_) => "a whole number",
        Value::Float(_) => "a number",
        Value::Boolean(_) => "a boolean",
        Value::Datetime(_) => "a date",
        Value::Array(_) => "a list",
        Value::Table(_) => "a table",
    }
}

/// The names in quotes, as a choice.
pub(super) fn one_of<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let quoted: Vec<_> = names.into_iter().map(quote).collect();
    match quoted.as_slice() {
        [only] => only.clone(),
        all => format!("one of {}", all.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(value: &str) -> String {
        let table: toml::Table = toml::from_str(&format!("value = {value}")).unwrap();
        show(&table["value"])
    }

    #[test]
    fn values_read_as_they_are_typed() {
        for text in [
            "1e300",
            "-2.5",
            "40",
            "true",
            "\"x-min\"",
            "[0.0, 1.0]",
            "{ a = [1, 2] }",
        ] {
            assert_eq!(shown(text), text);
        }
        assert_eq!(shown("nan"), "NaN");
    }

    #[test]
    fn long_or_unprintable_text_stays_on_one_short_line() {
        assert_eq!(shown(r#""a\nb""#), r#""a\nb""#);
        let long = shorten(&"x".repeat(500));
        assert_eq!(long.chars().count(), LONGEST);
        assert!(long.ends_with("..."));
        let list = format!("[{}]", vec!["1"; 1000].join(", "));
        assert!(shown(&list).chars().count() <= LONGEST);
    }
}
