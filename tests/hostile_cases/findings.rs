//! What users found to be answered wrongly in silence.

use crate::kit::{prints, refused, said, springfit};
use std::fs;
use tempfile::TempDir;

fn folder_with(files: &[(&str, String)]) -> TempDir {
    let folder = TempDir::new().unwrap();
    files.iter().for_each(|(name, text)| fs::write(folder.path().join(name), text).unwrap());
    folder
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
        let text = fs::read_to_string(folder.path().join("out/k.json")).unwrap();
        let network: serde_json::Value = serde_json::from_str(&text).unwrap();
        let loads = network["loads"].as_array().unwrap();
        assert_eq!([&loads[0], &loads[2]].map(|load| load["gravity"].is_null()), [!is_whole; 2], "{part}");
        let sum = |load: &serde_json::Value| -> f64 {
            load["forces"].as_array().unwrap().iter().map(|force| force["force"][2].as_f64().unwrap()).sum()
        };
        // 1000 kg/m³ of 2 cm, or of 6 cm, of the bar.
        let weight = if is_whole { -0.5 * 0.024 } else { -0.5 * 0.008 };
        assert!((sum(&loads[0]) / weight - 1.0).abs() < 1e-12 && (sum(&loads[2]) / weight - 1.0).abs() < 1e-12);
        let output = springfit(folder.path(), &["export", "s.toml", "--to", "xpbd", "--out", "x"]);
        assert!(output.status.success(), "{}", said(&output));
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
    let told = String::from_utf8_lossy(&large.stdout).into_owned() + &said(&large);
    assert!(told.contains("linear theory"), "{told}");
}

/// Linear cells that are long beside the thickness of a bent body are too stiff, whatever their number across it; cubes of four across, and cells of a
/// body that is pulled, are not called so.
#[test]
fn long_cells_of_a_bent_body_are_too_stiff_whatever_their_number_across() {
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
        ("cubes", text("hex8", [0.1, 0.02, 0.02], [20, 4, 4], bent), false),
        ("fine plate", text("hex8", [0.1, 0.1, 0.02], [20, 20, 4], bent), false),
        ("pulled plate", text("hex8", [0.1, 0.1, 0.001], [10, 10, 2], "[1e-6, 0, 0]"), false),
    ] {
        let folder = folder_with(&[("s.toml", text)]);
        let output = springfit(folder.path(), &["run", "s.toml", "--out", "out"]);
        let report = fs::read_to_string(folder.path().join("out/report.json")).unwrap();
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        let is_told = report["finite_elements_verdict"] == "too stiff";
        assert_eq!(is_told, is_long, "{name}: {}", said(&output));
        assert_eq!(said(&output).contains("long beside the thickness"), is_long, "{name}: {}", said(&output));
        if is_long {
            // The deflection by quadratic elements on the same cells is a fifth larger at least.
            let moved = report["fits"][0]["loads"][0]["largest_displacement"].as_f64().unwrap();
            let scene = fs::read_to_string(folder.path().join("s.toml")).unwrap().replace("\"cells\"", "\"quadratic\"");
            fs::write(folder.path().join("s.toml"), scene).unwrap();
            prints(folder.path(), &["run", "s.toml", "--out", "out"]);
            let report = fs::read_to_string(folder.path().join("out/report.json")).unwrap();
            let report: serde_json::Value = serde_json::from_str(&report).unwrap();
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
        let folder = folder_with(&[("s.toml", text)]);
        let output = springfit(folder.path(), &["run", "s.toml", "--out", "out"]);
        assert_eq!(said(&output).contains("is that of no solid"), is_told, "{}", said(&output));
    }
}
