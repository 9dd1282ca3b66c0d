//! Number types of legacy files and lists of them.

use crate::error::Result;
use crate::mesh::reader::{Encoding, Number, Reader};

#[derive(Debug, Clone, Copy)]
pub(super) enum Type {
    Bit,
    Char,
    UnsignedChar,
    Short,
    UnsignedShort,
    Int,
    UnsignedInt,
    Long,
    UnsignedLong,
    Float,
    Double,
    Text,
}

impl Type {
    /// Reads the name of a type.
    pub fn read(reader: &mut Reader) -> Result<Type> {
        let word = reader.peek();
        let kind = match word.to_ascii_lowercase().as_slice() {
            b"bit" => Type::Bit,
            b"char" | b"signed_char" | b"vtktypeint8" => Type::Char,
            b"unsigned_char" | b"vtktypeuint8" => Type::UnsignedChar,
            b"short" | b"vtktypeint16" => Type::Short,
            b"unsigned_short" | b"vtktypeuint16" => Type::UnsignedShort,
            // files hold the ids of VTK in 32 bits, whatever their size in memory
            b"int" | b"vtkidtype" | b"vtktypeint32" => Type::Int,
            b"unsigned_int" | b"vtktypeuint32" => Type::UnsignedInt,
            b"long" | b"long_long" | b"vtktypeint64" => Type::Long,
            b"unsigned_long" | b"unsigned_long_long" | b"vtktypeuint64" => Type::UnsignedLong,
            b"float" => Type::Float,
            b"double" => Type::Double,
            b"string" | b"utf8_string" => Type::Text,
            _ => return Err(reader.unexpected("a type such as int or double")),
        };
        reader.word();
        Ok(kind)
    }

    pub fn is_real(self) -> bool {
        matches!(self, Type::Float | Type::Double)
    }

    /// Reads `count` numbers as reals.
    pub fn reals(self, reader: &mut Reader, count: u64) -> Result<Vec<f64>> {
        match self {
            Type::Float => list(reader, count, |x: f32| x.into()),
            Type::Double => list(reader, count, |x| x),
            _ => Err(reader.expected("the type float or double", &format!("{self:?}").to_ascii_lowercase())),
        }
    }

    /// Reads `count` numbers; `None` if they are no whole numbers.
    pub fn whole_numbers(self, reader: &mut Reader, count: u64) -> Result<Option<Vec<i128>>> {
        match self {
            Type::Char => list(reader, count, |i: i8| i.into()).map(Some),
            Type::UnsignedChar => list(reader, count, |i: u8| i.into()).map(Some),
            Type::Short => list(reader, count, |i: i16| i.into()).map(Some),
            Type::UnsignedShort => list(reader, count, |i: u16| i.into()).map(Some),
            Type::Int => list(reader, count, |i: i32| i.into()).map(Some),
            Type::UnsignedInt => list(reader, count, |i: u32| i.into()).map(Some),
            Type::Long => list(reader, count, |i: i64| i.into()).map(Some),
            Type::UnsignedLong => list(reader, count, |i: u64| i.into()).map(Some),
            Type::Bit | Type::Float | Type::Double | Type::Text => self.skip(reader, count).map(|()| None),
        }
    }

    /// Moves past `count` values.
    pub fn skip(self, reader: &mut Reader, count: u64) -> Result<()> {
        if let Type::Text = self {
            return skip_texts(reader, count);
        }
        reader.start_data()?;
        reader.announce("numbers", count);
        if reader.encoding == Encoding::Text {
            for _ in 0..count {
                reader.number::<f64>()?;
                reader.count_one();
            }
            return Ok(());
        }
        let bytes = match self {
            Type::Bit => count.div_ceil(8),
            Type::Char | Type::UnsignedChar | Type::Text => count,
            Type::Short | Type::UnsignedShort => count.saturating_mul(2),
            Type::Int | Type::UnsignedInt | Type::Float => count.saturating_mul(4),
            Type::Long | Type::UnsignedLong | Type::Double => count.saturating_mul(8),
        };
        reader.take(usize::try_from(bytes).unwrap_or(usize::MAX)).map(|_| ())
    }
}

fn list<T: Number, U>(reader: &mut Reader, count: u64, convert: impl Fn(T) -> U) -> Result<Vec<U>> {
    reader.start_data()?;
    reader.announce("numbers", count);
    let mut values = Vec::with_capacity(reader.capacity::<T>(count, 1));
    for _ in 0..count {
        values.push(convert(reader.number()?));
        reader.count_one();
    }
    Ok(values)
}

/// Moves past texts, each on a line of its own or, in binary, after its length in 1, 2, 4 or 8 bytes.
fn skip_texts(reader: &mut Reader, count: u64) -> Result<()> {
    reader.line();
    reader.announce("texts", count);
    for _ in 0..count {
        if reader.encoding == Encoding::Text {
            if reader.rest_of_line().len() == reader.rest().len() {
                return Err(reader.ends());
            }
            reader.line();
        } else {
            // the two highest bits tell how many bytes follow, the others begin the length
            let first = reader.number::<u8>()?;
            let more = reader.take([7, 3, 1, 0][usize::from(first >> 6)])?;
            let length = more.iter().fold(u64::from(first & 63), |length, &byte| length << 8 | u64::from(byte));
            reader.take(usize::try_from(length).unwrap_or(usize::MAX))?;
        }
        reader.count_one();
    }
    Ok(())
}
