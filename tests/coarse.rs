//! Coarse networks for fine bodies: where the points of one mesh lie in another, and what a network fitted to a finer body gains.

use springfit::mesh::{BoxMesh, Embedding, Mesh};
use springfit::study::{Outcome, Scene, run};
use std::sync::Arc;

fn block(element: &str, size: &[f64], cells: &[usize]) -> Mesh {
    let element = Arc::new(springfit::element::Element::load(element).unwrap());
    BoxMesh { element, size: size.to_vec(), cells: cells.to_vec(), origin: vec![0.0; size.len()] }.build().unwrap()
}

/// Affine fields are interpolated without error, and forces keep their sum, their moment and the work of every field of the coarse
/// mesh.
#[test]
fn points_are_found_in_the_cells_of_another_mesh() {
    let pairs = [
        ("tet4", "tet10", vec![2.0, 1.0, 1.5]),
        ("hex8", "tet4", vec![2.0, 1.0, 1.5]),
        ("wedge6", "hex20", vec![2.0, 1.0, 1.5]),
        ("tri3", "quad9", vec![2.0, 1.0]),
        ("quad8", "tri6", vec![2.0, 1.0]),
    ];
    for (coarse, fine, size) in pairs {
        let d = size.len();
        let coarse = block(coarse, &size, &vec![2; d]);
        let fine = block(fine, &size, &vec![5; d]);
        let embedding = Embedding::of(&fine.points, &coarse).unwrap();
        assert_eq!(embedding.outside, 0);
        let affine = |x: &[f64]| -> Vec<f64> {
            (0..d).map(|k| 0.3 + (0..d).map(|l| (1.0 + (k * d + l) as f64) * x[l]).sum::<f64>()).collect()
        };
        let at = |mesh: &Mesh| -> Vec<f64> { (0..mesh.point_count()).flat_map(|p| affine(mesh.point(p))).collect() };
        let found = embedding.interpolate(&at(&coarse));
        let worst = found.iter().zip(at(&fine)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-9, "{worst}");
        let forces: Vec<f64> = (0..fine.points.len()).map(|i| (1.7 * i as f64).sin()).collect();
        let own = embedding.restrict(&forces);
        let field: Vec<f64> = (0..coarse.points.len()).map(|i| (0.9 * i as f64).cos()).collect();
        let work = |f: &[f64], u: &[f64]| f.iter().zip(u).map(|(f, u)| f * u).sum::<f64>();
        let (on_fine, on_coarse) = (work(&forces, &embedding.interpolate(&field)), work(&own, &field));
        assert!((on_fine - on_coarse).abs() < 1e-9 * on_fine.abs().max(1.0), "{on_fine} {on_coarse}");
        for k in 0..d {
            let sum = |f: &[f64]| f.iter().skip(k).step_by(d).sum::<f64>();
            assert!((sum(&forces) - sum(&own)).abs() < 1e-9);
        }
    }
    // A mesh of another body is refused.
    let (here, there) = (block("tet4", &[1.0, 1.0, 1.0], &[2, 2, 2]), block("tet4", &[9.0, 1.0, 1.0], &[2, 2, 2]));
    let error = Embedding::of(&there.points, &here).unwrap_err().to_string();
    assert!(error.contains("near them"), "{error}");
}

const SCENE: &str = r#"
[mesh]
box = { element = "ELEMENT", size = [4, 1, 1], cells = [4, 1, 1] }

[material]
young   = 1e5
poisson = 0.3

[reference]
refine = 2

[[fit]]
objective = "exact"

[[fit]]
name      = "coarse"
objective = "whole"
start     = "exact"
KEYS

[[fix]]
group = "xmin"

[[load]]
name     = "tip"
group    = "xmax"
traction = [0, 0, 100]
"#;

fn ran(element: &str, keys: &str) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, SCENE.replace("ELEMENT", element).replace("KEYS", keys)).unwrap();
    run(&Scene::load(&path).unwrap(), &mut |_| {}).unwrap()
}

/// Under loads that it has not seen, a network of moduli fitted to a finer body errs less than half as much as finite elements of its
/// own mesh; it is stable under every support, because its form is that of the exact network.
#[test]
fn a_coarse_network_answers_like_a_finer_body() {
    for (element, keys) in [
        ("hex8", ""),
        ("hex8", "volume = \"cells\""),
        ("tet4", "volume = \"patches\""),
        ("hex8", "supports = [[\"xmin\"], [\"xmin\", \"xmax\"]]\nvalidate_supports = [[\"ymin\"]]"),
        ("hex8", "unknowns = \"body-moduli\""),
    ] {
        let outcome = ran(element, keys);
        let whole = outcome.fits[1].kind.whole().unwrap();
        assert!(whole.stands && !whole.held_out.is_empty());
        for held_out in &whole.held_out {
            let median = |model: &str| held_out.models.iter().find(|m| m.model == model).unwrap().median.unwrap();
            let (body, fitted) = (median("finite elements"), median("fitted"));
            // Several supports at once, and one that was not fitted, leave less to gain.
            let share = match (keys.contains("body-moduli") || !held_out.is_trained, keys.contains("supports")) {
                (true, _) => 1.0,
                (false, true) => 0.7,
                (false, false) => 0.5,
            };
            assert!(fitted < share * body, "{element} {keys} {}: {body} {fitted}", held_out.support);
        }
        // The load of the scene has the finer body's displacements, and was not fitted.
        let rms = |fit: usize| outcome.fits[fit].loads[0].error.unwrap().rms;
        assert!(
            outcome.loads[0].measured.is_some() && rms(1) < 0.7 * rms(0),
            "{element} {keys}: {} {}",
            rms(0),
            rms(1)
        );
    }
}
