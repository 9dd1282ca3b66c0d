//! The storage of arrays in a `.vtu`: in base64 or raw, as bytes after their number or as compressed blocks after a header.

use super::compression::Compression;
use crate::error::{Error, Result};
use base64::alphabet::STANDARD;
use base64::engine::general_purpose::{GeneralPurpose, PAD};
use base64::{DecodeError, Engine};
use std::borrow::Cow;

/// Base64 with padding. Some programs leave bits after the last byte, which are ignored.
const BASE64: GeneralPurpose = GeneralPurpose::new(&STANDARD, PAD.with_decode_allow_trailing_bits(true));

/// How all arrays of a file are stored.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Storage {
    pub compression: Option<Compression>,
    /// Whether the numbers of a header have eight bytes instead of four.
    pub wide: bool,
    pub big_endian: bool,
}

/// The bytes of a file from the first byte of one array.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stored<'a> {
    pub bytes: &'a [u8],
    pub in_base64: bool,
}

/// A stored array whose header has been checked.
pub(super) struct Data<'a> {
    stored: Stored<'a>,
    /// The number of bytes of the decoded array.
    pub size: usize,
    /// The number of bytes of the stored array.
    pub stored_size: usize,
    layout: Layout,
}

enum Layout {
    /// The data follow their number, which has so many bytes, in the same run of base64.
    Plain {
        header: usize,
    },
    Blocks {
        start: usize,
        block: usize,
        compressed: Vec<usize>,
        compression: Compression,
    },
}

impl<'a> Stored<'a> {
    /// The number of stored bytes for so many decoded bytes.
    fn length(self, count: usize) -> usize {
        if self.in_base64 { count.div_ceil(3).saturating_mul(4) } else { count }
    }

    /// The `count` bytes that are stored from `start` as one run.
    fn run(self, start: usize, count: usize) -> Result<Cow<'a, [u8]>> {
        let rest = self.bytes.get(start..).unwrap_or_default();
        let length = self.length(count);
        let Some(run) = rest.get(..length) else {
            let unit = if self.in_base64 { "characters of base64" } else { "bytes" };
            return Err(Error::new(format!("expected {length} {unit}, found {}", rest.len())));
        };
        if !self.in_base64 {
            return Ok(Cow::Borrowed(run));
        }
        let mut bytes = BASE64.decode(run).map_err(|error| not_base64(&error, run))?;
        if bytes.len() < count {
            return Err(Error::new(format!("expected base64 of {count} bytes, found {}", bytes.len())));
        }
        bytes.truncate(count);
        Ok(Cow::Owned(bytes))
    }
}

impl Storage {
    fn width(self) -> usize {
        if self.wide { 8 } else { 4 }
    }

    /// The numbers of a header.
    fn numbers(self, header: &[u8]) -> impl Iterator<Item = usize> {
        header.chunks_exact(self.width()).map(move |bytes| {
            let fold = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
            let number = if self.big_endian { bytes.iter().fold(0, fold) } else { bytes.iter().rev().fold(0, fold) };
            // Larger than any file, and refused as such where it is compared with what is stored.
            usize::try_from(number).unwrap_or(usize::MAX)
        })
    }

    /// Reads the header of an array.
    ///
    /// # Errors
    /// It claims more data than the stored bytes can hold.
    pub fn open(self, stored: Stored<'_>) -> Result<Data<'_>> {
        let width = self.width();
        let first = stored.run(0, width)?;
        let first = self.numbers(&first).next().unwrap_or(0);
        if let Some(compression) = self.compression {
            return self.open_blocks(stored, first, compression);
        }
        // A header can claim any number, so nothing may overflow from here on.
        let stored_size = stored.length(first.saturating_add(width));
        if stored_size > stored.bytes.len() {
            let room = if stored.in_base64 { stored.bytes.len() / 4 * 3 } else { stored.bytes.len() };
            let found = room.saturating_sub(width);
            return Err(Error::new(format!("expected {first} bytes of data by the header, found {found}")));
        }
        Ok(Data { stored, size: first, stored_size, layout: Layout::Plain { header: width } })
    }

    /// A header has the number of blocks, their size, the size of the last one (0 if it is as large as the others), and
    /// the compressed sizes of all blocks.
    fn open_blocks(self, stored: Stored<'_>, count: usize, compression: Compression) -> Result<Data<'_>> {
        // The count itself, the size of the blocks and that of the last one stand before the compressed sizes.
        let length = count.saturating_add(3).saturating_mul(self.width());
        if stored.length(length) > stored.bytes.len() {
            let found = stored.bytes.len();
            return Err(Error::new(format!("expected the sizes of {count} compressed blocks, found {found} bytes")));
        }
        let header = stored.run(0, length)?;
        let mut numbers = self.numbers(&header).skip(1);
        let (block, last) = (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0));
        let compressed: Vec<usize> = numbers.collect();
        let start = stored.length(length);
        let total = compressed.iter().fold(0, |total: usize, &size| total.saturating_add(size));
        let stored_size = start.saturating_add(stored.length(total));
        if stored_size > stored.bytes.len() {
            let found = stored.bytes.len() - start;
            return Err(Error::new(format!(
                "expected {total} bytes of compressed data, found {found} with their coding"
            )));
        }
        // The format gives the size of the last block apart, as zero where that block is whole.
        let size = match count.checked_sub(1) {
            None => 0,
            Some(whole) => block.saturating_mul(whole).saturating_add(if last == 0 { block } else { last }),
        };
        // Asked before memory is taken: a short file can claim any size.
        if count > 0 && (block == 0 || last > block || size / compression.most() > total) {
            let expected = format!("blocks that compress to {total} bytes in all");
            return Err(Error::new(format!("expected {expected}, found {count} of {block} bytes, the last of {last}")));
        }
        Ok(Data { stored, size, stored_size, layout: Layout::Blocks { start, block, compressed, compression } })
    }
}

impl<'a> Data<'a> {
    /// Decodes the array: `size` bytes.
    ///
    /// # Errors
    /// The data are not in base64, or a block is not in the format of its compression or has another size.
    pub fn decode(self) -> Result<Cow<'a, [u8]>> {
        let Data { stored, size, layout, .. } = self;
        match layout {
            Layout::Plain { header } => Ok(match stored.run(0, header + size)? {
                Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[header..]),
                Cow::Owned(mut bytes) => {
                    bytes.drain(..header);
                    Cow::Owned(bytes)
                }
            }),
            Layout::Blocks { start, block, compressed, compression } => {
                let bytes = stored.run(start, compressed.iter().sum())?;
                compression.expanded(&bytes, &compressed, block, size).map(Cow::Owned)
            }
        }
    }
}

/// The error for data that are not base64.
fn not_base64(error: &DecodeError, run: &[u8]) -> Error {
    let found = match error {
        DecodeError::InvalidByte(place, byte) | DecodeError::InvalidLastSymbol(place, byte) => {
            let byte =
                if byte.is_ascii_graphic() { format!("\"{}\"", char::from(*byte)) } else { format!("byte {byte}") };
            format!("{byte} as character {}", place + 1)
        }
        DecodeError::InvalidLength(_) => format!("{} characters, no multiple of four", run.len()),
        DecodeError::InvalidPadding => "a wrong number of \"=\" at the end".into(),
    };
    Error::new(format!("expected base64, found {found}"))
}

/// Encodes bytes as one run of base64.
pub(super) fn base64(bytes: &[u8]) -> String {
    BASE64.encode(bytes)
}
