//! The studies of a sweep, each a scene with other values of some keys.

use crate::error::{Error, Result};
use crate::file::{self, Sum};
use crate::order::distinct;
use crate::text::printable;
use serde_json::Value;
use springfit_scenes::{InMemory, Scene, Setting, SweepEntry};
use std::collections::{BTreeMap, HashMap};
use std::hash::Hasher;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// A scene, and the values that its keys take in each study.
#[derive(Debug)]
pub struct Sweep {
    text: String,
    path: PathBuf,
    /// What names of files in the scene mean before files.
    memory: InMemory,
    title: String,
    /// Those beside the studies' own.
    settings: Vec<Setting>,
    keys: Vec<String>,
    studies: Vec<Study>,
    /// The sums of files that studies read, by their paths.
    sums: Mutex<HashMap<PathBuf, Sum>>,
}

/// One study: what is set in the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// In the order of `[sweep]`.
    pub settings: Vec<Setting>,
}

impl Study {
    /// The values by their keys.
    pub fn values(&self) -> BTreeMap<String, Value> {
        self.settings.iter().map(|setting| (setting.key().to_string(), setting.value())).collect()
    }
}

impl Sweep {
    /// The sweep of a scene file that has `[sweep]`, with other values of some keys.
    ///
    /// # Errors
    /// The scene or its `[sweep]` is wrong, or it has none; the scene is wrong in every study.
    pub fn load(path: &Path, settings: &[Setting]) -> Result<Sweep> {
        Sweep::parse(&file::read_text(path)?, path, settings, &InMemory::default())
    }

    /// Reads the sweep as [`Sweep::load`] does, from the text of a scene that is at `path`, to which other files are relative, unless their names
    /// are of what is in memory; those tell one content from another.
    ///
    /// # Errors
    /// As there.
    pub fn parse(text: &str, path: &Path, settings: &[Setting], memory: &InMemory) -> Result<Sweep> {
        let scene = Scene::parse_beside(text, path, settings, memory)?;
        let Some(entry) = scene.sweep() else {
            let expected = "a table [sweep] whose \"over\" gives keys of the scene and their values";
            return Err(scene.placed(Error::expected("sweep", expected, "none")));
        };
        let studies = studies_of(entry).map_err(|e| scene.at("sweep", e))?;
        let sweep = Sweep::of_studies(text, path, settings, studies);
        let sweep = Sweep { title: scene.title().into(), memory: memory.clone(), ..sweep };
        // A fault in every study is one of the sweep.
        let mut faults = sweep.studies.iter().map(|study| sweep.scene(study).err());
        match faults.next().flatten() {
            Some(first) if faults.all(|fault| fault.is_some()) => Err(first),
            _ => Ok(sweep),
        }
    }

    /// A sweep of these studies, whatever `[sweep]` says; nothing is checked before they run.
    pub fn of_studies(text: &str, path: &Path, settings: &[Setting], studies: Vec<Study>) -> Sweep {
        let keys = distinct(studies.iter().flat_map(|study| &study.settings).map(Setting::key));
        let others = settings.iter().filter(|setting| setting.first() != "sweep");
        Sweep {
            text: text.into(),
            path: path.into(),
            memory: InMemory::default(),
            title: String::new(),
            settings: others.cloned().collect(),
            keys: keys.into_iter().map(String::from).collect(),
            studies,
            sums: Mutex::default(),
        }
    }

    /// The sweep with what is in memory.
    pub fn beside(self, memory: &InMemory) -> Sweep {
        Sweep { memory: memory.clone(), ..self }
    }

    /// The title of the scene.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The keys that any study sets, in the order of `[sweep]`.
    pub fn keys(&self) -> &[String] {
        &self.keys
    }

    /// The studies in their order.
    pub fn studies(&self) -> &[Study] {
        &self.studies
    }

    /// The scene of a study.
    ///
    /// # Errors
    /// It is wrong with these values; the key is that of the scene.
    pub fn scene(&self, study: &Study) -> Result<Scene> {
        let settings: Vec<Setting> = self.settings.iter().chain(&study.settings).cloned().collect();
        Scene::parse_beside(&self.text, &self.path, &settings, &self.memory).map_err(|error| of_study(error, study))
    }

    /// All that a study depends on, by name with a sum of each: `version 0.1.0; scene 91…; --set 0f…; mesh.vtk 3c…`. Files are those that the scene
    /// names, and are read once.
    pub fn inputs(&self, study: &Study) -> String {
        let sum = |texts: &mut dyn Iterator<Item = String>| {
            let mut sum = Sum::default();
            texts.for_each(|text| sum.write(text.as_bytes()));
            format!("{:016x}", sum.finish())
        };
        let settings = sum(&mut self.settings.iter().map(|setting| format!("\n{setting}")));
        let values = sum(&mut study.values().iter().map(|(key, value)| format!("\n{key}={value}")));
        let scene = sum(&mut std::iter::once(without_sweep(&self.text)));
        let mut parts = vec![
            format!("version {}", env!("CARGO_PKG_VERSION")),
            format!("scene {scene}"),
            format!("--set {settings}"),
            format!("values {values}"),
        ];
        // The scene file itself has been taken without its sweep.
        let files = self.scene(study).map(|scene| scene.inputs()).unwrap_or_default();
        for path in files.into_iter().skip(1) {
            // Its folder may be named in other ways.
            let name = printable(&path.file_name().unwrap_or_default().to_string_lossy()).replace(';', ",");
            let mut sums = self.sums.lock().unwrap_or_else(PoisonError::into_inner);
            // A file that cannot be read fails in the study.
            let of_file = sums.entry(path).or_insert_with_key(|path| Sum::of_file(path).unwrap_or_default());
            parts.push(format!("{name} {:016x}", of_file.finish()));
        }
        parts.join("; ")
    }
}

fn studies_of(entry: &SweepEntry) -> Result<Vec<Study>> {
    let studies = entry.check()?.studies()?;
    let outside = |setting: &Setting| setting.first() != "sweep";
    if let Some(inside) = studies.iter().flatten().find(|setting| !outside(setting)) {
        return Err(Error::expected("over", "keys outside of [sweep]", format!("\"{}\"", inside.key())));
    }
    Ok(studies.into_iter().map(|settings| Study { settings }).collect())
}

/// The fault of a value names the key of the scene, which no option of the command line has set.
pub(super) fn of_study(error: Error, study: &Study) -> Error {
    let key = error.key().and_then(|key| key.strip_prefix("--set ")).map(String::from);
    match key.filter(|key| study.settings.iter().any(|setting| key.starts_with(setting.key()))) {
        Some(key) => error.at_key(key),
        None => error,
    }
}

/// The scene's entries without `[sweep]`, so that a sweep can be extended: as text of the parsed tables.
fn without_sweep(text: &str) -> String {
    match text.parse::<toml::Table>() {
        Ok(mut table) => {
            table.remove("sweep");
            serde_json::to_string(&table).unwrap_or_default()
        }
        Err(_) => text.into(),
    }
}
