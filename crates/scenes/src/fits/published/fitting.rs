//! Computes springs by published formulas.

use super::outcome::PublishedOutcome;
use super::record::PublishedRecord;
use crate::clock::Clock;
use crate::element::{Element, SpringKind};
use crate::error::{Error, Result};
use crate::fit::CellFits;
use crate::fit::published::{self, Method, Unmet};
use crate::fits::fitted::{Fitted, FittedKind};
use crate::fits::kind::{CellMethod, FitKind, Task};
use crate::fits::record::KindRecord;
use crate::material::Material;
use crate::progress::Progress;
use crate::springs::Springs;

impl FitKind for Method {
    fn title(&self, groups: &str) -> String {
        self.name().to_string() + groups
    }

    fn fit(&self, task: &Task, progress: &mut Progress) -> Result<Fitted> {
        let start = Clock::start();
        let of_method = |e: Error| e.placed(|e| Error::at("objective", e.to_string()));
        let materials = task.material.materials()?;
        let mut unmet: Option<Unmet> = None;
        for (index, block) in task.mesh.blocks.iter().enumerate() {
            let named = task.springs.iter().flat_map(|springs| block.element.select_groups(Some(springs)));
            if let Some(group) = named.flatten().find(|group| group.kind != SpringKind::Length) {
                let expected = format!("groups of length springs, beside which {} adds its own", self.name());
                return Err(Error::expected("springs", expected, format!("\"{}\"", group.name)));
            }
            let (points, cells) = (&task.mesh.points, &block.connectivity);
            let material = materials.block(index);
            let own = published::unmet(*self, &block.element, points, cells, material).map_err(of_method)?;
            unmet = Some(unmet.unwrap_or_default().and(own));
        }
        let cells = task.each_block(progress, |index, block, springs, _| {
            let material = materials.block(index);
            let (points, cells) = (&task.mesh.points, &block.connectivity);
            published::fit(*self, &block.element, springs, points, cells, material).map_err(of_method)
        })?;
        let kind = FittedKind::Published(PublishedOutcome { method: *self, unmet: unmet.unwrap_or_default() });
        Ok(Fitted::assembled(task.mesh, cells, start.seconds(), kind))
    }

    fn cell_method(&self) -> Option<&dyn CellMethod> {
        Some(self)
    }

    fn record(&self) -> KindRecord {
        KindRecord::Published(PublishedRecord::of(*self))
    }
}

impl CellMethod for Method {
    fn name(&self) -> String {
        Method::name(self).into()
    }

    fn solver(&self) -> &'static str {
        "formula"
    }

    fn fit_cells(
        &self,
        element: &Element,
        springs: &Springs,
        points: &[f64],
        cells: &[usize],
        material: Material,
    ) -> Result<CellFits> {
        published::fit(*self, element, springs, points, cells, material)
    }
}
