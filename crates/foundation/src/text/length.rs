//! Long texts cut to what a reader of a message needs of them.

use std::borrow::Cow;

/// The longest text in quotes, in characters: names, values and expressions that people write are shorter.
const LONGEST_QUOTED: usize = 120;
/// The longest word outside of quotes; paths are such words.
const LONGEST_WORD: usize = 240;
/// The longest message. Lists of known names are a few hundred characters long.
const LONGEST: usize = 4000;
/// Characters that are left of what is cut: a line of a terminal.
const KEPT: usize = 80;
/// Characters that are left of a message that is cut, few enough that what is said of its length makes it no longer than the longest.
const KEPT_OF_MESSAGE: usize = 3900;

/// The message with its long quoted texts and words cut: `"aaaa…" (10000 characters)`. What is not cut is left as it is.
pub fn cut(message: &str) -> Cow<'_, str> {
    if message.len() <= LONGEST_QUOTED {
        return Cow::Borrowed(message);
    }
    let mut short = String::with_capacity(message.len().min(2 * LONGEST));
    let mut said: Option<String> = None;
    for (i, part) in message.split('"').enumerate() {
        if i > 0 {
            short.push('"');
            short.extend(said.take());
        }
        match i % 2 {
            0 => part.split_inclusive(char::is_whitespace).for_each(|word| {
                let (begin, length) = beginning(word, LONGEST_WORD);
                short.push_str(begin);
                short.extend(length.map(|length| format!("…{length} ")));
            }),
            _ => {
                let (begin, length) = beginning(part, LONGEST_QUOTED);
                short.push_str(begin);
                short.extend(length.iter().map(|_| '…'));
                said = length;
            }
        }
    }
    match short.char_indices().nth(LONGEST) {
        None if short == message => Cow::Borrowed(message),
        None => Cow::Owned(short),
        Some(_) => {
            let end = short.char_indices().nth(KEPT_OF_MESSAGE).map_or(short.len(), |(end, _)| end);
            Cow::Owned(format!("{}… ({} characters)", &short[..end], message.chars().count()))
        }
    }
}

/// The path with its middle cut out if it is long: its end says most.
pub fn cut_path(path: &str) -> Cow<'_, str> {
    let count = path.chars().count();
    if count <= LONGEST_WORD {
        return Cow::Borrowed(path);
    }
    let (begin, _) = beginning(path, KEPT);
    let end = path.char_indices().nth(count - KEPT).map_or(path.len(), |(end, _)| end);
    Cow::Owned(format!("{begin}…{}", &path[end..]))
}

/// The text if it has at most so many characters, or its beginning and its length in words.
fn beginning(text: &str, most: usize) -> (&str, Option<String>) {
    if text.len() <= most || text.trim_end().chars().nth(most).is_none() {
        return (text, None);
    }
    let end = text.char_indices().nth(KEPT).map_or(text.len(), |(end, _)| end);
    (&text[..end], Some(format!(" ({} characters)", text.trim_end().chars().count())))
}
