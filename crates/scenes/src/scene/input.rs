//! The mesh of a scene: a file, or a generated one.

use super::elements::{load_element, load_elements};
use super::fill::FillEntry;
use super::in_memory::InMemory;
use super::value;
use crate::bound;
use crate::error::{Error, Result, expect_none};
use crate::extent::unit_note;
use crate::mesh::{BoxMesh, DiscMesh, Embedding, Gate, Mesh, MeshSource};
use crate::range;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A body of a file that is longer than this has another unit than the metre, m.
const TOO_LONG: f64 = 1e5;

/// The mesh of a scene: a file, a box, a disc or a filled surface.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshInput {
    /// The mesh is read from this file, relative to the scene, such as `.msh`, `.vtu`, `.inp` or `.bdf`. One of `file`, `box`, `disc` and
    /// `fill` is required.
    #[schemars(extend("x-type" = "path"))]
    pub file: Option<PathBuf>,
    /// The mesh is a box that is generated.
    #[serde(rename = "box")]
    pub generated: Option<BoxEntry>,
    /// The mesh is a disc or dome of triangles that is generated.
    pub disc: Option<DiscEntry>,
    /// The mesh fills a closed surface with cells, or divides voxels.
    pub fill: Option<FillEntry>,
    /// One unit of the mesh has this length in m, above 0.
    #[serde(default = "one", deserialize_with = "value::mesh_unit")]
    #[schemars(schema_with = "value::mesh_unit_schema")]
    pub scale: f64,
    /// The mesh of a `file` or of a `box` is in a space of this dimension, 2 or 3: a box of triangles is a sheet at z = 0 with 3. Without the key a surface of a format of surfaces (`.obj`, `.stl`, `.ply`, `.off`,
    /// `.vtp`) is in space, and other surfaces and curves are in the plane where all their points have one z.
    #[schemars(extend("x-default" = "by the file or the element"))]
    pub space: Option<usize>,
    /// These element files are searched before the shipped elements; paths are relative to the scene.
    #[serde(default)]
    #[schemars(extend("x-type" = "list of paths"))]
    pub elements: Vec<String>,
    /// `quality` says what becomes of poor cells of a `file`. Without it, cells below 1e-4 are reported.
    pub quality: Option<QualityEntry>,
    /// Whether `scale` is a text with a unit, such as `"m"`.
    #[serde(skip)]
    pub states_unit: bool,
    /// How often the edges of all cells are halved.
    #[serde(skip)]
    pub halvings: u32,
    /// The groups that materials name: their cells are part of the body also where they have fewer dimensions than it.
    #[serde(skip)]
    pub attached: Vec<String>,
    /// What names of files mean before files.
    #[serde(skip)]
    pub memory: InMemory,
}

#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct QualityEntry {
    /// A cell below this quality is poor, from 0 for flat to 1 for right angles.
    #[schemars(extend("default" = Gate::default().least))]
    pub least: Option<f64>,
    /// Poor cells are kept with a warning (`warn`), are an error (`refuse`), or are left out (`skip`).
    #[schemars(extend("enum" = ["warn", "refuse", "skip"], "default" = "warn"))]
    pub below: Option<String>,
}

impl QualityEntry {
    fn gate(&self) -> Result<Gate> {
        Gate::named(self.below.as_deref(), self.least).map_err(|e| e.under("mesh.quality"))
    }
}

/// A box filled with one element; lengths in mesh units.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxEntry {
    /// The cells have this element: the name of a shipped one, or a path relative to the scene that ends in `.toml`. Its cells must fill a
    /// box; triangles, tetrahedra, wedges and pyramids divide each square or cube.
    pub element: String,
    /// The box has these lengths along the axes, in mesh units.
    pub size: Vec<f64>,
    /// The box has these numbers of cells along the axes.
    pub cells: Vec<usize>,
    /// The corner of least coordinates is here, in mesh units.
    #[schemars(extend("x-default" = "zeros"))]
    pub origin: Option<Vec<f64>>,
}

/// A round disc or dome of triangles; lengths in mesh units.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DiscEntry {
    /// The cells have this element on triangles: the name of a shipped one, or a path relative to the scene that ends in `.toml`.
    pub element: String,
    /// The disc has this radius in mesh units.
    pub radius: f64,
    /// The middle is this height above the rim, in mesh units.
    #[serde(default)]
    pub height: f64,
    /// The disc has this number of rings of triangles, from 1 to 800.
    pub rings: usize,
    /// The disc has this number of points in all; the key needs `rim`. Without both, each ring has six points more than the one inside it.
    #[schemars(extend("x-default" = "six more in each ring"))]
    pub points: Option<usize>,
    /// The rim has this number of points; the key needs `points`.
    pub rim: Option<usize>,
}

/// The largest number of rings; a disc with six more points in each ring then has about two million points.
const MOST_RINGS: usize = 800;
/// The largest number of points, see [`bound::CELLS`].
const MOST_POINTS: usize = bound::CELLS as usize;

fn one() -> f64 {
    1.0
}

impl MeshInput {
    /// A note if the scene has no unit of the mesh file and the size of the mesh suggests that it is not the metre.
    pub fn unit_assumption(&self, mesh: &Mesh) -> Option<String> {
        let is_of_file = (self.file.is_some() && self.in_memory().is_none()) || self.fill.is_some();
        let is_taken = is_of_file && self.scale == 1.0 && !self.states_unit;
        is_taken.then(|| unit_note(mesh, "scale = \"mm\"")).flatten()
    }

    /// Checks the entry.
    ///
    /// # Errors
    /// There is no source of the mesh or more than one, or a number is out of its range.
    pub fn check(&self) -> Result<()> {
        let given: Vec<&str> = [
            ("file", self.file.is_some()),
            ("box", self.generated.is_some()),
            ("disc", self.disc.is_some()),
            ("fill", self.fill.is_some()),
        ]
        .into_iter()
        .filter_map(|(key, given)| given.then_some(key))
        .collect();
        if given.len() != 1 {
            let found = if given.is_empty() { "none".into() } else { given.join(" and ") };
            return Err(Error::expected("mesh", "one of \"file\", \"box\", \"disc\", \"fill\"", found));
        }
        range::positive("mesh.scale", self.scale, "metres per mesh unit")?;
        if self.in_memory().is_some() {
            let given = [
                ("mesh.scale", self.scale != 1.0),
                ("mesh.space", self.space.is_some()),
                ("mesh.elements", !self.elements.is_empty()),
                ("mesh.quality", self.quality.is_some()),
            ];
            expect_none(given, "belongs to a mesh that is read, found one from memory, which is in metres")?;
        }
        if let Some(space) = self.space {
            if self.file.is_none() && self.generated.is_none() {
                let problem = "belongs to a mesh in a \"file\" or a \"box\": what else is generated has its own";
                return Err(Error::at("mesh.space", problem));
            }
            if !(2..=3).contains(&space) {
                return Err(Error::expected("mesh.space", "2 or 3", space));
            }
        }
        if let Some(quality) = &self.quality {
            if self.file.is_none() {
                return Err(Error::at("mesh.quality", "belongs to a mesh in a \"file\": what is generated is regular"));
            }
            quality.gate()?;
        }
        Ok(())
    }

    /// The mesh that `file` names, if it is in memory.
    fn in_memory(&self) -> Option<&Arc<Mesh>> {
        self.memory.mesh(self.file.as_deref()?)
    }

    /// The files that the entry names, relative to `folder`; the names of shipped elements are not files.
    pub fn files(&self, folder: &Path) -> Vec<PathBuf> {
        let of_box = self.generated.iter().map(|entry| &entry.element);
        let of_fill = self.fill.iter().map(|entry| &entry.element);
        let of_disc = self.disc.iter().map(|entry| &entry.element);
        let elements = of_box.chain(of_disc).chain(of_fill).chain(&self.elements);
        let file = self.file.iter().filter(|file| !self.memory.has(file));
        let meshes = file.chain(self.fill.iter().map(|entry| &entry.surface));
        let meshes = meshes.flat_map(|file| MeshSource::files(&folder.join(file)));
        meshes.chain(elements.map(|name| folder.join(name))).collect()
    }

    /// What is read or generated, in words.
    pub fn title(&self) -> String {
        if let Some(entry) = &self.fill {
            return format!("fill {} with {}", entry.surface.display(), entry.element);
        }
        if let Some(mesh) = self.in_memory() {
            return format!("mesh from memory ({:08x})", mesh.checksum());
        }
        match (&self.file, &self.generated, &self.disc) {
            (Some(file), ..) => format!("read {}", file.display()),
            (_, Some(entry), _) => format!("generate {:?} cells of {}", entry.cells, entry.element),
            (.., Some(entry)) => format!("generate {} rings of {}", entry.rings, entry.element),
            _ => "mesh".into(),
        }
    }
}

/// That a body of a file is no longer than bodies are, if its unit is taken to be the metre. A filled surface is shorter than its cells
/// by up to the edge of one.
///
/// # Errors
/// It is; the key is `scale`.
pub fn check_unit(mesh: &Mesh, scale: f64) -> Result<()> {
    let edge = mesh.quality.filled.as_ref().map_or(0.0, |filled| filled.edge);
    let longest = mesh.longest_side();
    if scale == 1.0 && longest - edge > TOO_LONG {
        let expected =
            format!("the length of a mesh unit, such as mm, for a body longer than {:.0} km", TOO_LONG / 1e3);
        let found = format!("1 m, and a body of {:.0} km", longest / 1e3);
        return Err(Error::expected("scale", expected, found));
    }
    Ok(())
}

impl DiscEntry {
    fn build(&self, scale: f64, folder: &Path) -> Result<Mesh> {
        if !(1..=MOST_RINGS).contains(&self.rings) {
            return Err(Error::expected("rings", format!("1 to {MOST_RINGS} rings"), self.rings));
        }
        let rings = match (self.points, self.rim) {
            (None, None) => DiscMesh::even(self.rings),
            (Some(points), Some(rim)) => {
                // Bounded before the rings are made; that the bound was reached shows in the sum below.
                let rings = DiscMesh::rings_of(points.min(MOST_POINTS), self.rings, rim.min(MOST_POINTS));
                if rings.iter().any(|n| *n < 3) || rings.iter().sum::<usize>() + 1 != points {
                    let expected = format!("a middle, {rim} points on the rim and three or more on each other ring");
                    return Err(Error::expected("points", expected, points));
                }
                rings
            }
            (points, _) => {
                let key = if points.is_none() { "points" } else { "rim" };
                return Err(Error::at(key, "expected both \"points\" and \"rim\" or neither, found one"));
            }
        };
        let element = load_element(&self.element, folder)?;
        DiscMesh { element, radius: scale * self.radius, height: scale * self.height, rings }.build()
    }
}

impl MeshInput {
    /// Reads or generates the mesh of the scene at `scene`. A box is refined by its numbers of cells, any other mesh
    /// cell by cell. `choose` chooses what conditions select on the mesh that is not refined.
    ///
    /// # Errors
    /// The file or an element is wrong, or a cell has no volume or cannot be divided.
    pub fn build(&self, scene: &Path, choose: &dyn Fn(&mut Mesh)) -> Result<Mesh> {
        let mut mesh = self.build_coarse(scene, 0)?;
        choose(&mut mesh);
        if self.halvings == 0 {
            return Ok(mesh);
        }
        if self.generated.is_none() {
            for _ in 0..self.halvings {
                mesh = mesh.refined().map_err(|e| e.in_file(scene))?;
            }
            return Ok(mesh);
        }
        let mut fine = self.build_coarse(scene, self.halvings)?;
        if !mesh.conditions.is_empty() {
            let places = Embedding::of(&fine.points, &mesh).map_err(|e| e.in_file(scene))?;
            fine.choose_as_on(&mesh, &places).map_err(|e| e.in_file(scene))?;
        }
        Ok(fine)
    }

    /// The mesh, a box with its cells halved this number of times, with membranes and rods where a material names sides.
    fn build_coarse(&self, scene: &Path, halvings: u32) -> Result<Mesh> {
        let mut mesh = self.build_body(scene, halvings)?;
        mesh.attach_sides(&self.attached).map_err(|e| e.in_file(scene))?;
        Ok(mesh)
    }

    /// The mesh, a box with its cells halved this number of times, without what is on its sides.
    fn build_body(&self, scene: &Path, halvings: u32) -> Result<Mesh> {
        if let Some(mesh) = self.in_memory() {
            return Ok(Mesh::clone(mesh));
        }
        let folder = scene.parent().unwrap_or(Path::new(""));
        let at = |key: &'static str| move |e: Error| e.placed(|e| e.under(key).in_file(scene));
        if let Some(file) = &self.file {
            let own = load_elements(&self.elements, folder).map_err(at("mesh"))?;
            let path = folder.join(file);
            let gate = self.quality.as_ref().map(QualityEntry::gate).transpose()?;
            let mut source = MeshSource::read(&path)?;
            source.space = self.space.or(source.space);
            let mesh = Mesh::resolve_attached(&source, &own, self.scale, gate, &self.attached);
            let mesh = mesh.map_err(|e| e.in_file(&path))?;
            check_unit(&mesh, self.scale).map_err(at("mesh"))?;
            return Ok(mesh);
        }
        if let Some(disc) = &self.disc {
            return disc.build(self.scale, folder).map_err(at("mesh.disc"));
        }
        if let Some(fill) = &self.fill {
            let mesh = fill.build(self.scale, folder).map_err(at("mesh.fill"))?;
            check_unit(&mesh, self.scale).map_err(at("mesh"))?;
            return Ok(mesh);
        }
        let entry = self.generated.as_ref().expect("a scene has a file, a box, a disc or a surface");
        let element = load_element(&entry.element, folder).map_err(at("mesh.box"))?;
        let scaled = |lengths: &[f64]| lengths.iter().map(|x| x * self.scale).collect::<Vec<_>>();
        let origin = entry.origin.clone().unwrap_or_else(|| vec![0.0; element.dimension()]);
        // Counts that do not fit saturate, and the limit of cells refuses them. Wrapped ones would be a coarse mesh.
        let factor = 1usize.checked_shl(halvings).unwrap_or(usize::MAX);
        let cells = entry.cells.iter().map(|n| n.saturating_mul(factor)).collect();
        let spec = BoxMesh { element, size: scaled(&entry.size), cells, origin: scaled(&origin) };
        let mesh = spec.build().map_err(at("mesh.box"))?;
        match self.space {
            Some(space) if space != mesh.dimension => mesh.in_space(space).map_err(at("mesh")),
            _ => Ok(mesh),
        }
    }
}
