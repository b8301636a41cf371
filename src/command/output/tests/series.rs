//! Goal: at every moment of a run the index names complete files, all of them, at their times.

use std::fs;
use std::path::Path;

use vtkio::Vtk;

use super::scratch::Scratch;
use super::vtu::cloud;
use crate::output::{Folder, OutputError, Series};

/// Times and files of an index.
fn read(index: &Path) -> Vec<(f64, String)> {
    let text = fs::read_to_string(index).unwrap();
    assert!(text.contains("type=\"Collection\"") && text.ends_with("</VTKFile>\n"));
    let attribute = |line: &str, name: &str| {
        let (_, rest) = line.split_once(&format!(" {name}=\"")).unwrap();
        rest.split('"').next().unwrap().to_owned()
    };
    let entries = text.lines().filter(|line| line.starts_with("<DataSet "));
    entries
        .map(|line| {
            (
                attribute(line, "timestep").parse().unwrap(),
                attribute(line, "file"),
            )
        })
        .collect()
}

fn check_complete(folder: &Folder, times: &[f64]) {
    let entries = read(&folder.path().join("particles.pvd"));
    let found: Vec<u64> = entries.iter().map(|(time, _)| time.to_bits()).collect();
    let expected: Vec<u64> = times.iter().map(|time| time.to_bits()).collect();
    assert_eq!(found, expected);
    for (_, file) in entries {
        assert!(Vtk::import(folder.path().join(file)).is_ok());
    }
}

#[test]
fn after_every_frame_the_index_is_complete() {
    let scratch = Scratch::new("series");
    let folder = scratch.folder();
    let times = [0.0, 0.1, 1.0 / 3.0, 1e-7 + 0.5];
    let mut series = Series::new("particles");
    for (i, time) in times.iter().enumerate() {
        let path = series.add(&folder, *time, &cloud(i + 1)).unwrap();
        assert_eq!(path, folder.path().join(format!("particles-00000{i}.vtu")));
        check_complete(&folder, &times[..=i]);
    }
}

#[test]
fn a_frame_that_cannot_be_written_leaves_the_index_before() {
    let scratch = Scratch::new("series-failed");
    let folder = scratch.folder();
    let mut series = Series::new("particles");
    series.add(&folder, 0.0, &cloud(2)).unwrap();
    let before = series.clone();
    let mut wrong = cloud(2);
    wrong.positions.pop();
    series.add(&folder, 0.1, &wrong).unwrap_err();
    // A folder in the way of the next file.
    let taken = folder.path().join("particles-000001.vtu");
    fs::create_dir(&taken).unwrap();
    let error = series.add(&folder, 0.1, &cloud(2)).unwrap_err();
    assert!(matches!(&error, OutputError::Write { path, .. } if *path == taken));
    check_complete(&folder, &[0.0]);
    assert_eq!(series, before);
    fs::remove_dir(&taken).unwrap();
    series.add(&folder, 0.2, &cloud(2)).unwrap();
    check_complete(&folder, &[0.0, 0.2]);
}

#[test]
fn an_index_that_cannot_be_written_takes_the_frame_back() {
    let scratch = Scratch::new("series-index");
    let folder = scratch.folder();
    fs::create_dir(folder.path().join("particles.pvd")).unwrap();
    let mut series = Series::new("particles");
    series.add(&folder, 0.0, &cloud(2)).unwrap_err();
    assert!(series.frames.is_empty());
}
