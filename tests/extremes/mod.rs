//! Every number of an input may be extreme: it ends in an error that names its key, in a named status, or in figures that are right.

mod files;
mod measures;
mod options;
mod samples;
mod verdict;
mod walk;

use crate::kit::files_of;
use samples::{ALL, FILES};
use springfit_studies::study::Scene;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use tempfile::TempDir;
use toml::Value;
use verdict::{Verdict, of_scene};
use walk::{Place, Read, at, inline, is_numeric, key, numeric_keys, parse, places, takes, text, with};

/// What each number is changed to.
const EXTREMES: [f64; 12] =
    [0.0, -1.0, 1e-308, 1e-160, 1e160, 1e308, f64::NAN, f64::INFINITY, 1e-30, 1e30, -1e30, 5e-324];

/// Loads and moduli that the errors of a linear body do not depend on.
const HOMOGENEOUS: [&str; 8] = [
    "material.young",
    "material.thickness",
    "material.area",
    "material.density",
    "load[].traction[]",
    "load[].force[]",
    "load[].body[]",
    "mesh.scale",
];

/// A problem of a scene that is read, not run.
fn problem(text: &str) -> Option<String> {
    Scene::parse(text, Path::new("scene.toml")).err().map(|error| error.problem().to_string())
}

/// An extreme as the kind of value that stands there, or as the texts that may.
fn values(read: Read, document: &Value, place: &Place, extreme: f64) -> Vec<Value> {
    let own = match at(document, place) {
        Value::Integer(_) if extreme.fract() == 0.0 && extreme.abs() < 1e15 => Value::Integer(extreme as i64),
        _ => Value::Float(extreme),
    };
    let mut all = vec![own];
    // Where an expression may stand, as one of finite numbers.
    let is_text = at(document, place).is_str() || takes(read, document, place, Value::String("1*1".into()));
    if is_text && extreme.is_finite() {
        all.push(Value::String(format!("{extreme:e}")));
        all.push(Value::String(format!("{extreme:e}*(1 + 1)")));
    }
    all
}

fn numeric_places(document: &Value) -> Vec<Place> {
    places(document).into_iter().filter(|place| is_numeric(&problem, document, place)).collect()
}

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    FILES.iter().for_each(|(name, content)| std::fs::write(folder.path().join(name), content).unwrap());
    folder
}

/// A third of the values at each of the first three numbers with a key, so that the three have them all; one at each of the others with this key, in
/// turn. Most keys are in many samples.
#[test]
fn every_number_of_a_scene_may_be_extreme() {
    sweep(|before| if before < 3 { 3 } else { EXTREMES.len() });
}

#[test]
#[ignore = "takes minutes; .ci/long has it"]
fn every_number_of_a_scene_may_have_every_extreme() {
    sweep(|_| 1);
}

/// Sets every number of all samples to extremes. A number takes every `stride(n)`-th of the extremes, where n numbers with the same key came
/// before it.
fn sweep(stride: impl Fn(usize) -> usize) {
    let folder = folder();
    let path = folder.path().join("scene.toml");
    let (mut cases, mut wrong, mut verdicts) = (0, Vec::new(), [0; 3]);
    let mut met: BTreeMap<String, usize> = BTreeMap::new();
    for (name, scene) in ALL {
        let document = parse(scene);
        let sane = of_scene(scene, &path).unwrap_or_else(|e| panic!("{name}: {e}"));
        if sane == Verdict::Refused {
            let error =
                Scene::parse(scene, &path).and_then(|scene| springfit_studies::study::run(&scene, &mut |_| ())).err();
            wrong.push(format!(
                "{name} is refused before it is changed: {}",
                error.map_or_else(String::new, |e| e.to_string())
            ));
        }
        for place in numeric_places(&document) {
            let before = met.entry(key(&place)).or_default();
            let step = stride(*before);
            let first = *before % step;
            *before += 1;
            for extreme in EXTREMES.into_iter().skip(first).step_by(step) {
                for value in values(&problem, &document, &place, extreme) {
                    cases += 1;
                    let case = format!("{name}: {} = {}", key(&place), inline(&value));
                    let start = std::time::Instant::now();
                    let verdict = of_scene(&text(&with(&document, &place, value)), &path);
                    if start.elapsed().as_secs_f64() > 0.5 {
                        println!("{case}: {:.2} s", start.elapsed().as_secs_f64());
                    }
                    match verdict {
                        Err(problem) => {
                            println!("WRONG {case}: {problem}");
                            wrong.push(format!("{case}: {problem}"));
                        }
                        Ok(Verdict::Refused) => verdicts[0] += 1,
                        Ok(Verdict::Named) => verdicts[1] += 1,
                        Ok(Verdict::Right(found)) => {
                            verdicts[2] += 1;
                            let scales = HOMOGENEOUS.contains(&key(&place).as_str()) && extreme != 0.0;
                            // A load that is less than the rounding of the stresses is lost at large deformation.
                            let is_law = ["large", "fibres"].contains(&name);
                            // Not beside other components, nor where the load varies.
                            let value = at(&document, &place);
                            let alone =
                                value.as_integer() != Some(0) && (!value.is_str() || key(&place) == "material.young");
                            if let (Verdict::Right(expected), true) = (&sane, scales && alone && !is_law)
                                && !agree(expected, &found)
                            {
                                wrong.push(format!("{case}: errors {found:?}, expected {expected:?}"));
                            }
                        }
                    }
                }
            }
        }
    }
    println!("{cases} cases: {verdicts:?} refused, named, right");
    assert!(wrong.is_empty(), "{} of {cases} cases:\n{}", wrong.len(), wrong.join("\n"));
}

/// Whether errors in percent agree, to the rounding of a millionth of the displacement.
fn agree(a: &[Vec<Option<f64>>], b: &[Vec<Option<f64>>]) -> bool {
    let same = |a: &Option<f64>, b: &Option<f64>| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-4,
        (a, b) => a == b,
    };
    a.iter().zip(b).all(|(a, b)| a.iter().zip(b).all(|(a, b)| same(a, b)))
}

#[test]
fn every_numeric_key_of_a_scene_is_swept() {
    let mut visited = BTreeSet::new();
    let mut known = BTreeSet::new();
    for (_, scene) in ALL {
        let document = parse(scene);
        visited.extend(numeric_places(&document).iter().map(|place| key(place)));
        visited
            .extend(places(&document).iter().filter(|place| at(&document, place).is_table()).map(|place| key(place)));
        known.extend(numeric_keys(&problem, &document));
    }
    // The shipped scenes have no other keys.
    // An index of experiments is no scene.
    for path in files_of(Path::new("scenes"), "toml").into_iter().filter(|path| !path.ends_with("index.toml")) {
        let document = parse(&std::fs::read_to_string(&path).unwrap());
        known.extend(numeric_places(&document).iter().map(|place| key(place)));
    }
    let lists = |name: &String| [name.clone(), format!("{name}[]"), format!("{name}[][]")];
    // A material alone has the keys of one in a list, a set of shapes and what is held out as well, and the mesh of a finer body those of
    // a mesh.
    let alone = |names: BTreeSet<String>| -> BTreeSet<String> {
        let plain = |name: String| {
            let name = name.replacen("material[]", "material", 1).replacen("reference.mesh", "mesh", 1);
            name.replacen("shapes[]", "shapes", 1).replacen("shapes.held_out.", "shapes.", 1)
        };
        names.into_iter().map(plain).collect()
    };
    let (known, visited) = (alone(known), alone(visited));
    let missing: Vec<&String> =
        known.iter().filter(|name| !lists(name).iter().any(|name| visited.contains(name))).collect();
    assert!(known.len() > 60, "{} keys: {known:?}", known.len());
    assert!(missing.is_empty(), "no sample has {missing:?}");
}
