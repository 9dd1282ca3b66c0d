//! Element files: shape functions, quadrature, springs and formats.

use super::inputs::{FROM_FILES, TETRAHEDRON, edited, unit_mesh};
use super::refusals::{Refusals, refuses_elements};

const COORDINATES: &str = "[\"xi\", \"eta\", \"zeta\"]";
const LAST_PAIR: &str = "[2, 3]]";
const LENGTH: &str = "kind  = \"length\"";
const VOLUME: &str = "kind     = \"volume\"";
const RULE: &str = "rule   = \"simplex\"\ndegree = 1";

#[test]
fn shape_functions() {
    let shape = "\"xi\" }";
    let mut refusals = Refusals::default();
    refusals.expect_of_elements(&[
        (shape, "\"2*xi\" }", "nodes[1].shape", "is 2 at nodes[1], expected 1"),
        (shape, "\"xi - eta\" }", "nodes[1].shape", "is -1 at nodes[2], expected 0"),
        (shape, "\"sin(xi)\" }", "nodes[1].shape", "is 0.8414709848078965 at nodes[1], expected 1"),
        (shape, "\"xi/(xi*eta)\" }", "nodes[1].shape", "is NaN at nodes[0], expected 0"),
        (shape, "\"xi^2\" }", "nodes", "sum to 1, found 1 -2.500e-1 at [0.500, 0.335, 0.154]"),
        ("at = [0, 0, 1]", "at = [0, 1, 0]", "nodes[2].shape", "is 1 at nodes[3], expected 0"),
        ("at = [0, 0, 1]", "at = [0, 1]", "nodes[3].at", "3 coordinates, found 2"),
        ("at = [0, 0, 1]", "at = [0, 0, nan]", "11: nodes[3].at[2]", "found nan"),
        (COORDINATES, "[\"xi\", \"eta\"]", "coordinates", "found 2"),
        (COORDINATES, "[\"xi\", \"eta\", \"xi\"]", "coordinates[2]", "found \"xi\""),
        (COORDINATES, "[\"xi\", \"eta\", \"1\"]", "coordinates[2]", "found \"1\""),
        ("name        = \"tet4\"", "name = \"\"", "2: name", "found \"\""),
        ("group = \"edge\"", "group = \"a,b\"", "19: springs[0].group", "found \"a,b\""),
        ("\"tetrahedron\" ", "\"prism\" ", "4: cell", "\"prism\""),
    ]);
    // The sum is still one, but ξ is not reproduced.
    let first = "\"1 - xi - eta - zeta\"";
    let incomplete = edited(&edited(TETRAHEDRON, shape, "\"xi^2\" }"), first, "\"1 - xi^2 - eta - zeta\"");
    let words = "reproduce xi, found xi -2.500e-1 at [0.500, 0.465, 0.032]";
    refusals.expect_of_files(&incomplete, &unit_mesh(), "own.toml: nodes", words);
    refusals.finish();
}

#[test]
fn quadrature() {
    let quarter = "[\"1/4\", \"1/4\", \"1/4\"]";
    let light = format!("rule = \"explicit\"\npoints = [{quarter}]\nweights = [0.2]");
    let two = format!("rule = \"explicit\"\npoints = [{quarter}]\nweights = [\"1/12\", \"1/12\"]");
    let flat = "rule = \"explicit\"\npoints = [[\"1/4\", \"1/4\"]]\nweights = [\"1/6\"]";
    let outside = "rule = \"explicit\"\npoints = [[0.5, 0.5, 0.25]]\nweights = [\"1/6\"]";
    let lopsided = "rule = \"explicit\"\npoints = [[0.2, 0.25, 0.25]]\nweights = [\"1/6\"]";
    let gauss = "rule = \"gauss-legendre\"\npoints = 2";
    refuses_elements(&[
        (RULE, &light, "quadrature.weights", "content 0.16666666666666666, found 0.2"),
        (RULE, &two, "quadrature.weights", "1 points, found 2"),
        (RULE, flat, "quadrature.points[0]", "3 coordinates, found 2"),
        (RULE, outside, "quadrature.points[0]", "a point in the cell, found [0.5, 0.5, 0.25]"),
        (RULE, lopsided, "quadrature.points", "integrals of the coordinates are"),
        (RULE, "rule = \"explicit\"\npoints = []\nweights = []", "quadrature.points", "found none"),
        ("degree = 1", "degree = 0", "quadrature.degree", "1 to 32, found 0"),
        ("degree = 1", "degree = 33", "quadrature.degree", "1 to 32, found 33"),
        (RULE, gauss, "quadrature.rule", "found \"gauss-legendre\""),
        ("\"simplex\"", "\"simpson\"", "15: quadrature.rule", "\"simpson\""),
    ]);
}

#[test]
fn springs() {
    let pairs = "nodes = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]]\n";
    let measured = "kind = \"measure\"\nmeasure = \"x0 - x2\"";
    let crossed = "kind = \"coupling\"\nnodes = [[0, 1, 1, 0]]";
    let turned = "kind = \"angle\"\nnodes = [[0, 1, 2], [2, 1, 0]]";
    refuses_elements(&[
        (LAST_PAIR, "[2, 4]]", "springs[0].nodes[5]", "below 4, found [2, 4]"),
        (LAST_PAIR, "[2, 2]]", "springs[0].nodes[5]", "found [2, 2]"),
        (LAST_PAIR, "[1, 0]]", "springs[0].nodes[5]", "the pair [1, 0]"),
        (LAST_PAIR, "[2]]", "springs[0].nodes[5]", "two nodes, found 1"),
        (LAST_PAIR, "[2, 3, 1]]", "springs[0].nodes[5]", "two nodes, found 3"),
        (pairs, "", "springs[0].nodes", "found none"),
        ("\"bulk\"", "\"edge\"", "springs[1].group", "found \"edge\" again"),
        ("\"volume\"", "\"area\"", "springs[1].kind", "found \"area\""),
        ("\"volume\"", "\"mass\"", "25: springs[1].kind", "\"mass\""),
        ("\"volume\"", "\"angle\"", "springs[1].nodes", "found none"),
        (LENGTH, "kind = \"length\"\nmeasure = \"x0\"", "springs[0].measure", "found with \"length\""),
        (LENGTH, "kind = \"measure\"", "springs[0].measure", "found none"),
        (LENGTH, measured, "springs[0].measure", "found the name \"x2\" in \"x0 - x2\""),
        (LENGTH, "kind = \"angle\"", "springs[0].nodes[0]", "three nodes, found 2"),
        (LENGTH, "kind = \"area\"", "springs[0].nodes[0]", "three to eight nodes, found 2"),
        (LENGTH, "kind = \"length\"\nclass = \"all\"", "21: springs[0].class", "\"all\""),
        (VOLUME, crossed, "springs[1].nodes[0]", "found [0, 1, 1, 0]"),
        (VOLUME, turned, "springs[1].nodes[1]", "the list [2, 1, 0]"),
        (VOLUME, "kind = \"length\"\nnodes = \"complete\"", "springs[1].nodes", "found none"),
        (VOLUME, "kind = \"area\"\nnodes = \"complete\"", "springs[1].nodes", "found \"complete\""),
    ]);
}

#[test]
fn formats() {
    let order = "{ type = 4, order = [0, 1, 2, 4] }";
    refuses_elements(&[("{ type = 4 }", order, "formats.gmsh.order", "0 to 3 once, found [0, 1, 2, 4]")]);
}

#[test]
fn contents_that_are_not_elements() {
    let mut refusals = Refusals::default();
    refusals.expect_of_files("", &unit_mesh(), "own.toml:1", "missing field \"name\"");
    let files: [(&str, &[u8]); 2] = [("scene.toml", FROM_FILES.as_bytes()), ("own.toml", b"title = \"na\xefve\"")];
    refusals.expect(&files, &["run", "scene.toml"], "own.toml", "UTF-8");
    refusals.finish();
}
