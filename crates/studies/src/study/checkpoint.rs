//! Cancelling a long fit, and continuing it from a checkpoint.

use crate::error::{Error, Result};
use crate::file;
use crate::model::Network;
use crate::whole::{Snapshot, Target, Wanted};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
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

/// The states of the whole-object fits of a scene.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Checkpoint {
    fits: BTreeMap<String, SavedFit>,
}

#[derive(Debug, Serialize, Deserialize)]
struct SavedFit {
    fingerprint: Fingerprint,
    snapshot: Snapshot,
}

/// The time between two writes of a checkpoint: a crash loses no more than this.
const INTERVAL: Duration = Duration::from_secs(5);

/// The state of one fit, in memory and on disk.
pub(super) struct Saved<'a> {
    controls: &'a Controls,
    name: &'a str,
    fingerprint: Fingerprint,
    last: Instant,
}

impl Controls {
    pub(super) fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Checks the checkpoint before the work starts.
    ///
    /// # Errors
    /// The existing file is not a checkpoint, or none can be written.
    pub(super) fn check(&self) -> Result<()> {
        let Some(path) = &self.checkpoint else { return Ok(()) };
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(Error::new("expected a folder that exists, for the checkpoint").in_file(folder));
        }
        file::check_file(path)?;
        self.read().map(|_| ())
    }

    fn read(&self) -> Result<Checkpoint> {
        let Some(path) = self.checkpoint.as_ref().filter(|path| path.exists()) else {
            return Ok(Checkpoint::default());
        };
        let text = file::read_text(path)?;
        serde_json::from_str(&text).map_err(|e| {
            Error::new(format!("expected a checkpoint that springfit has written, found something else: {e}"))
                .in_file(path)
        })
    }
}

impl<'a> Saved<'a> {
    /// The state from which the fit continues, if there is one.
    ///
    /// # Errors
    /// The file is not a checkpoint, or its state belongs to another fit of this name.
    pub fn open(
        controls: &'a Controls,
        name: &'a str,
        fingerprint: Fingerprint,
    ) -> Result<(Saved<'a>, Option<Snapshot>)> {
        let mut known = controls.read()?;
        let snapshot = match known.fits.remove(name) {
            Some(state) if state.fingerprint != fingerprint => {
                let expected = "the state of this fit, or a file that does not exist yet";
                let found = "that of a fit with other springs, loads or keys";
                let error = Error::expected(format!("fits.{name}"), expected, found);
                return Err(controls.checkpoint.iter().fold(error, |e, path| e.in_file(path)));
            }
            state => state.map(|state| state.snapshot),
        };
        Ok((Saved { controls, name, fingerprint, last: Instant::now() }, snapshot))
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
        let mut all = self.controls.read()?;
        all.fits.insert(self.name.into(), SavedFit { fingerprint: self.fingerprint, snapshot: snapshot.clone() });
        let text = serde_json::to_string(&all).expect("a state of finite numbers is JSON");
        file::write_whole(path, text.as_bytes())
    }
}

/// A hash of all data with which a fit begins; it is the same on every machine (FNV-1a).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Fingerprint(u64);

impl Fingerprint {
    /// `settings` is a text of all settings of the fit.
    pub fn of(settings: &str, points: &[f64], network: &Network, wanted: &Wanted) -> Fingerprint {
        let mut all = Fingerprint(0xcbf2_9ce4_8422_2325);
        all.text(settings);
        all.numbers(points);
        for spring in &network.lengths {
            spring.points.iter().for_each(|p| all.word(*p as u64));
            all.numbers(&[spring.constant, spring.rest]);
        }
        for spring in &network.others {
            spring.points.iter().for_each(|p| all.word(*p as u64));
            all.numbers(&[spring.constant, spring.rest]);
            all.numbers(spring.law.as_ref().map_or(&[], |own| &own.parameters));
        }
        wanted.trained.iter().chain(wanted.validation.loads()).for_each(|target| all.target(target));
        if let Some(frequencies) = &wanted.frequencies {
            all.numbers(&frequencies.masses);
            all.numbers(&frequencies.squares);
        }
        all
    }

    fn target(&mut self, target: &Target) {
        self.text(&target.name);
        for numbers in [&target.forces, &target.displacement, &target.weights] {
            self.numbers(numbers);
        }
        let held: Vec<f64> = target.support.prescribed.iter().map(|p| p.unwrap_or(f64::NAN)).collect();
        self.numbers(&held);
    }

    fn text(&mut self, text: &str) {
        text.bytes().for_each(|byte| self.word(u64::from(byte)));
    }

    fn numbers(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|x| self.word(x.to_bits()));
    }

    fn word(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }
}
