//! What comes out of a scene.

use super::frequencies::FrequencyOutcome;
use super::gauge::Reading;
use super::metrics::DisplacementError;
use super::moduli::EffectiveModuli;
use super::motion::MotionOutcome;
use super::scene::NamedFit;
use crate::fit::Spread;
use crate::fit::published::Unmet;
use crate::material::Material;
use crate::mesh::Mesh;
use crate::model::Network;
use crate::solve::{Ending, Stability};

/// What came out of a scene.
#[derive(Debug)]
pub struct Outcome {
    pub scene: String,
    pub mesh: Mesh,
    pub material: Material,
    /// `[points]`, kg, where the scene gives a density.
    pub masses: Option<Vec<f64>>,
    /// Displacements of the finite elements, one per load, `[points · dimension]`, m.
    pub fem: Vec<Vec<f64>>,
    /// Where the material has a law, what it is called, and how far the finite elements followed each load.
    pub law: Option<String>,
    pub followed: Vec<Followed>,
    /// What was measured: errors under these loads are those from it.
    pub measured: Vec<MeasuredLoad>,
    /// What the scene's gauge says of the finite elements under each load; empty without a gauge.
    pub gauged: Vec<Option<Reading>>,
    pub fits: Vec<FitOutcome>,
    /// Where the scene has a motion.
    pub motion: Option<MotionOutcome>,
    /// Of the finite elements and of each network, where the scene asks for them.
    pub frequencies: Vec<FrequencyOutcome>,
    /// What the scene did not ask for and was not done.
    pub left_out: Vec<String>,
}

#[derive(Debug)]
pub struct FitOutcome {
    pub fit: NamedFit,
    pub network: Network,
    /// For the constants of all cells, without assembly.
    pub seconds: f64,
    pub seconds_assembly: f64,
    /// Cells whose springs the objective does not determine.
    pub deficient: usize,
    /// Cells whose iteration did not reach its end.
    pub unreached: usize,
    /// Cells that took over the constants of one of the same shape.
    pub reused: usize,
    /// Cells whose spectral optimum is not unique.
    pub ambiguous: usize,
    /// The largest relative duality gap, where the objective has certificates.
    pub gap: Option<f64>,
    /// Where `(1 − ε) R ⪯ K ⪯ (1 + ε) R` holds in every cell with ε < 1: the relative error of the model's energy.
    pub energy_error: Option<f64>,
    /// Of the elements' matrices; `None` for whole-object fits, whose springs belong to no element.
    pub frobenius: Option<Spread>,
    pub spectral: Option<Spread>,
    /// What the network is as a material, where the scene asks for it: under linear displacements of its boundary.
    pub moduli: Option<EffectiveModuli>,
    /// Of a published method: what it takes for granted and does not find.
    pub unmet: Option<Unmet>,
    /// Of a sampled fit.
    pub sampled: Option<SampledOutcome>,
    /// Of a whole-object fit; its springs belong to no element, so that there are no matrix errors.
    pub whole: Option<WholeOutcome>,
    /// With the support of the first load; `None` without loads.
    pub stability: Option<Stability>,
    /// Points that move in the softest motion, at least half as far as the one that moves most.
    pub loose_points: Vec<usize>,
    pub loads: Vec<LoadOutcome>,
}

#[derive(Debug)]
pub struct LoadOutcome {
    pub name: String,
    /// Displacements of the network, `[points · dimension]`, m; `None` where it does not stand.
    pub displacement: Option<Vec<f64>>,
    /// `None` where the network does not stand or nothing moves.
    pub error: Option<DisplacementError>,
    /// To assemble, factorise and solve, each as if this were the only load.
    pub seconds_fem: f64,
    pub seconds_lem: f64,
    /// At large deformation, how far the network followed the load.
    pub followed: Option<Followed>,
    /// What the scene's gauge says of the network.
    pub gauged: Option<Reading>,
}

/// A load under which displacements were measured.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredLoad {
    pub name: String,
    /// Points of which something is known.
    pub points: usize,
    /// Of the finite elements.
    pub error: Option<DisplacementError>,
}

/// How far an equilibrium was followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Followed {
    pub ending: Ending,
    /// The share of the load reached.
    pub load: f64,
    /// The last residual, relative to the forces that act.
    pub residual: f64,
    pub iterations: usize,
    /// Iterations whose tangent was not positive definite and had to be shifted.
    pub shifted: usize,
    /// Cells that are turned inside out at a quadrature point.
    pub inverted: usize,
}

/// What a whole-object fit has seen, and what it did.
#[derive(Debug, Clone, PartialEq)]
pub struct WholeOutcome {
    /// The loads that were fitted, and those that chose the regularization.
    pub loads: Vec<String>,
    pub validated: Vec<String>,
    /// `None` where the start was best.
    pub regularization: Option<f64>,
    /// The loads of the fit, and those that chose the regularization.
    pub fitted: Vec<FittedLoad>,
    pub judged: Vec<FittedLoad>,
    /// `ω_i/ω̄_i − 1` of the frequencies that were fitted, before and after.
    pub frequencies: [Vec<f64>; 2],
    /// The largest factor by which a constant changed.
    pub change: f64,
    /// The largest constant of a length spring, as a multiple of the least.
    pub range: f64,
    /// Whether a smaller ρ was left because the range would have been too large.
    pub limited: bool,
    pub steps: usize,
    /// Whether the network stands under every load at the start; else it is left as it is.
    pub stands: bool,
    /// Whether it was ended before its time.
    pub cancelled: bool,
}

/// `‖u_l − ū_l‖/‖ū_l‖` of a load before and after a whole-object fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedLoad {
    pub name: String,
    pub before: f64,
    pub after: f64,
}

/// How a sampled fit meets the forces, `√(Σ w ‖f − K‖²/Σ w ‖f‖²)` over the cells.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledOutcome {
    pub shapes: usize,
    pub trained: Spread,
    /// `None` where no shapes were held out.
    pub held_out: Option<Spread>,
    /// The least share of starts that found the best parameters, where there were several.
    pub agreeing: Option<f64>,
    /// Loads of the scene whose shapes were sampled: their errors are not held out.
    pub loads: Vec<String>,
}

impl Outcome {
    /// The outcome of one fit without loads.
    pub fn of_fit(name: String, mesh: Mesh, material: Material, masses: Option<Vec<f64>>, fit: FitOutcome) -> Outcome {
        let (fem, law, followed, measured, gauged, motion, frequencies, left_out) = Default::default();
        Outcome {
            scene: name,
            mesh,
            material,
            masses,
            fem,
            law,
            followed,
            measured,
            gauged,
            fits: vec![fit],
            motion,
            frequencies,
            left_out,
        }
    }
}
