//! Networks as the files of other programs: what is held is written whole, what is not is refused with a way out.

use crate::kit::{holding, outcome, ran};
use springfit::export::{Content, TARGETS, Target, target_named, with_warnings};
use springfit_bodies::engine::{Engine, Setting};
use springfit_bodies::model::Elastic;
use springfit_foundation::error::ErrorKind;
use springfit_report::report::{Division, NetworkFile, NetworkRecord, Parts};
use std::collections::BTreeMap;
use std::fs;
use std::sync::LazyLock;
use tempfile::TempDir;

const SCENE: &str = "
[mesh]
box = { element = \"tet4\", size = [1, 1, 1], cells = [2, 2, 2] }
[material]
young = 1e4
poisson = 0.3
density = 1000
[[fit]]
objective = \"exact\"
[[fit]]
name = \"classical\"
objective = \"offdiag\"
nonnegative = true
[[fit]]
name = \"patches\"
objective = \"exact\"
volume = \"patches\"
[[fit]]
name = \"free\"
objective = \"frobenius\"
[[fix]]
group = \"zmin\"
";

fn networks(text: &str) -> BTreeMap<String, NetworkRecord> {
    let outcome = outcome(text);
    outcome.fits.iter().map(|fit| (fit.fit.name.clone(), NetworkFile::of(&outcome, fit).record())).collect()
}

/// The networks of the scene, which are the same for every test.
static NETWORKS: LazyLock<BTreeMap<String, NetworkRecord>> = LazyLock::new(|| networks(SCENE));

/// Its network of springs on lengths alone.
fn classical() -> NetworkRecord {
    NETWORKS["classical"].clone()
}

fn texts(target: &str, network: &NetworkRecord) -> BTreeMap<&'static str, Vec<u8>> {
    let files = target_named(target).unwrap().files(network, None).unwrap();
    let bytes = |content| match content {
        Content::Bytes(bytes) => bytes,
        Content::Grid(grid) => format!("{} points", grid.points.len()).into_bytes(),
    };
    files.into_iter().map(|(name, content)| (name, bytes(content))).collect()
}

#[test]
fn each_program_takes_the_fits_that_it_holds_and_names_one_for_the_others() {
    let negative = NETWORKS["free"].springs.iter().any(|spring| spring.constant < 0.0);
    for target in &TARGETS {
        for (name, network) in &*NETWORKS {
            let held = match (target.name, name.as_str()) {
                ("vtu", _) => true,
                (_, "patches") => false,
                ("lammps" | "sofa" | "phystwin", "exact") => false,
                ("jolt" | "xpbd", "exact") => false,
                ("jolt" | "xpbd" | "phystwin", "free") => !negative,
                _ => true,
            };
            match target.files(network, None) {
                Ok(files) => {
                    assert!(held, "{} takes {name}", target.name);
                    assert!(!files.is_empty());
                }
                Err(error) => {
                    assert!(!held, "{} refuses {name}: {error}", target.name);
                    assert_eq!(error.kind(), ErrorKind::Unsupported);
                    let text = error.to_string();
                    assert!(text.contains("expected") && text.contains("found") && text.contains(';'), "{text}");
                    assert!(["objective", "volume", "nonnegative"].iter().any(|key| text.contains(key)), "{text}");
                }
            }
        }
    }
}

#[test]
fn a_network_that_lacks_something_is_refused() {
    let without = |line: &str| networks(&SCENE.replace(line, ""));
    let light = without("density = 1000\n");
    let error = |target: &str, network: &NetworkRecord, gravity: Option<&[f64]>| -> String {
        target_named(target).unwrap().files(network, gravity).err().unwrap().to_string()
    };
    assert!(error("newton", &light["exact"], None).contains("masses: expected a mass of each point, found none; give"));
    assert!(error("newton", &NETWORKS["exact"], Some(&[0.0, 1.0])).contains("--gravity: expected 3 numbers"));
    let sliding = networks(&SCENE.replace("group = \"zmin\"", "group = \"zmin\"\naxes = [\"z\"]"));
    assert!(error("mujoco", &sliding["classical"], None).contains("held in all directions"));
    assert!(target_named("lammps").unwrap().files(&sliding["classical"], None).is_ok());
    let plane = SCENE
        .replace("tet4", "tri3")
        .replace("[1, 1, 1]", "[1, 1]")
        .replace("[2, 2, 2]", "[2, 2]")
        .replace("zmin", "ymin");
    let plane = networks(&plane.replace("density", "plane = \"strain\"\ndensity"));
    assert!(error("mujoco", &plane["classical"], None).contains("take a solid body"));
    assert!(target_named("lammps").unwrap().files(&plane["classical"], None).is_ok());
    assert!(target_named("npz").unwrap().files(&plane["exact"], None).is_ok());
    let unknown = target_named("lamps").err().unwrap().to_string();
    assert!(
        unknown.contains("--to: expected one of mujoco, newton") && unknown.ends_with("did you mean \"lammps\"?"),
        "{unknown}"
    );
}

#[test]
fn lammps_has_half_the_constant_of_each_spring() {
    let network = &NETWORKS["classical"];
    let files = texts("lammps", network);
    let data = String::from_utf8(files["network.data"].clone()).unwrap();
    let section = |name: &str| -> Vec<Vec<f64>> {
        let lines = data.split(&format!("\n{name}")).nth(1).unwrap().lines().skip(2);
        let number = |word: &str| word.parse().unwrap();
        lines.take_while(|line| !line.is_empty()).map(|line| line.split(' ').map(number).collect()).collect()
    };
    let (coefficients, bonds) = (section("Bond Coeffs"), section("Bonds"));
    assert_eq!((coefficients.len(), bonds.len()), (network.springs.len(), network.springs.len()));
    for (spring, (coefficient, bond)) in network.springs.iter().zip(coefficients.iter().zip(&bonds)) {
        assert_eq!(coefficient[1..], [spring.constant / 2.0, spring.rest]);
        assert_eq!(bond[2..], [spring.points[0] as f64 + 1.0, spring.points[1] as f64 + 1.0]);
    }
    let masses = section("Masses");
    let total: f64 = section("Atoms").iter().map(|atom| masses[atom[2] as usize - 1][1]).sum();
    assert!((total - 1000.0).abs() < 1e-9, "{total}");
    let input = String::from_utf8(files["in.network"].clone()).unwrap();
    assert!(input.contains("setforce 0 NULL NULL") && input.contains("mass*(-9.81e0)"), "{input}");
}

/// The grammar of SOFA's loader: `mass` has ten words after its name, the second of which is `s` or `v`, `lspg` six, and both count from 1.
#[test]
fn sofa_has_held_points_as_negative_masses() {
    let network = &NETWORKS["classical"];
    let text = String::from_utf8(texts("sofa", network)["network.xs3"].clone()).unwrap();
    let lines = |name: &str| -> Vec<Vec<f64>> {
        let own = text.lines().filter_map(|line| line.strip_prefix(&format!("{name} ")));
        own.map(|line| line.split(' ').map(|word| word.parse().unwrap_or(f64::NAN)).collect()).collect()
    };
    let (masses, springs) = (lines("mass"), lines("lspg"));
    assert!(text.starts_with("Xsp 3.0\nnumm 27\n") && lines("nums") == [[network.springs.len() as f64]], "{text}");
    assert!(
        masses.iter().all(|line| line.len() == 10 && line[1].is_nan()) && springs.iter().all(|line| line.len() == 6)
    );
    assert_eq!(masses.iter().filter(|line| line[8] < 0.0).count(), network.held.len());
    for (line, spring) in springs.iter().zip(&network.springs) {
        assert_eq!(
            line[1..],
            [spring.points[0] as f64 + 1.0, spring.points[1] as f64 + 1.0, spring.constant, 0.0, spring.rest]
        );
    }
}

#[test]
fn damping_that_a_program_lacks_is_named() {
    let damped = |damping: &str| {
        let motion =
            format!("\n[motion]\nduration = 0.01\nstep = 1e-4\nfinite_elements = false\ndamping = {{ {damping} }}\n");
        networks(&format!("{SCENE}{motion}")).remove("exact").unwrap()
    };
    let (rayleigh, ratio) = (damped("rayleigh = [2, 1e-4]"), damped("ratio = 0.05"));
    let words = |target: &Target, network: &NetworkRecord| target.left_out(network).join("; ");
    for target in &TARGETS {
        assert!(words(target, &rayleigh).contains("stiffness, 1e-4 s, is left out"), "{}", target.name);
        let lacks_mass = ["newton", "jolt", "xpbd", "sofa"].contains(&target.name);
        assert_eq!(words(target, &rayleigh).contains("mass, 2e0 1/s, is left out"), lacks_mass, "{}", target.name);
        let lacks_contents = ["newton", "blender", "npz"].contains(&target.name);
        assert_eq!(words(target, &ratio).contains("dampers of springs on contents"), lacks_contents, "{}", target.name);
    }
}

#[test]
fn phystwin_has_the_gravity_of_its_own_and_no_other() {
    let network = &NETWORKS["classical"];
    let files = |gravity: &[f64]| target_named("phystwin").unwrap().files(network, Some(gravity));
    assert!(files(&[0.0, 0.0, -9.8]).is_ok() && files(&[0.0, 0.0, 9.8]).is_ok());
    for gravity in [[0.0, 0.0, -1.0], [0.0, -9.8, 0.0], [0.0; 3]] {
        let text = files(&gravity).err().unwrap().to_string();
        assert!(text.contains("--gravity: expected 9.8 m/s² along z"), "{text}");
    }
}

#[test]
fn a_scene_and_its_network_give_the_same_files_and_a_refusal_leaves_none() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    // A body that stands its weight.
    fs::write(at("s.toml"), SCENE.replace("1e4", "1e6")).unwrap();
    let (code, text) = ran(folder.path(), &["run", "s.toml", "--out", "o"]);
    assert_eq!(code, Some(0), "{text}");
    for (from, to) in [("s.toml", "a"), ("o/classical.json", "b")] {
        let fit: &[&str] = if from == "s.toml" { &["--fit", "classical"] } else { &[] };
        let arguments = [&["export", from, "--to", "lammps", "--out", to], fit].concat();
        let (code, text) = ran(folder.path(), &arguments);
        assert!(code == Some(0) && text.contains("run it: cd "), "{text}");
    }
    for name in ["network.data", "in.network"] {
        assert_eq!(fs::read(at("a").join(name)).unwrap(), fs::read(at("b").join(name)).unwrap());
    }
    for (arguments, words) in [
        (
            &["export", "o/exact.json", "--to", "lammps"][..],
            "o/exact.json: springs: expected springs between two points",
        ),
        (&["export", "o/exact.json", "--to", "newton", "--fit", "exact"], "--fit: belongs to a scene"),
        (&["export", "s.toml", "--to", "newton", "--fit", "clasical"], "did you mean \"classical\"?"),
        (&["export", "o/exact.json", "--to", "newton", "--gravity", "down"], "--gravity: expected numbers"),
        (&["export", "o/report.json", "--to", "newton"], "format: expected"),
        (&["export", "o/none.json", "--to", "newton"], "cannot be read"),
    ] {
        let before = fs::read_dir(folder.path()).unwrap().count();
        let (code, text) = ran(folder.path(), arguments);
        assert!(code == Some(2) && text.contains(words), "{arguments:?}: {text}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), before, "{arguments:?}");
    }
}

/// The rule by which bodies come to rest is in one file, and put into each script that imports it.
#[test]
fn scripts_stand_alone() {
    for target in ["mujoco", "newton", "blender"] {
        let script = String::from_utf8(texts(target, &NETWORKS["exact"])["run.py"].clone()).unwrap();
        assert_eq!(script.matches("def settle(").count(), 1, "{target}");
        assert!(!script.contains("import settle"), "{target}");
    }
}

/// Also of targets that only pass gravity on.
#[test]
fn gravity_has_the_dimension_of_the_network() {
    let network = &NETWORKS["classical"];
    for target in &TARGETS {
        let error = target.files(network, Some(&[0.0, -9.81])).err().unwrap().to_string();
        assert_eq!(error, "--gravity: expected 3 numbers in m/s², found 2", "{}", target.name);
    }
    let picture = target_named("vtu").unwrap();
    let error = picture.files(network, Some(&[0.0, 0.0, -1.0])).err().unwrap().to_string();
    let expected = "--gravity: belongs to programs that move the network, found it with vtu, which is a picture";
    assert_eq!(error, expected);
    assert!(picture.files(network, None).is_ok());
}

/// LAMMPS has 32 groups at most, and a line of input a bound; `group` adds to a group that is there.
#[test]
fn lammps_holds_any_number_of_points_with_three_groups() {
    let many = SCENE.replace("[2, 2, 2]", "[75, 75, 1]");
    let body = many.split("[[fit]]").next().unwrap();
    let scene = format!("{body}[[fit]]\nobjective = \"offdiag\"\nsprings = [\"edge\"]\n[[fix]]\ngroup = \"zmin\"\n");
    let network = networks(&scene).into_values().next().unwrap();
    assert!(network.held.len() > 5000);
    let input = String::from_utf8(texts("lammps", &network)["in.network"].clone()).unwrap();
    let lines = |word: &str| input.lines().filter(|line| line.starts_with(word)).collect::<Vec<_>>();
    let groups: std::collections::BTreeSet<&str> =
        lines("group ").iter().map(|line| line.split(' ').nth(1).unwrap()).collect();
    assert_eq!(groups.into_iter().collect::<Vec<_>>(), ["heldx", "heldy", "heldz"]);
    assert_eq!(lines("fix held").len(), 3);
    for axis in ["x", "y", "z"] {
        let own = lines(&format!("group held{axis} id "));
        let ids: Vec<usize> =
            own.iter().flat_map(|line| line.split(' ').skip(3)).map(|id| id.parse().unwrap()).collect();
        assert_eq!(ids, network.held.iter().map(|held| held.point + 1).collect::<Vec<_>>());
        assert!(own.iter().all(|line| line.len() < 16_000));
    }
}

/// Numbers that are infinite in single precision are refused by name, for every program.
#[test]
fn numbers_that_a_program_cannot_hold_are_named() {
    let network = &NETWORKS["classical"];
    let changed = |change: fn(&mut NetworkRecord)| {
        let mut network = network.clone();
        change(&mut network);
        network
    };
    let cases: [(NetworkRecord, &str); 9] = [
        (changed(|n| n.points[3][1] = 1e300), "points[3][1]"),
        (changed(|n| n.points[3][1] = f64::NAN), "points[3][1]"),
        (changed(|n| n.masses.as_mut().unwrap()[2] = 1e39), "masses[2]"),
        (changed(|n| n.springs[5].constant = 1e308), "springs[5].constant"),
        (changed(|n| n.springs[5].rest = f64::INFINITY), "springs[5].rest"),
        (changed(|n| n.springs[5].damper = -1e39), "springs[5].damper"),
        (changed(|n| n.gravity = Some(vec![0.0, 0.0, -1e308])), "gravity[2]"),
        (changed(|n| n.largest_step = Some(1e200)), "largest_step"),
        (changed(|n| n.damping.mass = 1e300), "damping.mass"),
    ];
    for target in &TARGETS {
        for (network, key) in &cases {
            let error = target.files(network, None).err().unwrap();
            assert_eq!(error.key(), Some(*key), "{}: {error}", target.name);
            assert!(
                error.problem().starts_with("expected a number of at most 3.4e38, as single precision holds, found ")
            );
        }
        for wrong in [[0.0, 0.0, 1e308], [1e39, 0.0, 0.0], [0.0, f64::NAN, 0.0], [f64::NEG_INFINITY, 0.0, 0.0]] {
            let error = target.files(network, Some(&wrong)).err().unwrap();
            assert_eq!(error.key(), Some("--gravity"), "{}: {error}", target.name);
        }
        // What is taken is finite, also where numbers are multiplied.
        let large = changed(|n| n.gravity = Some(vec![0.0, 0.0, -3e38]));
        for (name, bytes) in
            target.files(&large, None).into_iter().flatten().filter_map(|(name, content)| match content {
                Content::Bytes(bytes)
                    if !name.ends_with(".npz") && !name.ends_with(".py") && !name.ends_with(".mjs") =>
                {
                    Some((name, bytes))
                }
                _ => None,
            })
        {
            let text = String::from_utf8(bytes).unwrap();
            let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            let wrong: Vec<&str> = words.filter(|word| ["inf", "nan", "NaN", "null"].contains(word)).collect();
            assert!(wrong.is_empty(), "{} {name}", target.name);
        }
    }
}

/// A compliance is the inverse of a constant.
#[test]
fn jolt_has_no_edge_without_force() {
    let mut network = classical();
    let count = network.springs.len();
    (network.springs[0].constant, network.springs[1].constant) = (0.0, 1e-45);
    let text = String::from_utf8(texts("jolt", &network)["network.json"].clone()).unwrap();
    let body: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(body["edges"].as_array().unwrap().len(), count - 2);
}

/// Constants that belong to a setting go with it, in Jolt with the order of a sweep; others move at many substeps.
#[test]
fn jolt_has_the_setting_of_the_fit() {
    let network = classical();
    let body = |engine: Option<Setting>| -> serde_json::Value {
        let network = NetworkRecord { engine, ..network.clone() };
        serde_json::from_slice(&texts("jolt", &network)["network.json"]).unwrap()
    };
    let own = body(Some(Setting { step: 0.01, ..Setting::usual(Engine::Jolt).with_substeps(7) }));
    assert_eq!(
        (&own["fitted"], &own["setting"]["substeps"], &own["setting"]["step"]),
        (&true.into(), &7.into(), &0.01.into())
    );
    let edges = own["edges"].as_array().unwrap().len();
    let mut order: Vec<u64> = own["sweep"]["edges"].as_array().unwrap().iter().map(|i| i.as_u64().unwrap()).collect();
    assert!(!order.is_sorted(), "Jolt has an order of its own");
    order.sort_unstable();
    assert_eq!(order, (0..edges as u64).collect::<Vec<_>>());
    let usual = body(None);
    assert_eq!((&usual["fitted"], &usual["setting"]["substeps"]), (&false.into(), &50.into()));
    assert!(usual["sweep"].is_null());
}

/// In Newton's VBD points of a colour move at once: two ends of a spring differ. Its other arrays stay as they are.
#[test]
fn newton_has_the_setting_and_the_colours_of_the_fit() {
    let network = classical();
    let bytes = |engine: Option<Setting>| {
        texts("newton", &NetworkRecord { engine, ..network.clone() }).remove("network.npz").unwrap()
    };
    let names = |bytes: &[u8]| -> Vec<String> {
        let archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).unwrap();
        archive.file_names().map(|name| name.unwrap().into_owned()).collect()
    };
    let usual = names(&bytes(None));
    let setting = |engine| Setting { iterations: 3, step: 0.02, ..Setting::usual(engine) };
    let [vbd, xpbd] = [Engine::NewtonVbd, Engine::NewtonXpbd].map(|engine| bytes(Some(setting(engine))));
    for (bytes, more) in [(&vbd, 7), (&xpbd, 6)] {
        assert!(usual.iter().all(|name| names(bytes).contains(name)) && names(bytes).len() == usual.len() + more);
        assert_eq!((wholes(bytes, "iterations"), wholes(bytes, "substeps")), (vec![3], vec![10]));
        assert_eq!(reals(bytes, "step"), [0.02]);
    }
    assert_eq!((reals(&vbd, "relaxation"), reals(&xpbd, "relaxation")), (vec![1.0], vec![0.9]));
    let colours = wholes(&vbd, "colours");
    assert_eq!(colours.len(), network.points.len());
    for spring in &network.springs {
        assert_ne!(colours[spring.points[0]], colours[spring.points[1]], "{spring:?}");
    }
    let mut damped = NetworkRecord { engine: Some(setting(Engine::NewtonVbd)), ..network.clone() };
    damped.springs[0].damper = 1.0;
    let told = target_named("newton").unwrap().left_out(&damped).join("; ");
    assert!(told.contains("1 dampers of springs are left out"), "{told}");
}

/// What an engine does not have is refused by the key of the setting.
#[test]
fn settings_that_an_engine_lacks_are_refused() {
    for (engine, target) in [(Engine::Jolt, "jolt"), (Engine::NewtonVbd, "newton")] {
        let engine = Some(Setting { relaxation: 1.5, ..Setting::usual(engine) });
        let network = NetworkRecord { engine, ..classical() };
        let error = target_named(target).unwrap().files(&network, None).err().unwrap();
        assert_eq!(error.key(), Some("engine.relaxation"), "{error}");
    }
}

/// The header and the bytes of an array in a file of NumPy.
fn array(archive: &[u8], name: &str) -> (String, Vec<u8>) {
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(archive)).unwrap();
    let mut bytes = Vec::new();
    std::io::Read::read_to_end(&mut archive.by_name(&format!("{name}.npy")).unwrap(), &mut bytes).unwrap();
    let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    (String::from_utf8(bytes[10..10 + length].to_vec()).unwrap(), bytes[10 + length..].to_vec())
}

fn reals(archive: &[u8], name: &str) -> Vec<f64> {
    array(archive, name).1.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
}

fn wholes(archive: &[u8], name: &str) -> Vec<i32> {
    array(archive, name).1.chunks_exact(4).map(|b| i32::from_le_bytes(b.try_into().unwrap())).collect()
}

/// `--gravity`, then that of the network, then 9.81 m/s² against the last axis: in arrays alone as in scripts, in space and in the plane.
#[test]
fn arrays_have_the_gravity_of_the_help() {
    let plane = SCENE.replace("tet4", "tri3").replace("[1, 1, 1]", "[1, 1]").replace("[2, 2, 2]", "[2, 2]");
    let plane = plane.replace("zmin", "ymin").replace("density", "plane = \"strain\"\ndensity");
    let plane = networks(plane.split("[[fit]]\nname = \"patches\"").next().unwrap());
    let mut moved = NETWORKS["exact"].clone();
    let of = |target: &str, network: &NetworkRecord, gravity: Option<&[f64]>| {
        let files = target_named(target).unwrap().files(network, gravity).unwrap();
        let bytes =
            files.into_iter().find_map(|(_, content)| if let Content::Bytes(b) = content { Some(b) } else { None });
        reals(&bytes.unwrap(), "gravity")
    };
    for target in ["npz", "newton"] {
        assert_eq!(of(target, &moved, None), [0.0, 0.0, -9.81], "{target}");
        assert_eq!(of(target, &moved, Some(&[1.0, 0.0, 0.0])), [1.0, 0.0, 0.0], "{target}");
    }
    assert_eq!(of("npz", &plane["exact"], None), [0.0, -9.81, 0.0]);
    moved.gravity = Some(vec![0.0, 2.0, 0.0]);
    assert_eq!(of("npz", &moved, None), [0.0, 2.0, 0.0]);
}

/// Forces by load and point, in sum those of the scene, and points that a load moves.
#[test]
fn arrays_have_the_loads_by_name() {
    let loads = "[[load]]\nname = \"pöke\"\ngroup = \"zmax\"\nforce = [0, 3, -2]\n[[load]]\nname = \"turn\"\ngroup = \"zmax\"\n\
                 displacement = [\"-0.1*y\", \"0.1*x\", \"free\"]\n";
    let network = &networks(&format!("{SCENE}{loads}"))["exact"];
    let bytes = &texts("npz", network)["network.npz"];
    let (header, names) = array(bytes, "load_names");
    assert!(header.contains("'descr': '<U4', 'fortran_order': False, 'shape': (2,)"), "{header}");
    let letters: String =
        names.chunks_exact(4).filter_map(|b| char::from_u32(u32::from_le_bytes(b.try_into().unwrap()))).collect();
    assert_eq!(letters, "pöketurn");
    let (of, points, forces) = (wholes(bytes, "load_of"), wholes(bytes, "load_points"), reals(bytes, "load_forces"));
    assert_eq!((of.len(), points.len(), forces.len()), (9, 9, 27));
    assert!(of.iter().all(|of| *of == 0) && points.iter().all(|&p| network.points[p as usize][2] == 1.0));
    for (k, total) in [0.0, 3.0, -2.0].into_iter().enumerate() {
        let sum: f64 = forces.iter().skip(k).step_by(3).sum();
        assert!((sum - total).abs() < 1e-14, "{sum}");
    }
    let (of, points, moved) = (wholes(bytes, "moved_of"), wholes(bytes, "moved_points"), reals(bytes, "moved"));
    assert_eq!((of.len(), points.len(), moved.len()), (9, 9, 27));
    for (&p, u) in points.iter().zip(moved.chunks_exact(3)) {
        let x = &network.points[p as usize];
        assert!(u[0] == -0.1 * x[1] && u[1] == 0.1 * x[0] && u[2].is_nan(), "{x:?} {u:?}");
    }
    // Without loads the arrays are there, and empty.
    let bytes = &texts("npz", &NETWORKS["exact"])["network.npz"];
    assert!(array(bytes, "load_names").0.contains("'shape': (0,)") && reals(bytes, "load_forces").is_empty());
}

/// A column that hangs: strains are those of its weight, so that the least stretch is near `1 − ρ g L/E` where it stands, and more weight turns its cells inside out.
/// Springs with MuJoCo's energy push at most 0.192 k L, at 0.577 of their length, which those of the network do at 0.808.
#[test]
fn a_body_at_rest_is_told_to_a_program_that_would_move_another() {
    let sentences = |young: &str, target: &str, gravity: Option<&[f64]>| {
        let network = &networks(&SCENE.replace("1e4", young))["exact"];
        target_named(target).unwrap().at_rest(network, gravity)
    };
    for (young, words) in [
        ("1e6", None),
        ("5e4", Some("an energy that is quadratic in squared lengths is another one")),
        ("2e4", Some("below 0.81 springs")),
    ] {
        let told = sentences(young, "mujoco", None).unwrap();
        assert_eq!(told.len(), usize::from(words.is_some()), "{young}: {told:?}");
        assert!(words.is_none_or(|words| told[0].contains(words) && told[0].contains("--to newton")), "{told:?}");
        assert!(
            sentences(young, "newton", None).unwrap().is_empty() && sentences(young, "vtu", None).unwrap().is_empty()
        );
    }
    for target in ["mujoco", "newton", "npz"] {
        let error = sentences("2e3", target, None).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Unsupported);
        let text = error.to_string();
        assert!(text.starts_with("--gravity: expected a body whose cells stand their weight, found"), "{text}");
        assert!(text.contains("of 48 cells inside out at rest; a stiffer material"), "{text}");
        assert!(sentences("2e3", target, Some(&[0.0; 3])).unwrap().is_empty());
    }
    assert!(sentences("2e3", "vtu", None).unwrap().is_empty());
    let free = networks(&SCENE.replace("[[fix]]\ngroup = \"zmin\"\n", ""));
    assert!(target_named("mujoco").unwrap().at_rest(&free["exact"], None).unwrap().is_empty(), "it falls");
}

/// The displacement at rest is that of Newton's method on the model itself; by the record alone the network is the same.
/// A network whose cells lock is exported with a warning, from a scene as from its file, and one that does not without.
#[test]
fn a_network_that_locks_is_told() {
    let words = "at nu = 0.49 linear cells lock: the finite elements are too stiff, and this network with them";
    let all = networks(&SCENE.replace("0.3", "0.49").replace("1e4", "1e7"));
    for target in ["mujoco", "newton", "npz"] {
        let told = |fit: &str| target_named(target).unwrap().at_rest(&all[fit], None).unwrap().join("; ");
        assert!(told("exact").contains(words), "{target}: {}", told("exact"));
        assert!(!told("patches").contains("cells lock"), "{target}: {}", told("patches"));
    }
    let folder = holding("s.toml", SCENE.replace("0.3", "0.49"));
    for arguments in ["export s.toml --to npz", "run s.toml --out out", "export out/exact.json --to newton --out n"] {
        let (code, said) = ran(folder.path(), &arguments.split(' ').collect::<Vec<_>>());
        assert_eq!(code, Some(0), "{said}");
        assert!(said.contains("linear cells lock"), "{arguments}: {said}");
    }
    assert!(fs::read_to_string(folder.path().join("n/run.py")).unwrap().contains("linear cells lock"));
}

#[test]
fn springs_by_their_parts_are_the_network() {
    let outcome = outcome(SCENE);
    for fit in outcome.fits.iter().filter(|fit| fit.fit.name != "patches") {
        let record = NetworkFile::of(&outcome, fit).record();
        let network = springfit_report::report::Parts::of(&record).unwrap().network(3);
        let points = &outcome.mesh.points;
        let moved: Vec<f64> = points.iter().enumerate().map(|(i, x)| x + 0.05 * (i as f64).sin()).collect();
        let (mut own, mut other) = (vec![0.0; points.len()], vec![0.0; points.len()]);
        assert!(fit.network.forces(&moved, &mut own) && network.forces(&moved, &mut other));
        let largest = own.iter().fold(0.0_f64, |largest, f| largest.max(f.abs()));
        assert!(own.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-11 * largest), "{}", fit.fit.name);
    }
}

/// Loads are judged beside gravity, and what is told stands at the top of the script as well; a load that turns cells inside out is no
/// reason to refuse, because the script applies it only where it is asked for.
#[test]
fn scripts_begin_with_what_is_told() {
    let text = SCENE.replace("1e4", "2e5") + "[[load]]\nname = \"push\"\ngroup = \"zmax\"\ntraction = [0, 0, -1e5]\n";
    let folder = holding("s.toml", text.as_bytes());
    for target in ["mujoco", "newton"] {
        let (code, printed) = ran(folder.path(), &["export", "s.toml", "--to", target, "--out", target]);
        assert_eq!(code, Some(0), "{printed}");
        let written = fs::read_to_string(folder.path().join(target).join("run.py")).unwrap();
        let told: Vec<&str> = written.lines().map_while(|line| line.strip_prefix("# Beware: ")).collect();
        assert!(!told.is_empty(), "{target}: {written}");
        for words in told {
            assert!(words.contains("under gravity and the load \"push\""), "{words}");
            assert!(printed.contains(&format!("note: {}", words.trim_end_matches('.'))), "{printed}");
        }
    }
    let network = &networks(&text)["classical"];
    let jolt = target_named("jolt").unwrap();
    assert!(target_named("lammps").unwrap().at_rest(network, None).unwrap().is_empty(), "it has no loads");
    let files = with_warnings(jolt.files(network, None).unwrap(), &["one".into(), "two".into()]);
    let starts = |name: &str, start: &str| {
        files.iter().any(|(own, content)| {
            *own == name && matches!(content, Content::Bytes(b) if b.starts_with(start.as_bytes()))
        })
    };
    assert!(
        starts("run.mjs", "// Beware: one.\n// Beware: two.\n// A springfit network") && starts("network.json", "{")
    );
}

/// A body that would take long is not solved, and a sentence says so: an export takes no minute without a word.
#[test]
fn a_body_that_takes_long_is_not_solved() {
    let text = SCENE.replace("[2, 2, 2]", "[18, 18, 18]");
    let start = text.find("[[fit]]\nname = \"classical\"").unwrap();
    let end = text.find("[[fix]]").unwrap();
    let network = &networks(&format!("{}{}", &text[..start], &text[end..]))["exact"];
    let told = target_named("mujoco").unwrap().at_rest(network, None).unwrap();
    assert!(told.len() == 1 && told[0].contains("is not known under gravity"), "{told:?}");
}

/// One spring with five times its constant against it makes any of these networks release energy: held or not, under gravity or without it.
#[test]
fn a_network_that_is_not_stable_is_told() {
    let light = SCENE.replace("1e4", "1e6");
    for text in [light.clone(), light.replace("[[fix]]\ngroup = \"zmin\"\n", "")] {
        let mut network = networks(&text)["classical"].clone();
        let target = target_named("newton").unwrap();
        assert!(target.at_rest(&network, None).unwrap().is_empty());
        // The last spring joins points that are free.
        network.springs.last_mut().unwrap().constant *= -5.0;
        for gravity in [None, Some(&[0.0; 3][..])] {
            let told = target.at_rest(&network, gravity).unwrap();
            assert!(told.len() == 1 && told[0].contains("not stable: a motion from rest releases energy"), "{told:?}");
            assert!(told[0].contains("1 of its"), "{told:?}");
        }
        assert!(target_named("vtu").unwrap().at_rest(&network, None).unwrap().is_empty(), "a picture does not move");
    }
}

const VOXELS: &str = "
[mesh]
box = { element = \"hex8\", size = [2, 1, 1], cells = [4, 2, 2] }
[material]
young = 1e5
poisson = 0.4
density = 1000
[[fit]]
name = \"bulk\"
objective = \"modal\"
springs = [\"edge\", \"face diagonal\", \"body diagonal\", \"bulk\"]
nonnegative = true
[[fit]]
name = \"cells\"
objective = \"exact\"
volume = \"cells\"
[[fix]]
group = \"xmin\"
[[load]]
name = \"pull\"
group = \"xmax\"
traction = [100, 0, 0]
";

/// In place of a spring on the volume of a hexahedron ten on those of tetrahedra have its energy where all grow alike, and no less wherever the points
/// are; of any distorted hexahedron.
#[test]
fn springs_on_hexahedra_are_divided_into_those_of_tetrahedra() {
    let mut random = crate::shapes::Random(2);
    let all = networks(VOXELS);
    // Springs at the quadrature points of a hexahedron are no volumes of tetrahedra.
    let cells = Division::of(&all["cells"]).unwrap().unwrap();
    assert!(Parts::of(&cells.network).is_err());
    let mut network = all["bulk"].clone();
    // Bent faces; springs that pull at rest as well.
    network.points.iter_mut().flatten().for_each(|x| *x += 0.04 * random.next());
    let division = Division::of(&network).unwrap().expect("it has volume springs");
    assert_eq!(division.hexahedra.len(), 16);
    let parts = Parts::of(&division.network).unwrap();
    assert_eq!(parts.contents.len(), 160);
    let lengths = network.springs.len() - 16;
    assert_eq!(parts.lengths.len(), lengths);
    let rest: Vec<f64> = network.points.concat();
    let model = Parts { lengths: Vec::new(), ..parts }.network(3);
    let whole = |x: &[f64]| -> f64 {
        let of = |&place: &usize| {
            let spring = &network.springs[place];
            let own: Vec<f64> = spring.points.iter().flat_map(|&p| x[3 * p..3 * p + 3].to_vec()).collect();
            0.5 * spring.constant
                * (division.measures[spring.measure].as_ref().unwrap().value(&own, 3) - spring.rest).powi(2)
        };
        division.hexahedra.iter().map(of).sum()
    };
    for growth in [0.9, 1.0, 1.2] {
        let x: Vec<f64> = rest.iter().map(|x| growth * x).collect();
        let [own, other] = [model.energy(&x).unwrap(), whole(&x)];
        assert!((own - other).abs() < 1e-12 * other.abs().max(1e-6), "{growth}: {own} {other}");
    }
    for _ in 0..10 {
        let x: Vec<f64> = rest.iter().map(|x| x + 0.2 * random.next()).collect();
        let [own, other] = [model.energy(&x).unwrap(), whole(&x)];
        assert!(own > other * (1.0 - 1e-12), "{own} {other}");
    }
}

/// Programs that hold volumes of tetrahedra take the networks of voxels, and the export says how far the divided one is from it.
#[test]
fn networks_of_voxels_reach_an_engine() {
    let folder = holding("v.toml", VOXELS);
    let export = |to: &str, fit: &str| ran(folder.path(), &["export", "v.toml", "--to", to, "--fit", fit, "--out", to]);
    for to in ["newton", "blender", "jolt", "xpbd", "npz"] {
        let (code, said) = export(to, "bulk");
        assert_eq!(code, Some(0), "{to}: {said}");
        assert!(said.contains("the volume springs of 16 hexahedra are written as 160 of tetrahedra"), "{said}");
        assert!(
            said.contains("displacements differ by ") && said.contains("under gravity and the load \"pull\""),
            "{said}"
        );
        let share: f64 = said.split("differ by ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!(share > 0.1 && share < 15.0, "{share}");
    }
    let script = fs::read_to_string(folder.path().join("newton/run.py")).unwrap();
    assert!(script.starts_with("# Beware: the volume springs of 16 hexahedra"), "{}", &script[..80]);
    for (to, fit) in [("lammps", "bulk"), ("newton", "cells")] {
        let (code, said) = export(to, fit);
        assert_eq!(code, Some(2), "{to}: {said}");
        assert!(
            said.contains("expected linear springs on lengths, on the contents of triangles or tetrahedra, and on the angles of hinges"),
            "{said}"
        );
    }
}

/// A hexahedron that is folded is no sum of tetrahedra.
#[test]
fn folded_hexahedra_are_not_divided() {
    let mut network = networks(VOXELS).remove("bulk").unwrap();
    let corner = network.springs.iter().rev().find(|spring| spring.points.len() == 8).unwrap().points[6];
    let far = network.points[corner].clone();
    network.points[corner] = far.iter().map(|x| x - 0.9).collect();
    let error = Division::of(&network).unwrap_err().to_string();
    assert!(error.contains("springs[") && error.contains("a cell that is folded at"), "{error}");
}

const SHEET: &str = "
[mesh]
box = { element = \"tri3\", size = [0.2, 0.06], cells = [4, 2] }
space = 3
[material]
young = 1e8
poisson = 0.3
thickness = 5e-3
density = 1000
bending = \"plate\"
[[fit]]
name = \"directors\"
objective = \"offdiag\"
nonnegative = true
[[fit]]
name = \"hinges\"
objective = \"offdiag\"
nonnegative = true
bending = \"hinges\"
[[fit]]
name = \"areas\"
objective = \"exact\"
bending = \"hinges\"
[[fix]]
where = \"x < 0.06\"
";

/// Hinges on directors leave the program as hinges between triangles, to programs that hold them; the others name the reason.
#[test]
fn sheets_go_where_hinges_are_held() {
    let networks = networks(SHEET);
    let inner = 3 * 4 * 2 - 4 - 2;
    for target in &TARGETS {
        let (hinged, sentences) = target.prepared(networks["hinges"].clone(), None).unwrap();
        assert_eq!(hinged.points.len(), 5 * 3);
        let hinges = Parts::of(&hinged).unwrap().hinges;
        assert_eq!(hinges.len(), inner);
        assert!(hinges.iter().all(|hinge| hinge.rest.abs() < 1e-9 && hinge.constant > 0.0));
        assert!(sentences[0].contains("directors"), "{sentences:?}");
        assert!(hinged.largest_step.is_some_and(|step| step > 0.0));
        let holds = !["jolt", "sofa", "phystwin"].contains(&target.name);
        let found = target.files(&hinged, None);
        assert_eq!(found.is_ok(), holds, "{}: {:?}", target.name, found.err());
        if let Err(error) = target.files(&hinged, None) {
            assert!(error.to_string().contains("newton, lammps, xpbd, blender and npz hold hinges"), "{error}");
        }
        let (areas, _) = target.prepared(networks["areas"].clone(), None).unwrap();
        let holds = ["mujoco", "blender", "npz", "vtu"].contains(&target.name);
        assert_eq!(target.files(&areas, None).is_ok(), holds, "{}", target.name);
        // Directors as a plate are held by no program.
        let (plate, _) = target.prepared(networks["directors"].clone(), None).unwrap();
        if target.name != "vtu" {
            let error = target.files(&plate, None).err().unwrap();
            assert!(error.to_string().contains("bending = \"hinges\""), "{error}");
        }
    }
}

/// Newton's bending forces do not balance but in one solver, and leave small triangles out: both are refused. The colours of a sheet keep the points of hinges apart.
#[test]
fn newton_moves_hinges_by_one_solver() {
    let newton = target_named("newton").unwrap();
    let (hinged, _) = newton.prepared(networks(SHEET)["hinges"].clone(), None).unwrap();
    let mut fitted = hinged.clone();
    fitted.engine = Some(Setting::usual(Engine::NewtonXpbd));
    let error = newton.files(&fitted, None).err().unwrap();
    assert_eq!(error.kind(), ErrorKind::Unsupported);
    let error = error.to_string();
    assert!(error.contains("engine: expected") && error.contains("spin"), "{error}");
    fitted.engine = Some(Setting::usual(Engine::NewtonVbd));
    assert!(newton.files(&fitted, None).is_ok());
    let mut small = hinged;
    small.points.iter_mut().flatten().for_each(|x| *x *= 0.01);
    let error = newton.files(&small, None).err().unwrap().to_string();
    assert!(error.contains("triangles of at least 1e-6 m²") && error.contains("blender and npz"), "{error}");
}

/// A clamped edge keeps its directors, which MuJoCo has no place for.
#[test]
fn clamped_edges_keep_their_directors() {
    let clamped = SHEET.replace("where = \"x < 0.06\"", "where = \"x < 0.001\"\nclamp = true");
    let networks = networks(&clamped);
    let (hinged, _) = target_named("lammps").unwrap().prepared(networks["hinges"].clone(), None).unwrap();
    assert_eq!(hinged.points.len(), 5 * 3 + 2);
    assert!(target_named("lammps").unwrap().files(&hinged, None).is_ok());
    let error = target_named("mujoco").unwrap().files(&hinged, None).err().unwrap();
    assert!(error.to_string().contains("hold two rows of points"), "{error}");
}

/// A program pulls all points by its gravity: it is that of the scene's load, acts once, and other loads act beside it.
#[test]
fn gravity_of_a_load_is_the_gravity_of_the_program() {
    let folder = TempDir::new().unwrap();
    let scene = "[mesh]\nbox = { element = \"tet4\", size = [0.2, 0.1, 0.1], cells = [2, 1, 1] }\n[material]\nyoung = 1e6\npoisson = 0.3\ndensity = 1000\n\
                 [[fit]]\nobjective = \"offdiag\"\nnonnegative = true\n[[fix]]\ngroup = \"xmin\"\n\
                 [[load]]\nname = \"sag\"\ngravity = [0, -2, 0]\n[[load]]\nname = \"push\"\ngroup = \"xmax\"\ntraction = [0, 0, 50]\n\
                 [[load]]\nname = \"both\"\nsum = [\"sag\", \"push\"]\n";
    fs::write(folder.path().join("s.toml"), scene).unwrap();
    let written = |more: &[&str], out: &str| -> (String, serde_json::Value) {
        let (code, text) = ran(folder.path(), &[&["export", "s.toml", "--to", "xpbd", "--out", out], more].concat());
        assert_eq!(code, Some(0), "{text}");
        (text, serde_json::from_slice(&fs::read(folder.path().join(out).join("network.json")).unwrap()).unwrap())
    };
    let (text, network) = written(&[], "own");
    assert!(text.contains("gravity 0 -2 0 m/s²"), "{text}");
    assert_eq!(network["gravity"], serde_json::json!([0.0, -2.0, 0.0]));
    let loads: Vec<(&str, Vec<[f64; 3]>)> = network["loads"]
        .as_array()
        .unwrap()
        .iter()
        .map(|load| {
            let forces = load["forces"].as_array().unwrap().iter();
            (load["name"].as_str().unwrap(), forces.map(|f| [1, 2, 3].map(|k| f[k].as_f64().unwrap())).collect())
        })
        .collect();
    let total = |forces: &[[f64; 3]]| [0, 1, 2].map(|k| forces.iter().map(|f| f[k]).sum::<f64>());
    // 50 Pa on 0.01 m².
    for (name, forces) in &loads {
        let [x, y, z] = total(forces);
        assert!(x.abs() < 1e-9 && y.abs() < 1e-9 && (z - 0.5).abs() < 1e-9, "{name}: {x} {y} {z}");
    }
    assert_eq!(loads.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["push", "both"]);
    let (text, network) = written(&["--gravity", "0 0 -1"], "other");
    assert!(text.contains("\"sag\" is 0 -2 0 m/s²") && text.contains("--gravity \"0 -2 0\""), "{text}");
    assert_eq!(network["gravity"], serde_json::json!([0.0, 0.0, -1.0]));
}

/// Quadrilaterals have as many corners as tetrahedra, and are none.
#[test]
fn a_surface_of_quadrilaterals_is_no_body_of_tetrahedra() {
    let folder = TempDir::new().unwrap();
    let obj = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0.1\nf 1 2 5 4\nf 2 3 6 5\n";
    fs::write(folder.path().join("cloth.obj"), obj).unwrap();
    let scene = "[mesh]\nfile = \"cloth.obj\"\n[material]\nyoung = 1e5\npoisson = 0.3\nthickness = 0.001\ndensity = 1000\n\
                 [[fit]]\nobjective = \"offdiag\"\nnonnegative = true\n[[fix]]\nwhere = \"x < 0.1\"\n";
    fs::write(folder.path().join("s.toml"), scene).unwrap();
    let (code, text) = ran(folder.path(), &["export", "s.toml", "--to", "mujoco", "--out", "o"]);
    assert!(code == Some(2) && text.contains("linear tetrahedra or of triangles"), "{text}");
    assert!(!folder.path().join("o").exists());
}
