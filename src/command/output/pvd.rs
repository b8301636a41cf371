//! The index of a series of files in time, which ParaView opens as one.

use std::path::PathBuf;

use super::table::number;
use super::text::escape;
use super::{Folder, OutputError, PointCloud};

/// One moment of a series.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesFrame {
    /// When (s); finite.
    pub time: f64,
    /// Name of the file, beside the index.
    pub file: String,
}

/// Frames of a run: files `NAME-000000.vtu`, `NAME-000001.vtu`, ... and their index `NAME.pvd`.
///
/// Plain data, so that a checkpoint can hold it and a resumed run go on where the older one stopped.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// What the names of the files begin with.
    pub name: String,
    /// The frames so far, ascending in time.
    pub frames: Vec<SeriesFrame>,
}

impl Series {
    /// A series without frames.
    pub fn new(name: &str) -> Series {
        Series {
            name: name.to_owned(),
            frames: Vec::new(),
        }
    }

    /// Writes the particles at a time (s) and, once their file is complete, the index anew; returns where the
    /// particles are.
    ///
    /// Whenever the run ends, the index names complete files only.
    ///
    /// # Errors
    /// Those of [`PointCloud::write_vtu`]. The index on the disk is then the one before, and the series in
    /// memory too.
    pub fn add(&mut self, folder: &Folder, time: f64, cloud: &PointCloud) -> Result<PathBuf, OutputError> {
        let file = format!("{}-{:06}.vtu", self.name, self.frames.len());
        let path = cloud.write_vtu(folder, &file)?;
        self.frames.push(SeriesFrame { time, file });
        match self.write_pvd(folder) {
            Ok(_) => Ok(path),
            Err(error) => {
                self.frames.pop();
                Err(error)
            }
        }
    }

    /// Writes the index of the frames so far and returns where it is.
    ///
    /// # Errors
    /// Those of [`Folder::write_with`].
    pub fn write_pvd(&self, folder: &Folder) -> Result<PathBuf, OutputError> {
        folder.write_with(&format!("{}.pvd", self.name), |out| {
            out.write_all(HEAD.as_bytes())?;
            for SeriesFrame { time, file } in &self.frames {
                let (time, file) = (number(*time), escape(file));
                writeln!(
                    out,
                    "<DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{file}\"/>"
                )?;
            }
            out.write_all(TAIL.as_bytes())
        })
    }
}

const HEAD: &str = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" \
    byte_order=\"LittleEndian\">\n<Collection>\n";
const TAIL: &str = "</Collection>\n</VTKFile>\n";
