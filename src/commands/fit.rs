//! `springfit fit`.

use super::interrupt::end_early;
use super::state::State;
use crate::terminal::Terminal;
use clap::Args;
use springfit::error::{Error, Result};
use springfit::mesh::{Gate, Mesh, MeshSource, Selection};
use springfit::model::Support;
use springfit::quantity::Quantity;
use springfit::range;
use springfit::report::{self, NetworkFile, NetworkFormat};
use springfit::study::{
    BodyConstants, Controls, Event, FitEntry, NamedFit, Outcome, Reference, WholeBody, assumed, fit_mesh,
    load_elements, point_masses,
};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// Fit the springs of a mesh, without a scene
#[derive(Args)]
pub struct Fit {
    /// The mesh: .msh, .vtu or .vtk
    mesh: PathBuf,
    /// Young's modulus, such as 10kPa
    #[arg(long, allow_hyphen_values = true)]
    young: String,
    /// Poisson's ratio
    #[arg(long, allow_hyphen_values = true)]
    poisson: f64,
    /// exact, frobenius, offdiag, modal, spectral, divergence, sampled, whole or a published method [default: exact]. For programs
    /// with springs and volume constraints: exact. For those with classical springs alone, which rest at the lengths of the mesh:
    /// divergence, or offdiag with --nonnegative
    #[arg(long)]
    objective: Option<String>,
    /// The body's energy: stable-neo-hookean or neo-hookean [default: stable-neo-hookean] (exact only)
    #[arg(long)]
    energy: Option<String>,
    /// Where volumes are measured: points, cells or patches [default: points] (exact only)
    #[arg(long)]
    volume: Option<String>,
    /// A group of the mesh that is held; may be repeated (whole only)
    #[arg(long)]
    fix: Vec<String>,
    /// Energy whose forces are sampled: a shipped name such as neo-hookean, or a file (sampled only)
    #[arg(long)]
    law: Option<String>,
    /// linear, free-rest, or a law of force such as "k1*s + k3*s^3" (sampled only)
    #[arg(long)]
    force: Option<String>,
    /// Largest amplitude of the sampled shapes [default: 0.3] (sampled only)
    #[arg(long, allow_hyphen_values = true)]
    stretch: Option<f64>,
    /// How many shapes to fit to [default: 300] (sampled only)
    #[arg(long)]
    shapes: Option<usize>,
    /// What counts: none, offdiag, modal or relative (with frobenius and spectral), none or relative (with sampled)
    #[arg(long)]
    weight: Option<String>,
    /// Scale of what is beyond constant strain (modal and sampled only)
    #[arg(long)]
    higher: Option<f64>,
    /// From 0, which errs to the soft side, to 1 (divergence only)
    #[arg(long)]
    balance: Option<f64>,
    /// Spring groups to use, separated by commas [default: all that are not optional]
    #[arg(long, value_delimiter = ',')]
    springs: Option<Vec<String>>,
    /// One constant per group
    #[arg(long)]
    tied: bool,
    /// No constant below zero
    #[arg(long)]
    nonnegative: bool,
    /// Springs across the sides of cells where no others suffice (exact with --nonnegative only)
    #[arg(long)]
    across: bool,
    /// Rest measures: mesh, free or zero (frobenius, offdiag and modal only) [default: mesh]
    #[arg(long)]
    rest: Option<String>,
    /// Plane mesh or surface: stress or strain [default: stress]
    #[arg(long)]
    plane: Option<State>,
    /// Plane mesh or surface: thickness such as "0.5 mm" [default of plane meshes: 1 m; required for surfaces in space]
    #[arg(long, allow_hyphen_values = true)]
    thickness: Option<String>,
    /// Mesh of lines: cross-section such as "2 mm^2" [default: 1 m^2]
    #[arg(long, allow_hyphen_values = true)]
    area: Option<String>,
    /// Density such as "1060 kg/m^3"; gives the points masses
    #[arg(long, allow_hyphen_values = true)]
    density: Option<String>,
    /// Length of one mesh unit, such as mm or 0.001
    #[arg(long, default_value = "1", allow_hyphen_values = true)]
    scale: String,
    /// What becomes of cells whose quality is below the least: warn, refuse or skip [default: warn]. Cells that are flat or tangled,
    /// that have the nodes of another or are folded over their neighbours are left out with skip and refused otherwise
    #[arg(long)]
    below: Option<String>,
    /// The least quality of a cell, from 0 for flat to 1 for right angles [default: 1e-4]
    #[arg(long)]
    least: Option<f64>,
    /// An element file to look in before the shipped ones; may be repeated
    #[arg(long)]
    element: Vec<String>,
    /// Where the springs go: .vtu, .json or .csv
    #[arg(short, long)]
    output: PathBuf,
}

impl Fit {
    pub fn run(&self, terminal: &mut Terminal) -> Result<ExitCode> {
        let format = NetworkFormat::of(&self.output).map_err(|e| e.at_key("--output"))?;
        let elements = self.element.iter().chain(&self.law).map(PathBuf::from);
        let inputs: Vec<PathBuf> = [self.mesh.clone()].into_iter().chain(elements).collect();
        springfit::check_apart(std::slice::from_ref(&self.output), &inputs)?;
        springfit::check_file(&self.output)?;
        let given =
            |quantity: Quantity, key: &str, text: &str| quantity.parse(text).map_err(|e| e.under(format!("--{key}")));
        let asked =
            |quantity, key, text: &Option<String>| text.as_deref().map(|text| given(quantity, key, text)).transpose();
        let young = given(Quantity::Pressure, "young", &self.young)?;
        let named = self.named_fit()?;
        let scale = given(Quantity::MeshUnit, "scale", &self.scale)?;
        let density = asked(Quantity::Density, "density", &self.density)?;
        check(scale, density)?;
        let constants = BodyConstants {
            young,
            poisson: self.poisson,
            plane: self.plane.map(Into::into),
            thickness: asked(Quantity::Length, "thickness", &self.thickness)?,
            area: asked(Quantity::Area, "area", &self.area)?,
        };
        let whole = named.recipe.whole().is_some();
        let sampled = !whole && named.recipe.sampled().is_some();
        if whole == self.fix.is_empty() {
            let problem = match whole {
                true => "expected a group of the mesh that is held, which the objective \"whole\" requires, found none",
                false => "belongs to the objective \"whole\", found with another",
            };
            return Err(Error::at("--fix", problem));
        }
        if sampled && self.law.is_none() {
            let expected = "the energy whose forces the objective \"sampled\" samples, such as neo-hookean";
            return Err(Error::expected("--law", expected, "none"));
        }
        let mesh = self.mesh(scale)?;
        let material = constants.material(&mesh).map_err(Error::of_option)?;
        let assumed = assumed(&mesh, constants.thickness, constants.area);
        let support = self.support(&mesh)?;
        let controls = Arc::new(Controls::default());
        if whole {
            end_early(&controls);
        }
        let body = whole.then(|| WholeBody::new(&mesh, material, &support, &controls));
        let reference = Reference { whole: body.as_ref(), ..Reference::default() };
        let fit = fit_mesh(&mesh, material, &reference, &named, &mut |event: Event| terminal.show(event));
        let fit = fit.map_err(|e| e.placed(of_option))?;
        let masses = density.map(|density| point_masses(&mesh, density, material)).transpose().map_err(of_option)?;
        let outcome = Outcome::of_fit(self.mesh.display().to_string(), mesh, material, masses, fit);
        let outcome = Outcome { assumed, ..outcome };
        let (masses, notes) = (outcome.masses.as_deref(), report::notes(&outcome));
        // The file first: who reads the table may have gone away.
        let file = NetworkFile { mesh: &outcome.mesh, masses, fit: &outcome.fits[0], loads: &[], notes: &notes };
        format.write(&self.output, &file)?;
        terminal.print_outcome(&outcome)?;
        terminal.written(std::slice::from_ref(&self.output))?;
        Ok(ExitCode::SUCCESS)
    }

    /// What the options say of the fit.
    fn named_fit(&self) -> Result<NamedFit> {
        // The fit that gives the material itself; all others miss some of it on some meshes.
        let objective = self.objective.clone().unwrap_or("exact".into());
        let mut shapes = toml::Table::new();
        shapes.extend(self.shapes.map(|count| ("count".into(), (count as i64).into())));
        shapes.extend(self.stretch.map(|stretch| ("stretch".into(), stretch.into())));
        let entry = FitEntry::new(objective)
            .with_springs(self.springs.clone())
            .with("energy", self.energy.clone())
            .with("volume", self.volume.clone())
            .with("weight", self.weight.clone())
            .with("higher", self.higher)
            .with("balance", self.balance)
            .with("tied", self.tied.then_some(true))
            .with("nonnegative", self.nonnegative.then_some(true))
            .with("across", self.across.then_some(true))
            .with("rest", self.rest.clone())
            .with("force", self.force.clone())
            .with("shapes", Some(shapes).filter(|shapes| !shapes.is_empty()))
            .with("law", self.law.clone());
        Ok(entry.fits(Path::new("")).map_err(|e| e.placed(of_option))?.remove(0))
    }

    fn mesh(&self, scale: f64) -> Result<Mesh> {
        let own = load_elements(&self.element, Path::new("")).map_err(|e| e.placed(|e| e.at_key("--element")))?;
        let source = MeshSource::read(&self.mesh)?;
        let asked = self.below.is_some() || self.least.is_some();
        let gate = Gate::named(self.below.as_deref(), self.least).map_err(Error::of_option)?;
        let mesh = Mesh::resolve_within(&source, &own, scale, asked.then_some(gate));
        mesh.map_err(|e| e.in_file(&self.mesh))
    }

    /// The groups that are held.
    fn support(&self, mesh: &Mesh) -> Result<Support> {
        let mut support = Support::free(mesh);
        let directions: Vec<usize> = (0..mesh.dimension).collect();
        for group in &self.fix {
            let points = Selection::Group(group.clone()).points(mesh).map_err(|e| e.at_key("--fix"))?;
            support.fix(&points, &directions, mesh.dimension);
        }
        Ok(support)
    }
}

/// The same fault with the option that the key stands for, as it is typed.
fn of_option(error: Error) -> Error {
    let command = <Fit as Args>::augment_args(clap::Command::new("fit"));
    // Options have the last part of a key's path.
    let last = error.key().map(|key| key.rsplit('.').next().unwrap_or(key).to_string());
    match last.map(|name| if name == "count" { "shapes".to_string() } else { name }) {
        Some(name) if command.get_arguments().any(|argument| argument.get_long() == Some(&name)) => {
            error.at_key(format!("--{name}"))
        }
        _ => error,
    }
}

fn check(scale: f64, density: Option<f64>) -> Result<()> {
    range::positive("--scale", scale, "metres per mesh unit")?;
    density.map_or(Ok(()), |density| range::positive("--density", density, "kg/m³").map(|_| ()))
}
