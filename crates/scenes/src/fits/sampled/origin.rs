//! Where the shapes of a set are from, before the mesh is known.

use crate::body::LargeBody;
use crate::error::{Error, ErrorKind, Result};
use crate::file;
use crate::mesh::{Mesh, NamedState};
use crate::model::displaced;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The displacements of the finite elements of a run under its loads.
const GRID: &str = "mesh.vtu";
/// How the names of their arrays begin and end, around the name of the load.
const ARRAY: [&str; 2] = ["u fem ", " (m)"];
/// The pictures of the motion of the finite elements of a run.
const MOTION: &str = "motion-finite-elements.pvd";

/// Where the shapes of a set are from, if they are not of families, and what of them is asked for.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ShapeOrigin {
    /// The families are named; otherwise they are those that the dimension of the body has.
    pub are_named: bool,
    /// The loads of the scene, or of the run, under which the shapes are those of the finite elements.
    pub loads: Vec<String>,
    /// The folder of the run.
    pub run: Option<PathBuf>,
    /// The files of states.
    pub states: Vec<PathBuf>,
    /// The length of a unit of these files, m.
    pub scale: Option<f64>,
    /// The file from which deformation gradients were read.
    pub gradients: Option<PathBuf>,
    /// Whether there are deformation gradients.
    pub is_listed: bool,
    /// How many shapes are to be fitted, if the scene says so.
    pub count: Option<usize>,
    /// How many are to be held out, if the scene says so.
    pub held_out: Option<usize>,
    /// Where those are from that are held out in place of the set's own.
    pub others: Option<Box<ShapeOrigin>>,
}

/// Positions of all points of a mesh, `[states][points × dimension]`, m.
pub type States = Arc<Vec<Vec<f64>>>;

/// The states of each set, and of the shapes that are held out in their place.
#[derive(Debug, Clone, Default)]
pub struct SetStates(pub(super) Vec<[Option<States>; 2]>);

impl ShapeOrigin {
    /// The origin and that of what is held out.
    pub fn both(&self) -> impl Iterator<Item = &ShapeOrigin> {
        std::iter::once(self).chain(self.others.as_deref())
    }

    /// Whether the shapes are states of the body.
    pub fn has_states(&self) -> bool {
        !self.loads.is_empty() || self.run.is_some() || !self.states.is_empty()
    }

    /// Whether the shapes are those under loads of the scene.
    pub fn is_of_scene(&self) -> bool {
        !self.loads.is_empty() && self.run.is_none()
    }

    /// The files that it names.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> {
        let run = self.run.iter().map(|run| run.join(GRID));
        self.gradients.iter().cloned().chain(self.states.iter().cloned()).chain(run)
    }

    /// The word for it in reports.
    pub fn word(&self) -> &'static str {
        match (self.run.is_some(), self.states.is_empty(), self.loads.is_empty(), self.is_listed) {
            (true, ..) => "run",
            (false, false, ..) => "states",
            (false, true, false, _) => "loads",
            (false, true, true, true) => "gradients",
            (false, true, true, false) => "families",
        }
    }

    /// The states of the body; `None` if the shapes are no states.
    ///
    /// # Errors
    /// The finite elements reach no part of a load, a function has no loads, or a file is wrong or of another mesh.
    pub fn read(&self, mesh: &Mesh, large: Option<&LargeBody>) -> Result<Option<States>> {
        if self.is_of_scene() {
            let expected = "a law as an expression: a function is not solved under loads";
            let missing = || Error::expected("loads", expected, "a function").of_kind(ErrorKind::Unsupported);
            return Ok(Some(Arc::new(large.ok_or_else(missing)?.states(mesh, &self.loads)?)));
        }
        let mut found = match &self.run {
            Some(run) => self.read_run(run, mesh)?,
            None => Vec::new(),
        };
        for path in &self.states {
            found.extend(NamedState::read(path, mesh, self.scale.unwrap_or(1.0), &|_| true)?);
        }
        let place = |state: NamedState| displaced(&mesh.points, &state.displacements);
        Ok(self.has_states().then(|| Arc::new(found.into_iter().map(place).collect())))
    }

    fn read_run(&self, run: &Path, mesh: &Mesh) -> Result<Vec<NamedState>> {
        let (grid, motion) = (run.join(GRID), run.join(MOTION));
        if !run.is_dir() {
            return Err(Error::expected("run", "the folder of a run", run.display()));
        }
        if !grid.is_file() {
            let expected = format!("{GRID} in the folder of a run, which [output] vtu = true writes");
            return Err(Error::expected("run", expected, format!("none in {}", run.display())));
        }
        let load = |name: &str| Some(name.strip_prefix(ARRAY[0])?.strip_suffix(ARRAY[1])?.to_string());
        let is_wanted = |name: &str| load(name).is_some_and(|load| self.loads.is_empty() || self.loads.contains(&load));
        // Files of springfit are in metres.
        let mut found = NamedState::read(&grid, mesh, 1.0, &is_wanted)?;
        let is_found = |wanted: &&String| found.iter().any(|state| load(&state.name).as_ref() == Some(*wanted));
        if let Some(missing) = self.loads.iter().find(|wanted| !is_found(wanted)) {
            let known: Vec<String> = found.iter().filter_map(|state| load(&state.name)).collect();
            return Err(Error::expected(
                "loads",
                format!("loads of the run ({})", known.join(", ")),
                format!("\"{missing}\""),
            ));
        }
        if self.loads.is_empty() && motion.is_file() {
            found.extend(NamedState::read(&motion, mesh, 1.0, &|_| true)?);
        }
        Ok(found)
    }

    /// Reads numbers of a file of deformation gradients.
    ///
    /// # Errors
    /// It cannot be read, or has a word that is no number.
    pub fn numbers(path: &Path) -> Result<Vec<f64>> {
        super::values::numbers_of(&file::read_text(path)?).map_err(|e| e.in_file(path))
    }
}
