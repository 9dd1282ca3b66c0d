//! The keywords that make nodes and elements of others: `*NGEN`, `*NFILL`, `*NCOPY`, `*ELGEN` and `*ELCOPY`.

use super::deck::{Block, Deck};
use super::generation_geometry::{Arc, Generation, Image};
use super::keyword::{Keyword, fields};
use super::types;
use crate::error::{ErrorKind, Result};
use crate::mesh::lines::Lines;
use crate::mesh::reader::quoted;

/// How many nodes and elements the keywords of a deck may make: a line of a few characters can ask for as many as it likes.
// About as many as a generated mesh may have.
const MOST: usize = 1 << 21;

impl Deck {
    /// Begins a keyword that makes nodes or elements.
    ///
    /// # Errors
    /// It has a parameter whose meaning is not read.
    pub(super) fn open_generation(&mut self, lines: &Lines, keyword: &Keyword) -> Result<Block> {
        if self.is_apart() {
            return Ok(Block::Passed);
        }
        let line = lines.number();
        let node_set = |deck: &mut Deck, key: &str| {
            keyword.value(key).filter(|name| !name.is_empty()).map(|name| deck.model.node_sets.named(name, line))
        };
        let generation = match keyword.name.as_str() {
            "NGEN" => {
                let is_arc = match keyword.value("LINE").map(str::to_ascii_uppercase).as_deref() {
                    None => false,
                    Some("C") => true,
                    Some(other) => return Err(refused(lines, "a straight line or LINE=C", &format!("LINE={other}"))),
                };
                if let Some(system) = keyword.value("SYSTEM").filter(|system| !system.eq_ignore_ascii_case("RC")) {
                    return Err(refused(lines, "SYSTEM=RC", &format!("SYSTEM={system}")));
                }
                Generation::NodesBetween { is_arc, set: node_set(self, "NSET") }
            }
            "NFILL" => {
                let bias =
                    keyword.value("BIAS").filter(|bias| lines.real(bias.as_bytes(), "a number").ok() != Some(1.0));
                if let Some(bias) = bias {
                    return Err(refused(lines, "nodes at equal distances", &format!("BIAS={bias}")));
                }
                if keyword.has("SINGULAR") {
                    return Err(refused(lines, "two sets of as many nodes", "SINGULAR"));
                }
                Generation::NodesFilled { set: node_set(self, "NSET") }
            }
            "NCOPY" => self.open_copy(lines, keyword)?,
            "ELGEN" => {
                let set = keyword.value("ELSET").filter(|name| !name.is_empty());
                Generation::Elements { set: set.map(|name| self.model.element_sets.named(name, line)) }
            }
            // ELCOPY, the only keyword of a generation without data lines.
            _ => {
                self.copy_elements(lines, keyword)?;
                return Ok(Block::Passed);
            }
        };
        Ok(Block::Generation(generation))
    }

    fn open_copy(&mut self, lines: &Lines, keyword: &Keyword) -> Result<Generation> {
        if self.frame.is_some() {
            return Err(refused(lines, "nodes that are copied in the system of the body", "*SYSTEM before it"));
        }
        let image = match (keyword.has("SHIFT"), keyword.value("REFLECT").map(str::to_ascii_uppercase).as_deref()) {
            (true, None) => Image::Shift,
            (false, Some("LINE")) => Image::InLine,
            (false, Some("MIRROR")) => Image::InPlane,
            (false, Some("POINT")) => Image::InPoint,
            (_, other) => {
                let found = other.map_or("none of them".to_string(), |other| format!("REFLECT={other}"));
                return Err(refused(lines, "SHIFT, or REFLECT=LINE, MIRROR or POINT", &found));
            }
        };
        let of = keyword.required(lines, "OLDSET")?;
        let of = self.model.node_sets.find(of).ok_or_else(|| no_set(lines, of.as_bytes()))?;
        let add = signed(lines, keyword.required(lines, "CHANGENUMBER")?.as_bytes())?;
        let times = keyword.value("MULTIPLE").map_or(Ok(1), |times| lines.whole(times.as_bytes(), "a whole number"))?;
        let set = keyword.value("NEWSET").filter(|name| !name.is_empty());
        let set = set.map(|name| self.model.node_sets.named(name, lines.number()));
        Ok(Generation::NodesCopied { of, add, times, image, set, numbers: Vec::new() })
    }

    /// Reads a data line.
    pub(super) fn read_generation(&mut self, lines: &Lines, line: &[u8], of: &mut Generation) -> Result<()> {
        match of {
            Generation::NodesBetween { is_arc, set } => self.nodes_between(lines, line, *is_arc, *set),
            Generation::NodesFilled { set } => self.fill_nodes(lines, line, *set),
            Generation::NodesCopied { numbers, .. } => {
                for field in fields(line) {
                    numbers.push(if field.is_empty() { 0.0 } else { lines.real(field, "a number")? });
                }
                Ok(())
            }
            Generation::Elements { set } => self.generate_elements(lines, line, *set),
        }
    }

    /// Ends the data lines.
    pub(super) fn close_generation(&mut self, lines: &Lines, of: Generation) -> Result<()> {
        let Generation::NodesCopied { of, add, times, image, set, numbers } = of else { return Ok(()) };
        let map = image.map(&numbers).map_err(|expected| refused(lines, expected, &format!("{numbers:?}")))?;
        // A second reflection would bring the nodes back to where they were.
        if times > 1 && !matches!(image, Image::Shift) {
            return Err(refused(lines, "one reflection", &format!("MULTIPLE={times}")));
        }
        let members = self.members_so_far(lines, of)?;
        self.charge(lines, members.len() as u64, times)?;
        for number in members {
            let (mut number, mut point) = (number, self.point(lines, number)?);
            for _ in 0..times {
                number = shifted(lines, number, add)?;
                point = map(point);
                self.make_node(number, point, set);
            }
        }
        Ok(())
    }

    /// `x(t) = (1 − t) a + t b` at equal steps of t, or on the arc from a to b.
    fn nodes_between(&mut self, lines: &Lines, line: &[u8], is_arc: bool, set: Option<usize>) -> Result<()> {
        let row: Vec<&[u8]> = fields(line).collect();
        let field = |k: usize| row.get(k).copied().filter(|field| !field.is_empty());
        let ends = [0, 1].map(|k| lines.whole(field(k).unwrap_or_default(), "the number of a node"));
        let [first, last] = ends;
        let (first, last) = (first?, last?);
        let step = field(2).map_or(Ok(1), |field| signed(lines, field))?;
        // The difference of two numbers of 64 bits has a sign as well, and needs one bit more.
        let span = i128::from(last) - i128::from(first);
        let step = i128::from(step);
        if step == 0 || span % step != 0 || span / step < 1 {
            let expected = format!("an increment that leads from {first} to {last}");
            return Err(lines.expected(&expected, &step.to_string()));
        }
        // The quotient is at least one, and no larger than a difference of numbers of 64 bits.
        let intervals = (span / step) as u64;
        let (a, b) = (self.point(lines, first)?, self.point(lines, last)?);
        let arc = if is_arc {
            if (7..10).any(|k| field(k).is_some_and(|field| lines.real(field, "a number").ok() != Some(0.0))) {
                return Err(refused(lines, "an arc of less than 180°", "a normal, as longer ones have"));
            }
            let center = match field(3).map(|field| lines.whole(field, "the number of a node")).transpose()? {
                Some(number) if number > 0 => self.point(lines, number)?,
                _ if self.frame.is_some() => {
                    return Err(refused(
                        lines,
                        "the number of the node in the middle",
                        "its coordinates after *SYSTEM",
                    ));
                }
                _ => {
                    let mut center = [0.0; 3];
                    for (k, x) in center.iter_mut().enumerate() {
                        *x = field(4 + k).map_or(Ok(0.0), |field| lines.real(field, "a coordinate"))?;
                    }
                    center
                }
            };
            let problem = "the ends of an arc of less than 180° at one distance from its middle";
            Some(Arc::between(a, b, center).ok_or_else(|| refused(lines, problem, &quoted(line)))?)
        } else {
            None
        };
        self.charge(lines, intervals, 1)?;
        if let Some(set) = set {
            self.model.node_sets.sets[set].numbers.extend([first, last]);
        }
        for k in 1..intervals {
            let number = (i128::from(first) + i128::from(k) * step) as u64;
            let t = k as f64 / intervals as f64;
            let point = arc.as_ref().map_or_else(|| straight(a, b, t), |arc| arc.at(t));
            self.make_node(number, point, set);
        }
        Ok(())
    }

    fn fill_nodes(&mut self, lines: &Lines, line: &[u8], set: Option<usize>) -> Result<()> {
        let row: Vec<&[u8]> = fields(line).collect();
        let field = |k: usize| row.get(k).copied().filter(|field| !field.is_empty());
        let mut bounds = [Vec::new(), Vec::new()];
        let mut sets = [0; 2];
        for (k, bound) in bounds.iter_mut().enumerate() {
            let name = field(k).unwrap_or_default();
            let text = String::from_utf8_lossy(name);
            sets[k] = self.model.node_sets.find(text.trim_matches('"')).ok_or_else(|| no_set(lines, name))?;
            *bound = self.members_so_far(lines, sets[k])?;
        }
        let [from, to] = bounds;
        if from.len() != to.len() {
            let expected = "two sets of as many nodes";
            return Err(lines.expected(expected, &format!("{} and {}", from.len(), to.len())));
        }
        let intervals = lines.whole(field(2).unwrap_or_default(), "the number of intervals")?;
        let step = field(3).map_or(Ok(1), |field| signed(lines, field))?;
        self.charge(lines, intervals, from.len() as u64)?;
        if let Some(set) = set {
            self.model.node_sets.sets[set].numbers.extend(from.iter().chain(&to));
            let name = &self.model.node_sets.sets[set].name;
            self.annotations.remark(format!("the set \"{name}\" of *NFILL holds the nodes of both bounds as well"));
        }
        for (first, last) in from.into_iter().zip(to) {
            let (a, b) = (self.point(lines, first)?, self.point(lines, last)?);
            let mut number = first;
            for k in 1..intervals {
                number = shifted(lines, number, step)?;
                self.make_node(number, straight(a, b, k as f64 / intervals as f64), set);
            }
        }
        Ok(())
    }

    /// Reads a line of `*ELGEN`: the element that is copied; then for rows, for layers of rows and for blocks of layers their number with the one
    /// that is there, and what is added to the numbers of nodes and of elements from one to the next.
    fn generate_elements(&mut self, lines: &Lines, line: &[u8], set: Option<usize>) -> Result<()> {
        let row: Vec<&[u8]> = fields(line).collect();
        let field = |k: usize| row.get(k).copied().filter(|field| !field.is_empty());
        let first = lines.whole(field(0).unwrap_or_default(), "the number of an element")?;
        if row.len() > 10 {
            return Err(lines.expected("an element, and rows, layers and blocks of three numbers", &quoted(line)));
        }
        let mut directions = [(1, 0, 0); 3];
        for (d, direction) in directions.iter_mut().enumerate() {
            if let Some(count) = field(1 + 3 * d) {
                let count = lines.whole(count, "a number of elements")?.max(1);
                let step = |k: usize| match field(k) {
                    Some(field) => signed(lines, field),
                    None if d == 0 || count == 1 => Ok(1),
                    None => Err(lines.expected("what is added to the numbers of nodes and elements", "none")),
                };
                *direction = (count, step(2 + 3 * d)?, step(3 + 3 * d)?);
            }
        }
        let [row, layer, block] = directions;
        self.charge(lines, row.0.saturating_mul(layer.0), block.0)?;
        if let Some(set) = set {
            self.model.element_sets.sets[set].numbers.push(first);
        }
        let times = |step: i64, by: u64| i128::from(step) * i128::from(by);
        for (k, j, i) in (0..block.0).flat_map(|k| (0..layer.0).flat_map(move |j| (0..row.0).map(move |i| (k, j, i)))) {
            if (k, j, i) != (0, 0, 0) {
                let nodes = times(row.1, i) + times(layer.1, j) + times(block.1, k);
                let elements = times(row.2, i) + times(layer.2, j) + times(block.2, k);
                self.make_element(lines, first, elements, nodes, set)?;
            }
        }
        Ok(())
    }

    fn copy_elements(&mut self, lines: &Lines, keyword: &Keyword) -> Result<()> {
        if keyword.has("REFLECT") {
            return Err(refused(lines, "elements that are moved", "REFLECT, which turns their nodes round"));
        }
        let name = keyword.required(lines, "OLDSET")?;
        let of = self.known_elements(lines, name)?;
        let add = signed(lines, keyword.required(lines, "ELEMENTSHIFT")?.as_bytes())?;
        let nodes = signed(lines, keyword.required(lines, "SHIFTNODES")?.as_bytes())?;
        let set = keyword.value("NEWSET").filter(|name| !name.is_empty());
        let set = set.map(|name| self.model.element_sets.named(name, lines.number()));
        let sets = &self.model.element_sets;
        let members = sets.so_far(of, &self.model.listing.cells.numbers).ok_or_else(|| unordered(lines))?;
        self.charge(lines, members.len() as u64, 1)?;
        for number in members {
            self.make_element(lines, number, i128::from(add), i128::from(nodes), set)?;
        }
        Ok(())
    }

    /// Makes a node, or moves the one of this number: the last definition counts.
    fn make_node(&mut self, number: u64, point: [f64; 3], set: Option<usize>) {
        self.model.put_node(number, point);
        if let Some(set) = set {
            self.model.node_sets.sets[set].numbers.push(number);
        }
    }

    /// Makes an element like another, with these added to its number and those of its nodes.
    fn make_element(&mut self, lines: &Lines, of: u64, add: i128, nodes: i128, set: Option<usize>) -> Result<()> {
        let sum = |number: u64, by: i128| {
            u64::try_from(i128::from(number) + by)
                .map_err(|_| lines.expected("numbers of at least 0", &(i128::from(number) + by).to_string()))
        };
        let number = sum(of, add)?;
        let Some(cell) = self.model.cell(of) else {
            if self.model.left_out.contains(&of) {
                self.model.left_out.insert(number);
                self.annotations.leave_out("bodiless element", 1);
                return Ok(());
            }
            return Err(lines.expected("an element that is listed before", &of.to_string()));
        };
        let cells = &mut self.model.listing.cells;
        let moved: Result<Vec<u64>> = cells.nodes(cell).iter().map(|&node| sum(node, nodes)).collect();
        let cell_type = cells.cell_type(cell);
        cells.push(lines.number(), number, cell_type, moved?);
        if self.model.shells.contains(&of) {
            self.model.shells.insert(number);
        }
        let type_name = self.model.type_name(cell).to_string();
        self.model.begin_type(&type_name, 1);
        if types::stand_in(&type_name).is_some() {
            self.stand_ins.entry(type_name).or_insert((0, cell_type.dimension())).0 += 1;
        }
        if let Some(set) = set {
            self.model.element_sets.sets[set].numbers.push(number);
        }
        Ok(())
    }

    fn point(&mut self, lines: &Lines, number: u64) -> Result<[f64; 3]> {
        let place = self.model.node(number);
        let place = place.ok_or_else(|| lines.expected("a node that is listed before", &number.to_string()))?;
        Ok(self.model.listing.points[place])
    }

    fn members_so_far(&self, lines: &Lines, set: usize) -> Result<Vec<u64>> {
        let members = self.model.node_sets.so_far(set, &self.model.listing.node_numbers);
        members.filter(|_| self.model.node_sets.sets[set].of_elements.is_empty()).ok_or_else(|| unordered(lines))
    }

    /// Counts what is made.
    fn charge(&mut self, lines: &Lines, count: u64, times: u64) -> Result<()> {
        // The count is checked before anything is made, and a product beyond 64 bits counts as the largest number.
        let made = count.saturating_mul(times).saturating_add(self.made as u64);
        if made > MOST as u64 {
            let expected = format!("at most {MOST} nodes and elements that keywords make");
            return Err(lines.expected(&expected, &made.to_string()).of_kind(ErrorKind::Limit));
        }
        self.made = made as usize;
        Ok(())
    }
}

/// `(1 − t) a + t b`.
fn straight(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    // This form meets both ends to the last digit, as `a + t (b − a)` need not.
    std::array::from_fn(|k| (1.0 - t) * a[k] + t * b[k])
}

fn signed(lines: &Lines, field: &[u8]) -> Result<i64> {
    let text = std::str::from_utf8(field.trim_ascii()).ok();
    text.and_then(|text| text.parse().ok()).ok_or_else(|| lines.expected("a whole number", &quoted(field)))
}

fn shifted(lines: &Lines, number: u64, by: i64) -> Result<u64> {
    number.checked_add_signed(by).ok_or_else(|| lines.expected("numbers of at least 0", &format!("{number}{by:+}")))
}

/// The error for what is not read, with the way out.
fn refused(lines: &Lines, expected: &str, found: &str) -> crate::error::Error {
    let way = "; let the program that wrote the file write nodes and elements one by one";
    lines.expected(expected, found).of_kind(ErrorKind::Unsupported).followed_by(way)
}

fn no_set(lines: &Lines, name: &[u8]) -> crate::error::Error {
    lines.expected("a set of nodes that is listed before", &quoted(name))
}

fn unordered(lines: &Lines) -> crate::error::Error {
    refused(lines, "a set of numbers, sorted or in one list", "another")
}
