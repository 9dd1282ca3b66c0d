//! `springfit new`.

use super::mesh_file::MeshOptions;
use crate::terminal::Terminal;
use clap::Args;
use springfit_element::material::Material;
use springfit_foundation::error::{Error, Result};
use springfit_foundation::file::{check_file, write_whole};
use springfit_foundation::quantity::Quantity;
use springfit_foundation::range;
use springfit_foundation::text::{not_a_line, printable};
use springfit_mesh::mesh::{Mesh, listed_endings};
use springfit_studies::study::{DraftMaterial, DraftSource, DraftUnit, FillEntry, draft};
use std::path::{Component, Path, PathBuf};

/// Write a commented scene for a mesh, which runs as it is
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct New {
    #[arg(help = format!("The mesh: {}", listed_endings()))]
    mesh: PathBuf,
    /// Young's modulus, such as "5 kPa" [default: 10 kPa]
    #[arg(long, allow_hyphen_values = true, help_heading = "Material")]
    young: Option<String>,
    /// Poisson's ratio [default: 0.3]
    #[arg(long, allow_hyphen_values = true, help_heading = "Material")]
    poisson: Option<f64>,
    /// Density, such as "1060 kg/m^3"
    #[arg(long, allow_hyphen_values = true, help_heading = "Material")]
    density: Option<String>,
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
  springfit new organ.msh --young 5kPa --poisson 0.45 --density 1060 -o organ.toml
  springfit new organ.stl --scale mm --fill 4 -o organ.toml   # a closed surface, filled with cubes of 4 mm
  springfit new scan.stl --scale mm --points 1000 --repair -o scan.toml   # a damaged scan
  springfit run organ.toml";

impl New {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        if let Some(output) = &self.output {
            if output.symlink_metadata().is_ok() {
                return Err(Error::new("is there already and is not replaced: name another file").in_file(output));
            }
            check_file(output)?;
        }
        let mesh = self.options.mesh(&self.mesh)?;
        self.options.unit_note(&mesh).iter().for_each(|words| terminal.note(words));
        let folder = self.output.as_ref().and_then(|output| output.parent());
        let file = from_folder(&self.mesh, folder.unwrap_or(Path::new("")));
        let elements: Vec<String> =
            self.options.elements().iter().map(|name| own_file(name, folder.unwrap_or(Path::new("")))).collect();
        let title = self.mesh.file_stem().unwrap_or_default().to_string_lossy();
        let title = printable(&title);
        let unit = DraftUnit { text: self.options.unit(), scale: self.options.scale()?, space: self.options.space() };
        let file = file.to_string_lossy();
        if let Some(problem) = not_a_line(&file, false) {
            return Err(Error::new(format!("cannot be named in a scene: {problem}")).in_file(&self.mesh));
        }
        let here = folder.unwrap_or(Path::new(""));
        let fill = self
            .options
            .filling(Path::new(&*file))?
            .map(|fill| FillEntry { element: own_file(&fill.element, here), ..fill });
        let source = fill.as_ref().map_or(DraftSource::File(&file), DraftSource::Fill);
        let text = draft(&mesh, source, unit, &elements, &title, &self.material(&mesh)?);
        match &self.output {
            None => terminal.print(&text),
            Some(output) => {
                write_whole(output, text.as_bytes())?;
                terminal.written(std::slice::from_ref(output))
            }
        }
    }
}

impl New {
    /// The material that is given.
    ///
    /// # Errors
    /// A value is no quantity of its kind, or out of its range.
    fn material(&self, mesh: &Mesh) -> Result<DraftMaterial> {
        let parsed = |quantity: Quantity, option: &str, text: &Option<String>| {
            text.as_deref().map(|text| quantity.parse(text).map_err(|e| e.under(option))).transpose()
        };
        let young = parsed(Quantity::Pressure, "--young", &self.young)?;
        let density = parsed(Quantity::Density, "--density", &self.density)?;
        density.map_or(Ok(()), |density| range::positive("--density", density, "kg/m³").map(|_| ()))?;
        let (young, poisson) = (young.unwrap_or(10e3), self.poisson.unwrap_or(0.3));
        Material::for_body(mesh.cell_dimension(), young, poisson, None, None).map_err(Error::of_option)?;
        Ok(DraftMaterial { young: self.young.clone(), poisson: self.poisson, density: self.density.clone() })
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
