//! What the command line takes.

use clap::{Args, Parser, Subcommand, ValueEnum};
use springfit::fit::Solver;
use std::path::PathBuf;

/// Mass-spring models that answer like finite elements.
#[derive(Parser)]
#[command(version, about)]
pub struct CommandLine {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand)]
pub enum Command {
    /// Fit, solve and compare a scene
    Run(RunArguments),
    /// Fit the springs of a mesh, without a scene
    Fit(Box<FitArguments>),
    /// Prove element files: one line per property, exit code 1 if one fails
    Check(CheckArguments),
    /// Exact closed forms of an element's stiffness and spring constants
    Derive(DeriveArguments),
    /// Objectives and solvers side by side: error against run time, on random shapes of an element or on a scene
    Compare(CompareArguments),
    /// Run the experiments of the paper whose method this is, its printed figures beside ours
    Paper(PaperArguments),
    /// Try stiff and extreme cases: what came out beside twice the digits or closed forms; exit code 1 if an error is too large
    Stability(StabilityArguments),
}

#[derive(Args)]
pub struct StabilityArguments {
    /// A shipped element's name, an element file, or a scene [default: an element of each kind, bodies and motions]
    pub what: Option<String>,
    /// Where the table and the maps go [default: out/stability, or out/stability-NAME]
    #[arg(long)]
    pub out: Option<PathBuf>,
}

#[derive(Args)]
pub struct PaperArguments {
    /// Only this table, such as 1 or "figure 9"; may be repeated
    #[arg(long)]
    pub table: Vec<String>,
    /// Where the tables and figures go, and the scenes that were run [default: out/paper]
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// An index of experiments of your own, such as scenes/paper/index.toml
    #[arg(long)]
    pub index: Option<PathBuf>,
}

#[derive(Args)]
pub struct CheckArguments {
    /// Element files, folders of them, or names of shipped elements
    #[arg(required = true)]
    pub what: Vec<String>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct DeriveArguments {
    /// A shipped element's name, or an element file
    pub element: String,
    /// Lengths a, b, c along the axes as variables, instead of the reference cell
    #[arg(long)]
    pub sides: bool,
    /// Plane element: stress or strain, for the constants in terms of E and nu [default: stress]
    #[arg(long)]
    pub plane: Option<PlaneArgument>,
    /// Spring groups to use, separated by commas [default: all that are not optional]
    #[arg(long, value_delimiter = ',')]
    pub springs: Option<Vec<String>>,
    /// Print the stiffness matrix as well
    #[arg(long)]
    pub matrix: bool,
    /// Print LaTeX
    #[arg(long)]
    pub latex: bool,
}

#[derive(Args)]
pub struct CompareArguments {
    /// A shipped element's name, an element file, or a scene
    pub what: String,
    /// Random shapes of an element
    #[arg(long, default_value_t = 100)]
    pub shapes: usize,
    /// Iterations of the general optimisers
    #[arg(long, default_value_t = Solver::DEFAULT_ITERATIONS)]
    pub iterations: u64,
    /// Poisson's ratio, for an element
    #[arg(long, default_value_t = 0.3, allow_hyphen_values = true)]
    pub poisson: f64,
    /// An element at large deformation: the energy, a shipped name such as neo-hookean, or a file
    #[arg(long)]
    pub law: Option<String>,
    /// With --law, the largest stretch that is sampled
    #[arg(long, default_value_t = 0.35, allow_hyphen_values = true)]
    pub stretch: f64,
    /// Plane element: stress or strain [default: stress]
    #[arg(long)]
    pub plane: Option<PlaneArgument>,
    /// Where the tables and figures go [default: out/compare-NAME]
    #[arg(long)]
    pub out: Option<PathBuf>,
}

#[derive(Args)]
pub struct RunArguments {
    /// The scene file
    pub scene: PathBuf,
    /// Where the report goes [default: out/NAME of the scene]
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Where whole-object fits save their state, and what they go on from if it is there; Ctrl-C ends them at their best point
    #[arg(long)]
    pub checkpoint: Option<PathBuf>,
    /// Say which stages will run and which are left out, and stop
    #[arg(long)]
    pub explain: bool,
}

#[derive(Args)]
pub struct FitArguments {
    /// The mesh: .msh, .vtu or .vtk
    pub mesh: PathBuf,
    /// Young's modulus, such as 10kPa
    #[arg(long, allow_hyphen_values = true)]
    pub young: String,
    /// Poisson's ratio
    #[arg(long, allow_hyphen_values = true)]
    pub poisson: f64,
    /// frobenius, offdiag, modal, spectral, divergence, sampled, whole or a published method [default: offdiag with --nonnegative]
    #[arg(long)]
    pub objective: Option<String>,
    /// A group of the mesh that is held; may be repeated (whole only)
    #[arg(long)]
    pub fix: Vec<String>,
    /// Energy whose forces are sampled: a shipped name such as neo-hookean, or a file (sampled only)
    #[arg(long)]
    pub law: Option<String>,
    /// linear, free-rest, or a law of force such as "k1*s + k3*s^3" (sampled only)
    #[arg(long)]
    pub force: Option<String>,
    /// Largest amplitude of the sampled shapes [default: 0.3] (sampled only)
    #[arg(long, allow_hyphen_values = true)]
    pub stretch: Option<f64>,
    /// How many shapes to fit to [default: 300] (sampled only)
    #[arg(long)]
    pub shapes: Option<usize>,
    /// What counts: none, offdiag, modal or relative (with frobenius and spectral), none or relative (with sampled)
    #[arg(long)]
    pub weight: Option<String>,
    /// Scale of what is beyond constant strain (modal and sampled only)
    #[arg(long)]
    pub higher: Option<f64>,
    /// From 0, which errs to the soft side, to 1 (divergence only)
    #[arg(long)]
    pub balance: Option<f64>,
    /// Spring groups to use, separated by commas [default: all that are not optional]
    #[arg(long, value_delimiter = ',')]
    pub springs: Option<Vec<String>>,
    /// One constant per group
    #[arg(long)]
    pub tied: bool,
    /// No constant below zero
    #[arg(long)]
    pub nonnegative: bool,
    /// Plane mesh or surface: stress or strain [default: stress]
    #[arg(long)]
    pub plane: Option<PlaneArgument>,
    /// Plane mesh or surface: thickness in m [default: 1]
    #[arg(long, allow_hyphen_values = true)]
    pub thickness: Option<f64>,
    /// Mesh of lines: cross-section in m² [default: 1]
    #[arg(long, allow_hyphen_values = true)]
    pub area: Option<f64>,
    /// In kg/m³; gives the points masses
    #[arg(long, allow_hyphen_values = true)]
    pub density: Option<f64>,
    /// Mesh units to metres
    #[arg(long, default_value_t = 1.0, allow_hyphen_values = true)]
    pub scale: f64,
    /// What becomes of cells whose quality is below the least: warn, refuse or skip [default: warn]
    #[arg(long)]
    pub below: Option<String>,
    /// The least quality of a cell, from 0 for flat to 1 for right angles [default: 1e-4]
    #[arg(long)]
    pub least: Option<f64>,
    /// An element file to look in before the shipped ones; may be repeated
    #[arg(long)]
    pub element: Vec<String>,
    /// Where the springs go: .vtu, .json or .csv
    #[arg(short, long)]
    pub output: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
pub enum PlaneArgument {
    Stress,
    Strain,
}
