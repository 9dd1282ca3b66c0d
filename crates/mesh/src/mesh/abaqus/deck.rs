//! The lines of an input file, keyword by keyword.

use super::keyword::{Keyword, fields};
use super::sets::{On, Patch, Place, Sets, add_surfaces};
use super::types::{self, Kind};
use crate::error::{ErrorKind, Result};
use crate::mesh::lines::{Lines, whole};
use crate::mesh::listing::Listing;
use crate::mesh::polytope::CellType;
use crate::mesh::reader::quoted;
use crate::mesh::source::MeshSource;
use std::collections::HashSet;

/// Reads a flat input file, or one with one part and one instance of it. Sets of elements are groups of cells, sets of
/// nodes groups of points, surfaces groups of sides.
///
/// # Errors
/// The file has an element type without an element here, several parts or instances, nodes or elements that are
/// generated or included from other files, or it is damaged.
pub fn parse(bytes: &[u8]) -> Result<MeshSource> {
    let mut lines = Lines::new(bytes);
    let mut deck = Deck::default();
    while let Some(line) = lines.next() {
        if line.starts_with(b"**") || line.trim_ascii().is_empty() {
            continue;
        }
        if line.starts_with(b"*") {
            deck.close(&lines)?;
            let keyword = Keyword::of(&mut lines, line)?;
            lines.enter(format!("*{}", keyword.name));
            deck.open(&lines, &keyword)?;
        } else {
            deck.read(&lines, line)?;
        }
    }
    deck.close(&lines)?;
    deck.into_source(&lines, bytes.len())
}

/// What the data lines that follow are.
#[derive(Default)]
enum Block {
    /// The lines are of no use for a mesh.
    #[default]
    Passed,
    /// The set of the nodes.
    Nodes(Option<usize>),
    Elements(Element),
    NodeSet(usize, bool),
    ElementSet(usize, bool),
    Surface(bool),
    Instance,
}

struct Element {
    cell_type: Option<CellType>,
    set: Option<usize>,
    /// Number and nodes of the element that is not complete.
    numbers: Vec<u64>,
}

#[derive(Default)]
struct Deck {
    has_keyword: bool,
    block: Block,
    listing: Listing,
    node_sets: Sets,
    element_sets: Sets,
    /// Name, line and patches.
    surfaces: Vec<(String, usize, Vec<Patch>)>,
    left_out: HashSet<u64>,
    /// Nodes of the assembly, which belong to no part.
    apart: HashSet<u64>,
    parts: usize,
    instance: Option<String>,
    /// The lines of the instance: a translation, and an axis with an angle.
    placement: Vec<Vec<f64>>,
    in_assembly: bool,
    in_instance: bool,
    /// Whether the numbers of the set that is read are those of the assembly.
    is_apart: bool,
}

/// The keywords that state the mesh.
const MESH: [&str; 6] = ["NODE", "ELEMENT", "NSET", "ELSET", "SURFACE", "INCLUDE"];

const FLAT: &str = "merge them in the program that wrote the file, or write one file for each";

impl Deck {
    fn open(&mut self, lines: &Lines, keyword: &Keyword) -> Result<()> {
        self.has_keyword = true;
        self.block = Block::Passed;
        let line = lines.number();
        let is_outside = self.in_assembly && !self.in_instance;
        if let Some(input) = keyword.value("INPUT").filter(|_| MESH.contains(&keyword.name.as_str())) {
            let problem = format!(
                "expected its lines in this file, found INPUT={input}: put the content of {input} in its place"
            );
            return Err(lines.unsupported(problem));
        }
        match keyword.name.as_str() {
            "NODE" => {
                if keyword.value("SYSTEM").is_some_and(|system| !system.eq_ignore_ascii_case("R")) {
                    return Err(lines.unsupported("expected rectangular coordinates, found another SYSTEM"));
                }
                let set = keyword.value("NSET").map(|name| self.node_sets.named(name, line));
                self.block = Block::Nodes(set);
            }
            "ELEMENT" => {
                let name = keyword.required(lines, "TYPE")?;
                let cell_type = match types::kind(name) {
                    Kind::Cell(cell_type) => Some(cell_type),
                    Kind::Bodiless => None,
                    Kind::Unknown if is_outside => None,
                    Kind::Unknown => {
                        let expected =
                            format!("one of the types {}, with letters such as R, H or M after them", types::listed());
                        let error = lines.expected(&expected, name).of_kind(ErrorKind::Unsupported);
                        return Err(error.followed_by("; elements that are no part of the body may be deleted"));
                    }
                };
                let set = keyword.value("ELSET").map(|name| self.element_sets.named(name, line));
                self.block = Block::Elements(Element { cell_type, set, numbers: Vec::new() });
            }
            "NSET" => {
                let set = self.node_sets.named(keyword.required(lines, "NSET")?, line);
                if let Some(name) = keyword.value("ELSET").filter(|name| !name.is_empty()) {
                    let of = self.element_set(lines, name)?;
                    self.node_sets.sets[set].of_elements.push(of);
                }
                self.is_apart = is_outside && !keyword.has("INSTANCE");
                self.block = Block::NodeSet(set, keyword.has("GENERATE"));
            }
            "ELSET" => {
                let set = self.element_sets.named(keyword.required(lines, "ELSET")?, line);
                self.is_apart = is_outside && !keyword.has("INSTANCE");
                self.block = Block::ElementSet(set, keyword.has("GENERATE"));
            }
            "SURFACE" => {
                let kind = keyword.value("TYPE").unwrap_or("ELEMENT").to_ascii_uppercase();
                if kind == "ELEMENT" || kind == "NODE" {
                    self.surfaces.push((keyword.required(lines, "NAME")?.to_string(), line, Vec::new()));
                    self.block = Block::Surface(kind == "NODE");
                }
            }
            "PART" => {
                self.parts += 1;
                if self.parts > 1 {
                    return Err(lines.unsupported(format!("expected one part, found a second: {FLAT}")));
                }
            }
            "ASSEMBLY" => self.in_assembly = true,
            "END ASSEMBLY" => self.in_assembly = false,
            "INSTANCE" => {
                let name = keyword.value("NAME").unwrap_or_default().to_string();
                if self.instance.replace(name).is_some() {
                    return Err(lines.unsupported(format!("expected one instance of the part, found a second: {FLAT}")));
                }
                self.in_instance = true;
                self.block = Block::Instance;
            }
            "END INSTANCE" => self.in_instance = false,
            "INCLUDE" | "NGEN" | "NFILL" | "NCOPY" | "NMAP" | "ELGEN" | "ELCOPY" | "SYSTEM" | "SUBSTRUCTURE"
            | "TRANSFORM SYSTEM" => {
                let problem = "expected nodes and elements with their numbers, found a keyword that makes them: write the \
                               file without it";
                return Err(lines.unsupported(problem));
            }
            _ => {}
        }
        Ok(())
    }

    fn element_set(&self, lines: &Lines, name: &str) -> Result<usize> {
        let known = self.element_sets.find(local(name, self.instance.as_deref()));
        known.ok_or_else(|| lines.expected("a set of elements that is listed before", &format!("\"{name}\"")))
    }

    fn read(&mut self, lines: &Lines, line: &[u8]) -> Result<()> {
        if !self.has_keyword {
            return Err(lines.expected("a keyword such as *NODE", &quoted(line)));
        }
        match std::mem::take(&mut self.block) {
            Block::Passed => {}
            Block::Nodes(set) => {
                self.read_node(lines, line, set)?;
                self.block = Block::Nodes(set);
            }
            Block::Elements(mut element) => {
                for field in fields(line) {
                    element.numbers.push(lines.whole(field, "the number of an element or a node")?);
                    self.complete(lines.number(), &mut element);
                }
                if element.cell_type.is_none() {
                    element.numbers.clear();
                }
                self.block = Block::Elements(element);
            }
            Block::NodeSet(set, generate) => {
                read_set(lines, line, &mut self.node_sets, set, generate, self.is_apart, self.instance.as_deref())?;
                self.block = Block::NodeSet(set, generate);
            }
            Block::ElementSet(set, generate) => {
                read_set(lines, line, &mut self.element_sets, set, generate, self.is_apart, self.instance.as_deref())?;
                self.block = Block::ElementSet(set, generate);
            }
            Block::Surface(of_nodes) => {
                self.read_patch(lines, line, of_nodes)?;
                self.block = Block::Surface(of_nodes);
            }
            Block::Instance => {
                let row: Result<Vec<f64>> = fields(line).map(|field| lines.real(field, "a number")).collect();
                self.placement.push(row?);
                self.block = Block::Instance;
            }
        }
        Ok(())
    }

    fn read_node(&mut self, lines: &Lines, line: &[u8], set: Option<usize>) -> Result<()> {
        let mut fields = fields(line);
        let number = lines.whole(fields.next().unwrap_or_default(), "the number of a node")?;
        let mut point = [0.0; 3];
        for x in &mut point {
            match fields.next() {
                Some(field) if !field.is_empty() => *x = lines.real(field, "a coordinate")?,
                _ => {}
            }
        }
        if self.in_assembly && !self.in_instance {
            self.apart.insert(number);
            return Ok(());
        }
        self.listing.node_numbers.push(number);
        self.listing.points.push(point);
        if let Some(set) = set {
            self.node_sets.sets[set].numbers.push(number);
        }
        Ok(())
    }

    /// Keeps the element if all its nodes have been read.
    fn complete(&mut self, line: usize, element: &mut Element) {
        let Some(cell_type) = element.cell_type else {
            if element.numbers.len() == 1 {
                self.left_out.insert(element.numbers[0]);
            }
            return;
        };
        let [number, nodes @ ..] = &mut element.numbers[..] else { return };
        if nodes.len() < cell_type.nodes() {
            return;
        }
        if cell_type == CellType::LINE3 {
            // The middle is the second of three.
            nodes.swap(1, 2);
        }
        self.listing.cells.push(line, *number, cell_type, nodes.iter().copied());
        if let Some(set) = element.set {
            self.element_sets.sets[set].numbers.push(*number);
        }
        element.numbers.clear();
    }

    fn read_patch(&mut self, lines: &Lines, line: &[u8], of_nodes: bool) -> Result<()> {
        let mut fields = fields(line);
        let target = fields.next().unwrap_or_default();
        let label = fields.next().unwrap_or_default().to_ascii_uppercase();
        let text = String::from_utf8_lossy(target);
        let name = local(text.trim_matches('"'), self.instance.as_deref());
        let number = whole(name.as_bytes());
        let on = match (number, of_nodes) {
            (Some(number), true) => On::Node(number),
            (Some(number), false) => On::Element(number),
            (None, true) => {
                let known = self.node_sets.find(name);
                On::Nodes(known.ok_or_else(|| lines.expected("a set of nodes that is listed before", &quoted(target)))?)
            }
            (None, false) => On::Elements(self.element_set(lines, name)?),
        };
        let place = match &label[..] {
            b"" => Place::Outer,
            b"SPOS" | b"SNEG" => Place::Whole,
            [b'S' | b'E', digit @ b'1'..=b'9'] => Place::Side(usize::from(digit - b'1')),
            // Labels of sides that no cell here has, such as END1 of a beam.
            _ if !of_nodes => return Ok(()),
            _ => Place::Whole,
        };
        let surface = self.surfaces.last_mut().expect("a surface has been opened");
        surface.2.push(Patch { on, place });
        Ok(())
    }

    /// Ends the data of a keyword.
    fn close(&mut self, lines: &Lines) -> Result<()> {
        match std::mem::take(&mut self.block) {
            Block::Elements(Element { cell_type: Some(cell_type), numbers, .. }) if !numbers.is_empty() => {
                let expected = format!("{} nodes of element {}", cell_type.nodes(), numbers[0]);
                Err(lines.fault(format!("expected {expected}, found {} before this line", numbers.len() - 1)))
            }
            _ => Ok(()),
        }
    }

    fn into_source(mut self, lines: &Lines, length: usize) -> Result<MeshSource> {
        if self.listing.node_numbers.is_empty() {
            return Err(lines.fault("the file ends before *NODE"));
        }
        super::placement::place(&mut self.listing.points, &self.placement)?;
        let mut resolved = self.listing.resolve(length, "element")?;
        let most = (1 << 20) + 2 * length;
        let numbers = std::mem::take(&mut resolved.list.numbers);
        let elements = self.element_sets.members("element", &numbers, &resolved.cells, &self.left_out, most)?;
        let numbers = resolved.node_numbers.clone();
        let mut nodes = self.node_sets.members("node", &numbers, &resolved.nodes, &self.apart, most)?;
        for (set, list) in self.node_sets.sets.iter().zip(&mut nodes) {
            for &of in &set.of_elements {
                list.extend(elements[of].iter().flat_map(|&cell| resolved.cell_nodes(cell)));
            }
        }
        for (set, members) in self.element_sets.sets.iter().zip(&elements) {
            let group = resolved.group(&set.name);
            members.iter().try_for_each(|&cell| resolved.add_cell(group, cell))?;
        }
        for (set, members) in self.node_sets.sets.iter().zip(&nodes) {
            let group = resolved.group(&set.name);
            members.iter().try_for_each(|&node| resolved.add_node(group, node))?;
        }
        add_surfaces(&mut resolved, &self.surfaces, &elements, &nodes, &self.left_out)?;
        Ok(resolved.into_source())
    }
}

/// A name without that of the instance before it.
fn local<'n>(name: &'n str, instance: Option<&str>) -> &'n str {
    match (name.split_once('.'), instance) {
        (Some((before, rest)), Some(known)) if before.eq_ignore_ascii_case(known) => rest,
        _ => name,
    }
}

/// Reads a line of a set: numbers, names of sets before it, or ranges.
fn read_set(
    lines: &Lines,
    line: &[u8],
    sets: &mut Sets,
    set: usize,
    generate: bool,
    is_apart: bool,
    instance: Option<&str>,
) -> Result<()> {
    if generate {
        let row: Result<Vec<u64>> = fields(line).map(|field| lines.whole(field, "a whole number")).collect();
        let range = match row?[..] {
            [first, last] => [first, last, 1],
            [first, last, step] => [first, last, step],
            _ => return Err(lines.expected("first, last and step", &quoted(line))),
        };
        if range[0] > range[1] || range[2] == 0 {
            return Err(lines.expected("first, last and step, ascending", &quoted(line)));
        }
        if !is_apart {
            sets.sets[set].ranges.push(range);
        }
        return Ok(());
    }
    for field in fields(line).filter(|field| !field.is_empty()) {
        if let Some(number) = whole(field) {
            if !is_apart {
                sets.sets[set].numbers.push(number);
            }
            continue;
        }
        let text = String::from_utf8_lossy(field);
        let name = local(text.trim_matches('"'), instance);
        match (whole(name.as_bytes()), sets.find(name)) {
            (Some(number), _) => sets.sets[set].numbers.push(number),
            (None, Some(other)) if other < set => sets.sets[set].sets.push(other),
            (None, Some(other)) if other == set => {}
            (None, _) => return Err(lines.expected("a number, or the name of a set before it", &quoted(field))),
        }
    }
    Ok(())
}
