//! The table on the page: written there, and read again to be compared with.

use std::error::Error;
use std::fmt::{self, Write};
use std::path::PathBuf;

use materialpoint_command::output::fill_in;

use crate::case::Case;

/// Name of the page's part.
const PART: &str = "cost";

/// What a case costs.
pub struct Row {
    case: String,
    instructions: f64,
    time: f64,
}

impl Row {
    pub fn new(case: &Case, instructions: f64, time: f64) -> Self {
        Self {
            case: case.to_string(),
            instructions,
            time,
        }
    }
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "| {} | {:.1} | {:.1} |",
            self.case, self.instructions, self.time
        )
    }
}

fn page() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/verification/cost.md")
}

/// Writes the table into the page.
pub fn write(rows: &[Row]) -> Result<(), Box<dyn Error>> {
    let mut table = String::from("| case | instructions | ns |\n|---|---|---|\n");
    for row in rows {
        writeln!(table, "{row}")?;
    }
    let path = page();
    let filled = fill_in(&std::fs::read_to_string(&path)?, PART, &table)?;
    Ok(std::fs::write(path, filled)?)
}

/// The cases on the page with their instructions.
pub fn recorded() -> Result<Vec<(String, f64)>, Box<dyn Error>> {
    let text = std::fs::read_to_string(page())?;
    let row = |line: &str| {
        let mut cells = line.split('|').map(str::trim).skip(1);
        let case = cells.next()?.to_owned();
        Some((case, cells.next()?.parse().ok()?))
    };
    Ok(text.lines().filter_map(row).collect())
}
