//! One table of a scene, read key by key.

use toml::Table;

use super::Item;
use crate::scene::SceneError;
use crate::scene::text::shorten;

/// A table and the key that leads to it (empty for the scene itself).
#[derive(Debug)]
pub(super) struct Section<'a> {
    key: String,
    table: &'a Table,
}

impl<'a> Section<'a> {
    pub(super) fn new(key: String, table: &'a Table) -> Self {
        Self { key, table }
    }

    /// Refuses keys that are not in `known`. Keys in `later` are part of the scene language but not of this
    /// version, and are refused as such.
    pub(super) fn allow(self, known: &[&str], later: &[&str]) -> Result<Self, SceneError> {
        let unknown = self
            .table
            .iter()
            .find(|(name, _)| !known.contains(&name.as_str()));
        let Some((name, value)) = unknown else {
            return Ok(self);
        };
        let allowed = known.join(", ");
        if later.contains(&name.as_str()) {
            let item = Item::new(self.key_of(name), value);
            return Err(item.not_in_this_version(&format!("only {allowed}")));
        }
        let key = self.key_of(&shorten(name));
        Err(SceneError::UnknownKey { key, allowed })
    }

    /// Refuses any key.
    pub(super) fn allow_none(self) -> Result<Self, SceneError> {
        match self.items().first() {
            Some(item) => Err(item.conflict("this table is empty; leave it out")),
            None => Ok(self),
        }
    }

    /// The table under `name`, which every scene needs.
    pub(super) fn section(&self, name: &str) -> Result<Section<'a>, SceneError> {
        let expected = format!("a table, written [{name}]");
        self.required(name, &expected)?.section(&expected)
    }

    /// The table under `name`, if there is one.
    pub(super) fn optional_section(&self, name: &str) -> Result<Option<Section<'a>>, SceneError> {
        let expected = format!("a table, written [{name}]");
        self.optional(name)
            .map(|item| item.section(&expected))
            .transpose()
    }

    /// The value of `name`, if there is one.
    pub(super) fn optional(&self, name: &str) -> Option<Item<'a>> {
        let value = self.table.get(name)?;
        Some(Item::new(self.key_of(name), value))
    }

    /// The value of `name`; `expected` says what it takes.
    pub(super) fn required(&self, name: &str, expected: &str) -> Result<Item<'a>, SceneError> {
        self.optional(name).ok_or_else(|| SceneError::Missing {
            key: self.key_of(name),
            expected: expected.into(),
        })
    }

    /// The keys that are there, with their values, in alphabetical order.
    pub(super) fn items(&self) -> Vec<Item<'a>> {
        let entries = self.table.iter();
        entries
            .map(|(name, value)| Item::new(self.key_of(name), value))
            .collect()
    }

    /// Those of the given keys that are there.
    pub(super) fn present<'n>(&self, names: &[&'n str]) -> Vec<&'n str> {
        let there = |name: &&&str| self.table.contains_key(**name);
        names.iter().filter(there).copied().collect()
    }

    /// An error about the table as a whole.
    pub(super) fn missing(&self, expected: &str) -> SceneError {
        SceneError::Missing {
            key: self.key.clone(),
            expected: expected.into(),
        }
    }

    fn key_of(&self, name: &str) -> String {
        if self.key.is_empty() {
            name.into()
        } else {
            format!("{}.{name}", self.key)
        }
    }
}
