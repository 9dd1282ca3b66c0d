//! The cards of bulk data that make a mesh.

use super::card::Card;
use super::cells::element;
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::lines::{Lines, whole};
use crate::mesh::listing::Listing;
use crate::mesh::source::MeshSource;
use std::collections::BTreeMap;

/// Reads bulk data, alone or after the sections of a whole input file. The elements of a property form the group
/// `pid=NUMBER`; a SET1 of grid points and a SET3 of grid points, elements or properties form `set=NUMBER`.
///
/// # Errors
/// A grid point is in a coordinate system of its own, an element has none here, a set is not stated by numbers, the file
/// includes others, or it is damaged.
pub fn parse(bytes: &[u8]) -> Result<MeshSource> {
    let mut lines = Lines::new(bytes);
    if bytes.split(|&b| b == b'\n').any(is_begin) {
        while lines.next().is_some_and(|line| !is_begin(line)) {}
    }
    let mut bulk = Bulk::default();
    while let Some(card) = Card::next(&mut lines)? {
        if card.name == "ENDDATA" {
            break;
        }
        bulk.read(&card)?;
    }
    bulk.into_source(bytes.len())
}

/// Whether bulk data begins after this line.
fn is_begin(line: &[u8]) -> bool {
    let mut words = line.split(|b| b.is_ascii_whitespace() || *b == b'=').filter(|word| !word.is_empty());
    words.next().is_some_and(|word| word.eq_ignore_ascii_case(b"BEGIN"))
        && words.next().is_some_and(|word| word.eq_ignore_ascii_case(b"BULK"))
}

#[derive(Default)]
struct Bulk {
    listing: Listing,
    /// The property of each cell.
    properties: Vec<Option<u64>>,
    sets: Vec<SetCard>,
}

/// What a set lists.
struct SetCard {
    number: u64,
    of: Of,
    /// First, last and step.
    ranges: Vec<[u64; 3]>,
}

#[derive(Clone, Copy)]
enum Of {
    Points,
    Elements,
    Properties,
}

impl Bulk {
    fn read(&mut self, card: &Card) -> Result<()> {
        match card.name.as_str() {
            "GRID" => {
                basic(card, 1)?;
                let number = card.whole(0, "the number of a grid point")?;
                let at = |index| card.real(index, "a coordinate");
                let point = [at(2)?, at(3)?, at(4)?];
                self.listing.node_numbers.push(number);
                self.listing.points.push(point);
            }
            "GRDSET" => basic(card, 1)?,
            "SET1" => self.read_set(card, Of::Points, 1)?,
            "SET3" => {
                let of = match card.field(1).to_ascii_uppercase().as_slice() {
                    b"GRID" | b"POINT" => Of::Points,
                    b"ELEM" | b"ELEMENT" => Of::Elements,
                    b"PROP" | b"PROPERTY" => Of::Properties,
                    _ => return Ok(()),
                };
                self.read_set(card, of, 2)?;
            }
            name if name.starts_with("INCLUDE") || name.starts_with("BEGIN") => {
                let expected = "the cards of one body in this file";
                return Err(card.unsupported(expected, &format!("{name}: put the content in its place")));
            }
            _ => {
                if let Some(found) = element(card)? {
                    self.listing.cells.push(card.line, found.number, found.cell_type, found.nodes);
                    self.properties.push(found.property);
                }
            }
        }
        Ok(())
    }

    fn read_set(&mut self, card: &Card, of: Of, first: usize) -> Result<()> {
        let number = card.whole(0, "the number of a set")?;
        let mut ranges: Vec<[u64; 3]> = Vec::new();
        let mut fields = card.fields.iter().skip(first).filter(|field| !field.is_empty()).peekable();
        while let Some(field) = fields.next() {
            let one = whole(field).ok_or_else(|| {
                let expected = "the numbers of the members, or ranges of them with THRU and BY";
                let found = String::from_utf8_lossy(field);
                card.unsupported(expected, &format!("{found} in set {number}: list the members"))
            })?;
            let mut range = [one, one, 1];
            for (place, word, least) in [(1, "THRU", one), (2, "BY", 1)] {
                if fields.next_if(|field| field.eq_ignore_ascii_case(word.as_bytes())).is_none() {
                    break;
                }
                let field = fields.next().copied().unwrap_or_default();
                let given = whole(field).filter(|&given| given >= least);
                let expected = format!("a number of at least {least} after {word} in set {number}");
                range[place] = given.ok_or_else(|| card.expected(&expected, field))?;
            }
            ranges.push(range);
        }
        self.sets.push(SetCard { number, of, ranges });
        Ok(())
    }

    fn into_source(self, length: usize) -> Result<MeshSource> {
        if self.listing.points.is_empty() {
            return Err(Error::new("the file ends before a GRID card").of_kind(ErrorKind::Syntax));
        }
        let mut resolved = self.listing.resolve(length, "element")?;
        let mut of_property: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
        for (cell, property) in self.properties.iter().enumerate() {
            let Some(property) = property else { continue };
            let group = resolved.group(&format!("pid={property}"));
            resolved.add_cell(group, cell)?;
            of_property.entry(*property).or_default().push(cell);
        }
        for set in &self.sets {
            let group = resolved.group(&format!("set={}", set.number));
            for &range in &set.ranges {
                match set.of {
                    Of::Points => {
                        let (found, walked) = resolved.nodes.in_range(&resolved.node_numbers, range);
                        resolved.charge(walked)?;
                        found.into_iter().try_for_each(|node| resolved.add_node(group, node))?;
                    }
                    Of::Elements => {
                        let (found, walked) = resolved.cells.in_range(&resolved.list.numbers, range);
                        resolved.charge(walked)?;
                        found.into_iter().try_for_each(|cell| resolved.add_cell(group, cell))?;
                    }
                    Of::Properties => {
                        let [first, last, step] = range;
                        let listed = of_property.range(first..=last);
                        let stepped = listed.filter(|(property, _)| (*property - first).is_multiple_of(step));
                        stepped.flat_map(|(_, cells)| cells).try_for_each(|&cell| resolved.add_cell(group, cell))?;
                    }
                }
            }
        }
        Ok(resolved.into_source())
    }
}

/// That the field names the basic coordinate system.
fn basic(card: &Card, index: usize) -> Result<()> {
    match card.field(index) {
        b"" | b"0" => Ok(()),
        other => {
            let system = String::from_utf8_lossy(other);
            let found =
                format!("system {system}: let the program that wrote the file write coordinates in the basic system");
            Err(card.unsupported("coordinates in the basic system, 0", &found))
        }
    }
}
