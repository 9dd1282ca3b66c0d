//! Numbers as text, appended to bytes: what a large file is made of.

/// Appends a whole number.
pub fn push_whole(text: &mut Vec<u8>, value: u64) {
    text.extend_from_slice(itoa::Buffer::new().format(value).as_bytes());
}

/// Appends whole numbers with blanks between them.
pub fn push_list(text: &mut Vec<u8>, values: &[u64]) {
    for (place, &value) in values.iter().enumerate() {
        if place > 0 {
            text.push(b' ');
        }
        push_whole(text, value);
    }
}

/// Appends a number of JSON: the fewest digits that are read as the same number; `null` if it is not finite.
pub fn push_number(text: &mut Vec<u8>, value: f64) {
    match value.is_finite() {
        true => text.extend_from_slice(zmij::Buffer::new().format_finite(value).as_bytes()),
        false => text.extend_from_slice(b"null"),
    }
}

/// Appends what `{value:e}` prints: the fewest digits that are read as the same number, with an exponent, such as `1.5e-3`.
pub fn push_exponential(text: &mut Vec<u8>, value: f64) {
    if value == 0.0 || !value.is_finite() {
        let word: &[u8] = match value {
            value if value.is_nan() => b"NaN",
            f64::INFINITY => b"inf",
            f64::NEG_INFINITY => b"-inf",
            value if value.is_sign_negative() => b"-0e0",
            _ => b"0e0",
        };
        text.extend_from_slice(word);
        return;
    }
    let start = text.len();
    if value < 0.0 {
        text.push(b'-');
    }
    // `12.5`, `0.00125` or `1.25e-7`
    let mut buffer = zmij::Buffer::new();
    let printed = buffer.format_finite(value.abs()).as_bytes();
    let (digits, mut exponent) = match printed.iter().rposition(|byte| *byte == b'e') {
        Some(at) => (&printed[..at], whole(&printed[at + 1..])),
        None => (printed, 0),
    };
    let point = digits.iter().position(|byte| *byte == b'.').unwrap_or(digits.len());
    let (before, after) = (&digits[..point], digits.get(point + 1..).unwrap_or_default());
    let first = text.len();
    if before == b"0" {
        let zeros = after.iter().take_while(|digit| **digit == b'0').count();
        text.push(after[zeros]);
        text.push(b'.');
        text.extend_from_slice(&after[zeros + 1..]);
        exponent -= zeros as i32 + 1;
    } else {
        text.push(before[0]);
        text.push(b'.');
        text.extend_from_slice(&before[1..]);
        text.extend_from_slice(after);
        exponent += point as i32 - 1;
    }
    while let Some(b'0') = text.last() {
        text.pop();
    }
    let decimals = (text.len() - first) as i32 - 2;
    if decimals == 0 {
        text.pop();
    }
    // Where two shortest numerals are equally near, the standard library takes the larger one, which is not always the even one. Then twice
    // the number, in units of the last digit, is odd.
    if lowest_bit(value) == exponent - decimals - 1 {
        text.truncate(start);
        text.extend_from_slice(format!("{value:e}").as_bytes());
        return;
    }
    text.push(b'e');
    if exponent < 0 {
        text.push(b'-');
    }
    push_whole(text, u64::from(exponent.unsigned_abs()));
}

/// The exponent of the lowest bit of a number that is not zero.
fn lowest_bit(value: f64) -> i32 {
    let bits = value.to_bits();
    let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
    // Normal numbers have a leading one that is not stored. Subnormal ones have none, and the exponent of the least
    // normal number.
    let mantissa = if exponent == 0 { fraction } else { fraction | 1 << 52 };
    // The exponent is stored with 1023 added, and the mantissa counts units of 2⁻⁵².
    exponent.max(1) - 1075 + mantissa.trailing_zeros() as i32
}

/// The whole number that these digits are, after a sign.
fn whole(digits: &[u8]) -> i32 {
    let (sign, digits) = match digits {
        [b'-', rest @ ..] => (-1, rest),
        [b'+', rest @ ..] => (1, rest),
        all => (1, all),
    };
    sign * digits.iter().fold(0, |sum, digit| 10 * sum + i32::from(digit - b'0'))
}
