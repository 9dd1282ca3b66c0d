//! Options of the command line.

use super::inputs::{BRICK, unit_mesh};
use super::refusals::Refusals;

#[test]
fn options_of_fit() {
    let mesh = unit_mesh();
    let given = [("--young", "10kPa"), ("--poisson", "0.3"), ("--output", "springs.csv")];
    let mut refusals = Refusals::default();
    for (key, value, place, words) in [
        ("--young", "10 lbf", "--young", "found \"10 lbf\""),
        ("--young", "kPa", "--young", "found \"kPa\""),
        ("--young", "", "--young", "found \"\""),
        ("--output", "springs.txt", "--output", "found springs.txt"),
        ("--output", "springs", "--output", "found springs"),
        ("--output", ".csv", "--output", "found .csv"),
        ("--scale", "-1", "--scale", "found -1"),
        ("--scale", "0", "--scale", "found 0"),
        ("--scale", "inf", "--scale", "found inf"),
        ("--density", "0", "--density", "kg/m³, found 0"),
        ("--springs", "edge", "--springs", "no groups"),
        ("--weight", "modal", "--weight", "\"exact\""),
    ] {
        let mut arguments = vec!["fit".to_string(), "mesh.msh".to_string()];
        let others = given.iter().filter(|(other, _)| *other != key);
        arguments.extend(others.chain([&(key, value)]).map(|(key, value)| format!("{key}={value}")));
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        refusals.expect(&[("mesh.msh", mesh.as_bytes())], &arguments, place, words);
    }
    refusals.finish();
}

#[test]
fn options_by_their_names() {
    let mesh = unit_mesh();
    let mut refusals = Refusals::default();
    for (young, poisson, more, place, words) in [
        ("0", "0.3", &[][..], "--young", "Pa, found 0"),
        ("-1kPa", "0.3", &[], "--young", "Pa, found -1000"),
        ("1kPa", "0.5", &[], "--poisson", "found 0.5"),
        ("1kPa", "-1", &[], "--poisson", "found -1"),
        ("1kPa", "0.3", &["--plane", "stress"], "--plane", "solid"),
        ("1kPa", "0.3", &["--thickness", "1"], "--thickness", "solid"),
        ("1kPa", "0.3", &["--objective", "least"], "--objective", "found \"least\""),
        ("1kPa", "0.3", &["--rest", "long", "--objective", "offdiag"], "--rest", "found \"long\""),
        ("1kPa", "0.3", &["--rest", "free", "--objective", "spectral"], "--rest", "found \"free\""),
        ("1kPa", "0.3", &["--rest", "free", "--objective", "baudet"], "--rest", "\"baudet\""),
        ("1kPa", "0.3", &["--objective", "offdiag", "--springs", "edge,diagonal"], "--springs", "found \"diagonal\""),
        ("1kPa", "0.3", &["--scale", "-1"], "--scale", "found -1"),
        ("1kPa", "0.3", &["--density", "-1"], "--density", "kg/m³, found -1"),
        ("1kPa", "0.3", &["--element", "tet9"], "--element", "found \"tet9\""),
    ] {
        let arguments = ["fit", "mesh.msh", "--young", young, "--poisson", poisson, "-o", "springs.csv"];
        let arguments = [&arguments[..], more].concat();
        refusals.expect(&[("mesh.msh", mesh.as_bytes())], &arguments, place, words);
    }
    refusals.finish();
}

#[test]
fn comparisons() {
    let unloaded = BRICK.split("[[load]]").next().unwrap();
    let mut refusals = Refusals::default();
    for (file, arguments, place, words) in [
        (BRICK, &["tet9"][..], "element", "found \"tet9\""),
        (BRICK, &["tet4", "--shapes", "0"], "--shapes", "found 0"),
        (BRICK, &["tet4", "--iterations", "0"], "--iterations", "found 0"),
        (BRICK, &["tet4", "--poisson", "0.5"], "--poisson", "found 0.5"),
        (unloaded, &["scene.toml"], "scene.toml: load", "found none"),
    ] {
        let arguments = [&["compare"], arguments].concat();
        refusals.expect(&[("scene.toml", file.as_bytes())], &arguments, place, words);
    }
    refusals.finish();
}
