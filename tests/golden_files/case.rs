//! The cases as data, and running one: its commands in an empty folder, and all that they print and write.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The transcript of a case's commands among its outputs.
pub const PRINTED: &str = "printed.txt";

/// What the commands of the book name, and where it is in the repository.
const FOLDERS: [(&str, &str); 7] = [
    ("scenes", "scenes"),
    ("elements", "elements"),
    ("materials", "materials"),
    ("examples", "examples"),
    ("exports", "exports"),
    ("meshes", "tests/meshes"),
    ("wrong", "tests/wrong"),
];

/// One entry of `cases/AREA.toml`.
#[derive(Debug, Default)]
pub struct Case {
    pub name: String,
    /// Files that are there before the commands, by name.
    files: BTreeMap<String, String>,
    /// Lines of bash, in which `springfit` is the program.
    pub commands: Vec<String>,
    /// Why the case is only for comparisons to the bit, on one machine.
    pub exact_only: Option<String>,
    /// Outputs that are not compared; `*` stands for any letters.
    left_out: Vec<String>,
}

/// All outputs of a case by name.
pub type Outputs = BTreeMap<String, Vec<u8>>;

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The program under test: that of this build, or another one that [`super`] names.
pub fn program() -> PathBuf {
    std::env::var_os("SPRINGFIT_GOLDEN_PROGRAM").map_or(env!("CARGO_BIN_EXE_springfit").into(), PathBuf::from)
}

/// The cases of an area, in the order of its file; files of `[files]` are there in each.
pub fn cases(area: &str) -> Vec<Case> {
    let path = root().join("tests/golden_files/cases").join(format!("{area}.toml"));
    let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let table: toml::Table = text.parse().unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let shared = table.get("files").map(texts).unwrap_or_default();
    let list = table["case"].as_array().expect("cases are tables");
    list.iter().map(|entry| Case::read(entry.as_table().expect("a case is a table"), &shared)).collect()
}

fn text(value: &toml::Value) -> String {
    value.as_str().expect("the entries of a case are texts").to_string()
}

fn texts(value: &toml::Value) -> BTreeMap<String, String> {
    value.as_table().expect("files are a table").iter().map(|(name, value)| (name.clone(), text(value))).collect()
}

fn list(value: &toml::Value) -> Vec<String> {
    value.as_array().expect("a list").iter().map(text).collect()
}

impl Case {
    fn read(entry: &toml::Table, shared: &BTreeMap<String, String>) -> Case {
        let mut case = Case { files: shared.clone(), ..Case::default() };
        for (key, value) in entry {
            match key.as_str() {
                "name" => case.name = text(value),
                "page" => case.files.extend(files_of_page(&text(value))),
                "files" => case.files.extend(texts(value)),
                "commands" => case.commands = list(value),
                "exact_only" => case.exact_only = Some(text(value)),
                "left_out" => case.left_out = list(value),
                other => panic!("{other} is no key of a case"),
            }
        }
        case
    }

    /// Runs the commands and gathers what they print and write.
    pub fn run(&self) -> Outputs {
        let (work, programs) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        std::os::unix::fs::symlink(program(), programs.path().join("springfit")).unwrap();
        for (name, target) in FOLDERS {
            std::os::unix::fs::symlink(root().join(target), work.path().join(name)).unwrap();
        }
        self.files.iter().for_each(|(name, text)| fs::write(work.path().join(name), text).unwrap());
        let mut printed = String::new();
        self.run_commands(work.path(), programs.path(), &mut printed);
        let mut outputs = Outputs::from([(PRINTED.to_string(), printed.into_bytes())]);
        self.gather(work.path(), "", &mut outputs);
        outputs
    }

    /// Appends each command with its standard output, its standard error and its exit code. The program has one thread, because
    /// whole-object fits add in an order that depends on the number of threads.
    fn run_commands(&self, folder: &Path, programs: &Path, printed: &mut String) {
        let others = std::env::var_os("PATH").unwrap_or_default();
        let path = std::iter::once(programs.to_path_buf()).chain(std::env::split_paths(&others));
        let path = std::env::join_paths(path).expect("folders of the search path have no colon");
        for line in &self.commands {
            let mut command = Command::new("bash");
            for name in ["COLUMNS", "NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
                command.env_remove(name);
            }
            let output = command
                .args(["-c", line])
                .env("PATH", &path)
                .env("RAYON_NUM_THREADS", "1")
                .current_dir(folder)
                .output()
                .unwrap();
            *printed += &format!("$ {line}\n{}", String::from_utf8_lossy(&output.stdout));
            let said = String::from_utf8_lossy(&output.stderr);
            let said: String = said.split_inclusive('\n').filter(|line| !is_progress(line)).collect();
            if !said.is_empty() {
                *printed += &format!("[standard error]\n{said}");
            }
            if !output.status.success() {
                *printed += &format!("[exit code {}]\n", output.status.code().unwrap_or(-1));
            }
        }
    }

    /// The files below, but links, those that the case was given, and those that it leaves out.
    fn gather(&self, folder: &Path, within: &str, outputs: &mut Outputs) {
        for entry in fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap();
            let name = format!("{within}{}", entry.file_name().to_str().expect("names are text"));
            // The list of the files of a run has sums, also of times.
            if entry.file_name() == ".springfit.files" {
                continue;
            }
            let kind = entry.file_type().unwrap();
            if kind.is_dir() {
                self.gather(&entry.path(), &format!("{name}/"), outputs);
            } else if kind.is_file() && !self.files.contains_key(&name) && !self.leaves_out(&name) {
                outputs.insert(name, fs::read(entry.path()).unwrap());
            }
        }
    }

    fn leaves_out(&self, name: &str) -> bool {
        self.left_out.iter().any(|pattern| fits(name, pattern))
    }
}

/// Whether a text is of a pattern, in which `*` stands for any letters and `#` for a whole number.
pub fn fits(text: &str, pattern: &str) -> bool {
    // Most texts and patterns differ in their first letter, and there are millions of such pairs.
    if let (Some(first), Some(expected)) = (text.as_bytes().first(), pattern.as_bytes().first())
        && first != expected
        && !matches!(expected, b'*' | b'#')
    {
        return false;
    }
    let Some(at) = pattern.find(['*', '#']) else { return text == pattern };
    let Some(text) = text.strip_prefix(&pattern[..at]) else { return false };
    let rest = &pattern[at + 1..];
    if pattern[at..].starts_with('#') {
        let digits = text.bytes().take_while(u8::is_ascii_digit).count();
        return digits > 0 && fits(&text[digits..], rest);
    }
    let mut ends = text.char_indices().map(|(i, _)| i).chain([text.len()]);
    ends.any(|i| fits(&text[i..], rest))
}

/// The files that a page of the book tells its reader to write: blocks after `<!-- file: NAME -->`.
fn files_of_page(page: &str) -> BTreeMap<String, String> {
    let path = root().join(page);
    let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let (mut found, mut lines) = (BTreeMap::new(), text.lines());
    while let Some(line) = lines.next() {
        if let Some(name) = line.strip_prefix("<!-- file: ").and_then(|rest| rest.strip_suffix(" -->")) {
            let inside = lines.by_ref().skip(1).take_while(|line| *line != "```");
            found.insert(name.to_string(), inside.map(|line| format!("{line}\n")).collect());
        }
    }
    found
}

#[test]
fn patterns_have_numbers_and_any_letters() {
    for (text, pattern, is_one) in [
        ("note: whole: 3 of 8", "note: *: # of #", true),
        ("note: whole: strains of up to 3", "note: *: # of #", false),
        ("out/a/plot.svg", "*/plot.svg", true),
        ("out/a/plot.csv", "*/plot.svg", false),
        ("ab", "ab", true),
        ("abc", "ab", false),
    ] {
        assert_eq!(fits(text, pattern), is_one, "{text} {pattern}");
    }
}

/// Whether a line tells how far a stage is, which a slow machine prints and a fast one does not.
fn is_progress(line: &str) -> bool {
    let Some((_, pace)) = line.strip_prefix("note: ").and_then(|line| line.rsplit_once(": ")) else { return false };
    let words: Vec<&str> = pace.split([' ', ',', '\n']).filter(|word| !word.is_empty()).collect();
    let is_number = |word: &str| word.bytes().all(|byte| byte.is_ascii_digit());
    matches!(&words[..], [done, "of", total, rest @ ..] if is_number(done) && is_number(total) && matches!(rest, [] | ["about", ..]))
}
