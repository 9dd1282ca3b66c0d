//! The report of a run as one HTML file: its record, which `springfit-page` puts into the page.

mod array;
mod drawing;
mod histogram;
mod record;

pub use array::{Floats, Places};
pub(super) use histogram::constants_of;
pub use record::{HistogramRecord, NetworkViewRecord, PageRecord, SpringMeshRecord, ViewRecord};

use super::json::Report;
use super::notes::groups;
use super::object::Object;
use super::table::Table;

use crate::study::{ModelMotion, MotionOutcome, Outcome};
use crate::text::printable;
use drawing::{Drawing, spread};
use serde_json::json;
use std::io::{self, Write};

/// States of a motion that are played: as many as ten seconds of a film have.
const MOST_STATES: usize = 240;
/// Numbers of all states: they fill about 30 MB of a page.
const MOST_MOTION: usize = 6_000_000;

/// Writes the page of a run.
///
/// # Errors
/// The writer fails.
pub fn page_html(outcome: &Outcome, to: &mut dyn Write) -> io::Result<()> {
    let record = serde_json::to_string(&PageRecord::of(outcome)).map_err(io::Error::other)?;
    springfit_page::write(&printable(&outcome.scene), &record, to)
}

impl PageRecord {
    /// The record of a run.
    pub fn of(outcome: &Outcome) -> PageRecord {
        let report = Report::of(outcome);
        PageRecord {
            program: concat!("springfit ", env!("CARGO_PKG_VERSION")).into(),
            command: outcome.command.clone(),
            mesh: outcome.source.clone(),
            state: outcome.material.state().words().into(),
            notes: groups(outcome),
            tables: Table::all(&report),
            report,
            view: ViewRecord::of(outcome),
        }
    }
}

impl ViewRecord {
    fn of(outcome: &Outcome) -> ViewRecord {
        let networks: Vec<_> = outcome.fits.iter().map(|fit| (fit.fit.name.as_str(), &fit.network)).collect();
        let drawing = Drawing::of(&outcome.mesh, &networks, outcome.loads.len());
        let mut view = ViewRecord {
            dimension: outcome.mesh.dimension,
            points: drawing.vectors(&outcome.mesh.points),
            numbers: drawing.numbers(),
            edges: drawing.places(drawing.edges.iter().flatten().copied()),
            triangles: drawing.places(drawing.triangles.iter().flatten().copied()),
            left_out: drawing.left_out.clone(),
            ..ViewRecord::default()
        };
        for load in &outcome.loads {
            let displacement = drawing.vectors(&load.fem);
            let name = match load.followed.filter(|_| !load.is_reached()) {
                Some(followed) => format!("{}, {:.3} of the load", load.name, followed.load),
                None => load.name.clone(),
            };
            view.loads.push(Object(vec![("name", json!(name)), ("displacement", json!(displacement))]));
        }
        for (fit, springs) in outcome.fits.iter().zip(&drawing.springs) {
            let own = drawing.spring_mesh(&fit.network, springs);
            let mesh = view.meshes.iter().position(|known| *known == own).unwrap_or_else(|| {
                view.meshes.push(own);
                view.meshes.len() - 1
            });
            let lengths = || springs.iter().map(|&s| &fit.network.lengths[s]);
            view.networks.push(NetworkViewRecord {
                name: fit.fit.name.clone(),
                mesh,
                constants: lengths().map(|spring| spring.constant).collect(),
                rests: lengths().map(|spring| spring.rest).collect(),
                displacements: fit.loads.iter().map(|l| Some(drawing.vectors(l.displacement.as_ref()?))).collect(),
                histograms: HistogramRecord::all(&fit.network),
            });
        }
        view.motion = outcome.motion.as_ref().and_then(|motion| played(motion, &drawing, &mut view.left_out));
        view
    }
}

/// The states of a motion that are played, and in `left_out` how many are not; `None` if no states were kept.
fn played(motion: &MotionOutcome, drawing: &Drawing, left_out: &mut Vec<String>) -> Option<Object> {
    let longest = motion.models.iter().max_by_key(|model| model.states.len())?;
    let models = || motion.models.iter().filter(|model| !model.states.is_empty());
    let room = MOST_MOTION / (3 * drawing.count() * models().count()).max(1);
    let all = longest.states.len();
    let played = spread((0..all).collect(), room.clamp(2, MOST_STATES));
    let model = |model: &ModelMotion| {
        let states = played.iter().filter_map(|&i| Some(drawing.vectors(model.states.get(i)?)));
        json!({ "network": model.fit, "states": states.collect::<Vec<_>>() })
    };
    let times: Vec<f64> = played.iter().filter_map(|&i| Some(longest.records.get(i)?.account.time)).collect();
    if !times.is_empty() && times.len() < all {
        left_out.push(format!("Played are {} of {all} states of the motion.", times.len()));
    }
    (!times.is_empty()).then(|| Object(vec![("times", json!(times)), ("models", models().map(model).collect())]))
}
