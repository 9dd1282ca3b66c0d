//! Computes the exact network of a body.

use super::outcome::ExactOutcome;
use super::recipe::{ExactRecipe, spring_words};
use super::record::ExactRecord;
use crate::analysis::locking::Locking;
use crate::clock::Clock;
use crate::element::Element;
use crate::error::Result;
use crate::fit::{CellFits, ExactEnergy, ExactFit, ShearSprings, VolumeSprings, fit_exact};
use crate::fits::fitted::{Fitted, FittedKind};
use crate::fits::kind::{CellMethod, FitKind, Task};
use crate::fits::record::KindRecord;
use crate::material::{Energy, Material, MaterialMap};
use crate::mesh::Mesh;
use crate::model::{Network, edge_springs, fibre_springs_of_regions, patch_springs};
use crate::positive::{PositiveFit, Route, nearest_positive};
use crate::progress::{Event, Progress};
use crate::springs::Springs;

impl FitKind for ExactRecipe {
    fn title(&self, _groups: &str) -> String {
        let energy = self.energy.map_or(String::new(), |energy| format!(" {}", energy.name()));
        let springs = spring_words(self.shear, self.volume);
        let positive = match self.positive {
            None => "",
            Some(PositiveFit { across: false, .. }) => " k>=0",
            Some(PositiveFit { across: true, .. }) => " k>=0 across",
        };
        format!("exact{energy}{springs}{positive}")
    }

    fn fit(&self, task: &Task, progress: &mut Progress) -> Result<Fitted> {
        let (mesh, material) = (task.mesh, task.material);
        let laws = task.reference.large.map(|large| &large.laws);
        let fit = self.resolve_on(mesh, laws)?;
        let start = Clock::start();
        // The springs of domains belong to no cell.
        let domains = match fit.shear {
            ShearSprings::Cells => None,
            ShearSprings::Edges => Some(edge_springs(mesh, material.clone(), &fit)?),
        };
        let mut patches = Vec::new();
        if fit.volume == VolumeSprings::Patches {
            patches = patch_springs(mesh, material, &fit, task.reference.held)?;
        }
        // A fit that names an energy is that of a body without fibres.
        let fibres = laws.filter(|_| self.energy.is_none()).map(|laws| fibre_springs_of_regions(mesh, material, laws));
        let fibres = fibres.transpose()?.unwrap_or_default();
        let total = mesh.cell_count();
        let (mut done, mut cells) = (0, Vec::new());
        // What is attached to the body has springs on its own cells, whatever those of the body are on.
        // Springs on strains are those of domains of edges alone.
        let energy = if fit.energy.has_contents().is_ok() { fit.energy } else { ExactEnergy::default() };
        let attached = ExactFit { energy, shear: ShearSprings::Cells, volume: VolumeSprings::Points, ..fit };
        for (index, block) in mesh.blocks.iter().enumerate() {
            let own = match (block.element.dimension() < mesh.cell_dimension(), &domains) {
                (true, _) => &attached,
                (false, None) => &fit,
                (false, Some(_)) => continue,
            };
            let of_block = material.materials()?.block(index);
            let mut watch = |n: usize| progress(Event::stage(task.name, done + n, total));
            cells.push(fit_exact(&block.element, &mesh.points, &block.connectivity, of_block, own, &mut watch)?);
            done += block.cells().len();
        }
        let mut seconds = start.seconds();
        let start = Clock::start();
        let mut network = match domains {
            Some(domains) => domains.joined(Network::assemble(&attached_cells(mesh), &std::mem::take(&mut cells))),
            None => Network::assemble(mesh, &cells),
        };
        let springs = Fitted::springs_of(&cells);
        let mut outcome = ExactOutcome {
            energy: fit.energy,
            shear: fit.shear,
            volume: measured(mesh, fit.volume),
            is_other: laws
                .is_some_and(|laws| self.energy.is_some() && !laws.laws().all(|law| is_all_of(&fit.energy, law))),
            patches: patches.len(),
            positive: None,
            locking: locking(mesh, material, fit.volume),
        };
        network.others.extend(patches);
        network.others.extend(fibres);
        let seconds_assembly = start.seconds();
        if let Some(positive) = &self.positive {
            let start = Clock::start();
            let search = format!("{}: nearest network", task.name);
            let (nearest, found) = {
                let mut watch = |done, total| progress(Event::stage(&search, done, total));
                nearest_positive(mesh, &network, positive, &mut watch)?
            };
            if found.route != Route::Unchanged {
                // Its springs belong to the whole body.
                cells.clear();
            }
            (network, outcome.positive) = (nearest, Some(found));
            seconds += start.seconds();
        }
        Ok(Fitted { cells, springs, network, seconds, seconds_assembly, kind: FittedKind::Exact(outcome) })
    }

    fn cell_method(&self) -> Option<&dyn CellMethod> {
        (self.shear.is_of_cells(self.volume) && self.positive.is_none()).then_some(self)
    }

    fn record(&self) -> KindRecord {
        KindRecord::Exact(ExactRecord::of(self))
    }
}

/// The cells that are attached to a body, with its points.
fn attached_cells(mesh: &Mesh) -> Mesh {
    let of_body = mesh.cell_dimension();
    let attached = mesh.blocks.iter().filter(|block| block.element.dimension() < of_body).cloned().collect();
    Mesh::of_cells(mesh.dimension, mesh.points.clone(), attached)
}

/// Whether a law is this energy and has no fibres.
fn is_all_of(energy: &ExactEnergy, law: &Energy) -> bool {
    energy.is_that_of(law) && matches!(law.fibre_law(), Ok(None))
}

impl CellMethod for ExactRecipe {
    fn name(&self) -> String {
        self.title("")
    }

    fn solver(&self) -> &'static str {
        "formula"
    }

    /// The given springs are not used: an exact network has its own.
    fn fit_cells(
        &self,
        element: &Element,
        _springs: &Springs,
        points: &[f64],
        cells: &[usize],
        material: Material,
    ) -> Result<CellFits> {
        let fit = self.resolve(None)?;
        fit_exact(element, points, cells, material, &fit, &mut |_| {})
    }
}

/// Whether the content of a cell is that of its one quadrature point, as in linear triangles and tetrahedra.
fn has_one_point(element: &Element) -> bool {
    element.tabulation.weights.len() == 1
}

/// The contents that the volume springs measure: springs on cells are those on points where each cell has one.
fn measured(mesh: &Mesh, volume: VolumeSprings) -> VolumeSprings {
    match volume {
        VolumeSprings::Cells if mesh.blocks.iter().all(|block| has_one_point(&block.element)) => VolumeSprings::Points,
        VolumeSprings::Points | VolumeSprings::Cells | VolumeSprings::Patches => volume,
    }
}

/// The largest Poisson's ratio of cells that lock and whose network does as well, and the keys of springs that do not lock there.
fn locking(mesh: &Mesh, material: &MaterialMap, volume: VolumeSprings) -> Option<(f64, &'static str)> {
    let is_like_the_body = |element: &Element| match volume {
        VolumeSprings::Points => true,
        VolumeSprings::Cells => has_one_point(element),
        VolumeSprings::Patches => false,
    };
    let found = Locking::of(mesh, material, &is_like_the_body)?;
    let remedy = match found.of_simplices {
        true => "shear = \"edges\" with volume = \"patches\"",
        false => "volume = \"cells\"",
    };
    Some((found.poisson, remedy))
}
