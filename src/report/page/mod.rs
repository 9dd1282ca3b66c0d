//! The report of a run as one HTML file: its record, which `springfit-page` puts into the page.

mod array;
mod drawing;
mod histogram;
mod record;

pub use array::{Floats, Places};
pub(super) use histogram::constants_of;
pub use record::{
    HistogramRecord, LoadViewRecord, ModelViewRecord, MotionViewRecord, NetworkViewRecord, PageRecord,
    SpringMeshRecord, ViewRecord,
};

use super::json::Report;
use super::notes::groups;
use super::table::Table;
use crate::material::State;
use crate::study::{MotionOutcome, Outcome};
use crate::text::printable;
use drawing::{Drawing, spread};
use std::io::{self, Write};

/// States of a motion that are played.
const MOST_STATES: usize = 240;
/// Numbers of all states.
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
            state: match outcome.material.state() {
                State::Rod { .. } => "rod",
                State::Solid => "solid",
                State::PlaneStress { .. } => "plane stress",
                State::PlaneStrain { .. } => "plane strain",
            }
            .into(),
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
            view.loads.push(LoadViewRecord { name, displacement });
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
        view.motion = outcome.motion.as_ref().and_then(|motion| MotionViewRecord::of(motion, &drawing));
        if let Some(motion) = &view.motion {
            let all = outcome.motion.iter().flat_map(|m| &m.models).map(|model| model.states.len()).max().unwrap_or(0);
            if motion.times.len() < all {
                view.left_out.push(format!("Played are {} of {all} states of the motion.", motion.times.len()));
            }
        }
        view
    }
}

impl MotionViewRecord {
    /// `None` if no states were kept.
    fn of(motion: &MotionOutcome, drawing: &Drawing) -> Option<MotionViewRecord> {
        let longest = motion.models.iter().max_by_key(|model| model.states.len())?;
        let models = || motion.models.iter().filter(|model| !model.states.is_empty());
        let room = MOST_MOTION / (3 * drawing.count() * models().count()).max(1);
        let played = spread((0..longest.states.len()).collect(), room.clamp(2, MOST_STATES));
        let model = |model: &crate::study::ModelMotion| ModelViewRecord {
            network: model.fit,
            states: played.iter().filter_map(|&i| Some(drawing.vectors(model.states.get(i)?))).collect(),
        };
        let times: Vec<f64> = played.iter().filter_map(|&i| Some(longest.records.get(i)?.account.time)).collect();
        (!times.is_empty()).then(|| MotionViewRecord { times, models: models().map(model).collect() })
    }
}
