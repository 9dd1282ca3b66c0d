//! The cards of bulk data that make a mesh.

use super::card::Card;
use super::cells::{Other, element, other, stand_in};
use super::middles::{self, LACKING};
use super::properties::Properties;
use super::systems::{Grid, Systems};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::annotations::Annotations;
use crate::mesh::lines::{Lines, whole};
use crate::mesh::listing::Listing;
use crate::mesh::source::MeshSource;
use std::collections::{BTreeMap, HashMap};

/// Reads bulk data, alone or after the sections of a whole input file. The elements of a property form the group
/// `pid=NUMBER`; a SET1 of grid points and a SET3 of grid points, elements or properties form `set=NUMBER`.
///
/// # Errors
/// An element has none here, a set is not stated by numbers, the file includes others that are not read with it, or it is damaged.
pub fn parse(bytes: &[u8]) -> Result<MeshSource> {
    let mut lines = Lines::new(bytes);
    let mut bulk = Bulk::default();
    if bytes.split(|&b| b == b'\n').any(is_begin) {
        let begins = std::iter::from_fn(|| lines.next()).find(|line| is_begin(line));
        bulk.has_superelements = begins.is_some_and(|line| line.to_ascii_uppercase().windows(5).any(|w| w == b"SUPER"));
    }
    while let Some(card) = Card::next(&mut lines) {
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
        && words
            .next()
            .is_some_and(|word| [&b"BULK"[..], b"SUPER"].iter().any(|known| word.eq_ignore_ascii_case(known)))
}

#[derive(Default)]
struct Bulk {
    listing: Listing,
    grids: Vec<(u64, Grid)>,
    systems: Systems,
    /// The coordinate system of grid points that name none.
    system: u64,
    materials: Properties,
    annotations: Annotations,
    /// Whether points may be there twice, in two superelements.
    has_superelements: bool,
    /// How many elements each card has that is something else here, and their dimension.
    stand_ins: BTreeMap<String, (usize, usize)>,
    /// The property of each cell.
    properties: Vec<Option<u64>>,
    /// The cells that lack middle nodes.
    partial: Vec<usize>,
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
                card.check()?;
                let number = card.whole(0, "the number of a grid point")?;
                let at = |index| card.real(index, "a coordinate");
                let grid = Grid {
                    system: system(card, 1)?.unwrap_or(u64::MAX),
                    at: [at(2)?, at(3)?, at(4)?],
                    line: card.line,
                };
                self.grids.push((number, grid));
            }
            "GRDSET" => self.system = system(card, 1)?.unwrap_or(0),
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
            "MAT1" | "PSOLID" | "PSHELL" | "PROD" | "PBAR" | "PBEAM" => self.materials.read(card),
            // The cards of superelements; those of the rest of the body follow BULK.
            name if name.starts_with("BEGIN") => {
                self.annotations.remark("the superelements of the file are read as parts of one body");
                self.has_superelements = true;
            }
            name if name.starts_with("INCLUDE") => {
                let expected = "the cards of one body in this text";
                let way = "a file that is read by its path is read with what it includes";
                return Err(card.unsupported(expected, &format!("{name}: {way}")));
            }
            name => {
                if self.systems.read(card)? {
                    return Ok(());
                }
                if let Some(found) = element(card)? {
                    let dimension = found.cell_type.dimension();
                    let corners = found.nodes.len() - found.cell_type.middles().len();
                    if found.nodes[corners..].contains(&LACKING) {
                        self.partial.push(self.listing.cells.len());
                    }
                    self.listing.cells.push(card.line, found.number, found.cell_type, found.nodes);
                    self.properties.push(found.property);
                    if stand_in(name).is_some() {
                        self.stand_ins.entry(name.to_string()).or_insert((0, dimension)).0 += 1;
                    }
                    return Ok(());
                }
                match other(card)? {
                    Other::Prescribes => self.annotations.prescribe(name),
                    Other::LeftOut => self.annotations.leave_out(name, 1),
                    Other::Passed => {}
                }
            }
        }
        Ok(())
    }

    /// Finds where the grid points are.
    fn place(&mut self) -> Result<()> {
        let default = self.system;
        for (_, grid) in &mut self.grids {
            if grid.system == u64::MAX {
                grid.system = default;
            }
        }
        // Points of the basic system need no other.
        let is_basic = self.grids.iter().all(|(_, grid)| grid.system == 0);
        let by_number: HashMap<u64, Grid> =
            if is_basic { HashMap::new() } else { self.grids.iter().copied().collect() };
        let mut met = HashMap::new();
        for (number, grid) in &self.grids {
            if self.has_superelements && *met.entry(*number).or_insert(grid.line) != grid.line {
                let first = self.grids.iter().find(|(other, _)| other == number);
                // Superelements repeat the points that they share with others.
                if first.is_some_and(|(_, first)| first.system == grid.system && first.at == grid.at) {
                    continue;
                }
            }
            self.listing.node_numbers.push(*number);
            self.listing.points.push(if is_basic { grid.at } else { self.systems.place(grid, &by_number)? });
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

    fn into_source(mut self, length: usize) -> Result<MeshSource> {
        self.place()?;
        if self.listing.points.is_empty() {
            return Err(Error::new("the file ends before a GRID card").of_kind(ErrorKind::Syntax));
        }
        middles::complete(&mut self.listing, &self.partial, &mut self.annotations);
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
        let mut annotations = self.annotations;
        resolved.tell_stand_ins(&self.stand_ins, stand_in, &mut annotations);
        self.materials.annotate(&mut annotations, |property| of_property.contains_key(&property));
        Ok(resolved.into_source(annotations))
    }
}

/// The number of the coordinate system in a field; `None` if it is blank.
fn system(card: &Card, index: usize) -> Result<Option<u64>> {
    match card.field(index) {
        b"" => Ok(None),
        _ => card.whole(index, "the number of a coordinate system").map(Some),
    }
}
