//! Tables that commands typeset, in the languages of papers and of pages.

use crate::kit::{place, said, springfit};

fn root(path: &str) -> String {
    place(path).display().to_string()
}

/// Cells of a line, without separators that belong to a cell.
fn cells(line: &str, separator: &str) -> usize {
    line.replace(&format!("\\{separator}"), "").matches(separator).count()
}

#[test]
fn every_command_that_prints_tables_typesets_them() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, mesh) = (root("scenes/square_quad.toml"), root("scenes/meshes/cube_tet.msh"));
    let sweep = "sweep.over={material.poisson=[0.1,0.3]}";
    let commands: [(&[&str], usize); 14] = [
        (&["elements"], 1),
        (&["materials"], 1),
        (&["check", "tet4", "hex8"], 1),
        (&["groups", &mesh], 1),
        (&["compare", "tri3", "--shapes", "2", "--iterations", "20"], 2),
        (&["compare", "tri3", "--law", "neo-hookean", "--plane", "strain"], 3),
        (&["compare", &scene], 1),
        (&["converge", &scene, "--levels", "2"], 2),
        (&["stability", "tri3"], 1),
        (&["sweep", &scene, "--set", sweep], 1),
        (&["sweep", &scene, "--set", sweep, "--explain"], 1),
        (&["run", &scene], 5),
        (&["fit", &mesh, "--young", "10kPa", "--poisson", "0.3", "-o", "springs.json"], 3),
        (&["paper", "--only", "figure 9"], 1),
    ];
    for (arguments, tables) in commands {
        // A comparison of a law or a scene takes seconds; all tables have one writer of each language.
        let is_long = arguments.contains(&"--law") || arguments.ends_with(&["compare", &scene]);
        let languages = if is_long { &["latex"][..] } else { &["markdown", "latex"] };
        for language in languages.iter().copied() {
            let out = format!("{}-{language}", arguments[0]);
            let more: &[&str] = match arguments[0] {
                "compare" | "converge" | "stability" | "sweep" | "run" | "paper" => &["--out", &out],
                _ => &[],
            };
            let _ = std::fs::remove_dir_all(folder.path().join(&out));
            let output = springfit(folder.path(), &[arguments, &["--table", language][..], more].concat());
            let (text, words) = (String::from_utf8_lossy(&output.stdout), said(&output));
            assert!(output.status.success(), "{arguments:?}: {words}");
            // Names of files are not between the tables.
            assert!(!text.contains("written:"), "{arguments:?}");
            let (blocks, separator): (Vec<Vec<&str>>, _) = match language {
                "markdown" => {
                    let blocks =
                        text.split("\n\n").map(|block| block.lines().filter(|line| line.starts_with('|')).collect());
                    (blocks.collect(), "|")
                }
                _ => {
                    let blocks = text.split("\\begin{tabular}").skip(1);
                    (
                        blocks
                            .map(|block| {
                                block
                                    .lines()
                                    .filter(|line| line.ends_with("\\\\") && !line.contains("multicolumn"))
                                    .collect()
                            })
                            .collect(),
                        "&",
                    )
                }
            };
            let blocks: Vec<Vec<&str>> = blocks.into_iter().filter(|block| !block.is_empty()).collect();
            assert_eq!(blocks.len(), tables, "{arguments:?}, {language}: {text}");
            for block in blocks {
                let columns = cells(block[0], separator);
                assert!(block.len() > 1 && block.iter().all(|line| cells(line, separator) == columns), "{block:?}");
            }
        }
    }
}

#[test]
fn a_table_of_what_is_not_there_yet_or_twice_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scene = root("scenes/square_quad.toml");
    for (arguments, expected) in [
        (vec!["run", &scene, "--explain", "--table", "latex"], "--table: belongs to results, found with --explain"),
        (vec!["run", &scene, "--json", "--table", "latex"], "cannot be used with"),
        (vec!["elements", "tet4", "--table", "latex"], "cannot be used with"),
        (vec!["elements", "--table", "html"], "possible values: latex, markdown"),
    ] {
        let output = springfit(folder.path(), &arguments);
        let words = said(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(words.contains(expected), "{words}");
    }
}
