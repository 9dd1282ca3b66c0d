//! Messages quote the beginning of long texts, and never what a terminal interprets.

use springfit_element::element::Element;
use springfit_element::material::{Energy, Material};
use springfit_foundation::error::Error;
use springfit_mesh::mesh::{Mesh, MeshSource};
use springfit_studies::study::{Scene, Setting};
use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// The longest line that a reader of messages is shown.
const LONGEST: usize = 4100;
/// The longest text in quotes, in characters: 80 are kept.
const QUOTED: usize = 130;

fn is_short(message: &str) {
    assert!(message.chars().count() < LONGEST, "{} characters: {}", message.len(), message.get(..200).unwrap_or(""));
    assert!(message.split('"').all(|part| part.chars().count() < 4 * QUOTED), "{message}");
    let longest = message.split_whitespace().map(|word| word.chars().count()).max().unwrap_or(0);
    assert!(longest < 2 * QUOTED, "{message}");
    let acts = |c: char| c.is_control() && c != '\n' || ('\u{202a}'..='\u{202e}').contains(&c);
    assert!(!message.contains(acts), "{}", message.escape_debug());
}

fn long(length: usize) -> String {
    "x".repeat(length)
}

#[test]
fn long_keys_names_and_expressions_of_files_are_cut() {
    let element = include_str!("../../elements/tri3.toml");
    let scene = "mesh = { box = { element = \"quad4\", size = [1, 1], cells = [2, 2] } }\nfit = [{ objective = \"exact\" }]\n\
                 material = { young = 1, poisson = 0.3 }\nfix = [{ group = \"xmin\" }]\n";
    let energy = include_str!("../../materials/neo-hookean.toml");
    let solid = Material::for_body(3, 1e4, 0.3, None, None).unwrap();
    let mut checked = 0;
    for length in [200, 10_000, 900_000] {
        let x = long(length);
        let errors: Vec<Error> = [
            Element::parse(&format!("{x} = 1\n{element}")).err(),
            Element::parse(&element.replace("\"xi\" }", &format!("\"{x}\" }}"))).err(),
            Element::parse(&element.replace("\"xi\" }", &format!("\"1 + ({}\" }}", x.replace('x', "x + ")))).err(),
            Element::parse(&element.replace("\"triangle\"", &format!("\"{x}\""))).err(),
            Element::parse(&element.replace("\"edge\"", &format!("\"{x}\\n\""))).err(),
            Energy::parse(&format!("{x} = 1\n{energy}"), solid).err(),
            Energy::parse(&energy.replace("energy", &format!("let.{x} = \"y\"\nenergy")), solid).err(),
            Scene::parse(&format!("{x} = 1\n{scene}"), Path::new("s.toml")).err(),
            Scene::parse(&scene.replace("exact", &x), Path::new("s.toml")).err(),
            Scene::parse(&scene.replace("group = \"xmin\"", &format!("where = \"{x}\"")), Path::new("s.toml")).err(),
            Scene::parse(&scene.replace("young = 1", &format!("young = \"{x}\"")), Path::new("s.toml")).err(),
            Scene::parse(&scene.replace("young = 1", &format!("young = {x}")), Path::new("s.toml")).err(),
            Setting::parse(&x).err(),
            Setting::parse(&format!("{x}\u{1b}=1")).err(),
            Setting::parse(&format!("{x}=[1")).err(),
        ]
        .into_iter()
        .map(|error| error.expect("the input is wrong"))
        .collect();
        for error in &errors {
            is_short(&error.to_string());
            checked += 1;
        }
    }
    println!("{checked} messages");
}

/// Names of groups are listed whole, and are refused where they could not be.
#[test]
fn long_names_of_groups_are_refused() {
    let deck = |name: &str| {
        format!(
            "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4,ELSET={name}\n1,1,2,3,4\n*NSET,NSET=N{name}\n1\n"
        )
    };
    let read = |length: usize| {
        let source = MeshSource::parse(deck(&long(length)).as_bytes(), "inp").unwrap();
        Mesh::resolve(&source, &[], 1.0)
    };
    assert_eq!(read(999).unwrap().groups.len(), 2);
    for length in [1000, 1_000_000] {
        let error = read(length).unwrap_err().to_string();
        is_short(&error);
        assert!(
            error.contains(&format!("groups: expected names of at most 1000 characters, found one of {}", length + 1)),
            "{error}"
        );
    }
}

/// A list of known names is not cut, and its words are not either.
#[test]
fn lists_of_names_are_whole() {
    let error = Element::load("qaud4").unwrap_err().to_string();
    assert!(error.contains("pyramid13") && error.ends_with("did you mean \"quad4\"?"), "{error}");
    let whole = format!("expected one of {}, found \"x\"", ["name"; 300].join(", "));
    assert_eq!(Error::new(whole.clone()).problem(), whole);
    let quoted = format!("found \"{}\" and \"{}\"; did you mean \"b\"?", long(10_000), long(120));
    let cut = format!("found \"{}…\" (10000 characters) and \"{}\"; did you mean \"b\"?", long(80), long(120));
    assert_eq!(Error::new(quoted).problem(), cut);
    // What is cut stays as it is when more is said.
    assert_eq!(Error::new(cut.clone()).followed_by("!").problem(), cut + "!");
}

#[test]
fn arguments_are_printable_and_short_in_every_message() {
    let folder = TempDir::new().unwrap();
    let program = |arguments: &[&str]| {
        let run = Command::new(env!("CARGO_BIN_EXE_springfit")).args(arguments).current_dir(folder.path()).output();
        let output = run.unwrap();
        assert_eq!(output.status.code(), Some(2), "{:?}", arguments[0]);
        String::from_utf8(output.stderr).unwrap()
    };
    fs::write(folder.path().join("s.toml"), "title = 1\n").unwrap();
    let mesh = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"{}\"\n$EndPhysicalNames\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n\
         $EndNodes\n$Elements\n1\n1 2 2 1 1 1 2 3\n$EndElements\n",
        long(50_000)
    );
    fs::write(folder.path().join("m.msh"), mesh).unwrap();
    let scene = "mesh = { file = \"m.msh\" }\nfit = [{ objective = \"exact\" }]\nmaterial = { young = 1, poisson = 0.3 }\nfix = [{ group = \"none\" }]\n";
    fs::write(folder.path().join("g.toml"), scene).unwrap();
    let (x, deep) = (long(60_000), vec![long(200); 15].join("/"));
    for hostile in ["\u{1b}[31mred\u{7}\u{9b}", "a\nb", "\u{202e}", &x] {
        for arguments in [
            &[hostile][..],
            &["run", hostile],
            &["run", "s.toml", "--set", hostile],
            &["run", "s.toml", "--set", &format!("title={hostile}{hostile}")],
            &["run", "s.toml", &format!("--{hostile}")],
            &["run", "s.toml", "--jobs", hostile, "--none"],
            &["derive", "tri3", "--plane", hostile],
            &["derive", hostile],
            &["compare", "tri3", "--shapes", hostile],
            &["generate", "tri3", "--language", hostile],
            &["export", hostile, "--to", hostile],
            &["check", hostile],
        ] {
            is_short(&program(arguments));
        }
    }
    is_short(&program(&["run", &deep]));
    is_short(&program(&["run", "g.toml"]));
    assert!(program(&["run", &format!("{deep}/end.toml")]).contains("/end.toml: "));
}
