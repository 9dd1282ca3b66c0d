//! What is left when the program does not come to its end: killed, interrupted, the disk full, the folder read-only, the
//! reader gone. A crash shows only what a reader could have seen at that moment, so every moment is as good as any other.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::os::unix::fs::MetadataExt;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};
use tempfile::TempDir;

const BODY: &str = r#"
mesh = { box = { element = "hex8", size = [0.02, 0.02, 0.02], cells = [4, 4, 4] } }
material = { young = 10e3, poisson = 0.3, density = 1000 }
fix = [{ group = "zmin" }]
load = [{ name = "tension", group = "zmax", traction = [0, 0, 1000] }]
output = { vtu = true, csv = true }
"#;
const STARTS: &str = r#"fit = [{ objective = "whole", start = ["offdiag", "equal"], regularization = 1 }]"#;
/// The first saves its state at once, the second takes seconds.
const SLOW: &str = r#"fit = [
    { name = "short", objective = "whole", loads = ["tension"], regularization = 1, iterations = 1 },
    { name = "long", objective = "whole", solver = "l-bfgs", iterations = 300 },
]
"#;
const MOTION: &str = "[motion]\nduration = 0.01\nstep = 1e-3\nintegrator = \"newmark\"\nlinear = true\nevery = 5e-3\n\
                      gravity = [0, 0, -9.81]\n";
const INDEX: &str = "title = \"own\"\n[[table]]\nname = \"A\"\ntitle = \"pulled\"\nkind = \"scenes\"\nload = \"tension\"\n\
                     columns = [\"e_rms\"]\n[[table.row]]\nobject = \"cube\"\nscene = \"run.toml\"\n";
/// What stands in the place of a folder.
const OLD: &str = "of the user";
const RUN: &str = "run run.toml --out out";
const MOVED: &str = "run motion.toml --out out";
const SAVED: &str = "run short.toml --out out --checkpoint out/state.json";
const COMPARE: &str = "compare tri3 --shapes 2 --fit objective='offdiag' --out out";
const PAPER: &str = "paper --index index.toml --out out";
const COMMANDS: [&str; 7] =
    [RUN, MOVED, COMPARE, PAPER, "fit MESH -o out/x.json", "fit MESH -o out/x.csv", "fit MESH -o out/x.vtu"];

/// A command in a folder of its own, and what it writes into `out` when nothing comes between.
struct Case {
    folder: TempDir,
    arguments: Vec<String>,
    outputs: BTreeMap<String, Vec<u8>>,
    /// With the list of these files, as the next run finds it.
    former: BTreeMap<String, Vec<u8>>,
}

impl Case {
    fn bare(command: &str) -> Case {
        let folder = TempDir::new().unwrap();
        let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
        let (small, offdiag) = (BODY.replace("4, 4, 4", "2, 2, 3"), "fit = [{ objective = \"offdiag\" }]\n");
        write("run.toml", format!("{BODY}{offdiag}"));
        write("motion.toml", format!("{BODY}{offdiag}{MOTION}"));
        write("short.toml", format!("{small}{STARTS}"));
        write("long.toml", format!("{BODY}{SLOW}"));
        write("moved.toml", format!("{BODY}{SLOW}{}", MOTION.replace("0.01", "200").replace("5e-3", "200")));
        write("index.toml", INDEX.into());
        let mesh = crate::kit::place("scenes/meshes/cube_tet.msh");
        fs::copy(mesh, folder.path().join("cube.msh")).unwrap();
        fs::create_dir(folder.path().join("out")).unwrap();
        let command = command.replace("MESH", "cube.msh --scale 0.01 --young 10kPa --poisson 0.3");
        let arguments = command.split(' ').map(String::from).collect();
        Case { folder, arguments, outputs: BTreeMap::new(), former: BTreeMap::new() }
    }

    fn new(command: &str) -> Case {
        let mut case = Case::bare(command);
        let output = case.program().output().unwrap();
        assert!(output.status.success(), "{command}: {output:?}");
        case.former = files(&case.out());
        case.outputs = results(&case.out());
        case
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    fn program(&self) -> Command {
        self.within(&[], "exec \"$@\"")
    }

    /// A shell's script that runs the program as `"$@"`, in its turn run by `launcher`.
    fn within(&self, launcher: &[&str], script: &str) -> Command {
        let words = [heeding(), launcher, &["sh", "-c", script, "sh", env!("CARGO_BIN_EXE_springfit")]].concat();
        let mut command = Command::new(words[0]);
        command.args(&words[1..]).args(&self.arguments).current_dir(self.folder.path());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// An empty folder `out`, or one with the outputs of a former run.
    fn fresh(&self, old: bool) {
        let begun = begun_in(self.folder.path()).into_iter().map(|name| self.folder.path().join(name));
        for old in begun.chain([self.out()]) {
            let _ = fs::remove_dir_all(old);
        }
        fs::create_dir(self.out()).unwrap();
        for (name, content) in self.former.iter().filter(|_| old) {
            let path = self.out().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, content).unwrap();
        }
    }

    /// No beginning of a file is.
    fn is_whole(&self, name: &str, content: &[u8]) -> bool {
        let (text, expected) = (String::from_utf8_lossy(content), String::from_utf8_lossy(&self.outputs[name]));
        match name.rsplit_once('.').unwrap().1 {
            // The first brace is closed by the last.
            "json" => text.trim_end().ends_with('}') && text.matches('{').count() == text.matches('}').count(),
            "svg" => text.trim_end().ends_with("</svg>"),
            "html" => text.trim_end().ends_with("</html>"),
            "parquet" => content.starts_with(b"PAR1") && content.ends_with(b"PAR1"),
            // A line for each pass, whose number depends on the machine.
            "csv" if name == "values.csv" => text.ends_with('\n') && text.lines().count() > 10,
            "vtu" | "pvd" => text.trim_end().ends_with("</VTKFile>"),
            _ => text.ends_with('\n') && text.lines().count() == expected.lines().count(),
        }
    }

    /// Every file in `place` is whole, or what it was before; how many were begun beside them and left there.
    fn check(&self, place: &Path, old: bool, told: &str) -> usize {
        let found = results(place);
        for (name, content) in &found {
            let fine = self.outputs.contains_key(name) && self.is_whole(name, content);
            assert!(fine, "{}, {told}: {name} has {} bytes of a file", self.arguments.join(" "), content.len());
        }
        assert!(!old || self.outputs.keys().all(|name| found.contains_key(name)), "{told}: a file is gone");
        [place, place.parent().unwrap()].map(|folder| begun_in(folder).len()).iter().sum()
    }

    fn check_complete(&self, status: ExitStatus, told: &str) {
        assert!(status.success(), "{told}: {status}");
        self.check(&self.out(), false, told);
        assert!(self.outputs.keys().all(|name| self.out().join(name).exists()), "{told}: a file is missing");
    }

    /// Ends the program at moments over all of its time, every other one when a file is there anew.
    fn end_at_many_moments(&self, signal: &str, moments: usize) {
        self.fresh(false);
        let start = Instant::now();
        self.check_complete(self.program().output().unwrap().status, "undisturbed");
        let duration = start.elapsed();
        for i in 0..moments {
            let (old, told) = (i % 4 < 2, format!("SIG{signal}, moment {i} of {moments}"));
            self.fresh(old);
            let mut program = self.program().stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
            if i % 2 == 0 {
                std::thread::sleep(duration.mul_f64((i as f64 + 0.5) / moments as f64));
            } else {
                let name = self.outputs.keys().nth(i / 2 % self.outputs.len()).unwrap();
                let place = || fs::metadata(self.out().join(name)).ok().map(|data| data.ino());
                let before = place();
                let anew = || place().is_some_and(|now| before != Some(now));
                while !anew() && program.try_wait().unwrap().is_none() {}
                std::thread::sleep(Duration::from_micros(40 * (i as u64 % 5)));
            }
            send(&mut program, signal);
            let status = program.wait().unwrap();
            let ended = status.signal().is_some() || status.success() || status.code() == Some(130);
            assert!(ended, "{told}: {status}");
            let begun = self.check(&self.out(), old, &told);
            let killed = status.signal().is_some();
            // Of the folder that is prepared, and of a checkpoint.
            assert!(begun <= 2 * usize::from(killed), "{told}: {begun} files begun and left, {status}");
            if i % 5 == 0 {
                self.check_complete(self.program().output().unwrap().status, &format!("{told}, run again"));
            }
        }
    }
}

/// Lets a program heed interrupts, which it does not if the tests were started in the background of a script.
fn heeding() -> &'static [&'static str] {
    const WAY: [&str; 2] = ["env", "--default-signal=INT"];
    static IS_KNOWN: OnceLock<bool> = OnceLock::new();
    let is_known = || Command::new(WAY[0]).args([WAY[1], "true"]).output().is_ok_and(|output| output.status.success());
    if *IS_KNOWN.get_or_init(is_known) { &WAY } else { &[] }
}

/// Those that are results, by their paths.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    files(folder).into_iter().filter(|(name, _)| !name.starts_with(".springfit.")).collect()
}

/// Files and folders that are not in their places.
fn begun_in(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.filter(|name| name.ends_with(".partial")).collect()
}

/// By their paths below the folder.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap().flatten() {
        let (name, path) = (entry.file_name().to_string_lossy().into_owned(), entry.path());
        match path.is_dir() {
            true => found.extend(files(&path).into_iter().map(|(below, text)| (format!("{name}/{below}"), text))),
            false => drop(found.insert(name, fs::read(path).unwrap())),
        }
    }
    found
}

fn send(program: &mut Child, signal: &str) {
    // One that has ended already takes none.
    let kill = format!("kill -{signal} {} 2>&-", program.id());
    let _ = if signal == "KILL" { program.kill() } else { Command::new("sh").args(["-c", &kill]).status().map(drop) };
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// One error of one line that begins with what it is about, and exit code 2.
fn assert_clean(output: &Output, about: &str, problem: &str) {
    let text = told(output);
    let errors: Vec<&str> = text.lines().filter(|line| !line.starts_with("note: ")).collect();
    let clean = errors.len() == 1 && errors[0].starts_with(&format!("error: {about}")) && text.contains(problem);
    assert!(clean && output.status.code() == Some(2), "{about}, {problem}: {}, {text}", output.status);
}

/// Gives a command mounts of its own, which end with it.
const MOUNTS: [&str; 4] = ["unshare", "--user", "--map-root-user", "--mount"];

fn mounting() -> Option<&'static [&'static str]> {
    let probe = Command::new(MOUNTS[0]).args(&MOUNTS[1..]).args(["mount", "-t", "tmpfs", "none", "/tmp"]).status();
    if !probe.is_ok_and(|status| status.success()) {
        eprintln!("skipped: no file system can be mounted here");
        return None;
    }
    Some(&MOUNTS)
}

#[test]
fn outputs_are_whole_or_absent_after_a_kill() {
    COMMANDS.iter().for_each(|command| Case::new(command).end_at_many_moments("KILL", 15));
}

#[test]
fn outputs_are_whole_or_absent_after_an_interrupt() {
    [MOVED, COMPARE, PAPER, SAVED].iter().for_each(|command| Case::new(command).end_at_many_moments("INT", 9));
}

#[test]
fn a_killed_fit_goes_on_from_a_whole_checkpoint() {
    Case::new(SAVED).end_at_many_moments("KILL", 15);
}

/// A second name of the old file still has the old content: not even a crash of the machine finds half of the new.
#[test]
fn outputs_replace_files_and_are_not_written_into_them() {
    for command in COMMANDS.into_iter().chain([SAVED]) {
        let case = Case::new(command);
        case.fresh(true);
        let second = case.folder.path().join("second");
        fs::create_dir(&second).unwrap();
        let places: Vec<PathBuf> = (0..case.outputs.len()).map(|i| second.join(i.to_string())).collect();
        case.outputs.keys().zip(&places).for_each(|(name, place)| fs::hard_link(case.out().join(name), place).unwrap());
        case.check_complete(case.program().output().unwrap().status, command);
        assert!(
            places.iter().zip(case.outputs.values()).all(|(place, old)| fs::read(place).unwrap() == *old),
            "{command}"
        );
        let replaced = |(name, place): (&String, &PathBuf)| {
            let inode = |path: &Path| fs::metadata(path).unwrap().ino();
            inode(&case.out().join(name)) != inode(place)
        };
        assert!(case.outputs.keys().zip(&places).all(replaced), "{command}");
    }
}

/// Of an earlier program of the same number, longer than the file, and of another; but not what a living one holds.
#[test]
fn what_killed_programs_left_is_removed() {
    for command in [RUN, COMPARE, PAPER] {
        let case = Case::new(command);
        case.fresh(false);
        let numbers = (0..case.outputs.len()).map(|i| format!("{i} ")).collect::<String>();
        let own = "head -c 400000 /dev/zero > out/.springfit.$$.$n.partial";
        let left = format!("do {own}; echo > out/.springfit.1.$n.partial; done; exec \"$@\"");
        let alive = File::create(case.out().join(".springfit.1.alive.partial")).unwrap();
        alive.lock().unwrap();
        let output = case.within(&[], &format!("for n in {numbers}; {left}")).output().unwrap();
        case.check_complete(output.status, command);
        assert_eq!(case.check(&case.out(), false, command), 1, "what is locked stays");
    }
}

#[test]
fn files_that_would_grow_too_large_are_an_error() {
    for command in COMMANDS {
        let case = Case::new(command);
        for (i, limit) in [1, 4, 16, 64].into_iter().enumerate() {
            case.fresh(i % 2 == 0);
            let output = case.within(&[], &format!("ulimit -f {limit}; exec \"$@\"")).output().unwrap();
            assert_eq!(case.check(&case.out(), i % 2 == 0, "limited"), 0);
            if i == 0 || !output.status.success() {
                assert_clean(&output, "out/", "cannot be written: File too large");
            }
        }
    }
}

#[test]
fn a_full_disk_is_an_error_that_leaves_old_files() {
    let Some(way) = mounting() else { return };
    for command in COMMANDS {
        let case = Case::new(command);
        case.fresh(true);
        // Room for the old files, and for one page less than the largest of the new ones; the mount ends with the script.
        let pages = |content: &Vec<u8>| content.len().div_ceil(4096).max(1);
        let largest = case.outputs.values().map(pages).max().unwrap_or(1);
        let script = format!(
            "cp -R out old && mount -t tmpfs -o size={}k none out && cp -R old/. out || exit 77\n\
             \"$@\"; code=$?; cp -R out seen; exit $code",
            4 * (case.former.values().map(pages).sum::<usize>() + largest - 1)
        );
        let output = case.within(way, &script).output().unwrap();
        assert_clean(&output, "out/", "cannot be written: No space left on device");
        assert_eq!(case.check(&case.folder.path().join("seen"), true, "disk full"), 0, "{command}");
    }
}

#[test]
fn a_full_standard_output_is_an_error() {
    let Ok(full) = File::options().write(true).open("/dev/full") else { return };
    for command in COMMANDS.into_iter().chain(["derive quad4", "check quad4", "run run.toml --explain"]) {
        let case = Case::bare(command);
        let output = case.program().stdout(full.try_clone().unwrap()).output().unwrap();
        assert_clean(&output, "standard output cannot be written", "");
    }
}

/// Below a file no folder can be, and nothing is worked out for it; `fit` takes a file, which is tried at the end.
#[test]
fn outputs_below_a_file_are_an_error_before_the_work() {
    for command in COMMANDS {
        let case = Case::bare(command);
        fs::remove_dir(case.out()).unwrap();
        fs::write(case.out(), OLD).unwrap();
        let output = case.program().output().unwrap();
        assert_clean(&output, "out", "");
        assert!(output.stdout.is_empty() && fs::read(case.out()).unwrap() == OLD.as_bytes(), "{command}");
    }
}

fn read_only(command: &str, way: &[&str]) -> Output {
    let case = Case::bare(command);
    let output = case.within(way, "mount -t tmpfs -o ro none out || exit 77; exec \"$@\"").output().unwrap();
    assert_clean(&output, "out", "Read-only file system");
    output
}

#[test]
fn a_read_only_folder_is_an_error() {
    let Some(way) = mounting() else { return };
    for command in COMMANDS.into_iter().chain([&*SAVED.replace("--out out", "--out other")]) {
        read_only(&command.replace("--out out", "--out out/below"), way);
        read_only(command, way);
    }
}

#[test]
fn a_read_only_folder_is_an_error_before_the_work() {
    let Some(way) = mounting() else { return };
    COMMANDS.iter().for_each(|command| assert!(read_only(command, way).stdout.is_empty(), "{command}"));
}

/// Starts it, and waits until the first of its two fits has saved its state.
fn begun(case: &Case) -> Child {
    let mut program = case.program().stdout(Stdio::null()).spawn().unwrap();
    while !case.out().join("state.json").exists() {
        assert_eq!(program.try_wait().unwrap(), None);
    }
    program
}

#[test]
fn an_interrupt_ends_a_long_fit_at_its_best_point() {
    let mut case = Case::bare(&SAVED.replace("short", "long"));
    let mut program = begun(&case);
    send(&mut program, "INT");
    let ended = program.wait_with_output().unwrap();
    assert!(ended.status.success() && told(&ended).contains("it was ended early"), "{ended:?}");
    let seen = case.folder.path().join("seen");
    fs::rename(case.out(), &seen).unwrap();
    case.fresh(false);
    fs::copy(seen.join("state.json"), case.out().join("state.json")).unwrap();
    let resumed = case.program().output().unwrap();
    assert!(resumed.status.success() && !told(&resumed).contains("it was ended early"), "{resumed:?}");
    case.outputs = results(&case.out());
    case.check(&seen, false, "interrupted");
    assert!(results(&seen).keys().eq(case.outputs.keys()));
}

/// The motion after the fits would take long.
#[test]
fn a_second_interrupt_ends_the_program_at_once() {
    // On a busy machine the program may come to writing what it has before the second signal.
    let ends_at_once = || {
        let case = Case::bare(&SAVED.replace("short", "moved"));
        let mut program = begun(&case);
        send(&mut program, "INT");
        let line = BufReader::new(program.stderr.as_mut().unwrap()).lines().next().unwrap().unwrap();
        assert!(line.contains("again to end at once"), "{line}");
        send(&mut program, "INT");
        program.wait().unwrap().code() == Some(130) && files(&case.out()).keys().all(|name| name == "state.json")
    };
    assert!((0..5).any(|_| ends_at_once()));
}

/// As `head -1` does: after the first line, or before it.
fn left_by_its_reader(command: &str, lines: usize) -> Case {
    let case = Case::bare(command);
    let mut program = case.program().spawn().unwrap();
    let reader = BufReader::new(program.stdout.take().unwrap());
    assert_eq!(reader.lines().take(lines).count(), lines);
    let output = program.wait_with_output().unwrap();
    assert!(output.status.success() && told(&output).lines().all(|line| line.starts_with("note: ")), "{output:?}");
    case
}

#[test]
fn a_reader_that_leaves_ends_the_program_quietly() {
    for command in COMMANDS.into_iter().chain(["derive quad4 --matrix", "check quad4 tri3 hex8"]) {
        (0..2).for_each(|lines| drop(left_by_its_reader(command, lines)));
    }
}

#[test]
fn no_files_are_lost_where_nobody_reads() {
    let Ok(full) = File::options().write(true).open("/dev/full") else { return };
    COMMANDS.iter().for_each(|command| assert!(!files(&left_by_its_reader(command, 0).out()).is_empty(), "{command}"));
    let case = Case::bare(SAVED);
    let output = case.program().stderr(full).output().unwrap();
    assert!(output.status.success() && case.out().join("report.json").exists(), "{output:?}");
}
