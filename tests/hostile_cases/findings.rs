//! What users found to be answered wrongly in silence.

use crate::kit::{self, holding, json, prints, refused, said, springfit};
use std::fs;
use tempfile::TempDir;

fn folder_with(files: &[(&str, String)]) -> TempDir {
    let folder = TempDir::new().unwrap();
    files.iter().for_each(|(name, text)| fs::write(folder.path().join(name), text).unwrap());
    folder
}

/// The report of a run of this scene.
fn report_of(text: &str) -> serde_json::Value {
    let folder = holding("s.toml", text);
    prints(folder.path(), &["run", "s.toml", "--out", "out"]);
    json(&folder.path().join("out/report.json"))
}

/// What a run of this scene said on standard error.
fn said_of(text: String) -> String {
    let folder = holding("s.toml", text);
    kit::said(&kit::springfit(folder.path(), &["run", "s.toml", "-v", "--out", "out"]))
}

fn bar(element: &str, size: [f64; 3], cells: [usize; 3], more: &str) -> String {
    format!(
        "[mesh]\nbox = {{ element = \"{element}\", size = {size:?}, cells = {cells:?} }}\n[material]\nyoung = 1e5\npoisson = 0.3\ndensity = 1000\n\
         [[fit]]\nname = \"k\"\nobjective = \"exact\"\n[[fix]]\ngroup = \"xmin\"\n{more}"
    )
}

/// The weight of the end of a bar is a load of forces for other programs, not gravity of the whole, also in a sum; gravity of a group that has all
/// cells is that of the whole.
#[test]
fn gravity_on_a_part_is_exported_as_forces() {
    let gravity = |part: &str| format!("[[load]]\nname = \"tip\"\n{part}gravity = [0, 0, -0.5]\n");
    let pull = "[[load]]\nname = \"f\"\ngroup = \"xmax\"\nforce = [0.01, 0, 0]\n[[load]]\nname = \"both\"\nsum = [\"tip\", \"f\"]\n";
    for (part, is_whole) in [("where = \"x > 0.04\"\n", false), ("", true), ("where = \"x > -1\"\n", true)] {
        // XPBD holds springs that do not pull at rest.
        let held = "objective = \"divergence\"\nsprings = [\"all + volume\"]\nnonnegative = true";
        let text =
            bar("tet4", [0.06, 0.02, 0.02], [6, 2, 2], &(gravity(part) + pull)).replace("objective = \"exact\"", held);
        let folder = folder_with(&[("s.toml", text)]);
        prints(folder.path(), &["run", "s.toml", "--out", "out"]);
        let network = json(&folder.path().join("out/k.json"));
        let loads = network["loads"].as_array().unwrap();
        assert_eq!([&loads[0], &loads[2]].map(|load| load["gravity"].is_null()), [!is_whole; 2], "{part}");
        let sum = |load: &serde_json::Value| -> f64 {
            load["forces"].as_array().unwrap().iter().map(|force| force["force"][2].as_f64().unwrap()).sum()
        };
        // 1000 kg/m³ of 2 cm, or of 6 cm, of the bar.
        let weight = if is_whole { -0.5 * 0.024 } else { -0.5 * 0.008 };
        assert!((sum(&loads[0]) / weight - 1.0).abs() < 1e-12 && (sum(&loads[2]) / weight - 1.0).abs() < 1e-12);
        prints(folder.path(), &["export", "s.toml", "--to", "xpbd", "--out", "x"]);
        let written = fs::read_dir(folder.path().join("x")).unwrap().map(|entry| entry.unwrap().path());
        let texts: String = written.filter_map(|path| fs::read_to_string(path).ok()).collect();
        assert_eq!(texts.contains("\"tip\""), !is_whole, "{part}");
    }
}

/// What a motion prescribes in time is not in the files of other programs, which a note says.
#[test]
fn forces_in_time_are_told_to_be_left_out() {
    let motion = "[motion]\nduration = 0.01\nstep = 1e-3\n[[motion.force]]\ngroup = \"xmax\"\nforce = [\"t\", 0, 0]\n";
    let folder = folder_with(&[("s.toml", bar("tet4", [0.06, 0.02, 0.02], [6, 2, 2], motion))]);
    let output = springfit(folder.path(), &["export", "s.toml", "--to", "npz", "--out", "x"]);
    assert!(output.status.success() && said(&output).contains("[[motion.force]]"), "{}", said(&output));
}

/// Prescribed displacements move a body alike whatever its modulus is: no modulus is found where no force acts or is measured.
#[test]
fn a_modulus_that_nothing_shows_is_not_found() {
    let scene = |load: &str, more: &str| {
        let load =
            format!("[[load]]\nname = \"t\"\ngroup = \"xmax\"\n{load}\nmeasured = {{ file = \"u.csv\" }}\n{more}");
        bar("hex8", [0.1, 0.02, 0.02], [4, 1, 1], &load).replace("[[fit]]\nname = \"k\"\nobjective = \"exact\"\n", "")
            + "[calibrate]\nunknowns = \"young\"\nrefinements = 0\n"
    };
    let places: String =
        (1..4).map(|i| format!("{},0.01,0.01,{},0,0\n", 0.025 * f64::from(i), 0.00025 * f64::from(i))).collect();
    let measured = format!("x,y,z,ux,uy,uz\n{places}");
    let moved = "displacement = [0.001, \"free\", \"free\"]";
    let reactions = "reactions = [{ group = \"xmax\", force = [\"400 mN\", \"free\", \"free\"] }]\n";
    let folder = folder_with(&[
        ("alone.toml", scene(moved, "")),
        ("known.toml", scene(moved, reactions)),
        ("pulled.toml", scene("force = [0.4, 0, 0]", "")),
        ("u.csv", measured.clone()),
    ]);
    let told = refused(folder.path(), &["calibrate", "alone.toml"]);
    assert!(told.contains("calibrate.unknowns: expected loads of forces, or \"reactions\""), "{told}");
    for name in ["known.toml", "pulled.toml"] {
        let printed = prints(folder.path(), &["calibrate", name]);
        // 1 kPa at a strain of 1 %: E = 100 kPa, a little more where the held end cannot contract.
        let young = printed
            .lines()
            .find_map(|line| line.split_whitespace().find(|word| word.contains('e') && word.parse::<f64>().is_ok()));
        let young: f64 = young.unwrap().parse().unwrap();
        assert!((young / 1e5 - 1.0).abs() < 0.15, "{printed}");
    }
    // Metres in place of millimetres, and a tenth of the body.
    let times = |factor: f64| -> String {
        let rows =
            (1..4).map(|i| format!("{},0.01,0.01,{},0,0\n", 0.025 * f64::from(i), factor * 0.025 * f64::from(i)));
        format!("x,y,z,ux,uy,uz\n{}", rows.collect::<String>())
    };
    fs::write(folder.path().join("u.csv"), times(10.0)).unwrap();
    let told = refused(folder.path(), &["calibrate", "pulled.toml"]);
    assert!(told.contains("displacements below the size of the body, 0.1 m") && told.contains("0.75 m"), "{told}");
    fs::write(folder.path().join("u.csv"), times(0.3)).unwrap();
    let large = springfit(folder.path(), &["calibrate", "pulled.toml"]);
    let told = kit::told(&large);
    assert!(told.contains("linear theory"), "{told}");
}

/// Linear cells that are large for how a body bends are too stiff, whatever their number across it; cubes of two across, and cells of a body that is
/// pulled, are not called so.
#[test]
fn large_cells_of_a_bent_body_are_too_stiff_whatever_their_number_across() {
    let text = |element: &str, size: [f64; 3], cells: [usize; 3], force: &str| {
        let load =
            format!("[[load]]\nname = \"t\"\ngroup = \"xmax\"\nforce = {force}\n[reference]\nfrom = \"cells\"\n");
        bar(element, size, cells, &load)
    };
    let bent = "[0, 0, -1e-6]";
    for (name, text, is_long) in [
        ("plate", text("hex8", [0.1, 0.1, 0.001], [10, 10, 2], bent), true),
        ("plate of four", text("hex8", [0.1, 0.1, 0.002], [10, 10, 4], bent), true),
        ("tetrahedra", text("tet4", [0.1, 0.02, 0.02], [4, 2, 2], bent), true),
        ("beam of two", text("hex8", [0.1, 0.01, 0.01], [10, 2, 2], bent), true),
        ("beam of three", text("hex8", [0.1, 0.012, 0.012], [10, 3, 3], bent), true),
        // Cells as long as they are thick: half of the energy of bending is missing in tetrahedra, a tenth in hexahedra.
        ("tetrahedra of two", text("tet4", [0.1, 0.01, 0.01], [20, 2, 2], bent), true),
        ("tetrahedra of three", text("tet4", [0.1, 0.01, 0.01], [30, 3, 3], bent), true),
        ("cubes of two", text("hex8", [0.1, 0.01, 0.01], [20, 2, 2], bent), false),
        ("cubes", text("hex8", [0.1, 0.02, 0.02], [20, 4, 4], bent), false),
        ("fine plate", text("hex8", [0.1, 0.1, 0.02], [20, 20, 4], bent), false),
        ("pulled plate", text("hex8", [0.1, 0.1, 0.001], [10, 10, 2], "[1e-6, 0, 0]"), false),
    ] {
        let folder = holding("s.toml", &text);
        let output = springfit(folder.path(), &["run", "s.toml", "--out", "out"]);
        let report = json(&folder.path().join("out/report.json"));
        let is_told = report["finite_elements_verdict"] == "too stiff";
        assert_eq!(is_told, is_long, "{name}: {}", said(&output));
        let words = "the cells are large for the body, which bends under t (by about ";
        assert_eq!(said(&output).contains(words), is_long, "{name}: {}", said(&output));
        if is_long {
            // The deflection by quadratic elements on the same cells is a fifth larger at least.
            let moved = report["fits"][0]["loads"][0]["largest_displacement"].as_f64().unwrap();
            let report = report_of(&text.replace("\"cells\"", "\"quadratic\""));
            let right = report["measured"][0]["largest"].as_f64().unwrap();
            assert!(right > 1.15 * moved, "{name}: {moved} {right}");
        }
    }
}

/// Tables in other units than metres and newtons are not read as if they were in these.
#[test]
fn units_in_the_heads_of_tables_are_read() {
    let springs = |head: &str| format!("i,j,{head}\n0,1,5\n0,2,5\n1,2,5\n0,3,5\n1,3,5\n2,3,5\n");
    let points = |unit: &str| format!("x ({unit}),y ({unit}),z ({unit})\n0,0,0\n1,0,0\n0,1,0\n0,0,1\n");
    let folder = folder_with(&[
        ("k.csv", springs("k (N/m)")),
        ("wrong.csv", springs("k (N/mm)")),
        ("m.csv", points("m")),
        ("mm.csv", points("mm")),
        ("own.csv", "kind,points,constant,rest,unit\nlength,0 1,5,1,N/mm\n".into()),
    ]);
    prints(folder.path(), &["measure", "k.csv", "--points", "m.csv", "--hull"]);
    for (springs, points, words) in [
        ("wrong.csv", "m.csv", "wrong.csv:1: k: expected values in N/m, found (N/mm)"),
        ("k.csv", "mm.csv", "mm.csv:1: x: expected values in m, found (mm)"),
        ("own.csv", "m.csv", "own.csv:2: unit: expected N/m, found \"N/mm\""),
    ] {
        let told = refused(folder.path(), &["measure", springs, "--points", points, "--hull"]);
        assert!(told.contains(words), "{told}");
    }
}

/// A note names a density that no solid has.
#[test]
fn a_density_of_no_solid_is_told() {
    for (density, is_told) in [("7850", false), ("7.85e-9", true), ("7.85e15", true)] {
        let text =
            bar("tet4", [0.06, 0.02, 0.02], [2, 1, 1], "").replace("density = 1000", &format!("density = {density}"));
        let said = said_of(text);
        assert_eq!(said.contains("is that of no solid"), is_told, "{said}");
    }
}

/// A note tells of triangles of a clamped plate that are too large, with about the error that they cause.
#[test]
fn large_triangles_of_a_sheet_are_told() {
    // Clamped and pressed: 0.00126 q a⁴/D in the middle (Timoshenko and Woinowsky-Krieger, table 35, for ν = 0.3).
    let (young, thickness, q, side) = (1e7f64, 0.01f64, 1.0f64, 1.0f64);
    let plate = young * thickness.powi(3) / (12.0 * (1.0 - 0.09));
    let truth = 0.00126 * q * side.powi(4) / plate;
    for (cells, is_told) in [(8, true), (32, false)] {
        let mut points = String::new();
        let mut faces = String::new();
        for i in 0..(cells + 1) * (cells + 1) {
            points += &format!(
                "v {} {} 0\n",
                (i % (cells + 1)) as f64 / cells as f64,
                (i / (cells + 1)) as f64 / cells as f64
            );
        }
        for i in 0..cells * cells {
            let [a, b] = [i / cells * (cells + 1) + i % cells + 1, (i / cells + 1) * (cells + 1) + i % cells + 1];
            faces += &format!("f {a} {} {}\nf {a} {} {b}\n", a + 1, b + 1, b + 1);
        }
        let text = format!(
            "[mesh]\nfile = \"plate.obj\"\nscale = 1\n[material]\nyoung = {young}\npoisson = 0.3\nthickness = {thickness}\nbending = \"plate\"\n\
             [[fit]]\nname = \"sheet\"\nobjective = \"exact\"\n[[fix]]\nwhere = \"x < 1e-6 || x > 0.999999 || y < 1e-6 || y > 0.999999\"\nclamp = true\n\
             [[load]]\nname = \"press\"\nbody = [0, 0, {}]\n",
            q / thickness
        );
        let folder = folder_with(&[("plate.obj", points + &faces), ("s.toml", text)]);
        let output = springfit(folder.path(), &["run", "s.toml", "--out", "out"]);
        assert!(output.status.success(), "{}", said(&output));
        let report = json(&folder.path().join("out/report.json"));
        let found = report["fits"][0]["loads"][0]["largest_displacement"].as_f64().unwrap();
        let off = 100.0 * (found / truth - 1.0).abs();
        let note = said(&output).lines().find(|line| line.contains("too large")).map(str::to_string);
        println!("{cells}: {off:.1} % off; {note:?}");
        assert_eq!(note.is_some(), is_told, "{off}");
        if let Some(note) = note {
            let told: f64 = note.split("about ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
            assert!((0.5..2.0).contains(&(told / off)), "{told} of {off}");
        }
    }
}

/// A note tells of a condition of a material or of a weight that ends within cells, and of none that ends between cells.
#[test]
fn conditions_that_cut_cells_of_a_material_are_told() {
    for (at, is_told) in [(0.03, false), (0.0325, true)] {
        let material = format!(
            "[[material]]\nyoung = 1e5\npoisson = 0.3\ndensity = 1000\nwhere = \"x < {at}\"\n[[material]]\nyoung = 1e6\npoisson = 0.3\ndensity = 1000\n\
             where = \"x >= {at}\"\n"
        );
        let load = format!("[[load]]\nname = \"w\"\nwhere = \"x < {at}\"\ngravity = [0, 0, -9.81]\n");
        let text = bar("hex8", [0.06, 0.02, 0.02], [6, 2, 2], &load)
            .replace("[material]\nyoung = 1e5\npoisson = 0.3\ndensity = 1000\n", &material);
        let printed = said_of(text);
        let told = printed.matches("cuts through 4 cells").count();
        assert_eq!(told, if is_told { 2 } else { 0 }, "{at}: {printed}");
    }
}

/// A length is not compared with an area.
#[test]
fn sides_of_a_condition_are_of_one_kind() {
    let load = |text: &str| format!("[[load]]\nname = \"f\"\nwhere = \"{text}\"\nforce = [0.01, 0, 0]\n");
    for (text, found) in [
        ("x > 5 cm^2", "a length and an area"),
        ("y^2 + z < 1 cm", "an area and a length"),
        ("x*y > 1 mm || x > 5 ml", "an area and a length"),
        ("x/(5 mm) > 10 mm", "a number without a unit and a length"),
    ] {
        let folder = folder_with(&[("s.toml", bar("tet4", [0.06, 0.02, 0.02], [6, 2, 2], &load(text)))]);
        let said = refused(folder.path(), &["run", "s.toml", "--out", "out"]);
        assert!(said.contains(found) && said.contains("quantities of one kind"), "{said}");
    }
    for text in
        ["x > 5 cm", "(x - 60 mm)^2 + y^2 < 25 mm^2", "sqrt(x^2 + y^2) > 4 cm", "x > 4 cm + 0.1*y^2", "x > 0.05"]
    {
        let folder = folder_with(&[("s.toml", bar("tet4", [0.06, 0.02, 0.02], [6, 2, 2], &load(text)))]);
        prints(folder.path(), &["run", "s.toml", "--out", "out"]);
    }
}

/// A body of one cell across that bends at large deformation, or that is asked for vibrations alone, is too stiff, and the run says so.
#[test]
fn one_cell_across_is_too_stiff_with_a_law_and_without_loads() {
    let load = "[[load]]\nname = \"f\"\ngroup = \"xmax\"\nforce = [0, 0, 1e-4]\n";
    let vibrations = "[output]\nfrequencies = 2\n";
    for (law, rest) in [("law = \"stable-neo-hookean\"\n", load), ("", vibrations)] {
        let text = bar("hex8", [0.1, 0.01, 0.01], [10, 1, 1], rest)
            .replace("density = 1000\n", &format!("density = 1000\n{law}"));
        let printed = said_of(text);
        assert!(printed.contains("too stiff"), "{printed}");
    }
}

/// A body whose support is moved as a whole is moved with it at large deformation, without forces.
#[test]
fn a_body_is_moved_as_a_whole_at_large_deformation() {
    for (element, moved) in [("tet4", 0.01), ("hex8", 1e-6)] {
        let load =
            format!("[[load]]\nname = \"a\"\ngroup = \"xmin\"\ndisplacement = [{moved:e}, \"free\", \"free\"]\n");
        let text = bar(element, [0.1, 0.02, 0.02], [5, 2, 2], &load)
            .replace("density = 1000\n", "law = \"stable-neo-hookean\"\n")
            .replace("group = \"xmin\"\n[[load]]", "group = \"xmin\"\naxes = [\"y\", \"z\"]\n[[load]]");
        let report = report_of(&text);
        let fit = &report["fits"][0];
        assert_eq!(fit["status"], "converged", "{fit}");
        let largest = fit["loads"][0]["largest_displacement"].as_f64().unwrap();
        assert!((largest / moved - 1.0).abs() < 1e-9, "{largest} {moved}");
    }
}

/// The mean stress of a lattice whose springs pull is a tension: n springs of 10 N along each axis, each across 1 m.
#[test]
fn the_stress_of_a_pulled_lattice_is_a_tension() {
    let points: String = (0..9).map(|p| format!("{},{}\n", p % 3, p / 3)).collect();
    let mut springs = "i,j,k,rest\n".to_string();
    for p in 0..9 {
        let (x, y) = (p % 3, p / 3);
        let [right, above] = [y * 3 + (x + 1) % 3, (y + 1) % 3 * 3 + x];
        springs += &format!(
            "{p},{right},100,0.9\n{p},{above},100,0.9\n{p},{},100,{}\n",
            (y + 1) % 3 * 3 + (x + 1) % 3,
            2f64.sqrt()
        );
    }
    let folder = folder_with(&[("p.csv", format!("x,y\n{points}")), ("s.csv", springs)]);
    let arguments = ["measure", "s.csv", "--points", "p.csv", "--cell", "3 0, 0 3", "--json"];
    let found: serde_json::Value = serde_json::from_str(&prints(folder.path(), &arguments)).unwrap();
    let stress: Vec<f64> = found["tension"]["stress"].as_array().unwrap().iter().map(|s| s.as_f64().unwrap()).collect();
    assert!((stress[0] - 10.0).abs() < 1e-9 && (stress[1] - 10.0).abs() < 1e-9 && stress[2].abs() < 1e-9, "{stress:?}");
}

/// Cells lock where a change of volume is much stiffer than one of shape, whatever constants say so, and networks that do not lock are not called another
/// material because of elements that do.
#[test]
fn locking_is_seen_of_anisotropic_cells_and_of_regions() {
    let text = |material: &str, fits: &str| {
        format!(
            "[mesh]\nbox = {{ element = \"hex8\", size = [0.1, 0.02, 0.02], cells = [10, 3, 3] }}\n{material}{fits}[[fix]]\ngroup = \"xmin\"\n[[load]]\n\
             name = \"l\"\ngroup = \"xmax\"\ntraction = [0, 0, 5]\n"
        )
    };
    let frobenius = "[[fit]]\nobjective = \"frobenius\"\n";
    let isotropic = report_of(&text("[material]\nyoung = 1e4\npoisson = 0.4999\n", frobenius));
    // The cubic material has the same numbers: λ + 2μ, λ and μ.
    let (mu, lambda): (f64, f64) = (1e4 / (2.0 * 1.4999), 1e4 * 0.4999 / (1.4999 * 0.0002));
    let cubic = format!("[material.cubic]\nc11 = {:?}\nc12 = {lambda:?}\nc44 = {mu:?}\n", lambda + 2.0 * mu);
    let cubic = report_of(&text(&cubic, frobenius));
    for key in ["finite_elements_verdict", "measured"] {
        assert!(isotropic[key] == cubic[key] || key == "measured", "{key}: {} {}", isotropic[key], cubic[key]);
    }
    assert_eq!(cubic["finite_elements_verdict"], "locks");
    let off = |report: &serde_json::Value| report["measured"][0]["fem_e_max"].as_f64().unwrap();
    assert!((off(&cubic) / off(&isotropic) - 1.0).abs() < 1e-6, "{} {}", off(&cubic), off(&isotropic));
    // Muscle: stiff along its fibres, and nearly incompressible. Wood is not, though its shear is soft.
    let fibres = |young: &str, poisson: &str, shear: f64| {
        format!("[material.transversely-isotropic]\nyoung = {young}\npoisson = {poisson}\nshear = {shear}\n[material]\naxes = [[1, 0, 0]]\n")
            .replace("[material.transversely-isotropic]\n", "[material]\ntransversely-isotropic = { ")
            .replace("\npoisson", ", poisson")
            .replace("\nshear", ", shear")
            .replace("\n[material]\n", " }\n")
    };
    let muscle = report_of(&text(&fibres("[5e4, 1e4]", "[0.495, 0.89]", 4e3), frobenius));
    assert_eq!(muscle["finite_elements_verdict"], "locks");
    let wood = report_of(&text(&fibres("[1e7, 5e5]", "[0.37, 0.4]", 6e5), frobenius));
    assert_ne!(wood["finite_elements_verdict"], "locks");
    // Half of the bar is nearly incompressible.
    let regions = "[[material]]\nwhere = \"x < 0.025\"\nyoung = 1e4\npoisson = 0.4999\n[[material]]\nyoung = 1e4\npoisson = 0.3\n";
    let both = "[[fit]]\nobjective = \"exact\"\n[[fit]]\nobjective = \"exact\"\nvolume = \"cells\"\n";
    let report = report_of(&text(regions, both));
    let verdicts = ["exact", "exact cells"].map(|name| {
        let fits = report["fits"].as_array().unwrap().iter();
        fits.clone().find(|fit| fit["name"] == name).unwrap()["verdict"].as_str().unwrap().to_string()
    });
    assert_eq!(verdicts, ["locks", "stable"]);
    // Quadratic cells are too stiff there as well where they are few, and only finer ones tell by how much.
    for (poisson, more, is_told) in
        [("0.4999", "", true), ("0.45", "", false), ("0.4999", "[reference]\nrefine = 1\n", false)]
    {
        let material = format!("[material]\nyoung = 1e4\npoisson = {poisson}\n");
        let text = text(&material, "[[fit]]\nobjective = \"exact\"\n")
            .replace("hex8", "hex20")
            .replace("[10, 3, 3]", "[3, 1, 1]");
        let report = report_of(&(text + more));
        let is_noted = report["notes"].to_string().contains("cells of higher order are too stiff on coarse meshes");
        assert_eq!(is_noted, is_told, "{poisson} {more}: {}", report["notes"]);
    }
}
