//! A title, a name or a group that is no printable line is refused where it is read, with its line and its key.

use super::hostile::{others, printable_lines};
use springfit_element::element::Element;
use springfit_element::material::{Energy, Material};
use springfit_foundation::error::{Error, Result};
use springfit_foundation::text::toml;
use springfit_studies::study::Scene;
use std::path::Path;

const ELEMENT: &str = include_str!("../../elements/tri3.toml");
const MATERIAL: &str = include_str!("../../materials/neo-hookean.toml");
const SCENE: &str = "title = \"square\"\n[mesh]\nbox = { element = \"quad4\", size = [1, 1], cells = [2, 2] }\n[material]\n\
                     young = 1000\npoisson = 0.3\nthickness = 0.01\n[[fit]]\nname = \"first\"\nobjective = \"modal\"\n\
                     springs = [\"edge\", \"bulk\"]\n[[fix]]\ngroup = \"xmin\"\n[[load]]\nname = \"pull\"\ngroup = \"xmax\"\ntraction = [1, 0]\n";

fn element(text: &str) -> Result<()> {
    Element::parse(text).map(|_| ())
}

fn material(text: &str) -> Result<()> {
    Energy::parse(text, Material::for_body(3, 1e4, 0.3, None, None).unwrap()).map(|_| ())
}

fn scene(text: &str) -> Result<()> {
    Scene::parse(text, Path::new("s.toml")).map(|_| ())
}

/// Files with the line of a key and its value in them.
type Input = (&'static str, fn(&str) -> Result<()>, &'static [(&'static str, &'static str)]);

const INPUTS: [Input; 3] = [
    (ELEMENT, element, &[("name", "name"), ("title", "title"), ("source", "source"), ("group", "springs[0].group")]),
    (MATERIAL, material, &[("name", "name"), ("title", "title"), ("source", "source")]),
    (
        SCENE,
        scene,
        &[("title", "title"), ("name", "fit[0].name"), ("group", "fix[0].group"), ("objective", "fit[0].objective")],
    ),
];

/// The file with another text for the first key of this name, and the line of the key.
fn with(file: &str, key: &str, value: &str) -> (String, usize) {
    let is_key = |line: &&str| line.split_once('=').is_some_and(|(name, _)| name.trim() == key);
    let place = file.lines().position(|line| is_key(&line)).unwrap_or_else(|| panic!("no {key}"));
    let line = |(i, line): (usize, &str)| if i == place { format!("{key} = {value}\n") } else { format!("{line}\n") };
    (file.lines().enumerate().map(line).collect(), place + 1)
}

#[test]
fn a_text_that_is_no_printable_line_is_refused_with_its_line_and_key() {
    let mut refused = 0;
    for (file, read, keys) in INPUTS {
        assert!(read(file).is_ok());
        for text in others() {
            for (key, path) in keys {
                let (changed, line) = with(file, key, &toml(&text));
                let error: Error = read(&changed).unwrap_err();
                let words = format!("{line}: {path}: expected one line of printable characters, found ");
                assert!(error.to_string().contains(&words), "{error}");
                assert_eq!((error.line(), error.key()), (Some(line), Some(*path)));
                assert!(!error.to_string().contains(char::is_control), "{error}");
                refused += 1;
            }
        }
    }
    println!("{refused} texts refused");
}

#[test]
fn any_printable_line_is_a_title() {
    for text in printable_lines() {
        for (file, read, _) in INPUTS {
            read(&with(file, "title", &toml(&text)).0).unwrap_or_else(|e| panic!("{text}: {e}"));
        }
    }
}

#[test]
fn keys_are_printable_lines_and_expressions_may_have_several() {
    let error = scene(&format!("{SCENE}\n[[load]]\n\"a\\u001bb\" = 1\n")).unwrap_err();
    assert!(error.to_string().contains("expected one line of printable characters"), "{error}");
    // An expression is read, not printed: it may be on several lines.
    let (several, _) = with(MATERIAL, "energy", "\"\"\"mu/2*(I1 - 3)\n\t- mu*ln(J)\r\n + lambda/2*ln(J)^2\"\"\"");
    material(&several).unwrap();
    let error = material(&with(MATERIAL, "energy", "\"mu/2*\\u001b(I1 - 3)\"").0).unwrap_err();
    assert!(error.to_string().contains("energy: expected one line of printable characters, found U+001B"), "{error}");
}
