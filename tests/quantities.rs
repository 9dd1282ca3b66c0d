//! Quantities with units, and what is assumed of a body that an input does not describe.

use crate::kit::{self, holding, json, prints, said, springfit};
use springfit_foundation::quantity::Quantity;
use springfit_foundation::symbolic::Scope;
use std::fs;
use tempfile::TempDir;

/// A roof of two triangles in space, sides of 100.
const ROOF: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 100 0 0\n3 100 100 0\n4 0 100 50\n$EndNodes\n\
                    $Elements\n2\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n$EndElements\n";

/// The same text with a unit is the number without one, to the last bit.
#[test]
fn a_unit_is_a_power_of_ten() {
    for digits in ["1", "2", "3", "0.7", "5e-1", "1060", "25.4"] {
        for (quantity, unit, plain) in [
            (Quantity::Length, "mm", "e-3"),
            (Quantity::Length, "µm", "e-6"),
            (Quantity::Area, "mm^2", "e-6"),
            (Quantity::Pressure, "kPa", "e3"),
            (Quantity::Pressure, "N/mm²", "e6"),
            (Quantity::Density, "g/cm^3", "e3"),
            (Quantity::Time, "ms", "e-3"),
            (Quantity::MeshUnit, "cm", "e-2"),
        ] {
            let exponent: i32 = plain[1..].parse().unwrap();
            let value: f64 = digits.parse().unwrap();
            let expected = if exponent < 0 { value / 10f64.powi(-exponent) } else { value * 10f64.powi(exponent) };
            for text in [format!("{digits}{unit}"), format!(" {digits} {unit} ")] {
                assert_eq!(quantity.parse(&text).unwrap(), expected, "{text}");
            }
            assert_eq!(quantity.parse(digits).unwrap(), value);
        }
    }
    assert_eq!(Quantity::MeshUnit.parse("mm").unwrap(), 1e-3);
    for (quantity, text) in [
        (Quantity::Length, "mm"),
        (Quantity::Length, "5 Pa"),
        (Quantity::Length, "5 mm mm"),
        (Quantity::Pressure, "10 kpa"),
        (Quantity::Density, ""),
        (Quantity::MeshUnit, "inches"),
    ] {
        assert!(quantity.parse(text).is_err(), "{text:?}");
    }
}

/// Every option that takes a quantity takes the units that its key takes in a scene, and the same network comes out.
#[test]
fn options_and_keys_take_the_same_units() {
    let folder = holding("roof.msh", ROOF);
    let fit = |young: &str, scale: &str, thickness: &str, density: &str, name: &str| {
        let options = ["fit", "roof.msh", "--young", young, "--poisson", "0.3", "--scale", scale];
        let more = ["--thickness", thickness, "--density", density, "--objective", "offdiag", "-o", name];
        prints(folder.path(), &[&options[..], &more].concat());
        let mut network = springfit_report::report::read_network(&folder.path().join(name)).unwrap();
        // They differ in the command alone.
        assert!(network.provenance.command.take().is_some_and(|command| command.contains(young)));
        network
    };
    let plain = fit("5000", "0.001", "0.0005", "1060", "plain.json");
    assert_eq!(fit("5 kPa", "mm", "0.5 mm", "1.06 g/cm^3", "units.json"), plain);
    let scene = "[mesh]\nfile = \"roof.msh\"\nscale = \"mm\"\n[material]\nyoung = \"5 kPa\"\npoisson = 0.3\nthickness = \"0.5 mm\"\n\
                 density = \"1060 kg/m^3\"\n[[fit]]\nobjective = \"offdiag\"\n";
    fs::write(folder.path().join("roof.toml"), scene).unwrap();
    let head = prints(folder.path(), &["run", "roof.toml"]);
    assert!(head.contains("4 points, 2 tri3, 0.100 x 0.100 x 0.050 m; E = 5000 Pa"), "{head}");
}

/// A surface in space is a membrane of some thickness; a plane body without one is a metre thick, and a note says so.
#[test]
fn a_thickness_is_not_assumed_in_silence() {
    let folder = holding("roof.msh", ROOF);
    fs::write(folder.path().join("flat.msh"), ROOF.replace("100 50", "100 0")).unwrap();
    let fit = |mesh: &str, more: &[&str]| {
        let options = ["fit", mesh, "--young", "1kPa", "--poisson", "0.3", "--objective", "offdiag", "-o", "k.csv"];
        springfit(folder.path(), &[&options[..], more].concat())
    };
    let refused = fit("roof.msh", &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(said(&refused).starts_with("error: --thickness: "), "{}", said(&refused));
    assert!(!folder.path().join("k.csv").exists());
    let thick = fit("flat.msh", &[]);
    assert!(thick.status.success() && said(&thick).contains("assumed to be 1 m"), "{}", said(&thick));
    for mesh in ["roof.msh", "flat.msh"] {
        let given = fit(mesh, &["--thickness", "1 mm"]);
        assert!(given.status.success() && !said(&given).contains("assumed"), "{}", said(&given));
    }
    let scene = "[mesh]\nfile = \"roof.msh\"\n[material]\nyoung = 1\npoisson = 0.3\n[[fit]]\nobjective = \"offdiag\"\n";
    fs::write(folder.path().join("roof.toml"), scene).unwrap();
    let refused = kit::refused(folder.path(), &["run", "roof.toml"]);
    assert!(refused.starts_with("error: roof.toml:3: material.thickness: "), "{}", refused);
    fs::write(folder.path().join("flat.toml"), scene.replace("roof", "flat")).unwrap();
    let noted = springfit(folder.path(), &["run", "flat.toml"]);
    assert!(noted.status.success() && said(&noted).contains("assumed to be 1 m"), "{}", said(&noted));
    let report = fs::read_to_string(folder.path().join("out/flat/report.json")).unwrap();
    assert!(report.contains("\"assumed\": \"the thickness of the plane body"), "{report}");
    // Where one of several materials gives a thickness, the others do not have it.
    let part = scene
        .replace("roof", "flat")
        .replace("poisson = 0.3\n", "poisson = 0.3\nthickness = 0.01\nwhere = \"x < 50\"\n");
    let part = part
        .replace("[material]", "[[material]]")
        .replace("[[fit]]", "[[material]]\nyoung = 1\npoisson = 0.3\n[[fit]]");
    fs::write(folder.path().join("part.toml"), part).unwrap();
    let noted = springfit(folder.path(), &["run", "part.toml"]);
    let words = "the thickness of the cells whose material gives none is assumed to be 1 m, not that of the others";
    assert!(noted.status.success() && said(&noted).contains(words), "{}", said(&noted));
}

/// Loads in other units are those of the same numbers in N, N·m and m/s², those over time too; another quantity is refused with its place.
#[test]
fn loads_have_units() {
    let folder = TempDir::new().unwrap();
    let scene = |force: &str, gravity: &str, later: &str| {
        format!(
            "[mesh]\nbox = {{ element = \"hex8\", size = [0.1, 0.1, 0.1], cells = [2, 2, 2] }}\n\
             [material]\nyoung = 1e4\npoisson = 0.3\ndensity = 1000\n[[fit]]\nobjective = \"exact\"\n[[fix]]\ngroup = \"zmin\"\n\
             [[load]]\nname = \"pull\"\ngroup = \"zmax\"\nforce = [0, 0, {force}]\n[[load]]\nname = \"own\"\ngravity = [0, 0, {gravity}]\n\
             [motion]\nduration = 0.01\nstep = 1e-3\ngravity = [0, 0, {gravity}]\n[[motion.force]]\ngroup = \"zmax\"\nforce = [{later}, 0, 0]\n"
        )
    };
    let run = |text: String| {
        fs::write(folder.path().join("load.toml"), text).unwrap();
        springfit(folder.path(), &["run", "load.toml"])
    };
    let report = |text: String| {
        let output = run(text);
        assert!(output.status.success(), "{}", said(&output));
        let report = json(&folder.path().join("out/load/report.json"));
        let moved = |record: &serde_json::Value| record["largest_displacement"].as_f64().unwrap();
        let fit = report["fits"][0]["loads"].as_array().unwrap().iter().map(moved).collect::<Vec<_>>();
        (fit, report["motion"].as_array().unwrap().iter().map(moved).collect::<Vec<_>>())
    };
    let plain = report(scene("-0.05", "-9.81", "\"0.02*t\""));
    assert!(
        plain.0.len() == 2 && plain.1.len() == 2 && plain.0.iter().chain(&plain.1).all(|moved| *moved > 0.0),
        "{plain:?}"
    );
    assert_eq!(report(scene("\"-50 mN\"", "\"-981 cm/s^2\"", "\"(20 mN)*t\"")), plain);
    let refused = run(scene("\"5 Pa\"", "0", "0"));
    assert_eq!(refused.status.code(), Some(2));
    let told = said(&refused);
    assert!(told.starts_with("error: load.toml:14: load[0].force[2]: ") && told.contains("units: N, kN"), "{told}");
}

/// Powers as `^3`, `³` and `3`, micro in either letter, and units that are no powers of ten, by their definitions (NIST SP 811, appendix B).
#[test]
fn units_are_read_as_people_write_them() {
    for (quantity, text, value) in [
        (Quantity::Density, "1.06 g/cm3", 1060.0),
        (Quantity::Density, "1.06 g/cc", 1060.0),
        (Quantity::Density, "1.06g/mL", 1060.0),
        (Quantity::Density, "1060 kg/m3", 1060.0),
        (Quantity::Density, "1.06 kg/l", 1060.0),
        (Quantity::Density, "1.06e-9 t/mm^3", 1060.0),
        (Quantity::Pressure, "100 mmHg", 13332.2387415),
        (Quantity::Pressure, "10 cmH2O", 980.665),
        (Quantity::Pressure, "1 psi", 6894.757293168),
        (Quantity::Pressure, "5 kN/m2", 5000.0),
        (Quantity::Pressure, "1 dyn/cm²", 0.1),
        (Quantity::Length, "2 in", 0.0508),
        (Quantity::Length, "3 μm", 3e-6),
        (Quantity::Area, "2 mm2", 2e-6),
        (Quantity::Volume, "30 cm3", 30e-6),
        (Quantity::Volume, "2 µl", 2e-9),
        (Quantity::Time, "2 min", 120.0),
        (Quantity::Force, "-3 mN", -0.003),
        (Quantity::Force, "2 µN", 2e-6),
        (Quantity::Force, "1 kgf", 9.80665),
        (Quantity::Force, "1 lbf", 4.4482216152605),
        (Quantity::Force, "1e5 dyn", 1.0),
        (Quantity::Moment, "5 N mm", 0.005),
        (Quantity::Moment, "2 mN m", 0.002),
        (Quantity::Acceleration, "981 cm/s²", 9.81),
        (Quantity::MeshUnit, "in", 0.0254),
    ] {
        let found = quantity.parse(text).unwrap();
        assert!((found / value - 1.0).abs() < 1e-14, "{text}: {found}");
    }
    // What is read is what is listed, and no more.
    for (quantity, text) in [(Quantity::Length, "2^3 m"), (Quantity::Area, "2 mm3"), (Quantity::Density, "1 g/cm")] {
        let error = quantity.parse(text).unwrap_err().to_string();
        assert!(error.contains("units: "), "{error}");
    }
}

/// A number with a unit in a condition or an expression is the number in the SI unit; where readers would differ it is refused.
#[test]
fn numbers_in_expressions_have_units() {
    let place = Scope::of_place(3);
    for (with, without) in [
        ("z < -10mm", "z < -0.01"),
        ("x^2 + y^2 <= 25 mm^2 && !(z > 2 cm)", "x^2 + y^2 <= 25e-6 && !(z > 0.02)"),
        ("x*y*z < 3 ml", "x*y*z < 3e-6"),
        ("x/(5 mm) > 1", "x/0.005 > 1"),
        ("(2 mm)^2 > x^2", "0.002^2 > x^2"),
        ("x > 1e-1 in", "x > 0.00254"),
    ] {
        assert_eq!(place.predicate(with).unwrap(), place.predicate(without).unwrap(), "{with}");
    }
    for (text, said) in [
        ("x < 1/2 mm", "(2 mm)"),
        ("x/5 mm < 1", "(5 mm)"),
        ("x < 2 mm^4", "(2 mm)"),
        ("x < 5 kPa", "an operator, or a unit such as mm"),
        ("x < 5 mmm", "an operator, or a unit such as mm"),
    ] {
        let error = place.predicate(text).unwrap_err().to_string();
        assert!(error.contains(said), "{text}: {error}");
    }
    // A value has units of its own quantity, and those of lengths where the place decides.
    let value = |text: &str| Scope::value_over(&["x", "y", "z"], Some(Quantity::Pressure), text);
    let plain = |text: &str| Scope::new(&["x", "y", "z"]).expression(text).unwrap();
    assert_eq!(value("10 kPa*(1 + x/(5 mm))").unwrap(), plain("1e4*(1 + x/0.005)"));
    assert_eq!(value("2*10 kPa").unwrap(), plain("2e4"));
    for wrong in ["10 mm", "2*10 mm", "1 kg/m^3"] {
        assert!(value(wrong).is_err(), "{wrong}");
    }
    // The scope of elements and energies has none.
    assert!(Scope::new(&["x"]).expression("10 mm").is_err());
}

/// The edge of the cells of a fill is a number of mesh units or a length with a unit, in options and in scenes.
#[test]
fn a_fill_takes_a_length_with_a_unit() {
    let folder = TempDir::new().unwrap();
    let corners = [[0, 0, 0], [20, 0, 0], [20, 20, 0], [0, 20, 0], [0, 0, 20], [20, 0, 20], [20, 20, 20], [0, 20, 20]];
    let sides = [[1, 4, 3, 2], [5, 6, 7, 8], [1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8]];
    let mut text: String = corners.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    sides.iter().for_each(|[a, b, c, d]| text += &format!("f {a} {b} {c} {d}\n"));
    fs::write(folder.path().join("cube.obj"), text).unwrap();
    let network = |fill: &str, name: &str| {
        let options = ["fit", "cube.obj", "--scale", "mm", "--fill", fill, "--young", "1 kPa", "--poisson", "0.3"];
        prints(folder.path(), &[&options[..], &["-o", name]].concat());
        fs::read_to_string(folder.path().join(name)).unwrap()
    };
    let plain = network("4", "plain.csv");
    assert!(plain.lines().count() > 100);
    assert_eq!(network("4 mm", "units.csv"), plain);
    assert_eq!(network("0.4cm", "units.csv"), plain);
    let drafted = springfit(folder.path(), &["new", "cube.obj", "--scale", "mm", "--fill", "4 mm"]);
    let scene = String::from_utf8_lossy(&drafted.stdout).into_owned();
    assert!(scene.contains("cell = \"4 mm\""), "{scene}");
    fs::write(folder.path().join("cube.toml"), scene).unwrap();
    let output = springfit(folder.path(), &["groups", "cube.toml"]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("216 points"), "{}", said(&output));
    let options = ["fit", "cube.obj", "--fill", "4 kPa", "--young", "1 kPa", "--poisson", "0.3", "-o", "k.csv"];
    let refused = kit::refused(folder.path(), &options);
    assert!(refused.starts_with("error: --fill: expected a length"), "{}", refused);
}

/// A body of a hundred metres, or of a hundredth of a millimetre, whose unit nobody has stated has a note wherever a mesh is read.
#[test]
fn a_forgotten_unit_is_told() {
    let folder = holding("roof.msh", ROOF);
    let constants = ["--young", "1kPa", "--poisson", "0.3", "--thickness", "1 mm", "--objective", "offdiag", "-o"];
    let said = |first: &[&str], scale: Option<&str>| {
        let scale = scale.map_or(Vec::new(), |scale| vec!["--scale", scale]);
        let output = springfit(folder.path(), &[first, &scale].concat());
        assert!(output.status.success(), "{first:?}: {}", said(&output));
        said(&output)
    };
    for command in [
        vec!["groups", "roof.msh"],
        vec!["new", "roof.msh"],
        [&["fit", "roof.msh"][..], &constants, &["k.csv"]].concat(),
    ] {
        let note = said(&command, None);
        assert!(note.contains("taken in metres: the body is 100 m long; --scale mm"), "{note}");
        assert!(said(&command, Some("1e-7")).is_empty() || !said(&command, Some("1e-7")).contains("taken in metres"));
        for stated in ["mm", "m", "0.001"] {
            assert!(!said(&command, Some(stated)).contains("taken in metres"), "{command:?} {stated}");
        }
    }
    fs::write(folder.path().join("small.msh"), ROOF.replace("100", "1e-5").replace(" 50", " 5e-6")).unwrap();
    let note = said(&["groups", "small.msh"], None);
    assert!(note.contains("the body is 0.00001 m long") || note.contains("the body is 1e-5 m long"), "{note}");
    let scene = |scale: &str| {
        let text = format!(
            "[mesh]\nfile = \"roof.msh\"\n{scale}\n[material]\nyoung = 1\npoisson = 0.3\nthickness = 0.1\n[[fit]]\nobjective = \"offdiag\"\n"
        );
        fs::write(folder.path().join("roof.toml"), text).unwrap();
        said(&["run", "roof.toml"], None)
    };
    assert!(scene("").contains("taken in metres: the body is 100 m long; scale = \"mm\""));
    assert!(!scene("scale = \"m\"").contains("taken in metres"));
}
