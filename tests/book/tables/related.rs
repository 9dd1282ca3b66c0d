//! Methods of other authors on three bodies, and a search that removes springs.

use super::{fit, markdown, outcome, scene};
use springfit_bodies::solve::Standing;
use springfit_element::material::Moduli;
use springfit_element::springs::Springs;
use springfit_fit::fit::published::{Method, Ratio};
use springfit_fit::fit::{fit_element, reference_fit};
use springfit_studies::study::{FitEntry, FitOutcome, NamedFit, Output};

const SCENES: [&str; 3] = ["tissue_tri", "square_quad", "cube_tet"];
/// Poisson's ratio of the scenes.
const POISSON: f64 = 0.3;
/// The iterations of a search by annealing.
const ITERATIONS: i64 = 300;

/// What a row is called, and its fit.
fn rows() -> Vec<(String, FitEntry)> {
    let published = Method::all().map(|method| (format!("`{}`", method.name()), FitEntry::new(method.name())));
    let annealing = FitEntry::new("frobenius")
        .with("solver", Some("simulated-annealing"))
        .with("iterations", Some(ITERATIONS))
        .with("nonnegative", Some(true));
    let own = [
        ("`frobenius`, `solver = \"simulated-annealing\"`, k ≥ 0", annealing),
        ("`frobenius`, `rest = \"free\"`", FitEntry::new("frobenius").with("rest", Some("free"))),
        ("`frobenius`", FitEntry::new("frobenius")),
        ("`spectral`", FitEntry::new("spectral")),
        ("`offdiag`", FitEntry::new("offdiag")),
        ("`exact`", FitEntry::new("exact")),
    ];
    published.into_iter().chain(own.map(|(name, entry)| (name.to_string(), entry))).collect()
}

/// `e_rms` in percent under the first load of each scene with the springs of the network, and the processor time for each cell that is fitted, of
/// the last scene that the method fits.
pub fn table() -> String {
    let rows = rows();
    let columns: Vec<Vec<Option<(String, f64)>>> = SCENES.iter().map(|name| column(name, &rows)).collect();
    let row = |(i, (name, _)): (usize, &(String, FitEntry))| {
        let cells = columns.iter().map(|column| column[i].as_ref().map_or("–".into(), |(cell, _)| cell.clone()));
        let seconds = columns.iter().rev().find_map(|column| Some(column[i].as_ref()?.1)).unwrap();
        let microseconds = 1e6 * seconds;
        let time = format!("{microseconds:.*} us", if microseconds < 10.0 { 2 } else { 0 });
        std::iter::once(name.clone()).chain(cells).chain([time]).collect::<Vec<_>>()
    };
    let header: Vec<String> = SCENES.iter().map(|name| format!("`{name}`")).collect();
    let header: Vec<&str> =
        std::iter::once("fit").chain(header.iter().map(String::as_str)).chain(["time of a cell"]).collect();
    markdown(&header, &rows.iter().enumerate().map(row).collect::<Vec<_>>())
}

/// What a scene gives of each row, and seconds for each cell; none where the method is not for its cells.
fn column(name: &str, rows: &[(String, FitEntry)]) -> Vec<Option<(String, f64)>> {
    let scene = scene(name);
    // Times are not compared, so that they are repeated only where they are written.
    let output = Output { time: std::env::var_os("SPRINGFIT_WRITE_BOOK").is_some(), ..scene.output().clone() };
    let scene = scene.with_output(output);
    let element = scene.build_mesh().unwrap().blocks[0].element.clone();
    let refuses = |entry: &FitEntry| {
        let Ok(method) = Method::named(&entry.objective) else { return false };
        match method.cover(&element).map(|cover| cover.poisson) {
            Ok(Ratio::AtLeast(least)) => least > POISSON,
            Ok(Ratio::Any | Ratio::Only(_)) => false,
            Err(_) => true,
        }
    };
    let fits: Vec<Option<NamedFit>> =
        rows.iter().map(|(_, entry)| (!refuses(entry)).then(|| fit(entry.clone()))).collect();
    let outcome = outcome(&scene.with_fits(fits.iter().flatten().cloned().collect()));
    let (mut found, cells) = (outcome.fits.iter(), outcome.mesh.cell_count());
    let mut next = || {
        let fit = found.next().unwrap();
        (cell(fit), fit.seconds_per_element(cells))
    };
    fits.iter().map(|fit| fit.as_ref().map(|_| next())).collect()
}

fn cell(fit: &FitOutcome) -> String {
    let standing = fit.stability.as_ref().map(|stability| stability.standing);
    let mark = if standing == Some(Standing::Stable) { "" } else { " †" };
    format!("{:.2}, {}{mark}", fit.loads[0].error.unwrap().rms, fit.network.len())
}

/// A swarm that may remove springs of the cube: what each spring may cost, how many of the 28 are left, `‖R − K‖/‖R‖`, and the body's `e_rms`.
pub fn sparsity() -> String {
    let shares = [0.0, 0.025, 0.03, 0.04, 0.05];
    let entry = |share: &f64| {
        let entry = FitEntry::new("frobenius").with("solver", Some("particle-swarm")).with("topology", Some(true));
        fit(entry.with("sparsity", Some(*share)).with("nonnegative", Some(true)))
    };
    let scene = scene("cube_hex");
    let outcome =
        outcome(&scene.with_fits(shares.iter().map(entry).chain([fit(FitEntry::new("frobenius"))]).collect()));
    let element = &outcome.mesh.blocks[0].element;
    // All cells of the body are this cube, whose springs are those of any other size.
    let (x, moduli) = (&element.positions, Moduli { lambda: 1.5, mu: 1.0 });
    let springs = Springs::select(element, None).unwrap();
    let r = reference_fit::stiffness(element, x, &moduli.into()).unwrap();
    let g = reference_fit::gradients(element, &springs, x).unwrap();
    let row = |(i, fit): (usize, &FitOutcome)| {
        let name = shares.get(i).map_or("all springs, `frobenius`".into(), |share| format!("`sparsity = {share}`"));
        let k = fit_element(element, &springs, x, moduli, &fit.fit.recipe.stiffness().unwrap()).unwrap();
        let kept = k.iter().filter(|k| **k != 0.0).count();
        let error = (&r - reference_fit::network(&g, &k)).norm() / r.norm();
        vec![
            name,
            kept.to_string(),
            format!("{error:.3}"),
            fit.loads[0].error.map_or("a mechanism".into(), |error| format!("{:.2}", error.rms)),
        ]
    };
    let rows: Vec<Vec<String>> = outcome.fits.iter().enumerate().map(row).collect();
    markdown(&["search", "springs of a cell", "‖R − K‖/‖R‖", "`cube_hex`, tension, e_rms %"], &rows)
}
