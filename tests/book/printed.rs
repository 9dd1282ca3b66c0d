//! Whether a text on a page is what a command prints now.
//!
//! Lines are compared word by word. Numbers may differ by two units of the second decimal or by 0.2 %, or by a given share; whole numbers
//! not at all. Times are not compared. `…` stands for any lines, and at the end of a line for the rest of it.

/// # Errors
/// The first line of the page that does not come, with what came instead.
pub fn compare(page: &str, found: &str, share: f64) -> Result<(), String> {
    let (page, found) = (without_times(page), without_times(found));
    let page: Vec<&str> = page.iter().map(String::as_str).collect();
    let found: Vec<&str> = found.iter().map(String::as_str).collect();
    let mut deepest = (0, 0);
    if lines_agree(&page, &found, share, (0, 0), &mut deepest) {
        return Ok(());
    }
    let line = |lines: &[&str], i: usize| lines.get(i).map_or("(nothing)".to_string(), |l| l.trim_end().to_string());
    Err(format!("the page has\n  {}\nthe command printed\n  {}", line(&page, deepest.0), line(&found, deepest.1)))
}

fn lines_agree(page: &[&str], found: &[&str], share: f64, at: (usize, usize), deepest: &mut (usize, usize)) -> bool {
    *deepest = (*deepest).max(at);
    let (i, j) = at;
    match page.get(i) {
        None => j == found.len(),
        Some(line) if line.trim() == "…" => {
            (j..=found.len()).any(|j| lines_agree(page, found, share, (i + 1, j), deepest))
        }
        Some(line) => {
            found.get(j).is_some_and(|other| line_agrees(line, other, share))
                && lines_agree(page, found, share, (i + 1, j + 1), deepest)
        }
    }
}

fn line_agrees(page: &str, found: &str, share: f64) -> bool {
    let (page, open) = match page.trim_end().strip_suffix('…') {
        Some(start) => (start, true),
        None => (page, false),
    };
    let mut others = words(found);
    if open {
        // The last word of the page may be the beginning of one.
        let known = words(page);
        others.truncate(known.len());
        return known.len() == others.len()
            && known.iter().zip(&others).all(|(a, b)| words_agree(a, b, share) || b.starts_with(a.as_str()));
    }
    let known = words(page);
    known.len() == others.len() && known.iter().zip(&others).all(|(a, b)| words_agree(a, b, share))
}

/// Rules of tables are as long as their columns are wide.
fn words(line: &str) -> Vec<String> {
    let is_rule = |word: &str| word.len() > 3 && word.chars().all(|c| matches!(c, '-' | '|' | ':'));
    line.split_whitespace().map(|word| if is_rule(word) { "---".into() } else { word.into() }).collect()
}

pub fn words_agree(a: &str, b: &str, share: f64) -> bool {
    if a == b {
        return true;
    }
    let bare = |word: &str| {
        let trimmed =
            word.trim_matches(|c: char| matches!(c, ',' | ';' | ':' | ')' | '(' | '%' | '|' | '*' | '[' | ']'));
        trimmed.replace('−', "-")
    };
    let (a, b) = (bare(a), bare(b));
    let (Ok(x), Ok(y)) = (a.parse::<f64>(), b.parse::<f64>()) else { return false };
    // Figures that agree within a share can be rounded to neighbouring last digits.
    let digits = a.split_once('.').map_or(0, |(_, after)| after.chars().take_while(char::is_ascii_digit).count());
    let last = if share > 0.0 && !a.contains('e') { 1.001 * 0.1f64.powi(digits as i32) } else { 0.0 };
    let allowed = last.max(0.021f64.min(0.1 * x.abs().max(y.abs()))) + share.max(2e-3) * x.abs();
    if a.contains(['.', 'e']) { (x - y).abs() <= allowed } else { x == y }
}

/// The lines with `T` for each time: a number before a unit of time, and the column of a table whose heading is one.
fn without_times(text: &str) -> Vec<String> {
    let mut column: Option<usize> = None;
    let mut lines = Vec::new();
    for line in text.lines() {
        if line.trim().is_empty() {
            column = None;
        }
        column = ["us/element", "seconds"].iter().find_map(|word| end_of(line, word)).or(column);
        let masked = column.map_or(line.to_string(), |end| without_word_at(line, end));
        let mut words: Vec<&str> = masked.split_whitespace().collect();
        for i in 1..words.len() {
            let is_unit = matches!(words[i].trim_end_matches([',', '.', ')']), "ms" | "s" | "us" | "ns");
            if is_unit && words[i - 1].parse::<f64>().is_ok() {
                words[i - 1] = "T";
            }
        }
        lines.push(words.join(" "));
    }
    lines
}

/// Where the word ends in the line, in characters.
fn end_of(line: &str, word: &str) -> Option<usize> {
    line.find(word).map(|at| line[..at].chars().count() + word.len())
}

/// The line with `T` for the number that ends there.
fn without_word_at(line: &str, end: usize) -> String {
    let characters: Vec<char> = line.chars().collect();
    let Some(head) = characters.get(..end) else { return line.into() };
    let start = head.iter().rposition(|c| c.is_whitespace()).map_or(0, |at| at + 1);
    let word: String = head[start..].iter().collect();
    // A mark says that some elements have the constants of others.
    let ends_there = characters.get(end).is_none_or(|c| c.is_whitespace());
    let word = word.trim_end_matches('*');
    if ends_there && word.parse::<f64>().is_ok() {
        let text = |part: &[char]| part.iter().collect::<String>();
        return format!("{}T{}", text(&head[..start]), text(&characters[end..]));
    }
    line.into()
}

#[test]
fn figures_agree_to_rounding_and_times_are_not_compared() {
    let table = " fit   fit us/element   error\n a              12.30    1.37\n";
    assert!(compare(table, " fit   fit us/element   error\n a               0.30    1.38\n", 0.0).is_ok());
    assert!(compare(table, " fit   fit us/element   error\n a               0.30    1.48\n", 0.0).is_err());
    assert!(compare("solved: 5.21 ms, 12 springs\n", "solved: 70 ms, 12 springs\n", 0.0).is_ok());
    assert!(compare("solved: 5.21 ms, 12 springs\n", "solved: 5.21 ms, 13 springs\n", 0.0).is_err());
    assert!(compare("a\n…\nz\n", "a\nb\nc\nz\n", 0.0).is_ok());
    assert!(compare("a\n…\nz\n", "a\nb\nc\n", 0.0).is_err());
    assert!(compare("length,0 8,…\n", "length,0 8,1.2e0,0\n", 0.0).is_ok());
    assert!(words_agree("0.01", "0.02", 0.2) && !words_agree("0.01", "0.03", 0.2) && !words_agree("0.01", "0.02", 0.0));
    assert!(!words_agree("0.0000", "0.0209", 0.0) && words_agree("−0.99", "-0.98", 0.0));
}
