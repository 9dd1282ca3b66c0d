//! The command line as a whole: help, completions, manual pages, schemas, JSON, the width of tables, and what is written where.

use crate::kit::{holding, json};
use serde_json::Value;
use springfit_element::element::SHIPPED;
use springfit_fit::fit::published::Method;
use springfit_studies::study::{Forecast, Scene, run};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

const SQUARE: &str = "title = \"square\"\nmesh = { box = { element = \"quad4\", size = [1, 1], cells = [2, 2] } }\n\
                      material = { young = 1e4, poisson = 0.3, thickness = 0.01, density = 1000 }\n\
                      fit = [{ objective = \"exact\" }, { objective = \"divergence\" }]\nfix = [{ group = \"xmin\" }]\n\
                      load = [{ name = \"pull\", group = \"xmax\", traction = [1, 0] }, { name = \"shear\", group = \"xmax\", traction = [0, 1] }]\n";

fn springfit(folder: &Path, variables: &[(&str, &str)], arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_springfit"));
    for name in ["COLUMNS", "NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
        command.env_remove(name);
    }
    command.args(arguments).current_dir(folder).envs(variables.iter().copied()).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Standard output of a run that ends well.
fn printed(folder: &Path, variables: &[(&str, &str)], arguments: &[&str]) -> String {
    let output = springfit(folder, variables, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// What a run in the repository prints.
fn told(arguments: &[&str]) -> String {
    printed(Path::new(ROOT), &[], arguments)
}

fn folder_with_scene() -> TempDir {
    holding("s.toml", SQUARE)
}

/// The subcommands, as the help lists them.
fn commands() -> Vec<String> {
    let help = told(&["--help"]);
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    // A line that goes on has more blanks.
    let begins = |line: &&str| !line.starts_with("   ");
    listed
        .filter(begins)
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .map(String::from)
        .collect()
}

/// No line of help is wider than a page of 120 columns.
#[test]
fn every_help_fits_the_page_and_has_examples_of_its_own_options() {
    let commands = commands();
    assert!(commands.len() >= 14, "{commands:?}");
    for command in &commands {
        let help = told(&[command, "--help"]);
        let longest = help.lines().max_by_key(|line| line.chars().count()).unwrap_or_default();
        assert!(longest.chars().count() <= 120, "{command}: {longest}");
        let examples = help.split("\nExamples:\n").nth(1).unwrap_or_else(|| panic!("{command} has no examples"));
        let own: Vec<&str> = examples.lines().filter(|line| line.contains(&format!("springfit {command}"))).collect();
        assert!(!own.is_empty(), "{command}: {examples}");
        for example in own {
            let example = example.split("  #").next().unwrap_or_default();
            let options = example.split_whitespace().filter(|word| word.starts_with("--"));
            for option in options {
                let option = option.split('=').next().unwrap_or_default();
                assert!(help.contains(option), "{command}: {option} of an example is no option");
            }
        }
    }
    let help = told(&["--help"]);
    for words in ["Exit codes:", "  0 ", "  1 ", "  2 ", "  130 ", "NO_COLOR", "COLUMNS"] {
        assert!(help.contains(words), "{words}");
    }
}

#[test]
fn the_help_of_fit_groups_its_options_and_lists_all_published_methods() {
    let help = told(&["fit", "--help"]);
    for heading in ["Material:", "Fit:", "Mesh:", "Exact networks:", "Sampled fits:", "Output:", "Messages:"] {
        assert!(help.lines().any(|line| line == heading), "{heading}");
    }
    for method in Method::all() {
        assert!(help.contains(method.name()), "{}", method.name());
    }
}

#[test]
fn completions_and_manual_pages_name_every_command() {
    let names = commands();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = told(&["completions", shell]);
        let missing: Vec<_> = names.iter().filter(|name| !script.contains(name.as_str())).collect();
        assert!(missing.is_empty() && script.contains("checkpoint"), "{shell}: {missing:?}");
    }
    let page = told(&["man"]);
    assert!(page.contains(".TH springfit 1") && page.contains("Exit codes"), "{page}");
    for name in &names {
        let page = told(&["man", name]);
        assert!(page.contains(&format!("springfit\\-{name}")), "{page}");
    }
    let output = springfit(Path::new(ROOT), &[], &["man", "rn"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("did you mean \"run\"?"), "{}", text(&output.stderr));
}

#[test]
fn what_is_shipped_is_listed() {
    let elements = told(&["elements"]);
    let materials = told(&["materials"]);
    let names = |list: &str| -> Vec<String> {
        let list: Value = serde_json::from_str(list).unwrap();
        list.as_array().unwrap().iter().map(|entry| entry["name"].as_str().unwrap().to_string()).collect()
    };
    let listed = names(&told(&["elements", "--json"]));
    assert_eq!(listed, SHIPPED.iter().map(|element| element.name).collect::<Vec<_>>());
    assert!(listed.iter().all(|name| elements.lines().any(|line| line.trim_start().starts_with(name.as_str()))));
    let listed = names(&told(&["materials", "--json"]));
    assert_eq!(listed.len(), fs::read_dir(Path::new(ROOT).join("materials")).unwrap().count());
    assert!(listed.iter().all(|name| materials.contains(name.as_str())));
}

/// The groups of a box are known: those of a mesh file are the ones that it names.
#[test]
fn groups_are_listed_with_what_they_hold() {
    let folder = folder_with_scene();
    let record: Value = serde_json::from_str(&printed(folder.path(), &[], &["groups", "s.toml", "--json"])).unwrap();
    let group = record["groups"].as_array().unwrap().iter().find(|group| group["name"] == "xmax").unwrap();
    assert_eq!((&group["sides"], &group["points"]), (&2.into(), &3.into()), "{record}");
    assert_eq!((group["from"][0].as_f64(), group["to"][0].as_f64()), (Some(1.0), Some(1.0)));
    assert!(printed(folder.path(), &[], &["groups", "s.toml"]).contains("xmax"));
    let mesh = Path::new(ROOT).join("scenes/meshes/cube_tet.msh");
    let listed = printed(folder.path(), &[], &["groups", mesh.to_str().unwrap(), "--scale", "mm"]);
    assert!(listed.lines().count() > 3, "{listed}");
}

/// The first group has a face of the body, the second a face whose nodes belong to no cell, the third two sides, of which a cell has one.
#[test]
fn a_group_holds_what_the_body_has_of_it() {
    let folder = TempDir::new().unwrap();
    let mesh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n7\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 5 5 5\n6 6 5 5\n7 5 6 5\n\
                $EndNodes\n$Elements\n5\n1 4 2 1 1 1 2 3 4\n2 2 2 8 1 1 2 3\n3 2 2 2 1 5 6 7\n4 2 2 3 1 4 2 3\n5 2 2 3 1 4 6 3\n\
                $EndElements\n";
    fs::write(folder.path().join("low.msh"), mesh).unwrap();
    let record: Value = serde_json::from_str(&printed(folder.path(), &[], &["groups", "low.msh", "--json"])).unwrap();
    let count = |group: usize, what: &str| record["groups"][group][what].as_u64().unwrap();
    let names: Vec<&str> = (0..4).map(|group| record["groups"][group]["name"].as_str().unwrap()).collect();
    let place = |name: &str| names.iter().position(|known| known.ends_with(name)).unwrap();
    let (lost, half) = (place(":2"), place(":3"));
    assert_eq!((count(lost, "sides"), count(lost, "points"), count(half, "sides")), (0, 0, 1), "{record}");
    assert_eq!((record["groups"][lost]["from"].as_array().unwrap().len(), count(place(":8"), "sides")), (0, 1));
    let listed = printed(folder.path(), &[], &["groups", "low.msh"]);
    assert!(!listed.contains("inf"), "{listed}");
    let scene = printed(folder.path(), &[], &["new", "low.msh"]);
    assert!(scene.contains("nothing of the body") && !scene.contains("group    ="), "{scene}");
    fs::write(folder.path().join("low.toml"), scene).unwrap();
    printed(folder.path(), &[], &["run", "low.toml"]);
}

/// Every mesh of the repository that has a body.
fn meshes() -> Vec<PathBuf> {
    let mut found = Vec::new();
    for folder in ["scenes/meshes", "tests/meshes"] {
        let entries = fs::read_dir(Path::new(ROOT).join(folder)).unwrap().map(|entry| entry.unwrap().path());
        found.extend(
            entries.filter(|path| path.extension().is_some_and(|e| ["msh", "vtu", "vtk"].iter().any(|k| e == *k))),
        );
    }
    found.sort();
    found
}

/// The scene runs as it is written: to a file, where it names the mesh relative to itself, and to standard output.
#[test]
fn a_new_scene_runs_for_every_mesh() {
    let folder = TempDir::new().unwrap();
    fs::create_dir(folder.path().join("scenes")).unwrap();
    let (mut solved, mut tried) = (0, 0);
    for mesh in meshes() {
        let name = mesh.file_name().unwrap().to_str().unwrap();
        fs::copy(&mesh, folder.path().join(name)).unwrap();
        let readable = springfit(folder.path(), &[], &["groups", name]);
        if !readable.status.success() {
            // Some hold no cells, or types that no element has.
            let refused = springfit(folder.path(), &[], &["new", name]);
            assert_eq!((refused.status.code(), &refused.stderr), (Some(2), &readable.stderr), "{name}");
            continue;
        }
        let scene = format!("scenes/{name}.toml");
        printed(folder.path(), &[], &["new", name, "-o", &scene]);
        let written = fs::read_to_string(folder.path().join(&scene)).unwrap();
        assert!(written.contains(&format!("\"../{name}\"")), "{written}");
        let typed = printed(folder.path(), &[], &["new", name]);
        assert_eq!(typed.replace(&format!("\"{name}\""), &format!("\"../{name}\"")), written);
        tried += 1;
        let run = springfit(folder.path(), &[], &["run", &scene, "--json", "--set", "output.report=false"]);
        assert!(run.status.success(), "{name}: {}\n{written}", text(&run.stderr));
        let report: Value = serde_json::from_slice(&run.stdout).unwrap();
        let loads = report["fits"][0]["loads"].as_array().map_or(0, Vec::len);
        solved += usize::from(loads > 0);
    }
    println!("{tried} meshes, {solved} with a load");
    assert!(tried > 40 && solved > 30, "{tried} meshes, {solved} with a load");
    let again = springfit(folder.path(), &[], &["new", "cube_tet.msh", "-o", "scenes/cube_tet.msh.toml"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("is there already"), "{}", text(&again.stderr));
}

/// A surface has no law, and the part of its commented load is a part of it.
#[test]
fn a_new_scene_of_a_surface_names_what_it_may_have() {
    let folder = TempDir::new().unwrap();
    let triangles = "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    fs::write(folder.path().join("small.obj"), triangles).unwrap();
    let scene = printed(folder.path(), &[], &["new", "small.obj", "--scale", "mm"]);
    assert!(!scene.contains("law"), "{scene}");
    assert!(scene.contains("# where = \"x < 0.001\"") && scene.contains("# where = \"x > 0.009\""), "{scene}");
    assert!(!scene.contains("traction ="), "{scene}");
}

/// A name, a path or a group of any characters is quoted.
#[test]
fn a_new_scene_quotes_what_the_mesh_is_called() {
    let folder = TempDir::new().unwrap();
    let name = "it's \"a\" \\ mésh.msh";
    let mesh = fs::read_to_string(Path::new(ROOT).join("scenes/meshes/square_tri.msh")).unwrap();
    fs::write(folder.path().join(name), mesh).unwrap();
    printed(folder.path(), &[], &["new", name, "--scale", "mm", "-o", "s.toml"]);
    let groups = printed(folder.path(), &[], &["groups", "s.toml", "--json"]);
    let extent = serde_json::from_str::<Value>(&groups).unwrap()["extent"][0].as_f64().unwrap();
    assert!(extent < 0.1, "{extent}");
}

/// With --json, standard output is one document with the figures of the table.
#[test]
fn json_is_one_document() {
    let folder = folder_with_scene();
    let document = |arguments: &[&str]| -> Value {
        let output = springfit(folder.path(), &[], arguments);
        serde_json::from_slice(&output.stdout)
            .unwrap_or_else(|e| panic!("{arguments:?}: {e}: {}", text(&output.stderr)))
    };
    let report = document(&["run", "s.toml", "--json", "--out", "o"]);
    let file = json(&folder.path().join("o/report.json"));
    let names =
        |report: &Value| report["fits"].as_array().unwrap().iter().map(|f| f["name"].clone()).collect::<Vec<_>>();
    assert_eq!((names(&report), &report["version"]), (names(&file), &file["version"]));
    let written = springfit(folder.path(), &[], &["run", "s.toml", "--json", "--out", "o"]);
    assert!(text(&written.stderr).contains("written: o/report.json"), "{}", text(&written.stderr));
    assert!(document(&["compare", "s.toml", "--json"])["fits"].as_array().unwrap().len() > 5);
    assert!(
        document(&["compare", "tri3", "--shapes=2", "--iterations=5", "--json"])["cases"][0]["methods"][0]["values"]["frobenius"]["mean"].is_number()
    );
    assert_eq!(document(&["converge", "s.toml", "--levels=2", "--json"])["levels"].as_array().unwrap().len(), 2);
    assert!(document(&["stability", "s.toml", "--json"])["rows"][0]["verdict"].is_string());
    assert!(document(&["check", "tri3", "--json"])[0]["passes"].is_boolean());
    assert!(document(&["run", "s.toml", "--explain", "--json"])["stages"][0]["seconds"].is_number());
}

/// Tables fit COLUMNS, and 100 columns where there is no terminal; each part of a table names its rows.
#[test]
fn tables_fit_the_page() {
    let folder = folder_with_scene();
    for (variables, page) in [(&[][..], 100), (&[("COLUMNS", "60")], 60)] {
        let table = printed(folder.path(), variables, &["compare", "s.toml"]);
        let rows = table.lines().skip(3).filter(|line| !line.starts_with("written: "));
        let longest = rows.max_by_key(|line| line.chars().count()).unwrap();
        assert!(longest.chars().count() <= page, "{page}: {longest}");
        let parts = table.lines().filter(|line| line.trim_start().starts_with("exact  ")).count();
        assert!(parts >= 1 && (page > 60 || parts > 1), "{page}: {parts} parts\n{table}");
    }
    let wide = printed(folder.path(), &[("COLUMNS", "400")], &["compare", "s.toml"]);
    assert_eq!(wide.lines().filter(|line| line.trim_start().starts_with("exact  ")).count(), 1, "{wide}");
}

#[test]
fn quiet_and_verbose() {
    let folder = folder_with_scene();
    let run = |more: &[&str]| {
        let output =
            springfit(folder.path(), &[], &[&["run", "s.toml", "--set", "material.poisson=0.45"], more].concat());
        assert!(output.status.success());
        (text(&output.stdout), text(&output.stderr))
    };
    let (table, notes) = run(&[]);
    assert!(table.contains("written: ") && notes.contains("note: "), "{table}{notes}");
    let (table, notes) = run(&["-q"]);
    assert!(table.contains("divergence") && !table.contains("written: ") && notes.is_empty(), "{table}{notes}");
    let (_, notes) = run(&["-v"]);
    assert!(notes.contains("stage: divergence 0.25: "), "{notes}");
    assert_eq!(springfit(folder.path(), &[], &["run", "s.toml", "-q", "-v"]).status.code(), Some(2));
}

/// Colours are for terminals; CLICOLOR_FORCE asks for them elsewhere, and NO_COLOR turns them off.
#[test]
fn colours_can_be_turned_off() {
    let folder = folder_with_scene();
    let is_coloured = |variables: &[(&str, &str)]| {
        let output = springfit(folder.path(), variables, &["run", "none.toml"]);
        text(&output.stderr).contains('\u{1b}')
    };
    assert!(!is_coloured(&[]));
    assert!(is_coloured(&[("CLICOLOR_FORCE", "1")]));
    assert!(!is_coloured(&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]) && !is_coloured(&[("CLICOLOR", "0")]));
}

/// Nothing is run and nothing is written; sizes are those of the body.
#[test]
fn an_explanation_does_nothing() {
    let folder = folder_with_scene();
    let told = printed(folder.path(), &[], &["run", "s.toml", "--explain"]);
    for words in
        ["9 points, 4 quad4; 12 unknowns", "run       ", "left out  ", "2 loads by finite elements and 2 networks"]
    {
        assert!(told.contains(words), "{words}: {told}");
    }
    printed(folder.path(), &[], &["compare", "s.toml", "--explain"]);
    let levels = printed(folder.path(), &[], &["converge", "s.toml", "--levels=3", "--explain"]);
    assert!(levels.contains("level 3 of 3\n81 points, 64 quad4; 144 unknowns"), "{levels}");
    fs::copy(Path::new(ROOT).join("scenes/meshes/cube_tet.msh"), folder.path().join("m.msh")).unwrap();
    let told =
        printed(folder.path(), &[], &["fit", "m.msh", "--young=1e4", "--poisson=0.3", "--explain", "-o", "k.csv"]);
    assert!(told.contains("fit exact"), "{told}");
    let mut left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["m.msh", "s.toml"]);
}

/// What a fit to the whole object takes is a multiple of the cells' fits: it is counted, with what the finer body takes. The time of one run says how
/// well; the factor leaves room for what else the machine does.
#[test]
fn fits_to_the_whole_object_are_expected() {
    let scene = "[mesh]\nbox = { element = \"tet4\", size = [0.2, 0.05, 0.05], cells = [8, 2, 2] }\n[material]\nyoung = 1e4\n\
                 poisson = 0.3\n[reference]\nfrom = \"quadratic\"\n[[fix]]\ngroup = \"xmin\"\n[[load]]\nname = \"pull\"\n\
                 group = \"xmax\"\ntraction = [10, 0, 0]\n[[fit]]\nname = \"springs\"\nobjective = \"whole\"\nstart = \"divergence\"\n\
                 springs = \"all + volume\"\n[[fit]]\nname = \"smoothed\"\nobjective = \"exact\"\nshear = \"edges\"\n";
    let scene = Scene::parse(scene, Path::new("bar.toml")).unwrap();
    let forecast = Forecast::of(&scene).unwrap();
    assert_eq!(forecast.unknown().count(), 0, "{forecast:?}");
    assert_eq!(forecast.stages[2].name, "finite elements of the finer body", "{forecast:?}");
    let outcome = run(&scene, &mut |_| {}).unwrap();
    let seconds = outcome.fits[0].seconds;
    let expected = forecast.stages[0].seconds.unwrap() + forecast.stages[2].seconds.unwrap();
    assert!(
        expected > seconds / 6.0 && expected < 6.0 * seconds,
        "{expected} s were expected, and it took {seconds} s"
    );
}

/// Scenes of each kind can be explained: large deformation, motion, membranes, whole objects.
#[test]
fn every_shipped_scene_can_be_explained() {
    let scenes = fs::read_dir(Path::new(ROOT).join("scenes")).unwrap().map(|entry| entry.unwrap().path());
    let scenes: Vec<PathBuf> = scenes.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    assert!(scenes.len() > 15);
    for scene in scenes {
        let told = self::told(&["run", scene.to_str().unwrap(), "--explain", "--json"]);
        let forecast: Value = serde_json::from_str(&told).unwrap();
        let stages = forecast["stages"].as_array().unwrap();
        assert!(
            !stages.is_empty() && stages.iter().any(|stage| stage["seconds"].as_f64().is_some_and(|s| s > 0.0)),
            "{told}"
        );
    }
}

/// The name of an entry with `class = "auto"` stands for all its classes.
#[test]
fn the_name_of_an_entry_names_all_its_classes() {
    let folder = TempDir::new().unwrap();
    let element = fs::read_to_string(Path::new(ROOT).join("elements/quad4.toml")).unwrap();
    let element = element.split("[[springs]]").next().unwrap().replace("name        = \"quad4\"", "name = \"own\"");
    let formats = "[[springs]]\ngroup = \"all\"\nkind = \"length\"\nnodes = \"complete\"\nclass = \"auto\"\n";
    fs::write(folder.path().join("own.toml"), format!("{element}{formats}")).unwrap();
    let scene = SQUARE.replace("quad4", "own.toml");
    let run = |groups: &str| {
        let fit = format!("fit = [{{ objective = \"frobenius\", springs = {groups} }}]");
        let scene = scene.replace("fit = [{ objective = \"exact\" }, { objective = \"divergence\" }]", &fit);
        fs::write(folder.path().join("s.toml"), scene).unwrap();
        springfit(folder.path(), &[], &["run", "s.toml", "--json"])
    };
    let springs = |output: Output| {
        let report: Value =
            serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", text(&output.stderr)));
        report["fits"][0]["springs"].clone()
    };
    let all = springs(run("[\"all\"]"));
    assert_eq!(all, springs(run("[\"all 1\", \"all 2\"]")));
    assert_ne!(all, springs(run("[\"all 1\"]")));
    let wrong = run("[\"al\"]");
    assert!(text(&wrong.stderr).contains("did you mean \"all\"?"), "{}", text(&wrong.stderr));
}
