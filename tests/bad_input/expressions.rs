//! Expressions in element files: their grammar, their names and their bounds.

use super::inputs::{TETRAHEDRON, edited, unit_mesh};
use super::refusals::{Refusals, refuses_elements};

/// The shape function of the second node.
const SHAPE: &str = "\"xi\" }";

/// A tetrahedron whose first shape function is another, of so many nodes.
fn with_shape(definition: &str, shape: &str, nodes: usize) -> String {
    let node = format!("    {{ at = [0, 0, 0], shape = \"{shape}\" }},\n");
    let first = "    { at = [0, 0, 0], shape = \"1 - xi - eta - zeta\" },\n";
    let element = edited(TETRAHEDRON, first, &node.repeat(nodes));
    edited(&element, "nodes = [\n    { at", &format!("let = {{ a = \"{definition}\" }}\nnodes = [\n    {{ at"))
}

#[test]
fn expressions() {
    let mut refusals = Refusals::default();
    for (text, words) in [
        ("xi**2", "column 4: expected a number, a name or '(', found '*'"),
        ("xi eta", "column 4: expected an operator, found 'e'"),
        ("(1-xi)//4", "column 8: expected a number, a name or '(', found '/'"),
        ("(1-xi", "column 6: expected ')', found the end"),
        ("1-xi)", "column 5: expected an operator or the end, found ')'"),
        ("()", "column 2"),
        ("", "column 1"),
        ("xi^", "column 4"),
        ("+xi", "column 1"),
        ("--xi", "column 2"),
        ("2xi", "column 2"),
        ("2(xi)", "column 2"),
        ("xi^2^2", "parentheses in a power of a power"),
        ("xii", "xi, eta, zeta, found the name \"xii\""),
        ("sin", "column 4"),
        ("sinh(xi)", "found \"sinh(\""),
        ("ξ", "column 1"),
        ("xi = 1", "column 4"),
        ("xi; 1", "column 3"),
        ("1.2.3", "column 1"),
        ("1e999999", "column 1"),
        ("xi/(1-1)", "division by zero"),
    ] {
        let element = edited(TETRAHEDRON, SHAPE, &format!("\"{text}\" }}"));
        refusals.expect_of_files(&element, &unit_mesh(), "own.toml: nodes[1].shape", words);
    }
    let nodes = "nodes = [\n";
    refusals.expect_of_elements(&[
        (SHAPE, "\"xi < 1\" }", "nodes[1].shape", "found the condition \"xi < 1\""),
        (SHAPE, "\"true\" }", "nodes[1].shape", "found the name \"true\""),
        (nodes, "let = { xi = \"1\" }\nnodes = [\n", "let.xi", "found \"xi\""),
        (nodes, "let = { a = \"a\" }\nnodes = [\n", "let.a", "found the name \"a\" in \"a\""),
        (nodes, "let = { a = 1 }\nnodes = [\n", "let.a", "found integer"),
    ]);
    refusals.finish();
}

#[test]
fn long_and_deep_expressions() {
    let mut refusals = Refusals::default();
    let (open, close) = ("(".repeat(101), ")".repeat(101));
    let deep = edited(TETRAHEDRON, SHAPE, &format!("\"{open}xi{close}\" }}"));
    let words = "column 101: expected at most 100 open parentheses, found '('";
    refusals.expect_of_files(&deep, &unit_mesh(), "own.toml: nodes[1].shape", words);
    let long = edited(TETRAHEDRON, SHAPE, &format!("\"{}0\" }}", "1 + ".repeat(200_000)));
    let words = format!("at most 10000 characters, found 800001 in \"{}...\"", &"1 + ".repeat(15)[..57]);
    refusals.expect_of_files(&long, &unit_mesh(), "own.toml: nodes[1].shape", &words);
    refusals.finish();
}

#[test]
fn numbers_without_bound() {
    let squares: Vec<_> = (1..30).map(|i| format!("a{i} = \"a{}*a{}\"", i - 1, i - 1)).collect();
    let squares = format!("let = {{ a0 = \"1234567890\", {} }}\nnodes = [\n", squares.join(", "));
    let power = "\"(((2^256)^256)^256)^256*xi\" }";
    refuses_elements(&[
        (SHAPE, power, "nodes[1].shape", "at most 1000 digits"),
        ("nodes = [\n", &squares, "let.a7", "at most 1000 digits in \"a6*a6\""),
    ]);
}

#[test]
fn expressions_without_bound() {
    let sums: Vec<_> = (1..8).map(|i| format!("a{i} = \"{}0\"", format!("a{} + ", i - 1).repeat(100))).collect();
    let sums = format!("let = {{ a0 = \"xi\", {} }}\nnodes = [\n", sums.join(", "));
    let ramps = format!("\"{}xi{}\" }}", "ramp(".repeat(40), ")".repeat(40));
    refuses_elements(&[
        ("nodes = [\n", &sums, "let.a2", "at most 2000 terms and factors"),
        (SHAPE, &ramps, "nodes[1].shape", "at most 2000 terms and factors"),
    ]);
}

#[test]
fn shape_functions_without_bound() {
    let many = with_shape(&format!("xi{}", " + xi".repeat(990)), "a + a", 80);
    let steep = with_shape(&format!("xi{}", "*xi".repeat(990)), "a + a", 1);
    let slow = with_shape(&format!("xi{}", "*xi".repeat(249)), "1 - xi - eta - zeta + a - a + a - a", 1);
    let slow = edited(&slow, "degree = 1", "degree = 32");
    let mut refusals = Refusals::default();
    for (element, place, words) in [
        (many, "own.toml: nodes", "at most 80000 numbers, names and operations in all, found 158643"),
        (steep, "own.toml: nodes", "at most 5000000 numbers, names and operations in all, found 5904396"),
        (slow, "own.toml: quadrature", "found 1308474666 at 5202 points"),
    ] {
        refusals.expect_of_files(&element, &unit_mesh(), place, words);
    }
    refusals.finish();
}
