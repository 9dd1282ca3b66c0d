//! The study behind the default objective: every linear scene of the folder `scenes`, fitted in 64 ways.
//!
//! `cargo run --release --example defaults` prints, for each element type, the geometric mean of e_rms in percent over the loads
//! of its scenes, the worst of them, and how many networks are not stable. Scenes can be named:
//! `cargo run --release --example defaults -- scenes/square_quad.toml`.

use springfit::element::SpringKind;
use springfit::error::{Error, Result};
use springfit::fit::{Balance, Fit, Higher, MotionWeight, Objective, Weight};
use springfit::solve::Standing;
use springfit::study::{NamedFit, Scene, run};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The percentages of one fit on the scenes of one element type, and how many of its networks are not stable.
#[derive(Default)]
struct Row {
    errors: Vec<f64>,
    unstable: usize,
}

fn main() -> Result<()> {
    let mut rows: BTreeMap<(String, usize), (String, Row)> = BTreeMap::new();
    let chosen: Vec<PathBuf> = std::env::args().skip(1).map(PathBuf::from).collect();
    for path in if chosen.is_empty() { scenes(Path::new("scenes"))? } else { chosen } {
        let scene = Scene::load(&path)?;
        // Scenes with a law, a motion or whole-object fits have the bodies of others.
        let is_whole = scene.fits().iter().any(|fit| fit.recipe.whole().is_some());
        if scene.loads().is_empty() || scene.law().is_some() || scene.motion().is_some() || is_whole {
            continue;
        }
        let mesh = scene.build_mesh()?;
        // Nor do the springs of a cell bend a sheet.
        if mesh.directors.is_some() {
            continue;
        }
        let element = mesh.blocks[0].element.clone();
        let lengths: Vec<String> = names(&element, |kind| kind == SpringKind::Length);
        let all: Vec<String> = names(&element, |_| true);
        let outcome = run(&scene.with_fits(candidates(&lengths, &all)), &mut |_| {})?;
        for (order, fit) in outcome.fits.iter().enumerate() {
            let (_, row) = rows.entry((element.name.clone(), order)).or_insert((fit.fit.name.clone(), Row::default()));
            row.errors.extend(fit.loads.iter().map(|l| l.error.map_or(f64::INFINITY, |e| e.rms)));
            let stable = fit.stability.as_ref().is_some_and(|s| s.standing == Standing::Stable);
            row.unstable += usize::from(!stable);
        }
    }
    println!("{:8} {:28} {:>12} {:>8} {:>8}", "element", "fit", "mean e_rms, %", "worst", "unstable");
    for ((element, _), (fit, row)) in rows {
        let mean = (row.errors.iter().map(|e| e.ln()).sum::<f64>() / row.errors.len() as f64).exp();
        let worst = row.errors.iter().copied().fold(0.0, f64::max);
        println!("{element:8} {fit:28} {mean:12.2} {worst:8.2} {:8}", row.unstable);
    }
    Ok(())
}

fn scenes(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).map_err(|e| Error::new(format!("cannot be read: {e}")).in_file(folder))?;
    let mut paths: Vec<_> =
        entries.flatten().map(|e| e.path()).filter(|p| p.extension().is_some_and(|e| e == "toml")).collect();
    paths.sort();
    Ok(paths)
}

fn names(element: &springfit::element::Element, wanted: impl Fn(SpringKind) -> bool) -> Vec<String> {
    element.springs.iter().filter(|g| wanted(g.kind)).map(|g| g.name.clone()).collect()
}

fn candidates(lengths: &[String], all: &[String]) -> Vec<NamedFit> {
    let mut fits = Vec::new();
    for (groups, bulk) in [(lengths, ""), (all, " with bulk")] {
        for nonnegative in [false, true] {
            let mut objectives = vec![Objective::Frobenius(Weight::None), Objective::Frobenius(Weight::OffDiagonal)];
            objectives.extend(
                [0.7, 0.5, 0.316, 0.2, 0.1]
                    .map(|higher| Objective::Frobenius(Weight::Modal(Higher::new(higher).unwrap()))),
            );
            objectives.push(Objective::Frobenius(Weight::Relative));
            objectives.extend(MotionWeight::all().map(Objective::Spectral));
            objectives.extend(
                [0.0, 0.1, 0.25, 0.5, 1.0].map(|balance| Objective::Divergence(Balance::new(balance).unwrap())),
            );
            for objective in objectives {
                let fit = Fit { nonnegative, ..Fit::new(objective) };
                let mut named = NamedFit::new(fit, None);
                named.name += bulk;
                named.springs = Some(groups.to_vec());
                fits.push(named);
            }
        }
    }
    fits
}
