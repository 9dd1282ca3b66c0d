//! The unknowns of the springs of a cell.

use crate::fit::rest::Rest;
use crate::springs::{Springs, norm};

/// A dimensionless unknown u, and what it adds to the springs.
pub struct Unknown {
    pub terms: Vec<Term>,
    /// Whether it is a constant; otherwise it is a tension alone.
    pub is_constant: bool,
}

/// `k_s += constant · u`, `T_s += tension · u`.
pub struct Term {
    pub spring: usize,
    pub constant: f64,
    pub tension: f64,
}

/// The sizes by which the unknowns of a cell are made dimensionless.
pub struct Sizes {
    /// The size of R, N/m.
    pub stiffness: f64,
    /// The size of the cell, m.
    pub extent: f64,
    /// `‖g_s‖`.
    pub gradients: Vec<f64>,
    /// The measures `c_s` at rest.
    pub measures: Vec<f64>,
}

/// The unknowns of all springs: a constant for each, and a tension for those whose rest measure is unknown. Tied
/// springs have one of each per group. Their tensions are `T_s = q c_s`, so that they also share the ratio
/// `c₀/c = 1 − q/k`.
pub fn unknowns(springs: &Springs, rest: Rest, tied: bool, sizes: &Sizes) -> Vec<Unknown> {
    let members: Vec<Vec<usize>> = match tied {
        true => {
            let of_group = |group| (0..springs.len()).filter(|&s| springs.groups()[s] == group).collect();
            // A group that this element has no springs of has no unknown.
            (0..springs.names().len()).map(of_group).filter(|group: &Vec<usize>| !group.is_empty()).collect()
        }
        false => (0..springs.len()).map(|s| vec![s]).collect(),
    };
    members.iter().flat_map(|members| of_members(members, members[0] < springs.pairs().len(), rest, sizes)).collect()
}

/// The unknowns of springs that share them.
fn of_members(members: &[usize], on_lengths: bool, rest: Rest, sizes: &Sizes) -> Vec<Unknown> {
    let Sizes { stiffness, extent, gradients, measures } = sizes;
    let mean = |values: &[f64]| {
        let own: Vec<f64> = members.iter().map(|&s| values[s]).collect();
        // The root mean square is positive where a single gradient is.
        norm(&own) / (own.len() as f64).sqrt()
    };
    let (g, c) = (mean(gradients), mean(measures));
    let unknown = |is_constant: bool, of: &dyn Fn(usize) -> [f64; 2]| {
        let term = |&spring: &usize| {
            let [constant, tension] = of(spring);
            Term { spring, constant, tension }
        };
        Unknown { terms: members.iter().map(term).collect(), is_constant }
    };
    let constant = stiffness / (g * g);
    match rest {
        Rest::Zero if on_lengths => vec![unknown(true, &|s| [constant, constant * measures[s]])],
        Rest::Mesh => vec![unknown(true, &|_| [constant, 0.0])],
        Rest::Free | Rest::Zero => {
            let tension = stiffness * extent / g;
            let share = |s: usize| match members {
                // A single spring may pull even if it measures zero.
                [_] => 1.0,
                _ if c == 0.0 => 0.0,
                _ => measures[s] / c,
            };
            vec![unknown(true, &|_| [constant, 0.0]), unknown(false, &|s| [0.0, tension * share(s)])]
        }
    }
}
