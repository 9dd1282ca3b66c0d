//! Reads matrices in the format of Matrix Market.

use crate::error::{Error, ErrorKind, Result};
use nalgebra::DMatrix;
use std::path::Path;

/// A matrix has at most this number of rows: a dense one with as many columns takes 800 MB.
const MOST: usize = 10_000;

/// Reads a real matrix, `[rows × columns]`: coordinate or array, general, symmetric or skew-symmetric.
///
/// # Errors
/// The file cannot be read, is of another format or of complex numbers, has a place out of its range, is cut short; or it has more than 10 000
/// rows, kind `Limit`.
pub fn read_matrix(path: &Path) -> Result<DMatrix<f64>> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::io("cannot be read", e).in_file(path))?;
    parse(&text).map_err(|e| e.in_file(path))
}

fn parse(text: &str) -> Result<DMatrix<f64>> {
    let syntax = |expected: &str, found: &str| {
        Error::expected("matrix", expected, format!("\"{found}\"")).of_kind(ErrorKind::Syntax)
    };
    let mut lines = text.lines().enumerate();
    let head = lines.next().map(|(_, line)| line.to_lowercase()).unwrap_or_default();
    let words: Vec<&str> = head.split_whitespace().collect();
    let ["%%matrixmarket", "matrix", layout, numbers, symmetry] = words[..] else {
        return Err(syntax("%%MatrixMarket matrix coordinate real symmetric, or the like", &head).on_line(1));
    };
    let is_sparse = match layout {
        "coordinate" => true,
        "array" => false,
        other => return Err(syntax("coordinate or array", other).on_line(1)),
    };
    if !matches!(numbers, "real" | "integer" | "double") {
        return Err(syntax("real numbers", numbers).on_line(1).of_kind(ErrorKind::Unsupported));
    }
    let mirror = match symmetry {
        "general" => None,
        "symmetric" => Some(1.0),
        "skew-symmetric" => Some(-1.0),
        other => {
            return Err(syntax("general, symmetric or skew-symmetric", other)
                .on_line(1)
                .of_kind(ErrorKind::Unsupported));
        }
    };
    let mut rest = lines.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('%'));
    let (at, sizes) = rest.next().ok_or_else(|| syntax("the size of the matrix", ""))?;
    let numbers: Vec<usize> = sizes.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let (rows, columns, entries) = match (&numbers[..], is_sparse) {
        (&[rows, columns, entries], true) => (rows, columns, entries),
        (&[rows, columns], false) => (rows, columns, 0),
        _ => return Err(syntax("rows, columns and, with coordinates, entries", sizes).on_line(at + 1)),
    };
    if rows > MOST || columns > MOST {
        let expected = format!("at most {MOST} rows: a part of a body, such as a superelement");
        return Err(Error::expected("matrix", expected, rows.max(columns)).on_line(at + 1).of_kind(ErrorKind::Limit));
    }
    if mirror.is_some() && rows != columns {
        return Err(syntax("a square matrix that is symmetric", sizes).on_line(at + 1));
    }
    let mut matrix = DMatrix::zeros(rows, columns);
    let mut put = |i: usize, j: usize, value: f64| {
        // Entries of one place add up, as those of assembled matrices do.
        matrix[(i, j)] += value;
        // An entry of the diagonal is its own mirror image, and would count twice.
        if let Some(sign) = mirror.filter(|_| i != j) {
            matrix[(j, i)] += sign * value;
        }
    };
    let real = |word: Option<&str>, at: usize| {
        let word = word.unwrap_or_default();
        let number = word.parse::<f64>().ok().filter(|x| x.is_finite());
        number.ok_or_else(|| syntax("a number", word).on_line(at + 1))
    };
    let mut count = 0;
    if is_sparse {
        for (at, line) in rest {
            let mut words = line.split_whitespace();
            let mut place = |size: usize| {
                let word = words.next().unwrap_or_default();
                let place = word.parse::<usize>().ok().filter(|place| (1..=size).contains(place));
                place
                    // Rows and columns are counted from one in the file.
                    .map(|place| place - 1)
                    .ok_or_else(|| syntax(&format!("a place from 1 to {size}"), word).on_line(at + 1))
            };
            let (i, j) = (place(rows)?, place(columns)?);
            put(i, j, real(words.next(), at)?);
            count += 1;
        }
        // A file that was cut short would be read as another matrix.
        if count != entries {
            return Err(Error::expected("matrix", format!("{entries} entries"), count).of_kind(ErrorKind::Syntax));
        }
        return Ok(matrix);
    }
    // Columns first; of a symmetric matrix what is below the diagonal, of a skew one without it.
    let first = |column: usize| match mirror {
        None => 0,
        Some(sign) if sign > 0.0 => column,
        Some(_) => column + 1,
    };
    let places: Vec<(usize, usize)> = (0..columns).flat_map(|j| (first(j)..rows).map(move |i| (i, j))).collect();
    for (at, line) in rest {
        for word in line.split_whitespace() {
            let Some(&(i, j)) = places.get(count) else {
                return Err(Error::expected("matrix", format!("{} numbers", places.len()), "more").on_line(at + 1));
            };
            put(i, j, real(Some(word), at)?);
            count += 1;
        }
    }
    match count == places.len() {
        true => Ok(matrix),
        false => Err(Error::expected("matrix", format!("{} numbers", places.len()), count).of_kind(ErrorKind::Syntax)),
    }
}
