//! Cancelling a long fit, and continuing it from a checkpoint.

use crate::error::{Error, Result};
use crate::file::{self, Sum};
use crate::model::Network;
use crate::whole::{Snapshot, Target, Wanted};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::hash::Hasher;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How a run can be cancelled and continued.
#[derive(Debug, Default)]
pub struct Controls {
    /// Set from outside: whole-object fits end after their current step and keep the best point so far.
    pub cancelled: AtomicBool,
    /// The file to which whole-object fits save their state every few seconds and at their end, and from which they
    /// continue if it exists.
    pub checkpoint: Option<PathBuf>,
    /// Whether work that will take more than ten seconds is announced with an estimate.
    pub announce: bool,
}

/// The states of the whole-object fits of a scene, on disk.
#[derive(Debug, Serialize, Deserialize)]
struct Checkpoint {
    /// [`FORMAT`].
    format: String,
    /// [`VERSION`].
    version: u32,
    fits: BTreeMap<String, SavedFit>,
}

#[derive(Debug, Serialize, Deserialize)]
struct SavedFit {
    identity: Identity,
    snapshot: Snapshot,
}

const FORMAT: &str = "springfit checkpoint";
/// It changes with the meaning of a key, of the file or of a snapshot.
const VERSION: u32 = 2;

impl Default for Checkpoint {
    fn default() -> Checkpoint {
        Checkpoint { format: FORMAT.into(), version: VERSION, fits: BTreeMap::new() }
    }
}

/// The time between two writes of a checkpoint: a crash loses no more than this.
const INTERVAL: Duration = Duration::from_secs(5);

/// The state of one fit, in memory and on disk.
pub(super) struct Saved<'a> {
    controls: &'a Controls,
    name: &'a str,
    identity: Identity,
    last: Instant,
}

impl Controls {
    /// Whether the work is to end early.
    pub fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Checks the checkpoint before the work starts.
    ///
    /// # Errors
    /// The existing file is not a checkpoint, or none can be written.
    pub fn check(&self) -> Result<()> {
        let Some(path) = &self.checkpoint else { return Ok(()) };
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(Error::new("expected a folder that exists, for the checkpoint").in_file(folder));
        }
        // A checkpoint that cannot be written is told at once, and not after hours of work.
        file::check_file(path)?;
        self.read().map(|_| ())
    }

    fn read(&self) -> Result<Checkpoint> {
        let Some(path) = self.checkpoint.as_ref().filter(|path| path.exists()) else {
            return Ok(Checkpoint::default());
        };
        let text = file::read_text(path)?;
        let other = |found: String| {
            Error::new(format!("expected a checkpoint that springfit has written, found something else: {found}"))
                .in_file(path)
        };
        let value: Value = serde_json::from_str(&text).map_err(|e| other(e.to_string()))?;
        // The first version had no format in it, and is known by its fits.
        let is_checkpoint = value["format"] == FORMAT || value["fits"].is_object();
        if is_checkpoint && value["version"] != VERSION {
            let found = value["version"].as_u64().map_or("an older one".into(), |version| format!("version {version}"));
            let problem = format!("expected a checkpoint of version {VERSION}, found {found}: remove it to begin anew");
            return Err(Error::new(problem).in_file(path));
        }
        serde_json::from_value(value).map_err(|e| other(e.to_string()))
    }
}

impl<'a> Saved<'a> {
    /// The state from which the fit continues, if there is one.
    ///
    /// # Errors
    /// The file is not a checkpoint, or its state belongs to another fit of this name.
    pub fn open(controls: &'a Controls, name: &'a str, identity: Identity) -> Result<(Saved<'a>, Option<Snapshot>)> {
        let mut known = controls.read()?;
        let snapshot = match known.fits.remove(name) {
            Some(state) => {
                if let Some(change) = identity.change(&state.identity) {
                    let expected = "the state of this fit, or a file that does not exist yet";
                    let error =
                        Error::expected(format!("fits.{name}"), expected, format!("that of a fit with {change}"));
                    return Err(controls.checkpoint.iter().fold(error, |e, path| e.in_file(path)));
                }
                Some(state.snapshot)
            }
            None => None,
        };
        Ok((Saved { controls, name, identity, last: Instant::now() }, snapshot))
    }

    /// Names the checkpoint in an error about the state that was read from it.
    pub fn blame(&self, error: Error) -> Error {
        let error = Error::at(format!("fits.{}.snapshot", self.name), error.problem());
        self.controls.checkpoint.iter().fold(error, |error, path| error.in_file(path))
    }

    /// Writes the state beside those of other fits, if the last write was some time ago or `at_once` is set.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn keep(&mut self, snapshot: &Snapshot, at_once: bool) -> Result<()> {
        let Some(path) = self.controls.checkpoint.as_ref().filter(|_| at_once || self.last.elapsed() > INTERVAL) else {
            return Ok(());
        };
        self.last = Instant::now();
        // The fits of a run share the file: what others have saved stays.
        let mut all = self.controls.read()?;
        all.fits.insert(self.name.into(), SavedFit { identity: self.identity.clone(), snapshot: snapshot.clone() });
        let text = serde_json::to_string(&all).expect("a state of finite numbers is JSON");
        file::write_whole(path, text.as_bytes())
    }
}

/// What a fit begins with: its state belongs to no other fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Identity {
    /// Its settings, by their keys.
    settings: BTreeMap<String, Value>,
    /// A sum of the points, the springs and the loads.
    data: String,
}

impl Identity {
    /// The identity of a fit with these settings.
    pub fn of(settings: BTreeMap<String, Value>, points: &[f64], network: &Network, wanted: &Wanted) -> Identity {
        let mut data = DataSum(Sum::default());
        data.numbers(points);
        for spring in &network.lengths {
            spring.points.iter().for_each(|p| data.word(*p as u64));
            data.numbers(&[spring.constant, spring.rest]);
        }
        for spring in &network.others {
            spring.points.iter().for_each(|p| data.word(*p as u64));
            data.numbers(&[spring.constant, spring.rest]);
            data.numbers(spring.law.as_ref().map_or(&[], |own| &own.parameters));
        }
        wanted.trained.iter().chain(wanted.validation.loads()).for_each(|target| data.target(target));
        if let Some(frequencies) = &wanted.frequencies {
            data.numbers(&frequencies.masses);
            data.numbers(&frequencies.squares);
        }
        Identity { settings, data: data.0.to_string() }
    }

    /// What differs, if anything does.
    fn change(&self, found: &Identity) -> Option<String> {
        let keys = self.settings.keys().chain(found.settings.keys());
        let differs = |key: &&String| self.settings.get(*key) != found.settings.get(*key);
        let of_key = keys.into_iter().find(differs).map(|key| {
            let value = |own: &Identity| own.settings.get(key).map_or("none".into(), Value::to_string);
            format!("{key} = {}, where the scene has {}", value(found), value(self))
        });
        of_key.or_else(|| (self.data != found.data).then(|| "other points, springs or loads".into()))
    }
}

struct DataSum(Sum);

impl DataSum {
    fn target(&mut self, target: &Target) {
        target.name.bytes().for_each(|byte| self.word(u64::from(byte)));
        for numbers in [&target.forces, &target.displacement, &target.weights] {
            self.numbers(numbers);
        }
        // No support has this number, so that it can stand for what is free.
        let held: Vec<f64> = target.support.prescribed.iter().map(|p| p.unwrap_or(f64::NAN)).collect();
        self.numbers(&held);
    }

    fn numbers(&mut self, numbers: &[f64]) {
        // By their bits: a fit goes on only where the run would make the same steps.
        numbers.iter().for_each(|x| self.word(x.to_bits()));
    }

    fn word(&mut self, word: u64) {
        self.0.write(&word.to_le_bytes());
    }
}
