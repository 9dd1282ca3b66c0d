//! What must be known of the parts that a scene names before its results are trusted: names that stand for several things, and conditions.

use crate::extent::extends;
use crate::mesh::{CellIndex, Group, Mesh, Selection};
use crate::model::Action;
use crate::scene::{Hold, Part, Scene};
use std::collections::BTreeSet;

/// What must be known of the parts of a scene on its mesh, one sentence each.
pub(super) fn part_notes(scene: &Scene, mesh: &Mesh) -> Vec<String> {
    of_names(scene, mesh)
        .into_iter()
        .chain(of_tractions(scene, mesh))
        .chain(of_conditions(scene, mesh))
        .chain(of_cells(scene, mesh))
        .collect()
}

/// That a name lists several parts of the body which are not the same part.
fn of_names(scene: &Scene, mesh: &Mesh) -> Vec<String> {
    let supports = scene.supports().iter().map(|hold| hold.part.clone());
    let loads = scene.loads().iter().filter_map(|load| Some(load.single()?.0.clone()));
    let materials = scene.material_parts().into_iter().map(|(_, part)| part);
    let gauge = scene.gauge().map(|gauge| gauge.part.clone());
    let named = supports.chain(loads).chain(materials).chain(gauge);
    let names: BTreeSet<String> =
        named.filter_map(|part| if let Part::Group(name) = part { Some(name) } else { None }).collect();
    names.into_iter().filter_map(|name| several(&name, mesh.groups.get(&name)?, mesh)).collect()
}

fn several(name: &str, group: &Group, mesh: &Mesh) -> Option<String> {
    let of_cells = group.cells.iter().flat_map(|cell| mesh.cell_nodes(*cell)).copied().collect();
    let all: [(&str, usize, BTreeSet<usize>); 4] = [
        // The points of other lists are known as well, but the file does not name them as points.
        ("point", if group.lists_points { group.points.len() } else { 0 }, group.points.iter().copied().collect()),
        ("edge", group.edges.len(), group.edges.iter().flatten().copied().collect()),
        ("side", group.sides.len(), group.sides.iter().flatten().copied().collect()),
        ("cell", group.cells.len(), of_cells),
    ];
    let listed: Vec<_> = all.iter().filter(|(_, count, _)| *count > 0).collect();
    let differ = listed.windows(2).any(|pair| pair[0].2 != pair[1].2);
    differ.then(|| {
        let counted = |(what, count, _): &&(&str, usize, _)| format!("{count} {what}{}", if *count == 1 { "" } else { "s" });
        let counts = listed.iter().map(counted).collect::<Vec<_>>().join(" and ");
        let taken = match listed[0].0 {
            "point" => "those points".to_string(),
            other => format!("the points of its {other}s"),
        };
        format!(
            "the name \"{name}\" stands for {counts}, which are different parts of the body: supports, displacements and forces take {taken}, tractions and pressures \
             its sides, materials and body forces its cells"
        )
    })
}

/// That a traction or a pressure acts on a group which lists no sides.
fn of_tractions(scene: &Scene, mesh: &Mesh) -> Vec<String> {
    let on_points = scene.loads().iter().filter_map(|load| {
        let (Part::Group(name), Action::Traction(_) | Action::Pressure(_) | Action::Volume(_)) = load.single()? else { return None };
        // A pressure on a surface in space acts on cells, which groups list.
        if load.key() == "pressure" && mesh.cell_dimension() < mesh.dimension {
            return None;
        }
        let group = mesh.groups.get(name).filter(|group| group.sides.is_empty())?;
        let sides = Selection::Group(name.clone()).sides(mesh).ok()?.len();
        let what = if group.is_of_points() { "points" } else { "cells" };
        Some(format!(
            "the group \"{name}\" lists {what} and no sides: the {} {} acts on the {sides} outer sides all of whose points it has",
            load.key(),
            load.name
        ))
    });
    on_points.collect()
}

/// That a condition of a support or of a load on sides and points holds everywhere, or ends within cells.
fn of_conditions(scene: &Scene, mesh: &Mesh) -> Vec<String> {
    let supports = scene.supports().iter().enumerate().map(|(i, Hold { part, .. })| (format!("fix[{i}]"), part));
    let loads = scene.loads().iter().filter_map(|load| {
        let (part, action) = load.single()?;
        let is_of_cells = match action {
            Action::Body(_) => true,
            Action::Pressure(_) => mesh.cell_dimension() < mesh.dimension,
            Action::Traction(_)
            | Action::Force(_)
            | Action::Displacement(_)
            | Action::Volume(_)
            | Action::Moment(_) => false,
        };
        (!is_of_cells).then(|| (format!("the load {}", load.name), part))
    });
    let all = supports.chain(loads).filter_map(|(what, part)| {
        let (Part::Where(text), Selection::Where(condition)) = (part, part.selection(mesh.dimension).ok()?) else {
            return None;
        };
        let points = Selection::Where(condition.clone()).points(mesh).ok()?;
        if points.len() == mesh.point_count() {
            return Some(format!(
                "where = \"{text}\" of {what} holds at all points of the body, which extends {}",
                extends(mesh)
            ));
        }
        // It holds at the middle of the cell, and not at all of its points: the part that has it is smaller than the condition says.
        let is_in = |p: &usize| points.binary_search(p).is_ok();
        let is_cut = |cell: &CellIndex| {
            let nodes = mesh.cell_nodes(*cell);
            nodes.iter().any(is_in) && !nodes.iter().all(is_in) && condition.holds(&mesh.middle(*cell))
        };
        let cut = mesh.cell_indices().filter(is_cut).count();
        let cells = if cut == 1 { "1 cell".to_string() } else { format!("{cut} cells") };
        (cut > 0).then(|| {
            format!(
                "where = \"{text}\" of {what} cuts through {cells}: the part ends at points of the mesh, up to a cell before the condition does, and in a finer \
                 mesh elsewhere; errors leave this out, and a condition between points, or smaller cells, makes it small. The body extends {}",
                extends(mesh)
            )
        })
    });
    all.collect()
}

/// How far corners are moved to the middle of their cell before a condition is asked there: a condition that ends at corners cuts no cell.
// The digits of coordinates and conditions are far finer, and a cell of which a condition cuts less is not worth a note.
const INWARDS: f64 = 0.01;

/// That a condition of a material or of a body force ends within cells, each of which is in it or not as its middle is.
fn of_cells(scene: &Scene, mesh: &Mesh) -> Vec<String> {
    let materials = scene.material_parts().into_iter();
    let loads = scene.loads().iter().filter_map(|load| match load.single()? {
        (part, Action::Body(_)) => Some((format!("the load {}", load.name), part.clone())),
        _ => None,
    });
    let note = |(what, part): (String, Part)| {
        let (Part::Where(text), Selection::Where(condition)) = (&part, part.selection(mesh.dimension).ok()?) else {
            return None;
        };
        let (mut cut, mut chosen) = (0, 0);
        for cell in mesh.cell_indices() {
            let middle = mesh.middle(cell);
            let inwards = |node: usize| -> Vec<f64> {
                mesh.point(node).iter().zip(&middle).map(|(x, m)| x + INWARDS * (m - x)).collect()
            };
            let is_in = condition.holds(&middle);
            let is_cut = mesh.cell_nodes(cell).iter().any(|&node| condition.holds(&inwards(node)) != is_in);
            cut += usize::from(is_cut);
            chosen += usize::from(is_in);
        }
        (cut > 0).then(|| {
            let cells = if cut == 1 { "1 cell".to_string() } else { format!("{cut} cells") };
            format!(
                "where = \"{text}\" of {what} cuts through {cells}: each is in the part or not as its middle is, so that the part has {chosen} whole cells and \
                 another size than the condition says; errors leave this out, and a condition between cells, or smaller ones, makes it small"
            )
        })
    };
    // What one region lacks, its neighbour has: one note is enough for both.
    materials.filter_map(note).take(1).chain(loads.filter_map(note)).collect()
}
