//! The text of a scene with what is given beside it, and the place of a fault in them.

use super::entry::SceneFile;
use super::in_memory::InMemory;
use super::key_paths::led;
use super::setting::Setting;
use crate::error::{Error, Result};
use crate::file;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::Table;

/// A scene file, and settings in place of values of it.
#[derive(Debug, Clone)]
pub struct SceneSource {
    pub path: PathBuf,
    text: Arc<str>,
    pub settings: Vec<Setting>,
    /// What names of files mean before files.
    pub memory: InMemory,
}

impl SceneSource {
    pub fn new(text: &str, path: &Path, settings: &[Setting]) -> SceneSource {
        let memory = InMemory::default();
        SceneSource { path: path.to_path_buf(), text: text.into(), settings: settings.to_vec(), memory }
    }

    /// With what is in memory.
    pub fn beside(self, memory: &InMemory) -> SceneSource {
        SceneSource { memory: memory.clone(), ..self }
    }

    /// The file without the settings.
    pub fn alone(&self) -> SceneSource {
        SceneSource { settings: Vec::new(), ..self.clone() }
    }

    /// The entries of the file, with those of the settings.
    ///
    /// # Errors
    /// The text is not TOML, or a key is unknown, missing or of the wrong type.
    pub fn entries(&self) -> Result<SceneFile> {
        if self.settings.is_empty() {
            return file::parse_toml(&self.text);
        }
        let mut table = file::parse_toml::<Table>(&self.text)?;
        for setting in &self.settings {
            setting.apply(&mut table).map_err(|e| of_option(setting.key(), &e))?;
        }
        file::parse_table(table)
    }

    /// Whether the scene states the unit of its mesh as a text.
    pub fn states_unit(&self) -> bool {
        let is_text =
            |table: Table| table.get("mesh").and_then(|mesh| mesh.get("scale")).is_some_and(|scale| scale.is_str());
        match self.settings.iter().rev().find(|setting| setting.key() == "mesh.scale") {
            Some(setting) => setting.value().is_string(),
            None => file::parse_toml(&self.text).is_ok_and(is_text),
        }
    }

    /// Names the setting that brings a fault in, or the file and the line. `alone` is whether the file is right without settings.
    pub fn explained(&self, error: Error, alone: impl FnOnce() -> Result<()>) -> Error {
        if self.settings.is_empty() || error.file().is_some() || self.of_setting(&error).is_some() {
            return self.placed(error);
        }
        let key = error.key().unwrap_or_default();
        if key.starts_with("--") {
            return error;
        }
        match (alone(), self.settings.iter().rev().find(|setting| setting.is_in(key))) {
            (Err(own), _) => self.placed(own),
            (Ok(()), Some(setting)) => of_option(setting.key(), &error),
            (Ok(()), None) => {
                let given: Vec<String> = self.settings.iter().map(|setting| format!("--set {setting}")).collect();
                self.placed(error.followed_by(format!(" (with {})", given.join(" "))))
            }
        }
    }

    /// Names the scene and the line, or the setting, in an error that names no file.
    pub fn placed(&self, error: Error) -> Error {
        let in_file = |error: Error| {
            let key = error.key().unwrap_or_default().to_string();
            let is_alone = error.problem().contains("did you mean");
            let error = if is_alone { error } else { led(error, &key) };
            file::on_line_of_key(error, &self.text).in_file(&self.path)
        };
        error.placed(|error| self.of_setting(&error).unwrap_or_else(|| in_file(error)))
    }

    /// Names the line, or the setting, in an error about this scene.
    pub fn with_line(&self, error: Error) -> Error {
        if error.line().is_some() || error.file() != Some(&self.path) {
            return error;
        }
        let line = error.key().and_then(|key| file::line_of_key(&self.text, key));
        self.of_setting(&error).unwrap_or_else(|| line.into_iter().fold(error, Error::on_line))
    }

    /// The error as one of the option, if a setting has its key.
    fn of_setting(&self, error: &Error) -> Option<Error> {
        let key = error.key()?;
        self.settings.iter().any(|setting| setting.holds(key)).then(|| of_option(key, error))
    }
}

/// The fault as one of the option, which has no file.
fn of_option(key: &str, error: &Error) -> Error {
    let error = led(error.clone(), key);
    Error::at(format!("--set {key}"), error.problem()).of_kind(error.kind())
}
