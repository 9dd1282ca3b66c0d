//! The sections of an MSH file.

use super::nodes::Nodes;
use super::{types, v22, v40, v41};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::annotations::Annotations;
use crate::mesh::grouping::{Gather, Gathered};
use crate::mesh::numbering::NumberOrigin;
use crate::mesh::reader::{Encoding, Reader, quoted};
use crate::mesh::source::{Format, MeshSource, SourceBlock};
use std::collections::{HashMap, HashSet};

/// Reads a Gmsh mesh. Points keep the order of the file; cells of one type in the same physical groups form one block.
///
/// A physical group without a name is called `dimension:tag`.
///
/// # Errors
/// The file is not an MSH file of version 4.1, 4.0, 2.2 or 1; it is binary of version 4.0, damaged, cut short or partitioned; or it has an element
/// type that Gmsh does not document.
pub fn parse(bytes: &[u8]) -> Result<MeshSource> {
    let mut reader = Reader::new(bytes);
    let mut file = File::default();
    loop {
        let word = reader.peek();
        if word.is_empty() {
            return file.into_source();
        }
        reader.enter("");
        let Some(name) = word.strip_prefix(b"$") else {
            return Err(reader.expected("a section such as $MeshFormat", &quoted(word)));
        };
        let name = String::from_utf8_lossy(name);
        reader.enter(format!("${}", &*name));
        reader.word();
        file.read_section(&mut reader, &name)?;
    }
}

enum Version {
    V1,
    V22,
    V40,
    V41,
}

/// The sections that have been read so far.
#[derive(Default)]
struct File {
    version: Option<Version>,
    /// Names of physical groups by dimension and tag.
    names: HashMap<(usize, u32), String>,
    entities: v41::Entities,
    nodes: Option<Nodes>,
    cells: Option<Cells>,
    annotations: Annotations,
}

enum Cells {
    OfEntities(Gather<v41::Key>),
    OfGroups(Gather<v22::Key>),
}

impl File {
    fn read_section(&mut self, reader: &mut Reader, name: &str) -> Result<()> {
        match (name, &self.version) {
            ("MeshFormat", None) => self.version = Some(format(reader)?),
            ("PhysicalNames", Some(_)) => self.names = physical_names(reader)?,
            ("Entities", Some(Version::V40)) => self.entities = v41::entities(reader, 6)?,
            ("Entities", Some(Version::V41)) => self.entities = v41::entities(reader, 3)?,
            // Files of version 1 begin with their nodes.
            ("NOD", None) => {
                self.version = Some(Version::V1);
                self.nodes = Some(v22::nodes(reader, false)?);
            }
            ("ELM", Some(Version::V1)) if self.cells.is_none() => {
                self.cells = Some(Cells::OfGroups(v22::elements(reader, self.known_nodes(reader)?, true)?));
            }
            ("Nodes", Some(version)) if self.nodes.is_none() => {
                self.nodes = Some(match version {
                    Version::V1 | Version::V22 => v22::nodes(reader, false)?,
                    Version::V40 => v40::nodes(reader)?,
                    Version::V41 => v41::nodes(reader)?,
                });
            }
            ("ParametricNodes", Some(Version::V22)) if self.nodes.is_none() => {
                self.nodes = Some(v22::nodes(reader, true)?);
            }
            ("Elements", Some(version)) if self.cells.is_none() => {
                let nodes = self.known_nodes(reader)?;
                self.cells = Some(match version {
                    Version::V1 | Version::V22 => Cells::OfGroups(v22::elements(reader, nodes, false)?),
                    Version::V40 => Cells::OfEntities(v40::elements(reader, nodes)?),
                    Version::V41 => Cells::OfEntities(v41::elements(reader, nodes)?),
                });
            }
            ("MeshFormat" | "Nodes" | "Elements", Some(_)) | ("ParametricNodes", Some(Version::V22)) => {
                return Err(reader.fault("stands in the file a second time".into()));
            }
            ("PhysicalNames" | "Entities" | "Nodes" | "ParametricNodes" | "Elements", None) => {
                return Err(reader.fault("expected $MeshFormat before it".into()));
            }
            ("NOD" | "ELM", Some(Version::V1)) => return Err(reader.fault("stands in the file a second time".into())),
            ("ELM", None) => return Err(reader.fault("expected $NOD before it".into())),
            ("PartitionedEntities", Some(Version::V41)) => {
                self.entities.extend(v41::partitioned_entities(reader)?);
            }
            ("PartitionedEntities", _) => {
                let error = reader.fault("partitioned meshes of this version are not supported".into());
                return Err(error.of_kind(ErrorKind::Unsupported).followed_by(v40::CONVERTS));
            }
            _ => {
                if !skip(reader, name) {
                    self.annotations
                        .remark(format!("the file ends inside ${name}, which no mesh needs: it may be cut short"));
                }
                return Ok(());
            }
        }
        let end = match name {
            "NOD" | "ELM" => format!("$END{name}"),
            _ => format!("$End{name}"),
        };
        if reader.peek() != end.as_bytes() {
            return Err(reader.unexpected(&end));
        }
        reader.word();
        Ok(())
    }

    fn known_nodes(&self, reader: &Reader) -> Result<&Nodes> {
        self.nodes.as_ref().ok_or_else(|| reader.fault("expected $Nodes before it".into()))
    }

    fn into_source(self) -> Result<MeshSource> {
        let missing = |section| Error::new(format!("the file ends before {section}")).of_kind(ErrorKind::Syntax);
        self.version.ok_or_else(|| missing("$MeshFormat"))?;
        let nodes = self.nodes.ok_or_else(|| missing("$Nodes"))?;
        let cells = match self.cells.ok_or_else(|| missing("$Elements"))? {
            Cells::OfGroups(cells) => cells,
            Cells::OfEntities(cells) => {
                let mut gather = Gather::new();
                for Gathered { key: (cell_type, dimension, entity), nodes, .. } in cells.into_lists() {
                    let groups = self.entities.get(&(dimension, entity)).cloned().unwrap_or_default();
                    gather.append(&(cell_type, groups), nodes);
                }
                gather
            }
        };
        let mut blocks = Vec::new();
        for Gathered { key: (cell_type, tags), nodes: connectivity, runs } in cells.into_lists() {
            let Some((dimension, nodes_per_cell)) = types::find(cell_type) else { continue };
            let name = |tag| self.names.get(&(dimension, tag)).cloned().unwrap_or_else(|| format!("{dimension}:{tag}"));
            let mut known = HashSet::new();
            // Several tags may have one name, which is one group.
            let groups = tags.into_iter().map(name).filter(|group| known.insert(group.clone())).collect();
            blocks.push(SourceBlock {
                dimension,
                cell_type,
                nodes_per_cell,
                connectivity,
                groups,
                is_marker: true,
                runs,
            });
        }
        let origin = NumberOrigin::GmshTag;
        Ok(MeshSource {
            format: Format::Gmsh,
            origin,
            points: nodes.points,
            numbers: nodes.tags,
            blocks,
            space: None,
            annotations: self.annotations,
        })
    }
}

/// Reads the version and determines the encoding of the following sections.
fn format(reader: &mut Reader) -> Result<Version> {
    let number: Option<f64> = std::str::from_utf8(reader.peek()).ok().and_then(|word| word.parse().ok());
    let version = match number {
        // A version has the digits of these numbers, and parses to the same bits.
        Some(4.1) => Version::V41,
        Some(4.0) => Version::V40,
        Some(2.0..=2.2) => Version::V22,
        _ => return Err(unknown_version(reader)),
    };
    reader.word();
    let binary: u32 = reader.text_number()?;
    let size: u32 = reader.text_number()?;
    match binary {
        0 => return Ok(version),
        1 if matches!(version, Version::V40) => {
            let error = reader.expected("a file of version 4.0 in text", "a binary one");
            return Err(error.of_kind(ErrorKind::Unsupported).followed_by(v40::CONVERTS));
        }
        1 => {}
        other => return Err(reader.expected("file type 0 or 1", &other.to_string())),
    }
    if size != 8 {
        return Err(reader.expected("data size 8", &size.to_string()).of_kind(ErrorKind::Unsupported));
    }
    reader.encoding = Encoding::Binary { big_endian: false };
    reader.start_data()?;
    // The file has a one in binary, which tells its order of bytes.
    let one: i32 = reader.number()?;
    match one {
        1 => {}
        _ if one.swap_bytes() == 1 => reader.encoding = Encoding::Binary { big_endian: true },
        _ => return Err(reader.expected("the number 1 in binary", &one.to_string())),
    }
    Ok(version)
}

/// A file that ends here, or has no number here, has no version at all.
fn unknown_version(reader: &mut Reader) -> Error {
    let is_number = reader.peek().first().is_some_and(u8::is_ascii_digit);
    let error = reader.unexpected("version 4.1, 4.0 or 2.2");
    if is_number { error.of_kind(ErrorKind::Unsupported).followed_by(v40::CONVERTS) } else { error }
}

/// Reads the names of the physical groups, which are text in binary files too.
fn physical_names(reader: &mut Reader) -> Result<HashMap<(usize, u32), String>> {
    let count: u64 = reader.text_number()?;
    reader.announce("names", count);
    let mut names = HashMap::new();
    for _ in 0..count {
        let dimension: u32 = reader.text_number()?;
        let tag: i32 = reader.text_number()?;
        if reader.peek().is_empty() || reader.peek().starts_with(b"$") {
            return Err(reader.unexpected("a name"));
        }
        let line = reader.rest_of_line();
        if line.len() == reader.rest().len() {
            return Err(reader.ends());
        }
        // Names are in quotes; some programs leave them out.
        let name = match line.trim_ascii().strip_prefix(b"\"") {
            Some(name) => {
                let end = name.iter().rposition(|&b| b == b'"');
                &name[..end.ok_or_else(|| reader.expected("a quote after the name", &quoted(line)))?]
            }
            None => line.trim_ascii(),
        };
        let name = String::from_utf8_lossy(name).into_owned();
        reader.line();
        reader.count_one();
        names.insert((dimension as usize, tag.unsigned_abs()), name);
    }
    Ok(names)
}

/// Skips a section whose content is not used, whose end follows binary data without a line end; whether it ends.
fn skip(reader: &mut Reader, name: &str) -> bool {
    let end = format!("$End{name}");
    let rest = reader.rest();
    // The section may be large: its end is sought by its first byte.
    let mut from = 0;
    while let Some(found) = rest[from..].iter().position(|&b| b == b'$') {
        let at = from + found;
        let after = at + end.len();
        if rest[at..].starts_with(end.as_bytes()) && rest.get(after).is_none_or(u8::is_ascii_whitespace) {
            reader.pass(after);
            return true;
        }
        from = at + 1;
    }
    reader.pass(rest.len());
    false
}
