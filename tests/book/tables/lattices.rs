//! The closed forms of lattices, as the program derives them.

use super::markdown;
use springfit_report::report::lattice_text;
use springfit_studies::study::NamedLattice;

/// Each lattice with nearest neighbours alone, and with all its shells.
pub fn table() -> String {
    let mut rows = Vec::new();
    for lattice in NamedLattice::all() {
        let mut shells = vec![1, lattice.shells.len().min(2), lattice.shells.len()];
        shells.dedup();
        for count in shells {
            let text = lattice_text(lattice, &lattice.closed(count).unwrap());
            let value = |name: &str| {
                let line = text.lines().find(|line| line.trim_start().split(' ').next() == Some(name));
                let value = line.and_then(|line| line.split_once("= ")).map_or("", |(_, value)| value);
                if value.is_empty() || value.starts_with("none") { "–".to_string() } else { format!("`{value}`") }
            };
            let shear = if lattice.dimension() == 3 { "C44" } else { "C66" };
            let name = format!("`{}`, {}", lattice.name, lattice.shells[..count].join(", "));
            let mut row = vec![name];
            row.extend(["C11", "C12", shear, "E", "nu", "Zener"].map(value));
            rows.push(row);
        }
    }
    markdown(&["lattice", "C11", "C12", "C44, C66", "E along an axis", "ν between axes", "Zener's ratio"], &rows)
}
