//! The element cards of Nastran, and their node orders.

use super::card::Card;
use super::middles::LACKING;
use crate::error::{ErrorKind, Result};
use crate::mesh::lines::whole;
use crate::mesh::polytope::CellType;

/// A kind of element card. Cells with middle nodes may have an underscore after their name, as meshio writes them.
pub(super) struct Shape {
    name: &'static str,
    /// The index of the field of the first node.
    first: usize,
    corners: CellType,
    /// The cell with middle nodes.
    full: Option<CellType>,
}

const fn shape(name: &'static str, corners: CellType, full: Option<CellType>) -> Shape {
    Shape { name, first: 2, corners, full }
}

const SHAPES: [Shape; 18] = [
    shape("CTETRA", CellType::TET4, Some(CellType::TET10)),
    shape("CHEXA", CellType::HEX8, Some(CellType::HEX20)),
    shape("CPENTA", CellType::WEDGE6, Some(CellType::WEDGE15)),
    shape("CPYRAM", CellType::PYRAMID5, Some(CellType::PYRAMID13)),
    shape("CPYRA", CellType::PYRAMID5, Some(CellType::PYRAMID13)),
    shape("CTRIA3", CellType::TRI3, None),
    shape("CTRIAR", CellType::TRI3, None),
    shape("CTRIA6", CellType::TRI3, Some(CellType::TRI6)),
    shape("CQUAD4", CellType::QUAD4, None),
    shape("CQUADR", CellType::QUAD4, None),
    shape("CQUAD8", CellType::QUAD4, Some(CellType::QUAD8)),
    shape("CQUAD", CellType::QUAD4, Some(CellType::QUAD8)),
    shape("CBEAM3", CellType::LINE2, Some(CellType::LINE3)),
    shape("CBAR", CellType::LINE2, None),
    shape("CBEAM", CellType::LINE2, None),
    shape("CROD", CellType::LINE2, None),
    shape("CTUBE", CellType::LINE2, None),
    Shape { name: "CONROD", first: 1, corners: CellType::LINE2, full: None },
];

/// The beginnings of names of cards without a body that begin with a C, as those of elements do: springs, dampers, masses, gaps, joints, coordinate
/// systems, heat exchange, aerodynamics and sets.
const BODILESS: [&str; 30] = [
    "CELAS", "CDAMP", "CMASS", "CONM", "CBUSH", "CGAP", "CVISC", "CFAST", "CWELD", "CSEAM", "CORD", "CAERO", "CHBDY",
    "CONV", "CYJOIN", "CYSYM", "CYAX", "CYSUP", "CSUPER", "CSUPEXT", "CLOAD", "CREEP", "CSET", "CSSCHD", "CBARAO",
    "CHACAB", "CHACBR", "CONTRLT", "CTYPE", "CIFHEX",
];

/// Names of cards that begin so are of elements that connect points and have no cell.
const CONNECTORS: [&str; 10] = ["CELAS", "CDAMP", "CMASS", "CONM", "CBUSH", "CGAP", "CVISC", "CFAST", "CWELD", "CSEAM"];

/// Elements that are counted and left out.
const OTHERS: [&str; 3] = ["CSHEAR", "CBEND", "PLOTEL"];

/// Cards that prescribe what is not taken from a file.
const PRESCRIBED: [&str; 25] = [
    "SPC", "SPC1", "SPCD", "SPCADD", "MPC", "RBE1", "RBE2", "RBE3", "RBAR", "RROD", "RSPLINE", "RSSCON", "FORCE",
    "FORCE1", "FORCE2", "MOMENT", "PLOAD", "PLOAD1", "PLOAD2", "PLOAD4", "GRAV", "TEMP", "TEMPD", "BCTABLE", "SUPORT",
];

/// What a card is that makes no cell and no point.
pub(super) enum Other {
    /// It prescribes something.
    Prescribes,
    /// An element that is left out.
    LeftOut,
    /// It is of no use for a mesh.
    Passed,
}

/// The use of a card that neither gives a point nor a cell of a known element.
///
/// # Errors
/// It is of an element without one here, or repeats the card before it.
pub(super) fn other(card: &Card) -> Result<Other> {
    let name = card.name.as_str();
    let starts = |start: &&str| name.starts_with(*start);
    if PRESCRIBED.contains(&name) {
        return Ok(Other::Prescribes);
    }
    if OTHERS.contains(&name) || CONNECTORS.iter().any(starts) {
        return Ok(Other::LeftOut);
    }
    if name.starts_with('=') {
        return Err(card.unsupported(
            "each card in full",
            &format!("{name}, which repeats the card before it: let the program that wrote the file write all cards"),
        ));
    }
    if name.starts_with('C') && !BODILESS.iter().any(starts) {
        let known = SHAPES.map(|shape| shape.name).join(", ");
        return Err(card.unsupported(&format!("one of the elements {known}"), name));
    }
    Ok(Other::Passed)
}

/// How elements of a card answer here, where that is another way than in the program that wrote the file.
pub(super) fn stand_in(name: &str) -> Option<&'static str> {
    match name {
        "CTRIA3" | "CTRIAR" | "CTRIA6" | "CQUAD4" | "CQUADR" | "CQUAD8" => Some("membranes, without bending stiffness"),
        "CBAR" | "CBEAM" | "CBEAM3" => Some("rods, which need bending = \"rod\" to bend"),
        _ => None,
    }
}

/// The places in VTK's order, by place in that of Nastran, whose upright edges come before those on top.
const HEX20: [usize; 20] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15];
const WEDGE15: [usize; 15] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11];

/// What an element card holds.
pub(super) struct ElementCard {
    pub number: u64,
    /// The number of its property.
    pub property: Option<u64>,
    pub cell_type: CellType,
    /// In the order of VTK; [`LACKING`] stands for middle nodes that the card leaves out.
    pub nodes: Vec<u64>,
}

/// The element of the card; `None` for another card.
///
/// # Errors
/// The card has a wrong field.
pub(super) fn element(card: &Card) -> Result<Option<ElementCard>> {
    let Some(shape) = SHAPES.iter().find(|shape| shape.name == card.name.trim_end_matches('_')) else {
        return Ok(None);
    };
    card.check()?;
    let number = card.whole(0, "the number of an element")?;
    let is_property = shape.first == 2;
    let property = is_property.then(|| match card.field(1) {
        // A property without a number has that of the element.
        b"" => Ok(number),
        _ => card.whole(1, "the number of a property"),
    });
    let mut nodes = Vec::new();
    for index in 0..shape.corners.nodes() {
        nodes.push(card.whole(shape.first + index, "the number of a grid point")?);
    }
    let middles = shape.full.map_or(0, CellType::nodes).saturating_sub(nodes.len());
    let start = shape.first + nodes.len();
    let given = (start..start + middles).filter(|&index| !matches!(card.field(index), b"" | b"0")).count();
    // Cards of plates have angles and thicknesses after the grid points, those of solids nothing.
    let more = card.fields.iter().skip(start + middles).filter(|field| !matches!(**field, b"" | b"0")).count();
    if shape.corners.dimension() == 3 && more > 0 {
        let (least, most) = (nodes.len(), nodes.len() + middles);
        let found = format!("{} in element {number}", least + given + more);
        return Err(card.unsupported(&format!("{least} or {most} grid points"), &found));
    }
    let mut cell_type = shape.corners;
    if let Some(full) = shape.full.filter(|_| given > 0) {
        cell_type = full;
        for index in start..start + middles {
            let field = card.field(index);
            let node = if field.is_empty() { Some(LACKING) } else { whole(field) };
            nodes.push(node.ok_or_else(|| card.expected("the number of a grid point", field))?);
        }
        let order: &[usize] = match cell_type {
            CellType::HEX20 => &HEX20,
            CellType::WEDGE15 => &WEDGE15,
            _ => &[],
        };
        if !order.is_empty() {
            nodes = order.iter().map(|&place| nodes[place]).collect();
        }
    }
    let property = property.transpose().map_err(|e| e.of_kind(ErrorKind::Syntax))?;
    Ok(Some(ElementCard { number, property, cell_type, nodes }))
}
