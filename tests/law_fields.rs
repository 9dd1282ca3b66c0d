//! Laws at large deformation whose numbers and fibres vary from cell to cell.

use crate::kit::{outcome, outcome_in, refusal};
use crate::messages::reads;
use springfit_studies::study::Outcome;
use tempfile::TempDir;

fn scene(material: &str, fits: &str) -> String {
    format!(
        "[mesh]\nbox = {{ element = \"tet4\", size = [1, 1, 2], cells = [2, 2, 4] }}\n{material}\n{fits}\n\
         [[fix]]\ngroup = \"zmin\"\n[[load]]\nname = \"pull\"\ngroup = \"zmax\"\ntraction = [150, 0, 400]\n"
    )
}

const EXACT: &str = "[[fit]]\nobjective = \"exact\"\n";

/// The largest displacement, and the largest difference from another body beside it.
fn difference(a: &Outcome, b: &Outcome) -> f64 {
    let (a, b) = (&a.loads[0].fem, &b.loads[0].fem);
    let size = a.iter().fold(0.0, |size: f64, u| size.max(u.abs()));
    assert!(size > 0.1, "{size}: not a large deformation");
    a.iter().zip(b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) / size
}

/// The exact network of a body whose moduli, parameters and fibres vary is the body.
#[test]
fn exact_networks_follow_the_fields() {
    let moduli = "young = \"1e3*(1 + 2*z + x)\"\npoisson = \"0.25 + 0.1*y\"\n";
    let fibres = "fibre = [\"cos(z)\", \"sin(z)\", 0.5]\nparameters = { stiffness = \"0.3 + 0.4*x\", growth = 0.5 }\n";
    for law in
        ["law = \"stable-neo-hookean\"\n", "law = \"stable-mooney-rivlin\"\n", &format!("law = \"fibre\"\n{fibres}")]
    {
        let found = outcome(&scene(&format!("[material]\n{moduli}{law}"), EXACT));
        let errors = &found.fits[0].loads[0];
        let error = errors.error.as_ref().unwrap();
        assert!(error.rms < 1e-9, "{law}: {:e}", error.rms);
    }
}

/// A field that has two values is two regions, and a constant field or parameter is the number.
#[test]
fn fields_are_regions_of_cells() {
    let folder = TempDir::new().unwrap();
    let of = |material: &str| outcome_in(folder.path(), &scene(material, EXACT)).unwrap();
    let field = of("[material]\nyoung = \"if_(z)\"\npoisson = 0.3\nlaw = \"neo-hookean\"\n"
        .replace("if_(z)", "1e3 + 1e3*step(z - 1)")
        .as_str());
    let regions = of("[[material]]\nwhere = \"z <= 1.00001\"\nyoung = 1e3\npoisson = 0.3\nlaw = \"neo-hookean\"\n\
                      [[material]]\nyoung = 2e3\npoisson = 0.3\nlaw = \"neo-hookean\"\n");
    assert!(difference(&field, &regions) < 1e-9, "{:e}", difference(&field, &regions));
    // Numbers of the key, of the file of the law, and as a field of one value.
    let shipped = springfit_element::material::Energy::load("fibre", field.material.isotropic(0, 0).unwrap()).unwrap();
    let default: Vec<(&str, f64)> = shipped.parameters().collect();
    assert_eq!(default, [("growth", 1.0), ("stiffness", 0.5)]);
    let base = "[material]\nyoung = 1e3\npoisson = 0.3\nlaw = \"fibre\"\n";
    let plain = of(base);
    let same = of(&format!("{base}fibre = [2, 0, 0]\nparameters = {{ stiffness = \"0.5 + 0*x\", growth = 1 }}\n"));
    assert!(difference(&plain, &same) < 1e-9, "{:e}", difference(&plain, &same));
    let own = "name = \"own\"\ntitle = \"Own\"\nfibre = [0, 0, 1]\nparameters = { stiffness = 2, growth = 1 }\n\
               energy = \"mu/2*(I1 - 3) - mu*ln(J) + lambda/2*ln(J)^2 + stiffness*mu/(2*growth)*(exp(growth*(I4 - 1)^2) - 1)\"\n";
    std::fs::write(folder.path().join("own.toml"), own).unwrap();
    let of_file = of("[material]\nyoung = 1e3\npoisson = 0.3\nlaw = \"own.toml\"\n");
    std::fs::write(folder.path().join("f.csv"), "x,y,z,a_x,a_y,a_z\n0,0,0,0,0,3\n1,1,2,0,0,1\n").unwrap();
    let of_keys =
        of(&format!("{base}fibre = {{ file = \"f.csv\", array = \"a\" }}\nparameters = {{ stiffness = 2 }}\n"));
    assert!(difference(&of_file, &of_keys) < 1e-9, "{:e}", difference(&of_file, &of_keys));
    assert!(difference(&plain, &of_file) > 1e-3);
}

#[test]
fn wrong_numbers_of_laws_are_named() {
    let base = "[material]\nyoung = 1e3\npoisson = 0.3\n";
    for (rest, expected) in [
        ("law = \"fibre\"\nparameters = { stifness = 1 }\n", "scene.toml:7: material.parameters: … \"stiffness\"?"),
        (
            "law = \"neo-hookean\"\nparameters = { a = 1 }\n",
            "scene.toml:7: material.parameters: … has no parameters, found \"a\"",
        ),
        ("law = \"neo-hookean\"\nfibre = [1, 0, 0]\n", "scene.toml:… material.fibre: … \"neo-hookean\" has none…"),
        ("law = \"fibre\"\nfibre = [1]\n", "scene.toml:… material.fibre: … two or three components…"),
        ("law = \"fibre\"\nfibre = [\"x - x\", 0, 0]\n", "scene.toml:… material.fibre: … in tet4 cell 1 at …"),
        (
            "law = \"fibre\"\nparameters = { stiffness = \"1/(x - x)\" }\n",
            "scene.toml:… material.parameters.stiffness: … in tet4 cell 1 …",
        ),
        ("parameters = { a = 1 }\n", "scene.toml:… material.parameters: belongs to a law…"),
        ("fibre = [1, 0, 0]\n", "scene.toml:… material.fibre: belongs to a law…"),
    ] {
        reads(&refusal(&scene(&format!("{base}{rest}"), EXACT)), expected).unwrap();
    }
}
