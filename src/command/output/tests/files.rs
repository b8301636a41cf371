//! Goal: what is written reads back to the bit, and what cannot be written says where and why.

use std::fs;

use super::scratch::Scratch;
use crate::output::{Folder, OutputError, Records, Table};

fn table(columns: Vec<Vec<f64>>) -> Table {
    Table {
        header: vec!["x[m]".into(), "stress[Pa]".into()],
        columns,
    }
}

#[test]
fn numbers_read_back_to_the_bit() {
    let scratch = Scratch::new("roundtrip");
    let x = vec![0.1, 1.0 / 3.0, -0.0, f64::MIN_POSITIVE, 5e-324];
    let stress = vec![f64::MAX, 1e16 + 2.0, -4e4, f64::INFINITY, f64::EPSILON];
    let path = table(vec![x.clone(), stress.clone()])
        .write_csv(&scratch.folder(), "p.csv")
        .unwrap();
    let mut reader = csv::Reader::from_path(path).unwrap();
    assert_eq!(reader.headers().unwrap(), vec!["x[m]", "stress[Pa]"]);
    let rows: Vec<(f64, f64)> = reader.deserialize().map(Result::unwrap).collect();
    for (row, (x, stress)) in rows.iter().zip(x.iter().zip(&stress)) {
        assert_eq!(
            (row.0.to_bits(), row.1.to_bits()),
            (x.to_bits(), stress.to_bits())
        );
    }
    assert_eq!(rows.len(), 5);
}

#[test]
fn an_empty_table_is_its_header() {
    let scratch = Scratch::new("empty");
    let path = table(vec![Vec::new(), Vec::new()])
        .write_csv(&scratch.folder(), "p.csv")
        .unwrap();
    assert_eq!(fs::read_to_string(path).unwrap(), "x[m],stress[Pa]\n");
}

#[test]
fn unequal_columns_are_refused_and_nothing_is_written() {
    let scratch = Scratch::new("unequal");
    let folder = scratch.folder();
    let error = table(vec![vec![1.0, 2.0], vec![1.0]])
        .write_csv(&folder, "p.csv")
        .unwrap_err();
    assert!(
        matches!(&error, OutputError::Columns { column, found: 1, expected: 2, .. } if column == "stress[Pa]")
    );
    let error = table(vec![vec![1.0]]).write_csv(&folder, "p.csv").unwrap_err();
    assert!(matches!(
        error,
        OutputError::Header {
            names: 2,
            columns: 1,
            ..
        }
    ));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn names_with_commas_are_quoted() {
    let scratch = Scratch::new("records");
    let header = vec!["method".into(), "error[-]".into()];
    let records = Records {
        header,
        rows: vec![vec!["linear, Taylor".into(), "1e-3".into()]],
    };
    let path = records.write_csv(&scratch.folder(), "study.csv").unwrap();
    assert_eq!(
        fs::read_to_string(path).unwrap(),
        "method,error[-]\n\"linear, Taylor\",1e-3\n"
    );
}

#[test]
fn a_folder_below_a_file_is_refused_by_name() {
    let scratch = Scratch::new("refused");
    let file = scratch.folder().write("file", "").unwrap();
    let wanted = file.join("out");
    let error = Folder::create(&wanted).unwrap_err();
    assert!(matches!(&error, OutputError::Create { path, .. } if *path == wanted));
    assert!(
        error.to_string().contains(&format!("`{}`", wanted.display())),
        "{error}"
    );
}

#[test]
fn a_failed_write_names_the_file_and_leaves_the_older_one() {
    let scratch = Scratch::new("failed");
    let folder = scratch.folder();
    let path = folder.write("kept.txt", "older").unwrap();
    let half = |file: &mut dyn std::io::Write| {
        file.write_all(b"new")
            .and(Err(std::io::Error::other("disk full")))
    };
    let error = folder.write_with("kept.txt", |file| half(file)).unwrap_err();
    let expected = format!("the file `{}` cannot be written (disk full)", path.display());
    assert_eq!(error.to_string(), expected);
    assert_eq!(fs::read_to_string(path).unwrap(), "older");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_folder_that_vanished_is_an_error() {
    let scratch = Scratch::new("vanished");
    let folder = scratch.folder();
    fs::remove_dir_all(folder.path()).unwrap();
    assert!(matches!(
        folder.write("p.csv", "1"),
        Err(OutputError::Write { .. })
    ));
}
