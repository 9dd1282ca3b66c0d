//! The example of the book.

use springfit_element::element::Element;
use springfit_generate::generate::{Program, Recipe, language};
use std::fs;
use std::path::Path;
use std::process::Command;

/// The text of the first block of a kind after a place.
fn block<'a>(page: &'a str, kind: &str) -> &'a str {
    let after = page.split_once(&format!("```{kind}\n")).expect("the page has such a block").1;
    after.split_once("```").expect("the block ends").0
}

#[test]
fn the_example_of_the_book_compiles_and_prints_what_the_page_says() {
    let page =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/src/reference/generate.md")).unwrap();
    let folder = tempfile::TempDir::new().unwrap();
    let element = Element::load("hex8").unwrap();
    let program = Program::new(&element, None, Recipe::named("exact", None, None).unwrap()).unwrap();
    let header = program.print(language("c").unwrap()).unwrap();
    fs::write(folder.path().join("hex8_exact.h"), header).unwrap();
    fs::write(folder.path().join("cube.c"), block(&page, "c")).unwrap();
    let run = |name: &str, arguments: &[&str]| {
        let output = Command::new(name).args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1", "cube.c", "-o", "cube", "-lm"];
    run("cc", &strict);
    assert_eq!(run("./cube", &[]), block(&page, "text"));
}
