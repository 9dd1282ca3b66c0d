//! Links lead somewhere, and the pages are those of the table of contents.

use super::markdown::{page, pages, root};
use crate::kit::files;
use std::collections::BTreeSet;

#[test]
fn every_link_leads_somewhere() {
    let mut wrong = Vec::new();
    for page in pages() {
        for (line, target) in page.links() {
            let (path, anchor) = target.split_once('#').unwrap_or((&target, ""));
            if path.contains("://") {
                continue;
            }
            let leads_to = if path.is_empty() { page.path.clone() } else { page.path.parent().unwrap().join(path) };
            let known = leads_to.exists()
                && (anchor.is_empty()
                    || super::markdown::page(leads_to.to_str().unwrap()).anchors().iter().any(|a| a == anchor));
            if !known {
                wrong.push(format!("{}:{line}: {target}", page.name()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_page_of_the_book_is_in_its_contents() {
    let contents = page("docs/src/SUMMARY.md");
    let listed: BTreeSet<_> = contents.links().into_iter().map(|(_, target)| format!("docs/src/{target}")).collect();
    let there: BTreeSet<_> =
        pages().iter().map(|page| page.name()).filter(|name| name.starts_with("docs/src/")).collect();
    let pages: BTreeSet<_> = there.into_iter().filter(|name| !name.ends_with("SUMMARY.md")).collect();
    assert_eq!(listed, pages);
}

/// A file of the book that is shown outside of it leads to pages by their place in the repository; in the book no link may leave it.
#[test]
fn links_of_the_book_stay_in_the_book() {
    let book = root().join("docs/src");
    for page in pages().iter().filter(|page| page.path.starts_with(&book)) {
        for (line, target) in
            page.links().iter().filter(|(_, target)| !target.contains("://") && !target.starts_with('#'))
        {
            let leads_to = page.path.parent().unwrap().join(target.split('#').next().unwrap());
            let within = leads_to.canonicalize().is_ok_and(|path| path.starts_with(book.canonicalize().unwrap()));
            assert!(within, "{}:{line}: {target}", page.name());
        }
    }
}

/// Sources name pages of the book by their titles.
#[test]
fn pages_that_the_sources_name_are_in_the_book() {
    let titles: Vec<String> = pages()
        .iter()
        .map(|page| page.text.lines().next().unwrap_or("").trim_start_matches("# ").to_string())
        .collect();
    let mut named = 0;
    // A published package holds its own sources alone.
    let folders = ["crates", "src"].map(|folder| root().join(folder)).into_iter().filter(|folder| folder.is_dir());
    for path in folders.flat_map(|folder| files(&folder)) {
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        for line in text.lines().filter(|line| line.starts_with("//! Theory: page")) {
            for title in line.split('*').skip(1).step_by(2) {
                assert!(titles.iter().any(|known| known == title), "{}: no page *{title}*", path.display());
                named += 1;
            }
        }
    }
    assert!(named > 0 || !root().join("crates").is_dir());
}
