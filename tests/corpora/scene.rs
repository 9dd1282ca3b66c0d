//! A scene: what has been accepted names parts that can be selected, and every fault prints as one line.

use springfit_studies::study::{Part, Scene};
use std::path::Path;

pub fn check(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    // The one key that has a file read at once.
    if text.contains("gradients") {
        return;
    }
    let path = Path::new("scene.toml");
    match Scene::parse(text, path) {
        Ok(scene) => check_scene(&scene),
        Err(error) => {
            assert_eq!(error.to_string().lines().count(), 1, "{error:?}");
            assert!(error.to_string().starts_with("scene.toml:"), "{error}");
        }
    }
}

fn check_scene(scene: &Scene) {
    assert!(!scene.fits().is_empty() && scene.fits().iter().all(|fit| fit.entry().is_some()));
    for dimension in 1..=3 {
        let parts = scene
            .supports()
            .iter()
            .map(|hold| &hold.part)
            .chain(scene.loads().iter().filter_map(|load| load.single()).map(|(part, _)| part));
        for part in parts {
            let selected = part.selection(dimension);
            assert!(selected.is_ok() || dimension < 3 && matches!(part, Part::Where(_)));
        }
        if let Ok(material) = scene.material(dimension) {
            let moduli = material.moduli();
            assert!(moduli.lambda.is_finite() && moduli.mu.is_finite());
        }
    }
}
