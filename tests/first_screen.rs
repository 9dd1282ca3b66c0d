//! What a run prints first: one row for each fit with its verdict, and notes once.

use springfit_report::report::{Report, Table, groups_beside_summary, notes_beside_summary};
use springfit_studies::study::{FitEntry, Outcome, Scene, run};
use std::path::Path;
use std::process::Command;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

fn outcome(name: &str, fits: Option<Vec<FitEntry>>, change: [&str; 2]) -> Outcome {
    let path = Path::new(ROOT).join(format!("scenes/{name}.toml"));
    let text = std::fs::read_to_string(&path).unwrap().replace(change[0], change[1]);
    let scene = Scene::parse(&text, &path).unwrap();
    let fits = fits.map(|entries| entries.iter().map(|entry| entry.fits(Path::new("")).unwrap().remove(0)).collect());
    run(&fits.map_or(scene.clone(), |fits| scene.with_fits(fits)), &mut |_| {}).unwrap()
}

fn verdicts(outcome: &Outcome) -> Vec<String> {
    Report::of(outcome).fits.into_iter().map(|fit| fit.verdict).collect()
}

/// The screen of a command on a page of so many columns, and what it says on standard error.
fn screen(columns: &str, arguments: &[&str]) -> [String; 2] {
    let mut command = Command::new(env!("CARGO_BIN_EXE_springfit"));
    let output = command.current_dir(ROOT).env("COLUMNS", columns).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap())
}

#[test]
fn lines_fit_a_hundred_columns() {
    let out = tempfile::tempdir().unwrap();
    let out = out.path().to_str().unwrap();
    let mut commands = Vec::new();
    for scene in ["cube_tet", "square_quad", "specimen_tet", "tissue_quad_whole", "cube_hex_motion", "cube_regions"] {
        commands.push(vec!["run".to_string(), format!("scenes/{scene}.toml"), format!("--out={out}/{scene}")]);
    }
    let timed = [&commands[0][..], &["--time".into(), format!("--out={out}/timed")]].concat();
    commands.push(timed.into_iter().filter(|word| !word.ends_with("/cube_tet")).collect());
    let words = |text: &str| text.split(' ').map(String::from).collect::<Vec<String>>();
    let fit = "fit scenes/meshes/cube_tet.msh --scale 0.01 --young 1e4 --poisson 0.45 --density 1000";
    commands.push(words(&format!("{fit} --compliance -o {out}/springs.json")));
    commands.push(words(&format!("{fit} --nonnegative -o {out}/positive.json")));
    commands.push(words("check quad4 hex20 tet10"));
    commands.push(words(&format!("measure {out}/springs.json")));
    commands.push(words(&format!("export {out}/springs.json --to mujoco --out {out}/mujoco")));
    commands.push(words("groups scenes/meshes/cube_tet.msh"));
    commands.push(words("elements"));
    for command in commands {
        let arguments: Vec<&str> = command.iter().map(String::as_str).collect();
        for text in screen("100", &arguments) {
            // Paths are not broken.
            let wide = text.lines().find(|line| line.chars().count() > 100 && !line.contains(out));
            assert!(wide.is_none(), "{arguments:?}: {}\n{text}", wide.unwrap_or_default());
        }
    }
}

#[test]
fn a_fit_has_one_row_and_more_is_printed_where_it_is_asked_for() {
    let out = tempfile::tempdir().unwrap();
    let folder = format!("--out={}", out.path().display());
    let [table, notes] = screen("100", &["run", "scenes/cube_tet.toml", &folder]);
    for name in ["exact", "frobenius", "offdiag", "offdiag k>=0", "frobenius + volume"] {
        let rows = table.lines().filter(|line| line.trim_start().starts_with(&format!("{name}  "))).count();
        assert_eq!(rows, 1, "{name}\n{table}");
    }
    assert!(notes.matches("note: ").count() <= 9 && notes.matches("has no such error").count() == 1, "{notes}");
    let [all, all_notes] = screen("100", &["run", "scenes/cube_tet.toml", &folder, "-v"]);
    for words in ["Matrices of the elements", "e_tip / e_energy", "Networks as materials"] {
        assert!(all.contains(words) && !table.contains(words), "{words}\n{all}");
    }
    assert_eq!(all_notes.matches("has no such").count(), 4, "{all_notes}");
}

/// Each verdict on a body that earns it.
#[test]
fn verdicts_name_what_is_dearest() {
    let exact = || FitEntry::new("exact");
    let positive = |objective: &str| FitEntry::new(objective).with("nonnegative", Some(true));
    let locking = outcome("cube_tet", Some(vec![exact(), positive("offdiag")]), ["poisson = 0.3", "poisson = 0.45"]);
    assert_eq!(verdicts(&locking), ["locks", "not the material, 56 %"]);
    assert_eq!(Report::of(&locking).finite_elements_verdict, "locks");
    let groups = ["edge", "face diagonal", "body diagonal", "bulk"].map(String::from).to_vec();
    let loose = FitEntry::new("modal").with_springs(Some(groups)).with("higher", Some(0.1));
    assert_eq!(verdicts(&outcome("cylinder_hex", Some(vec![loose, exact()]), ["", ""])), ["indefinite", "stable"]);
    let far = outcome("specimen_tet", Some(vec![positive("offdiag")]), ["", ""]);
    assert_eq!(verdicts(&far), ["not trusted"]);
    // The whole object is not asked for its material, however far its constants are from it.
    let whole = outcome("tissue_quad_whole", None, ["10 kPa", "10 MPa"]);
    let report = Report::of(&whole);
    let of_whole: Vec<_> = report.fits.iter().filter(|fit| fit.whole.is_some()).collect();
    assert!(!of_whole.is_empty() && of_whole.iter().all(|fit| fit.verdict == "stable"), "{:?}", verdicts(&whole));
}

/// Notes in groups have each sentence of the notes for one fit, once for all that it concerns.
#[test]
fn groups_of_notes_name_all_fits() {
    let outcome = outcome("cube_tet", None, ["", ""]);
    let (single, groups) = (notes_beside_summary(&outcome), groups_beside_summary(&outcome));
    assert!(groups.len() < single.len(), "{groups:?}");
    let of_material = groups.iter().find(|note| note.contains("is not the material")).unwrap();
    for fit in outcome.fits.iter().filter(|fit| fit.fit.name != "exact") {
        assert!(of_material.contains(&fit.fit.name), "{of_material}");
    }
    let overview = &Table::all(&Report::of(&outcome))[0];
    assert_eq!((overview.name.as_str(), overview.rows.len()), ("overview", outcome.fits.len()));
}
