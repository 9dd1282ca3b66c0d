//! What generated files say.

use super::case::every;
use springfit_generate::generate::LANGUAGES;

/// Every spring is listed with its nodes and group, in every language, and files have a moderate size.
#[test]
fn every_language_lists_the_springs() {
    for case in every(|case| case.element.nodes() <= 8) {
        for language in LANGUAGES {
            let text = case.program.print(language).unwrap();
            for [i, j] in case.springs.pairs() {
                assert!(text.contains(&format!(" {i}-{j}")), "{} {}", case.prefix(), language.name);
            }
            for name in case.springs.names() {
                let has_springs = case.springs.groups().iter().any(|group| case.springs.names()[*group] == *name);
                assert!(!has_springs || text.contains(&format!(" {name}:")), "{} {name}", case.prefix());
            }
            assert!(!text.contains("NaN") && !text.contains("inf,") && !text.contains("inf)"), "{}", case.prefix());
            assert!(text.len() < 400_000, "{} in {}: {} bytes", case.prefix(), language.name, text.len());
        }
    }
}

/// Functions without loops compute each operation once.
#[test]
fn no_operation_is_computed_twice() {
    for case in every(|case| case.element.nodes() <= 4 && case.element.tabulation.points() == 1) {
        let text = case.text("c").unwrap();
        if text.contains("for (") {
            continue;
        }
        for function in text.split("static inline ").skip(1) {
            let mut known = std::collections::BTreeSet::new();
            for line in function.lines().filter_map(|line| line.trim().strip_prefix("const double ")) {
                let Some((_, value)) = line.split_once(" = ") else { continue };
                assert!(known.insert(value.to_string()), "{}: {line}", case.prefix());
            }
        }
    }
}
