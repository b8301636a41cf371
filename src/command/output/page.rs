//! Pages of which a program writes parts and people the rest.

use std::fmt;

/// A page without a place for what is to be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the page has no lines `{}` and, below, `{}`, each once", begin(.name), end(.name))]
pub struct PageError {
    /// Name of the part.
    pub name: String,
}

/// The page with `text` between the lines `<!-- begin NAME -->` and `<!-- end NAME -->`; the rest stays as it
/// is.
///
/// # Errors
/// If either line is missing or comes more than once, or the end is above the beginning.
pub fn fill_in(page: &str, name: &str, text: &str) -> Result<String, PageError> {
    let parts = || {
        let (before, rest) = page.split_once(&begin(name))?;
        let (_, after) = rest.split_once(&end(name))?;
        let again = |part: &str| part.contains(&begin(name)) || part.contains(&end(name));
        (!again(before) && !rest.contains(&begin(name)) && !again(after)).then_some((before, after))
    };
    let (before, after) = parts().ok_or_else(|| PageError {
        name: name.to_owned(),
    })?;
    Ok(format!(
        "{before}{}\n{}\n{}{after}",
        begin(name),
        text.trim_end(),
        end(name)
    ))
}

fn begin(name: impl fmt::Display) -> String {
    format!("<!-- begin {name} -->")
}

fn end(name: impl fmt::Display) -> String {
    format!("<!-- end {name} -->")
}

#[cfg(test)]
mod tests {
    use super::fill_in;

    const PAGE: &str =
        "# T\n\n<!-- begin a -->\nold\n<!-- end a -->\nprose\n<!-- begin ab -->\n<!-- end ab -->\n";

    #[test]
    fn only_the_named_part_changes_and_filling_again_changes_nothing() {
        let page = fill_in(PAGE, "a", "new\n\n").unwrap();
        assert_eq!(page, PAGE.replace("old", "new"));
        assert_eq!(fill_in(&page, "a", "new").unwrap(), page);
        let page = fill_in(PAGE, "ab", "x").unwrap();
        assert!(page.contains("old") && page.ends_with("<!-- begin ab -->\nx\n<!-- end ab -->\n"));
    }

    #[test]
    fn a_page_without_the_place_or_with_two_of_them_is_refused() {
        for page in [
            "",
            "<!-- begin a -->",
            "<!-- end a --> <!-- begin a -->",
            "<!-- begin a --> <!-- begin a --> <!-- end a -->",
            &PAGE.repeat(2),
        ] {
            let error = fill_in(page, "a", "x").unwrap_err();
            assert!(error.to_string().contains("`<!-- begin a -->`"), "{error}");
        }
    }
}
