//! Fits to sampled forces, with laws of the material and of the springs.

use super::inputs::{BRICK, SOFT, edited};
use super::refusals::{Refusals, refuses_edits, refuses_values};

const SHAPES: &str = "shapes = { families = [\"uniaxial\"], count = 30, held_out = 10, stretch = 0.2 }";
const FORCE: &str = "\"k*(exp(a*s) - 1)\"";

#[test]
fn solvers_and_laws_of_the_material() {
    let rubber = "law = \"rubber\"";
    let mut refusals = Refusals::default();
    refusals.expect_of_edits(
        SOFT,
        &[
            ("law = \"neo-hookean\"\n", "", "newton", "found one without"),
            ("steps = 2", "steps = 0", "newton.steps", "found 0"),
            ("steps = 2", "iterations = 0", "newton.iterations", "found 0"),
            ("steps = 2", "tolerance = 2", "newton.tolerance", "found 2"),
            ("law = \"neo-hookean\"", rubber, "material.law", "found \"rubber\""),
        ],
    );
    let plain = edited(BRICK, "objective = \"modal\"", "objective = \"modal\"\nforce = \"k*s\"");
    refusals.expect_of_scene(&plain, "fit[0].force", "found with \"modal\"");
    let lawless = edited(BRICK, "objective = \"modal\"", "objective = \"sampled\"");
    refusals.expect_of_scene(&lawless, "material.law", "fit[0] samples");
    refusals.finish();
}

#[test]
fn options_of_the_fit() {
    refuses_values(
        SOFT,
        "starts = 2",
        "…",
        "fit[0].…",
        &[
            ("starts = 0", "starts", "found 0"),
            ("balance = 0.5", "balance", "\"sampled\""),
            ("solver = \"nelder-mead\"", "solver", "\"sampled\""),
            ("topology = true", "topology", "\"sampled\""),
            ("weight = \"modal\"", "weight", "found \"modal\""),
            ("higher = -1", "higher", "found -1"),
            ("norm = \"3\"", "norm", "found \"3\""),
            ("norm = \"1\"", "norm", "2-norm"),
            ("nonnegative = true\nhuber = 0.5", "huber", "norm \"huber\""),
            ("huber = 0.5", "huber", "norm \"huber\""),
        ],
    );
    refuses_edits(
        SOFT,
        &[
            ("objective = \"sampled\"", "objective = \"sampled\"\nsprings = []", "fit[0].springs", "found none"),
            (FORCE, "\"k*s\"", "fit[0].starts", "not linear"),
        ],
    );
}

#[test]
fn laws_of_force_and_bounds() {
    refuses_edits(
        SOFT,
        &[
            (
                "bounds = { a = [0, 10] }\nstarts = 2",
                "bounds = { a = [-2, -1] }\nnonnegative = true",
                "fit[0].bounds.a",
                "found -2 to -1",
            ),
            ("a = [0, 10]", "a = [10, 0]", "fit[0].bounds.a", "found 10 to 0"),
            ("a = [0, 10]", "a = 3", "fit[0].bounds.a", "found 3"),
            ("a = [0, 10]", "b = [0, 1]", "fit[0].bounds", "k, a, found \"b\""),
            (FORCE, "\"Linear\"", "fit[0].force", "found \"Linear\""),
            (FORCE, "{ edge = \"free-rest\" }", "fit[0].force.edge", "force = \"free-rest\""),
            (FORCE, "\"3*s\"", "fit[0].force", "found 3*s"),
            (FORCE, "3", "fit[0].force", "found integer"),
            (FORCE, "{ edge = \"k*exp(a*s)\", bulk = \"a*s\" }", "fit[0].force", "edge, found \"bulk\""),
            (FORCE, "{ edge = \"k*s*\" }", "fit[0].force.edge", "column 5"),
        ],
    );
}

/// The options of the shapes, the key below `fit[0].shapes`, and words of the problem.
const OPTIONS: [(&str, &str, &str); 27] = [
    ("loads = [\"pull\"], stretch = 0.1", "stretch", "\"families\""),
    ("count = 100000000000", "count", "from 1 to 10000000, found 100000000000"),
    ("families = [\"uniaxal\"]", "families", "found \"uniaxal\""),
    ("count = 0", "count", "found 0"),
    ("weight = 2", "weight", "several sets"),
    ("design = \"halton\"", "design", "found \"halton\""),
    ("directions = [[1, 0]]", "directions[0]", "found 2"),
    ("scale = 2", "scale", "\"states\""),
    ("states = []", "states", "found none"),
    ("states = 3", "states", "integer"),
    ("states = [\"a.npy\"]", "states", "found \"a.npy\""),
    ("run = \"nowhere\"", "run", "found nowhere"),
    ("gradients = [[1, 0, 0, 0, 1, 0, 0, 0, -1]]", "gradients[0]", "det F = -1.0000"),
    ("gradients = [[1, \"a\"]]", "gradients[0][1]", "found \"a\""),
    ("gradients = []", "gradients", "found 0 numbers in all"),
    ("gradients = true", "gradients", "found a boolean"),
    ("gradients = [[1, 0, 0, 0, 1, 0, 0, 0, 2]], directions = [[1, 0, 0]]", "directions", "\"families\""),
    ("held_out = -1", "held_out", "found -1"),
    ("held_out = { count = 0 }", "held_out.count", "found 0"),
    ("held_out = { families = [\"torsional\"] }", "held_out.families", "found \"torsional\""),
    ("held_out = { held_out = 3 }", "held_out.held_out", "belongs to the shapes of the fit"),
    ("gradients = [[1, 0, 0, 0, 1, 0, 0, 0, 2]], held_out = { count = 3 }", "held_out", "apart from those of the list"),
    ("held_out = { loads = [\"push\"] }", "held_out.loads", "(pull), found \"push\""),
    ("stretch = \"much\"", "stretch", "found \"much\""),
    ("stretch = [0.5, 0]", "stretch", "found 0.5 to 0"),
    ("perturbation = 9", "perturbation", "found 9"),
    ("loads = [\"push\"]", "loads", "(pull), found \"push\""),
];

#[test]
fn shapes() {
    refuses_values(SOFT, SHAPES, "shapes = { … }", "fit[0].shapes.…", &OPTIONS);
    let mut refusals = Refusals::default();
    refusals.expect_of_edits(
        SOFT,
        &[
            (SHAPES, "shapes = { families = [\"uniaxial\"], loads = [\"pull\"] }", "fit[0].shapes", "found more"),
            (SHAPES, "shapes = []", "fit[0].shapes", "found none"),
            (
                SHAPES,
                "shapes = [{ families = [\"bending\"] }, { families = [\"bent\"] }]",
                "fit[0].shapes[1].families",
                "found \"bent\"",
            ),
            (SHAPES, "data = true\nshapes = { held_out = 0 }", "fit[0].shapes.held_out", "whose errors are the data"),
        ],
    );
    let list = edited(SOFT, SHAPES, "shapes = { gradients = \"list.csv\" }");
    refusals.expect_with(&list, &[], "list.csv", "cannot be read");
    let states = edited(SOFT, SHAPES, "shapes = { states = \"states.csv\" }");
    refusals.expect_with(&states, &[], "states.csv", "cannot be read");
    let flat = "point,ux,uy,uz\n0,0,0,0\n1,0,0,0\n2,0,0,0\n3,0,0,0\n4,0,0,-1.5\n5,0,0,-1.5\n6,0,0,-1.5\n7,0,0,-1.5\n";
    for (text, place, words) in [
        (flat, "scene.toml: fit[0].shapes.states[0]", "det F = -0.5000 in the cell with the nodes"),
        ("point,ux,uy,uz\n0,0,0,0\n", "states.csv: displacement", "found none of point 1 along x"),
    ] {
        refusals.expect_with(&states, &[("states.csv", text)], place, words);
    }
    let run = edited(SOFT, SHAPES, "shapes = { run = \"out\" }");
    refusals.expect_with(&run, &[("out/", "")], "scene.toml: fit[0].shapes.run", "mesh.vtu");
    for (text, place, words) in [
        ("1 0 0 0 1 0 0 0\n", "scene.toml: fit[0].shapes.gradients", "found 8 numbers in all"),
        ("1 0 0\n0 one 0 0 0 1\n", "list.csv:2", "found one"),
    ] {
        refusals.expect_with(&list, &[("list.csv", text)], place, words);
    }
    refusals.finish();
}
