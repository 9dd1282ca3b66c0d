//! From the keys of a set of shapes to its settings.

use super::origin::ShapeOrigin;
use super::shapes_entry::{HeldOutEntry, PathsEntry, ShapesEntry};
use super::values::{flat, number, pair, shown};
use crate::bound;
use crate::choice::choice;
use crate::error::{Error, Result};
use crate::file;
use crate::fit::{DeformationFamily, Design, Sampling, Source};
use crate::mesh::NamedState;
use crate::range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl ShapesEntry {
    /// The settings, with those of `usual` for keys that are not given; files are relative to `folder`. Only sets of a list have a weight.
    ///
    /// # Errors
    /// A key has a wrong value, or does not go with another.
    pub(super) fn check(self, folder: &Path, usual: &Sampling, is_list: bool) -> Result<(Sampling, ShapeOrigin)> {
        let (weight, held_out) = (self.weight, self.held_out.clone());
        if weight.is_some() && !is_list {
            return Err(Error::at("weight", "belongs to one of several sets of shapes"));
        }
        let held_out_usually = usual.held_out;
        let (mut sampling, mut origin) = self.check_own(folder, usual.clone())?;
        sampling.weight = weight.unwrap_or(sampling.weight);
        match held_out {
            None => {}
            Some(HeldOutEntry::Count(count)) => {
                sampling.held_out = count;
                origin.held_out = Some(count);
            }
            Some(HeldOutEntry::Shapes(entry)) => {
                let usual = Sampling { shapes: held_out_usually, ..sampling.clone() };
                let others = entry.check_others(folder, usual, &origin);
                let (others, of_others) = others.map_err(|e| e.placed(|e| e.under("held_out")))?;
                sampling.others = Some(Box::new(others));
                origin.others = Some(Box::new(of_others));
            }
        }
        sampling.check_numbers().map_err(counted)?;
        Ok((sampling, origin))
    }

    /// The shapes that are held out in place of those of a set.
    fn check_others(self, folder: &Path, mut usual: Sampling, origin: &ShapeOrigin) -> Result<(Sampling, ShapeOrigin)> {
        for (key, is_given) in [("held_out", self.held_out.is_some()), ("weight", self.weight.is_some())] {
            if is_given {
                return Err(Error::at(key, "belongs to the shapes of the fit, not to those that are held out"));
            }
        }
        let is_own = self.sources().next().is_some();
        if !is_own && (origin.is_listed || origin.has_states()) {
            let expected = "shapes apart from those of the list that is fitted: \"families\", \"gradients\", \"states\" or \"run\"";
            return Err(Error::new(format!("expected {expected}, found none")));
        }
        usual.weight = 1.0;
        if self.families.is_some() && self.directions.is_none() {
            // Directions are those of the families that have them.
            usual.directions = Vec::new();
        }
        let are_named = origin.are_named;
        let (sampling, mut own) = self.check_own(folder, usual)?;
        own.are_named |= are_named && !is_own;
        Ok((sampling, own))
    }

    /// The names of the keys that say where shapes are from.
    fn sources(&self) -> impl Iterator<Item = &'static str> {
        let loads = self.loads.is_some() && self.run.is_none();
        let given = [
            ("families", self.families.is_some()),
            ("gradients", self.gradients.is_some()),
            ("loads", loads),
            ("states", self.states.is_some()),
            ("run", self.run.is_some()),
        ];
        given.into_iter().filter(|(_, is_given)| *is_given).map(|(key, _)| key)
    }

    fn check_own(self, folder: &Path, mut sampling: Sampling) -> Result<(Sampling, ShapeOrigin)> {
        let sources: Vec<&str> = self.sources().collect();
        if let [first, second, ..] = sources[..] {
            let expected = "expected one of \"families\", \"gradients\", \"loads\", \"states\", \"run\"";
            return Err(Error::new(format!("{expected}, found more: \"{first}\" and \"{second}\"")));
        }
        let is_of_families = sources.first().is_none_or(|source| *source == "families");
        let of_families = [
            ("stretch", self.stretch.is_some()),
            ("directions", self.directions.is_some()),
            ("design", self.design.is_some()),
        ];
        if let Some((key, _)) = of_families.iter().find(|(_, is_given)| *is_given && !is_of_families) {
            return Err(Error::at(*key, "belongs to \"families\": shapes of a list have their own"));
        }
        if self.scale.is_some() && self.states.is_none() {
            return Err(Error::at("scale", "belongs to the files of \"states\""));
        }
        let mut origin = ShapeOrigin { count: self.count, scale: self.scale, ..ShapeOrigin::default() };
        if let Some(names) = &self.families {
            let families: Result<Vec<DeformationFamily>> =
                names.iter().map(|name| DeformationFamily::named(name)).collect();
            sampling.source = Source::Families(families.map_err(|e| e.under("families"))?);
            origin.are_named = true;
        }
        sampling.directions = self.directions.unwrap_or(sampling.directions);
        sampling.design = choice("design", self.design.as_deref(), sampling.design, Design::named)?;
        if let Some(given) = &self.gradients {
            let (numbers, path) = gradients(folder, given)?;
            // Each row is used once, whatever their number.
            let most = numbers.len().clamp(1, bound::SHAPES as usize);
            (sampling.shapes, sampling.held_out) = (most, most);
            sampling.source = Source::Gradients(Arc::new(numbers));
            (origin.gradients, origin.is_listed) = (path, true);
        }
        if let Some(loads) = self.loads {
            if loads.is_empty() {
                return Err(Error::expected("loads", "names of loads of the scene", "none"));
            }
            origin.loads = loads;
        }
        origin.run = self.run.map(|run| folder.join(run));
        if let Some(states) = &self.states {
            origin.states = paths(folder, states)?;
            range::positive("scale", self.scale.unwrap_or(1.0), "metres per unit of the files")?;
        }
        sampling.shapes = self.count.unwrap_or(sampling.shapes);
        sampling.perturbation = self.perturbation.unwrap_or(sampling.perturbation);
        sampling.seed = self.seed.unwrap_or(sampling.seed);
        if let Some(value) = &self.stretch {
            let symmetric = number(value).map(|s| [-s, s]);
            let expected = "a share such as 0.3, or a range such as [-0.1, 0.4]";
            sampling.stretch =
                symmetric.or_else(|| pair(value)).ok_or_else(|| Error::expected("stretch", expected, shown(value)))?;
        }
        sampling.check_numbers().map_err(counted)?;
        Ok((sampling, origin))
    }
}

/// The numbers of a file, with its path, or of lists of numbers.
fn gradients(folder: &Path, given: &toml::Value) -> Result<(Vec<f64>, Option<PathBuf>)> {
    match given {
        toml::Value::String(path) => {
            let path = folder.join(path);
            Ok((ShapeOrigin::numbers(&path)?, Some(path)))
        }
        toml::Value::Array(_) => {
            let mut numbers = Vec::new();
            flat("gradients", given, &mut numbers)?;
            Ok((numbers, None))
        }
        other => Err(Error::expected("gradients", "the path of a file, or a list of gradients", shown(other))),
    }
}

fn paths(folder: &Path, given: &PathsEntry) -> Result<Vec<PathBuf>> {
    let expected = "files that end in .vtu, .vtk, .pvd or .csv";
    let path = |path: &PathBuf| match NamedState::ENDINGS.contains(&file::ending(path).as_str()) {
        true => Ok(folder.join(path)),
        false => Err(Error::expected("states", expected, format!("\"{}\"", path.display()))),
    };
    if given.0.is_empty() {
        return Err(Error::expected("states", expected, "none"));
    }
    given.0.iter().map(path).collect()
}

/// An error of the settings of shapes with the key that the number of shapes has in scenes.
fn counted(error: Error) -> Error {
    match error.key() {
        Some("shapes") => error.at_key("count"),
        Some("held_out.shapes") => error.at_key("held_out.count"),
        _ => error,
    }
}

/// The keys of a set of shapes that depend on the cells.
const KEYS: [&str; 5] = ["families", "gradients", "directions", "states", "held_out"];

/// An error of the settings of shapes that depends on the cells, with the path of its key.
pub(super) fn of_shapes(error: Error) -> Error {
    let is_of_shapes = error
        .key()
        .is_some_and(|key| key.starts_with('[') || KEYS.contains(&key.split(['.', '[']).next().unwrap_or_default()));
    if is_of_shapes { error.under("shapes") } else { error }
}
