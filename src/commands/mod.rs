//! The subcommands: each file has the arguments of one, with their help texts, and what it does.

mod calibrate;
mod check;
mod choice;
mod compare;
mod completions;
mod converge;
mod derive;
mod elements;
mod export;
mod fit;
mod fit_flags;
mod generate;
mod groups;
mod interrupt;
mod man;
mod materials;
mod matrix;
mod measure;
mod merge;
mod mesh_file;
mod new;
mod not_a_scene;
mod output;
mod paper;
mod plot;
mod referee;
mod run;
mod scene_file;
mod schema;
mod shipped;
mod stability;
mod state;
mod sweep;

pub use interrupt::answer as answer_interrupts;
pub use output::typed_as;

use crate::terminal::Terminal;
use clap::Subcommand;
use springfit_foundation::error::Result;
use std::process::{ExitCode, Termination};

/// One list of the subcommands: their names, and who runs them.
macro_rules! commands {
    ($($name:ident: $arguments:ty),+ $(,)?) => {
        #[derive(Subcommand)]
        pub enum Command {
            $($name($arguments)),+
        }

        impl Command {
            /// The exit code: 0, or 1 where the command found a fault that it was to look for.
            ///
            /// # Errors
            /// An input is wrong, or a file cannot be read or written.
            pub fn run(&self, terminal: &mut Terminal) -> Result<ExitCode> {
                match self {
                    $(Command::$name(arguments) => arguments.run(terminal).map(Termination::report)),+
                }
            }
        }
    };
}

/// Adds the help of the flags that are keys of a fit, which is made from their schema.
pub fn explained(program: clap::Command) -> clap::Command {
    program.mut_subcommands(|one| if one.get_name() == "fit" { fit_flags::FitFlags::explained(one) } else { one })
}

commands! {
    New: new::New,
    Run: run::Run,
    Fit: Box<fit::Fit>,
    Merge: merge::Merge,
    Calibrate: calibrate::Calibrate,
    Check: check::Check,
    Export: export::Export,
    Measure: Box<measure::Measure>,
    Matrix: Box<matrix::Matrix>,
    Derive: derive::Derive,
    Generate: generate::Generate,
    Compare: compare::Compare,
    Converge: converge::Converge,
    Sweep: sweep::Sweep,
    Plot: plot::Plot,
    Referee: referee::Referee,
    Paper: paper::Paper,
    Stability: stability::Stability,
    Elements: elements::Elements,
    Materials: materials::Materials,
    Groups: groups::Groups,
    Schema: schema::Schema,
    Completions: completions::Completions,
    Man: man::Man,
}
