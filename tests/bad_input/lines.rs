//! The line of a fault: every value of a scene is changed to others, and every error about it has the line of its key or of a table
//! around it.

use crate::kit::place;
use springfit_foundation::error::ErrorKind;
use springfit_studies::study::{Forecast, Scene};

/// Values of other types, and one that is out of every range.
const VALUES: [&str; 5] = ["\"zzz\"", "-1e40", "[]", "true", "{ a = 1 }"];

#[test]
fn every_error_of_a_scene_has_a_line() {
    let folder = place("scenes");
    let (mut errors, mut wrong) = (0, Vec::new());
    for name in ["square_quad", "cube_hex_large", "cube_hex_motion", "cube_hex_whole", "specimen_tri", "cantilever"] {
        let path = match name {
            "cantilever" => folder.join("converge/cantilever_hex.toml"),
            name => folder.join(format!("{name}.toml")),
        };
        let text = std::fs::read_to_string(&path).unwrap();
        for (i, line) in text.lines().enumerate() {
            let Some((key, _)) = line.split_once('=').filter(|(key, _)| !key.contains(['#', '['])) else { continue };
            for value in VALUES {
                let changed = format!("{key}= {value}");
                let changed: Vec<&str> =
                    text.lines().enumerate().map(|(j, old)| if i == j { &changed } else { old }).collect();
                let scene = Scene::parse(&changed.join("\n"), &path);
                // The mesh, the material, the supports and the loads are worked out, the fits are not.
                let Err(error) = scene.and_then(|scene| Forecast::of(&scene.with_fits(Vec::new()))) else { continue };
                errors += 1;
                // A file that cannot be read is named itself.
                let names_another = error.kind() == ErrorKind::Io && error.file().is_some_and(|file| file != path);
                if !names_another && (error.file() != Some(&path) || error.line().is_none()) {
                    wrong.push(format!("{name}: {key}= {value}: {error}"));
                }
            }
        }
    }
    println!("{errors} errors");
    assert!(errors > 500 && wrong.is_empty(), "{} of {errors}:\n{}", wrong.len(), wrong.join("\n"));
}
