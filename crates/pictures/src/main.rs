//! SVG from standard input as PDF or PNG on standard output.

#![forbid(unsafe_code)]

mod picture;

use picture::Format;
use std::ffi::OsString;
use std::io::{Read, Write};
use std::process::ExitCode;

const USAGE: &str = "\
Figures as PDF and PNG

Usage: springfit-pictures <pdf|png> < FIGURE.svg > PICTURE

Texts are set in DejaVu Sans. A PNG has 300 pixels an inch.

Exit codes:
  0  done
  2  an argument is wrong, or the figure cannot be read, converted or written; a line says what";

/// What the arguments ask for.
enum Request {
    Picture(Format),
    Print(String),
}

impl Request {
    fn of(arguments: &[OsString]) -> Result<Request, String> {
        let words: Vec<_> = arguments.iter().map(|word| word.to_string_lossy()).collect();
        match words.iter().map(AsRef::as_ref).collect::<Vec<&str>>()[..] {
            ["pdf"] => Ok(Request::Picture(Format::Pdf)),
            ["png"] => Ok(Request::Picture(Format::Png)),
            ["-h" | "--help"] => Ok(Request::Print(USAGE.into())),
            ["-V" | "--version"] => Ok(Request::Print(format!("springfit-pictures {}", env!("CARGO_PKG_VERSION")))),
            [] => Err("expected pdf or png, found no argument; --help says more".into()),
            _ => Err(format!("expected pdf or png, found {:?}; --help says more", words.join(" "))),
        }
    }
}

/// The whole picture is made before its first byte is written.
fn answer() -> Result<(), String> {
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let bytes = match Request::of(&arguments)? {
        Request::Print(text) => format!("{text}\n").into_bytes(),
        Request::Picture(format) => {
            let mut svg = Vec::new();
            std::io::stdin().read_to_end(&mut svg).map_err(|e| format!("the figure cannot be read: {e}"))?;
            format.bytes(&svg)?
        }
    };
    let mut output = std::io::stdout().lock();
    output
        .write_all(&bytes)
        .and_then(|()| output.flush())
        .map_err(|e| format!("standard output cannot be written: {e}"))
}

fn main() -> ExitCode {
    let Err(fault) = answer() else { return ExitCode::SUCCESS };
    // What is left to say if standard error is closed as well.
    let _ = writeln!(std::io::stderr(), "error: {fault}");
    ExitCode::from(2)
}
