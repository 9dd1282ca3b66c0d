//! Labels of voxels in NumPy's `.npy`: a header that describes an array, then its numbers.

use super::numbering::NumberOrigin;
use super::reader::{Encoding, Reader, quoted};
use super::source::MeshSource;
use super::vtk::{Image, Labels, Lattice, ScalarType, mesh};
use crate::error::{Error, ErrorKind, Result};

const MARK: &[u8] = b"\x93NUMPY";
/// The name of the labels in groups.
const NAME: &str = "label";

/// The mesh of the voxels whose label is not zero, of edge 1: `a[i, j, k]` is the voxel from (i, j, k) to (i + 1, j + 1, k + 1), and
/// `a[i, j]` the square from (i, j) to (i + 1, j + 1). Each label is a group, `label=3`.
///
/// The format: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>, versions 1 to 3.
///
/// # Errors
/// The file is of another kind, damaged or cut short; the array has another number of dimensions or no whole numbers; all labels are
/// zero, or they are grey values.
pub(super) fn parse(bytes: &[u8]) -> Result<MeshSource> {
    let file = NumpyFile::split(bytes)?;
    let (data, array) = (file.data, Array::of(&file)?);
    let count = array.shape.iter().try_fold(1_u64, |count, n| count.checked_mul(*n));
    let size = count.and_then(|count| count.checked_mul(array.scalar.size().unwrap_or(1)));
    if size != Some(data.len() as u64) {
        let expected = format!("{} numbers of {} bytes", shown(&array.shape), array.scalar.size().unwrap_or(1));
        let error = Error::expected("data", expected, format!("{} bytes", data.len()));
        return Err(error.of_kind(ErrorKind::Syntax));
    }
    let mut reader = Reader::new(data);
    reader.encoding = Encoding::Binary { big_endian: array.big_endian };
    reader.enter("data");
    let values = array.scalar.whole_numbers(&mut reader, count.unwrap_or(0), "a whole number")?;
    let values: Vec<i128> = values.unwrap_or_default();
    // An axis of one point is flat, one of two has a cell.
    let mut cells = [1; 3];
    cells[..array.shape.len()].copy_from_slice(&array.shape);
    let points: [u64; 3] = std::array::from_fn(|k| if k < array.shape.len() { cells[k] + 1 } else { 1 });
    if values.is_empty() {
        return Err(Error::expected("shape", "at least one voxel", shown(&array.shape)).of_kind(ErrorKind::Syntax));
    }
    let values = if array.is_fortran { values } else { turned(values, cells) };
    let steps = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let image = Image { lattice: Lattice::new(points)?, origin: [0.0; 3], steps };
    let piece = image.piece(vec![Labels { name: NAME.into(), values }], Vec::new(), None)?;
    Ok(MeshSource { origin: NumberOrigin::FilePlace, ..mesh(vec![piece])? })
}

/// The numbers with the first index fastest.
fn turned(values: Vec<i128>, [a, b, c]: [u64; 3]) -> Vec<i128> {
    let [a, b, c] = [a, b, c].map(|n| n as usize);
    let index = |i: usize, j: usize, k: usize| (i * b + j) * c + k;
    // NumPy's last axis runs fastest, and the first axis of a lattice.
    (0..values.len()).map(|at| values[index(at % a, at / a % b, at / a / b)]).collect()
}

/// A file of NumPy's format: a header that describes an array, and the bytes of its numbers.
///
/// The format: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>, versions 1 to 3.
#[derive(Debug, Clone, Copy)]
pub struct NumpyFile<'a> {
    /// The dictionary `{'descr': '<i4', 'fortran_order': False, 'shape': (6, 4, 3), }`.
    header: &'a str,
    /// The bytes of the numbers.
    pub data: &'a [u8],
}

impl<'a> NumpyFile<'a> {
    /// Takes the header from the numbers.
    ///
    /// # Errors
    /// The bytes are of another kind, or end inside the header.
    pub fn split(bytes: &'a [u8]) -> Result<NumpyFile<'a>> {
        let wrong = |problem: Error| problem.of_kind(ErrorKind::Syntax);
        let Some(rest) = bytes.strip_prefix(MARK) else {
            let found = quoted(&bytes[..bytes.len().min(6)]);
            return Err(wrong(Error::expected("header", "an array of NumPy, which begins with \\x93NUMPY", found)));
        };
        let ends = || wrong(Error::new("the file ends inside header"));
        let (length, rest) = match rest {
            // The length of the header has two bytes in version 1, and four bytes in later ones.
            [1, _, a, b, rest @ ..] => (u32::from(u16::from_le_bytes([*a, *b])), rest),
            [2 | 3, _, a, b, c, d, rest @ ..] => (u32::from_le_bytes([*a, *b, *c, *d]), rest),
            [1..=3, ..] | [] => return Err(ends()),
            [other, ..] => return Err(wrong(Error::expected("header", "version 1, 2 or 3", other))),
        };
        let (header, data) = rest.split_at_checked(length as usize).ok_or_else(ends)?;
        let header =
            std::str::from_utf8(header).map_err(|_| wrong(Error::expected("header", "text", "other bytes")))?;
        Ok(NumpyFile { header, data })
    }

    /// The type of a number, such as `<i4`; empty where it is no single text.
    ///
    /// # Errors
    /// The header does not say it.
    pub fn number(&self) -> Result<&'a str> {
        let text = self.value("descr")?.strip_prefix('\'').and_then(|rest| rest.split_once('\''));
        Ok(text.map_or("", |(kind, _)| kind))
    }

    /// Whether the first index is the fastest.
    ///
    /// # Errors
    /// The header does not say it.
    pub fn is_fortran(&self) -> Result<bool> {
        let order = self.value("fortran_order")?;
        match (order.starts_with("True"), order.starts_with("False")) {
            (true, _) => Ok(true),
            (_, true) => Ok(false),
            _ => Err(syntax("fortran_order", "True or False", order)),
        }
    }

    /// The numbers along each axis.
    ///
    /// # Errors
    /// The header does not say them.
    pub fn shape(&self) -> Result<Vec<u64>> {
        let shape = self.value("shape")?;
        let inner = shape.strip_prefix('(').and_then(|rest| rest.split_once(')')).map(|(inner, _)| inner);
        let counts = inner.map(|inner| inner.split(',').map(str::trim).filter(|count| !count.is_empty()));
        let counts: Option<Vec<u64>> = counts.and_then(|counts| counts.map(|count| count.parse().ok()).collect());
        counts.ok_or_else(|| syntax("shape", "counts such as (6, 4, 3)", shape))
    }

    /// The text after the key of the dictionary.
    fn value(&self, key: &str) -> Result<&'a str> {
        let header = self.header;
        let found = header.split_once(&format!("'{key}'")).and_then(|(_, rest)| rest.trim_start().strip_prefix(':'));
        found.map(str::trim_start).ok_or_else(|| syntax("header", &format!("a dictionary with '{key}'"), header))
    }
}

/// What the header says of labels.
struct Array {
    scalar: ScalarType,
    big_endian: bool,
    is_fortran: bool,
    shape: Vec<u64>,
}

impl Array {
    fn of(file: &NumpyFile) -> Result<Array> {
        let kind = file.number()?;
        let (order, number) = kind.split_at_checked(1).unwrap_or_default();
        let scalar = match number {
            "b1" | "u1" => ScalarType::UInt8,
            "i1" => ScalarType::Int8,
            "i2" => ScalarType::Int16,
            "u2" => ScalarType::UInt16,
            "i4" => ScalarType::Int32,
            "u4" => ScalarType::UInt32,
            "i8" => ScalarType::Int64,
            "u8" => ScalarType::UInt64,
            _ => {
                let expected = "whole numbers or bool, such as '<i4' or '|b1'";
                let descr = quoted(start(file.value("descr")?).as_bytes());
                let found = format!("{descr}; labels.astype(\"int32\") makes them");
                return Err(Error::expected("descr", expected, found).of_kind(ErrorKind::Unsupported));
            }
        };
        let big_endian = match order {
            "<" | "|" | "=" => false,
            ">" => true,
            _ => return Err(syntax("descr", "a byte order, one of < > |", file.value("descr")?)),
        };
        let (is_fortran, counts) = (file.is_fortran()?, file.shape()?);
        // Along an axis there is one point more than voxels, which must be a number too.
        if !(2..=3).contains(&counts.len()) || counts.iter().any(|count| *count >= u64::MAX / 2) {
            let error = Error::expected("shape", "an array of 2 or 3 dimensions", self::shown(&counts));
            return Err(error.of_kind(ErrorKind::Unsupported));
        }
        Ok(Array { scalar, big_endian, is_fortran, shape: counts })
    }
}

fn syntax(key: &str, expected: &str, found: &str) -> Error {
    Error::expected(key, expected, quoted(start(found).as_bytes())).of_kind(ErrorKind::Syntax)
}

/// The text up to the next comma outside a list.
fn start(text: &str) -> &str {
    text.split(", '").next().unwrap_or(text).trim_end_matches([',', '}', ' ', '\n'])
}

fn shown(shape: &[u64]) -> String {
    let counts: Vec<String> = shape.iter().map(u64::to_string).collect();
    format!("({})", counts.join(", "))
}
