//! Quantities with units, and what is assumed of a body that an input does not describe.

use springfit::quantity::Quantity;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

fn springfit(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_springfit")).args(arguments).current_dir(folder).output().unwrap()
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

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
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("roof.msh"), ROOF).unwrap();
    let fit = |young: &str, scale: &str, thickness: &str, density: &str, name: &str| {
        let options = ["fit", "roof.msh", "--young", young, "--poisson", "0.3", "--scale", scale];
        let more = ["--thickness", thickness, "--density", density, "--objective", "offdiag", "-o", name];
        let output = springfit(folder.path(), &[&options[..], &more].concat());
        assert!(output.status.success(), "{}", errors(&output));
        let mut network = springfit::report::read_network(&folder.path().join(name)).unwrap();
        // They differ in the command alone.
        assert!(network.provenance.command.take().is_some_and(|command| command.contains(young)));
        network
    };
    let plain = fit("5000", "0.001", "0.0005", "1060", "plain.json");
    assert_eq!(fit("5 kPa", "mm", "0.5 mm", "1.06 g/cm^3", "units.json"), plain);
    let scene = "[mesh]\nfile = \"roof.msh\"\nscale = \"mm\"\n[material]\nyoung = \"5 kPa\"\npoisson = 0.3\nthickness = \"0.5 mm\"\n\
                 density = \"1060 kg/m^3\"\n[[fit]]\nobjective = \"offdiag\"\n";
    fs::write(folder.path().join("roof.toml"), scene).unwrap();
    let output = springfit(folder.path(), &["run", "roof.toml"]);
    assert!(output.status.success(), "{}", errors(&output));
    let head = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(head.contains("4 points, 2 tri3, 0.100 x 0.100 x 0.050 m; E = 5000 Pa"), "{head}");
}

/// A surface in space is a membrane of some thickness; a plane body without one is a metre thick, and a note says so.
#[test]
fn a_thickness_is_not_assumed_in_silence() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("roof.msh"), ROOF).unwrap();
    fs::write(folder.path().join("flat.msh"), ROOF.replace("100 50", "100 0")).unwrap();
    let fit = |mesh: &str, more: &[&str]| {
        let options = ["fit", mesh, "--young", "1kPa", "--poisson", "0.3", "--objective", "offdiag", "-o", "k.csv"];
        springfit(folder.path(), &[&options[..], more].concat())
    };
    let refused = fit("roof.msh", &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(errors(&refused).starts_with("error: --thickness: "), "{}", errors(&refused));
    assert!(!folder.path().join("k.csv").exists());
    let thick = fit("flat.msh", &[]);
    assert!(thick.status.success() && errors(&thick).contains("assumed to be 1 m"), "{}", errors(&thick));
    for mesh in ["roof.msh", "flat.msh"] {
        let given = fit(mesh, &["--thickness", "1 mm"]);
        assert!(given.status.success() && !errors(&given).contains("assumed"), "{}", errors(&given));
    }
    let scene = "[mesh]\nfile = \"roof.msh\"\n[material]\nyoung = 1\npoisson = 0.3\n[[fit]]\nobjective = \"offdiag\"\n";
    fs::write(folder.path().join("roof.toml"), scene).unwrap();
    let refused = springfit(folder.path(), &["run", "roof.toml"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(errors(&refused).starts_with("error: roof.toml:3: material.thickness: "), "{}", errors(&refused));
    fs::write(folder.path().join("flat.toml"), scene.replace("roof", "flat")).unwrap();
    let noted = springfit(folder.path(), &["run", "flat.toml"]);
    assert!(noted.status.success() && errors(&noted).contains("assumed to be 1 m"), "{}", errors(&noted));
    let report = fs::read_to_string(folder.path().join("out/flat/report.json")).unwrap();
    assert!(report.contains("\"assumed\": \"the thickness"), "{report}");
}
