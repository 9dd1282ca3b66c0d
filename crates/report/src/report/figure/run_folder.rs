//! What a run wrote, read again.

use crate::error::{Error, Result};
use crate::file::finish_edition;
use crate::report::json::{OLDEST, Report, VERSION};
use crate::report::network::{NetworkRecord, read_network};
use std::path::{Path, PathBuf};

/// The folder of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunFolder {
    path: PathBuf,
}

impl RunFolder {
    /// The folder at `path`, or that of the report at `path`.
    pub fn at(path: &Path) -> RunFolder {
        let is_report = path.extension().is_some_and(|ending| ending == "json");
        let folder = if is_report { path.parent().unwrap_or(Path::new("")) } else { path };
        RunFolder { path: folder.to_path_buf() }
    }

    /// The report of the run.
    ///
    /// # Errors
    /// The folder has no report, or the report has another version.
    pub fn report(&self) -> Result<Report> {
        let path = self.file("report.json");
        // A run may have ended while its files took their places.
        finish_edition(&self.path)?;
        let text = std::fs::read_to_string(&path).map_err(|e| {
            let advice = "the folder of a run has one unless [output] report is false";
            Error::new(format!("cannot be read: {e}; {advice}")).in_file(&path)
        })?;
        let value: serde_json::Value =
            serde_json::from_str(&text).map_err(|e| Error::new(format!("is not JSON: {e}")).in_file(&path))?;
        let version = value.get("version").and_then(serde_json::Value::as_u64);
        if !version.is_some_and(|version| (OLDEST.into()..=VERSION.into()).contains(&version)) {
            let found = version.map_or("none".into(), |version| version.to_string());
            let error =
                Error::expected("version", format!("{OLDEST} to {VERSION}, those that this program reads"), found);
            return Err(error.followed_by("; run the scene again").in_file(&path));
        }
        serde_path_to_error::deserialize(value)
            .map_err(|e| Error::at(e.path().to_string(), format!("{}", e.inner())).in_file(&path))
    }

    /// A file of the folder.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The place of the fit with this name, or of the first.
    pub(super) fn place(report: &Report, fit: Option<&str>) -> Result<usize> {
        let names = || report.fits.iter().map(|fit| fit.name.as_str());
        let Some(name) = fit else {
            return match report.fits.is_empty() {
                false => Ok(0),
                true => Err(Error::new("the run has no fit, so there is nothing to draw")),
            };
        };
        let known = || names().collect::<Vec<_>>().join(", ");
        let place = names().position(|known| known == name);
        place.ok_or_else(|| Error::expected("--of", format!("a fit of the run: {}", known()), name))
    }

    /// A file that the run wrote, which `has` says the content of; `advice` says when a run writes it.
    ///
    /// # Errors
    /// It is not there, or it is not one of the run whose report this is.
    pub(super) fn own_file(&self, report: &Report, name: &str, has: &str, advice: &str) -> Result<PathBuf> {
        let path = self.file(name);
        // Reports of former versions list no files.
        let is_own = report.files.is_empty() || report.files.iter().any(|file| file == name);
        match (path.is_file(), is_own) {
            (true, true) => Ok(path),
            (true, false) => {
                let why = format!("has {has} of another run: the run of report.json did not write it; {advice}");
                Err(Error::new(why).in_file(&path))
            }
            (false, _) => Err(Error::new(format!("is not there, and has {has}; {advice}")).in_file(&path)),
        }
    }

    /// The network of the fit with this name, or of the first.
    ///
    /// # Errors
    /// The run has no such fit, or its network was not written.
    pub fn network(&self, fit: Option<&str>) -> Result<NetworkRecord> {
        let report = self.report()?;
        let place = RunFolder::place(&report, fit)?;
        let stems = crate::report::names::file_stems(report.fits.iter().map(|fit| fit.name.as_str()));
        let advice = "a run writes it unless [output] json of the scene is false";
        read_network(&self.own_file(&report, &format!("{}.json", stems[place]), "the network", advice)?)
    }
}
