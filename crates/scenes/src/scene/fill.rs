//! The mesh of a scene that fills a surface.

use super::elements::load_element;
use super::value::MeshLength;
use crate::element::Element;
use crate::error::{Error, Result, expect_none};
use crate::mesh::{FillBoundary, FillLayers, FillMesh, FillSpacing, Mesh, MeshSource, VoxelMesh};
use crate::range;
use crate::text::toml as quoted;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A closed surface in a file, filled with the cells of a lattice, or voxels in a file, divided into cells of an element.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FillEntry {
    /// The surface is read from this file, relative to the scene, such as `.stl`, `.obj`, `.ply` or `.off`. It is a closed surface of
    /// triangles or quadrangles with its normals outwards, or with `repair` a damaged one. An image of labels, such as `.npy` or `.vti`, is taken as well: its voxels
    /// are the cells, or are divided into six tetrahedra each, by `element`.
    #[schemars(extend("x-type" = "path"))]
    pub surface: PathBuf,
    /// A cube of the lattice has edges of this length, above 0: a number of mesh units, or a length with a unit such as `"4 mm"`. A surface needs
    /// `cell` or `points`.
    pub cell: Option<MeshLength>,
    /// The edges of the cubes are chosen so that the mesh has about this number of points, 8 or more; the key takes the place of `cell`.
    pub points: Option<usize>,
    /// The cells have this element of hexahedra, which are the cubes, or of tetrahedra, twelve for each cube. It is the name of a shipped
    /// one, or a path relative to the scene that ends in `.toml`.
    #[serde(default = "cubes")]
    pub element: String,
    /// The body has whole cells of the lattice whose centres are inside (`stepped`), or tetrahedra that are cut off at the surface
    /// (`smooth`).
    #[serde(default = "stepped")]
    #[schemars(extend("enum" = FillBoundary::NAMES))]
    pub boundary: String,
    /// A surface that crosses itself is refused (`refuse`), or what any of its layers encloses is filled (`union`).
    #[schemars(extend("enum" = FillLayers::NAMES, "x-default" = "`\"refuse\"`, with `repair` `\"union\"`"))]
    pub layers: Option<String>,
    /// A damaged surface, such as a scan, is mended before it is filled: corners are welded, double and flat triangles left out, triangles
    /// turned outwards, pieces apart from the largest left out, and small holes closed. Notes count what was changed.
    #[serde(default)]
    pub repair: bool,
}

fn stepped() -> String {
    FillBoundary::default().name().into()
}

fn cubes() -> String {
    FillMesh::cube().into()
}

impl FillEntry {
    /// The fill of a surface without further keys.
    pub fn new(surface: &Path) -> FillEntry {
        FillEntry {
            surface: surface.to_path_buf(),
            cell: None,
            points: None,
            element: cubes(),
            boundary: stepped(),
            layers: None,
            repair: false,
        }
    }

    /// Fills the surface, with `scale` metres per mesh unit; paths are relative to `folder`.
    ///
    /// # Errors
    /// The file, a key, the element or the surface is wrong, or there are no cells or too many.
    pub fn build(&self, scale: f64, folder: &Path) -> Result<Mesh> {
        let element = load_element(&self.element, folder)?;
        let source = MeshSource::read(&folder.join(&self.surface))?;
        self.of_source(&source, element, scale, folder)
    }

    /// Fills a surface, or divides voxels, that is read already or in memory, with cells of this element.
    ///
    /// # Errors
    /// Those of [`FillEntry::build`].
    pub fn of_source(&self, source: &MeshSource, element: Arc<Element>, scale: f64, folder: &Path) -> Result<Mesh> {
        let path = folder.join(&self.surface);
        let of_file = |e: Error| if e.key() == Some("surface") { e.in_file(&path) } else { e };
        if source.is_solid() {
            self.check_solid(&path)?;
            // What is wrong with cells and points is wrong in the file.
            let of_cells = |e: Error| if e.key() == Some("element") { e } else { e.in_file(&path) };
            return VoxelMesh { element }.build(source, scale).map_err(of_cells);
        }
        let spacing = self.spacing(scale)?;
        let boundary = FillBoundary::named(&self.boundary).map_err(|e| e.at_key("boundary"))?;
        let layers = self.layers.as_deref().map(FillLayers::named).transpose().map_err(|e| e.at_key("layers"))?;
        // A scan may cross itself, and what it encloses is the body.
        let usual = if self.repair { FillLayers::Union } else { FillLayers::default() };
        FillMesh { element, spacing, boundary, layers: layers.unwrap_or(usual), repair: self.repair }
            .build(source, scale)
            .map_err(of_file)
    }

    /// How large the cubes are.
    ///
    /// # Errors
    /// None or both of the keys are given, or the edge is no length.
    fn spacing(&self, scale: f64) -> Result<FillSpacing> {
        match (&self.cell, self.points) {
            (Some(MeshLength::Units(cell)), None) => {
                Ok(FillSpacing::Edge(scale * range::positive("cell", *cell, "mesh units")?))
            }
            (Some(MeshLength::Stated(_, metres)), None) => {
                Ok(FillSpacing::Edge(range::positive("cell", *metres, "m")?))
            }
            (None, Some(points)) => Ok(FillSpacing::Points(points)),
            (Some(cell), Some(points)) => {
                let expected = "the number of points or the edge of a cube, which gives it";
                Err(Error::expected("points", expected, format!("both, {points} points and edges of {}", cell.toml())))
            }
            (None, None) => {
                let expected = "the edge of a cube in mesh units, or the number of points, for a surface";
                Err(Error::expected("cell", expected, "neither"))
            }
        }
    }

    /// That no key of a surface is given.
    ///
    /// # Errors
    /// One is.
    fn check_solid(&self, path: &Path) -> Result<()> {
        let given = [
            ("repair", self.repair),
            ("cell", self.cell.is_some()),
            ("points", self.points.is_some()),
            ("boundary", self.boundary != stepped()),
            ("layers", self.layers.is_some()),
        ];
        expect_none(given, format!("belongs to a surface, found it with {}, whose cells are solid", path.display()))
    }

    /// The entry as a table of TOML, without keys that have their defaults.
    pub fn toml(&self) -> String {
        let mut keys = vec![("surface", quoted(&self.surface.to_string_lossy()).to_string())];
        keys.extend(self.cell.as_ref().map(|cell| ("cell", cell.toml())));
        keys.extend(self.points.map(|points| ("points", points.to_string())));
        keys.push(("element", quoted(&self.element).to_string()));
        keys.extend((self.boundary != stepped()).then(|| ("boundary", quoted(&self.boundary).to_string())));
        let unusual = self.layers.iter().filter(|layers| self.repair || *layers != FillLayers::default().name());
        keys.extend(unusual.map(|layers| ("layers", quoted(layers).to_string())));
        keys.extend(self.repair.then(|| ("repair", "true".to_string())));
        let keys: Vec<String> = keys.into_iter().map(|(key, value)| format!("{key} = {value}")).collect();
        format!("{{ {} }}", keys.join(", "))
    }
}
