//! What an export is: a row for each program, and its files.

use super::extent::check_numbers;
use super::relaxes::Relaxes;
use springfit_bodies::engine::{Engine, Setting};
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_foundation::file::write_whole;
use springfit_mesh::mesh::vtk::{self, Grid};
use springfit_report::report::{MeasureKind, NetworkRecord, SpringRecord, open_outputs};
use std::path::{Path, PathBuf};

/// A file by its name.
pub type NamedFile = (&'static str, Content);

/// What is in a file.
pub enum Content {
    /// Bytes as they are.
    Bytes(Vec<u8>),
    /// A grid, written as VTU.
    Grid(Box<Grid>),
}

impl Content {
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        match self {
            Content::Bytes(bytes) => write_whole(path, bytes),
            Content::Grid(grid) => vtk::write(path, grid),
        }
    }
}

/// Writes the files of an export into `folder`, and returns their paths.
///
/// # Errors
/// A file is one of the inputs, or would replace one of others; or it cannot be written. The folder is as it was.
pub fn write_files(files: &[NamedFile], folder: &Path, inputs: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    let mut edition = open_outputs(folder, &names, inputs)?;
    files.iter().try_for_each(|(name, content)| edition.write(name, |path| content.write(path)))?;
    edition.publish()
}

/// What a script in Python says where it takes in what scripts have in common, and that text: how bodies are loaded, come to rest and are judged;
/// and what a body remembers whose stress relaxes.
const COMMON: [[&str; 2]; 2] = [
    ["from settle import judge, keep_rest, seconds, settle, taken\n", include_str!("../../exports/settle.py")],
    ["from memory import Memory\n", include_str!("../../exports/memory.py")],
];

/// A script in Python, which stands alone: what scripts have in common is put where it is imported.
pub(super) fn script(text: &str) -> Content {
    let taken_in =
        |text: String, [import, rule]: [&str; 2]| text.replacen(import, &format!("\n\n{}\n\n", rule.trim_end()), 1);
    Content::Bytes(COMMON.into_iter().fold(text.to_string(), taken_in).into_bytes())
}

/// How a line that is not read begins, by the ending of a script.
const COMMENTS: [(&str, &str); 4] = [(".py", "# "), (".mjs", "// "), (".c", "// "), ("in.network", "# ")];

/// The files with these sentences at the top of their scripts.
pub fn with_warnings(mut files: Vec<NamedFile>, warnings: &[String]) -> Vec<NamedFile> {
    for (name, content) in &mut files {
        let comment = COMMENTS.iter().find(|(ending, _)| name.ends_with(ending));
        if let (Some((_, comment)), Content::Bytes(bytes)) = (comment, content) {
            let lines: String = warnings.iter().map(|words| format!("{comment}Beware: {words}.\n")).collect();
            bytes.splice(0..0, lines.into_bytes());
        }
    }
    files
}

/// Makes the files of a network with a gravity that may be given.
type Writer = fn(&NetworkRecord, Option<&[f64]>) -> Result<Vec<NamedFile>>;

/// Up to which deformation a program moves a body as the network would.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stands {
    /// The program has the energy of the network and moves the body as far as the network does.
    Network,
    /// The program ends its sweeps early: with the constants of equations that are solved it has a softer body.
    Truncated,
    /// Springs whose energy is quadratic in the square of their length, `k/(8 L²) (l² − L²)²`.
    SquaredLengths,
    /// The program does not move it.
    Still,
}

/// These are the engines of programs that show or pass on the numbers of a network, whatever they were fitted for.
pub(super) const EVERY_ENGINE: &[Engine] =
    &[Engine::Xpbd, Engine::Vbd, Engine::Jolt, Engine::NewtonXpbd, Engine::NewtonVbd];

/// A program that networks are written for.
pub struct Target {
    /// The word after `--to`.
    pub name: &'static str,
    /// The program and what it gets, in words.
    pub title: &'static str,
    /// What a user types in the folder; empty of files that are read by hand.
    pub command: &'static str,
    /// The damping that this program leaves out and others hold, in lines of words.
    pub(super) leaves_out: fn(&NetworkRecord) -> Vec<String>,
    /// Whether the loads of the scene are in its files.
    pub has_loads: bool,
    /// Whether springs on the volumes of hexahedra are divided for it into those of tetrahedra, which it holds wherever they are.
    pub(super) divides: bool,
    /// The engines whose constants it takes. Those of solved equations go to each program.
    pub(super) engines: &'static [Engine],
    /// What it does with stress that relaxes.
    pub(super) relaxes: Relaxes,
    /// Up to which deformation it moves the network.
    pub(super) stands: Stands,
    pub(super) write: Writer,
}

impl Target {
    /// The files of a network. `gravity` is in m/s², `[dimension]`; that of the network if it is absent, or 9.81 m/s² against the
    /// last axis.
    ///
    /// # Errors
    /// The gravity has another dimension; the constants belong to an engine that is not this program; a number is not finite in single precision; or the program does not hold the network: the error says what it holds and which fit has it.
    pub fn files(&self, network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
        gravity.map_or(Ok(()), |asked| self.check_gravity(network, asked))?;
        self.check_engine(network)?;
        self.relaxes.check(network)?;
        check_numbers(network, gravity)?;
        (self.write)(network, gravity)
    }

    /// That a gravity which is asked for has as many numbers as the network has dimensions.
    ///
    /// # Errors
    /// It has not.
    pub fn check_gravity(&self, network: &NetworkRecord, asked: &[f64]) -> Result<()> {
        if asked.len() != network.dimension {
            let expected = format!("{} numbers in m/s²", network.dimension);
            return Err(Error::expected("--gravity", expected, asked.len()));
        }
        Ok(())
    }

    /// That constants which belong to the settings of an engine go to this engine: anywhere else the body has another stiffness.
    fn check_engine(&self, network: &NetworkRecord) -> Result<()> {
        let Some(setting) = &network.engine else { return Ok(()) };
        setting.check().map_err(|e| e.under("engine"))?;
        if self.engines.contains(&setting.engine) {
            return Ok(());
        }
        let own = self.engines.iter().flat_map(|engine| [engine.name(), " or for "]).collect::<String>();
        let expected = format!("constants for {own}equations that are solved");
        let found = format!("constants for {}", setting.engine.name());
        let advice = "; --to npz passes them on to a program of your own, and a fit without an engine goes anywhere";
        Err(Error::expected("engine", expected, found).followed_by(advice).of_kind(ErrorKind::Unsupported))
    }

    /// That the constants are not those of this program, which ends its sweeps early.
    pub(super) fn is_softer(&self, network: &NetworkRecord) -> Option<String> {
        let engine = *self.engines.first().filter(|_| self.stands == Stands::Truncated && network.engine.is_none())?;
        Some(format!(
            "the constants are those of equations that are solved, and the body is softer where sweeps end early ({}): more substeps come closer, and \
             a fit with an engine has constants that answer like the body at its settings",
            Setting::usual(engine).words()
        ))
    }

    /// The damping that is left out, in lines of words. No program has Rayleigh's damping by the stiffness at rest.
    pub fn left_out(&self, network: &NetworkRecord) -> Vec<String> {
        let beta = network.damping.stiffness;
        let of_stiffness = (beta > 0.0).then(|| format!("Rayleigh's damping by stiffness, {beta:e} s, is left out"));
        (self.leaves_out)(network).into_iter().chain(of_stiffness).collect()
    }
}

pub(super) fn nothing(_: &NetworkRecord) -> Vec<String> {
    Vec::new()
}

/// That dampers are left out, if there are some.
pub(super) fn dampers(network: &NetworkRecord) -> Vec<String> {
    left_out(network, "springs", |_| true)
}

/// That dampers of springs on contents are left out, if there are some.
pub(super) fn content_dampers(network: &NetworkRecord) -> Vec<String> {
    left_out(network, "springs on contents", |spring| network.measures[spring.measure].kind == MeasureKind::Content)
}

/// That Rayleigh's damping by mass is left out, if there is some.
pub(super) fn mass_damping(network: &NetworkRecord) -> Vec<String> {
    let alpha = network.damping.mass;
    (alpha > 0.0).then(|| format!("Rayleigh's damping by mass, {alpha:e} 1/s, is left out")).into_iter().collect()
}

fn left_out(network: &NetworkRecord, of: &str, is_meant: impl Fn(&SpringRecord) -> bool) -> Vec<String> {
    let count = network.springs.iter().filter(|spring| spring.damper != 0.0 && is_meant(spring)).count();
    (count > 0).then(|| format!("{count} dampers of {of} are left out")).into_iter().collect()
}
