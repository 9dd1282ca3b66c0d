//! Reads arrays of NumPy: a ZIP file of `.npy` files.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::NumpyFile;
use std::collections::BTreeMap;
use std::io::{Cursor, Read};
use zip::ZipArchive;

/// An array of numbers, rows first.
#[derive(Debug)]
pub struct Array {
    pub shape: Vec<usize>,
    pub values: Vec<f64>,
}

/// The arrays of a file by name, of numbers and of texts. Those of objects are left out.
pub struct Arrays {
    numbers: BTreeMap<String, Array>,
    texts: BTreeMap<String, Vec<String>>,
}

/// Bytes that the arrays of a file may have together. A header may claim any size, and memory is allocated by it.
const MOST: u64 = 1 << 36;

impl Arrays {
    pub fn read(bytes: &[u8]) -> Result<Arrays> {
        let wrong = |e: &dyn std::fmt::Display| {
            Error::new(format!("expected a ZIP file of arrays of NumPy: {e}")).of_kind(ErrorKind::Syntax)
        };
        let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| wrong(&e))?;
        let (mut numbers, mut texts) = (BTreeMap::new(), BTreeMap::new());
        let mut total = 0u64;
        for index in 0..archive.len() {
            let mut file = archive.by_index(index).map_err(|e| wrong(&e))?;
            let name = file.name().map_err(|e| wrong(&e))?.into_owned();
            let name = name.strip_suffix(".npy").unwrap_or(&name).to_string();
            total = total.saturating_add(file.size());
            if total > MOST {
                return Err(Error::new("the arrays are larger than 64 GB").of_kind(ErrorKind::Limit));
            }
            let (mut content, claimed) = (Vec::new(), file.size());
            // What is packed may be longer than its entry claims.
            file.by_ref()
                .take(claimed.saturating_add(1))
                .read_to_end(&mut content)
                .map_err(|e| wrong(&e).at_key(&*name))?;
            if content.len() as u64 != claimed {
                let found = if content.len() as u64 > claimed { "more" } else { "fewer" };
                return Err(wrong(&format!("expected {claimed} bytes, found {found}")).at_key(&*name));
            }
            if let Some(array) = parse(&content).map_err(|e| e.at_key(&*name))? {
                numbers.insert(name, array);
            } else if let Some(own) = parse_texts(&content).map_err(|e| e.at_key(&*name))? {
                texts.insert(name, own);
            }
        }
        Ok(Arrays { numbers, texts })
    }

    pub fn get(&self, name: &str) -> Option<&Array> {
        self.numbers.get(name)
    }

    pub fn names(&self) -> Vec<&str> {
        self.numbers.keys().map(String::as_str).collect()
    }

    /// The first of several names that there is.
    pub fn first<'a>(&self, names: &[&'a str]) -> Option<(&'a str, &Array)> {
        names.iter().find_map(|name| Some((*name, self.get(name)?)))
    }

    /// The first of the texts of an array.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.texts.get(name)?.first().map(String::as_str)
    }

    /// A list of numbers.
    pub fn list(&self, name: &str, count: usize) -> Result<Option<Vec<f64>>> {
        let Some(array) = self.get(name) else { return Ok(None) };
        match array.values.len() == count {
            true => Ok(Some(array.values.clone())),
            false => {
                Err(Error::expected(name, format!("{count} numbers"), format!("an array of shape {:?}", array.shape)))
            }
        }
    }

    /// Rows of whole numbers, `[rows][width]`.
    pub fn places(&self, name: &str, widths: &[usize]) -> Result<Option<(Vec<i64>, usize)>> {
        let Some(array) = self.get(name) else { return Ok(None) };
        let width = match array.shape[..] {
            [_, width] if widths.contains(&width) => width,
            _ => {
                let widths: Vec<String> = widths.iter().map(usize::to_string).collect();
                let expected = format!("an array of shape (n, {})", widths.join(" or "));
                return Err(Error::expected(name, expected, format!("one of shape {:?}", array.shape)));
            }
        };
        match array.values.iter().find(|value| value.fract() != 0.0 || !value.is_finite()) {
            Some(value) => Err(Error::expected(name, "whole numbers", value)),
            None => Ok(Some((array.values.iter().map(|value| *value as i64).collect(), width))),
        }
    }
}

/// A file of the format; `None` of texts and objects.
fn parse(bytes: &[u8]) -> Result<Option<Array>> {
    let wrong = |what: &str| Error::expected("array", "a file of NumPy's format", what).of_kind(ErrorKind::Syntax);
    let file = NumpyFile::split(bytes)?;
    let (descr, is_turned, data) = (file.number()?, file.is_fortran()?, file.data);
    let shape: Vec<usize> = file.shape()?.iter().map(|size| usize::try_from(*size).unwrap_or(usize::MAX)).collect();
    let Some((size, number)) = number(descr) else { return Ok(None) };
    let count = shape.iter().try_fold(1usize, |product, size| product.checked_mul(*size));
    // The shape is what a file claims: the product may overflow, or exceed the bytes that follow.
    let count = count.filter(|count| count.checked_mul(size).is_some_and(|bytes| bytes <= data.len()));
    let count = count.ok_or_else(|| wrong("fewer numbers than its shape says"))?;
    let values: Vec<f64> = data.chunks_exact(size).take(count).map(number).collect();
    let values = match (&shape[..], is_turned) {
        // Fortran's order has columns first.
        ([rows, columns], true) => (0..count).map(|at| values[at % columns * rows + at / columns]).collect(),
        ([_, _, _, ..], true) => return Err(wrong("an array of three axes in Fortran's order")),
        _ => values,
    };
    Ok(Some(Array { shape, values }))
}

/// The texts of a file of the format; `None` of others.
fn parse_texts(bytes: &[u8]) -> Result<Option<Vec<String>>> {
    let file = NumpyFile::split(bytes)?;
    // Four bytes for each letter, with zeros behind the last one.
    let width = file.number()?.strip_prefix("<U").and_then(|letters| letters.parse::<usize>().ok());
    let Some(size) = width.and_then(|letters| letters.checked_mul(4)).filter(|size| *size > 0) else { return Ok(None) };
    let letter = |bytes: &[u8; 4]| char::from_u32(u32::from_le_bytes(*bytes)).filter(|letter| *letter != '\0');
    let text = |bytes: &[u8]| bytes.as_chunks::<4>().0.iter().map_while(letter).collect();
    Ok(Some(file.data.chunks_exact(size).map(text).collect()))
}

/// The bytes that a number has, and what reads it from them.
type Number = (usize, fn(&[u8]) -> f64);

/// How numbers of this type are read; none of texts and objects.
fn number(descr: &str) -> Option<Number> {
    macro_rules! of {
        ($type:ty) => {
            Some((size_of::<$type>(), |bytes| {
                <$type>::from_le_bytes(bytes.try_into().expect("a chunk has the size of a number")) as f64
            }))
        };
    }
    match descr {
        "<f8" => of!(f64),
        "<f4" => of!(f32),
        "<i8" => of!(i64),
        "<i4" => of!(i32),
        "<i2" => of!(i16),
        "|i1" => of!(i8),
        "<u8" => of!(u64),
        "<u4" => of!(u32),
        "<u2" => of!(u16),
        "|u1" | "|b1" => of!(u8),
        _ => None,
    }
}
