//! The operations that every kind of fit has.

use super::facts::SceneFacts;
use super::fitted::Fitted;
use super::record::KindRecord;
use super::sampled::SampledRecipe;
use super::whole::WholeBody;
use crate::body::LargeBody;
use crate::element::Element;
use crate::error::Result;
use crate::fit::CellFits;
use crate::material::{Material, MaterialMap};
use crate::mesh::{CellBlock, Mesh};
use crate::model::Network;
use crate::progress::{Event, Progress};
use crate::springs::Springs;

/// A kind of fit, with its settings.
pub trait FitKind {
    /// A name that states the settings; `groups` are the spring groups, such as ` +bulk`.
    fn title(&self, groups: &str) -> String;

    /// Checks that the scene has what the fit requires.
    ///
    /// # Errors
    /// It has not; the error names the key of the `[[fit]]`.
    fn check(&self, _scene: &SceneFacts) -> Result<()> {
        Ok(())
    }

    /// Fits the springs of all cells and assembles their network.
    ///
    /// # Errors
    /// The elements have no such spring group, or the body lacks what the fit requires.
    fn fit(&self, task: &Task, progress: &mut Progress) -> Result<Fitted>;

    /// The network from which a fit for an engine starts.
    ///
    /// # Errors
    /// Those of [`FitKind::fit`].
    fn start(&self, task: &Task, progress: &mut Progress) -> Result<Network> {
        Ok(self.fit(task, progress)?.network)
    }

    /// The sampled fit that it is, or from which it starts.
    fn sampled(&self) -> Option<&SampledRecipe> {
        None
    }

    /// The method, if it uses one cell at a time and needs only the cell and its material.
    fn cell_method(&self) -> Option<&dyn CellMethod> {
        None
    }

    /// The work of the fit, for a list of stages.
    fn stage(&self, name: &str) -> String {
        let shapes = self.sampled().map_or(String::new(), SampledRecipe::shapes);
        format!("fit {name}{shapes}, assemble its network, measure its matrix errors")
    }

    /// The settings, for a report.
    fn record(&self) -> KindRecord;
}

/// A method that fits single cells.
pub trait CellMethod: Sync {
    /// The name of the method.
    fn name(&self) -> String;

    /// How the constants are found, such as `native` or `formula`.
    fn solver(&self) -> &'static str;

    /// The constants of each of `cells`, `[cells · nodes]`.
    ///
    /// # Errors
    /// The springs do not belong to the element, or there is no formula for it.
    fn fit_cells(
        &self,
        element: &Element,
        springs: &Springs,
        points: &[f64],
        cells: &[usize],
        material: Material,
    ) -> Result<CellFits>;
}

/// What is known, besides its stiffness, of the body to which springs are fitted.
#[derive(Clone, Copy, Default)]
pub struct Reference<'a> {
    /// The body at large deformation, for sampled fits.
    pub large: Option<&'a LargeBody>,
    /// The body under loads, for whole-object fits.
    pub whole: Option<&'a WholeBody<'a>>,
    /// Whether each point is held in all directions under every load, `[points]`; empty if this is not known.
    pub held: &'a [bool],
}

/// A fit to be made: the body, its material, and the spring groups.
pub struct Task<'a> {
    /// The name of the fit, for progress reports.
    pub name: &'a str,
    /// The spring groups; all that are not optional, if absent.
    pub springs: Option<&'a [String]>,
    /// The mesh of the body.
    pub mesh: &'a Mesh,
    /// The materials of the body.
    pub material: &'a MaterialMap,
    /// What else is known of the body.
    pub reference: &'a Reference<'a>,
}

impl Task<'_> {
    /// Runs `fit` on every block of cells, with its index and its springs; the progress is that of all cells.
    ///
    /// # Errors
    /// Those of `fit`; or the elements have no such spring group.
    pub fn each_block<T>(
        &self,
        progress: &mut Progress,
        fit: impl Fn(usize, &CellBlock, &Springs, &mut dyn FnMut(usize)) -> Result<T>,
    ) -> Result<Vec<T>> {
        let total = self.mesh.cell_count();
        let mut done = 0;
        let mut all = Vec::new();
        for (index, block) in self.mesh.blocks.iter().enumerate() {
            let springs = Springs::select(&block.element, self.springs)?;
            all.push(fit(index, block, &springs, &mut |n| progress(Event::stage(self.name, done + n, total)))?);
            done += block.cells().len();
        }
        Ok(all)
    }
}
