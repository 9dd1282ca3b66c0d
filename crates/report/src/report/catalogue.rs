//! The shipped elements and materials, one line each.

use super::table::{Column, Table};
use crate::element::{Outline, SpringGroup};
use crate::material::Energy;

/// The elements as a table; groups in parentheses are optional.
pub fn elements_table(elements: &[Outline]) -> Table {
    let columns = vec![
        Column::words("element"),
        Column::numbers("nodes"),
        Column::words("title"),
        Column::sentences("spring groups"),
    ];
    let group = |group: &SpringGroup| match group.optional {
        true => format!("({})", group.name),
        false => group.name.clone(),
    };
    let row = |element: &Outline| {
        let groups: Vec<String> = element.springs.iter().map(group).collect();
        vec![element.name.clone(), element.nodes.to_string(), element.title.clone(), groups.join(", ")]
    };
    let note = "A fit uses the groups in parentheses only where its \"springs\" name them.";
    Table::new("elements", "Elements", columns, elements.iter().map(row)).with_notes([note.to_string()])
}

/// The materials as a table.
pub fn materials_table(materials: &[Energy]) -> Table {
    let columns = vec![Column::words("material"), Column::words("title"), Column::sentences("parameters")];
    let row = |material: &Energy| {
        let parameters: Vec<String> = material.parameters().map(|(name, value)| format!("{name} = {value}")).collect();
        vec![material.name().into(), material.title().into(), parameters.join(", ")]
    };
    let note = "The moduli of every energy follow from \"young\" and \"poisson\" of the scene.";
    Table::new("materials", "Hyperelastic materials", columns, materials.iter().map(row)).with_notes([note.to_string()])
}
