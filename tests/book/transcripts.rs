//! Commands of the pages, run as a reader runs them.

use super::markdown::{Block, Page, page, root};
use super::printed::compare;
use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

/// The program first, as after `cargo install`.
fn search_path() -> OsString {
    let own = Path::new(env!("CARGO_BIN_EXE_springfit")).parent().unwrap().to_path_buf();
    let others = std::env::var_os("PATH").unwrap_or_default();
    std::env::join_paths(std::iter::once(own).chain(std::env::split_paths(&others))).unwrap()
}

/// Writes the files of the page and runs its `sh` blocks, in the order of the page; a `text` block right after one is what it prints.
fn run(page: &Page, folder: &Path) {
    let blocks = page.blocks();
    for (i, block) in blocks.iter().enumerate() {
        let place = format!("{}:{}", page.name(), block.line);
        if let Some(name) = block.mark.as_deref().and_then(|mark| mark.strip_prefix("file: ")) {
            std::fs::write(folder.join(name), &block.text).unwrap();
        }
        if block.language != "sh" {
            continue;
        }
        let script = format!("exec 2>&1\nset -e\n{}", block.text);
        let output = Command::new("bash").args(["-c", &script]).env("PATH", search_path()).current_dir(folder).output();
        let output = output.unwrap();
        let printed = String::from_utf8(output.stdout).unwrap();
        let fails = block.mark.as_deref() == Some("fails");
        assert_eq!(output.status.success(), !fails, "{place}\n{printed}");
        let expected: Option<&Block> = blocks.get(i + 1).filter(|next| next.language == "text" && next.follows);
        if let Some(expected) = expected
            && let Err(problem) = compare(&expected.text, &printed, 0.0)
        {
            panic!("{place}: {problem}\nall that was printed:\n{printed}");
        }
    }
}

/// Runs the pages that say that they take minutes, or the others; returns how many there are.
fn tutorials(long: bool) -> usize {
    let mut count = 0;
    for entry in std::fs::read_dir(root().join("docs/src/start")).unwrap() {
        let folder = tempfile::tempdir().unwrap();
        let page = page(entry.unwrap().path().to_str().unwrap());
        if page.text.contains("<!-- takes minutes -->") != long {
            continue;
        }
        count += 1;
        // A page may say that it is read in the folder of the repository.
        if page.text.contains("In the folder of the repository") {
            std::os::unix::fs::symlink(root().join("scenes"), folder.path().join("scenes")).unwrap();
        }
        run(&page, folder.path());
    }
    count
}

#[test]
fn the_tutorials_print_what_they_say_in_an_empty_folder() {
    assert!(tutorials(false) > 15);
}

#[test]
#[ignore = "takes minutes; .ci/long has it"]
fn the_long_tutorials_print_what_they_say_in_an_empty_folder() {
    assert!(tutorials(true) > 0);
}

/// In a folder like that of the repository, with the files that the recipes have from the tutorials.
#[test]
fn the_commands_of_the_readme_print_what_it_says() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["scenes", "elements"] {
        std::os::unix::fs::symlink(root().join(name), folder.path().join(name)).unwrap();
    }
    std::fs::copy(root().join("scenes/meshes/cube_tet.msh"), folder.path().join("organ.msh")).unwrap();
    for block in page("docs/src/start/voxels.md").blocks() {
        if let Some(name) = block.mark.as_deref().and_then(|mark| mark.strip_prefix("file: ")) {
            std::fs::write(folder.path().join(name), &block.text).unwrap();
        }
    }
    run(&page("README.md"), folder.path());
}
