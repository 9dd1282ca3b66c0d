//! `springfit generate`.

use crate::terminal::Terminal;
use clap::Args;
use springfit_element::element::Element;
use springfit_foundation::error::{Error, Result};
use springfit_generate::generate::{LANGUAGES, Program, Recipe, language, language_of};
use std::path::PathBuf;

/// Write code that computes the springs of a cell at run time, for programs that cut, remesh or adapt
#[derive(Args)]
#[command(after_help = after_help())]
pub struct Generate {
    /// A shipped element's name, or an element file
    element: String,
    /// exact, offdiag, frobenius, modal, or a published method: those with direct solutions
    #[arg(long, default_value = "exact")]
    objective: String,
    #[arg(long, help = language_help())]
    language: Option<String>,
    /// Where volumes are measured: points or cells [default: points] (exact only)
    #[arg(long)]
    volume: Option<String>,
    /// Scale of what is beyond constant strain (modal only)
    #[arg(long)]
    higher: Option<f64>,
    /// Spring groups to use, separated by commas [default: all that are not optional] (not with exact)
    #[arg(long, value_delimiter = ',')]
    springs: Option<Vec<String>>,
    /// Also write a branch whose stress relaxes, and a step of it (exact only)
    #[arg(long)]
    relaxing: bool,
    /// Where the code goes [default: standard output]
    #[arg(short, long, help_heading = "Output")]
    output: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  springfit generate tet4 -o tet4_exact.h
  springfit generate hex8 --objective offdiag --language rust -o hex8_offdiag.rs
  springfit generate tri3 --objective modal --springs edge,bulk --language python
  springfit generate tet4 --language wgsl -o tet4_exact.wgsl
  springfit generate tet4 --relaxing -o tet4_relaxing.h

The file needs no other. Its functions give the moduli from Young's modulus and Poisson's ratio,
the spring constants from the positions of the nodes and the moduli, and the energy and the
forces of the network. WGSL and GLSL have single precision.
Published methods: van-gelder, van-gelder-simple, lloyd, lloyd-preserving, baudet,
baudet-corrected, delingette-quadratic, delingette-biquadratic";

fn after_help() -> String {
    let endings: Vec<String> =
        LANGUAGES.iter().flat_map(|language| language.endings).map(|ending| format!(".{ending}")).collect();
    format!("{EXAMPLES}\nEndings: {}", endings.join(" "))
}

fn language_help() -> String {
    let names: Vec<&str> = LANGUAGES.iter().map(|language| language.name).collect();
    format!("One of {} [default: by the ending of the file, otherwise c]", names.join(", "))
}

impl Generate {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        let ending = self.output.as_ref().and_then(|path| path.extension()).and_then(|ending| ending.to_str());
        let language = match (self.language.as_deref(), ending) {
            (Some(name), _) => language(name),
            (None, Some(ending)) => language_of(ending),
            (None, None) => language("c"),
        };
        let language = language.map_err(Error::of_option)?;
        let recipe = Recipe::named(&self.objective, self.volume.as_deref(), self.higher).map_err(Error::of_option)?;
        if let Some(output) = &self.output {
            let inputs: Vec<PathBuf> = vec![self.element.clone().into()];
            springfit_foundation::file::check_apart(std::slice::from_ref(output), &inputs)?;
            springfit_foundation::file::check_file(output)?;
        }
        let element = Element::load(&self.element)?;
        let program =
            Program::new(&element, self.springs.as_deref(), recipe).map_err(|e| e.placed(|e| self.of_option(e)))?;
        let program = match self.relaxing {
            true => program.with_branch(&element, recipe).map_err(Error::of_option)?,
            false => program,
        };
        let text = program.print(language).map_err(Error::of_option)?;
        match &self.output {
            Some(path) => springfit_foundation::file::write_whole(path, text.as_bytes()),
            None => terminal.print(&text),
        }
    }

    /// Moves a fault to the option that it is about: objectives name themselves, and what is wrong with an element names no option.
    fn of_option(&self, error: Error) -> Error {
        match error.key() {
            Some("higher") if self.higher.is_none() => error.at_key("--objective"),
            Some(key) if key == self.objective => error.at_key("--objective"),
            Some("springs" | "higher" | "volume" | "objective") => error.of_option(),
            _ => error,
        }
    }
}
