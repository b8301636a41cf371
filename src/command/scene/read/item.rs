//! One value of a scene, with the key that leads to it.

use toml::Value;

use super::Section;
use crate::scene::text::{one_of, show, type_name};
use crate::scene::{Expression, SceneError};

/// A value and its key. Every reading function names both when it refuses.
#[derive(Clone, Debug)]
pub(super) struct Item<'a> {
    pub(super) key: String,
    value: &'a Value,
}

impl<'a> Item<'a> {
    pub(super) fn new(key: String, value: &'a Value) -> Self {
        Self { key, value }
    }

    /// A finite number; whole ones count.
    pub(super) fn number(&self, expected: &str) -> Result<f64, SceneError> {
        let number = match self.value {
            Value::Float(number) => *number,
            Value::Integer(number) => *number as f64,
            _ => return Err(self.wrong_type(expected)),
        };
        if number.is_finite() {
            Ok(number)
        } else {
            Err(self.not_allowed(expected))
        }
    }

    /// A finite number for which `fits` holds; `expected` says in words what that is.
    pub(super) fn number_where(&self, expected: &str, fits: impl Fn(f64) -> bool) -> Result<f64, SceneError> {
        let number = self.number(expected)?;
        if fits(number) {
            Ok(number)
        } else {
            Err(self.not_allowed(expected))
        }
    }

    /// A number above 0.
    pub(super) fn positive(&self, unit: &str) -> Result<f64, SceneError> {
        self.number_where(&format!("a positive number ({unit})"), |number| number > 0.0)
    }

    /// A whole number from `least` to `most`.
    pub(super) fn count(&self, least: u64, most: u64) -> Result<u64, SceneError> {
        let expected = match most {
            u64::MAX => format!("a whole number, {least} or more"),
            _ => format!("a whole number from {least} to {most}"),
        };
        let Value::Integer(number) = self.value else {
            return Err(self.wrong_type(&expected));
        };
        match u64::try_from(*number) {
            Ok(number) if (least..=most).contains(&number) => Ok(number),
            _ => Err(self.not_allowed(&expected)),
        }
    }

    /// As [`Item::count`], to count things in memory.
    pub(super) fn size(&self, least: u64, most: u64) -> Result<usize, SceneError> {
        let number = self.count(least, most)?;
        usize::try_from(number).map_err(|_| self.not_allowed("a smaller number"))
    }

    /// Text.
    pub(super) fn text(&self, expected: &str) -> Result<&'a str, SceneError> {
        match self.value {
            Value::String(text) => Ok(text),
            _ => Err(self.wrong_type(expected)),
        }
    }

    /// The text, if it is one.
    pub(super) fn as_text(&self) -> Option<&'a str> {
        self.value.as_str()
    }

    /// `true` or `false`.
    pub(super) fn flag(&self, expected: &str) -> Result<bool, SceneError> {
        self.value.as_bool().ok_or_else(|| self.wrong_type(expected))
    }

    /// One of the names in `allowed`; names in `later` are part of the scene language but not of this
    /// version.
    pub(super) fn choice<T: Copy>(&self, allowed: &[(&str, T)], later: &[&str]) -> Result<T, SceneError> {
        let expected = one_of(allowed.iter().map(|choice| choice.0));
        let name = self.text(&expected)?;
        match allowed.iter().find(|choice| choice.0 == name) {
            Some(choice) => Ok(choice.1),
            None if later.contains(&name) => Err(self.not_in_this_version(&expected)),
            None => Err(self.not_allowed(&expected)),
        }
    }

    /// The entries of a list.
    pub(super) fn list(&self, expected: &str) -> Result<Vec<Item<'a>>, SceneError> {
        let Value::Array(entries) = self.value else {
            return Err(self.wrong_type(expected));
        };
        let entries = entries.iter().enumerate();
        let item = |(index, value)| Item::new(format!("{}.{index}", self.key), value);
        Ok(entries.map(item).collect())
    }

    /// A list with one entry per axis, each read by `entry`.
    pub(super) fn per_axis<T>(
        &self,
        dimension: usize,
        expected: &str,
        entry: impl Fn(&Item<'a>) -> Result<T, SceneError>,
    ) -> Result<Vec<T>, SceneError> {
        let entries = self.list(&format!("a list of {expected}, one per axis"))?;
        if entries.len() == dimension {
            return entries.iter().map(entry).collect();
        }
        Err(self.conflict(&format!(
            "it has {} of them and grid.min has {dimension}; expected a list of {expected}, one per axis",
            entries.len()
        )))
    }

    /// A table.
    pub(super) fn section(&self, expected: &str) -> Result<Section<'a>, SceneError> {
        match self.value {
            Value::Table(table) => Ok(Section::new(self.key.clone(), table)),
            _ => Err(self.wrong_type(expected)),
        }
    }

    /// An expression in the given variables.
    pub(super) fn expression(&self, variables: &[&str]) -> Result<Expression, SceneError> {
        let expected = format!("an expression in {}, in quotes", variables.join(", "));
        let text = self.text(&expected)?;
        Ok(Expression::parse_key(&self.key, text, variables)?)
    }

    pub(super) fn wrong_type(&self, expected: &str) -> SceneError {
        SceneError::WrongType {
            key: self.key.clone(),
            value: show(self.value),
            found: type_name(self.value),
            expected: expected.into(),
        }
    }

    pub(super) fn not_allowed(&self, expected: &str) -> SceneError {
        SceneError::NotAllowed {
            key: self.key.clone(),
            value: show(self.value),
            expected: expected.into(),
        }
    }

    pub(super) fn not_in_this_version(&self, expected: &str) -> SceneError {
        SceneError::NotInThisVersion {
            key: self.key.clone(),
            value: show(self.value),
            expected: expected.into(),
        }
    }

    /// `problem` says what the value does not go with, and what is allowed.
    pub(super) fn conflict(&self, problem: &str) -> SceneError {
        SceneError::Conflict {
            key: self.key.clone(),
            value: show(self.value),
            problem: problem.into(),
        }
    }
}
