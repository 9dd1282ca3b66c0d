//! The unknowns of a whole-object fit: factors on the constants at the start, each for one spring or shared by many.
//!
//! Theory: page *Whole-object fits* of the book.

use super::regions::BodyRegions;
use crate::error::{Error, Result};
use crate::fit::CellFits;
use crate::mesh::{CellIndex, Mesh};
use crate::model::Network;
use crate::springs::Force;
use std::collections::{BTreeMap, HashMap};

/// The factors `factor_s = Σ_p share_sp exp θ_p`, where the shares of a spring sum to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknowns {
    /// The index at which the shares of each spring begin, `[springs + 1]`.
    starts: Vec<usize>,
    /// Unknown and share.
    shares: Vec<(usize, f64)>,
    count: usize,
}

impl Unknowns {
    /// Unknown `own[s]` for part s.
    pub(super) fn one_for_each(own: Vec<usize>) -> Unknowns {
        let count = own.iter().max().map_or(0, |last| last + 1);
        Unknowns { starts: (0..=own.len()).collect(), shares: own.into_iter().map(|p| (p, 1.0)).collect(), count }
    }

    /// One unknown for all springs on lengths, and one for all others.
    pub fn per_kind(network: &Network) -> Unknowns {
        let lengths = network.lengths.len();
        Unknowns::one_for_each((0..network.len()).map(|s| usize::from(lengths > 0 && s >= lengths)).collect())
    }

    /// One unknown for each spring of the network.
    pub fn per_spring(network: &Network) -> Unknowns {
        let count = network.len();
        Unknowns { starts: (0..=count).collect(), shares: (0..count).map(|s| (s, 1.0)).collect(), count }
    }

    /// One unknown for each spring group of the elements.
    ///
    /// # Errors
    /// Those of [`Unknowns::per_element`].
    pub fn per_group(mesh: &Mesh, fits: &[CellFits], network: &Network) -> Result<Unknowns> {
        let name = |cell: CellIndex, spring: usize| group(&fits[cell.block], spring);
        Unknowns::labelled(mesh, fits, network, name)
    }

    /// One unknown for each spring group in each region.
    ///
    /// # Errors
    /// Those of [`Unknowns::per_element`].
    pub fn per_region(mesh: &Mesh, regions: &BodyRegions, fits: &[CellFits], network: &Network) -> Result<Unknowns> {
        Unknowns::labelled(mesh, fits, network, |cell, spring| (regions.names(cell), group(&fits[cell.block], spring)))
    }

    /// One unknown for each spring of each element, before springs between the same two points are added.
    ///
    /// # Errors
    /// The springs have force laws or rest lengths of their own, so that only whole springs can be scaled.
    pub fn per_element(mesh: &Mesh, fits: &[CellFits], network: &Network) -> Result<Unknowns> {
        Unknowns::labelled(mesh, fits, network, |cell, spring| (cell.block, cell.cell, spring))
    }

    /// One unknown for each label that a spring of a cell can have.
    fn labelled<L: Ord>(
        mesh: &Mesh,
        fits: &[CellFits],
        network: &Network,
        label: impl Fn(CellIndex, usize) -> L,
    ) -> Result<Unknowns> {
        if fits.iter().any(|fit| fit.force != Force::Linear) {
            let expected = "\"spring\" where springs have laws of force or rest lengths of their own";
            return Err(Error::expected("unknowns", expected, "unknowns that are shared"));
        }
        let place: HashMap<[usize; 2], usize> =
            network.lengths.iter().enumerate().map(|(s, spring)| (spring.points, s)).collect();
        let mut known: BTreeMap<L, usize> = BTreeMap::new();
        let mut shares: Vec<Vec<(usize, f64)>> = vec![Vec::new(); network.len()];
        let mut next = network.lengths.len();
        for (index, (block, fit)) in mesh.blocks.iter().zip(fits).enumerate() {
            let m = fit.springs.len();
            for (cell, (nodes, constants)) in block.cells().zip(fit.constants.chunks_exact(m.max(1))).enumerate() {
                for (spring, &constant) in constants.iter().enumerate().filter(|(_, k)| **k != 0.0) {
                    let at = match fit.springs.pairs().get(spring) {
                        Some(&[a, b]) => place.get(&[nodes[a].min(nodes[b]), nodes[a].max(nodes[b])]).copied(),
                        // Springs on more than two points are never added to others: the network has them in the order
                        // of the cells.
                        None => {
                            next += 1;
                            Some(next - 1)
                        }
                    };
                    // Constants of opposite sign may cancel and leave no spring.
                    let Some(at) = at else { continue };
                    let count = known.len();
                    let unknown = *known.entry(label(CellIndex { block: index, cell }, spring)).or_insert(count);
                    match shares[at].iter_mut().find(|(p, _)| *p == unknown) {
                        Some((_, sum)) => *sum += constant,
                        None => shares[at].push((unknown, constant)),
                    }
                }
            }
        }
        let mut unknowns = Unknowns { starts: vec![0], shares: Vec::new(), count: known.len() };
        for own in &shares {
            let total: f64 = own.iter().map(|(_, k)| k).sum();
            // At θ = 0 the shares sum to one, so that the factor is one and the spring as it was.
            unknowns.shares.extend(own.iter().map(|(p, k)| (*p, k / total)));
            unknowns.starts.push(unknowns.shares.len());
        }
        Ok(unknowns)
    }

    /// The first unknown of each part.
    pub(super) fn owners(&self) -> impl Iterator<Item = usize> {
        self.each().map(|own| own[0].0)
    }

    /// The number of springs, or of other parts with a factor.
    pub fn springs(&self) -> usize {
        self.starts.len() - 1
    }

    /// The number of unknowns.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The factor on each spring, `[springs]`.
    pub fn factors(&self, theta: &[f64]) -> Vec<f64> {
        self.each().map(|own| own.iter().map(|(p, share)| share * theta[*p].exp()).sum()).collect()
    }

    /// The rate of change of the factors if the unknowns change at the rate v: `Σ_p share_sp exp θ_p v_p`.
    pub fn forward(&self, theta: &[f64], v: &[f64]) -> Vec<f64> {
        self.each().map(|own| own.iter().map(|(p, share)| share * theta[*p].exp() * v[*p]).sum()).collect()
    }

    /// The transpose of [`Unknowns::forward`].
    pub fn adjoint(&self, theta: &[f64], w: &[f64]) -> Vec<f64> {
        let mut total = vec![0.0; self.count];
        for (own, w) in self.each().zip(w) {
            own.iter().for_each(|(p, share)| total[*p] += share * w);
        }
        total.iter_mut().zip(theta).for_each(|(t, theta)| *t *= theta.exp());
        total
    }

    fn each(&self) -> impl Iterator<Item = &[(usize, f64)]> {
        self.starts.windows(2).map(|at| &self.shares[at[0]..at[1]])
    }
}

fn group(fit: &CellFits, spring: usize) -> &str {
    &fit.springs.names()[fit.springs.groups()[spring]]
}
