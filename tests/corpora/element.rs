//! An element or a material file: what has been accepted gives finite numbers.

use springfit_element::element::Element;
use springfit_element::material::{Energy, Material};
use springfit_element::springs::Springs;
use springfit_fit::fit::{Choices, Fit, Objective, fit_element};

/// Larger elements take long to fit.
const MOST_NODES: usize = 10;
const MOST_POINTS: usize = 64;

pub fn check(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    for dimension in [2, 3] {
        let material = Material::for_body(dimension, 10e3, 0.3, None, None).expect("a common material");
        let _ = Energy::parse(text, material);
    }
    if let Ok(element) = Element::parse(text) {
        check_element(&element);
    }
}

fn check_element(element: &Element) {
    let (nodes, d, points) = (element.nodes(), element.dimension(), element.tabulation.points());
    assert_eq!(element.positions.len(), nodes * d);
    assert_eq!(element.tabulation.gradients.len(), points * nodes * d);
    let table = &element.tabulation;
    let numbers = table.values.iter().chain(&table.gradients).chain(&table.weights).chain(&element.positions);
    assert!(numbers.copied().all(f64::is_finite));
    element.springs.iter().flat_map(|group| group.nodes.iter().flatten()).for_each(|&node| assert!(node < nodes));
    let all: Vec<String> = element.springs.iter().map(|group| group.name.clone()).collect();
    Springs::select(element, Some(&all)).expect("the names are those of the element");
    let springs = Springs::select(element, None).expect("an element in its own space may use all its springs");
    if nodes <= MOST_NODES && points <= MOST_POINTS && !springs.is_empty() {
        let moduli = Material::for_body(d, 10e3, 0.3, None, None).expect("a common material").moduli();
        let fit = Fit::new(Objective::named("modal", Choices::default()).expect("it is one of the names"));
        if let Ok(constants) = fit_element(element, &springs, &element.positions, moduli, &fit) {
            assert_eq!(constants.len(), springs.len());
            assert!(constants.iter().all(|k| k.is_finite()), "{constants:?}");
        }
    }
}
