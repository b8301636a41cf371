//! Numbers to bytes and back: little-endian, nothing in between.

use std::any::TypeId;
use std::io::{self, Read, Write};

use crate::error::RestoreError;
use crate::record::Record;
use crate::scalar::Scalar;

/// Whether the bits of `T` are all there in an `f64` or `f32`.
fn check_scalar<T: Scalar>() -> io::Result<()> {
    if [TypeId::of::<f64>(), TypeId::of::<f32>()].contains(&TypeId::of::<T>()) {
        return Ok(());
    }
    let name = std::any::type_name::<T>();
    let problem = format!("a checkpoint holds numbers of f64 and f32, not of {name}");
    Err(io::Error::new(io::ErrorKind::Unsupported, problem))
}

/// Enough for what any run counts, and far from what would overflow.
const MOST: usize = usize::MAX / 1024;

/// Takes numbers and writes them.
pub(in super::super) struct Out<'a> {
    bytes: &'a mut dyn Write,
}

impl<'a> Out<'a> {
    /// For numbers of `T`.
    pub(super) fn new<T: Scalar>(bytes: &'a mut dyn Write) -> io::Result<Self> {
        check_scalar::<T>()?;
        Ok(Self { bytes })
    }

    fn number<T: Scalar>(&mut self, value: T) -> io::Result<()> {
        let value = value.primal();
        if size_of::<T>() == size_of::<f32>() {
            return self.bytes.write_all(&(value as f32).to_le_bytes());
        }
        self.bytes.write_all(&value.to_le_bytes())
    }

    pub(super) fn numbers<T: Scalar>(&mut self, values: &[T]) -> io::Result<()> {
        values.iter().try_for_each(|&value| self.number(value))
    }

    /// The numbers of all values.
    pub(super) fn records<T: Scalar, Q: Record<T>>(&mut self, values: &[Q]) -> io::Result<()> {
        for value in values {
            let mut written = Ok(());
            value.put(&mut |number| {
                if written.is_ok() {
                    written = self.number(number);
                }
            });
            written?;
        }
        Ok(())
    }

    pub(super) fn count(&mut self, value: usize) -> io::Result<()> {
        self.bytes.write_all(&(value as u64).to_le_bytes())
    }

    pub(super) fn flag(&mut self, value: bool) -> io::Result<()> {
        self.bytes.write_all(&[u8::from(value)])
    }

    pub(super) fn indices(&mut self, values: &[u32]) -> io::Result<()> {
        let mut bytes = values.iter().map(|value| value.to_le_bytes());
        bytes.try_for_each(|bytes| self.bytes.write_all(&bytes))
    }
}

/// Reads numbers and hands them over.
pub(in super::super) struct In<'a> {
    bytes: &'a mut dyn Read,
}

impl<'a> In<'a> {
    /// For numbers of `T`.
    pub(super) fn new<T: Scalar>(bytes: &'a mut dyn Read) -> io::Result<Self> {
        check_scalar::<T>()?;
        Ok(Self { bytes })
    }

    fn array<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut array = [0; N];
        self.bytes.read_exact(&mut array)?;
        Ok(array)
    }

    fn number<T: Scalar>(&mut self) -> io::Result<T> {
        if size_of::<T>() == size_of::<f32>() {
            return Ok(T::lit(f64::from(f32::from_le_bytes(self.array()?))));
        }
        Ok(T::lit(f64::from_le_bytes(self.array()?)))
    }

    pub(super) fn numbers<T: Scalar>(&mut self, values: &mut [T]) -> io::Result<()> {
        for value in values {
            *value = self.number()?;
        }
        Ok(())
    }

    /// All values from their numbers; `what` names them.
    pub(super) fn records<T: Scalar, Q: Record<T>>(
        &mut self,
        what: &'static str,
        values: &mut [Q],
    ) -> Result<(), RestoreError> {
        for (index, value) in values.iter_mut().enumerate() {
            let mut read = Ok(());
            let taken = Q::take(&mut || {
                self.number().unwrap_or_else(|error| {
                    read = Err(error);
                    T::zero()
                })
            });
            read?;
            *value = taken.ok_or(RestoreError::Invalid { what, index })?;
        }
        Ok(())
    }

    pub(super) fn count(&mut self) -> Result<usize, RestoreError> {
        let value = u64::from_le_bytes(self.array()?);
        match usize::try_from(value) {
            Ok(value) if value <= MOST => Ok(value),
            _ => Err(RestoreError::Invalid {
                what: "a count above",
                index: MOST,
            }),
        }
    }

    /// A count below `end`; `what` and `index` name it.
    pub(super) fn count_below(
        &mut self,
        end: usize,
        what: &'static str,
        index: usize,
    ) -> Result<usize, RestoreError> {
        let value = self.count()?;
        if value < end {
            return Ok(value);
        }
        Err(RestoreError::Invalid { what, index })
    }

    /// Refuses any other count than the expected one.
    pub(super) fn expect(&mut self, what: &'static str, expected: usize) -> Result<(), RestoreError> {
        let found = self.count()?;
        if found == expected {
            return Ok(());
        }
        Err(RestoreError::Other {
            what,
            found,
            expected,
        })
    }

    pub(super) fn flag(&mut self) -> io::Result<bool> {
        Ok(self.array::<1>()? != [0])
    }

    pub(super) fn indices(&mut self, values: &mut [u32]) -> io::Result<()> {
        for value in values {
            *value = u32::from_le_bytes(self.array()?);
        }
        Ok(())
    }
}
