//! The compression of the blocks of an array.

use crate::error::{Error, Result};
use flate2::{Decompress, FlushDecompress, Status};
use lzma_rust2::XzReader;
use std::io::Read;

/// How blocks are compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Compression {
    Zlib,
    Lz4,
    Xz,
}

impl Compression {
    /// The compression with this name.
    pub fn called(name: &str) -> Option<Compression> {
        Some(match name {
            "vtkZLibDataCompressor" => Compression::Zlib,
            "vtkLZ4DataCompressor" => Compression::Lz4,
            "vtkLZMADataCompressor" => Compression::Xz,
            _ => return None,
        })
    }

    fn title(self) -> &'static str {
        match self {
            Compression::Zlib => "zlib",
            Compression::Lz4 => "LZ4",
            Compression::Xz => "XZ",
        }
    }

    /// The largest ratio by which it compresses.
    pub fn most(self) -> usize {
        match self {
            // The formats themselves allow about these: deflate 1032 to 1, LZ4 255 to 1; a header that claims more is
            // wrong.
            Compression::Zlib => 1100,
            Compression::Lz4 => 260,
            Compression::Xz => 8000,
        }
    }

    /// The content of blocks of these compressed lengths: `size` bytes, all blocks but the last of `block` bytes.
    ///
    /// # Errors
    /// A block is not in the format of the compression, or has another size.
    pub fn expanded(self, bytes: &[u8], compressed: &[usize], block: usize, size: usize) -> Result<Vec<u8>> {
        let mut data = vec![0; size];
        let mut rest = bytes;
        let mut zlib = Decompress::new(true);
        // Without data the size of a block may be zero, which no chunk can be.
        for (i, (output, &length)) in data.chunks_mut(block.max(1)).zip(compressed).enumerate() {
            let (input, after) = rest.split_at(length);
            rest = after;
            let expected = output.len();
            let found = match self {
                Compression::Zlib => inflated(&mut zlib, input, output, i)?,
                Compression::Lz4 => {
                    let into = lz4_flex::block::decompress_into(input, output);
                    into.map_err(|error| self.not_of_format(i, &error.to_string()))?
                }
                // No more is expanded than the block holds: a short one could expand to any length.
                Compression::Xz => {
                    let mut reader = XzReader::new(input, false);
                    let read = reader.read_exact(output).and_then(|()| reader.read(&mut [0]));
                    expected + read.map_err(|error| self.not_of_format(i, &error.to_string()))?
                }
            };
            if found != expected {
                let expected = format!("{expected} bytes of data in compressed block {i}");
                return Err(Error::new(format!("expected {expected}, found {found}")));
            }
        }
        Ok(data)
    }

    fn not_of_format(self, block: usize, found: &str) -> Error {
        Error::new(format!(
            "expected data in the format of {}, found others in compressed block {block}: {found}",
            self.title()
        ))
    }
}

/// Expands a block of zlib, and returns its size.
fn inflated(zlib: &mut Decompress, input: &[u8], output: &mut [u8], block: usize) -> Result<usize> {
    zlib.reset(true);
    let status = zlib.decompress(input, output, FlushDecompress::Finish);
    let found = zlib.total_out() as usize;
    match status {
        Ok(Status::StreamEnd) => Ok(found),
        Ok(Status::Ok | Status::BufError) => {
            let expected = format!("the end of compressed block {block} after {} bytes of data", output.len());
            Err(Error::new(format!("expected {expected}, found none")))
        }
        Err(_) => {
            let place = format!("after {} bytes of compressed block {block}", zlib.total_in());
            Err(Error::new(format!("expected data in the format of zlib, found other bytes {place}")))
        }
    }
}
