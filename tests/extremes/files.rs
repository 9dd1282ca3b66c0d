//! The numbers of the files that scenes name: elements, materials, meshes, displacements, deformation gradients.

use super::verdict::{Verdict, of_scene};
use super::walk::{at, inline, is_numeric, key, numeric_keys, parse, places, text, with};
use super::{EXTREMES, folder, values};
use springfit_element::element::Element;
use springfit_element::material::{Energy, Material};
use std::collections::BTreeSet;
use std::fs::write;
use std::path::Path;

/// An element with rules that list their points, and formats with orders.
const LISTED: &str = r#"
name = "listed"
title = "Four-node square with listed points"
cell = "quadrilateral"
coordinates = ["xi", "eta"]
nodes = [
    { at = [-1, -1], shape = "(1 - xi)*(1 - eta)/4" },
    { at = [1, -1], shape = "(1 + xi)*(1 - eta)/4" },
    { at = [1, 1], shape = "(1 + xi)*(1 + eta)/4" },
    { at = ["-1", 1.0], shape = "(1 - xi)*(1 + eta)/4" },
]
[quadrature]
rule = "explicit"
points = [["-1/sqrt(3)", "-1/sqrt(3)"], ["1/sqrt(3)", "-1/sqrt(3)"], ["1/sqrt(3)", "1/sqrt(3)"], ["-1/sqrt(3)", "1/sqrt(3)"]]
weights = [1, 1.0, "1", 1]
[volumetric_quadrature]
rule = "degree"
degree = 1
[[springs]]
group = "edge"
kind = "length"
nodes = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 3]]
[formats]
gmsh = { type = 3, order = [0, 1, 2, 3] }
vtk = { type = 9, order = [0, 1, 2, 3] }
"#;

const PLATE: &str = r#"
mesh = { box = { element = "own.toml", size = [1, 1], cells = [1, 1] } }
material = { young = 10e3, poisson = 0.3 }
fit = [{ objective = "frobenius" }]
fix = [{ group = "ymin" }]
load = [{ group = "ymax", traction = [0, 1] }]
"#;

const BLOCK: &str = r#"
mesh = { box = { element = "tet4", size = [1, 1, 1], cells = [1, 1, 1] } }
material = { young = 10e3, poisson = 0.3, law = "own.toml" }
fit = [{ objective = "sampled", shapes = { families = ["uniaxial"], count = 10, held_out = 2 } }]
newton = { steps = 1 }
fix = [{ group = "zmin" }]
load = [{ group = "zmax", traction = [0, 0, 100] }]
"#;

const FROM_FILE: &str = r#"
mesh = { file = "MESH" }
material = { young = 10e3, poisson = 0.3, density = 1000 }
fit = [{ objective = "modal", higher = 0.3 }, { objective = "exact" }]
fix = [{ where = "z <= 0" }]
load = [{ body = [0, 0, 1] }]
"#;

const MEASURED: &str = r#"
mesh = { box = { element = "tet4", size = [1, 1, 1], cells = [1, 1, 1] } }
material = { young = 10e3, poisson = 0.3 }
fit = [{ objective = "frobenius" }]
fix = [{ group = "zmin" }]
load = [{ group = "zmax", displacement = ["free", "free", 0.01], measured = { file = "field.csv" } }]
"#;

const GRADIENTS: &str = r#"
mesh = { box = { element = "tri3", size = [1, 1], cells = [1, 1] } }
material = { young = 10e3, poisson = 0.3, law = "neo-hookean" }
fit = [{ objective = "sampled", shapes = { gradients = "gradients.txt", count = 4, held_out = 0 } }]
fix = [{ group = "ymin" }]
load = [{ group = "ymax", traction = [0, 10] }]
"#;

/// Changes each number of the files with `places`, and runs the scene.
fn sweep(scene: &str, cases: impl Iterator<Item = (String, &'static str, String)>) {
    let folder = folder();
    let path = folder.path().join("scene.toml");
    let (mut count, mut wrong, mut verdicts) = (0, Vec::new(), [0; 3]);
    for (case, name, content) in cases {
        count += 1;
        write(folder.path().join(name), content).unwrap();
        match of_scene(&scene.replace("MESH", name), &path) {
            Err(problem) => wrong.push(format!("{case}: {problem}")),
            Ok(Verdict::Refused) => verdicts[0] += 1,
            Ok(Verdict::Named) => verdicts[1] += 1,
            Ok(Verdict::Right(_)) => verdicts[2] += 1,
        }
    }
    println!("{count} cases: {verdicts:?} refused, named, right");
    assert!(count > 0 && wrong.is_empty(), "{} of {count} cases:\n{}", wrong.len(), wrong.join("\n"));
}

type Problem = fn(&str) -> Option<String>;

/// The cases of files in TOML, all of whose numeric keys are in one of them.
fn documents(files: &[&str], problem: Problem) -> Vec<(String, &'static str, String)> {
    let (mut visited, mut known, mut cases) = (BTreeSet::new(), BTreeSet::new(), Vec::new());
    for file in files {
        assert_eq!(problem(file), None);
        let document = parse(file);
        known.extend(numeric_keys(&problem, &document));
        visited
            .extend(places(&document).iter().filter(|place| at(&document, place).is_table()).map(|place| key(place)));
        for place in places(&document).into_iter().filter(|place| is_numeric(&problem, &document, place)) {
            visited.insert(key(&place));
            for extreme in EXTREMES {
                for value in values(&problem, &document, &place, extreme) {
                    let case = format!("{}: {} = {}", inline(&document["name"]), key(&place), inline(&value));
                    cases.push((case, "own.toml", text(&with(&document, &place, value))));
                }
            }
        }
    }
    let lists = |name: &String| [name.clone(), format!("{name}[]"), format!("{name}[][]")];
    let missing: Vec<&String> =
        known.iter().filter(|name| !lists(name).iter().any(|name| visited.contains(name))).collect();
    assert!(missing.is_empty(), "no sample has {missing:?}; swept are {visited:?}");
    cases
}

fn shipped(path: &str) -> String {
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn every_number_of_an_element_may_be_extreme() {
    let problem: Problem = |text| Element::parse(text).err().map(|error| error.problem().to_string());
    let [triangle, square] = ["elements/tri3.toml", "elements/quad4.toml"].map(shipped);
    sweep(PLATE, documents(&[&triangle, &square, LISTED], problem).into_iter());
}

#[test]
fn every_number_of_a_material_may_be_extreme() {
    let problem: Problem = |text| {
        let material = Material::for_body(3, 10e3, 0.3, None, None).unwrap();
        Energy::parse(text, material).err().map(|error| error.problem().to_string())
    };
    let [fibre, cubic] = ["materials/fibre.toml", "materials/yeoh.toml"].map(shipped);
    sweep(BLOCK, documents(&[&fibre, &cubic], problem).into_iter());
}

/// Two tetrahedra on a common side.
const POINTS: [[f64; 3]; 5] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.1, 0.2, 1.0], [1.0, 1.0, 0.7]];

/// The mesh in each format, whose points are lines of coordinates.
fn mesh_files(points: &[String]) -> [(&'static str, String); 4] {
    let numbered: Vec<String> = points.iter().enumerate().map(|(i, point)| format!("{} {point}", i + 1)).collect();
    let (lines, numbered) = (points.join("\n"), numbered.join("\n"));
    let cells = "2\n1 4 2 0 1 1 2 3 4\n2 4 2 0 1 2 5 3 4";
    let v22 = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n{numbered}\n$EndNodes\n$Elements\n{cells}\n$EndElements\n"
    );
    let v41 = format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 5 1 5\n3 1 0 5\n1\n2\n3\n4\n5\n{lines}\n$EndNodes\n\
         $Elements\n1 2 1 2\n3 1 4 2\n1 1 2 3 4\n2 2 5 3 4\n$EndElements\n"
    );
    let legacy = format!(
        "# vtk DataFile Version 3.0\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n{lines}\nCELLS 2 10\n\
         4 0 1 2 3\n4 1 4 2 3\nCELL_TYPES 2\n10\n10\n"
    );
    let array = |kind: &str, name: &str, more: &str, text: &str| {
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" {more} format=\"ascii\">{text}</DataArray>")
    };
    let xml = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\
         <UnstructuredGrid><Piece NumberOfPoints=\"5\" NumberOfCells=\"2\"><Points>{}</Points><Cells>{}{}{}</Cells></Piece>\
         </UnstructuredGrid></VTKFile>\n",
        array("Float64", "Points", "NumberOfComponents=\"3\"", &lines),
        array("Int64", "connectivity", "", "0 1 2 3 1 4 2 3"),
        array("Int64", "offsets", "", "4 8"),
        array("UInt8", "types", "", "10 10"),
    );
    [("v22.msh", v22), ("v41.msh", v41), ("grid.vtk", legacy), ("grid.vtu", xml)]
}

/// Lines of numbers, one of which is changed.
fn changed(rows: &[Vec<f64>], separator: &str) -> Vec<(String, Vec<String>)> {
    let mut all = Vec::new();
    for (i, j) in (0..rows.len()).flat_map(|i| (0..rows[i].len()).map(move |j| (i, j))) {
        for extreme in EXTREMES {
            let number = |(k, row): (usize, &Vec<f64>)| {
                let words = row.iter().enumerate().map(|(l, x)| if (k, l) == (i, j) { extreme } else { *x });
                words.map(|x| format!("{x:e}")).collect::<Vec<_>>().join(separator)
            };
            all.push((format!("number {j} of line {i} = {extreme:e}"), rows.iter().enumerate().map(number).collect()));
        }
    }
    all
}

#[test]
fn every_coordinate_of_a_mesh_may_be_extreme() {
    let rows = POINTS.map(Vec::from);
    let lines: Vec<String> =
        rows.iter().map(|row| row.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")).collect();
    let folder = folder();
    for (name, content) in mesh_files(&lines) {
        write(folder.path().join(name), content).unwrap();
        let verdict = of_scene(&FROM_FILE.replace("MESH", name), &folder.path().join("scene.toml"));
        assert!(matches!(verdict, Ok(Verdict::Right(_))), "{name}: {verdict:?}");
    }
    let files = |(case, lines): (String, Vec<String>)| {
        mesh_files(&lines).map(|(name, text)| (format!("{name}: {case}"), name, text))
    };
    sweep(FROM_FILE, changed(&rows, " ").into_iter().flat_map(files));
}

#[test]
fn every_measured_number_may_be_extreme() {
    let rows: Vec<Vec<f64>> = (4..8).map(|point| vec![point as f64, 0.001, 0.002, 0.01]).collect();
    let file = |(case, lines): (String, Vec<String>)| {
        // Points are counted: a whole number is written as one.
        let lines: Vec<String> = lines.iter().map(|line| line.replacen("e0,", ",", 1)).collect();
        (case, "field.csv", format!("point,ux,uy,uz\n{}\n", lines.join("\n")))
    };
    sweep(MEASURED, changed(&rows, ",").into_iter().map(file));
}

#[test]
fn every_number_of_a_deformation_gradient_may_be_extreme() {
    let rows: Vec<Vec<f64>> =
        vec![vec![1.1, 0.0, 0.0, 0.95], vec![1.0, 0.1, 0.0, 1.0], vec![0.9, 0.0, 0.1, 1.1], vec![1.0, 0.0, 0.05, 1.2]];
    let file = |(case, lines): (String, Vec<String>)| (case, "gradients.txt", lines.join("\n"));
    sweep(GRADIENTS, changed(&rows, " ").into_iter().map(file));
}

/// So that a sample that is refused from the start does not count.
#[test]
fn the_files_are_right_before_they_are_changed() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    write(path("own.toml"), LISTED).unwrap();
    write(path("field.csv"), "point,ux,uy,uz\n4,0.001,0.002,0.01\n").unwrap();
    write(path("gradients.txt"), "1.1 0 0 0.95\n1 0.1 0 1\n0.9 0 0.1 1.1\n1 0 0.05 1.2\n").unwrap();
    for scene in [PLATE, MEASURED, GRADIENTS] {
        let verdict = of_scene(scene, &path("scene.toml"));
        assert!(matches!(verdict, Ok(Verdict::Right(_))), "{scene}: {verdict:?}");
    }
    write(path("own.toml"), shipped("materials/fibre.toml")).unwrap();
    let verdict = of_scene(BLOCK, Path::new(&path("scene.toml")));
    assert!(matches!(verdict, Ok(Verdict::Right(_))), "{verdict:?}");
}
