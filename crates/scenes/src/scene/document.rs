//! A scene that has been read and checked.

use super::bending::RestShape;
use super::calibrate::CalibrationRecipe;
use super::entry::FixEntry;
use super::gauge::Gauge;
use super::hold::Hold;
use super::in_memory::InMemory;
use super::input::MeshInput;
use super::laws::laws_of_cells;
use super::lists::{check_fits, read_fits};
use super::load::{LoadCase, read_loads};
use super::material::{MaterialEntries, MaterialEntry};
use super::motion_recipe::MotionRecipe;
use super::output::Output;
use super::reference::ReferenceEntry;
use super::setting::Setting;
use super::source::SceneSource;
use crate::bound::{self, check_count};
use crate::error::{Error, Result};
use crate::file;
use crate::fits::{NamedFit, RESERVED, law_at};
use crate::material::{EnergyMap, Material, MaterialMap};
use crate::mesh::Mesh;
use crate::solve::{Newton, StaticSolver};
use crate::sweep::SweepEntry;
use crate::text::printable;
use std::path::{Path, PathBuf};

/// A mesh, a material, fits, supports and loads, checked as far as possible without reading the mesh.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Kept for the lines of what turns out to be wrong later.
    pub(super) source: SceneSource,
    pub(super) title: String,
    pub(super) mesh: MeshInput,
    pub(super) material: MaterialEntries,
    pub(super) fits: Vec<NamedFit>,
    pub(super) supports: Vec<Hold>,
    pub(super) loads: Vec<LoadCase>,
    pub(super) newton: Newton,
    pub(super) solver: StaticSolver,
    pub(super) reference: Option<ReferenceEntry>,
    pub(super) gauge: Option<Gauge>,
    pub(super) motion: Option<MotionRecipe>,
    pub(super) output: Output,
    pub(super) calibration: Option<CalibrationRecipe>,
    pub(super) sweep: Option<SweepEntry>,
}

impl Scene {
    /// Reads and checks a scene file.
    ///
    /// # Errors
    /// The file is wrong. The error names the file and the key, what was expected and what was found.
    pub fn load(path: &Path) -> Result<Scene> {
        Scene::load_with(path, &[])
    }

    /// Reads and checks a scene with other values of some keys.
    ///
    /// # Errors
    /// Those of [`Scene::load`]; the key of a fault that a setting brings in is `--set` and the key of the scene, without a file.
    pub fn load_with(path: &Path, settings: &[Setting]) -> Result<Scene> {
        Scene::parse_with(&file::read_text(path)?, path, settings)
    }

    /// Checks the text of a scene that is at `path`, to which other files are relative.
    ///
    /// # Errors
    /// Those of [`Scene::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Scene> {
        Scene::parse_with(text, path, &[])
    }

    /// Checks the text of a scene as [`Scene::parse`] does, with other values of some keys.
    ///
    /// # Errors
    /// Those of [`Scene::load_with`].
    pub fn parse_with(text: &str, path: &Path, settings: &[Setting]) -> Result<Scene> {
        Scene::parse_beside(text, path, settings, &InMemory::default())
    }

    /// Checks the text of a scene as [`Scene::parse_with`] does, some of whose files are names of what is in memory.
    ///
    /// # Errors
    /// Those of [`Scene::load_with`].
    pub fn parse_beside(text: &str, path: &Path, settings: &[Setting], memory: &InMemory) -> Result<Scene> {
        let source = SceneSource::new(text, path, settings).beside(memory);
        let alone = || Scene::checked(source.alone()).map(|_| ());
        Scene::checked(source.clone()).map_err(|error| source.explained(error, alone))
    }

    fn checked(source: SceneSource) -> Result<Scene> {
        let (mut entry, path) = (source.entries()?, source.path.clone());
        entry.material.complete()?;
        for (i, fit) in entry.fit.iter().enumerate() {
            fit.check().map_err(|e| e.under(format!("fit[{i}]")))?;
        }
        let mut mesh = entry.mesh;
        mesh.memory = source.memory.clone();
        mesh.states_unit = source.states_unit();
        mesh.check()?;
        if entry.fit.is_empty() && entry.calibrate.is_none() {
            return Err(Error::expected("fit", "at least one [[fit]], or [calibrate]", "none"));
        }
        entry.material.check()?;
        let attached: Vec<String> = entry.material.all.iter().filter_map(|entry| entry.group.clone()).collect();
        if let Some(finer) = entry.reference.as_mut().and_then(|reference| reference.mesh.as_mut()) {
            finer.attached.clone_from(&attached);
            finer.memory = source.memory.clone();
        }
        mesh.attached = attached;
        let fits = read_fits(&entry.fit, path.parent().unwrap_or(Path::new("")))?;
        let fix = |(i, fix): (usize, FixEntry)| fix.check().map_err(|e| e.under(format!("fix[{i}]")));
        let supports = entry.fix.into_iter().enumerate().map(fix).collect::<Result<_>>()?;
        let loads = read_loads(entry.load)?;
        if let (Some(i), false) = (loads.iter().position(LoadCase::is_acceleration), entry.material.has_density()) {
            let found = format!("none, beside load[{i}].gravity");
            return Err(Error::expected(
                "material.density",
                "a number of kg/m³, by which gravity is multiplied",
                found,
            ));
        }
        if entry.newton.is_some() && entry.material.first().law.is_none() {
            return Err(Error::at("newton", "belongs to a material with a \"law\", found one without"));
        }
        let newton = entry.newton.map_or(Ok(Newton::default()), |e| e.check().map_err(|e| e.under("newton")))?;
        if entry.solver.is_some() && entry.material.first().law.is_some() {
            return Err(Error::at("solver", "belongs to small deformation, found a material with a \"law\""));
        }
        let solver = entry.solver.map_or(Ok(StaticSolver::default()), |e| e.check().map_err(|e| e.under("solver")))?;
        let motion = entry.motion.map(|e| e.check().map_err(|e| e.under("motion"))).transpose()?;
        if motion.as_ref().is_some_and(MotionRecipe::needs_masses) && !entry.material.has_density() {
            return Err(Error::expected("material.density", "a number of kg/m³, for [motion] moves masses", "none"));
        }
        if let Some(motion) = &motion {
            motion.check_relaxing(&entry.material).map_err(|e| e.under("motion"))?;
        }
        if entry.output.frequencies > 0 && !entry.material.has_density() {
            return Err(Error::expected("output.frequencies", "a density in [material]", "none"));
        }
        if let Some(moduli) = &entry.output.dynamic_moduli {
            let key = "output.dynamic_moduli";
            moduli.frequencies().map_err(|e| e.under(key))?;
            let is_damped = motion.as_ref().is_some_and(|motion| motion.damping.is_there());
            if !is_damped && entry.material.all.iter().all(|entry| entry.relaxation.is_none()) {
                let expected = "a material with \"relaxation\", or [motion] with \"damping\"";
                return Err(Error::expected(key, expected, "nothing that loses energy"));
            }
        }
        if entry.output.frequencies > 0 && entry.material.first().rest == RestShape::Flat {
            let expected =
                "0 of a sheet with rest = \"flat\", which is bent in the mesh: it vibrates about another shape";
            return Err(Error::expected("output.frequencies", expected, entry.output.frequencies));
        }
        check_count("output.frequencies", entry.output.frequencies as u64, 0, bound::MODES)?;
        check_fits(&fits, &entry.material, &loads)?;
        if let Some(i) = loads.iter().position(|load| RESERVED.contains(&load.name.as_str())) {
            let expected = format!("a name other than {}", RESERVED.join(", "));
            return Err(Error::expected(format!("load[{i}].name"), expected, format!("\"{}\"", loads[i].name)));
        }
        if let Some(reference) = &entry.reference {
            reference.check().map_err(|e| e.under("reference"))?;
        }
        if let Some(sweep) = &entry.sweep {
            sweep.check().map_err(|e| e.under("sweep"))?;
        }
        let calibration = entry.calibrate.map(|e| e.check().map_err(|e| e.under("calibrate"))).transpose()?;
        let stem = path.file_stem().map(|s| printable(&s.to_string_lossy()).into_owned()).unwrap_or_default();
        Ok(Scene {
            source,
            title: entry.title.unwrap_or(stem),
            mesh,
            material: entry.material,
            fits,
            supports,
            loads,
            newton,
            solver,
            reference: entry.reference,
            gauge: entry.gauge.map(|gauge| gauge.check().map_err(|e| e.under("gauge"))).transpose()?,
            motion,
            output: entry.output,
            calibration,
            sweep: entry.sweep,
        })
    }

    /// The path of the scene file, to which other files are relative.
    pub fn path(&self) -> &Path {
        &self.source.path
    }

    /// What is given in place of values of the file, in the order in which it was given.
    pub fn settings(&self) -> &[Setting] {
        &self.source.settings
    }

    /// The title, or the stem of the file name.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The source of the mesh.
    pub fn mesh(&self) -> &MeshInput {
        &self.mesh
    }

    /// The fits, in the order of the file.
    pub fn fits(&self) -> &[NamedFit] {
        &self.fits
    }

    /// What is held.
    pub fn supports(&self) -> &[Hold] {
        &self.supports
    }

    /// The loads, in the order of the file.
    pub fn loads(&self) -> &[LoadCase] {
        &self.loads
    }

    /// How loads are applied if the material has a law.
    pub fn newton(&self) -> Newton {
        self.newton
    }

    /// How the linear equations of the loads are solved.
    pub fn solver(&self) -> StaticSolver {
        self.solver
    }

    /// The finer body with which the networks are compared, if there is one.
    pub fn reference(&self) -> Option<&ReferenceEntry> {
        self.reference.as_ref()
    }

    /// Where the modulus and the ratio of a specimen are measured, if the scene says so.
    pub fn gauge(&self) -> Option<&Gauge> {
        self.gauge.as_ref()
    }

    /// The motion of the body, if there is one.
    pub fn motion(&self) -> Option<&MotionRecipe> {
        self.motion.as_ref()
    }

    /// What is written and computed besides the table.
    pub fn output(&self) -> &Output {
        &self.output
    }

    /// Gives access to what is written and computed besides the table, so that it can be changed.
    pub fn output_mut(&mut self) -> &mut Output {
        &mut self.output
    }

    /// Which moduli are found from measurements, if the scene says so.
    pub fn calibration(&self) -> Option<&CalibrationRecipe> {
        self.calibration.as_ref()
    }

    /// Which studies a sweep makes of the scene, if it says so.
    pub fn sweep(&self) -> Option<&SweepEntry> {
        self.sweep.as_ref()
    }

    /// Reads or generates the mesh.
    ///
    /// # Errors
    /// The file or an element is wrong, or a cell has no volume; or a mesh that is to bend is no surface of triangles.
    pub fn build_mesh(&self) -> Result<Mesh> {
        self.bent(self.unbent()?)
    }

    /// Reads or generates the mesh with halved cells, whose first points are those of [`Self::build_mesh`].
    ///
    /// # Errors
    /// The mesh is wrong as in [`Self::build_mesh`], or a cell cannot be divided.
    pub fn build_refined(&self) -> Result<Mesh> {
        self.bent(self.unbent()?.refined()?)
    }

    /// The mesh of the file or the generated one, without the directors by which sheets and rods bend.
    fn unbent(&self) -> Result<Mesh> {
        self.mesh.build(self.path(), &|mesh| self.choose(mesh)).map_err(|e| self.with_line(e))
    }

    /// The names of the regions of a material map of this scene, in their order.
    pub fn region_names(&self, map: &MaterialMap) -> Vec<String> {
        match map.regions() {
            [only] if only.is_empty() => vec![self.material.first().name.clone().unwrap_or_else(|| "body".into())],
            regions => regions.to_vec(),
        }
    }

    /// The materials of the meshed body, with their density if the scene gives one.
    ///
    /// # Errors
    /// A cell is in two regions or in none, a region is empty or unknown, data are wrong or do not cover the mesh, or a value is out of
    /// its range; or a surface in space has no thickness.
    pub fn material_of(&self, mesh: &Mesh) -> Result<MaterialMap> {
        let folder = self.path().parent().unwrap_or(Path::new(""));
        let own = self.mesh.file.as_ref().map(|file| (folder.join(file), self.mesh.scale));
        self.material.on(mesh, folder, own, &self.source.memory).map_err(|e| self.placed(e))
    }

    /// The material of a body of this dimension, one metre thick if the scene gives no thickness.
    ///
    /// # Errors
    /// A constant is out of range, bodies of this dimension have no plane state, or the material differs from cell to cell.
    pub fn material(&self, dimension: usize) -> Result<Material> {
        let material = self.material.constants().and_then(|constants| constants.of_dimension(dimension));
        material.map_err(|e| self.at(&self.material.key(0), e))
    }

    /// The name of the material's law, if the scene gives one; deformations are large then.
    pub fn law(&self) -> Option<&str> {
        self.material.first().law.as_deref()
    }

    /// The energies of the laws of all cells, if there are laws.
    ///
    /// # Errors
    /// There is no such law, its file is wrong, or a parameter or a direction of fibres is.
    pub fn laws(&self, mesh: &Mesh, material: &MaterialMap) -> Result<Option<EnergyMap>> {
        let folder = self.path().parent().unwrap_or(Path::new(""));
        laws_of_cells(&self.material, mesh, material, (folder, &self.source.memory)).map_err(|e| self.placed(e))
    }

    /// The scene file, and the files that it names: of the mesh, of elements, laws and data.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let folder = self.path().parent().unwrap_or(Path::new(""));
        let mut files = vec![self.path().to_path_buf()];
        files.extend(self.mesh.files(folder));
        files.extend(self.reference.iter().flat_map(|reference| reference.files(folder)));
        let laws = self.material.all.iter().filter_map(|entry| entry.law.as_deref());
        files.extend(laws.map(|law| PathBuf::from(law_at(law, folder))));
        let measured = self.loads.iter().filter_map(|load| load.measured.as_ref());
        files.extend(measured.map(|entry| folder.join(&entry.file)));
        let sampled = self.fits.iter().filter_map(|fit| fit.recipe.sampled());
        files.extend(sampled.flat_map(|recipe| recipe.files()));
        let memory = &self.source.memory;
        let data = self.material.all.iter().flat_map(MaterialEntry::files).filter(|file| !memory.has(file));
        files.extend(data.map(|file| folder.join(file)));
        files
    }

    /// A sentence about the defaults on which the results depend, if there are any.
    pub fn assumption(&self, mesh: &Mesh) -> Option<String> {
        self.material.assumption(mesh).or_else(|| self.mesh.unit_assumption(mesh))
    }

    /// Whether the scene gives a density.
    pub fn has_density(&self) -> bool {
        self.material.has_density()
    }

    /// The error with the scene and the line of one of its entries.
    pub fn at(&self, key: &str, error: Error) -> Error {
        self.placed(error.under(key))
    }

    /// The error with the scene and the line, if it names no file.
    pub fn placed(&self, error: Error) -> Error {
        self.source.placed(error)
    }

    /// The error with the line in the scene.
    pub fn with_line(&self, error: Error) -> Error {
        self.source.with_line(error)
    }
}
