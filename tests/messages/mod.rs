//! Messages are compared by their place and by what was found; the words between are free.

/// Whether `message` reads as `pattern`, in which `…` stands for any words: `fit[0].higher: … found 2`.
///
/// # Errors
/// Both, if it does not.
pub fn reads(message: &str, pattern: &str) -> Result<(), String> {
    if matches(message, pattern) { Ok(()) } else { Err(format!("expected {pattern:?}, found {message:?}")) }
}

fn matches(message: &str, pattern: &str) -> bool {
    match pattern.split_once('…') {
        None => message == pattern,
        Some((first, rest)) => message.strip_prefix(first).is_some_and(|message| {
            let mut starts = message.char_indices().map(|(i, _)| i).chain([message.len()]);
            starts.any(|i| matches(&message[i..], rest))
        }),
    }
}

#[test]
fn only_the_words_between_are_free() {
    let message = "fit[0].higher: expected a scale above 0 and at most 1, found 1.5";
    for pattern in [message, "fit[0].higher: …", "fit[0].higher: … above 0 … found 1.5", "… found 1.5"] {
        reads(message, pattern).unwrap();
    }
    for pattern in
        ["", "fit[0].higher", "fit[1].higher: …", "fit[0].higher: … found 1", "fit[0].higher: … 2 … found 1.5"]
    {
        reads(message, pattern).unwrap_err();
    }
}
