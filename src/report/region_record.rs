//! The materials of a body, region by region.

use crate::material::{CellMap, State};
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
        let material = &outcome.material;
        // Over a million cells, so in a package that is optimised.
        let ranges = |values: &CellMap<f64>| -> Vec<[Option<f64>; 2]> {
            material.ranges_by_region(values).into_iter().map(|range| range.map(finite)).collect()
        };
        let cells = material.cells_by_region(outcome.mesh.cell_count());
        let (young, poisson) = (ranges(&material.young()), ranges(&material.poisson()));
        let thickness = (material.state() != State::Solid).then(|| ranges(&material.thicknesses()));
        let density = material.density().map(ranges);
        let record = |(region, name): (usize, &String)| RegionRecord {
            region: (!name.is_empty()).then(|| name.clone()),
            cells: cells[region],
            young: young[region],
            poisson: poisson[region],
            thickness: thickness.as_ref().map(|ranges| ranges[region]),
            density: density.as_ref().map(|ranges| ranges[region]),
        };
        material.regions().iter().enumerate().map(record).collect()
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
