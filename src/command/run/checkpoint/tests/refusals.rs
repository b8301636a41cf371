//! Checkpoints that do not serve.

use std::fs;
use std::path::{Path, PathBuf};

use super::{BAR, resume, scene, with_checkpoint};
use crate::output::tests::scratch::Scratch;
use crate::run::checkpoint::file::Sealed;
use crate::run::{CheckpointError, RunError};
use std::io::Write;

/// The checkpoint of the bar, its bytes, and a place for changed ones.
fn bar(name: &str) -> (Scratch, PathBuf, Vec<u8>) {
    let (scratch, path, _) = with_checkpoint::<1>(name, &scene(BAR, &[]));
    let bytes = fs::read(&path).unwrap();
    (scratch, path.with_file_name("changed.mpm"), bytes)
}

#[track_caller]
fn refused(path: &Path, set: &[&str]) -> CheckpointError {
    match resume::<1>(&scene(BAR, set), path) {
        Err(RunError::Checkpoint(error)) => {
            let message = error.to_string();
            assert!(message.contains(&path.display().to_string()), "{message}");
            assert!(!message.contains('\n'), "{message}");
            *error
        }
        other => panic!("{:?}", other.map(|outcome| outcome.summary)),
    }
}

#[test]
fn a_file_that_ends_early_is_refused_wherever_it_ends() {
    let (_scratch, path, bytes) = bar("short");
    for length in 0..bytes.len() {
        fs::write(&path, &bytes[..length]).unwrap();
        let error = refused(&path, &[]);
        let expected = match length {
            0..8 => matches!(error, CheckpointError::NotACheckpoint { .. }),
            _ => matches!(error, CheckpointError::Damaged { .. }),
        };
        assert!(expected, "{length}: {error}");
    }
}

#[test]
fn every_bit_counts() {
    let (_scratch, path, bytes) = bar("flipped");
    for (place, bit) in (0..bytes.len()).flat_map(|place| [(place, place % 8), (place, (place * 5 + 3) % 8)])
    {
        let mut changed = bytes.clone();
        changed[place] ^= 1 << bit;
        fs::write(&path, &changed).unwrap();
        let error = refused(&path, &[]);
        let expected = match place {
            0..8 => matches!(error, CheckpointError::NotACheckpoint { .. }),
            8..12 => matches!(error, CheckpointError::Version { .. }),
            _ => matches!(error, CheckpointError::Damaged { .. }),
        };
        assert!(expected, "{place}: {error}");
    }
}

/// With a checksum that agrees: lengths of nothing, of more than there is, of more than memory.
#[test]
fn a_sealed_file_of_nonsense_is_refused_too() {
    let (_scratch, path, bytes) = bar("nonsense");
    let content = &bytes[12..bytes.len() - 8];
    let seal = |content: &[u8]| {
        let mut file = Vec::new();
        let mut sealed = Sealed::new(&mut file).unwrap();
        sealed.write_all(content).unwrap();
        sealed.finish().unwrap();
        fs::write(&path, file).unwrap();
    };
    seal(content);
    assert!(resume::<1>(&scene(BAR, &[]), &path).is_ok());
    for length in (0..content.len()).chain([content.len() + 1]) {
        let mut content = content.to_vec();
        content.resize(length, 0);
        seal(&content);
        refused(&path, &[]);
    }
    for place in 0..content.len() - 8 {
        for value in [u64::MAX, 1 << 40, 0] {
            let mut content = content.to_vec();
            content[place..place + 8].copy_from_slice(&value.to_le_bytes());
            seal(&content);
            // Most are refused; a number of the state may be any number. None may panic or ask for memory.
            let _ = resume::<1>(&scene(BAR, &[]), &path);
        }
    }
}

#[test]
fn another_scene_is_refused_by_the_key_that_differs() {
    let (_scratch, path, bytes) = bar("another");
    fs::write(&path, &bytes).unwrap();
    let message = refused(&path, &["grid.cells=[8]"]).to_string();
    assert!(
        message.contains("another scene: grid.cells was 4 and is 8 now"),
        "{message}"
    );
    let message = refused(&path, &["body.0.velocity=[\"2\"]"]).to_string();
    assert!(
        message.contains("body.0.velocity.0 was \"1\" and is \"2\" now"),
        "{message}"
    );
    let set = ["title=other", "output={particles=\"csv\"}"];
    assert!(resume::<1>(&scene(BAR, &set), &path).is_ok());
}

#[test]
fn another_end_is_refused_where_the_steps_would_be_others() {
    let (_scratch, path, bytes) = bar("ends");
    fs::write(&path, &bytes).unwrap();
    let error = refused(&path, &["time.end=1"]);
    assert!(
        matches!(
            error,
            CheckpointError::Beyond {
                done: 11,
                steps: 10,
                ..
            }
        ),
        "{error}"
    );
    // The eleventh step would be half as long.
    let error = refused(&path, &["time.end=1.05"]);
    assert!(
        matches!(error, CheckpointError::LastStep { done: 11, .. }),
        "{error}"
    );
    assert!(resume::<1>(&scene(BAR, &["time.end=1.1"]), &path).is_ok());
    let error = refused(&path, &["time.step=\"auto\""]);
    assert!(error.to_string().contains("time.step was Fixed"), "{error}");
}

#[test]
fn what_is_no_checkpoint_is_called_so() {
    let (_scratch, path, mut bytes) = bar("none");
    assert!(matches!(refused(&path, &[]), CheckpointError::Read { .. }));
    assert!(matches!(
        refused(path.parent().unwrap(), &[]),
        CheckpointError::Read { .. }
    ));
    fs::write(&path, "x0[m],x[m]\n").unwrap();
    assert!(matches!(
        refused(&path, &[]),
        CheckpointError::NotACheckpoint { .. }
    ));
    bytes[8] = 3;
    fs::write(&path, &bytes).unwrap();
    let message = refused(&path, &[]).to_string();
    assert!(
        message.contains("has format 3; this version reads format 6"),
        "{message}"
    );
}
