//! `springfit new`.

use super::mesh_file::MeshOptions;
use crate::terminal::Terminal;
use clap::Args;
use springfit::error::{Error, Result};
use springfit::study::draft;
use springfit::{check_file, write_whole};
use std::path::{Component, Path, PathBuf};
use std::process::ExitCode;

/// Write a commented scene for a mesh, which runs as it is
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct New {
    /// The mesh: .msh, .vtu or .vtk
    mesh: PathBuf,
    #[command(flatten)]
    options: MeshOptions,
    /// Where the scene goes; a file that is there is not replaced [default: standard output]
    #[arg(short, long, help_heading = "Output")]
    output: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  springfit new organ.msh -o organ.toml
  springfit new organ.msh --scale mm > organ.toml     # a mesh in millimetres
  springfit run organ.toml";

impl New {
    pub fn run(&self, terminal: &mut Terminal) -> Result<ExitCode> {
        if let Some(output) = &self.output {
            if output.symlink_metadata().is_ok() {
                return Err(Error::new("is there already and is not replaced: name another file").in_file(output));
            }
            check_file(output)?;
        }
        let mesh = self.options.mesh(&self.mesh)?;
        let folder = self.output.as_ref().and_then(|output| output.parent());
        let file = from_folder(&self.mesh, folder.unwrap_or(Path::new("")));
        let elements: Vec<String> =
            self.options.elements().iter().map(|name| own_file(name, folder.unwrap_or(Path::new("")))).collect();
        let title = self.mesh.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let text = draft(&mesh, &file.to_string_lossy(), self.options.unit(), &elements, &title);
        match &self.output {
            None => terminal.print(&text)?,
            Some(output) => {
                write_whole(output, text.as_bytes())?;
                terminal.written(std::slice::from_ref(output))?;
            }
        }
        Ok(ExitCode::SUCCESS)
    }
}

/// An element of `--element` as a scene in the folder names it.
fn own_file(name: &str, folder: &Path) -> String {
    let is_file = name.ends_with(".toml");
    if is_file { from_folder(Path::new(name), folder).to_string_lossy().into_owned() } else { name.to_string() }
}

/// The path of a file as a scene in the folder names it: relative where it can be.
fn from_folder(file: &Path, folder: &Path) -> PathBuf {
    if folder.as_os_str().is_empty() || file.is_absolute() {
        return file.to_path_buf();
    }
    let whole = |path: &Path| path.canonicalize().ok();
    let (Some(target), Some(start)) = (whole(file), whole(folder)) else { return file.to_path_buf() };
    let (target, start): (Vec<Component>, Vec<Component>) =
        (target.components().collect(), start.components().collect());
    let common = target.iter().zip(&start).take_while(|(a, b)| a == b).count();
    let up = start[common..].iter().map(|_| Component::ParentDir);
    up.chain(target[common..].iter().copied()).collect()
}
