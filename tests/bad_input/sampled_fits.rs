//! Fits to sampled forces, with laws of the material and of the springs.

use super::inputs::{BRICK, SOFT, edited};
use super::refusals::{Refusals, refuses_edits};

const SHAPES: &str = "shapes = { families = [\"uniaxial\"], count = 30, held_out = 10, stretch = 0.2 }";
const FORCE: &str = "\"k*(exp(a*s) - 1)\"";
const STARTS: &str = "starts = 2";

#[test]
fn solvers_and_laws_of_the_material() {
    let rubber = "law = \"rubber\"";
    let mut refusals = Refusals::default();
    refusals.expect_of_edits(
        SOFT,
        &[
            ("law = \"neo-hookean\"\n", "", "scene.toml: newton", "found one without"),
            ("steps = 2", "steps = 0", "scene.toml: newton.steps", "found 0"),
            ("steps = 2", "iterations = 0", "scene.toml: newton.iterations", "found 0"),
            ("steps = 2", "tolerance = 2", "scene.toml: newton.tolerance", "found 2"),
            ("law = \"neo-hookean\"", rubber, "scene.toml: material.law", "found \"rubber\""),
        ],
    );
    let plain = edited(BRICK, "objective = \"modal\"", "objective = \"modal\"\nforce = \"k*s\"");
    refusals.expect_of_scene(&plain, "scene.toml: fit[0].force", "found with \"modal\"");
    let lawless = edited(BRICK, "objective = \"modal\"", "objective = \"sampled\"");
    refusals.expect_of_scene(&lawless, "scene.toml: material.law", "fit[0] samples");
    refusals.finish();
}

#[test]
fn options_of_the_fit() {
    refuses_edits(
        SOFT,
        &[
            (STARTS, "starts = 0", "scene.toml: fit[0].starts", "found 0"),
            (STARTS, "balance = 0.5", "scene.toml: fit[0].balance", "\"sampled\""),
            (STARTS, "solver = \"nelder-mead\"", "scene.toml: fit[0].solver", "\"sampled\""),
            (STARTS, "topology = true", "scene.toml: fit[0].topology", "\"sampled\""),
            (STARTS, "weight = \"modal\"", "scene.toml: fit[0].weight", "found \"modal\""),
            (STARTS, "higher = -1", "scene.toml: fit[0].higher", "found -1"),
            (STARTS, "norm = \"3\"", "scene.toml: fit[0].norm", "found \"3\""),
            (STARTS, "norm = \"1\"", "scene.toml: fit[0].norm", "2-norm"),
            (STARTS, "nonnegative = true\nhuber = 0.5", "scene.toml: fit[0].huber", "norm \"huber\""),
            (STARTS, "huber = 0.5", "scene.toml: fit[0].huber", "norm \"huber\""),
            (
                "objective = \"sampled\"",
                "objective = \"sampled\"\nsprings = []",
                "scene.toml: fit[0].springs",
                "found none",
            ),
            (FORCE, "\"k*s\"", "scene.toml: fit[0].starts", "not linear"),
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
                "scene.toml: fit[0].bounds.a",
                "found -2 to -1",
            ),
            ("a = [0, 10]", "a = [10, 0]", "scene.toml: fit[0].bounds.a", "found 10 to 0"),
            ("a = [0, 10]", "a = 3", "scene.toml: fit[0].bounds.a", "found 3"),
            ("a = [0, 10]", "b = [0, 1]", "scene.toml: fit[0].bounds", "k, a, found \"b\""),
            (FORCE, "\"Linear\"", "scene.toml: fit[0].force", "found \"Linear\""),
            (FORCE, "{ edge = \"free-rest\" }", "scene.toml: fit[0].force.edge", "force = \"free-rest\""),
            (FORCE, "\"3*s\"", "scene.toml: fit[0].force", "found 3*s"),
            (FORCE, "3", "scene.toml: fit[0].force", "found integer"),
            (FORCE, "{ edge = \"k*exp(a*s)\", bulk = \"a*s\" }", "scene.toml: fit[0].force", "edge, found \"bulk\""),
            (FORCE, "{ edge = \"k*s*\" }", "scene.toml: fit[0].force.edge", "column 5"),
        ],
    );
}

#[test]
fn shapes() {
    let mut refusals = Refusals::default();
    let count = "shapes = { count = 100000000000 }";
    let two = "shapes = { families = [\"uniaxial\"], loads = [\"pull\"] }";
    refusals.expect_of_edits(
        SOFT,
        &[
            (
                SHAPES,
                "shapes = { loads = [\"pull\"], stretch = 0.1 }",
                "scene.toml: fit[0].shapes.stretch",
                "\"families\"",
            ),
            (SHAPES, count, "scene.toml: fit[0].shapes.count", "from 1 to 10000000, found 100000000000"),
            (
                SHAPES,
                "shapes = { families = [\"uniaxal\"] }",
                "scene.toml: fit[0].shapes.families",
                "found \"uniaxal\"",
            ),
            (SHAPES, two, "scene.toml: fit[0].shapes", "found more"),
            (SHAPES, "shapes = { count = 0 }", "scene.toml: fit[0].shapes.count", "found 0"),
            (SHAPES, "shapes = []", "scene.toml: fit[0].shapes", "found none"),
            (SHAPES, "shapes = { weight = 2 }", "scene.toml: fit[0].shapes.weight", "several sets"),
            (SHAPES, "shapes = { design = \"halton\" }", "scene.toml: fit[0].shapes.design", "found \"halton\""),
            (SHAPES, "shapes = { directions = [[1, 0]] }", "scene.toml: fit[0].shapes.directions[0]", "found 2"),
            (SHAPES, "shapes = { scale = 2 }", "scene.toml: fit[0].shapes.scale", "\"states\""),
            (SHAPES, "shapes = { states = [] }", "scene.toml: fit[0].shapes.states", "found none"),
            (SHAPES, "shapes = { states = 3 }", "scene.toml: fit[0].shapes.states", "integer"),
            (SHAPES, "shapes = { states = [\"a.npy\"] }", "scene.toml: fit[0].shapes.states", "found \"a.npy\""),
            (SHAPES, "shapes = { run = \"nowhere\" }", "scene.toml: fit[0].shapes.run", "found nowhere"),
            (
                SHAPES,
                "shapes = [{ families = [\"bending\"] }, { families = [\"bent\"] }]",
                "scene.toml: fit[0].shapes[1].families",
                "found \"bent\"",
            ),
            (
                SHAPES,
                "shapes = { gradients = [[1, 0, 0, 0, 1, 0, 0, 0, -1]] }",
                "scene.toml: fit[0].shapes.gradients[0]",
                "det F = -1.0000",
            ),
            (
                SHAPES,
                "shapes = { gradients = [[1, \"a\"]] }",
                "scene.toml: fit[0].shapes.gradients[0][1]",
                "found \"a\"",
            ),
            (SHAPES, "shapes = { gradients = [] }", "scene.toml: fit[0].shapes.gradients", "found 0 numbers in all"),
            (SHAPES, "shapes = { gradients = true }", "scene.toml: fit[0].shapes.gradients", "found a boolean"),
            (
                SHAPES,
                "shapes = { gradients = [[1, 0, 0, 0, 1, 0, 0, 0, 2]], directions = [[1, 0, 0]] }",
                "scene.toml: fit[0].shapes.directions",
                "\"families\"",
            ),
        ],
    );
    refusals.expect_of_edits(
        SOFT,
        &[
            (SHAPES, "shapes = { held_out = -1 }", "scene.toml: fit[0].shapes.held_out", "found -1"),
            (SHAPES, "shapes = { held_out = { count = 0 } }", "scene.toml: fit[0].shapes.held_out.count", "found 0"),
            (
                SHAPES,
                "shapes = { held_out = { families = [\"torsional\"] } }",
                "scene.toml: fit[0].shapes.held_out.families",
                "found \"torsional\"",
            ),
            (
                SHAPES,
                "shapes = { held_out = { held_out = 3 } }",
                "scene.toml: fit[0].shapes.held_out.held_out",
                "belongs to the shapes of the fit",
            ),
            (
                SHAPES,
                "shapes = { gradients = [[1, 0, 0, 0, 1, 0, 0, 0, 2]], held_out = { count = 3 } }",
                "scene.toml: fit[0].shapes.held_out",
                "apart from those of the list",
            ),
            (
                SHAPES,
                "shapes = { held_out = { loads = [\"push\"] } }",
                "scene.toml: fit[0].shapes.held_out.loads",
                "(pull), found \"push\"",
            ),
            (
                SHAPES,
                "data = true\nshapes = { held_out = 0 }",
                "scene.toml: fit[0].shapes.held_out",
                "whose errors are the data",
            ),
            (SHAPES, "shapes = { stretch = \"much\" }", "scene.toml: fit[0].shapes.stretch", "found \"much\""),
            (SHAPES, "shapes = { stretch = [0.5, 0] }", "scene.toml: fit[0].shapes.stretch", "found 0.5 to 0"),
            (SHAPES, "shapes = { perturbation = 9 }", "scene.toml: fit[0].shapes.perturbation", "found 9"),
            (SHAPES, "shapes = { loads = [\"push\"] }", "scene.toml: fit[0].shapes.loads", "(pull), found \"push\""),
        ],
    );
    let list = edited(SOFT, SHAPES, "shapes = { gradients = \"list.csv\" }");
    refusals.expect_of_scene(&list, "list.csv", "cannot be read");
    let states = edited(SOFT, SHAPES, "shapes = { states = \"states.csv\" }");
    refusals.expect_of_scene(&states, "states.csv", "cannot be read");
    let flat = "point,ux,uy,uz\n0,0,0,0\n1,0,0,0\n2,0,0,0\n3,0,0,0\n4,0,0,-1.5\n5,0,0,-1.5\n6,0,0,-1.5\n7,0,0,-1.5\n";
    for (text, place, words) in [
        (flat, "scene.toml: fit[0].shapes.states[0]", "det F = -0.5000 in the cell with the nodes"),
        ("point,ux,uy,uz\n0,0,0,0\n", "states.csv: displacement", "found none of point 1 along x"),
    ] {
        let files: [(&str, &[u8]); 2] = [("scene.toml", states.as_bytes()), ("states.csv", text.as_bytes())];
        refusals.expect(&files, &["run", "scene.toml"], place, words);
    }
    let run = edited(SOFT, SHAPES, "shapes = { run = \"out\" }");
    let files: [(&str, &[u8]); 2] = [("scene.toml", run.as_bytes()), ("out/", b"")];
    refusals.expect(&files, &["run", "scene.toml"], "scene.toml: fit[0].shapes.run", "mesh.vtu");
    for (text, place, words) in [
        ("1 0 0 0 1 0 0 0\n", "scene.toml: fit[0].shapes.gradients", "found 8 numbers in all"),
        ("1 0 0\n0 one 0 0 0 1\n", "list.csv:2", "found one"),
    ] {
        let files: [(&str, &[u8]); 2] = [("scene.toml", list.as_bytes()), ("list.csv", text.as_bytes())];
        refusals.expect(&files, &["run", "scene.toml"], place, words);
    }
    refusals.finish();
}
