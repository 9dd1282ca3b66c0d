//! Computes fits to the stiffness at rest.

use super::outcome::StiffnessOutcome;
use super::record::StiffnessRecord;
use super::tension::TensionOutcome;
use crate::clock::Clock;
use crate::element::Element;
use crate::error::Result;
use crate::fit::{CellFits, Fit, Rest, Solver, fit_cells};
use crate::fits::fitted::{Fitted, FittedKind};
use crate::fits::kind::{CellMethod, FitKind, Task};
use crate::fits::record::KindRecord;
use crate::material::Material;
use crate::progress::Progress;
use crate::springs::Springs;

impl FitKind for Fit {
    fn title(&self, groups: &str) -> String {
        let mut title = self.objective.title() + groups;
        if self.solver != Solver::Native {
            title += &format!(" by {}", self.solver.title());
        }
        title += self.rest.title();
        if self.tied {
            title += " tied";
        }
        if self.nonnegative {
            title += " k>=0";
        }
        if self.gap > 0.0 {
            title += &format!(" to {:e}", self.gap);
        }
        title
    }

    fn fit(&self, task: &Task, progress: &mut Progress) -> Result<Fitted> {
        let start = Clock::start();
        let cells = fit_at_rest(self, task, progress)?;
        let seconds = start.seconds();
        let kind = FittedKind::Stiffness(StiffnessOutcome::of(self, &cells));
        let mut fitted = Fitted::assembled(task.mesh, cells, seconds, kind);
        if let (Rest::Free | Rest::Zero, FittedKind::Stiffness(outcome)) = (self.rest, &mut fitted.kind) {
            outcome.tension = Some(TensionOutcome::of(&fitted.cells, &fitted.network, &task.mesh.points));
        }
        Ok(fitted)
    }

    fn cell_method(&self) -> Option<&dyn CellMethod> {
        Some(self)
    }

    fn record(&self) -> KindRecord {
        KindRecord::Stiffness(StiffnessRecord::of(self))
    }
}

/// The constants of all cells of the body.
///
/// # Errors
/// The elements have no such spring group, or the objective does not apply to them.
pub fn fit_at_rest(fit: &Fit, task: &Task, progress: &mut Progress) -> Result<Vec<CellFits>> {
    let moduli = task.material.moduli();
    task.each_block(progress, |index, block, springs, progress| {
        let moduli = moduli.block(index);
        fit_cells(&block.element, springs, &task.mesh.points, &block.connectivity, moduli, fit, progress)
    })
}

impl CellMethod for Fit {
    fn name(&self) -> String {
        self.objective.title()
    }

    fn solver(&self) -> &'static str {
        self.solver.name()
    }

    fn fit_cells(
        &self,
        element: &Element,
        springs: &Springs,
        points: &[f64],
        cells: &[usize],
        material: Material,
    ) -> Result<CellFits> {
        fit_cells(element, springs, points, cells, material.moduli(), self, &mut |_| {})
    }
}
