//! What fits to the whole object will take, and the finer body that they ask: counts of loads, times the solutions that each takes.

use super::rates::{ASSEMBLY, BYTES, COMPARED, ITERATED, SLOWEST_RATE, SOLUTIONS, SPARSE};
use crate::error::Result;
use crate::fit::{ShearSprings, VolumeSprings};
use crate::mesh::Mesh;
use crate::model::BlockStiffness;
use crate::solve::{FactorCost, dense_rate, factor_cost, factor_cost_of};
use springfit_scenes::{Start, ValidationRecipe, WholeRecipe, entries};
use std::collections::HashMap;

/// Loads that are made for a support: of each kind, in the plane and in space; varied ones; those that choose ρ where loads are not varied;
/// and those that no fit has seen.
// In the plane three stresses, one bending and two directions of gravity are made; in space six stresses, torsion, two
// bendings and three directions.
const MADE: [f64; 2] = [6.0, 12.0];
const VARIED: f64 = 16.0;
const RANDOM: f64 = 4.0;
const HELD_OUT: f64 = 30.0;
/// Solutions of the network for each ρ, over the number of loads to the power of 3/4: loads are solved side by side, and each step of a search
/// has some products of two solutions. Moduli take fewer than springs, and loads of each kind fewer than varied ones. Searches differ by a factor of
/// two to either side; measured on bodies of 150 to 2 000 points.
const SEARCH: f64 = 38.0;
const SEARCH_KINDS: f64 = 20.0;
const SEARCH_MODULI: f64 = 14.0;
const SIDE_BY_SIDE: f64 = 0.75;
/// Factors of the network for each ρ and support: that of each step, and of each that is tried.
const STEPS: f64 = 8.0;
/// The parts of a network are passed once for each solution: seconds for an entry of their stiffnesses.
const PASSED: f64 = 1e-9;
/// Exact networks beside which a fit is compared, and the network before and after it.
const NETWORKS: f64 = 5.0;
/// Solutions for a load of the finer body with its refinement, which most do not need.
const REFINED: f64 = 1.5;
/// Iterations on quadratic cells take so many times as long.
const QUADRATIC: f64 = 2.0;

/// The loads of the fits to the whole object under a support of the finer body.
struct Loads {
    trained: f64,
    validating: f64,
    held_out: f64,
    is_varied: bool,
    /// Supports of the fit, and all.
    supports: [f64; 2],
}

impl Loads {
    fn of(recipe: &WholeRecipe, mesh: &Mesh, is_finer: bool) -> Loads {
        let count = |supports: &[Vec<String>]| supports.len() as f64;
        let fitted = count(&recipe.supports).max(1.0);
        let consulted = if recipe.validation_supports.is_empty() { fitted } else { count(&recipe.validation_supports) };
        let is_varied = is_finer || !recipe.supports.is_empty() || !recipe.validation_supports.is_empty();
        let made = MADE[usize::from(mesh.dimension == 3)] + if is_varied { VARIED } else { 0.0 };
        let trained = recipe.loads.names.len() as f64 + if recipe.loads.made { fitted * made } else { 0.0 };
        let validating = match &recipe.validation {
            ValidationRecipe::Loads(loads) => {
                let drawn = if is_varied { VARIED } else { RANDOM };
                loads.names.len() as f64 + if loads.made { consulted * drawn } else { 0.0 }
            }
            // Each load is left out of a path of its own.
            ValidationRecipe::LeaveOneOut => trained * trained,
            ValidationRecipe::Discrepancy | ValidationRecipe::None => 0.0,
        };
        let has_others = is_finer || !recipe.supports.is_empty() || !recipe.other_supports.is_empty();
        // Supports that choose ρ are often those of the fit.
        let all = fitted.max(consulted) + count(&recipe.other_supports);
        let held_out = if has_others { all * HELD_OUT } else { 0.0 };
        Loads { trained, validating, held_out, is_varied, supports: [fitted, all] }
    }
}

/// The factor of the stiffness of the network of a fit, and the entries of the stiffnesses of its parts.
fn network_cost(recipe: &WholeRecipe, mesh: &Mesh) -> Result<(FactorCost, f64)> {
    let (edges, patches) = match &recipe.start {
        Start::Exact(shear, volume) => (*shear == ShearSprings::Edges, *volume == VolumeSprings::Patches),
        Start::Fit(_) | Start::Sampled(_) | Start::Equal => (false, false),
    };
    let cells = || mesh.blocks.iter().flat_map(|block| block.cells());
    let square = |nodes: &[usize]| ((nodes.len() * mesh.dimension) as f64).powi(2);
    let mut parts = if edges { 0.0 } else { entries(mesh) };
    let mut domains: Vec<Vec<usize>> = Vec::new();
    if edges {
        let mut around: HashMap<[usize; 2], Vec<usize>> = HashMap::new();
        for cell in cells() {
            let pairs = cell.iter().flat_map(|&a| cell.iter().map(move |&b| [a, b])).filter(|[a, b]| a < b);
            pairs.for_each(|pair| around.entry(pair).or_default().extend_from_slice(cell));
        }
        domains.extend(around.into_values());
    }
    if patches {
        let mut around: Vec<Vec<usize>> = vec![Vec::new(); mesh.point_count()];
        cells().for_each(|cell| cell.iter().for_each(|&p| around[p].extend_from_slice(cell)));
        domains.extend(around);
    }
    for domain in &mut domains {
        domain.sort_unstable();
        domain.dedup();
    }
    parts += domains.iter().map(|domain| square(domain)).sum::<f64>();
    let coupled = domains.iter().map(Vec::as_slice).chain(cells());
    Ok((factor_cost_of(&mesh.points, mesh.dimension, coupled)?, parts))
}

/// Seconds of one factorisation and of one solution.
fn seconds(factor: FactorCost) -> [f64; 2] {
    let rate = SPARSE * dense_rate();
    let factorisation = if factor.operations < SLOWEST_RATE { 0.0 } else { factor.operations / rate };
    // A solution reads the factor forward and backward.
    [factorisation, 2.0 * factor.entries / SOLUTIONS]
}

/// What a fit takes, without the finer body.
pub(super) struct WholeCost {
    pub seconds: f64,
    pub bytes: f64,
    /// Entries of the stiffness of the network, of its lower triangle.
    pub entries: f64,
}

/// A fit at small deformation whose equations are solved with factors.
///
/// # Errors
/// The analysis does not fit into memory.
pub(super) fn of_fit(recipe: &WholeRecipe, mesh: &Mesh, is_finer: bool) -> Result<WholeCost> {
    let Loads { trained, validating, held_out, is_varied, supports: [fitted, all] } = Loads::of(recipe, mesh, is_finer);
    let (cost, parts) = network_cost(recipe, mesh)?;
    let [factorisation, solution] = seconds(cost);
    let stages = recipe.settings.regularizations.len() as f64;
    let product = solution + PASSED * parts;
    let of_loads = match (recipe.unknowns.moduli(), is_varied || !recipe.loads.made) {
        (Some(_), _) => SEARCH_MODULI,
        (None, true) => SEARCH,
        (None, false) => SEARCH_KINDS,
    };
    let solutions = of_loads * trained.powf(SIDE_BY_SIDE);
    let search = stages * (solutions * product + STEPS * fitted * (factorisation + ASSEMBLY * parts));
    let judged = stages * validating * solution;
    let compared = NETWORKS * (all * factorisation + held_out * solution);
    // A factor is kept for each support of the fit, in numbers of eight bytes. The lower triangle alone of the parts is
    // assembled.
    let bytes = 8.0 * (fitted * cost.entries + parts) + BYTES * parts / 2.0;
    Ok(WholeCost { seconds: search + judged + compared, bytes, entries: parts / 2.0 })
}

/// The finer body: the loads of the scene, and those that its fits to the whole object ask for; its equations are solved by iterations, or with
/// factors.
///
/// # Errors
/// The analysis does not fit into memory.
pub(super) fn of_finer<'a>(
    (fine, iterates): (&Mesh, bool),
    loads: usize,
    recipes: impl Iterator<Item = &'a WholeRecipe>,
) -> Result<[f64; 2]> {
    // Fits of the same scene ask for the same loads, unless their supports are others.
    let (mut supports, mut solved) = (f64::from(u8::from(loads > 0)), loads as f64);
    for recipe in recipes {
        let Loads { trained, validating, held_out, supports: [_, all], .. } = Loads::of(recipe, fine, true);
        supports = supports.max(all);
        solved = solved.max(loads as f64 + trained + validating + held_out);
    }
    if iterates {
        let is_linear = fine.blocks.iter().all(|block| block.element.has_corners_alone());
        let each = if is_linear { ITERATED } else { QUADRATIC * ITERATED };
        let seconds = fine.points.len() as f64 * (supports * COMPARED + solved * each);
        return Ok([seconds, BlockStiffness::expected_bytes(fine, 1, 1) as f64]);
    }
    let cost = factor_cost(fine)?;
    let [factorisation, solution] = seconds(cost);
    let each = factorisation + ASSEMBLY * entries(fine);
    Ok([supports * each + solved * REFINED * solution, BYTES * entries(fine) + 8.0 * supports * cost.entries])
}
