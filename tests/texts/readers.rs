//! Readers of the grammars in which texts are written, which know the grammars alone.

use std::fs;
use std::path::Path;
use std::process::Command;

/// Runs a script of Python in the folder; it fails where a file is not what the script says of it.
pub fn parsed_by_python(folder: &Path, script: &str) {
    fs::write(folder.join("read_all.py"), script).unwrap();
    let Ok(output) = Command::new("python3").arg("read_all.py").current_dir(folder).output() else {
        return println!("not run: there is no python3");
    };
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}", words.chars().take(2000).collect::<String>());
}

/// What is printed of the text between two parts of LaTeX; none where a command is not one that prints a character.
pub fn of_latex(text: &str, begin: &str, end: &str) -> Option<String> {
    let inside = text.split_once(begin)?.1;
    printed(&inside[..inside.find(end)?])
}

/// What LaTeX prints of a text that has no commands but those that print characters.
pub fn printed(text: &str) -> Option<String> {
    const WORDS: [(&str, &str); 17] = [
        ("\\textbackslash{}", "\\"),
        ("\\textasciitilde{}", "~"),
        ("\\textasciicircum{}", "^"),
        ("\\char34{}", "\""),
        ("\\dots{}", "…"),
        ("\\textmu{}", "µ"),
        ("$<$", "<"),
        ("$>$", ">"),
        ("$|$", "|"),
        ("{[}", "["),
        ("{*}", "*"),
        ("{}", ""),
        ("\\&", "&"),
        ("\\%", "%"),
        ("\\$", "$"),
        ("\\#", "#"),
        ("\\_", "_"),
    ];
    let mut rest = text;
    let mut plain = String::new();
    while let Some(c) = rest.chars().next() {
        let word = WORDS.iter().chain(&[("\\{", "{"), ("\\}", "}")]).find(|(word, _)| rest.starts_with(word));
        match word {
            Some((word, shown)) => {
                plain += shown;
                rest = &rest[word.len()..];
            }
            None if "\\{}$&#^_~%\"".contains(c) => return None,
            None => {
                // Two of these would be one character.
                if "-'`".contains(c) && rest[1..].starts_with(c) {
                    return None;
                }
                plain.push(c);
                rest = &rest[c.len_utf8()..];
            }
        }
    }
    Some(plain)
}

/// Parts of a line of Markdown or LaTeX between separators that have no backslash before them.
pub fn parts(line: &str, separator: char) -> Vec<String> {
    let (mut parts, mut is_escaped) = (vec![String::new()], false);
    for c in line.chars() {
        match c == separator && !is_escaped {
            true => parts.push(String::new()),
            false => parts.last_mut().unwrap().push(c),
        }
        is_escaped = c == '\\' && !is_escaped;
    }
    parts
}

/// What Markdown prints of a text without marks; none where a mark is left.
pub fn of_markdown(text: &str) -> Option<String> {
    let mut plain = String::new();
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        let is_inside =
            plain.ends_with(char::is_alphanumeric) && characters.peek().is_some_and(|c| c.is_alphanumeric());
        match c {
            '_' if is_inside => plain.push(c),
            '\\' => plain.push(characters.next()?),
            '&' => {
                let name: String = characters.by_ref().take_while(|c| *c != ';').collect();
                plain.push(match name.as_str() {
                    "lt" => '<',
                    "amp" => '&',
                    _ => return None,
                });
            }
            '*' | '_' | '`' | '[' | ']' | '<' | '|' | '~' | '$' => return None,
            c => plain.push(c),
        }
    }
    Some(plain)
}
