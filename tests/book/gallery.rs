//! The gallery shows thirteen scenes, each with its command and a picture that loads at once.

use super::markdown::{page, root};
use crate::kit::files_of;
use springfit_studies::study::Scene;

#[test]
fn the_gallery_has_thirteen_scenes_with_command_and_picture() {
    let text = page("docs/src/gallery.md").text;
    let (scenes, _) = text.split_once("\n## Figures for a paper").unwrap();
    let parts: Vec<&str> = scenes.split("\n## ").skip(1).collect();
    assert_eq!(parts.len(), 13);
    for part in parts {
        let command = part.lines().find(|line| line.starts_with("springfit run ")).unwrap_or_else(|| panic!("{part}"));
        Scene::load(&root().join(command.split(' ').nth(2).unwrap())).unwrap();
        assert!(part.contains("![") && command.ends_with("--report"), "{part}");
    }
}

#[test]
fn pictures_of_pages_load_at_once() {
    for (ending, most) in [("jpg", 150_000), ("webp", 1_000_000)] {
        let own = files_of(&root().join("docs/src/figures"), ending);
        assert!(!own.is_empty(), "{ending}");
        for file in own {
            let size = file.metadata().unwrap().len();
            assert!(size < most, "{}: {size} bytes", file.display());
        }
    }
}
