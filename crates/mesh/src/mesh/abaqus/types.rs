//! The element types of Abaqus and CalculiX that have an element here. All their node orders but that of curved lines are VTK's.

use crate::mesh::polytope::CellType;

/// Names without the letters for integration, hybrid and other formulations, and what they are.
const TYPES: [(&str, CellType); 53] = [
    ("C3D4", CellType::TET4),
    ("C3D10", CellType::TET10),
    ("C3D8", CellType::HEX8),
    ("C3D20", CellType::HEX20),
    ("C3D6", CellType::WEDGE6),
    ("C3D15", CellType::WEDGE15),
    ("C3D5", CellType::PYRAMID5),
    ("C3D13", CellType::PYRAMID13),
    ("SC6", CellType::WEDGE6),
    ("SC8", CellType::HEX8),
    ("C2D3", CellType::TRI3),
    ("C2D4", CellType::QUAD4),
    ("C2D6", CellType::TRI6),
    ("C2D8", CellType::QUAD8),
    ("CPS3", CellType::TRI3),
    ("CPS4", CellType::QUAD4),
    ("CPS6", CellType::TRI6),
    ("CPS8", CellType::QUAD8),
    ("CPE3", CellType::TRI3),
    ("CPE4", CellType::QUAD4),
    ("CPE6", CellType::TRI6),
    ("CPE8", CellType::QUAD8),
    ("S3", CellType::TRI3),
    ("S4", CellType::QUAD4),
    ("S6", CellType::TRI6),
    ("S8", CellType::QUAD8),
    ("STRI3", CellType::TRI3),
    ("STRI65", CellType::TRI6),
    ("S4R5", CellType::QUAD4),
    ("S8R5", CellType::QUAD8),
    ("S9R5", CellType::QUAD9),
    ("M3D3", CellType::TRI3),
    ("M3D4", CellType::QUAD4),
    ("M3D6", CellType::TRI6),
    ("M3D8", CellType::QUAD8),
    ("M3D9", CellType::QUAD9),
    ("SFM3D3", CellType::TRI3),
    ("SFM3D4", CellType::QUAD4),
    ("SFM3D6", CellType::TRI6),
    ("SFM3D8", CellType::QUAD8),
    ("T2D2", CellType::LINE2),
    ("T2D3", CellType::LINE3),
    ("T3D2", CellType::LINE2),
    ("T3D3", CellType::LINE3),
    ("B21", CellType::LINE2),
    ("B31", CellType::LINE2),
    ("B22", CellType::LINE3),
    ("B32", CellType::LINE3),
    ("B23", CellType::LINE2),
    ("B33", CellType::LINE2),
    ("PIPE21", CellType::LINE2),
    ("PIPE31", CellType::LINE2),
    ("C1D2", CellType::LINE2),
];

/// The letters that a name may end in: reduced integration, hybrid, modified, incompatible modes, temperature, pore
/// pressure, small strain and others, which do not change the nodes.
const FORMULATIONS: &str = "RHMITPSEOLW";

/// The beginnings of names of elements without a body: masses, springs, dampers, connectors, gaps and rigid surfaces.
const BODILESS: [&str; 15] = [
    "MASS",
    "ROTARYI",
    "HEATCAP",
    "SPRING",
    "DASHPOT",
    "CONN",
    "GAP",
    "DCOUP",
    "JOINT",
    "DISTRIBUTING",
    "ITS",
    "DRAG",
    "R3D",
    "R2D2",
    "RB3D2",
];

pub(super) enum Kind {
    Cell(CellType),
    /// An element without a body, which is left out.
    Bodiless,
    Unknown,
}

/// What the elements of this type are.
pub(super) fn kind(name: &str) -> Kind {
    let name = name.to_ascii_uppercase();
    let is_formulation = |rest: &str| rest.chars().all(|letter| FORMULATIONS.contains(letter));
    // Elements of heat conduction and of sound have the letters D and A before the name, and the same nodes.
    let plain = ["DC", "AC"].iter().find(|start| name.starts_with(**start)).map_or(&name[..], |_| &name[1..]);
    let plain = if plain.starts_with("DS") { &plain[1..] } else { plain };
    let base = |&&(base, _): &&(&str, CellType)| plain.strip_prefix(base).is_some_and(is_formulation);
    if let Some((_, cell_type)) = TYPES.iter().find(base) {
        return Kind::Cell(*cell_type);
    }
    // Elements of networks of pipes have the one letter D in CalculiX, and those of fluids begin with F3D.
    let is_bodiless = name == "D" || name.starts_with("F3D") || BODILESS.iter().any(|start| name.starts_with(start));
    if is_bodiless { Kind::Bodiless } else { Kind::Unknown }
}

/// The known names, for an error.
pub(super) fn listed() -> String {
    TYPES.map(|(name, _)| name).join(", ")
}

/// How elements of a type answer here, where that is another way than in the program that wrote the file.
pub(super) fn stand_in(name: &str) -> Option<&'static str> {
    let name = name.to_ascii_uppercase();
    let starts = |all: &[&str]| all.iter().any(|start| name.starts_with(start));
    if is_shell(&name) && !starts(&["M3D", "SFM3D"]) {
        return Some("membranes, without bending stiffness");
    }
    if starts(&["B2", "B3", "PIPE"]) {
        return Some("rods, which need bending = \"rod\" to bend");
    }
    starts(&["SC"]).then_some("solids")
}

/// Whether the first two sides of elements of this type are their faces.
pub(super) fn is_shell(name: &str) -> bool {
    let name = name.to_ascii_uppercase();
    let starts = |start: &&str| name.starts_with(start);
    ["S3", "S4", "S6", "S8", "S9", "STRI", "M3D", "SFM3D", "DS"].iter().any(starts)
}
