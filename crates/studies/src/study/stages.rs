//! The stages of a scene, before any of them runs.

use springfit_scenes::Scene;

/// The stages of a scene in order: what will run, or the reason why it is left out.
pub fn stages(scene: &Scene) -> Vec<(String, Option<String>)> {
    let run = |what: String| (what, None);
    let skip = |what: &str, why: &str| (what.to_string(), Some(why.to_string()));
    let mut stages = vec![run(scene.mesh().title())];
    if let Some(law) = scene.law() {
        stages.push(run(format!("compile the energy {law}")));
    }
    stages.extend(scene.fits().iter().map(|fit| run(fit.recipe.kind().stage(&fit.name))));
    if scene.law().is_none() {
        stages.push(skip("hyperelastic energy, Newton's method", "the material has no law"));
    }
    if !scene.fits().iter().any(|fit| fit.recipe.sampled().is_some()) {
        stages.push(skip("sampled shapes", "no [[fit]] has the objective \"sampled\""));
    }
    if scene.loads().is_empty() {
        stages.push(skip("finite element solution", "the scene has no [[load]]"));
        stages.push(skip("network solutions, displacement errors, stability", "the scene has no [[load]]"));
    }
    for load in scene.loads() {
        let large = if scene.law().is_some() { " at large deformation" } else { "" };
        let networks = scene.fits().len();
        stages.push(run(format!("solve {}{large} with finite elements and with {networks} networks", load.name)));
    }
    if !scene.loads().is_empty() && scene.law().is_none() {
        stages.push(run("compare the energies of each network with the body's".into()));
    }
    match scene.has_density() {
        true => stages.push(run("masses".into())),
        false => stages.push(skip("masses", "the material has no density")),
    }
    match scene.motion() {
        Some(motion) => {
            let finite = if motion.finite_elements { "finite elements and " } else { "" };
            stages.push(run(format!("move {finite}{} networks for {}", scene.fits().len(), motion.title())));
        }
        None => stages.push(skip("motion", "the scene has no [motion]")),
    }
    match scene.output().frequencies {
        0 => stages.push(skip("natural frequencies", "not requested in [output]")),
        count => stages.push(run(format!("{count} natural frequencies of each model"))),
    }
    if scene.output().dynamic_moduli.is_some() {
        stages.push(run("storage and loss moduli of each model".into()));
    }
    for (asked, what) in [
        (scene.output().time, "costs of each fit and of each model"),
        (scene.output().moduli, "moduli of each whole network"),
        (scene.output().vtu, "VTU files"),
        (scene.output().csv, "CSV files"),
    ] {
        stages.push(if asked { run(what.into()) } else { skip(what, "not requested in [output]") });
    }
    stages
}
