//! Tables as CSV.

use std::io;
use std::path::PathBuf;

use super::{Folder, OutputError};

/// Columns of numbers with names that carry units, such as `x[m]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// One name a column, unit in brackets.
    pub header: Vec<String>,
    /// Columns of equal length, in the units of the header.
    pub columns: Vec<Vec<f64>>,
}

impl Table {
    /// Writes the table with as many digits as give back the same bits when read; the file is complete or
    /// absent.
    pub fn write_csv(&self, folder: &Folder, name: &str) -> Result<PathBuf, OutputError> {
        self.check(folder, name)?;
        let rows = self.columns.first().map_or(0, Vec::len);
        let row = |i: usize| {
            self.columns
                .iter()
                .filter_map(move |column| column.get(i))
                .copied()
                .map(number)
        };
        write(folder, name, &self.header, (0..rows).map(row))
    }

    fn check(&self, folder: &Folder, name: &str) -> Result<(), OutputError> {
        check_header(folder, name, self.header.len(), self.columns.len())?;
        let expected = self.columns.first().map_or(0, Vec::len);
        let mut named = self.header.iter().zip(&self.columns);
        match named.find(|(_, column)| column.len() != expected) {
            None => Ok(()),
            Some((column, values)) => Err(OutputError::Columns {
                path: folder.path().join(name),
                column: column.clone(),
                found: values.len(),
                expected,
            }),
        }
    }
}

/// Rows of text for tables that hold names as well as numbers (see [`number`]).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Records {
    /// One name a column, unit in brackets.
    pub header: Vec<String>,
    /// Rows with one field for each name; an empty field says "none".
    pub rows: Vec<Vec<String>>,
}

impl Records {
    /// Writes the rows, quoted where CSV asks for it; the file is complete or absent.
    pub fn write_csv(&self, folder: &Folder, name: &str) -> Result<PathBuf, OutputError> {
        for row in &self.rows {
            check_header(folder, name, self.header.len(), row.len())?;
        }
        write(folder, name, &self.header, self.rows.iter())
    }
}

/// The shortest text that reads back as the same number: `0.1`, `1e-7`, `NaN`, `inf`.
pub fn number(value: f64) -> String {
    format!("{value:?}")
}

fn check_header(folder: &Folder, name: &str, names: usize, columns: usize) -> Result<(), OutputError> {
    if names == columns {
        return Ok(());
    }
    Err(OutputError::Header {
        path: folder.path().join(name),
        names,
        columns,
    })
}

fn write<R>(
    folder: &Folder,
    name: &str,
    header: &[String],
    rows: impl Iterator<Item = R>,
) -> Result<PathBuf, OutputError>
where
    R: IntoIterator,
    R::Item: AsRef<[u8]>,
{
    folder.write_with(name, |file| {
        let mut csv = csv::Writer::from_writer(file);
        csv.write_record(header).map_err(system)?;
        for row in rows {
            csv.write_record(row).map_err(system)?;
        }
        csv.flush()
    })
}

/// The system's own error, which knows a full disk, where there is one within.
fn system(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        kind => io::Error::other(format!("{kind:?}")),
    }
}
