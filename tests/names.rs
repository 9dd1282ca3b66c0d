//! Names from outside: what was probably meant by a wrong one, and that none reaches a terminal as a command.

use crate::kit::{said, springfit};
use std::fs;
use tempfile::TempDir;

const SQUARE: &str = "title = \"square\"\n[mesh]\nbox = { element = \"quad4\", size = [1, 1], cells = [2, 2] }\n[material]\n\
                      young = 1000\npoisson = 0.3\nthickness = 0.01\n[[fit]]\nobjective = \"modal\"\nsprings = [\"edge\", \"bulk\"]\n\
                      name = \"first\"\n[[fix]]\ngroup = \"xmin\"\n[[load]]\nname = \"pull\"\ngroup = \"xmax\"\ntraction = [1, 0]\n\
                      [output]\nvtu = true\ncsv = true\n";

/// Every closed list of names suggests the nearest one, and nothing where none is near.
#[test]
fn a_wrong_name_is_answered_with_the_nearest() {
    let folder = TempDir::new().unwrap();
    for (from, to, line, key, meant) in [
        ("\"modal\"", "\"model\"", 9, "fit[0].objective", "modal"),
        ("\"modal\"", "\"van-gelder-simpel\"", 9, "fit[0].objective", "van-gelder-simple"),
        ("\"modal\"", "\"modal\"\nsolver = \"nelder-maed\"", 10, "fit[0].solver", "nelder-mead"),
        ("\"modal\"", "\"frobenius\"\nweight = \"moddal\"", 10, "fit[0].weight", "modal"),
        ("\"quad4\"", "\"qaud4\"", 3, "mesh.box.element", "quad4"),
        ("\"bulk\"]", "\"bluk\"]", 10, "fit[0].springs", "bulk"),
        ("poisson", "posson", 6, "material.posson", "poisson"),
        ("name = \"first\"", "higer = 0.1", 11, "fit[0].higer", "higher"),
        ("\"xmin\"", "\"xmni\"", 13, "fix[0].group", "xmin"),
        ("thickness = 0.01", "thickness = 0.01\nlaw = \"neo-hokean\"", 8, "material.law", "neo-hookean"),
    ] {
        fs::write(folder.path().join("s.toml"), SQUARE.replace(from, to)).unwrap();
        let output = springfit(folder.path(), &["run", "s.toml"]);
        let text = said(&output);
        assert!(text.starts_with(&format!("error: s.toml:{line}: {key}: ")), "{text}");
        assert!(text.ends_with(&format!("; did you mean \"{meant}\"?\n")), "{text}");
        assert_eq!(output.status.code(), Some(2));
    }
    fs::write(folder.path().join("s.toml"), SQUARE.replace("\"modal\"", "\"xyz\"")).unwrap();
    let output = springfit(folder.path(), &["run", "s.toml"]);
    assert!(!said(&output).contains("did you mean"));
}

/// A fault of an option is named by the option as it is typed.
#[test]
fn options_are_named_as_they_are_typed() {
    let folder = TempDir::new().unwrap();
    let mesh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n\
                1 2 2 1 1 1 2 3\n$EndElements\n";
    fs::write(folder.path().join("m.msh"), mesh).unwrap();
    fs::write(folder.path().join("s.toml"), SQUARE).unwrap();
    let common = ["fit", "m.msh", "--young", "1", "--poisson", "0.3", "-o", "k.csv", "--thickness", "1"];
    for (more, key) in [
        (&["--objective", "offdiag", "--springs", "edgy"][..], "--springs"),
        (&["--objective", "ofdiag"], "--objective"),
        (&["--objective", "sampled", "--law", "neo-hookaen"], "--law"),
        (&["--objective", "sampled", "--law", "neo-hookean", "--shapes", "0"], "--shapes"),
        (&["--objective", "offdiag", "--stretch", "0.2"], "--stretch"),
        (&["--scale", "5 kPa"], "--scale"),
        (&["--density", "5 mm"], "--density"),
    ] {
        let output = springfit(folder.path(), &[&common[..], more].concat());
        let text = said(&output);
        assert!(text.starts_with(&format!("error: {key}: ")), "{more:?}: {text}");
    }
    for (arguments, key) in [
        (&["compare", "tri3", "--shapes", "0"][..], "--shapes"),
        (&["compare", "tri3", "--iterations", "0"], "--iterations"),
        (&["compare", "tri3", "--law", "neo-hookaen"], "--law"),
        (&["compare", "tri3", "--poisson", "2"], "--poisson"),
        (&["compare", "tri3", "--stretch", "0.2"], "--stretch"),
        (&["compare", "tri3", "--law", "neo-hookean", "--shapes", "3"], "--shapes"),
        (&["compare", "s.toml", "--shapes", "3"], "--shapes"),
        (&["compare", "s.toml", "--poisson", "0.1"], "--poisson"),
        (&["compare", "s.toml", "--law", "neo-hookean"], "--law"),
        (&["generate", "hex8", "--objective", "lloyd"], "--objective"),
    ] {
        let output = springfit(folder.path(), arguments);
        let text = said(&output);
        assert!(text.starts_with(&format!("error: {key}: ")), "{arguments:?}: {text}");
    }
}

/// Escapes in titles, names and groups are refused, and those of paths replaced wherever they are printed or written.
#[test]
fn no_escape_of_an_input_is_printed_or_written() {
    let folder = TempDir::new().unwrap();
    let escape = "\\u001b[31m\\u0007\\u009b";
    fs::write(folder.path().join("s\u{1b}[31m.toml"), SQUARE.replace("title = \"square\"\n", "")).unwrap();
    let clean = |what: &str, bytes: &[u8]| {
        let text = String::from_utf8_lossy(bytes);
        let found = text.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\t'));
        assert!(found.is_none(), "{what} has {found:?}: {}", text.escape_debug());
    };
    let run = |arguments: &[&str]| {
        let output = springfit(folder.path(), arguments);
        clean("stdout", &output.stdout);
        clean("stderr", &output.stderr);
        output.status.code()
    };
    assert_eq!(run(&["run", "s\u{1b}[31m.toml", "--out", "o\u{1b}"]), Some(0));
    assert_eq!(run(&["converge", "s\u{1b}[31m.toml", "--levels", "2", "--out", "c\u{1b}"]), Some(0));
    for place in ["o\u{1b}", "c\u{1b}"] {
        for entry in fs::read_dir(folder.path().join(place)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|ending| ending != "json") {
                clean(&path.display().to_string(), &fs::read(&path).unwrap());
            }
        }
    }
    for name in ["square", "first", "pull", "xmin"] {
        let text = SQUARE.replace(&format!("\"{name}\""), &format!("\"x{escape}\""));
        fs::write(folder.path().join("g.toml"), text).unwrap();
        assert_eq!(run(&["run", "g.toml"]), Some(2));
    }
    assert_eq!(run(&["run", "none\u{1b}[2J.toml"]), Some(2));
    assert_eq!(run(&["check", "none\u{1b}[2J.toml"]), Some(2));
}

/// Names of fits and loads that together make one name of two arrays are found before the work, and so is a fit with the name of the
/// finite elements.
#[test]
fn names_that_make_equal_names_are_found_before_the_work() {
    let folder = TempDir::new().unwrap();
    let load = "[[load]]\nname = \"pull\"";
    let two = "[[load]]\nname = \"slow pull\"\ngroup = \"xmax\"\ntraction = [2, 0]\n[[fit]]\nobjective = \"offdiag\"\nname = \"first slow\"\n";
    for (from, to, message) in [
        (
            load,
            &format!("{two}{load}")[..],
            ":20: fit[1].name: … \"first slow\", whose array \"u first slow pull (m)\" …",
        ),
        ("\"first\"", "\"fem\"", ":11: fit[0].name: … \"fem\", whose array \"u fem pull (m)\" …"),
        (
            load,
            &format!("[[load]]\nname = \"fem pull\"\ngroup = \"xmax\"\ntraction = [2, 0]\n{load}"),
            ":15: load[0].name: … \"fem pull\", whose array …",
        ),
        ("\"first\"", "\"finite elements\"", ":11: fit[0].name: … a name of its own, found \"finite elements\" again"),
    ] {
        let text = SQUARE.replace(from, to);
        fs::write(folder.path().join("s.toml"), &text).unwrap();
        let output = springfit(folder.path(), &["run", "s.toml"]);
        let found = said(&output);
        crate::messages::reads(found.trim_end(), &format!("error: s.toml{message}")).unwrap();
        assert_eq!((output.status.code(), folder.path().join("out").exists()), (Some(2), false));
    }
    // Without files for ParaView there are no such arrays.
    fs::write(
        folder.path().join("s.toml"),
        SQUARE.replace("\"first\"", "\"fem\"").replace("vtu = true", "vtu = false"),
    )
    .unwrap();
    assert!(springfit(folder.path(), &["run", "s.toml"]).status.success());
}
