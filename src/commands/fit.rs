//! `springfit fit`.

use super::fit_flags::FitFlags;
use super::interrupt;
use super::mesh_file::MeshOptions;
use super::output::{OutputOptions, command};
use super::state::State;
use crate::terminal::Terminal;
use clap::{Args, ValueEnum};
use springfit_bodies::model::{Support, is_exact, length_shares};
use springfit_element::element::SpringKind;
use springfit_element::material::{CellMap, Material, MaterialMap, Moduli};
use springfit_fit::fit::VolumeSprings;
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_foundation::file::Sum;
use springfit_foundation::quantity::Quantity;
use springfit_foundation::range;
use springfit_mesh::mesh::{Mesh, MeshSource, Selection, listed_endings};
use springfit_report::report::{self, NetworkFile, NetworkFormat, NetworkShard, Shard, ShardRun};
use springfit_studies::study::{
    BodyConstants, Controls, Event, FitEntry, Forecast, NamedFit, Outcome, Recipe, Reference, Stated, WholeBody,
    assumed, fit_mesh, fit_some, fit_without_errors, point_masses,
};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Fit the springs of a mesh, without a scene
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Fit {
    #[arg(help = format!("The mesh: {}", listed_endings()))]
    mesh: PathBuf,
    /// Print what would be done, with estimates of time and memory, and stop
    #[arg(long)]
    explain: bool,
    /// Young's modulus, such as 10kPa
    #[arg(long, allow_hyphen_values = true, help_heading = "Material")]
    young: String,
    /// Poisson's ratio
    #[arg(long, allow_hyphen_values = true, help_heading = "Material")]
    poisson: f64,
    /// exact, frobenius, offdiag, modal, spectral, divergence, sampled, whole, or a published method, which are listed below
    /// [default: exact]. If your program has volume constraints, use exact. If it has only springs whose rest lengths are those of the
    /// mesh, use divergence, or offdiag with --nonnegative
    #[arg(long, help_heading = "Fit")]
    objective: Option<String>,
    #[command(flatten)]
    keys: FitFlags,
    /// A group of the mesh that is held; may be repeated (whole, and exact with volume springs on patches)
    #[arg(long, help_heading = "Whole-object fits")]
    fix: Vec<String>,
    /// Plane mesh or surface: stress or strain [default: stress]
    #[arg(long, help_heading = "Material")]
    plane: Option<State>,
    /// Plane mesh or surface: thickness such as "0.5 mm" [default of plane meshes: 1 m; required for surfaces in space]
    #[arg(long, allow_hyphen_values = true, help_heading = "Material")]
    thickness: Option<String>,
    /// Mesh of lines: cross-section such as "2 mm^2" [default: 1 m^2]
    #[arg(long, allow_hyphen_values = true, help_heading = "Material")]
    area: Option<String>,
    /// Density such as "1060 kg/m^3"; gives the points masses
    #[arg(long, allow_hyphen_values = true, help_heading = "Material")]
    density: Option<String>,
    #[command(flatten)]
    options: MeshOptions,
    /// Fit the NUMBER-th of COUNT ranges of cells only, into a file that ends in .shard; springfit merge makes one network of all
    #[arg(long, value_name = "NUMBER/COUNT", help_heading = "Fit")]
    shard: Option<String>,
    /// Leave out the errors of the elements' matrices, which take up to half of the time
    #[arg(long, help_heading = "Output")]
    no_errors: bool,
    /// Print the compliances 1/k as well, which engines of position-based dynamics take
    #[arg(long, help_heading = "Output", conflicts_with_all = ["json", "table", "shard"])]
    compliance: bool,
    /// Where the springs go: .json with all that is known of them, .npz, .csv or .vtu
    #[arg(short, long, help_heading = "Output")]
    output: PathBuf,
    #[command(flatten)]
    format: OutputOptions,
}

/// Points of a body whose longest step is found a second time, to be told.
// In space the 120 vectors of Lanczos' method are made orthogonal to each other by some 2e9 operations, about a second.
const FEW: usize = 20_000;

const EXAMPLES: &str = "\
Examples:
  springfit fit organ.msh --young 10kPa --poisson 0.45 -o springs.vtu
  springfit fit organ.msh --young 10kPa --poisson 0.45 --shear edges --volume patches -o k.json
  springfit fit organ.msh --young 10kPa --poisson 0.3 --objective divergence -o springs.json
  springfit fit organ.msh --scale mm --young 10kPa --poisson 0.3 -o springs.csv --explain

Published methods, for --objective:
  van-gelder, van-gelder-simple    Van Gelder (1998): triangles, tetrahedra
  lloyd, lloyd-preserving          Lloyd et al. (2007): triangles, quadrilaterals, tetrahedra
  baudet, baudet-corrected         Baudet et al. (2007, 2009): rectangles, bricks
  delingette-quadratic             Delingette (2008): triangles, tetrahedra
  delingette-biquadratic           the same
  maciel-uniform                   Maciel et al. (2003)";

impl Fit {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        let shard = self.shard.as_deref().map(Shard::parse).transpose()?;
        let format = match shard {
            Some(_) => None,
            None => Some(NetworkFormat::of(&self.output).map_err(|e| e.at_key("--output"))?),
        };
        if shard.is_some() && self.output.extension().is_none_or(|ending| ending != "shard") {
            let expected = "a file ending in .shard with --shard";
            return Err(Error::expected("--output", expected, self.output.display()).of_kind(ErrorKind::Unsupported));
        }
        let elements = self.options.elements().iter().chain(&self.keys.law).map(PathBuf::from);
        let inputs: Vec<PathBuf> = MeshSource::files(&self.mesh).into_iter().chain(elements).collect();
        springfit_foundation::file::check_apart(std::slice::from_ref(&self.output), &inputs)?;
        springfit_foundation::file::check_file(&self.output)?;
        let given =
            |quantity: Quantity, key: &str, text: &str| quantity.parse(text).map_err(|e| e.under(format!("--{key}")));
        let asked =
            |quantity, key, text: &Option<String>| text.as_deref().map(|text| given(quantity, key, text)).transpose();
        let young = given(Quantity::Pressure, "young", &self.young)?;
        let named = self.named_fit()?;
        self.options.scale()?;
        let density = asked(Quantity::Density, "density", &self.density)?;
        density.map_or(Ok(()), |density| range::positive("--density", density, "kg/m³").map(|_| ()))?;
        let constants = BodyConstants {
            young,
            poisson: self.poisson,
            plane: self.plane.map(Into::into),
            thickness: asked(Quantity::Length, "thickness", &self.thickness)?,
            area: asked(Quantity::Area, "area", &self.area)?,
        };
        let whole = named.recipe.whole().is_some();
        let sampled = !whole && named.recipe.sampled().is_some();
        let patches = matches!(&named.recipe, Recipe::Exact(recipe) if recipe.volume == VolumeSprings::Patches);
        match (whole || patches, self.fix.is_empty()) {
            (true, true) if whole => {
                let problem =
                    "expected a group of the mesh that is held, which the objective \"whole\" requires, found none";
                return Err(Error::at("--fix", problem));
            }
            (false, false) => {
                let problem = "belongs to the objective \"whole\" and to --volume patches, found with another fit";
                return Err(Error::at("--fix", problem));
            }
            (true, true) => terminal.note(
                "no point is held: patches of points that will be held lock as cells do; --fix names the groups that hold them",
            ),
            _ => {}
        }
        if sampled && self.keys.law.is_none() {
            let expected = "the energy whose forces the objective \"sampled\" samples, such as neo-hookean";
            return Err(Error::expected("--law", expected, "none"));
        }
        let mesh = self.options.mesh(&self.mesh)?;
        let material = constants.material(&mesh).map_err(Error::of_option)?;
        let (thickness, area) = (Stated::once(constants.thickness), Stated::once(constants.area));
        let assumed = assumed(&mesh, thickness, area).or_else(|| self.options.unit_note(&mesh));
        let support = (!self.fix.is_empty()).then(|| self.support(&mesh)).transpose()?;
        let forecast = Forecast::of_fits(&mesh, material, std::slice::from_ref(&named), None);
        if self.explain {
            let title = self.mesh.display().to_string();
            return self.format.print_plan(terminal, &forecast, || report::forecast_text(&title, &forecast, &[]));
        }
        let Some(format) = format else {
            let shard = shard.unwrap_or(Shard::WHOLE);
            return self.fit_shard(terminal, shard, &mesh, material, &named);
        };
        forecast.announcement().iter().for_each(|words| terminal.note(words));
        let controls = Arc::new(Controls::default());
        if whole {
            interrupt::end_early(&controls);
        }
        let body =
            support.as_ref().filter(|_| whole).map(|support| WholeBody::new(&mesh, material, support, &controls));
        let d = mesh.dimension;
        let held: Vec<bool> = support
            .as_ref()
            .map_or(Vec::new(), |support| (0..mesh.point_count()).map(|point| support.is_fixed(point * d)).collect());
        let reference = Reference { whole: body.as_ref(), held: &held, ..Reference::default() };
        let told = &mut |event: Event| terminal.show(event);
        let fit = match self.no_errors {
            false => fit_mesh(&mesh, material, &reference, &named, told),
            true => fit_without_errors(&mesh, &material.into(), &reference, &named, told).map(|(fit, _)| fit),
        };
        let fit = fit.map_err(|e| e.placed(|e| self.of_option(e)))?;
        let masses =
            density.map(|density| point_masses(&mesh, density, material)).transpose().map_err(|e| self.of_option(e))?;
        let material = MaterialMap::from(material).with_density(density.map(CellMap::Uniform));
        let outcome = Outcome::of_fit(self.mesh.display().to_string(), mesh, material, masses, fit);
        let outcome = Outcome { assumed, command: Some(command()), ..outcome };
        // The file first: who reads the table may have gone away.
        format.write(&self.output, &NetworkFile::of(&outcome, &outcome.fits[0]))?;
        self.format.print_outcome(terminal, &outcome)?;
        if self.compliance {
            terminal.print(&format!("\n{}", report::compliances(&outcome.fits[0].network).titled_text()))?;
        }
        // A larger body has it in its file alone.
        let is_told = outcome.mesh.point_count() <= FEW;
        let step = is_told.then(|| NetworkFile::of(&outcome, &outcome.fits[0]).longest_step()).flatten();
        if let Some(step) = step {
            terminal.note(&format!("the longest stable explicit step is {step:.3e} s, without damping"));
        }
        if outcome.masses.is_some() && format.ending == "csv" {
            terminal.note("a CSV file has no masses and no places of points; .json and .npz have both");
        }
        terminal.written(std::slice::from_ref(&self.output))?;
        // The program ends: the system takes its memory back at once, not spring by spring.
        std::mem::forget(outcome);
        Ok(())
    }

    /// Fits one range of cells, and writes what it gives to the springs.
    fn fit_shard(
        &self,
        terminal: &mut Terminal,
        shard: Shard,
        mesh: &Mesh,
        material: Material,
        named: &NamedFit,
    ) -> Result<()> {
        let cells = mesh.cell_count();
        if shard.count > cells {
            return Err(Error::expected("--shard", format!("at most {cells} shards, one for each cell"), shard.count));
        }
        let range = shard.range(cells);
        let own = mesh.of_range(range.clone());
        let fitted = fit_some(named, &own, &material.into(), &mut |event: Event| terminal.show(event));
        let fitted = fitted.map_err(|e| e.placed(|e| self.of_option(e)))?;
        let is_inside = mesh.is_inside(range.clone());
        // Springs on lengths are there as shares.
        let others: Vec<_> = fitted.network.others.iter().filter(|spring| spring.kind != SpringKind::Length).collect();
        let record = NetworkShard {
            shard,
            run: ShardRun {
                program: concat!("springfit ", env!("CARGO_PKG_VERSION")).into(),
                mesh: format!("{:08x}", mesh.checksum()),
                points: mesh.point_count(),
                cells,
                fit: self.identity(material)?,
                is_exact: is_exact(&fitted.cells),
                is_numbered: mesh.numbering.is_some(),
            },
            points: &mesh.points,
            dimension: mesh.dimension,
            places: None,
            numbers: mesh.numbering.as_ref().map(|numbering| &numbering.nodes[..]),
            shares: &length_shares(&own, &fitted.cells, |point| is_inside[point]),
            others: &others,
        };
        record.write(&self.output)?;
        let cells = range.len();
        terminal.print(&format!("{cells} cells of shard {} of {}\n", shard.number, shard.count))?;
        terminal.written(std::slice::from_ref(&self.output))
    }

    /// What tells the shards of one fit and material from those of another: keys, values and the sums of files that are read.
    fn identity(&self, material: Material) -> Result<String> {
        let mut set = self.entry().identity();
        let Moduli { lambda, mu } = material.moduli();
        set.extend([format!("lambda = {lambda:e}"), format!("mu = {mu:e}")]);
        let plane = self.plane.and_then(|plane| plane.to_possible_value());
        set.extend(plane.map(|plane| format!("plane = {}", plane.get_name())));
        for path in self.options.elements().iter().chain(&self.keys.law).map(Path::new).filter(|path| path.is_file()) {
            let sum = Sum::of_file(path).map_err(|e| Error::io("cannot be read", e).in_file(path))?;
            set.push(format!("file = {sum}"));
        }
        Ok(set.join("\n"))
    }

    /// What the options say of the fit.
    fn named_fit(&self) -> Result<NamedFit> {
        Ok(self.entry().fits(Path::new("")).map_err(|e| e.placed(|e| self.of_option(e)))?.remove(0))
    }

    fn entry(&self) -> FitEntry {
        // The fit that gives the material itself; all others miss some of it on some meshes.
        let objective = self.objective.clone().unwrap_or("exact".into());
        self.keys.entry(objective)
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

    /// Moves a fault from its key to the option that the key stands for, as it is typed.
    fn of_option(&self, error: Error) -> Error {
        let command = <Fit as Args>::augment_args(clap::Command::new("fit"));
        // Options have the last part of a key's path.
        let last = error.key().map(|key| key.rsplit('.').next().unwrap_or(key));
        let flag = last.and_then(|key| self.keys.flag(key).or(Some(key))).map(String::from);
        match flag {
            Some(name) if command.get_arguments().any(|argument| argument.get_long() == Some(&name)) => {
                error.at_key(format!("--{name}"))
            }
            _ => error,
        }
    }
}
