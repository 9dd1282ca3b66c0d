//! Networks in JSON.

use super::lists::ListedRecord;
use super::record::SpringRecord;
use crate::text::{push_number, push_whole};
use std::io::{self, Write};

/// Bytes that are gathered before they are written. A write for each number would be a call of the system for each.
const PIECE: usize = 8192;

/// Writes a record. Its springs are made while they are written, so that no text or list of all of them is held in memory.
///
/// # Errors
/// The writer fails.
pub fn write_json(record: ListedRecord<'_>, to: &mut dyn Write) -> io::Result<()> {
    let (record, springs) = record.apart();
    let mut head = Head { to, last: Vec::new() };
    serde_json::to_writer(&mut head, &record)?;
    let Head { to, last } = head;
    // Springs are the last key: what is withheld closes their list and the record.
    let mut text = Vec::with_capacity(2 * PIECE);
    for (place, spring) in springs.iter().enumerate() {
        if place > 0 {
            text.push(b',');
        }
        push_spring(&mut text, &spring)?;
        if text.len() >= PIECE {
            to.write_all(&text)?;
            text.clear();
        }
    }
    to.write_all(&text)?;
    to.write_all(&last)?;
    to.write_all(b"\n")
}

/// What passes on all but the last two bytes.
struct Head<'a> {
    to: &'a mut dyn Write,
    last: Vec<u8>,
}

/// The bytes that close the list of springs and the record.
const END: usize = 2;

impl Write for Head<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let kept = bytes.len().min(END);
        let passed = (self.last.len() + kept).saturating_sub(END);
        self.to.write_all(&self.last[..passed])?;
        self.last.drain(..passed);
        self.to.write_all(&bytes[..bytes.len() - kept])?;
        self.last.extend_from_slice(&bytes[bytes.len() - kept..]);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

/// Appends a spring as `serde_json` has it, which writes those with a law.
fn push_spring(text: &mut Vec<u8>, spring: &SpringRecord) -> io::Result<()> {
    if spring.law.is_some() || !spring.parameters.is_empty() {
        return Ok(serde_json::to_writer(text, spring)?);
    }
    let SpringRecord { kind, points, constant, rest, measure, law: _, parameters: _, damper, groups } = spring;
    text.extend_from_slice(b"{\"kind\":\"");
    text.extend_from_slice(kind.as_bytes());
    text.extend_from_slice(b"\",\"points\":");
    push_places(text, points);
    text.extend_from_slice(b",\"constant\":");
    push_number(text, *constant);
    text.extend_from_slice(b",\"rest\":");
    push_number(text, *rest);
    text.extend_from_slice(b",\"measure\":");
    push_whole(text, *measure as u64);
    text.extend_from_slice(b",\"law\":null,\"parameters\":{},\"damper\":");
    push_number(text, *damper);
    text.extend_from_slice(b",\"groups\":");
    push_places(text, groups);
    text.push(b'}');
    Ok(())
}

fn push_places(text: &mut Vec<u8>, places: &[usize]) {
    text.push(b'[');
    for (at, &place) in places.iter().enumerate() {
        if at > 0 {
            text.push(b',');
        }
        push_whole(text, place as u64);
    }
    text.push(b']');
}
