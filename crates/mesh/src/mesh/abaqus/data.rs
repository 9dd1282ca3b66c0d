//! The data lines of an input file.

use super::deck::{Block, Deck, Element};
use super::keyword::fields;
use super::model::Surface;
use super::sets::{On, Patch, Place, Sets};
use super::surfaces::place;
use super::types;
use crate::error::Result;
use crate::mesh::frame::{Frame, System};
use crate::mesh::lines::{Lines, whole};
use crate::mesh::polytope::CellType;
use crate::mesh::reader::quoted;

/// What a field of a set or of a surface names.
enum Named {
    Number(u64),
    /// The index of a set.
    Set(usize),
    /// What belongs to the assembly alone.
    Apart,
    Unknown,
}

impl Deck {
    pub(super) fn read(&mut self, lines: &Lines, line: &[u8]) -> Result<()> {
        let mut block = std::mem::take(&mut self.block);
        match &mut block {
            Block::Passed if !self.has_keyword => {
                return Err(lines.expected("a keyword such as *NODE", &quoted(line)));
            }
            Block::Passed => {}
            Block::Prescribed(keyword) => self.annotations.prescribe(&format!("*{keyword}")),
            Block::Nodes(set, system) => self.read_node(lines, line, *set, *system)?,
            Block::Elements(element) => self.read_elements(lines, line, element)?,
            Block::NodeSet(set, generate) => self.read_set(lines, line, *set, *generate, true)?,
            Block::ElementSet(set, generate) => self.read_set(lines, line, *set, *generate, false)?,
            Block::Surface(of_nodes) => self.read_patch(lines, line, *of_nodes)?,
            Block::Union => self.read_union(lines, line)?,
            Block::Instance => self.placement.push(reals(lines, line)?),
            Block::System => self.system.extend(reals(lines, line)?),
            Block::Generation(generation) => self.read_generation(lines, line, generation)?,
            Block::Datum(datum) => self.sections.read(*datum, line),
        }
        self.block = block;
        Ok(())
    }

    fn read_node(&mut self, lines: &Lines, line: &[u8], set: Option<usize>, system: System) -> Result<()> {
        let mut fields = fields(line);
        let number = lines.whole(fields.next().unwrap_or_default(), "the number of a node")?;
        let mut point = [0.0; 3];
        for x in &mut point {
            match fields.next() {
                Some(field) if !field.is_empty() => *x = lines.real(field, "a coordinate")?,
                _ => {}
            }
        }
        if self.is_apart() {
            return Ok(());
        }
        if self.frame.is_some() || system != System::Rectangular {
            let frame = self.frame.unwrap_or(crate::mesh::frame::BASIC);
            point = Frame { system, ..frame }.place(point);
        }
        if self.made > 0 {
            // A node that a keyword has made is moved.
            self.model.put_node(number, point);
        } else {
            self.model.listing.node_numbers.push(number);
            self.model.listing.points.push(point);
        }
        if let Some(set) = set {
            self.model.node_sets.sets[set].numbers.push(number);
        }
        Ok(())
    }

    /// The system of coordinates of the nodes that follow: of three points, of a shifted origin, or that of the body.
    pub(super) fn close_system(&mut self, lines: &Lines) -> Result<()> {
        let at = |first: usize, v: &[f64]| [v[first], v[first + 1], v[first + 2]];
        let system = std::mem::take(&mut self.system);
        let frame = match system.len() {
            0 => return Ok(()),
            3 => {
                let [x, y, z] = at(0, &system);
                Frame::of_plane([x, y, z], [x + 1.0, y, z], [x, y + 1.0, z])
            }
            // The axis z stays, and x is turned about it.
            6 => {
                let (origin, on_x) = (at(0, &system), at(3, &system));
                let along = [on_x[0] - origin[0], on_x[1] - origin[1]];
                let projected = [origin[0] + along[0], origin[1] + along[1], origin[2]];
                Frame::of_plane(origin, projected, [origin[0] - along[1], origin[1] + along[0], origin[2]])
            }
            9 => Frame::of_plane(at(0, &system), at(3, &system), at(6, &system)),
            found => {
                return Err(lines.expected("the three coordinates of one, two or three points", &found.to_string()));
            }
        };
        self.frame = Some(frame.ok_or_else(|| lines.fault("expected three points that are not on one line"))?);
        Ok(())
    }

    fn read_elements(&mut self, lines: &Lines, line: &[u8], element: &mut Element) -> Result<()> {
        let Some(cell_type) = element.cell_type else {
            // A line of an element of the assembly begins with its number, and may name nodes of instances after it.
            let number = fields(line).next().and_then(whole);
            if let Some(number) = number.filter(|_| !line.trim_ascii().is_empty()) {
                self.annotations.leave_out(&element.type_name, 1);
                if !self.is_apart() {
                    self.model.left_out.insert(number);
                }
            }
            return Ok(());
        };
        for field in fields(line) {
            element.numbers.push(lines.whole(field, "the number of an element or a node")?);
            self.complete(lines.number(), element, cell_type);
        }
        Ok(())
    }

    /// Keeps the element if all its nodes have been read.
    fn complete(&mut self, line: usize, element: &mut Element, cell_type: CellType) {
        let [number, nodes @ ..] = &mut element.numbers[..] else { return };
        if nodes.len() < cell_type.nodes() {
            return;
        }
        if cell_type == CellType::LINE3 {
            // The middle is the second of three.
            nodes.swap(1, 2);
        }
        self.model.listing.cells.push(line, *number, cell_type, nodes.iter().copied());
        if types::is_shell(&element.type_name) {
            self.model.shells.insert(*number);
        }
        if types::stand_in(&element.type_name).is_some() {
            let of_type = self.stand_ins.entry(element.type_name.clone()).or_insert((0, cell_type.dimension()));
            of_type.0 += 1;
        }
        if let Some(set) = element.set {
            self.model.element_sets.sets[set].numbers.push(*number);
        }
        element.numbers.clear();
    }

    /// The instance with this name.
    pub(super) fn instance(&self, name: &str) -> Option<usize> {
        self.instances.iter().position(|instance| instance.name.eq_ignore_ascii_case(name))
    }

    /// What a field names: a number, a set of this name or, in an assembly, one of an instance.
    fn named(&self, field: &[u8], of_nodes: bool) -> Named {
        let text = String::from_utf8_lossy(field);
        let text = text.trim_matches('"');
        let sets: &Sets = if of_nodes { &self.model.node_sets } else { &self.model.element_sets };
        let shifted = |number: u64, instance: usize| {
            let instance = &self.instances[instance];
            number
                .checked_add(if of_nodes { instance.nodes } else { instance.elements })
                .map_or(Named::Unknown, Named::Number)
        };
        if let Some(number) = whole(text.as_bytes()) {
            return match self.of_instance {
                Some(instance) => shifted(number, instance),
                None if self.is_apart() => Named::Apart,
                None => Named::Number(number),
            };
        }
        if let Some((before, rest)) = text.split_once('.')
            && let (Some(instance), Some(number)) = (self.instance(before), whole(rest.as_bytes()))
        {
            return shifted(number, instance);
        }
        let own = self.of_instance.or((self.instances.len() == 1).then_some(0));
        let within = own.and_then(|instance| sets.find(&format!("{}.{text}", self.instances[instance].name)));
        let known = if self.of_instance.is_some() { within.or(sets.find(text)) } else { sets.find(text).or(within) };
        known.map_or(Named::Unknown, Named::Set)
    }

    /// The set of elements with this name.
    pub(super) fn known_elements(&self, lines: &Lines, name: &str) -> Result<usize> {
        match self.named(name.as_bytes(), false) {
            Named::Set(set) => Ok(set),
            _ => Err(lines.expected("a set of elements that is listed before", &format!("\"{name}\""))),
        }
    }

    fn read_patch(&mut self, lines: &Lines, line: &[u8], of_nodes: bool) -> Result<()> {
        let mut fields = fields(line);
        let target = fields.next().unwrap_or_default();
        let label = fields.next().unwrap_or_default();
        let on = match (self.named(target, of_nodes), of_nodes) {
            (Named::Number(number), true) => On::Node(number),
            (Named::Number(number), false) => On::Element(number),
            (Named::Set(set), true) => On::Nodes(set),
            (Named::Set(set), false) => On::Elements(set),
            (Named::Apart, _) => return Ok(()),
            (Named::Unknown, true) => {
                return Err(lines.expected("a set of nodes that is listed before", &quoted(target)));
            }
            (Named::Unknown, false) => {
                return Err(lines.expected("a set of elements that is listed before", &quoted(target)));
            }
        };
        let place = match place(label) {
            _ if of_nodes => Place::Whole,
            Some(Ok(place)) => place,
            Some(Err(expected)) => return Err(lines.expected(expected, &quoted(label))),
            None => {
                self.annotations.leave_out("beam end", 1);
                return Ok(());
            }
        };
        let surface = self.model.surfaces.last_mut().expect("a surface has been opened");
        surface.patches.push(Patch { on, place });
        Ok(())
    }

    /// Reads a line of a surface that consists of others before it: their names, in an assembly after those of their instances.
    fn read_union(&mut self, lines: &Lines, line: &[u8]) -> Result<()> {
        let Some((last, before)) = self.model.surfaces.split_last_mut() else { return Ok(()) };
        for field in fields(line).filter(|field| !field.is_empty()) {
            let text = String::from_utf8_lossy(field);
            let text = text.trim_matches('"');
            let is_named = |surface: &&Surface| match &surface.instance {
                None => surface.name.eq_ignore_ascii_case(text),
                Some(instance) => format!("{instance}.{}", surface.name).eq_ignore_ascii_case(text),
            };
            match before.iter().find(is_named) {
                Some(surface) => last.patches.extend_from_slice(&surface.patches),
                None => return Err(lines.expected("a surface that is listed before", &quoted(field))),
            }
        }
        Ok(())
    }

    /// Reads a line of a set: numbers, names of sets before it, or ranges.
    fn read_set(&mut self, lines: &Lines, line: &[u8], set: usize, generate: bool, of_nodes: bool) -> Result<()> {
        if generate {
            let row: Result<Vec<u64>> = fields(line).map(|field| lines.whole(field, "a whole number")).collect();
            let mut range = match row?[..] {
                [first, last] => [first, last, 1],
                [first, last, step] => [first, last, step],
                _ => return Err(lines.expected("first, last and step", &quoted(line))),
            };
            if range[0] > range[1] || range[2] == 0 {
                return Err(lines.expected("first, last and step, ascending", &quoted(line)));
            }
            let by = match self.of_instance.map(|instance| &self.instances[instance]) {
                Some(instance) => {
                    if of_nodes {
                        instance.nodes
                    } else {
                        instance.elements
                    }
                }
                None if self.is_apart() => return Ok(()),
                None => 0,
            };
            (range[0], range[1]) = (range[0].saturating_add(by), range[1].saturating_add(by));
            self.sets(of_nodes).sets[set].ranges.push(range);
            return Ok(());
        }
        for field in fields(line).filter(|field| !field.is_empty()) {
            match self.named(field, of_nodes) {
                Named::Number(number) => self.sets(of_nodes).sets[set].numbers.push(number),
                Named::Set(other) if other < set => self.sets(of_nodes).sets[set].sets.push(other),
                Named::Set(other) if other == set => {}
                Named::Apart => {}
                Named::Set(_) | Named::Unknown => {
                    return Err(lines.expected("a number, or the name of a set before it", &quoted(field)));
                }
            }
        }
        Ok(())
    }

    fn sets(&mut self, of_nodes: bool) -> &mut Sets {
        if of_nodes { &mut self.model.node_sets } else { &mut self.model.element_sets }
    }
}

fn reals(lines: &Lines, line: &[u8]) -> Result<Vec<f64>> {
    fields(line).map(|field| lines.real(field, "a number")).collect()
}
