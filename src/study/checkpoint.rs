//! What ends a long fit early, and what it goes on from.

use super::scene::NamedFit;
use crate::error::{Error, Result};
use crate::file;
use crate::model::Network;
use crate::whole::Snapshot;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How a run may be ended early and gone on with.
#[derive(Debug, Default)]
pub struct Controls {
    /// Set from outside, it ends whole-object fits after the step they are at; the best point so far is kept.
    pub cancelled: AtomicBool,
    /// Where whole-object fits save their state every few seconds and at their end, and what they go on from if it is there.
    pub checkpoint: Option<PathBuf>,
}

/// The states of the whole-object fits of a scene.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Checkpoint {
    fits: BTreeMap<String, State>,
}

#[derive(Debug, Serialize, Deserialize)]
struct State {
    /// Of what the fit begins with.
    fingerprint: u64,
    snapshot: Snapshot,
}

const INTERVAL: Duration = Duration::from_secs(5);

/// The state of one fit, in memory and on disk.
pub(super) struct Saved<'a> {
    controls: &'a Controls,
    name: &'a str,
    fingerprint: u64,
    last: Instant,
}

impl Controls {
    pub(super) fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    fn read(&self) -> Result<Checkpoint> {
        let Some(path) = self.checkpoint.as_ref().filter(|path| path.exists()) else {
            return Ok(Checkpoint::default());
        };
        let text = file::read_text(path)?;
        serde_json::from_str(&text).map_err(|e| Error::new(format!("is no checkpoint: {e}")).in_file(path))
    }
}

impl<'a> Saved<'a> {
    /// The state that the fit goes on from, if there is one.
    ///
    /// # Errors
    /// The file is no checkpoint, or its state is that of another fit of this name.
    pub fn open(controls: &'a Controls, fit: &'a NamedFit, network: &Network) -> Result<(Saved<'a>, Option<Snapshot>)> {
        let mut hasher = DefaultHasher::new();
        format!("{:?} {:?}", fit.recipe, fit.springs).hash(&mut hasher);
        for spring in &network.lengths {
            (spring.points, spring.constant.to_bits(), spring.rest.to_bits()).hash(&mut hasher);
        }
        network.others.iter().for_each(|s| (&s.points, s.constant.to_bits(), s.rest.to_bits()).hash(&mut hasher));
        let fingerprint = hasher.finish();
        let mut known = controls.read()?;
        let snapshot = match (known.fits.remove(&fit.name), &controls.checkpoint) {
            (Some(state), Some(path)) if state.fingerprint != fingerprint => {
                let expected = "the state of this fit, or a file that does not exist yet";
                let found = "that of a fit with other springs, constants or keys";
                return Err(Error::expected(format!("fits.{}", fit.name), expected, found).in_file(path));
            }
            (state, _) => state.map(|state| state.snapshot),
        };
        Ok((Saved { controls, name: &fit.name, fingerprint, last: Instant::now() }, snapshot))
    }

    /// Writes the state beside those of other fits, if the last time is a while ago.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn keep(&mut self, snapshot: &Snapshot, at_once: bool) -> Result<()> {
        let Some(path) = self.controls.checkpoint.as_ref().filter(|_| at_once || self.last.elapsed() > INTERVAL) else {
            return Ok(());
        };
        self.last = Instant::now();
        let mut all = self.controls.read()?;
        let state = State { fingerprint: self.fingerprint, snapshot: snapshot.clone() };
        all.fits.insert(self.name.into(), state);
        let text = serde_json::to_string(&all).expect("a state of finite numbers is JSON");
        file::write_whole(path, text.as_bytes())
    }
}
