//! Particles of one moment as a VTK unstructured grid, which ParaView opens.
//!
//! Every particle is a point and a vertex cell. Numbers are little-endian `Float64` in base64, bit for bit,
//! so that the file is well-formed XML; it is streamed, nothing is held twice. Our own writer, since the
//! crate `vtkio`, which reads the files back in the tests, holds a file several times in memory, gives
//! vectors the range of their components, and writes no particles in a way that VTK refuses.

use std::collections::HashSet;
use std::io::{self, Write};
use std::path::PathBuf;

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;

use super::text::escape;
use super::{Folder, OutputError};

/// VTK's number of the cell that is one point.
const VERTEX: u8 = 1;

/// What a field has at each particle; the order of components is VTK's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Components {
    /// One number.
    Scalar,
    /// `x`, `y`, `z`.
    Vector,
    /// `xx`, `yy`, `zz`, `xy`, `yz`, `xz`: not the order of the columns in tables, which end in `xy`, `xz`,
    /// `yz`.
    Symmetric,
    /// `xx`, `xy`, `xz`, `yx`, ..., `zz`: row by row.
    Tensor,
}

impl Components {
    /// How many numbers a particle has.
    pub fn count(self) -> usize {
        self.names().len().max(1)
    }

    fn names(self) -> &'static [&'static str] {
        match self {
            Self::Scalar => &[],
            Self::Vector => &["x", "y", "z"],
            Self::Symmetric => &["xx", "yy", "zz", "xy", "yz", "xz"],
            Self::Tensor => &["xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"],
        }
    }
}

/// A named quantity of all particles.
#[derive(Clone, Debug, PartialEq)]
pub struct PointField {
    /// Name with the unit in brackets, such as `stress[Pa]`; no other field of the cloud has it.
    pub name: String,
    /// What a particle has of it.
    pub components: Components,
    /// The numbers, particle by particle, in the unit that the name says.
    pub values: Vec<f64>,
}

/// Particles of one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointCloud {
    /// Where the particles are (m); in two dimensions `z` is 0, in one `y` too.
    pub positions: Vec<[f64; 3]>,
    /// What they carry.
    pub fields: Vec<PointField>,
    /// Numbers about the whole, by name: `TimeValue` is what ParaView calls the time (s).
    pub field_data: Vec<(String, f64)>,
}

impl PointCloud {
    /// Writes the particles as `name`, which should end in `.vtu`; the file is complete or as it was.
    ///
    /// # Errors
    /// [`OutputError::Field`] if a field has not as many values as the particles need,
    /// [`OutputError::FieldName`] if it has no name or that of another; otherwise those of
    /// [`Folder::write_with`].
    pub fn write_vtu(&self, folder: &Folder, name: &str) -> Result<PathBuf, OutputError> {
        self.check(folder, name)?;
        folder.write_with(name, |file| self.stream(file))
    }

    fn check(&self, folder: &Folder, file: &str) -> Result<(), OutputError> {
        let mut names = HashSet::new();
        for PointField {
            name,
            components,
            values,
        } in &self.fields
        {
            let path = || folder.path().join(file);
            if name.is_empty() || !names.insert(name) {
                return Err(OutputError::FieldName {
                    path: path(),
                    field: name.clone(),
                });
            }
            let expected = self.positions.len() * components.count();
            if values.len() != expected {
                return Err(OutputError::Field {
                    path: path(),
                    field: name.clone(),
                    found: values.len(),
                    expected,
                });
            }
        }
        Ok(())
    }

    fn stream(&self, file: &mut dyn Write) -> io::Result<()> {
        let n = self.positions.len();
        file.write_all(HEAD.as_bytes())?;
        if !self.field_data.is_empty() {
            writeln!(file, "<FieldData>")?;
            for (name, value) in &self.field_data {
                let attributes = format!("{} NumberOfTuples=\"1\"", attributes(name, Components::Scalar));
                array(file, "Float64", &attributes, [value.to_le_bytes()].into_iter())?;
            }
            writeln!(file, "</FieldData>")?;
        }
        writeln!(file, "<Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{n}\">")?;
        writeln!(file, "<PointData>")?;
        for field in &self.fields {
            let attributes = attributes(&field.name, field.components);
            array(
                file,
                "Float64",
                &attributes,
                field.values.iter().map(|v| v.to_le_bytes()),
            )?;
        }
        writeln!(file, "</PointData>\n<Points>")?;
        let coordinates = self.positions.as_flattened().iter().map(|v| v.to_le_bytes());
        array(
            file,
            "Float64",
            &attributes("Points", Components::Vector),
            coordinates,
        )?;
        writeln!(file, "</Points>\n<Cells>")?;
        cells(file, n)?;
        file.write_all(TAIL.as_bytes())
    }
}

const HEAD: &str = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
    byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n";
const TAIL: &str = "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";

/// Cell i is the point i.
fn cells(file: &mut dyn Write, n: usize) -> io::Result<()> {
    let numbers = |from: i64| (0..n).map(move |i| (from + i as i64).to_le_bytes());
    array(file, "Int64", " Name=\"connectivity\"", numbers(0))?;
    array(file, "Int64", " Name=\"offsets\"", numbers(1))?;
    let types = std::iter::repeat_n([VERTEX], n);
    array(file, "UInt8", " Name=\"types\"", types)
}

fn attributes(name: &str, components: Components) -> String {
    let mut text = format!(" Name=\"{}\"", escape(name));
    if components != Components::Scalar {
        text += &format!(" NumberOfComponents=\"{}\"", components.count());
    }
    for (i, name) in components.names().iter().enumerate() {
        text += &format!(" ComponentName{i}=\"{name}\"");
    }
    text
}

/// One array: its size in bytes, then its numbers, in one run of base64.
fn array<const N: usize>(
    file: &mut dyn Write,
    kind: &str,
    attributes: &str,
    numbers: impl ExactSizeIterator<Item = [u8; N]>,
) -> io::Result<()> {
    write!(file, "<DataArray type=\"{kind}\"{attributes} format=\"binary\">")?;
    let mut encoder = EncoderWriter::new(&mut *file, &STANDARD);
    encoder.write_all(&((numbers.len() * N) as u64).to_le_bytes())?;
    for number in numbers {
        encoder.write_all(&number)?;
    }
    encoder.finish()?;
    drop(encoder);
    writeln!(file, "</DataArray>")
}
