//! Computes fits to the displacements of the whole object.

use super::recipe::{Start, WholeRecipe};
use super::record::WholeRecord;
use crate::clock::Clock;
use crate::error::{Error, Result};
use crate::fit::{CellFits, Fit, Objective, Weight};
use crate::fits::facts::SceneFacts;
use crate::fits::fitted::{Fitted, FittedKind};
use crate::fits::kind::{FitKind, Task};
use crate::fits::record::KindRecord;
use crate::fits::sampled::{SampledRecipe, fit_shapes};
use crate::fits::stiffness::fit_at_rest;
use crate::model::Network;
use crate::progress::Progress;
use crate::whole::raise_idle;

impl WholeRecipe {
    /// The constants from which the fit starts.
    fn begin(&self, task: &Task, progress: &mut Progress) -> Result<Vec<CellFits>> {
        match &self.start {
            Start::Fit(fit) => fit_at_rest(fit, task, progress),
            // Only its springs are needed, not their constants.
            Start::Equal => fit_at_rest(&Fit::new(Objective::Frobenius(Weight::None)), task, progress),
            Start::Exact(..) => Ok(Vec::new()),
            Start::Sampled(recipe) => {
                Ok(fit_shapes(recipe, task, progress)?.into_iter().map(|found| found.fits).collect())
            }
        }
    }
}

impl FitKind for WholeRecipe {
    fn title(&self, groups: &str) -> String {
        format!("whole from {}{groups}", self.start.title())
    }

    fn check(&self, scene: &SceneFacts) -> Result<()> {
        if let Some(recipe) = self.sampled() {
            recipe.check(scene)?;
        }
        self.check_in(scene)
    }

    fn fit(&self, task: &Task, progress: &mut Progress) -> Result<Fitted> {
        let start = Clock::start();
        let mut cells = self.begin(task, progress)?;
        let seconds = start.seconds();
        let start = Clock::start();
        raise_idle(&mut cells);
        let springs = Fitted::springs_of(&cells);
        let network = Network::assemble(task.mesh, &cells);
        let seconds_assembly = start.seconds();
        let start = Clock::start();
        let missing = || Error::at("objective", "\"whole\" belongs to a scene with supports");
        let body = task.reference.whole.ok_or_else(missing)?;
        let own = (!matches!(self.start, Start::Exact(..))).then_some((&cells[..], &network));
        let (network, outcome) = body.fit((task.name, task.springs, task.reference.held), self, own, progress)?;
        let seconds = seconds + start.seconds();
        let (cells, kind) = (Vec::new(), FittedKind::Whole(Box::new(outcome)));
        Ok(Fitted { cells, springs, network, seconds, seconds_assembly, kind })
    }

    fn start(&self, task: &Task, progress: &mut Progress) -> Result<Network> {
        let mut cells = self.begin(task, progress)?;
        raise_idle(&mut cells);
        Ok(Network::assemble(task.mesh, &cells))
    }

    fn sampled(&self) -> Option<&SampledRecipe> {
        match &self.start {
            Start::Sampled(recipe) => Some(recipe),
            Start::Fit(_) | Start::Equal | Start::Exact(..) => None,
        }
    }

    fn stage(&self, name: &str) -> String {
        let shapes = self.sampled().map_or(String::new(), SampledRecipe::shapes);
        let loads = self.loads.words().join(", ");
        let chosen = match self.validation.words().join(", ") {
            none if none.is_empty() => String::new(),
            words => format!(", rho chosen by {words}"),
        };
        let start = self.start.title();
        format!(
            "fit {name}: start from {start}{shapes}, assemble its network, fit it to displacements under {loads}{chosen}"
        )
    }

    fn record(&self) -> KindRecord {
        KindRecord::Whole(Box::new(WholeRecord::of(self)))
    }
}
