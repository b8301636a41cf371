//! What can go wrong on the way to the disk.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

/// Output that cannot be written.
#[derive(Debug, Error)]
pub enum OutputError {
    /// The folder does not exist and cannot be made.
    #[error("the output folder `{}` cannot be created ({source}); choose another folder", path.display())]
    Create {
        /// The folder asked for.
        path: PathBuf,
        /// What the system answered.
        source: io::Error,
    },
    /// The folder exists, but no file can be put into it.
    #[error("the output folder `{}` cannot be written to ({source}); choose another folder", path.display())]
    NotWritable {
        /// The folder asked for.
        path: PathBuf,
        /// What the system answered.
        source: io::Error,
    },
    /// One file cannot be written; an older file of that name is still as it was.
    #[error("the file `{}` cannot be written ({source})", path.display())]
    Write {
        /// The file asked for.
        path: PathBuf,
        /// What the system answered.
        source: io::Error,
    },
    /// No space, or no quota, is left for a file; nothing of it was kept.
    #[error("the disk is full: the file `{}` cannot be written ({source}); {}; free some space or choose another folder", path.display(), remains(.older))]
    DiskFull {
        /// The file asked for.
        path: PathBuf,
        /// Whether an older file of that name is there, as it was.
        older: bool,
        /// What the system answered.
        source: io::Error,
    },
    /// A table whose header and columns differ in number.
    #[error("the table `{}` has {names} names for {columns} columns", path.display())]
    Header {
        /// The file asked for.
        path: PathBuf,
        /// Names in the header.
        names: usize,
        /// Columns, or fields of the row at fault.
        columns: usize,
    },
    /// A table whose columns have different lengths.
    #[error("the table `{}` has {found} values in column `{column}` but {expected} in the first", path.display())]
    Columns {
        /// The file asked for.
        path: PathBuf,
        /// Name of the column at fault.
        column: String,
        /// Its length.
        found: usize,
        /// Length of the first column.
        expected: usize,
    },
    /// A field of particles that has not one value, or one set of components, for each.
    #[error("`{}`: the field `{field}` has {found} values where the particles need {expected}", path.display())]
    Field {
        /// The file asked for.
        path: PathBuf,
        /// Name of the field.
        field: String,
        /// How many values it has.
        found: usize,
        /// Particles times components.
        expected: usize,
    },
    /// A field of particles without a name, or with that of another.
    #[error("`{}`: the name `{field}` of a field is empty or taken; each needs one of its own", path.display())]
    FieldName {
        /// The file asked for.
        path: PathBuf,
        /// The name.
        field: String,
    },
}

fn remains(older: &bool) -> &'static str {
    if *older {
        "the older file of that name is still as it was"
    } else {
        "nothing of it was kept, and the files written before are complete"
    }
}
