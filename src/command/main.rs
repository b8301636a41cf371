//! The command `materialpoint`: runs scenes, compares methods. See `materialpoint --help`.

#![forbid(unsafe_code)]

mod cli;

use std::process::ExitCode;

use clap::Parser;

use cli::{Arguments, execute};

fn main() -> ExitCode {
    // Bad flags end with status 2 inside `parse`, as bad scenes do below.
    let arguments = Arguments::parse();
    match execute(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("materialpoint: {failure}");
            ExitCode::from(failure.status())
        }
    }
}
