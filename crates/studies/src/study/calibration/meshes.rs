//! The meshes of a calibration: that of the scene, and finer ones.

use super::readings::Observed;
use crate::calibration::{Asked, Laws, Level, LoadCase};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::{Embedding, Mesh};
use crate::model::cell_places;
use springfit_scenes::{Scene, applied_cases};

/// The degrees of freedom of the finest mesh, where the scene does not say how often the mesh is refined: some seconds for each step.
const USUAL: usize = 60_000;
/// Refinements where the scene does not say how many.
const TWICE: usize = 2;
/// The degrees of freedom of a mesh at large deformation, whose steps are dearer.
const LARGE: usize = 12_000;

/// The mesh of the scene and its refinements.
pub(super) fn meshes(scene: &Scene, mesh: Mesh, wanted: Option<usize>) -> Result<Vec<Mesh>> {
    let most = if scene.law().is_some() { LARGE } else { USUAL };
    // A refinement halves the edges: each cell becomes `2^d` cells, and points grow about alike.
    let growth = 1 << mesh.cell_dimension();
    let mut all = vec![mesh];
    for _ in 0..wanted.unwrap_or(TWICE) {
        let last = &all[all.len() - 1];
        // The size of the next mesh by its growth, so that it need not be made to be refused.
        if wanted.is_none() && last.points.len() * growth > most {
            break;
        }
        let finer = last.refined()?;
        all.push(finer);
    }
    Ok(all)
}

/// A mesh with the loads that were measured.
pub(super) fn level<'a>(
    scene: &Scene,
    mesh: Mesh,
    (asked, first): (Asked, Option<&Mesh>),
    observed: &Observed,
    laws: Option<&'a Laws<'a>>,
) -> Result<Level<'a>> {
    let materials = scene.material_of(&mesh)?;
    let (_, cases) = applied_cases(scene, &mesh, &materials)?;
    let mut loads = Vec::new();
    for &number in &observed.loads {
        let case = &cases[number];
        if laws.is_some() && (case.pressed.is_some() || case.cavity.is_some()) {
            let expected = "loads whose forces keep their directions, of a material with a law";
            let found = format!("the pressure of \"{}\", which follows the body", case.name);
            return Err(Error::expected("load", expected, found).of_kind(ErrorKind::Unsupported));
        }
        loads.push(LoadCase { name: case.name.clone(), support: case.support.clone(), forces: case.forces.clone() });
    }
    // Places in millimetres lie far outside of a body in metres: the unit is asked for first.
    let outside = |e: Error| match e.kind() {
        ErrorKind::Unsupported => e.under("measured"),
        _ => Error::at(
            "measured",
            format!(
                "{}: is the unit of the places that of the scene, m?",
                e.problem().replace("of the other mesh", "of the mesh")
            ),
        ),
    };
    let places = Embedding::of(&observed.places, &mesh).map_err(outside)?;
    // All meshes are of the same body: places that are in the first are in the others.
    if first.is_none() {
        observed.check_inside(mesh.dimension, &places.multiples)?;
    }
    let parts =
        observed.parts.iter().map(|name| mesh.groups.get(name).map_or(Vec::new(), |group| group.points.clone()));
    let parts = parts.collect();
    let owners = if asked == Asked::Cells { owners(&mesh, first)? } else { Vec::new() };
    let large = laws.map(|laws| (laws, scene.newton()));
    Ok(Level::new(mesh, materials, owners, loads, places, parts, scene.solver(), large))
}

/// The cell of the first mesh that has the middle of each cell, by block; cells of the first mesh are counted through all its blocks.
fn owners(mesh: &Mesh, first: Option<&Mesh>) -> Result<Vec<Vec<usize>>> {
    let Some(first) = first else {
        let mut next = 0;
        let own = mesh.blocks.iter().map(|block| {
            let count = block.cells().len();
            next += count;
            (next - count..next).collect()
        });
        return Ok(own.collect());
    };
    let starts: Vec<usize> = first
        .blocks
        .iter()
        .scan(0, |next, block| {
            let start = *next;
            *next += block.cells().len();
            Some(start)
        })
        .collect();
    let block = |places: &Vec<(f64, Vec<f64>)>| {
        // The middle of a refined cell lies inside its parent, away from the sides that the parent shares.
        let middles: Vec<f64> = places.iter().flat_map(|(_, middle)| middle.clone()).collect();
        let found = Embedding::of(&middles, first)?;
        Ok(found.cells.iter().map(|cell| starts[cell.block] + cell.cell).collect())
    };
    cell_places(mesh).iter().map(block).collect()
}
