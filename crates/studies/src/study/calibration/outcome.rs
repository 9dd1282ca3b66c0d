//! What a calibration has found.

use schemars::JsonSchema;
use serde::Serialize;

/// What a calibration has found.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
#[non_exhaustive]
pub struct CalibrationOutcome {
    /// The title of the scene.
    pub scene: String,
    /// `young`, `moduli` or `cells` was found.
    pub unknowns: String,
    /// Each entry is a region of the body. The list is empty where the unknowns are those of cells.
    pub regions: Vec<CalibratedRegion>,
    /// The unknowns have these names, in the order of the correlations.
    pub names: Vec<String>,
    /// The errors of two unknowns have this correlation by noise; it is null where they are not determined.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// The measurements hardly see these: one modulus alone, or several whose combination they do not see. Intervals reach beyond the factor 2.
    pub hardly_seen: Vec<String>,
    /// Each entry is a load whose measurements were used.
    pub loads: Vec<CalibratedLoad>,
    /// This many numbers were measured.
    pub measurements: usize,
    /// The sum of the squares of residuals over σ; it is null where the noise is not known.
    pub chi_square: Option<f64>,
    /// Measurements less unknowns.
    pub degrees_of_freedom: Option<usize>,
    /// Residuals are this many times as large as the noise; it is null where the noise is not known.
    pub misfit: Option<f64>,
    /// A body that the model describes has residuals as large as these, or larger, with this probability; it is null where the noise is not
    /// known.
    pub probability: Option<f64>,
    /// The body explains this share of the sum of the squares of what was measured, each over its noise, or where that is not known over the root
    /// mean square of its load.
    pub explained: f64,
    /// The residuals are more than noise: the model does not describe the body. Deviations by noise are multiplied by the misfit, as they are where it exceeds 3.
    pub is_unexplained: bool,
    /// Moduli and intervals are to be trusted: the search has reached its optimum, residuals are at most three times the stated noise, or without
    /// one the body explains three quarters of what was measured, and what is held was not measured to move.
    pub is_trusted: bool,
    /// Intervals are those by noise alone, without the error of the mesh.
    pub by_noise_alone: bool,
    /// The answers of the last two meshes differ by this share of the difference of the two before; it is null with fewer than three meshes.
    pub ratio: Option<f64>,
    /// Each entry is a mesh, from the one of the scene on.
    pub meshes: Vec<MeshStep>,
    /// Young's modulus of each cell of the mesh in Pa, by blocks, where the unknowns are those of cells.
    pub young_by_cell: Vec<f64>,
    /// The standard deviation of each, as a share of it, by noise with this prior, without the pull of the prior.
    pub deviation_by_cell: Vec<f64>,
    /// The prior of the field has this weight; it is null where the unknowns are those of regions.
    pub prior_weight: Option<f64>,
    /// The search has made this number of steps.
    pub steps: usize,
    /// The search has ended before the optimum.
    pub is_unfinished: bool,
    /// The calibration has taken this time in s.
    pub seconds: f64,
    /// Each note is a sentence for the reader.
    pub notes: Vec<String>,
}

/// The moduli of a region.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[non_exhaustive]
pub struct CalibratedRegion {
    /// The name of the entry of `[[material]]`.
    pub region: String,
    /// Whether its moduli were known.
    pub is_known: bool,
    /// The guess of Young's modulus is multiplied by this factor.
    pub factor: f64,
    /// Young's modulus, Pa; of a region in which the guess varies, that of its first cell.
    pub young: Value,
    /// Poisson's ratio.
    pub poisson: Value,
    /// The shear modulus μ, Pa.
    pub shear_modulus: Value,
    /// Lamé's first constant λ, Pa.
    pub lambda: Value,
}

/// A modulus with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[non_exhaustive]
pub struct Value {
    /// The value that was found.
    pub value: f64,
    /// The true one is in this interval with 95 %; it is null where the measurements do not determine it, and where it was known.
    pub interval: Option<[f64; 2]>,
    /// Noise causes this standard deviation, of the logarithm of E, μ and λ, and of Poisson's ratio itself.
    pub deviation: Option<f64>,
    /// The error of the meshes causes this one; it is null without a finer mesh.
    pub mesh_deviation: Option<f64>,
}

/// The residuals of a load.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[non_exhaustive]
pub struct CalibratedLoad {
    /// The name of the load.
    pub load: String,
    /// `displacements` or `forces` were measured.
    pub quantity: String,
    /// This many numbers were measured.
    pub measurements: usize,
    /// Their root mean square, m or N.
    pub size: f64,
    /// The root mean square of the residuals, m or N.
    pub residual: f64,
    /// The root mean square of the standard deviations of the noise, m or N; it is null where they are not known.
    pub sigma: Option<f64>,
    /// The root mean square of the residuals over the noise, whose expectation is 1.
    pub misfit: Option<f64>,
    /// This many displacements of what is held were measured, which no modulus moves; they are not among the measurements.
    pub held: usize,
    /// The largest distance of these from where it is held, m; it is null where none was measured.
    pub held_residual: Option<f64>,
}

/// A mesh of a calibration.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[non_exhaustive]
pub struct MeshStep {
    /// The number of its cells.
    pub cells: usize,
    /// The number of its degrees of freedom.
    pub unknowns: usize,
    /// Each unknown would change by this much from this mesh to the next one, in logarithms of E and in t of Poisson's ratio; empty for the last.
    pub changes: Vec<f64>,
}
