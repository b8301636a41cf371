//! TOML text to a table, with the place of a mistake.

use toml::Table;

use super::SceneError;
use super::text::shorten;

/// Reads the text.
pub(super) fn parse(text: &str) -> Result<Table, SceneError> {
    toml::from_str(text).map_err(|error| {
        let start = error.span().map_or(0, |span| span.start);
        let before = text.get(..start).unwrap_or(text);
        let line = before.matches('\n').count();
        let column = before.rsplit('\n').next().map_or(0, |part| part.chars().count());
        SceneError::Syntax {
            line: line + 1,
            column: column + 1,
            reason: error.message().replace('\n', ", "),
            excerpt: shorten(text.lines().nth(line).unwrap_or_default().trim()),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistake_is_found_by_line_and_column() {
        let message = |text: &str| parse(text).unwrap_err().to_string();
        assert_eq!(
            message("[grid]\nmin = 0.0 1.0\n"),
            "line 2, column 7: string values must be quoted, expected literal string, in the line \"min = 0.0 1.0\""
        );
        assert!(message("é = 1").starts_with("line 1, column 1: "));
        assert!(message("a = 1\na = 2").starts_with("line 2, column 1: duplicate key"));
        assert!(message("a = é").contains("line 1, column 5"));
    }
}
