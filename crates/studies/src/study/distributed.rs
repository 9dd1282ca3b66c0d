//! Scenes whose cells are shared among several machines: what is worked out once, and what each works out from its own cells.
//!
//! Theory: page *Bodies on several machines* of the book.

use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::{CellFits, ShearSprings};
use crate::material::MaterialMap;
use crate::mesh::Mesh;
use crate::model::{BlockStiffness, Network};
use springfit_scenes::{Case, Fitted, NamedFit, Progress, Recipe, Reference, Scene, Task, load_cases, load_elements};
use std::path::Path;
use std::sync::Arc;

/// The mesh and the loads of a scene that several machines can solve together: small deformations of a solid or plane body of one
/// isotropic material, and fits that need one cell at a time.
///
/// # Errors
/// An input is wrong, or the scene asks for something else (kind `Unsupported`).
pub fn distributed_body(scene: &Scene) -> Result<(Mesh, Vec<Case>)> {
    let body = || {
        check(scene)?;
        let mesh = scene.build_mesh()?;
        let material = scene.material_of(&mesh)?;
        if scene.laws(&mesh, &material)?.is_some() {
            return Err(refused("material.law", "small deformations", "a law"));
        }
        if material.uniform().is_none() {
            return Err(refused("material", "one isotropic material", "regions or another"));
        }
        if !BlockStiffness::is_of(&mesh) || mesh.cell_dimension() < mesh.dimension {
            return Err(refused("mesh", "a plane or solid body", "lines or a surface in space"));
        }
        let (_, cases) = load_cases(scene, &mesh, &material)?;
        Ok((mesh, cases))
    };
    body().map_err(|e: Error| e.placed(|e| e.in_file(scene.path()))).map_err(|e| scene.with_line(e))
}

fn refused(key: &str, expected: &str, found: &str) -> Error {
    Error::expected(key, format!("{expected} on several machines"), found).of_kind(ErrorKind::Unsupported)
}

fn check(scene: &Scene) -> Result<()> {
    if scene.loads().is_empty() {
        return Err(refused("load", "a load", "none"));
    }
    let others = [
        ("reference", scene.reference().is_some()),
        ("gauge", scene.gauge().is_some()),
        ("motion", scene.motion().is_some()),
        ("output.frequencies", scene.output().frequencies > 0),
        ("output.dynamic_moduli", scene.output().dynamic_moduli.is_some()),
        ("output.moduli", scene.output().moduli),
    ];
    if let Some((key, _)) = others.iter().find(|(_, asked)| *asked) {
        return Err(refused(key, "displacements under loads", "more"));
    }
    if let Some(i) = scene.loads().iter().position(|load| load.measured.is_some()) {
        return Err(refused(&format!("load[{i}].measured"), "displacements of finite elements", "measured ones"));
    }
    for fit in scene.fits() {
        check_fit(fit).map_err(|e| e.under(fit.place()))?;
    }
    Ok(())
}

/// Checks that the fit needs one cell at a time.
fn check_fit(fit: &NamedFit) -> Result<()> {
    let is_of_cells = match &fit.recipe {
        Recipe::Stiffness(_) | Recipe::Exact(_) | Recipe::Published(_) => fit.recipe.kind().cell_method().is_some(),
        Recipe::Sampled(_) | Recipe::Whole(_) => false,
    };
    match (is_of_cells, &fit.recipe) {
        (true, _) => Ok(()),
        (false, Recipe::Exact(exact)) if exact.shear == ShearSprings::Edges => {
            let expected = "\"cells\" where cells are fitted apart from each other: the springs of an edge are those of all its cells";
            Err(Error::expected("shear", expected, "\"edges\"").of_kind(ErrorKind::Unsupported))
        }
        (false, _) => {
            let expected = "a fit to the stiffness of one cell at a time, where cells are fitted apart from each other";
            Err(Error::expected("objective", expected, format!("\"{}\"", fit.name)).of_kind(ErrorKind::Unsupported))
        }
    }
}

/// The springs of the cells of a mesh that are some of those of a body.
///
/// # Errors
/// The fit needs more than one cell at a time (kind `Unsupported`), or a cell cannot be fitted.
pub fn fit_some(fit: &NamedFit, mesh: &Mesh, material: &MaterialMap, progress: &mut Progress) -> Result<Fitted> {
    check_fit(fit)?;
    let reference = &Reference::default();
    let task = Task { name: &fit.name, springs: fit.springs.as_deref(), mesh, material, reference };
    fit.recipe.kind().fit(&task, progress)
}

/// Some cells of a body, on the machine that has them.
pub struct BodyShare {
    scene: Scene,
    mesh: Mesh,
    material: MaterialMap,
    /// The finite elements of these cells have this stiffness, N/m.
    pub stiffness: BlockStiffness,
}

/// The springs of some cells by one fit.
pub struct FittedShare {
    /// Each block of cells has these springs.
    pub cells: Vec<CellFits>,
    /// The springs of these cells alone make this network.
    pub network: Network,
    /// At rest.
    pub stiffness: BlockStiffness,
    /// The time for the constants, s.
    pub seconds: f64,
}

impl BodyShare {
    /// `points` are `[points × dimension]`, m; each block of cells has the name of its element and the nodes, `[cells × nodes]`. The
    /// cells are those of the body of [`distributed_body`].
    ///
    /// # Errors
    /// An element is unknown, the index of a node is not that of a point, or a cell has no volume; or the stiffness does not fit into memory.
    pub fn new(
        scene: Scene,
        dimension: usize,
        points: Vec<f64>,
        blocks: Vec<(String, Vec<usize>)>,
    ) -> Result<BodyShare> {
        let own = elements(&scene)?;
        let block = |(name, connectivity): (String, Vec<usize>)| {
            let known = own.iter().find(|element| element.name == name).cloned();
            let element = known.map_or_else(|| Element::load(&name).map(Arc::new), Ok)?;
            Ok((element, connectivity))
        };
        let blocks: Vec<(Arc<Element>, Vec<usize>)> = blocks.into_iter().map(block).collect::<Result<_>>()?;
        let mesh = Mesh::of_proved_cells(dimension, points, blocks)?;
        let material = scene.material_of(&mesh)?;
        let stiffness = BlockStiffness::of_body(&mesh, material.moduli(), 2, 1)?;
        Ok(BodyShare { scene, mesh, material, stiffness })
    }

    /// The points and the cells.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The springs by the fit of this number in the scene.
    ///
    /// # Errors
    /// There is no such fit, or a cell cannot be fitted.
    pub fn fit(&self, fit: usize, progress: &mut Progress) -> Result<FittedShare> {
        let Some(named) = self.scene.fits().get(fit) else {
            return Err(Error::expected("fit", format!("a number below {}", self.scene.fits().len()), fit));
        };
        let (mesh, place) = (&self.mesh, |e: Error| e.placed(|e| self.scene.at(&named.place(), e)));
        let fitted = fit_some(named, mesh, &self.material, progress).map_err(place)?;
        let stiffness = BlockStiffness::of_network(&fitted.network, &mesh.points, Some(&self.stiffness));
        Ok(FittedShare { cells: fitted.cells, network: fitted.network, stiffness, seconds: fitted.seconds })
    }
}

/// The elements that the scene names for its mesh.
fn elements(scene: &Scene) -> Result<Vec<Arc<Element>>> {
    let folder = scene.path().parent().unwrap_or(Path::new(""));
    let input = scene.mesh();
    let made = [
        input.generated.as_ref().map(|entry| &entry.element),
        input.disc.as_ref().map(|entry| &entry.element),
        input.fill.as_ref().map(|entry| &entry.element),
    ];
    let names: Vec<String> = input.elements.iter().chain(made.into_iter().flatten()).cloned().collect();
    load_elements(&names, folder)
}
