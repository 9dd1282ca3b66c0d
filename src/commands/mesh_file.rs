//! Arguments that are meshes.

use clap::Args;
use springfit_foundation::error::{Error, Result, expect_none};
use springfit_foundation::quantity::Quantity;
use springfit_foundation::range;
use springfit_mesh::mesh::{Gate, Mesh, MeshSource};
use springfit_studies::study::{FillEntry, MeshLength, check_unit, load_elements, unit_note};
use std::path::Path;

/// How a mesh file is read.
#[derive(Args)]
#[command(next_help_heading = "Mesh")]
pub struct MeshOptions {
    /// Length of one mesh unit, such as mm or 0.001
    #[arg(long, default_value = "1", allow_hyphen_values = true)]
    scale: String,
    /// Dimension of the space, 2 or 3 [default: surfaces of .obj, .stl, .ply, .off and .vtp are in space; others in the plane if they have one z]
    #[arg(long)]
    space: Option<usize>,
    /// What to do with cells whose quality is below --least: warn, refuse or skip [default: warn]. Flat, tangled, duplicate and
    /// overlapping cells are left out with skip, and an error otherwise
    #[arg(long)]
    below: Option<String>,
    /// The least quality of a cell, from 0 for flat to 1 for right angles [default: 1e-4]
    #[arg(long, allow_hyphen_values = true)]
    least: Option<f64>,
    /// The mesh is a closed surface: fill it with cells of this edge, a number of mesh units or a length such as "4 mm"
    #[arg(long, allow_hyphen_values = true)]
    fill: Option<String>,
    /// The mesh is a closed surface: fill it so that there are about this number of points, in place of --fill
    #[arg(long)]
    points: Option<usize>,
    /// Mend a damaged surface, such as a scan, before it is filled: weld, turn outwards, keep the largest piece, close small holes
    #[arg(long)]
    repair: bool,
    /// The element of hexahedra or tetrahedra that fills a surface, or into which voxels of an image are divided [default: cubes of eight nodes]
    #[arg(long)]
    fill_element: Option<String>,
    /// The boundary of a filled surface: stepped, or smooth with tetrahedra that are cut off at it [default: stepped]
    #[arg(long)]
    fill_boundary: Option<String>,
    /// What happens if layers of the surface overlap: refuse, or union to fill what any of them encloses [default: refuse, with --repair union]
    #[arg(long)]
    fill_layers: Option<String>,
    /// An element file to look in before the shipped ones; may be repeated
    #[arg(long)]
    element: Vec<String>,
}

impl MeshOptions {
    /// The element files.
    pub fn elements(&self) -> &[String] {
        &self.element
    }

    /// The length of one mesh unit as it is typed.
    pub fn unit(&self) -> &str {
        &self.scale
    }

    /// The dimension of the space, if it is given.
    pub fn space(&self) -> Option<usize> {
        self.space
    }

    /// Metres per mesh unit.
    ///
    /// # Errors
    /// It is no positive length.
    pub fn scale(&self) -> Result<f64> {
        let scale = Quantity::MeshUnit.parse(&self.scale).map_err(|e| e.under("--scale"))?;
        range::positive("--scale", scale, "metres per mesh unit")
    }

    /// A note if no unit is given and the size of the mesh suggests that it is not the metre.
    pub fn unit_note(&self, mesh: &Mesh) -> Option<String> {
        let is_taken = self.scale.parse::<f64>().is_ok_and(|scale| scale == 1.0);
        is_taken.then(|| unit_note(mesh, "--scale mm")).flatten()
    }

    /// The mesh in the file.
    ///
    /// # Errors
    /// An option or the file is wrong.
    pub fn mesh(&self, file: &Path) -> Result<Mesh> {
        let scale = self.scale()?;
        let own = load_elements(&self.element, Path::new("")).map_err(|e| e.placed(|e| e.at_key("--element")))?;
        if let Some(fill) = self.filling(file)? {
            let others = [
                ("--below", self.below.is_some()),
                ("--least", self.least.is_some()),
                ("--space", self.space.is_some()),
                ("--element", !self.element.is_empty()),
            ];
            expect_none(others, "belongs to the cells of a file, found it with a fill, whose cells are all alike")?;
            let fault = |e: Error| {
                let option = match e.key() {
                    Some("cell") => "--fill",
                    Some("points") => "--points",
                    Some("repair") => "--repair",
                    Some("boundary") => "--fill-boundary",
                    Some("layers") => "--fill-layers",
                    _ => "--fill-element",
                };
                e.placed(|e| e.at_key(option))
            };
            let mesh = fill.build(scale, Path::new("")).map_err(fault)?;
            check_unit(&mesh, scale).map_err(|e| e.at_key("--scale").in_file(file))?;
            return Ok(mesh);
        }
        let mut source = MeshSource::read(file)?;
        if let Some(space) = self.space.filter(|space| !(2..=3).contains(space)) {
            return Err(Error::expected("--space", "2 or 3", space));
        }
        source.space = self.space.or(source.space);
        let asked = self.below.is_some() || self.least.is_some();
        let gate = Gate::named(self.below.as_deref(), self.least).map_err(Error::of_option)?;
        let mesh = Mesh::resolve_within(&source, &own, scale, asked.then_some(gate)).map_err(|e| e.in_file(file))?;
        check_unit(&mesh, scale).map_err(|e| e.at_key("--scale").in_file(file))?;
        Ok(mesh)
    }

    /// How the surface in the file is filled, if it is.
    ///
    /// # Errors
    /// The edge of the cells is no length.
    pub fn filling(&self, surface: &Path) -> Result<Option<FillEntry>> {
        let usual = FillEntry::new(surface);
        let is_asked = self.filling_options().into_iter().any(|(_, given)| given);
        let cell = self.fill.as_deref().map(MeshLength::parse).transpose().map_err(|e| e.under("--fill"))?;
        Ok(is_asked.then(|| FillEntry {
            cell,
            points: self.points,
            element: self.fill_element.clone().unwrap_or(usual.element),
            boundary: self.fill_boundary.clone().unwrap_or(usual.boundary),
            layers: self.fill_layers.clone(),
            repair: self.repair,
            ..usual
        }))
    }

    /// The options of a fill, and whether each is given.
    fn filling_options(&self) -> [(&'static str, bool); 6] {
        [
            ("--fill", self.fill.is_some()),
            ("--points", self.points.is_some()),
            ("--repair", self.repair),
            ("--fill-element", self.fill_element.is_some()),
            ("--fill-boundary", self.fill_boundary.is_some()),
            ("--fill-layers", self.fill_layers.is_some()),
        ]
    }

    /// That none is given with a scene, which has its own.
    ///
    /// # Errors
    /// One is given.
    pub fn expect_none(&self) -> Result<()> {
        let given = [
            ("--scale", self.scale != "1"),
            ("--below", self.below.is_some()),
            ("--least", self.least.is_some()),
            ("--space", self.space.is_some()),
            ("--element", !self.element.is_empty()),
        ];
        let given = given.into_iter().chain(self.filling_options());
        expect_none(given, "belongs to a mesh file, found it with a scene, which has keys for it")
    }
}
