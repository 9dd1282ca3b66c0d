//! The files that the program has inside.

use springfit_foundation::error::Result;
use springfit_foundation::named::unknown;

/// The text of the file with this name, from names and texts.
///
/// # Errors
/// No file has this name.
pub fn shipped_text(
    files: impl Iterator<Item = (&'static str, &'static str)> + Clone,
    name: &str,
) -> Result<&'static str> {
    let names = || files.clone().map(|(name, _)| name);
    files.clone().find(|(shipped, _)| *shipped == name).map(|(_, text)| text).ok_or_else(|| {
        let expected = format!("one of {}", names().collect::<Vec<_>>().join(", "));
        unknown(expected, names(), name).at_key("NAME")
    })
}
