//! `springfit export`.

use super::output::command;
use super::scene_file::Settings;
use crate::export::{target_list, target_named, used_gravity, with_warnings, write_files};
use crate::terminal::Terminal;
use clap::Args;
use springfit_foundation::error::{Error, Result};
use springfit_foundation::named::unknown;
use springfit_report::report::{NetworkFile, NetworkRecord, read_network};
use springfit_studies::study::{Controls, run_with};
use std::path::PathBuf;

/// Write a network as the files and scripts of another program
#[derive(Args)]
#[command(after_help = format!("{EXAMPLES}\n{}If a program cannot represent a network, export stops with an error that names a fit which it can represent", target_list()))]
pub struct Export {
    /// A network in JSON, as run and fit write it; or a scene, which is run first
    network: PathBuf,
    /// The program; they are listed below
    #[arg(long, value_name = "PROGRAM")]
    to: String,
    /// The fit of a scene whose network is taken [default: the first]
    #[arg(long)]
    fit: Option<String>,
    /// Acceleration of gravity in m/s², such as "0 0 -1" [default: that of the network, or 9.81 against the last axis]
    #[arg(long, allow_hyphen_values = true)]
    gravity: Option<String>,
    #[command(flatten)]
    settings: Settings,
    /// Folder of the files [default: NAME-PROGRAM]
    #[arg(long, help_heading = "Output")]
    out: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  springfit export out/organ/exact.json --to newton
  springfit export organ.toml --to mujoco --fit exact --out mj
  springfit export classical.json --to lammps --gravity \"0 0 -1\"

Programs:";

impl Export {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        let target = target_named(&self.to)?;
        let stem = self.network.file_stem().unwrap_or_default().to_string_lossy();
        let folder = self.out.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}-{}", target.name)));
        let gravity = self.gravity.as_deref().map(numbers).transpose()?;
        let is_network = self.network.extension().is_some_and(|ending| ending == "json");
        let mut inputs = vec![self.network.clone()];
        let network = if is_network { self.read()? } else { self.fitted(terminal, &mut inputs)? };
        let of_network = |e: Error| if e.key() == Some("--gravity") { e } else { e.in_file(&self.network) };
        if let Some(asked) = &gravity {
            target.check_gravity(&network, asked).map_err(of_network)?;
        }
        let (network, mut warnings) = target.prepared(network, gravity.as_deref()).map_err(of_network)?;
        let files = target.files(&network, gravity.as_deref()).map_err(of_network)?;
        warnings.extend(target.at_rest(&network, gravity.as_deref()).map_err(of_network)?);
        let files = with_warnings(files, &warnings);
        let written = write_files(&files, &folder, &inputs)?;
        terminal.print(&terminal.within_page(&summary(&network, gravity.as_deref())))?;
        if network.held.is_empty() {
            terminal.note("no point is held: under gravity the body falls; [[fix]] in a scene holds points");
        }
        if !network.loads.is_empty() {
            let names: Vec<String> = network.loads.iter().map(|load| format!("\"{}\"", load.name)).collect();
            let names = names.join(", ");
            terminal.note(&match (target.has_loads, target.command.is_empty()) {
                (true, false) => {
                    let are = if files.iter().any(|(name, _)| *name == "network.json") {
                        "in network.json"
                    } else {
                        "arrays of network.npz"
                    };
                    format!("the loads {names} act where the script is given --load NAME, and are {are}")
                }
                (true, true) => format!("the loads {names} are arrays of network.npz"),
                (false, _) => format!("the loads {names} are not exported: supports and gravity are"),
            });
        }
        warnings.iter().for_each(|words| terminal.note(words));
        target.left_out(&network).iter().for_each(|words| terminal.note(words));
        if !target.command.is_empty() {
            terminal.print(&format!("run it: cd {} && {}\n", folder.display(), target.command))?;
        }
        terminal.written(&written)
    }

    fn read(&self) -> Result<NetworkRecord> {
        self.settings.expect_none("an element")?;
        if let Some(fit) = &self.fit {
            return Err(Error::at("--fit", format!("belongs to a scene, found \"{fit}\" with a network")));
        }
        read_network(&self.network)
    }

    /// The network of one fit of a scene; adds the files of the scene to `inputs`.
    fn fitted(&self, terminal: &mut Terminal, inputs: &mut Vec<PathBuf>) -> Result<NetworkRecord> {
        let scene = self.settings.scene(&self.network)?;
        inputs.extend(scene.inputs());
        let names = || scene.fits().iter().map(|fit| fit.name.as_str());
        let chosen = match &self.fit {
            None => &scene.fits()[0],
            Some(name) => scene.fits().iter().find(|fit| fit.name == *name).ok_or_else(|| {
                let quoted: Vec<String> = names().map(|name| format!("\"{name}\"")).collect();
                unknown(format!("one of {}", quoted.join(", ")), names(), name).at_key("--fit")
            })?,
        };
        let fits = vec![chosen.clone()];
        let scene = scene.with_fits(fits);
        let mut outcome = run_with(&scene, &Controls::default(), &mut |event| terminal.show(event))?;
        outcome.command = Some(command());
        Ok(NetworkFile::of(&outcome, &outcome.fits[0]).record())
    }
}

/// One line about a network.
fn summary(network: &NetworkRecord, gravity: Option<&[f64]>) -> String {
    let gravity = used_gravity(network, gravity);
    let gravity = gravity.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let gravity = format!("; gravity {gravity} m/s²");
    let (points, springs) = (network.points.len(), network.springs.len());
    let step = network.largest_step.map_or(String::new(), |step| format!(", longest explicit step {step:.2e} s"));
    let name = network.provenance.fit.as_ref().map_or("network", |fit| &fit.name);
    let material = network.provenance.material.as_ref();
    let material = material.map_or(String::new(), |m| format!("; E = {} Pa, nu = {}", m.young, m.poisson));
    let held = network.held.len();
    format!("{name}: {points} points, {springs} springs, {held} points held{step}{material}{gravity}\n")
}

fn numbers(text: &str) -> Result<Vec<f64>> {
    let words = text.split([' ', ',']).filter(|word| !word.is_empty());
    words
        .map(|word| word.parse::<f64>().ok().filter(|g| g.is_finite()))
        .collect::<Option<Vec<f64>>>()
        .ok_or_else(|| Error::expected("--gravity", "numbers in m/s², such as \"0 0 -9.81\"", format!("\"{text}\"")))
}
