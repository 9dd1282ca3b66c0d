//! The pages of the book: fenced blocks with the marks before them, tables between marks, and links.

use crate::kit::files_of;
use std::path::{Path, PathBuf};

/// A fenced block of a page.
pub struct Block {
    /// The comment right before it, such as `file: organ.toml`.
    pub mark: Option<String>,
    /// The word after the fence, such as `toml`.
    pub language: String,
    pub text: String,
    /// Of its first line in the page, from 1.
    pub line: usize,
    /// Whether nothing but empty lines and a mark stand between it and the block before it.
    pub follows: bool,
}

pub struct Page {
    pub path: PathBuf,
    pub text: String,
}

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A page by its path in the repository.
pub fn page(path: &str) -> Page {
    let path = root().join(path);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    Page { path, text }
}

/// The pages of the book, and those beside it.
pub fn pages() -> Vec<Page> {
    let mut paths = files_of(&root().join("docs/src"), "md");
    paths.extend(["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| root().join(name)));
    paths.iter().map(|path| page(path.to_str().unwrap())).collect()
}

impl Page {
    pub fn name(&self) -> String {
        self.path.strip_prefix(root()).unwrap().display().to_string()
    }

    /// In the order of the page.
    pub fn blocks(&self) -> Vec<Block> {
        let (mut blocks, mut mark, mut follows): (Vec<Block>, _, _) = (Vec::new(), None, false);
        let mut lines = self.text.lines().enumerate();
        while let Some((i, line)) = lines.next() {
            if let Some(language) = line.strip_prefix("```") {
                let inside: Vec<&str> = lines.by_ref().map(|(_, line)| line).take_while(|l| *l != "```").collect();
                blocks.push(Block {
                    mark: mark.take(),
                    language: language.into(),
                    text: inside.iter().map(|line| format!("{line}\n")).collect(),
                    line: i + 2,
                    follows,
                });
                follows = true;
            } else if let Some(comment) = line.strip_prefix("<!-- ").and_then(|l| l.strip_suffix(" -->")) {
                mark = Some(comment.to_string());
            } else if !line.trim().is_empty() {
                (mark, follows) = (None, false);
            }
        }
        blocks
    }

    /// The text outside fenced blocks and code between backquotes, line by line, from 1.
    pub fn prose(&self) -> Vec<(usize, String)> {
        let mut inside = false;
        let mut lines = Vec::new();
        for (i, line) in self.text.lines().enumerate() {
            if line.starts_with("```") {
                inside = !inside;
            } else if !inside {
                let outside = line.split('`').step_by(2).collect::<Vec<_>>().join(" ");
                lines.push((i + 1, outside));
            }
        }
        lines
    }

    /// What the links and pictures of the page lead to, with the line of each.
    pub fn links(&self) -> Vec<(usize, String)> {
        let ends = |(line, text): (usize, String)| {
            let parts: Vec<String> =
                text.split("](").skip(1).map(|rest| rest.split(')').next().unwrap().into()).collect();
            parts.into_iter().map(move |target| (line, target))
        };
        self.prose().into_iter().flat_map(ends).collect()
    }

    /// The anchors of the page's headings, as mdBook and GitHub make them.
    pub fn anchors(&self) -> Vec<String> {
        let mut inside = false;
        let mut found = Vec::new();
        for line in self.text.lines() {
            inside ^= line.starts_with("```");
            if let Some(title) = line.strip_prefix('#').filter(|_| !inside) {
                let title = title.trim_start_matches('#').trim().to_lowercase();
                let kept = title.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
                found.push(kept.map(|c| if c == ' ' { '-' } else { c }).collect());
            }
        }
        found
    }

    /// The lines between `<!-- table NAME -->` and `<!-- end -->`, by name.
    pub fn tables(&self) -> Vec<(String, String)> {
        let mut found = Vec::new();
        for part in self.text.split("\n<!-- table ").skip(1) {
            let (name, rest) = part.split_once(" -->\n").expect("a mark ends its line");
            let (table, _) =
                rest.split_once("<!-- end -->").unwrap_or_else(|| panic!("{}: {name}: no end", self.name()));
            found.push((name.to_string(), table.trim().to_string()));
        }
        found
    }

    /// Puts another text between the marks of a table.
    pub fn write_table(&mut self, name: &str, table: &str) {
        let head = format!("<!-- table {name} -->\n");
        let (before, rest) = self.text.split_once(&head).unwrap();
        let (_, after) = rest.split_once("<!-- end -->").unwrap();
        self.text = format!("{before}{head}{}\n<!-- end -->{after}", table.trim());
        std::fs::write(&self.path, &self.text).unwrap();
    }
}
