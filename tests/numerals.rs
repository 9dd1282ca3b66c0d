//! Numbers as text are those of the standard library and of `serde_json`.

use springfit_foundation::text::{push_exponential, push_list, push_number};

/// Bits in no order (xorshift; Marsaglia, J. Stat. Softw. 8, 2003).
fn bits(count: usize) -> impl Iterator<Item = u64> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    std::iter::repeat_with(move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    })
    .take(count)
}

/// Powers of two and their neighbours, among which are ties between two shortest numerals; whole numbers and parts; any bits.
fn numbers() -> impl Iterator<Item = f64> {
    let mantissas = [0, 1, 2, (1 << 51) - 1, 1 << 51, (1 << 52) - 1];
    let powers = (0..2048_u64).flat_map(move |e| mantissas.map(|m| f64::from_bits(e << 52 | m)));
    let plain = (0..20_000).flat_map(|i| [f64::from(i), 1e-3 * f64::from(i), 1e15 * f64::from(i), 1.0 / f64::from(i)]);
    powers.chain(plain).chain(bits(300_000).flat_map(|b| [f64::from_bits(b), (b >> 11) as f64 * 2.0_f64.powi(-4)]))
}

#[test]
fn exponential_numerals_are_those_of_the_standard_library() {
    let mut text = Vec::new();
    for value in numbers().flat_map(|value| [value, -value]) {
        text.clear();
        push_exponential(&mut text, value);
        let expected = if value.is_nan() { "NaN".to_string() } else { format!("{value:e}") };
        assert_eq!(String::from_utf8_lossy(&text), expected, "{:x}", value.to_bits());
    }
}

#[test]
fn numbers_of_json_are_those_of_its_library() {
    let mut text = Vec::new();
    for value in numbers().flat_map(|value| [value, -value]) {
        text.clear();
        push_number(&mut text, value);
        assert_eq!(String::from_utf8_lossy(&text), serde_json::to_string(&value).unwrap());
    }
}

#[test]
fn lists_have_blanks_between_their_numbers() {
    let mut text = b"1,".to_vec();
    push_list(&mut text, &[0, 10, u64::MAX]);
    assert_eq!(text, b"1,0 10 18446744073709551615");
}
