//! The languages in which functions are printed: one row of [`LANGUAGES`] for each, and one file for each or for dialects that differ little.

mod c;
mod javascript;
mod latex;
mod printer;
mod python;
mod rust;
mod syntax;
mod wgsl;

use super::code::Function;
use crate::error::Result;
use crate::unknown;
use printer::Printer;
use syntax::Syntax;

/// A language.
#[derive(Debug)]
pub struct LanguageRow {
    /// The name in options.
    pub name: &'static str,
    /// The endings of its files.
    pub endings: &'static [&'static str],
    /// The largest working memory of a function, in numbers.
    pub most_work: usize,
    syntax: &'static dyn Syntax,
}

/// Memory of a thread on common systems: 1 MiB of doubles in C and Rust, as little as 512 kB on a device.
const STACK: usize = 131_072;
const DEVICE: usize = 65_536;
/// Memory of an invocation of a shader.
const SHADER: usize = 4_096;

/// The languages.
pub const LANGUAGES: &[LanguageRow] = &[
    LanguageRow { name: "c", endings: &["h", "c", "hpp", "cpp", "cc"], most_work: STACK, syntax: &c::C },
    LanguageRow { name: "cuda", endings: &["cuh", "cu"], most_work: DEVICE, syntax: &c::CUDA },
    LanguageRow { name: "rust", endings: &["rs"], most_work: STACK, syntax: &rust::Rust },
    LanguageRow { name: "python", endings: &["py"], most_work: usize::MAX, syntax: &python::Python },
    LanguageRow { name: "javascript", endings: &["js", "mjs"], most_work: usize::MAX, syntax: &javascript::JavaScript },
    LanguageRow { name: "wgsl", endings: &["wgsl"], most_work: SHADER, syntax: &wgsl::Wgsl },
    LanguageRow { name: "glsl", endings: &["glsl", "comp"], most_work: SHADER, syntax: &c::GLSL },
    LanguageRow { name: "latex", endings: &["tex"], most_work: usize::MAX, syntax: &latex::Latex },
];

/// The languages that have room for so many numbers in a function.
pub fn languages_for(work: usize) -> Vec<&'static str> {
    LANGUAGES.iter().filter(|language| language.most_work >= work).map(|language| language.name).collect()
}

/// The language with this name.
///
/// # Errors
/// There is none.
pub fn language(name: &str) -> Result<&'static LanguageRow> {
    LANGUAGES.iter().find(|language| language.name == name).ok_or_else(|| {
        let names: Vec<&str> = LANGUAGES.iter().map(|language| language.name).collect();
        unknown(format!("one of {}", names.join(", ")), names, name).at_key("language")
    })
}

/// The language of files with this ending.
///
/// # Errors
/// There is none.
pub fn language_of(ending: &str) -> Result<&'static LanguageRow> {
    LANGUAGES.iter().find(|language| language.endings.contains(&ending)).ok_or_else(|| {
        let endings: Vec<&str> = LANGUAGES.iter().flat_map(|language| language.endings).copied().collect();
        unknown(format!("a language, or one of the endings {}", endings.join(", ")), endings, ending).at_key("language")
    })
}

/// The file with these functions.
pub fn print(language: &LanguageRow, prefix: &str, heading: &[String], functions: &[Function]) -> String {
    Printer::new(language.syntax, prefix).file(heading, functions)
}
