//! Numbers within texts, and how they are written into golden files.

/// A piece of a line.
#[derive(Debug, Clone, PartialEq)]
pub enum Piece<'a> {
    Words(&'a str),
    Number(&'a str),
}

/// The line in pieces. A number does not begin within a word: `tet4` has none, and `4.5e-3` is one.
pub fn pieces(line: &str) -> Vec<Piece<'_>> {
    let (bytes, mut found, mut begin, mut i) = (line.as_bytes(), Vec::new(), 0, 0);
    while i < bytes.len() {
        let is_free = i == 0 || !(bytes[i - 1].is_ascii_alphanumeric() || matches!(bytes[i - 1], b'_' | b'.'));
        let length = if is_free { length(&bytes[i..]) } else { 0 };
        if length == 0 {
            i += 1;
            continue;
        }
        if begin < i {
            found.push(Piece::Words(&line[begin..i]));
        }
        found.push(Piece::Number(&line[i..i + length]));
        i += length;
        begin = i;
    }
    if begin < bytes.len() {
        found.push(Piece::Words(&line[begin..]));
    }
    found
}

/// How many bytes the number at the beginning of the text has; 0 if the text begins with no number.
fn length(bytes: &[u8]) -> usize {
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let sign = usize::from(matches!(bytes.first(), Some(b'-' | b'+')));
    let whole = digits(sign);
    if whole == 0 {
        return 0;
    }
    let mut end = sign + whole;
    if bytes.get(end) == Some(&b'.') && digits(end + 1) > 0 {
        end += 1 + digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'-' | b'+')));
        let power = if end + 1 + sign <= bytes.len() { digits(end + 1 + sign) } else { 0 };
        end += if power > 0 { 1 + sign + power } else { 0 };
    }
    // `2d` and `8x` are words.
    if bytes.get(end).is_some_and(|b| b.is_ascii_alphabetic() || *b == b'_') { 0 } else { end }
}

/// The number with as many digits as golden files have: two more than are compared, so that rounding does not count.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().expect("a number that was written is one")
}

#[test]
fn numbers_are_found_between_words() {
    let numbers = |line| -> Vec<String> {
        let number = |piece: &Piece| match piece {
            Piece::Number(text) => Some(text.to_string()),
            Piece::Words(_) => None,
        };
        pieces(line).iter().filter_map(number).collect()
    };
    assert_eq!(numbers("tet4 has -1.5e-3 m, 12 of 3,4; 7.0.1"), ["-1.5e-3", "12", "3", "4", "7.0"]);
    assert_eq!(numbers("1e5 2e x9 3D -"), ["1e5"]);
    assert_eq!(rounded(0.1 + 0.2), 0.3);
}
