//! README is short.

use super::markdown::page;

#[test]
fn the_readme_has_at_most_nine_kilobytes() {
    let size = page("README.md").text.len();
    assert!(size <= 9 * 1024, "{size} bytes");
}
