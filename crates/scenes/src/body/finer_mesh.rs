//! The finer mesh of the body of a scene: read, checked against the mesh of the scene, and asked for its answers to the loads of the scene.

use super::case::{Case, FinerSolution};
use super::cases::{applied_cases, held};
use super::finer_body::FinerBody;
use super::finer_large::FinerLaws;
use super::finer_linear::answers;
use crate::analysis::metrics::resultant;
use crate::error::{Error, Result};
use crate::material::CellMap;
use crate::mesh::{Embedding, Field, Mesh};
use crate::model::Moments;
use crate::progress::{Event, Progress};
use crate::scene::Scene;
use crate::solve::KnownEquations;
use crate::springs::norm;
use std::sync::{Mutex, OnceLock};

/// The ratio of the contents of two meshes from which on they are of different bodies. Coarse meshes of curved bodies lack a sixth.
// A prism in a cylinder has 0.83 of its content with six sides, 0.76 with five and 0.64 with four: quotients of 1.21,
// 1.32 and 1.57.
const OTHER: f64 = 1.4;
/// The relative difference of the contents from which on it is reported. Errors of displacements change by about that
/// share.
const ALIKE: f64 = 0.02;

/// Total forces that differ by less than this share of the forces are one force. Tractions on the sides of two meshes
/// of one curved body differ by more than rounding.
const SAME_FORCE: f64 = 1e-3;

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

    /// Replaces the forces of the cases by those that do the same work as on the finer mesh, and gives each the displacements
    /// of the finer body at the points of the mesh of the scene, unless it has measured ones of its own.
    ///
    /// # Errors
    /// The finer body has no solution under a load.
    pub fn measure(&self, scene: &Scene, cases: &mut [Case], progress: &mut Progress) -> Result<()> {
        let (_, own) = applied_cases(scene, &self.mesh, &self.material)?;
        let body = (&self.mesh, &self.material, self.solver);
        let found = match &self.large {
            Some(large) => large.answers(&self.mesh, &own, progress),
            None => answers(body, &own, &self.equations, "finer body", progress),
        };
        let found = found.map_err(|e| e.placed(|e| scene.at("reference", e)))?;
        let dimension = self.mesh.dimension;
        for ((case, own), fine) in cases.iter_mut().zip(&own).zip(found) {
            if let Some(note) = other_force(case, own, dimension) {
                progress(Event::Note(&note));
            }
            // Pressures that follow are those of the sides of the mesh.
            let follows = self.large.is_some() && case.pressed.is_some();
            if !case.is_prescribed && !follows {
                case.forces = self.embedding.restrict(&own.forces);
            }
            if !case.is_measured {
                let displacements = self.sampling.interpolate(&fine.displacement).into_iter().map(Some).collect();
                case.measured = Some(Field { displacements });
                case.finer = Some(FinerSolution { standard: self.standard, work: fine.work, uncertainty: None });
            }
        }
        self.cases.get_or_init(|| own);
        Ok(())
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

/// The note that the total force of a load on the finer mesh is another one than on the mesh of the scene.
fn other_force(case: &Case, fine: &Case, dimension: usize) -> Option<String> {
    let [own, other] = [case, fine].map(|case| resultant(&case.forces, dimension));
    let apart: Vec<f64> = own.iter().zip(&other).map(|(a, b)| a - b).collect();
    let acting = case.forces.iter().map(|f| f.abs()).sum::<f64>();
    (norm(&apart) > SAME_FORCE * acting).then(|| {
        format!(
            "the total force of {} is {:.4e} N on the finer mesh and {:.4e} N on the mesh; networks get that of the finer mesh",
            case.name,
            norm(&other),
            norm(&own)
        )
    })
}
