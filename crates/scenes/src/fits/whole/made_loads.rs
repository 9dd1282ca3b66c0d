//! What became of the loads that were made at large deformation.
//!
//! Theory: page *Whole-object fits* of the book.

use crate::whole::StretchedLoads;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How far made loads stretch the body at large deformation. The loads of the fit are called `loads: NAME`, those that choose ρ `validate:
/// NAME`, and those that neither `held out: NAME`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct MadeLoads {
    /// A tenth of the body becomes longer or shorter by this share under each load.
    pub stretch: f64,
    /// This number of loads was made.
    pub loads: usize,
    /// These loads lost their stable equilibrium before the stretch, and were scaled back to nine tenths of the last load with one.
    pub scaled_back: Vec<ScaledLoad>,
    /// These loads were drawn anew, because the first draw lost its equilibrium before half of the stretch.
    pub drawn_anew: Vec<String>,
    /// These loads were left out, because no draw has an equilibrium at half of the stretch.
    pub left_out: Vec<String>,
    /// These loads were left out, because the network at the start has no stable equilibrium under them.
    pub not_followed: Vec<String>,
}

/// A load that was scaled back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct ScaledLoad {
    /// The load has this name.
    pub load: String,
    /// A tenth of the body becomes longer or shorter by this share.
    pub stretch: f64,
}

impl MadeLoads {
    /// Adds the loads of one set under one support, in words.
    pub(super) fn add(&mut self, (set, place): (&str, &str), of: &StretchedLoads) {
        let named = |name: &String| format!("{set}: {name}{place}");
        self.loads += of.loads.len();
        self.scaled_back
            .extend(of.back.iter().map(|(name, stretch)| ScaledLoad { load: named(name), stretch: *stretch }));
        self.drawn_anew.extend(of.anew.iter().map(named));
        self.left_out.extend(of.out.iter().map(named));
    }

    /// Notes for the reader, one sentence each.
    pub(super) fn notes(&self) -> Vec<String> {
        let MadeLoads { stretch, loads, scaled_back, drawn_anew, left_out, not_followed } = self;
        let mut parts =
            vec![format!("{loads} loads were made that stretch a tenth of the body by {:.0} %", 100.0 * stretch)];
        let back = |own: &ScaledLoad| format!("{} {:.0} %", own.load, 100.0 * own.stretch);
        let scaled_back: Vec<String> = scaled_back.iter().map(back).collect();
        for (names, what) in [
            (&scaled_back, "scaled back, where the equilibrium was lost"),
            (drawn_anew, "drawn anew"),
            (left_out, "left out, because the body has no equilibrium at half of it"),
            (not_followed, "left out, because the network at the start has no stable equilibrium"),
        ] {
            if !names.is_empty() {
                parts.push(format!("{} {what} ({})", names.len(), names.join(", ")));
            }
        }
        vec![parts.join("; ")]
    }
}
