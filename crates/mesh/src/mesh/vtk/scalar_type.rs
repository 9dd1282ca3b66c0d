//! The number types of VTK, and lists of such numbers.

use crate::error::Result;
use crate::mesh::reader::{Encoding, Number, Reader};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::mesh) enum ScalarType {
    Bit,
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Float32,
    Float64,
    Text,
}

// The names in XML files.
crate::named!(ScalarType {
    "Bit" => Bit,
    "Int8" => Int8,
    "UInt8" => UInt8,
    "Int16" => Int16,
    "UInt16" => UInt16,
    "Int32" => Int32,
    "UInt32" => UInt32,
    "Int64" => Int64,
    "UInt64" => UInt64,
    "Float32" => Float32,
    "Float64" => Float64,
    "String" => Text,
});

impl ScalarType {
    /// Reads the name of a type in a legacy file.
    pub fn read(reader: &mut Reader) -> Result<ScalarType> {
        let word = reader.peek();
        let scalar = match word.to_ascii_lowercase().as_slice() {
            b"bit" => ScalarType::Bit,
            b"char" | b"signed_char" | b"vtktypeint8" => ScalarType::Int8,
            b"unsigned_char" | b"vtktypeuint8" => ScalarType::UInt8,
            b"short" | b"vtktypeint16" => ScalarType::Int16,
            b"unsigned_short" | b"vtktypeuint16" => ScalarType::UInt16,
            // Legacy files store the ids of VTK in 32 bits, whatever their size in memory is.
            b"int" | b"vtkidtype" | b"vtktypeint32" => ScalarType::Int32,
            b"unsigned_int" | b"vtktypeuint32" => ScalarType::UInt32,
            b"long" | b"long_long" | b"vtktypeint64" => ScalarType::Int64,
            b"unsigned_long" | b"unsigned_long_long" | b"vtktypeuint64" => ScalarType::UInt64,
            b"float" => ScalarType::Float32,
            b"double" => ScalarType::Float64,
            b"string" | b"utf8_string" => ScalarType::Text,
            _ => return Err(reader.unexpected("a type such as int or double")),
        };
        reader.word();
        Ok(scalar)
    }

    pub fn is_real(self) -> bool {
        matches!(self, ScalarType::Float32 | ScalarType::Float64)
    }

    /// The bytes of one number in binary; none for types that are not stored in whole bytes.
    pub fn size(self) -> Option<u64> {
        match self {
            ScalarType::Bit | ScalarType::Text => None,
            ScalarType::Int8 | ScalarType::UInt8 => Some(1),
            ScalarType::Int16 | ScalarType::UInt16 => Some(2),
            ScalarType::Int32 | ScalarType::UInt32 | ScalarType::Float32 => Some(4),
            ScalarType::Int64 | ScalarType::UInt64 | ScalarType::Float64 => Some(8),
        }
    }

    /// Reads `count` numbers as reals.
    pub fn reals(self, reader: &mut Reader, count: u64) -> Result<Vec<f64>> {
        match self {
            ScalarType::Bit | ScalarType::Text => Err(reader.expected("a type of numbers", &format!("{self:?}"))),
            ScalarType::Int8 => list(reader, count, |i: i8, _| Ok(i.into())),
            ScalarType::UInt8 => list(reader, count, |i: u8, _| Ok(i.into())),
            ScalarType::Int16 => list(reader, count, |i: i16, _| Ok(i.into())),
            ScalarType::UInt16 => list(reader, count, |i: u16, _| Ok(i.into())),
            ScalarType::Int32 => list(reader, count, |i: i32, _| Ok(i.into())),
            ScalarType::UInt32 => list(reader, count, |i: u32, _| Ok(i.into())),
            ScalarType::Int64 => list(reader, count, |i: i64, _| Ok(i as f64)),
            ScalarType::UInt64 => list(reader, count, |i: u64, _| Ok(i as f64)),
            ScalarType::Float32 => list(reader, count, |x: f32, _| Ok(x.into())),
            ScalarType::Float64 => list(reader, count, |x, _| Ok(x)),
        }
    }

    /// Reads `count` whole numbers, each in the range of `U`, which `expected` names. `None` for other types, which are
    /// skipped.
    pub fn whole_numbers<U: TryFrom<i128>>(
        self,
        reader: &mut Reader,
        count: u64,
        expected: &str,
    ) -> Result<Option<Vec<U>>> {
        fn narrow<T: Into<i128>, U: TryFrom<i128>>(expected: &str) -> impl Fn(T, &Reader) -> Result<U> {
            move |number, reader| {
                let number = number.into();
                U::try_from(number).map_err(|_| reader.expected(expected, &number.to_string()))
            }
        }
        match self {
            ScalarType::Int8 => list(reader, count, narrow::<i8, U>(expected)).map(Some),
            ScalarType::UInt8 => list(reader, count, narrow::<u8, U>(expected)).map(Some),
            ScalarType::Int16 => list(reader, count, narrow::<i16, U>(expected)).map(Some),
            ScalarType::UInt16 => list(reader, count, narrow::<u16, U>(expected)).map(Some),
            ScalarType::Int32 => list(reader, count, narrow::<i32, U>(expected)).map(Some),
            ScalarType::UInt32 => list(reader, count, narrow::<u32, U>(expected)).map(Some),
            ScalarType::Int64 => list(reader, count, narrow::<i64, U>(expected)).map(Some),
            ScalarType::UInt64 => list(reader, count, narrow::<u64, U>(expected)).map(Some),
            ScalarType::Bit | ScalarType::Float32 | ScalarType::Float64 | ScalarType::Text => {
                self.skip(reader, count).map(|()| None)
            }
        }
    }

    /// Skips `count` values.
    pub fn skip(self, reader: &mut Reader, count: u64) -> Result<()> {
        if self == ScalarType::Text {
            return skip_texts(reader, count);
        }
        reader.announce("numbers", count);
        if reader.encoding == Encoding::Text {
            for _ in 0..count {
                reader.number::<f64>()?;
                reader.count_one();
            }
            return Ok(());
        }
        let bytes = self.size().map_or(count.div_ceil(8), |size| count.saturating_mul(size));
        reader.take(usize::try_from(bytes).unwrap_or(usize::MAX)).map(|_| ())
    }
}

fn list<T: Number, U>(reader: &mut Reader, count: u64, convert: impl Fn(T, &Reader) -> Result<U>) -> Result<Vec<U>> {
    reader.announce("numbers", count);
    let mut values = Vec::with_capacity(reader.capacity::<T>(count, 1));
    for _ in 0..count {
        let number = reader.number()?;
        values.push(convert(number, reader)?);
        reader.count_one();
    }
    Ok(values)
}

/// Skips texts, each on a line of its own or, in binary, after its length in 1, 2, 4 or 8 bytes.
fn skip_texts(reader: &mut Reader, count: u64) -> Result<()> {
    reader.announce("texts", count);
    for _ in 0..count {
        if reader.encoding == Encoding::Text {
            if reader.rest_of_line().len() == reader.rest().len() {
                return Err(reader.ends());
            }
            reader.line();
        } else {
            // The two highest bits give the number of bytes that follow, the others begin the length.
            let first = reader.number::<u8>()?;
            let more = reader.take([7, 3, 1, 0][usize::from(first >> 6)])?;
            let length = more.iter().fold(u64::from(first & 63), |length, &byte| length << 8 | u64::from(byte));
            reader.take(usize::try_from(length).unwrap_or(usize::MAX))?;
        }
        reader.count_one();
    }
    Ok(())
}
