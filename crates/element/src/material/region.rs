//! The materials of a body, region by region.

use super::{CellMap, MaterialMap, State};
use crate::number::finite;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The material of a region, in `report.json`: the least and the largest value over its cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "RegionRecord")]
pub struct RegionMaterial {
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

impl MaterialMap {
    /// The material of each region, of a body with so many cells.
    pub fn by_region(&self, cells: usize) -> Vec<RegionMaterial> {
        let mut counts = vec![0; self.regions().len()];
        match self.region() {
            CellMap::Uniform(region) => counts[*region] = cells,
            CellMap::Each(blocks) => blocks.iter().flatten().for_each(|region| counts[*region] += 1),
        }
        let (young, poisson) = (self.ranges(&self.young()), self.ranges(&self.poisson()));
        let thickness = (self.state() != State::Solid).then(|| self.ranges(&self.thicknesses()));
        let density = self.density().map(|density| self.ranges(density));
        let of = |(region, name): (usize, &String)| RegionMaterial {
            region: (!name.is_empty()).then(|| name.clone()),
            cells: counts[region],
            young: young[region],
            poisson: poisson[region],
            thickness: thickness.as_ref().map(|ranges| ranges[region]),
            density: density.as_ref().map(|ranges| ranges[region]),
        };
        self.regions().iter().enumerate().map(of).collect()
    }

    /// The least and the largest of some values over the cells of each region. What is not a number is left out.
    fn ranges(&self, values: &CellMap<f64>) -> Vec<[Option<f64>; 2]> {
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.regions().len()];
        match self.region() {
            CellMap::Uniform(region) => ranges[*region] = values.range(),
            CellMap::Each(blocks) => {
                for (block, regions) in blocks.iter().enumerate() {
                    for (cell, region) in regions.iter().enumerate() {
                        let value = *values.at(block, cell);
                        let [least, largest] = &mut ranges[*region];
                        (*least, *largest) = (least.min(value), largest.max(value));
                    }
                }
            }
        }
        ranges.into_iter().map(|range| range.map(finite)).collect()
    }
}
