//! Arguments that are scenes, and what is set beside them.

use super::not_a_scene::explained;
use clap::Args;
use springfit_foundation::error::{Error, Result};
use springfit_studies::study::{Scene, Setting, Sweep};
use std::path::Path;

/// The option `--set` of a command that reads a scene.
#[derive(Args)]
pub struct Settings {
    /// A value for a key of the scene in place of the file's, such as material.poisson=0.45 or "load[0].traction=[0, 0, 50]"; may be
    /// repeated. Entries of lists count from 0, and the number after the last adds one. Paths are relative to the scene
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
}

impl Settings {
    /// The scene with what is set.
    ///
    /// # Errors
    /// A setting is no `KEY=VALUE`; the file or a setting is wrong.
    pub fn scene(&self, path: &Path) -> Result<Scene> {
        Scene::load_with(path, &self.read()?).map_err(|error| explained(path, error))
    }

    /// The sweep of the scene with what is set.
    ///
    /// # Errors
    /// As there; or the scene has no sweep.
    pub fn sweep(&self, path: &Path) -> Result<Sweep> {
        Sweep::load(path, &self.read()?).map_err(|error| explained(path, error))
    }

    /// The reference of a convergence study, which has the material, supports and loads of the scene and a mesh of its own.
    ///
    /// # Errors
    /// As there.
    pub fn reference(&self, path: &Path) -> Result<Scene> {
        let mut settings = self.read()?;
        settings.retain(|setting| !["mesh", "fit", "output"].contains(&setting.first()));
        Scene::load_with(path, &settings).map_err(|error| explained(path, error))
    }

    /// That nothing is set where there is no scene, but `what`.
    ///
    /// # Errors
    /// Something is set.
    pub fn expect_none(&self, what: &str) -> Result<()> {
        match self.set.first() {
            None => Ok(()),
            Some(set) => Err(Error::at("--set", format!("belongs to a scene, found {set} with {what}"))),
        }
    }

    /// What is set.
    ///
    /// # Errors
    /// A setting is no `KEY=VALUE`.
    pub fn read(&self) -> Result<Vec<Setting>> {
        self.set.iter().map(|text| Setting::parse(text)).collect()
    }
}

/// Whether a file is a scene: it has a `mesh`, where an element has nodes. A file that cannot be read counts as an element.
pub fn is_scene(path: &Path) -> bool {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let begins = |line: &str| {
        let rest = line.trim_start().trim_start_matches('[').strip_prefix("mesh");
        rest.is_some_and(|rest| rest.trim_start().starts_with([']', '.', '=']))
    };
    text.lines().any(begins)
}
