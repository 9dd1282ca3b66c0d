//! A term of the shear modulus of a body with regions.

use crate::material::Relaxation;

/// A branch: the share of the shear modulus in each region that relaxes with one time, and flows beyond one stress.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchTerm {
    /// The relaxation time τ, s.
    pub time: f64,
    /// The von Mises stress up to which it does not flow, Pa.
    pub yield_stress: Option<f64>,
    /// The shares, `[regions]`.
    pub shares: Vec<f64>,
}

impl BranchTerm {
    /// The terms of regions, each with its series; terms that are alike in several regions are one.
    pub fn of(series: &[Option<Relaxation>]) -> Vec<BranchTerm> {
        let mut terms: Vec<BranchTerm> = Vec::new();
        for (region, own) in series.iter().enumerate() {
            for term in own.iter().flat_map(Relaxation::terms) {
                let alike = |known: &&mut BranchTerm| {
                    // A region may name one time twice: its second share is a term of its own.
                    (known.time, known.yield_stress) == (term.time, term.yield_stress) && known.shares[region] == 0.0
                };
                match terms.iter_mut().find(alike) {
                    Some(known) => known.shares[region] = term.shear,
                    None => {
                        let mut shares = vec![0.0; series.len()];
                        shares[region] = term.shear;
                        terms.push(BranchTerm { time: term.time, yield_stress: term.yield_stress, shares });
                    }
                }
            }
        }
        terms
    }
}
