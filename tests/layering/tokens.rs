//! The words and signs of a source file, without comments, literals and what is compiled for tests only.

/// Identifiers, `::`, and every other sign as a text of its own.
pub fn tokens(text: &str) -> Vec<String> {
    without_tests(split(&text.chars().collect::<Vec<char>>()))
}

pub fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

fn split(text: &[char]) -> Vec<String> {
    let (mut tokens, mut i) = (Vec::new(), 0);
    let at = |i: usize| text.get(i).copied().unwrap_or(' ');
    let in_word = |i: usize| at(i).is_alphanumeric() || at(i) == '_';
    while i < text.len() {
        let start = i;
        match (at(i), at(i + 1)) {
            ('/', '/') => i = after(text, i, "\n"),
            ('/', '*') => i = after_comment(text, i),
            ('"', _) => i = after_string(text, i),
            ('\'', '\\') => i = after(text, i + 3, "'"),
            ('\'', _) if at(i + 2) == '\'' => i += 3,
            // A lifetime.
            ('\'', _) => {
                i += 1;
                while in_word(i) {
                    i += 1;
                }
            }
            (':', ':') => {
                tokens.push("::".to_string());
                i += 2;
            }
            (c, _) if c.is_ascii_digit() => {
                while in_word(i) || (at(i) == '.' && at(i + 1).is_ascii_digit()) {
                    i += 1;
                }
            }
            (c, _) if c.is_alphabetic() || c == '_' => {
                while in_word(i) {
                    i += 1;
                }
                let word: String = text[start..i].iter().collect();
                let hashes = (i..).take_while(|&j| at(j) == '#').count();
                if ["r", "br", "cr"].contains(&word.as_str()) && at(i + hashes) == '"' {
                    let end = format!("\"{}", "#".repeat(hashes));
                    i = after(text, i + hashes + 1, &end);
                } else if word == "r" && hashes == 1 {
                    i += 1;
                } else {
                    tokens.push(word);
                }
            }
            (c, _) => {
                if !c.is_whitespace() {
                    tokens.push(c.to_string());
                }
                i += 1;
            }
        }
    }
    tokens
}

/// The place after the next `end`.
fn after(text: &[char], from: usize, end: &str) -> usize {
    let end: Vec<char> = end.chars().collect();
    (from..text.len()).find(|&i| text[i..].starts_with(&end)).map_or(text.len(), |i| i + end.len())
}

fn after_comment(text: &[char], mut i: usize) -> usize {
    let mut depth = 0;
    loop {
        match text.get(i..i + 2) {
            Some(['/', '*']) => (depth, i) = (depth + 1, i + 2),
            Some(['*', '/']) => (depth, i) = (depth - 1, i + 2),
            Some(_) => i += 1,
            None => return text.len(),
        }
        if depth == 0 {
            return i;
        }
    }
}

fn after_string(text: &[char], start: usize) -> usize {
    let mut i = start + 1;
    while i < text.len() && text[i] != '"' {
        i += if text[i] == '\\' { 2 } else { 1 };
    }
    i + 1
}

fn without_tests(tokens: Vec<String>) -> Vec<String> {
    const MARK: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut kept, mut i) = (Vec::new(), 0);
    while i < tokens.len() {
        if tokens[i..].iter().zip(MARK).filter(|(token, mark)| token == mark).count() == MARK.len() {
            i = after_item(&tokens, i);
        } else {
            kept.push(tokens[i].clone());
            i += 1;
        }
    }
    kept
}

/// The place after the item that begins at `i`: after its `;` or its block.
fn after_item(tokens: &[String], i: usize) -> usize {
    let end = (i..tokens.len()).find(|&j| tokens[j] == ";" || tokens[j] == "{").unwrap_or(tokens.len() - 1);
    if tokens[end] == "{" { after_block(tokens, end) } else { end + 1 }
}

/// The place after the `}` that belongs to the `{` at `open`.
pub fn after_block(tokens: &[String], open: usize) -> usize {
    let mut depth = 0;
    for (i, token) in tokens.iter().enumerate().skip(open) {
        match token.as_str() {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return i + 1;
        }
    }
    tokens.len()
}
