//! The header of a zlib-compressed array, in base64: number of blocks, their size, size of the last one, and the sizes
//! of all compressed.

/// No data compress by zlib to less than this part.
const MOST_COMPRESSION: u64 = 1100;

/// How the numbers of a header are written.
#[derive(Clone, Copy, Default)]
pub(super) struct Numbers {
    pub wide: bool,
    pub big_endian: bool,
}

/// A header that fits the data after it.
pub(super) struct Blocks {
    header: Vec<u8>,
    numbers: Numbers,
    data: u64,
}

impl Blocks {
    /// The header at the beginning of `text`; `None` if it claims more data than `text` can hold.
    pub fn read(text: &[u8], numbers: Numbers) -> Option<Blocks> {
        let width = numbers.width();
        let count = numbers.read(&decoded(text, width)?, 0)?;
        let length = usize::try_from(count).ok()?.checked_add(3)?.checked_mul(width)?;
        let header = decoded(text, length)?;
        let (size, last) = (numbers.read(&header, 1)?, numbers.read(&header, 2)?);
        let mut compressed = 0_u64;
        for i in 0..usize::try_from(count).ok()? {
            compressed = compressed.checked_add(numbers.read(&header, 3 + i)?)?;
        }
        let data = text.get(encoded_length(length)..)?;
        let fits = encoded_length(usize::try_from(compressed).ok()?) <= data.len();
        let total = size.checked_mul(count.checked_sub(1)?)?.checked_add(if last == 0 { size } else { last })?;
        let plausible = size > 0 && last <= size && total / MOST_COMPRESSION <= compressed;
        (fits && plausible).then_some(Blocks { header, numbers, data: total })
    }

    /// Bytes that header and data take up once decoded.
    pub fn size(&self) -> u64 {
        self.data.saturating_add(self.header.len() as u64)
    }

    /// The header in base64 with the size of the last block where it had 0 for "whole", which the decoder takes for
    /// empty.
    pub fn with_last_size(mut self) -> Option<String> {
        let width = self.numbers.width();
        if self.numbers.read(&self.header, 2)? != 0 {
            return None;
        }
        self.header.copy_within(width..2 * width, 2 * width);
        Some(encoded(&self.header))
    }
}

impl Numbers {
    /// Bytes of an array that is not compressed: they stand after their number.
    pub fn size_of(self, text: &[u8]) -> u64 {
        let size = decoded(text, self.width()).and_then(|header| self.read(&header, 0));
        size.unwrap_or(0).min(text.len() as u64)
    }

    fn width(self) -> usize {
        if self.wide { 8 } else { 4 }
    }

    fn read(self, bytes: &[u8], i: usize) -> Option<u64> {
        let bytes = bytes.chunks_exact(self.width()).nth(i)?;
        let fold = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
        Some(if self.big_endian { bytes.iter().fold(0, fold) } else { bytes.iter().rev().fold(0, fold) })
    }
}

const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

fn encoded_length(bytes: usize) -> usize {
    bytes.div_ceil(3).saturating_mul(4)
}

/// The first `count` bytes that `text` stands for.
fn decoded(text: &[u8], count: usize) -> Option<Vec<u8>> {
    let text = text.get(..encoded_length(count))?;
    let mut bytes = Vec::with_capacity(text.len());
    for four in text.chunks_exact(4) {
        let mut bits = 0_u32;
        for character in four {
            let six = if *character == b'=' { Some(0) } else { ALPHABET.iter().position(|c| c == character) };
            bits = bits << 6 | six? as u32;
        }
        bytes.extend_from_slice(&bits.to_be_bytes()[1..]);
    }
    bytes.truncate(count);
    Some(bytes)
}

fn encoded(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(encoded_length(bytes.len()));
    for three in bytes.chunks(3) {
        let bits = three.iter().fold(0_u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - three.len()));
        for i in 0..4 {
            let six = (bits >> (18 - 6 * i)) as usize & 63;
            text.push(if i <= three.len() { char::from(ALPHABET[six]) } else { '=' });
        }
    }
    text
}
