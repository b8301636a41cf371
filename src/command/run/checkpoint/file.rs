//! The container: eight bytes that say what the file is, a version, the content, and a checksum of all before
//! it.
//!
//! Everything is little-endian. The checksum is checked before anything is believed, so that a damaged file
//! is told from a sound one at once, and no length in it makes us ask for memory that it does not fill.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Take, Write};
use std::path::Path;

use super::CheckpointError;

/// First bytes of the file. Not text, and changed by whatever changes the ends of lines.
const MAGIC: [u8; 8] = *b"\x8aMPM\r\n\x1a\n";
/// Format of all that follows.
pub(super) const VERSION: u32 = 6;
/// Bytes that are passed on at once, a multiple of the words of the checksum.
const BLOCK: usize = 1 << 16;
/// Bytes of the checksum.
const SEAL: u64 = 8;

/// Sum of words in which each step can be undone: a change within one word always changes the result.
#[derive(Clone, Copy)]
struct Checksum(u64);

impl Checksum {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Adds the bytes of a block; only the last one may end within a word.
    fn add(&mut self, block: &[u8]) {
        let (words, rest) = block.as_chunks::<8>();
        for word in words {
            self.add_word(u64::from_le_bytes(*word));
        }
        let mut last = [0; 8];
        last.iter_mut().zip(rest).for_each(|(to, &from)| *to = from);
        self.add_word(u64::from_le_bytes(last) ^ rest.len() as u64);
    }

    /// As FNV-1a does with bytes; the turn takes the upper bits to where the product mixes them.
    fn add_word(&mut self, word: u64) {
        self.0 = (self.0 ^ word)
            .wrapping_mul(0x0000_0100_0000_01b3)
            .rotate_left(29);
    }
}

/// Takes the content of a file, and seals it.
pub(super) struct Sealed<'a> {
    out: &'a mut dyn Write,
    block: Vec<u8>,
    sum: Checksum,
}

impl<'a> Sealed<'a> {
    /// Begins with what the file is.
    pub(super) fn new(out: &'a mut dyn Write) -> io::Result<Self> {
        let mut sealed = Self {
            out,
            block: Vec::with_capacity(BLOCK),
            sum: Checksum::new(),
        };
        sealed.write_all(&MAGIC)?;
        sealed.write_all(&VERSION.to_le_bytes())?;
        Ok(sealed)
    }

    /// Ends the file with the checksum.
    pub(super) fn finish(mut self) -> io::Result<()> {
        self.pass_on()?;
        self.out.write_all(&self.sum.0.to_le_bytes())
    }

    fn pass_on(&mut self) -> io::Result<()> {
        self.sum.add(&self.block);
        self.out.write_all(&self.block)?;
        self.block.clear();
        Ok(())
    }
}

impl Write for Sealed<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let room = BLOCK - self.block.len();
        let taken = bytes.get(..room).unwrap_or(bytes);
        self.block.extend_from_slice(taken);
        if self.block.len() == BLOCK {
            self.pass_on()?;
        }
        Ok(taken.len())
    }

    /// Only the end passes on what does not fill a block: the checksum counts blocks.
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The content of a file whose checksum agrees.
pub(super) type Content = BufReader<Take<File>>;

/// Opens the file and checks it as a whole; the content begins after the version.
pub(super) fn open(path: &Path) -> Result<Content, CheckpointError> {
    let damaged = |problem| CheckpointError::Damaged {
        path: path.into(),
        problem,
    };
    let read = |source: io::Error| match source.kind() {
        io::ErrorKind::UnexpectedEof => damaged("it ends early"),
        _ => CheckpointError::Read {
            path: path.into(),
            source,
        },
    };
    let mut file = File::open(path).map_err(read)?;
    let length = file.metadata().map_err(read)?.len();
    check_head(&mut file, path).map_err(read)??;
    file.rewind().map_err(read)?;
    let content = length.checked_sub(SEAL).ok_or_else(|| damaged("it ends early"))?;
    let sum = checksum(&mut (&mut file).take(content)).map_err(read)?;
    let mut seal = [0; SEAL as usize];
    file.read_exact(&mut seal).map_err(read)?;
    if u64::from_le_bytes(seal) != sum {
        return Err(damaged("its checksum does not agree"));
    }
    let head = (MAGIC.len() + size_of_val(&VERSION)) as u64;
    file.seek(SeekFrom::Start(head)).map_err(read)?;
    let rest = content
        .checked_sub(head)
        .ok_or_else(|| damaged("it ends early"))?;
    Ok(BufReader::with_capacity(BLOCK, file.take(rest)))
}

/// What the file is, and its version.
fn check_head(file: &mut File, path: &Path) -> io::Result<Result<(), CheckpointError>> {
    let mut magic = Vec::new();
    file.take(MAGIC.len() as u64).read_to_end(&mut magic)?;
    if magic != MAGIC {
        return Ok(Err(CheckpointError::NotACheckpoint { path: path.into() }));
    }
    let mut version = [0; 4];
    file.read_exact(&mut version)?;
    Ok(match u32::from_le_bytes(version) {
        VERSION => Ok(()),
        found => Err(CheckpointError::Version {
            path: path.into(),
            found,
        }),
    })
}

/// Of all that can be read.
fn checksum(from: &mut impl Read) -> io::Result<u64> {
    let (mut sum, mut block) = (Checksum::new(), Vec::with_capacity(BLOCK));
    loop {
        block.clear();
        from.take(BLOCK as u64).read_to_end(&mut block)?;
        sum.add(&block);
        if block.len() < BLOCK {
            return Ok(sum.0);
        }
    }
}
