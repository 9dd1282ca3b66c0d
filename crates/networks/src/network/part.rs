//! Parts of a long work that several machines do apart from each other.

use crate::error::{Error, Result};
use std::ops::Range;

/// One of several parts of a sweep or a fit that are run apart from each other, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// The number of the part, from 1.
    pub number: usize,
    /// The number of parts.
    pub count: usize,
}

impl Shard {
    /// The whole.
    pub const WHOLE: Shard = Shard { number: 1, count: 1 };

    /// `2/5` is the second of five.
    ///
    /// # Errors
    /// The text is no such pair.
    pub fn parse(text: &str) -> Result<Shard> {
        let pair = text.split_once('/').and_then(|(i, n)| Some((i.trim().parse().ok()?, n.trim().parse().ok()?)));
        match pair {
            Some((number, count)) if (1..=count).contains(&number) => Ok(Shard { number, count }),
            _ => Err(Error::expected("--shard", "NUMBER/COUNT such as 2/5, counted from 1", format!("\"{text}\""))),
        }
    }

    /// Whether the study at a place, counted from 0, belongs to it.
    pub fn has(self, place: usize) -> bool {
        place % self.count == self.number - 1
    }

    /// The range of cells of this shard, of `cells` in all. The lengths of two ranges differ by at most one.
    pub fn range(self, cells: usize) -> Range<usize> {
        let start = |number: usize| (cells as u128 * number as u128 / self.count as u128) as usize;
        start(self.number - 1)..start(self.number)
    }

    /// A file's name with the shard, if there is more than one: `studies-2-of-5.jsonl`.
    pub fn file_name(self, stem: &str, ending: &str) -> String {
        match self.count {
            1 => format!("{stem}.{ending}"),
            count => format!("{stem}-{}-of-{count}.{ending}", self.number),
        }
    }
}
