//! The first scene for a mesh: it runs as it is, and says in comments what else there is.

use crate::analysis::locking::LOCKS;
use crate::fit::check_flat;
use crate::mesh::{CellBlock, FillMesh, Filled, Group, ListedSides, Mesh, Selection};
use crate::text::{comment, rounded, toml as quoted};
use conditions::conditions;
use material::{POISSON, material_lines, stated_poisson, young};
use springfit_scenes::{FillEntry, MeshLength, extends};
use std::fmt::Write;

mod conditions;
mod material;

pub use material::DraftMaterial;

/// Groups that are listed at most: a draft with more is no longer read, and `springfit groups` lists them all.
const LISTED: usize = 40;
/// The largest mesh whose draft asks for quadratic elements beside it, which take several times the memory.
const MOST_COMPARED: usize = 10_000;

/// How the coordinates of a mesh become metres.
#[derive(Debug, Clone, Copy)]
pub struct DraftUnit<'a> {
    /// The unit of the mesh as it is typed, such as `0.001` or `mm`.
    pub text: &'a str,
    /// Metres per mesh unit.
    pub scale: f64,
    /// The dimension of the space, if it is given.
    pub space: Option<usize>,
}

/// Where the mesh of a first scene comes from; paths are relative to the scene.
#[derive(Debug, Clone, Copy)]
pub enum DraftSource<'a> {
    /// A file.
    File(&'a str),
    /// A filled surface, or divided voxels.
    Fill(&'a FillEntry),
}

/// The text of a scene for the mesh in `source`, which has cells of the files `elements`. What a deck states of materials is taken from it, in newtons and the unit of the mesh.
///
/// A solid or plane body is held at a group, or at the points that lie lowest along its longest axis, so that no part of it can move as
/// a rigid body; a load acts on another group, or on the whole body. Surfaces and curves in space have fits alone: they do not
/// resist all motions.
pub fn draft(
    mesh: &Mesh,
    source: DraftSource,
    DraftUnit { text: unit, scale, space }: DraftUnit,
    elements: &[String],
    title: &str,
    material: &DraftMaterial,
) -> String {
    let mut text = String::new();
    let mut line = |words: &str| writeln!(text, "{words}").expect("a String grows");
    let cells: Vec<_> = mesh.blocks.iter().map(|b| format!("{} {}", b.cells().len(), b.element.name)).collect();
    let sizes: Vec<String> = mesh.extent().iter().map(|x| rounded(*x, 3)).collect();
    let size = format!("{} points, {}; {} m", mesh.point_count(), cells.join(", "), sizes.join(" x "));
    line(&comment("# ", &size));
    line(&format!("# The body extends {}.", extends(mesh)));
    mesh.annotations.notes().iter().for_each(|note| line(&comment("# ", note)));
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
        DraftSource::File(file) => {
            line(&format!("file  = {}", quoted(file)));
            if let Some(repair) = fillable(mesh) {
                let element = quoted(FillMesh::cube());
                let fill = format!("{{ surface = {}, points = 1000, element = {element}{repair} }}", quoted(file));
                line(&format!("# fill = {fill}   # in place of `file`: a solid of what the surface encloses"));
            }
        }
        DraftSource::Fill(entry) => {
            let words = match (&entry.cell, entry.points) {
                (Some(MeshLength::Units(_)), _) => " # the edge of a cube in mesh units",
                (Some(MeshLength::Stated(..)), _) => " # the edge of a cube",
                (None, Some(_)) => " # about so many points",
                (None, None) => "",
            };
            line(&format!("fill  = {}{words}", entry.toml()));
        }
    }
    let written = if unit.parse::<f64>().is_ok() { unit.to_string() } else { quoted(unit) };
    line(&format!("scale = {written:<17} # metres per mesh unit; \"mm\" for a mesh in millimetres"));
    if let Some(space) = space {
        line(&format!("space = {space:<17} # the dimension of the space"));
    }
    if !elements.is_empty() {
        let names: Vec<String> = elements.iter().map(|name| quoted(name)).collect();
        line(&format!("elements = [{}]", names.join(", ")));
    }
    line("");
    groups(mesh).iter().for_each(|listed| line(listed));
    material_lines(mesh, material, scale).iter().for_each(|written| line(written));
    let poisson = material.poisson.or(stated_poisson(mesh)).unwrap_or(POISSON);
    for (i, Fit { name, objective, keys, words }) in Fit::recommended(mesh, poisson).into_iter().enumerate() {
        line("[[fit]]");
        line(&format!("name      = {:<13} # {}", quoted(name), if i == 0 { "of your choice" } else { RECOMMENDED }));
        line(&format!("objective = {:<13} # {words}{}", quoted(objective), if keys.is_empty() { "\n" } else { "" }));
        keys.iter().enumerate().for_each(|(i, (key, value, words))| {
            let end = if i + 1 == keys.len() { "\n" } else { "" };
            line(&format!("{key:<9} = {:<13} # {words}{end}", quoted(value)));
        });
    }
    let with_volume = positive(mesh);
    if let Some((objective, springs)) = with_volume {
        line("[[fit]]");
        let words = match objective {
            "divergence" => "none pulls at rest: MuJoCo, Newton and Jolt hold them",
            _ => "none pulls at rest; exports divide what its cells contain",
        };
        line(&format!("name        = \"positive\"   # {words}"));
        line(&format!(
            "objective   = {:<12} # springs with the lengths of the mesh, and volume springs",
            quoted(objective)
        ));
        line(&format!("springs     = {springs}\nnonnegative = true\n"));
    }
    line("[[fit]]");
    line("name        = \"classical springs, k >= 0\"");
    line("objective   = \"offdiag\"   # springs alone; `springfit fit --help` lists the objectives");
    line("nonnegative = true");
    let names = mesh.blocks.first().map(|block| block.element.springs.iter().map(|group| quoted(&group.name)));
    let names = names.into_iter().flatten().collect::<Vec<_>>().join(", ");
    line(&format!("# springs = [{names}]   # spring groups; those that are not optional if absent\n"));
    if let Some((objective, springs)) = with_volume {
        let is_given = mesh.point_count() <= MOST_COMPARED && mesh.elevated().is_ok();
        if is_given {
            line("[reference]              # errors are relative to");
            line("from = \"quadratic\"       # quadratic elements on the same cells, which bend and shear better\n");
        }
        line("# One object under the supports below errs less if it is fitted as a whole to quadratic elements:");
        if !is_given {
            line("# [reference]\n# from = \"quadratic\"");
        }
        line(&format!(
            "# [[fit]]\n# name      = \"calibrated\"\n# objective = \"whole\"\n# start     = {}\n# springs   = {springs}\n",
            quoted(objective)
        ));
    }
    let longest = mesh.longest_side();
    conditions(mesh, longest, young(mesh, material, scale)).iter().for_each(|written| line(written));
    line("\n[output]");
    line("# vtu = true              # springs and displacements for ParaView");
    line("# csv = true              # springs as a table");
    line("# moduli = true           # each network as a material");
    line("# frequencies = 6         # natural frequencies");
    text
}

/// The key that a fill of the mesh needs besides, if the mesh is a surface that is closed, or may be when it is welded.
fn fillable(mesh: &Mesh) -> Option<&'static str> {
    if (mesh.cell_dimension(), mesh.dimension) != (2, 3) {
        return None;
    }
    let is_closed = || Selection::Everything.sides(mesh).is_ok_and(|sides| sides.is_empty());
    match mesh.quality.unwelded {
        true => Some(", repair = true"),
        false => is_closed().then_some(""),
    }
}

/// Why the second fit is there.
const RECOMMENDED: &str = "the better one where your program holds springs on several cells";

/// A fit for the mesh by the page *How to choose* of the book.
struct Fit {
    name: &'static str,
    objective: &'static str,
    /// Further keys with their values, and what they do.
    keys: &'static [(&'static str, &'static str, &'static str)],
    words: &'static str,
}

impl Fit {
    /// The fit that every program holds which has volume constraints, and the one that errs less with springs on several cells, if there is one.
    fn recommended(mesh: &Mesh, poisson: f64) -> Vec<Fit> {
        const EDGES: (&str, &str, &str) =
            ("shear", "edges", "springs on several cells; errs less than the finite elements");
        let words = "springs and volume constraints that have the energy of the material";
        let exact = |name, keys| Fit { name, objective: "exact", keys, words };
        let all = |holds: &dyn Fn(&CellBlock) -> bool| mesh.blocks.iter().all(holds);
        if mesh.cell_dimension() < mesh.dimension {
            let is_flat = |block: &CellBlock| {
                let is_curve = block.element.dimension() == 1 && block.element.has_corners_alone();
                is_curve || check_flat(&block.element, &mesh.points, &block.connectivity).is_ok()
            };
            if !all(&is_flat) {
                let words = "bent cells of a surface or curve have no exact network";
                return vec![Fit { name: "least squares", objective: "frobenius", keys: &[], words }];
            }
            return vec![exact("exact", &[])];
        }
        let is_linear = all(&|block| block.element.has_corners_alone()) && mesh.cell_dimension() > 1;
        let is_simplex = all(&|block| block.element.cell.is_simplex());
        match (is_linear && is_simplex, poisson >= LOCKS) {
            (true, true) => {
                const PATCHES: (&str, &str, &str) =
                    ("volume", "patches", "volume springs around nodes, which do not lock");
                vec![exact("exact", &[]), exact("smoothed", &[EDGES, PATCHES])]
            }
            (true, false) => vec![exact("exact", &[]), exact("smoothed", &[EDGES])],
            (false, true) if is_linear => {
                vec![exact("exact", &[("volume", "cells", "one volume spring for each cell, which does not lock")])]
            }
            (false, _) => vec![exact("exact", &[])],
        }
    }
}

/// The objective and the groups of the fit with volume springs that *How to choose* has for programs without negative constants and with the
/// lengths of the mesh: on solid and plane bodies of linear simplices, or of linear hexahedra and quadrilaterals.
fn positive(mesh: &Mesh) -> Option<(&'static str, &'static str)> {
    let all = |holds: &dyn Fn(&CellBlock) -> bool| mesh.blocks.iter().all(holds);
    let is_of =
        |words: &'static str| move |block: &CellBlock| block.element.select_groups(Some(&[words.to_string()])).is_ok();
    let is_full = mesh.cell_dimension() == mesh.dimension && mesh.cell_dimension() > 1;
    if !is_full || !all(&|block| block.element.has_corners_alone()) || !all(&is_of("all + volume")) {
        return None;
    }
    // Of elements with corners alone only quadrilaterals and hexahedra have `2^d` nodes.
    let is_bricks = |block: &CellBlock| block.element.nodes() == 1 << block.element.dimension();
    match (all(&|block| block.element.cell.is_simplex()), all(&is_bricks)) {
        (true, _) => Some(("divergence", "[\"all + volume\"]")),
        (false, true) => Some(("modal", "[\"all + volume\"]")),
        (false, false) => None,
    }
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
