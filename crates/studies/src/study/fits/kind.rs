//! What every kind of fit can do.

use super::facts::SceneFacts;
use super::fitted::Fitted;
use super::record::KindRecord;
use super::sampled::SampledRecipe;
use super::whole::WholeBody;
use crate::element::Element;
use crate::error::Result;
use crate::fit::CellFits;
use crate::material::Material;
use crate::mesh::{CellBlock, Mesh};
use crate::springs::Springs;
use crate::study::body::LargeBody;
use crate::study::progress::{Event, Progress};

/// A kind of fit, with its settings.
pub trait FitKind {
    /// A name that tells the settings; `groups` are the spring groups, such as ` +bulk`.
    fn title(&self, groups: &str) -> String;

    /// That the scene has what the fit needs.
    ///
    /// # Errors
    /// Names the key of the `[[fit]]`.
    fn check(&self, _scene: &SceneFacts) -> Result<()> {
        Ok(())
    }

    /// Fits the springs of all cells and assembles their network.
    ///
    /// # Errors
    /// A spring group is no group of the elements, or the body lacks what the fit needs.
    fn fit(&self, task: &Task, progress: &mut Progress) -> Result<Fitted>;

    /// The sampled fit that it is or starts from.
    fn sampled(&self) -> Option<&SampledRecipe> {
        None
    }

    /// The method, if it looks at one cell at a time and needs nothing but the cell and its material.
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

/// A fit of single cells.
pub trait CellMethod: Sync {
    fn name(&self) -> String;

    /// How the constants are found, such as `native` or `formula`.
    fn solver(&self) -> &'static str;

    /// The constants of each of `cells`, `[cells · nodes]`.
    ///
    /// # Errors
    /// The springs do not go with the element, or there is no formula for it.
    fn fit_cells(
        &self,
        element: &Element,
        springs: &Springs,
        points: &[f64],
        cells: &[usize],
        material: Material,
    ) -> Result<CellFits>;
}

/// What is known of the body that springs are fitted to, beyond its stiffness.
#[derive(Clone, Copy, Default)]
pub struct Reference<'a> {
    /// For sampled fits.
    pub large: Option<&'a LargeBody>,
    /// For whole-object fits.
    pub whole: Option<&'a WholeBody<'a>>,
    /// Which points are held in all directions under every load, `[points]`; empty where nothing is known of that.
    pub held: &'a [bool],
}

/// A body to be fitted.
pub struct Task<'a> {
    pub name: &'a str,
    /// The spring groups; all that are not optional, if absent.
    pub springs: Option<&'a [String]>,
    pub mesh: &'a Mesh,
    pub material: Material,
    pub reference: &'a Reference<'a>,
}

impl Task<'_> {
    /// `fit` of every block of cells with its springs; the progress is that of all cells.
    ///
    /// # Errors
    /// Those of `fit`, and a spring group is no group of the elements.
    pub fn each_block<T>(
        &self,
        progress: &mut Progress,
        fit: impl Fn(&CellBlock, &Springs, &mut dyn FnMut(usize)) -> Result<T>,
    ) -> Result<Vec<T>> {
        let total = self.mesh.cell_count();
        let mut done = 0;
        let mut all = Vec::new();
        for block in &self.mesh.blocks {
            let springs = Springs::select(&block.element, self.springs)?;
            all.push(fit(block, &springs, &mut |n| progress(Event::stage(self.name, done + n, total)))?);
            done += block.cells().len();
        }
        Ok(all)
    }
}
