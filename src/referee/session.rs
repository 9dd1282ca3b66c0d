//! A process in which an engine moves a body: a request in JSON on a line, and an answer on a line.

use super::engine::Engine;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_foundation::file::write_whole;
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The scripts, which stand alone in a folder.
const SCRIPTS: [(&str, &[u8]); 7] = [
    ("serve.py", include_bytes!("../../exports/referee/serve.py")),
    ("serve.mjs", include_bytes!("../../exports/referee/serve.mjs")),
    ("with_mujoco.py", include_bytes!("../../exports/referee/with_mujoco.py")),
    ("with_newton.py", include_bytes!("../../exports/referee/with_newton.py")),
    ("with_lammps.py", include_bytes!("../../exports/referee/with_lammps.py")),
    ("with_xpbd.py", include_bytes!("../../exports/referee/with_xpbd.py")),
    ("requirements.txt", include_bytes!("../../exports/requirements.txt")),
];

/// Writes the scripts of all engines into a folder that exists.
///
/// # Errors
/// A file cannot be written.
pub fn write_scripts(folder: &Path) -> Result<()> {
    SCRIPTS.iter().try_for_each(|(name, bytes)| write_whole(&folder.join(name), bytes))
}

/// What is asked of a body.
#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum Request<'a> {
    Open {
        folder: &'a Path,
        solver: &'a str,
        told: Option<[f64; 2]>,
        damping: f64,
    },
    /// N, of each point.
    Load(Vec<&'a [f64]>),
    /// Steps.
    Advance(usize),
}

#[derive(Deserialize)]
struct Hello {
    version: Option<String>,
    missing: Option<String>,
}

#[derive(Deserialize)]
struct Opened {
    step: f64,
}

#[derive(Deserialize)]
struct Loaded {}

/// Where a body is after some steps.
#[derive(Deserialize)]
pub struct Advanced {
    /// `[points][3]`, m; `None` if the motion has diverged.
    pub positions: Option<Vec<[f64; 3]>>,
    /// What the engine has warned of.
    pub warnings: Vec<String>,
}

/// An engine that waits for requests.
pub struct Session {
    child: Child,
    requests: ChildStdin,
    answers: BufReader<ChildStdout>,
    program: PathBuf,
    /// What the engine prints.
    log: PathBuf,
    /// The engine has this version.
    pub version: String,
    /// s; 0 before a body is opened.
    pub step: f64,
}

impl Session {
    /// Starts an engine, whose scripts are in `folder`.
    ///
    /// # Errors
    /// The interpreter cannot be started, or does not find the engine; the error says how it is installed.
    pub fn start(engine: &Engine, program: &Path, folder: &Path) -> Result<Session> {
        let log = folder.join(format!("{}.log", engine.name));
        // Into a file: a pipe that nobody reads would fill, and the engine would wait for ever.
        let said = File::create(&log).map_err(|e| Error::io("cannot be written", e).in_file(&log))?;
        // Compiled Python beside the scripts would be of no use.
        let mut command = Command::new(program);
        command.arg(folder.join(engine.interpreter.script())).arg(engine.name).env("PYTHONDONTWRITEBYTECODE", "1");
        let pipes = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(said);
        let option = engine.interpreter.option();
        let mut child = pipes.spawn().map_err(|e| {
            let words = format!("the program {} cannot be started, which runs {}", program.display(), engine.name);
            Error::io(format!("{option}: {words}"), e)
        })?;
        let requests = child.stdin.take().expect("it is piped");
        let answers = BufReader::new(child.stdout.take().expect("it is piped"));
        let program = program.to_path_buf();
        let mut session = Session { child, requests, answers, program, log, version: String::new(), step: 0.0 };
        let hello: Hello = session.answer()?;
        match (hello.version, hello.missing) {
            (Some(version), _) => session.version = version,
            (None, words) => {
                let words = words.unwrap_or_default();
                let program = session.program.display();
                let problem = format!("{} is not there for {program} ({words}): {}", engine.name, engine.install);
                return Err(
                    Error::new(format!("{problem}, or name another by {option}")).of_kind(ErrorKind::Unsupported)
                );
            }
        }
        Ok(session)
    }

    /// Opens the springs in `folder`, or elements of the engine if E and ν are told. Velocities fall at the rate `damping`, 1/s.
    ///
    /// # Errors
    /// The program ended.
    pub fn open(&mut self, folder: &Path, solver: &str, told: Option<[f64; 2]>, damping: f64) -> Result<()> {
        let opened: Opened = self.ask(&Request::Open { folder, solver, told, damping })?;
        if !(opened.step > 0.0 && opened.step.is_finite()) {
            return Err(self.broken(format!("a step of {} s", opened.step)));
        }
        self.step = opened.step;
        Ok(())
    }

    /// Puts the body back, under forces `[points · 3]`.
    ///
    /// # Errors
    /// The program ended.
    pub fn load(&mut self, forces: &[f64]) -> Result<()> {
        let Loaded {} = self.ask(&Request::Load(forces.chunks(3).collect()))?;
        Ok(())
    }

    /// Moves the body by so many steps.
    ///
    /// # Errors
    /// The program ended.
    pub fn advance(&mut self, steps: usize) -> Result<Advanced> {
        self.ask(&Request::Advance(steps))
    }

    fn ask<A: DeserializeOwned>(&mut self, request: &Request) -> Result<A> {
        let line = serde_json::to_string(request).expect("keys are text") + "\n";
        // If the program has ended, reading says why.
        let _ = self.requests.write_all(line.as_bytes()).and_then(|()| self.requests.flush());
        self.answer()
    }

    fn answer<A: DeserializeOwned>(&mut self) -> Result<A> {
        let mut line = String::new();
        match self.answers.read_line(&mut line) {
            Ok(0) => Err(self.ended()),
            Ok(_) => serde_json::from_str(&line).map_err(|_| self.broken(line.trim_end().chars().take(80).collect())),
            Err(e) => Err(Error::io(format!("{} cannot be read", self.program.display()), e)),
        }
    }

    fn broken(&self, found: String) -> Error {
        Error::new(format!("{}: expected an answer of the script, found {found}", self.program.display()))
    }

    /// The error of a program that has ended, with its last words.
    fn ended(&self) -> Error {
        let said = std::fs::read(&self.log).unwrap_or_default();
        let said = String::from_utf8_lossy(&said);
        let last = said.lines().rev().map(str::trim).find(|line| !line.is_empty()).unwrap_or("it said nothing");
        let last: String = last.chars().take(200).collect();
        Error::new(format!("{} ended early: {last}", self.program.display()))
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
