//! Measures of one's own.

use springfit_element::element::Element;

fn triangle(measure: &str) -> springfit_foundation::error::Result<Element> {
    let file = std::fs::read_to_string("examples/elements/tri3_coupled.toml").unwrap();
    let own = "abs((x1 - x0)*(y2 - y0) - (x2 - x0)*(y1 - y0))/sqrt((x1 - x0)^2 + (y1 - y0)^2)";
    assert!(file.contains(own));
    Element::parse(&file.replace(own, measure))
}

/// A spring on a measure that a rigid motion changes would hold the body to a place.
#[test]
fn a_measure_is_the_same_after_every_rigid_motion() {
    for invariant in [
        "(x1 - x0)^2 + (y1 - y0)^2",
        "sqrt((x1 - x0)^2 + (y1 - y0)^2) + sqrt((x2 - x0)^2 + (y2 - y0)^2)",
        "(x1 - x0)*(y2 - y0) - (x2 - x0)*(y1 - y0)",
        "((x1 - x0)*(x2 - x0) + (y1 - y0)*(y2 - y0))/((x1 - x0)^2 + (y1 - y0)^2)",
    ] {
        triangle(invariant).unwrap();
    }
    for other in [
        "x0",
        "x1 - x0",
        "x1^2 + y1^2",
        "x0*y1 - x1*y0 + 1",
        "(x1 - x0)^2 + 1.001*(y1 - y0)^2",
        "sqrt((x1 - x0)^2 + (y1 - y0)^2) + 1e-6*x2",
    ] {
        let error = triangle(other).unwrap_err();
        let key = error.key().unwrap();
        assert!(key.starts_with("springs[") && key.ends_with("].measure"), "{error}");
        let file = std::fs::read_to_string("examples/elements/tri3_coupled.toml").unwrap();
        let line = file.lines().position(|line| line.starts_with("measure")).unwrap();
        assert_eq!(error.line(), Some(line + 1), "{error}");
    }
}
