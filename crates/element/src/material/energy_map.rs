//! The energies of a body at large deformation.

use super::{CellMap, Energy, State};
use crate::error::Result;
use std::sync::Arc;

/// The energy and the state of each cell of a body: one for each region, or for each set of numbers in it. Copies share the values.
#[derive(Debug, Clone)]
pub struct EnergyMap {
    laws: Arc<[(Energy, State)]>,
    /// The law of each cell.
    of: CellMap<usize>,
}

impl EnergyMap {
    /// The laws of a body, and the law of each cell. A cell without a law has the first.
    ///
    /// `None` if there is no law.
    pub fn new(laws: Vec<(Energy, State)>, of: CellMap<usize>) -> Option<EnergyMap> {
        let count = laws.len();
        (count > 0).then(|| EnergyMap { laws: laws.into(), of: of.map(|law| if *law < count { *law } else { 0 }) })
    }

    /// The body with another law in place of each.
    ///
    /// # Errors
    /// This returns the errors of `of`.
    pub fn try_map(&self, of: impl Fn(&Energy, State) -> Result<Energy>) -> Result<EnergyMap> {
        let laws: Result<Vec<_>> = self.laws.iter().map(|(law, state)| Ok((of(law, *state)?, *state))).collect();
        Ok(EnergyMap { laws: laws?.into(), of: self.of.clone() })
    }

    /// The body with another law in place of each, by the region of its cells.
    ///
    /// # Errors
    /// This returns the errors of `of`.
    pub fn try_map_in(
        &self,
        region: &CellMap<usize>,
        of: impl Fn(usize, &Energy, State) -> Result<Energy>,
    ) -> Result<EnergyMap> {
        let both = self.of.try_zip(region, |law, region| Ok((*law, *region)))?;
        let mut known: Vec<(usize, usize)> = both.values().copied().collect();
        // A law is made once for each region that has it, and not for each cell.
        known.sort_unstable();
        known.dedup();
        let law = |&(law, region): &(usize, usize)| -> Result<(Energy, State)> {
            let (energy, state) = &self.laws[law];
            Ok((of(region, energy, *state)?, *state))
        };
        let laws: Result<Vec<_>> = known.iter().map(law).collect();
        let of = both.map(|pair| known.binary_search(pair).unwrap_or(0));
        Ok(EnergyMap { laws: laws?.into(), of })
    }

    /// The laws, each once.
    pub fn laws(&self) -> impl Iterator<Item = &Energy> {
        self.laws.iter().map(|(energy, _)| energy)
    }

    /// The law of the first region.
    pub fn first(&self) -> &Energy {
        &self.laws[0].0
    }

    /// The law of all cells, if they have the same.
    pub fn uniform(&self) -> Option<(&Energy, State)> {
        let (energy, state) = &self.laws[*self.of.uniform()?];
        Some((energy, *state))
    }

    /// The law of a cell and its state.
    pub fn at(&self, block: usize, cell: usize) -> (&Energy, State) {
        let (energy, state) = &self.laws[*self.of.at(block, cell)];
        (energy, *state)
    }

    /// The index of the law of each cell, in the order of [`EnergyMap::laws`].
    pub fn index(&self) -> &CellMap<usize> {
        &self.of
    }

    /// The titles of the laws, each once.
    pub fn title(&self) -> String {
        let mut titles: Vec<&str> = Vec::new();
        for energy in self.laws() {
            if !titles.contains(&energy.title()) {
                titles.push(energy.title());
            }
        }
        titles.join(", ")
    }

    /// How far fibres move the elasticity tensor at rest from that of E and ν, at most; `None` without fibres.
    pub fn distance_at_rest(&self) -> Option<f64> {
        self.laws().filter(|law| law.has_fibres()).map(Energy::distance_at_rest).reduce(f64::max)
    }

    /// The laws of some of the cells, which are given by block.
    pub fn of_some(&self, cells: &[Vec<usize>]) -> EnergyMap {
        EnergyMap { laws: self.laws.clone(), of: self.of.of_cells(cells) }
    }
}

impl From<(Energy, State)> for EnergyMap {
    fn from(law: (Energy, State)) -> EnergyMap {
        EnergyMap { laws: [law].into(), of: CellMap::Uniform(0) }
    }
}
