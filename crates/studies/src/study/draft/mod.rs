//! The first scene for a mesh: it runs as it is, and says in comments what else there is.

use super::extent::extent;
use crate::mesh::{CellBlock, FillBoundary, FillLayers, Filled, Group, ListedSides, Mesh};
use crate::quantity::Quantity;
use crate::text::{comment, not_a_line, toml as quoted};
use std::fmt::Write;

/// Groups that are listed at most.
const LISTED: usize = 40;
/// Names of groups that are probably meant to be held.
const HELD: [&str; 8] = ["fix", "clamp", "support", "base", "bottom", "rim", "left", "min"];
/// The share of the points that a group without such a name may hold.
const MOST_HELD: f64 = 0.4;
/// What the load strains the body by, about.
const STRAIN: f64 = 0.01;
/// The modulus of a draft without one, Pa.
const YOUNG: f64 = 10e3;
/// A body with fewer points than this share in the lowest layers is rounded: it is held over `DEPTH` of its length.
const FEW: f64 = 0.05;
const DEPTH: f64 = 0.12;

/// The material of a first scene, as values of TOML. A value that is `None` is replaced by a default.
#[derive(Debug, Clone, Default)]
pub struct DraftMaterial {
    /// Young's modulus, with or without a unit.
    pub young: Option<String>,
    /// Poisson's ratio.
    pub poisson: Option<f64>,
    /// The density, with or without a unit.
    pub density: Option<String>,
}

/// Where the mesh of a first scene comes from; paths are relative to the scene.
#[derive(Debug, Clone, Copy)]
pub enum DraftSource<'a> {
    /// A file.
    File(&'a str),
    /// A filled surface.
    Fill {
        /// The file of the surface.
        surface: &'a str,
        /// The edge of a cube, mesh units, as it is typed.
        cell: &'a str,
        /// The element of the cells.
        element: &'a str,
        /// `stepped` or `smooth`.
        boundary: &'a str,
        /// `refuse` or `union`.
        layers: &'a str,
    },
}

/// The text of a scene for the mesh in `source`, whose unit is `unit`, such as `0.001` or `mm`, and which has
/// cells of the files `elements`.
///
/// A solid or plane body is held at a group, or at the points that lie lowest along its longest axis, so that no part of it can move as
/// a rigid body; a load acts on another group, or on the whole body. Surfaces and curves in space have fits alone: they do not
/// resist all motions.
pub fn draft(
    mesh: &Mesh,
    source: DraftSource,
    unit: &str,
    elements: &[String],
    title: &str,
    material: &DraftMaterial,
) -> String {
    let mut text = String::new();
    let mut line = |words: &str| writeln!(text, "{words}").expect("a String grows");
    let cells: Vec<_> = mesh.blocks.iter().map(|b| format!("{} {}", b.cells().len(), b.element.name)).collect();
    let sizes: Vec<String> = extent(mesh).iter().map(|x| rounded(*x, 3)).collect();
    let size = format!("{} points, {}; {} m", mesh.point_count(), cells.join(", "), sizes.join(" x "));
    line(&comment("# ", &size));
    let filled = || mesh.quality.filled.iter();
    filled()
        .flat_map(Filled::lines)
        .chain(filled().filter_map(Filled::far_off))
        .for_each(|words| line(&comment("# ", &words)));
    if let Some(steps) = filled().find_map(Filled::steps) {
        line(&format!("# A traction on the surface is too large where it is not along the axes: {steps}."));
    }
    line("# Quantities are in SI units, or texts with a unit such as \"10 kPa\".");
    line(&format!("title = {}\n", quoted(title)));
    line("[mesh]");
    match source {
        DraftSource::File(file) => line(&format!("file  = {}", quoted(file))),
        DraftSource::Fill { surface, cell, element, boundary, layers } => {
            let (surface, element) = (quoted(surface), quoted(element));
            let unusual = |key: &str, value: &str, usual: &str| match value == usual {
                true => String::new(),
                false => format!(", {key} = {}", quoted(value)),
            };
            let boundary = unusual("boundary", boundary, FillBoundary::default().name());
            let layers = unusual("layers", layers, FillLayers::default().name());
            line(&format!(
                "fill  = {{ surface = {surface}, cell = {cell}, element = {element}{boundary}{layers} }} # the edge of a cube in mesh units"
            ));
        }
    }
    let scale = if unit.parse::<f64>().is_ok() { unit.to_string() } else { quoted(unit) };
    line(&format!("scale = {scale:<17} # metres per mesh unit; \"mm\" for a mesh in millimetres"));
    if !elements.is_empty() {
        let names: Vec<String> = elements.iter().map(|name| quoted(name)).collect();
        line(&format!("elements = [{}]", names.join(", ")));
    }
    line("");
    groups(mesh).iter().for_each(|listed| line(listed));
    line("[material]");
    let value = |text: &str| if text.parse::<f64>().is_ok() { text.to_string() } else { quoted(text) };
    let young = material.young.as_deref().map_or("\"10 kPa\"".into(), value);
    line(&format!(
        "young   = {young:<15} # Young's modulus; or \"1e4*(1 + 20*z)\" with z in m, or {{ file = \"map.csv\" }}"
    ));
    line(&format!("poisson = {:<15} # Poisson's ratio, below 0.5", material.poisson.unwrap_or(0.3)));
    let longest = extent(mesh).into_iter().fold(0.0, f64::max);
    match mesh.cell_dimension() {
        2 => {
            line(&format!("thickness = {:<13} # m", rounded(longest / 100.0, 1)));
            line("plane   = \"stress\"        # or \"strain\"");
        }
        1 => line(&format!("area    = {:<15} # m^2, the cross-section", rounded(longest * longest / 1e4, 1))),
        _ => {}
    }
    match material.density.as_deref().map(value) {
        Some(density) => {
            line(&format!("density = {density:<15} # kg/m^3; masses, [motion] and frequencies require it"))
        }
        None => line("# density = 1000          # kg/m^3; masses, [motion] and frequencies require it"),
    }
    if mesh.cell_dimension() == mesh.dimension {
        line("# law = \"neo-hookean\"     # large deformation; `springfit materials` lists the energies");
    }
    line(
        "# Regions: one [[material]] for each, with group = \"…\" or where = \"z < 0.01\", and one without for the rest.\n",
    );
    let is_bent = |block: &CellBlock| !block.element.has_corners_alone();
    let (fit, objective, words) = match mesh.cell_dimension() < mesh.dimension && mesh.blocks.iter().any(is_bent) {
        true => ("least squares", "frobenius", "bent cells of a surface or curve have no exact network"),
        false => ("exact", "exact", "springs and volume constraints that have the energy of the material"),
    };
    line("[[fit]]");
    line(&format!("name      = {:<13} # of your choice", quoted(fit)));
    line(&format!("objective = {:<13} # {words}\n", quoted(objective)));
    line("[[fit]]");
    line("name        = \"classical springs, k >= 0\"");
    line("objective   = \"offdiag\"   # springs alone; `springfit fit --help` lists the objectives");
    line("nonnegative = true");
    let names = mesh.blocks.first().map(|block| block.element.springs.iter().map(|group| quoted(&group.name)));
    let names = names.into_iter().flatten().collect::<Vec<_>>().join(", ");
    line(&format!("# springs = [{names}]   # spring groups; those that are not optional if absent\n"));
    conditions(mesh, longest, material).iter().for_each(|written| line(written));
    line("\n[output]");
    line("# vtu = true              # springs and displacements for ParaView");
    line("# csv = true              # springs as a table");
    line("# moduli = true           # each network as a material");
    line("# frequencies = 6         # natural frequencies");
    text
}

/// The groups as comments.
fn groups(mesh: &Mesh) -> Vec<String> {
    let mut lines = Vec::new();
    if mesh.groups.is_empty() {
        lines.push(
            "# The mesh has no groups; parts are selected by conditions such as where = \"z < 0.01\" (x, y, z in m)."
                .into(),
        );
    } else {
        lines.push(
            "# Groups of the mesh; conditions such as where = \"z < 0.01\" (x, y, z in m) select parts as well:".into(),
        );
    }
    let longest = mesh.groups.keys().take(LISTED).map(|name| quoted(name).chars().count()).max().unwrap_or(0).min(30);
    for (name, group) in mesh.groups.iter().take(LISTED) {
        lines.push(format!("#   {:longest$}  {}", quoted(name), contents(mesh, group)));
    }
    if mesh.groups.len() > LISTED {
        lines.push(format!("#   and {} more: `springfit groups MESH`", mesh.groups.len() - LISTED));
    }
    lines.push(String::new());
    lines
}

/// `12 cells, 30 points`.
fn contents(mesh: &Mesh, group: &Group) -> String {
    if group.points.is_empty() {
        return "nothing of the body".into();
    }
    let counted = [
        (group.cells.len(), "cells"),
        (ListedSides::of(mesh, group).sides.len(), "sides"),
        (group.edges.len(), "edges"),
        (group.points.len(), "points"),
    ];
    counted.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect::<Vec<_>>().join(", ")
}

/// The supports and loads.
fn conditions(mesh: &Mesh, longest: f64, material: &DraftMaterial) -> Vec<String> {
    let young = material.young.as_deref().and_then(|text| Quantity::Pressure.parse(text).ok()).unwrap_or(YOUNG);
    let d = mesh.dimension;
    // Near the ends of the body along x.
    let ends = || {
        let along = || mesh.points.iter().step_by(d).copied();
        let (low, high) = (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
        [0.1, 0.9].map(|share| rounded(low + share * (high - low), 6))
    };
    let none = |why: &str, action: &str| {
        let (example, [low, high]) = (vec!["0"; d - 1].join(", "), ends());
        vec![
            format!("# {why}"),
            format!("# [[fix]]\n# where = \"x < {low}\"\n#\n# [[load]]\n# name = \"pull\""),
            format!("# where = \"x > {high}\"\n# {}", action.replace("EXAMPLE", &example)),
        ]
    };
    if mesh.cell_dimension() < d {
        return none(
            "A surface or curve in space bends freely: it is solved with a [motion]; loads need supports of all points that could bend.",
            "body = [100, EXAMPLE]   # N/m^3; or force (N), displacement (m); a traction (Pa) acts on the outline",
        );
    }
    let pieces = mesh.pieces();
    let held_by = |group: &&String| holds(mesh, &pieces, &mesh.groups[*group].points);
    let is_likely = |group: &&String| HELD.iter().any(|word| group.to_lowercase().contains(word));
    // No scene can name another.
    let is_name = |group: &&String| not_a_line(group, false).is_none();
    let able: Vec<&String> = mesh.groups.keys().filter(is_name).filter(held_by).collect();
    // A group such as the whole surface leaves little to move.
    let is_small =
        |group: &&&String| (mesh.groups[**group].points.len() as f64) < MOST_HELD * mesh.point_count() as f64;
    let group = able.iter().find(|group| is_likely(group)).or(able.iter().find(is_small)).copied();
    let mut lines = Vec::new();
    let (held, fix) = match group {
        Some(group) => (mesh.groups[group].points.clone(), format!("group = {}", quoted(group))),
        None => match lowest(mesh, &pieces) {
            Some((points, condition)) => (points, format!("where = {}", quoted(&condition))),
            None => {
                return none(
                    "Too few points are left free to load the body when it is held.",
                    "traction = [100, EXAMPLE]   # Pa; or force (N), body (N/m^3), displacement (m)",
                );
            }
        },
    };
    lines.push(format!("[[fix]]\n{fix}\n# axes = [\"x\"]            # all if absent\n"));
    let zeros = vec!["0"; d - 1].join(", ");
    let is_free = |group: &&Group| group.points.iter().all(|point| held.binary_search(point).is_err());
    let has_sides = |group: &&Group| {
        let ListedSides { sides, lost } = ListedSides::of(mesh, group);
        !sides.is_empty() && lost.is_empty()
    };
    let loaded = mesh
        .groups
        .iter()
        .filter(|(name, _)| is_name(name))
        .find(|(_, group)| group.cells.is_empty() && is_free(group) && has_sides(group));
    lines.push("[[load]]\nname     = \"pull\"".into());
    lines.push(match loaded {
        Some((name, _)) => {
            let traction = rounded(STRAIN * young, 1);
            format!(
                "group    = {}\ntraction = [{traction}, {zeros}]   # Pa; or force (N), body (N/m^3), displacement (m)",
                quoted(name)
            )
        }
        None => {
            let body = rounded(STRAIN * young / longest, 1);
            format!("body     = [{body}, {zeros}]   # N/m^3; on a part: traction (Pa), force (N), displacement (m)")
        }
    });
    lines
}

/// Whether no piece of the body can move if these points are held, and some point is free.
fn holds(mesh: &Mesh, pieces: &[Vec<usize>], points: &[usize]) -> bool {
    let mut is_held = vec![false; mesh.point_count()];
    points.iter().for_each(|&point| is_held[point] = true);
    let held = |piece: &Vec<usize>| piece.iter().copied().filter(|&point| is_held[point]).collect::<Vec<_>>();
    points.len() < mesh.point_count() && pieces.iter().all(|piece| is_rigid(mesh, &held(piece)))
}

/// Whether the points span a line in the plane, and a plane in space: a body that is held there cannot turn.
fn is_rigid(mesh: &Mesh, points: &[usize]) -> bool {
    let at = |point: usize| mesh.point(point);
    let from = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| b - a).collect() };
    let square = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
    let Some((&first, others)) = points.split_first() else { return false };
    let arm = |point: &usize| from(at(first), at(*point));
    let longest = others.iter().map(arm).max_by(|a, b| square(a).total_cmp(&square(b))).unwrap_or_default();
    let length = square(&longest);
    if !(length > 0.0) || mesh.dimension == 2 {
        return length > 0.0;
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // The square of the sine of the angle between the arms; in the middle of a flat set of points some are off the line.
    let off = |v: Vec<f64>| square(&v) / length - (dot(&v, &longest) / length).powi(2);
    others.iter().map(arm).any(|v| off(v) > 1e-4)
}

/// The points that lie lowest along the longest axis, as few layers as hold the body, and the condition that selects them.
fn lowest(mesh: &Mesh, pieces: &[Vec<usize>]) -> Option<(Vec<usize>, String)> {
    let sizes = extent(mesh);
    let axis = (0..sizes.len()).max_by(|a, b| sizes[*a].total_cmp(&sizes[*b]))?;
    let mut along: Vec<f64> = (0..mesh.point_count()).map(|point| mesh.point(point)[axis]).collect();
    let places = along.clone();
    along.sort_by(f64::total_cmp);
    let gaps: Vec<f64> = along
        .windows(2)
        .filter(|pair| pair[1] - pair[0] > 1e-4 * sizes[axis])
        .map(|pair| (pair[0] + pair[1]) / 2.0)
        .collect();
    let below = |limit: f64| -> Vec<usize> { (0..places.len()).filter(|&point| places[point] < limit).collect() };
    // What holds the body holds it with more points as well.
    let mut place = gaps.partition_point(|limit| !holds(mesh, pieces, &below(*limit)));
    if (below(*gaps.get(place)?).len() as f64) < FEW * places.len() as f64 {
        let deep = along[0] + DEPTH * sizes[axis];
        place = place.max(gaps.partition_point(|limit| *limit < deep));
    }
    let limit = *gaps.get(place)?;
    let text = rounded(limit, 6);
    let written: f64 = text.parse().ok()?;
    (below(written) == below(limit)).then(|| (below(limit), format!("{} < {text}", ["x", "y", "z"][axis])))
}

/// The number with so many digits.
fn rounded(value: f64, digits: usize) -> String {
    let short = format!("{:.*e}", digits - 1, value).parse::<f64>().unwrap_or(value);
    match short.abs() {
        0.0 | 1e-4..1e6 => format!("{short}"),
        _ => format!("{short:e}"),
    }
}
