//! The standard bodies: their networks, where these rest by linear theory, and the energies of refined meshes.

use springfit_bodies::model::finite_elements;
use springfit_bodies::solve::{System, lowest_modes};
use springfit_foundation::error::{Error, Result};
use springfit_report::report::{NetworkFile, NetworkRecord};
use springfit_studies::study::{Progress, Scene, Setting, converge, run};
use std::path::Path;

/// The scenes: tension, torsion and bending of a bar, shear of a block.
const SCENES: [StandardScene; 2] = [
    StandardScene {
        name: "bar",
        text: include_str!("../../exports/referee/bar.toml"),
        truth: include_str!("../../exports/referee/bar_truth.set"),
    },
    StandardScene {
        name: "block",
        text: include_str!("../../exports/referee/block.toml"),
        truth: include_str!("../../exports/referee/block_truth.set"),
    },
];

/// A scene, and the setting of a mesh of quadratic cells whose refinements are the truth.
struct StandardScene {
    name: &'static str,
    text: &'static str,
    truth: &'static str,
}

/// A body of linear tetrahedra.
pub struct StandardBody {
    /// The name of its scene.
    pub name: &'static str,
    /// E in Pa and ν.
    pub moduli: [f64; 2],
    /// By fit.
    pub networks: Vec<(String, NetworkRecord)>,
    /// The lowest angular frequency, 1/s.
    pub slowest: f64,
    /// One for each load.
    pub cases: Vec<Case>,
}

/// A load of a body.
pub struct Case {
    /// Its name.
    pub load: String,
    /// `[points · 3]`, N.
    pub forces: Vec<f64>,
    /// Displacements as finite elements, `[points · 3]`, m.
    pub elements: Vec<f64>,
    /// Displacements of each network by linear theory, `[points · 3]`, m.
    pub networks: Vec<Vec<f64>>,
    /// Half the work of the load as finite elements of refined meshes, J, and how uncertain it is.
    pub truth: [f64; 2],
}

impl Case {
    /// Half the work of the load, J: the elastic energy of a linear body at rest.
    pub fn energy(&self, u: &[f64]) -> f64 {
        0.5 * self.forces.iter().zip(u).map(|(f, u)| f * u).sum::<f64>()
    }

    /// The displacement of the point that moves most as finite elements, in the direction in which it moves, m.
    pub fn tip(&self, u: &[f64]) -> f64 {
        let length = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (at, direction) = self
            .elements
            .chunks(3)
            .enumerate()
            .max_by(|a, b| length(a.1).total_cmp(&length(b.1)))
            .expect("a body has points");
        u[3 * at..3 * at + 3].iter().zip(direction).map(|(u, d)| u * d).sum::<f64>() / length(direction)
    }
}

/// The standard bodies of this Poisson's ratio with the networks of these fits.
///
/// # Errors
/// No material with this Poisson's ratio has all networks, or an engine cannot hold a body of this stiffness at its setting.
pub fn standard_bodies(poisson: f64, fits: &[&str], progress: &mut Progress) -> Result<Vec<StandardBody>> {
    SCENES.iter().map(|scene| standard_body(scene, poisson, fits, progress)).collect()
}

fn standard_body(
    standard: &StandardScene,
    poisson: f64,
    fits: &[&str],
    progress: &mut Progress,
) -> Result<StandardBody> {
    let path = format!("{}.toml", standard.name);
    let told = Setting::parse(&format!("material.poisson={poisson}"))?;
    let scene = Scene::parse_with(standard.text, Path::new(&path), std::slice::from_ref(&told))?;
    let refined = [told, Setting::parse(standard.truth.trim())?];
    let refined = Scene::parse_with(standard.text, Path::new(&path), &refined)?.with_fits(Vec::new());
    let limits = converge(&refined, None, progress)?.loads;
    // Networks for the settings of engines take seconds each: those that nobody moves are left out.
    let chosen = scene.fits().iter().filter(|fit| fits.contains(&fit.name.as_str())).cloned().collect();
    let scene = scene.with_fits(chosen);
    let outcome = run(&scene.clone().judged_by_cells(), progress)?;
    let missing = |what: &str| Error::new(format!("{path} has no {what}"));
    let masses = outcome.masses.as_deref().ok_or_else(|| missing("density"))?;
    let support = outcome.support.as_ref().ok_or_else(|| missing("support"))?;
    let system = System::new(&finite_elements(&outcome.mesh, outcome.material.moduli()), support)?;
    let factor = system.cholesky()?.ok_or_else(|| missing("stiffness"))?;
    let slowest = lowest_modes(&system, &factor, masses, 3, 1)?.squares[0].sqrt();
    let mut cases = Vec::new();
    for (i, load) in outcome.loads.iter().enumerate() {
        let limit = limits.iter().find(|limit| limit.name == load.name).and_then(|limit| limit.truth);
        let limit = limit.ok_or_else(|| missing("limit"))?;
        let networks = outcome.fits.iter().map(|fit| fit.loads[i].displacement.as_deref().cloned());
        let networks: Option<Vec<Vec<f64>>> = networks.collect();
        cases.push(Case {
            load: load.name.clone(),
            forces: load.forces.clone(),
            elements: load.fem.clone(),
            networks: networks.ok_or_else(|| missing("network that is stable"))?,
            // Compliances are works `f·u` of whole loads; the energy of a linear body is half of the work.
            truth: [0.5 * limit.value, 0.5 * limit.uncertainty],
        });
    }
    let record = |fit| NetworkFile::of(&outcome, fit).record();
    let networks = outcome.fits.iter().map(|fit| (fit.fit.name.clone(), record(fit))).collect();
    let young = scene.material(3)?.young();
    Ok(StandardBody { name: standard.name, moduli: [young, poisson], networks, slowest, cases })
}
