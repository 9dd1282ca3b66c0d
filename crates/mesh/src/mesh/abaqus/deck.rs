//! The lines of an input file, keyword by keyword.

use super::generation_geometry::Generation;
use super::keyword::Keyword;
use super::model::{Instance, Model, Surface};
use super::sections::{Datum, Profile, Sections};
use super::surfaces::{Members, add_surfaces};
use super::types::{self, Kind};
use crate::error::{ErrorKind, Result};
use crate::mesh::annotations::Annotations;
use crate::mesh::frame::{Frame, System};
use crate::mesh::lines::Lines;
use crate::mesh::polytope::CellType;
use crate::mesh::source::MeshSource;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Reads an input file: flat, or parts and their instances in an assembly. Sets of elements are groups of cells, sets of nodes groups of points,
/// surfaces groups of sides. Of several instances the groups have the name of the instance before their own.
///
/// # Errors
/// The file has an element type without an element here, nodes or elements that are made in a way that is not read, or it is damaged.
pub fn parse(bytes: &[u8]) -> Result<MeshSource> {
    let mut lines = Lines::new(bytes);
    let mut deck = Deck::default();
    while let Some(line) = lines.next() {
        if line.trim_ascii_start().starts_with(b"**") || line.trim_ascii().is_empty() {
            continue;
        }
        if line.trim_ascii_start().starts_with(b"*") {
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
pub(super) enum Block {
    /// The lines are of no use for a mesh.
    #[default]
    Passed,
    /// Each line prescribes something.
    Prescribed(&'static str),
    /// The set of the nodes, and the system of their coordinates.
    Nodes(Option<usize>, System),
    Elements(Element),
    NodeSet(usize, bool),
    ElementSet(usize, bool),
    Surface(bool),
    /// The surfaces of which one consists.
    Union,
    Instance,
    System,
    Datum(Datum),
    /// Nodes or elements that are made of others.
    Generation(Generation),
}

pub(super) struct Element {
    pub cell_type: Option<CellType>,
    pub type_name: String,
    pub set: Option<usize>,
    /// Number and nodes of the element that is not complete.
    pub numbers: Vec<u64>,
}

#[derive(Default)]
pub(super) struct Deck {
    pub(super) has_keyword: bool,
    pub(super) block: Block,
    /// What is read: a flat file, a part, an instance, or the assembly.
    pub(super) model: Model,
    /// The assembly while an instance or a part is read.
    assembly: Option<Model>,
    parts: HashMap<String, Model>,
    pub(super) instances: Vec<Instance>,
    /// The name of the part or of the instance that is read.
    open: String,
    /// The lines of the instance: a translation, and an axis with an angle.
    pub(super) placement: Vec<Vec<f64>>,
    pub(super) in_assembly: bool,
    /// The instance to which the numbers of the set that is read belong; `None` for those of the assembly itself.
    pub(super) of_instance: Option<usize>,
    /// The coordinate system of the nodes, and the numbers that state it.
    pub(super) frame: Option<Frame>,
    pub(super) system: Vec<f64>,
    pub(super) sections: Sections,
    pub(super) annotations: Annotations,
    /// How many elements each type has that is something else here, and their dimension.
    pub(super) stand_ins: BTreeMap<String, (usize, usize)>,
    /// How many nodes and elements keywords have made.
    pub(super) made: usize,
}

/// The keywords that prescribe what is not taken from a file.
const PRESCRIBED: [&str; 20] = [
    "BOUNDARY",
    "CLOAD",
    "DLOAD",
    "DSLOAD",
    "TIE",
    "MPC",
    "EQUATION",
    "COUPLING",
    "KINEMATIC",
    "KINEMATIC COUPLING",
    "DISTRIBUTING",
    "DISTRIBUTING COUPLING",
    "RIGID BODY",
    "CONTACT PAIR",
    "CONTACT",
    "EMBEDDED ELEMENT",
    "PRE-TENSION SECTION",
    "TEMPERATURE",
    "INITIAL CONDITIONS",
    "ORIENTATION",
];

impl Deck {
    /// Whether the lines belong to the assembly and to none of its instances.
    pub(super) fn is_apart(&self) -> bool {
        self.in_assembly && self.assembly.is_none()
    }

    fn open(&mut self, lines: &Lines, keyword: &Keyword) -> Result<()> {
        self.has_keyword = true;
        self.block = Block::Passed;
        let line = lines.number();
        self.of_instance = keyword.value("INSTANCE").and_then(|name| self.instance(name));
        if let Some(prescribed) = PRESCRIBED.iter().find(|known| **known == keyword.name) {
            self.block = Block::Prescribed(prescribed);
            return Ok(());
        }
        match keyword.name.as_str() {
            "INCLUDE" => {
                let input = keyword.value("INPUT").unwrap_or_default();
                let way = "a deck that is read by its path is read with what it includes";
                return Err(lines.unsupported(format!("expected its lines in this text, found INPUT={input}: {way}")));
            }
            "NODE" => {
                let system = match keyword.value("SYSTEM").unwrap_or("R").to_ascii_uppercase().as_str() {
                    "R" => System::Rectangular,
                    "C" => System::Cylindrical,
                    other => {
                        let found = format!("SYSTEM={other}: write the coordinates as x, y, z");
                        return Err(lines.expected("SYSTEM=R or C", &found).of_kind(ErrorKind::Unsupported));
                    }
                };
                let name = keyword.value("NSET").filter(|_| !self.is_apart());
                let set = name.map(|name| self.model.node_sets.named(name, line));
                self.block = Block::Nodes(set, system);
            }
            "ELEMENT" => self.open_elements(lines, keyword)?,
            "NSET" => {
                let set = self.model.node_sets.named(keyword.required(lines, "NSET")?, line);
                self.model.node_sets.sets[set].is_unsorted |= keyword.has("UNSORTED");
                if let Some(name) = keyword.value("ELSET").filter(|name| !name.is_empty()) {
                    let of = self.known_elements(lines, name)?;
                    self.model.node_sets.sets[set].of_elements.push(of);
                }
                self.block = Block::NodeSet(set, keyword.says("GENERATE"));
            }
            "ELSET" => {
                let set = self.model.element_sets.named(keyword.required(lines, "ELSET")?, line);
                self.block = Block::ElementSet(set, keyword.says("GENERATE"));
            }
            "SURFACE" => {
                let kind = keyword.value("TYPE").unwrap_or("ELEMENT").to_ascii_uppercase();
                if kind == "ELEMENT" || kind == "NODE" {
                    let name = keyword.required(lines, "NAME")?.to_string();
                    self.model.surfaces.push(Surface { name, instance: None, line, patches: Vec::new() });
                    self.block = match keyword.value("COMBINE").map(str::to_ascii_uppercase).as_deref() {
                        None => Block::Surface(kind == "NODE"),
                        Some("UNION") => Block::Union,
                        Some(other) => {
                            let found = format!("COMBINE={other}: list the sides of the surface");
                            return Err(lines.expected("COMBINE=UNION", &found).of_kind(ErrorKind::Unsupported));
                        }
                    };
                }
            }
            "PART" => {
                self.open = keyword.required(lines, "NAME")?.to_uppercase();
                self.assembly = Some(std::mem::take(&mut self.model));
            }
            "END PART" => {
                if let Some(assembly) = self.assembly.take() {
                    let part = std::mem::replace(&mut self.model, assembly);
                    self.parts.insert(self.open.clone(), part);
                }
                self.frame = None;
            }
            "ASSEMBLY" => self.in_assembly = true,
            "END ASSEMBLY" => self.in_assembly = false,
            "INSTANCE" => {
                self.open = keyword.value("NAME").unwrap_or_default().to_string();
                // A part that is not in the file is read in the instance itself.
                let part = keyword.value("PART").and_then(|part| self.parts.get(&part.to_uppercase())).cloned();
                self.assembly = Some(std::mem::replace(&mut self.model, part.unwrap_or_default()));
                self.placement.clear();
                self.block = Block::Instance;
            }
            "END INSTANCE" => self.end_instance()?,
            "SYSTEM" => {
                (self.frame, self.block) = (None, Block::System);
                self.system.clear();
            }
            "MATERIAL" => self.sections.material(keyword.value("NAME").unwrap_or_default()),
            "ELASTIC" if keyword.value("TYPE").is_none_or(|kind| kind.to_ascii_uppercase().starts_with("ISO")) => {
                self.block = Block::Datum(Datum::Elastic);
            }
            "DENSITY" => self.block = Block::Datum(Datum::Density),
            "SOLID SECTION" | "SHELL SECTION" | "MEMBRANE SECTION" => {
                let value = |key: &str| keyword.value(key).unwrap_or_default();
                self.sections.section(value("ELSET"), value("MATERIAL"));
                self.block = Block::Datum(Datum::Size);
            }
            "BEAM SECTION" | "BEAM GENERAL SECTION" => {
                let value = |key: &str| keyword.value(key).unwrap_or_default();
                self.sections.section(value("ELSET"), value("MATERIAL"));
                let name = value("SECTION").to_ascii_uppercase();
                let is_general = keyword.name == "BEAM GENERAL SECTION" && (name.is_empty() || name == "GENERAL");
                // Profiles without a formula here give their material alone.
                self.block = match Profile::named(&name) {
                    _ if is_general => Block::Datum(Datum::Size),
                    Some(profile) => Block::Datum(Datum::Profile(profile)),
                    None => Block::Passed,
                };
            }
            "NGEN" | "NFILL" | "NCOPY" | "ELGEN" | "ELCOPY" => self.block = self.open_generation(lines, keyword)?,
            "NMAP" | "SUBSTRUCTURE" | "TRANSFORM SYSTEM" => {
                let problem = "expected nodes and elements with their numbers, found a keyword that makes or moves them: let the program that \
                               wrote the file write them one by one";
                return Err(lines.unsupported(problem));
            }
            _ => {}
        }
        Ok(())
    }

    fn open_elements(&mut self, lines: &Lines, keyword: &Keyword) -> Result<()> {
        let name = keyword.required(lines, "TYPE")?;
        let cell_type = match types::kind(name) {
            // What connects instances is no part of the body.
            _ if self.is_apart() => None,
            Kind::Cell(cell_type) => Some(cell_type),
            Kind::Bodiless => None,
            Kind::Unknown => {
                let expected =
                    format!("one of the types {}, with letters such as R, H or M after them", types::listed());
                let error = lines.expected(&expected, name).of_kind(ErrorKind::Unsupported);
                return Err(error.followed_by("; elements that are no part of the body may be deleted"));
            }
        };
        let set = keyword.value("ELSET").filter(|_| !self.is_apart());
        let set = set.map(|name| self.model.element_sets.named(name, lines.number()));
        self.model.begin_type(&name.to_ascii_uppercase(), 0);
        self.block =
            Block::Elements(Element { cell_type, type_name: name.to_ascii_uppercase(), set, numbers: Vec::new() });
        Ok(())
    }

    fn end_instance(&mut self) -> Result<()> {
        if let Some(assembly) = self.assembly.take() {
            let part = std::mem::replace(&mut self.model, assembly);
            self.instances.push(self.model.add(&self.open, part, &self.placement)?);
        }
        self.frame = None;
        Ok(())
    }

    /// Ends the data of a keyword.
    fn close(&mut self, lines: &Lines) -> Result<()> {
        match std::mem::take(&mut self.block) {
            Block::Elements(Element { cell_type: Some(cell_type), numbers, .. }) if !numbers.is_empty() => {
                let expected = format!("{} nodes of element {}", cell_type.nodes(), numbers[0]);
                Err(lines.fault(format!("expected {expected}, found {} before this line", numbers.len() - 1)))
            }
            Block::System => self.close_system(lines),
            Block::Generation(generation) => self.close_generation(lines, generation),
            _ => Ok(()),
        }
    }

    fn into_source(mut self, lines: &Lines, length: usize) -> Result<MeshSource> {
        // A part that is in no assembly is the body.
        if self.instances.is_empty() && self.model.listing.points.is_empty() {
            let mut parts: Vec<(String, Model)> = self.parts.drain().collect();
            parts.sort_by(|a, b| a.0.cmp(&b.0));
            for (name, part) in parts {
                self.instances.push(self.model.add(&name, part, &[])?);
            }
        }
        if self.model.listing.node_numbers.is_empty() {
            return Err(lines.fault("the file ends before *NODE"));
        }
        let [node_names, element_names, surface_names] = self.model.names(self.instances.len());
        let Model { listing, node_sets, element_sets, surfaces, left_out, shells, .. } = self.model;
        // Each instance has as many members again as its part lists.
        let length = length.saturating_add(self.made).saturating_mul(self.instances.len().max(1));
        let mut resolved = listing.resolve(length, "element")?;
        // A line for a range may stand for as many members as it likes: what a deck may name grows with its length.
        let most = (1 << 20) + 2 * length;
        let numbers = std::mem::take(&mut resolved.list.numbers);
        let elements = element_sets.members("element", &numbers, &resolved.cells, &left_out, most)?;
        let node_numbers = resolved.node_numbers.clone();
        let mut nodes = node_sets.members("node", &node_numbers, &resolved.nodes, &HashSet::new(), most)?;
        for (set, list) in node_sets.sets.iter().zip(&mut nodes) {
            for &of in &set.of_elements {
                list.extend(elements[of].iter().flat_map(|&cell| resolved.cell_nodes(cell)));
            }
        }
        for (name, members) in element_names.iter().zip(&elements) {
            let group = resolved.group(name);
            members.iter().try_for_each(|&cell| resolved.add_cell(group, cell))?;
        }
        for (name, members) in node_names.iter().zip(&nodes) {
            let group = resolved.group(name);
            members.iter().try_for_each(|&node| resolved.add_node(group, node))?;
        }
        let members = Members { elements: &elements, nodes: &nodes, left_out: &left_out, shells: &shells };
        add_surfaces(&mut resolved, &surfaces, &surface_names, &numbers, &members)?;
        let mut annotations = self.annotations;
        resolved.tell_stand_ins(&self.stand_ins, types::stand_in, &mut annotations);
        self.sections.annotate(&mut annotations, |set| {
            let of_set = element_sets.find(set).and_then(|set| elements[set].first());
            of_set.is_some_and(|&cell| resolved.list.cell_type(cell).dimension() == 1)
        });
        Ok(resolved.into_source(annotations))
    }
}
