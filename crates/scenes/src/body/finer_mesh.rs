//! The finer mesh of the body of a scene: read, and checked against the mesh of the scene. Its answers to loads are in `finer_body.rs`.

use super::cases::held;
use super::finer_body::FinerBody;
use super::finer_large::FinerLaws;
use crate::error::{Error, Result};
use crate::material::CellMap;
use crate::mesh::{Embedding, Mesh};
use crate::model::Moments;
use crate::progress::{Event, Progress};
use crate::scene::Scene;
use crate::solve::KnownEquations;
use std::sync::{Mutex, OnceLock};

/// The ratio of the contents of two meshes from which on they are of different bodies. Coarse meshes of curved bodies lack a sixth.
// A prism in a cylinder has 0.83 of its content with six sides, 0.76 with five and 0.64 with four: quotients of 1.21,
// 1.32 and 1.57.
const OTHER: f64 = 1.4;
/// The relative difference of the contents from which on it is reported. Errors of displacements change by about that
/// share.
const ALIKE: f64 = 0.02;

impl FinerBody {
    /// The finer body of the scene, if it has one.
    ///
    /// # Errors
    /// The mesh is wrong, is of another body, or lacks the parts that are held.
    pub fn of(scene: &Scene, mesh: &Mesh, progress: &mut Progress) -> Result<Option<FinerBody>> {
        let Some(entry) = scene.reference().filter(|entry| !entry.is_of_cells()) else { return Ok(None) };
        let at = |e: Error| e.placed(|e| scene.at("reference", e));
        let mut fine = entry.build(scene.path(), mesh).map_err(at)?;
        if fine.dimension != mesh.dimension {
            let expected = format!("a mesh of dimension {}", mesh.dimension);
            return Err(at(Error::expected("mesh", expected, fine.dimension)));
        }
        if let Some(note) = difference(mesh, &fine).map_err(at)? {
            progress(Event::Note(&note));
        }
        let another =
            |e: Error| at(Error::at("mesh", format!("is not one of the same body: {}", e.problem())).of_kind(e.kind()));
        let embedding = Embedding::of(&fine.points, mesh).map_err(another)?;
        let sampling = Embedding::of(&mesh.points, &fine).map_err(another)?;
        // Bodies whose surfaces are not the same have points that no cell of the other has; conditions are then asked on the finer mesh.
        if entry.mesh.is_some() && embedding.outside == 0 && sampling.outside == 0 {
            fine.choose_as_on(mesh, &embedding).map_err(another)?;
        }
        let support = held(scene, &fine)?;
        let material = scene.material_of(&fine)?;
        let laws = scene.laws(&fine, &material)?;
        let large = laws.map(|laws| FinerLaws::of(&fine, laws, scene.newton()).map_err(at)).transpose()?;
        Ok(Some(FinerBody {
            mesh: fine,
            embedding,
            sampling,
            support,
            material,
            large,
            standard: entry.standard(),
            solver: scene.solver(),
            cases: OnceLock::new(),
            known: Mutex::default(),
            stretched: Mutex::default(),
            squares: Mutex::default(),
            equations: KnownEquations::default(),
        }))
    }
}

/// What differs between a mesh and a finer one of the same body.
///
/// # Errors
/// It is too much: they are meshes of different bodies.
fn difference(mesh: &Mesh, fine: &Mesh) -> Result<Option<String>> {
    let content = |mesh: &Mesh| Moments::of_body(mesh, CellMap::Uniform(1.0), CellMap::Uniform(1.0)).mass;
    let [own, other] = [content(mesh), content(fine)];
    let unit = ["m", "m²", "m³"][mesh.cell_dimension() - 1];
    // A body without content has a quotient that is infinite or NaN, and is refused as well.
    if !((own / other).max(other / own) <= OTHER) {
        let expected = format!("a mesh of the same body, of {own:.4e} {unit}");
        return Err(Error::expected("mesh", expected, format!("one of {other:.4e} {unit}")));
    }
    let share = 100.0 * (other / own - 1.0);
    if share.abs() > 100.0 * ALIKE {
        return Ok(Some(format!(
            "the finer mesh has {own:.4e} {unit} {share:+.1} %: errors of the networks have this difference"
        )));
    }
    let [own, other] = [mesh, fine].map(Mesh::point_count);
    Ok((other < own).then(|| format!("the finer mesh has fewer points than the mesh: {other} for {own}")))
}
