//! The materials of a body, region by region.

use crate::material::{Material, State};
use crate::mesh::Mesh;
use crate::number::finite;
use crate::study::Outcome;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The material of a region, in `report.json`: the least and the largest value over its cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RegionRecord {
    /// The region is this group, this condition or `rest`; it is null where the body has no regions.
    pub region: Option<String>,
    /// The region has this number of cells.
    pub cells: usize,
    /// Young's modulus in Pa has this least and largest value over the cells; both are null for anisotropic materials.
    pub young: [Option<f64>; 2],
    /// Poisson's ratio has this least and largest value over the cells; both are null for anisotropic materials.
    pub poisson: [Option<f64>; 2],
    /// The thickness in m, or the cross-section of rods in m², has this least and largest value over the cells; it is null for solids.
    pub thickness: Option<[Option<f64>; 2]>,
    /// The density in kg/m³ has this least and largest value over the cells; it is null without a density.
    pub density: Option<[Option<f64>; 2]>,
}

impl RegionRecord {
    /// Makes a record of each region of a body.
    pub(super) fn all(outcome: &Outcome) -> Vec<RegionRecord> {
        let (mesh, material) = (&outcome.mesh, &outcome.material);
        let (names, thicknesses) = (material.regions(), material.thicknesses());
        let cells = cells_of_regions(mesh, outcome);
        let record = |(name, cells): (&String, &Vec<(usize, usize)>)| {
            let range = |value: &dyn Fn(usize, usize) -> f64| {
                let values = cells.iter().map(|&(block, cell)| value(block, cell));
                let ends = values
                    .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
                ends.map(finite)
            };
            let of = |value: fn(&Material) -> f64| {
                range(&|block, cell| material.isotropic(block, cell).map_or(f64::NAN, |material| value(&material)))
            };
            RegionRecord {
                region: (!name.is_empty()).then(|| name.clone()),
                cells: cells.len(),
                young: of(Material::young),
                poisson: of(Material::poisson),
                thickness: (material.state() != State::Solid)
                    .then(|| range(&|block, cell| *thicknesses.at(block, cell))),
                density: material.density().map(|density| range(&|block, cell| *density.at(block, cell))),
            }
        };
        names.iter().zip(&cells).map(record).collect()
    }

    /// The material in words, such as `E = 1000 to 5000 Pa, nu = 0.3`.
    pub(super) fn words(&self) -> String {
        let words = |[least, largest]: [Option<f64>; 2]| match (least, largest) {
            (Some(least), Some(largest)) if least == largest => format!("{least}"),
            (Some(least), Some(largest)) => format!("{} to {}", short(least), short(largest)),
            _ => "-".into(),
        };
        match self.young {
            [None, None] => "anisotropic".into(),
            _ => format!("E = {} Pa, nu = {}", words(self.young), words(self.poisson)),
        }
    }
}

/// Four digits: ends of a range are seldom round numbers.
fn short(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    match value {
        0.0 => "0".into(),
        _ if (-3.0..6.0).contains(&exponent) => {
            let text = format!("{value:.*}", (3.0 - exponent).max(0.0) as usize);
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').into(),
                false => text,
            }
        }
        _ => format!("{value:.3e}"),
    }
}

/// Block and index of the cells of each region.
fn cells_of_regions(mesh: &Mesh, outcome: &Outcome) -> Vec<Vec<(usize, usize)>> {
    let material = &outcome.material;
    let mut cells = vec![Vec::new(); material.regions().len()];
    for (index, block) in mesh.blocks.iter().enumerate() {
        (0..block.cells().len()).for_each(|cell| cells[*material.region().at(index, cell)].push((index, cell)));
    }
    cells
}
