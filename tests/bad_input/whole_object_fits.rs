//! Fits of a whole object under loads.

use super::inputs::{BRICK, PLATE, edited};
use super::refusals::{Refusals, refuses_edits, refuses_values};

const FIT: &str = "objective = \"modal\"";
const WHOLE: &str = "objective = \"whole\"";

/// The options that follow `objective = "whole"`, the key below `fit[0]`, and words of the problem.
const OPTIONS: [(&str, &str, &str); 32] = [
    ("loads = []", "loads", "found none"),
    ("loads = [\"push\"]", "loads", "(load 1), found \"push\""),
    ("validate = [\"push\"]", "validate", "(load 1), found \"push\""),
    ("validate = []", "validate", "found none"),
    ("loads = [\"load 1\"]\nvalidate = [\"load 1\"]", "validate", "found \"load 1\""),
    ("loads = [\"load 1\"]\nvalidate = [\"leave-one-out\"]", "validate", "found 1"),
    ("validate = [\"made\"]\nregularization = 1e-3", "regularization", "found both"),
    ("regularization = -1", "regularization", "found -1"),
    ("start = \"rest\"", "start", "found \"rest\""),
    ("start = [\"offdiag\", \"offdiag\"]", "start", "each once"),
    ("start = 3", "start", "an objective"),
    ("range = 0.5", "range", "found 0.5"),
    ("iterations = 0", "iterations", "found 0"),
    ("solver = \"native\"", "solver", "found \"native\""),
    ("residual = \"forces\"", "residual", "unknown field"),
    ("unknowns = \"cell\"", "unknowns", "found \"cell\""),
    ("frequencies = 3", "frequencies", "density"),
    ("tied = true", "tied", "\"whole\""),
    ("topology = true", "topology", "\"whole\""),
    ("sparsity = 0.1", "sparsity", "\"whole\""),
    ("nonnegative = true", "nonnegative", "\"whole\""),
    ("loads = [\"load 1\", \"load 1\"]", "loads", "found \"load 1\" again"),
    ("start = \"equal\"\nhigher = 0.1", "higher", "\"equal\""),
    ("range = 10\nregularization = 1", "range", "\"validate\""),
    ("shear = \"edges\"", "shear", "\"exact\""),
    ("start = \"exact\"\nshear = \"faces\"", "shear", "found \"faces\""),
    ("start = \"exact\"\nshear = \"edges\"\nvolume = \"cells\"", "volume", "found \"cells\""),
    ("stretch = 0", "stretch", "above 0 and at most 1, found 0"),
    ("stretch = 1.5", "stretch", "found 1.5"),
    ("stretch = nan", "stretch", "found NaN"),
    ("stretch = 0.3", "stretch", "a material with a \"law\", found one without"),
    ("stretch = 0.3\nloads = [\"load 1\"]\nregularization = 1", "stretch", "belongs to loads = [\"made\"]"),
];

#[test]
fn options_of_whole_object_fits() {
    refuses_values(BRICK, FIT, &format!("{WHOLE}\n…"), "fit[0].…", &OPTIONS);
    refuses_edits(
        BRICK,
        &[
            (FIT, &format!("{FIT}\nfrequencies = 3"), "fit[0].frequencies", "found with \"modal\""),
            (FIT, &format!("{FIT}\nloads = [\"load 1\"]"), "fit[0].loads", "found with \"modal\""),
        ],
    );
}

#[test]
fn whole_objects() {
    let mut refusals = Refusals::default();
    let cubes = edited(BRICK, "tet4", "hex8");
    refusals.expect_of_scene(
        &edited(&cubes, FIT, &format!("{WHOLE}\nstart = \"exact\"\nshear = \"edges\"")),
        "fit[0].shear",
        "found \"edges\" with hex8",
    );
    let whole = edited(BRICK, FIT, WHOLE);
    // No equilibrium is found in one iteration, under no load.
    refusals.expect_of_scene(
        &edited(&whole, "poisson = 0.3", "poisson = 0.3\nlaw = \"neo-hookean\"\n[newton]\niterations = 1"),
        "fit[0].stretch",
        "has an equilibrium at half of the stretch 0.3, found none of",
    );
    let exact = edited(&whole, WHOLE, &format!("{WHOLE}\nstart = \"exact\""));
    for (law, words) in [
        ("yeoh", "where the start is \"exact\", found Yeoh"),
        ("fibre", "a law without fibres, where moduli are unknown, found \"fibre\""),
    ] {
        let scene = edited(&exact, "poisson = 0.3", &format!("poisson = 0.3\nlaw = \"{law}\""));
        refusals.expect_of_scene(&scene, "fit[0].start", words);
    }
    let plate = edited(
        PLATE,
        "objective = \"frobenius\"",
        "objective = \"whole\"\nstart = \"exact\"\nloads = [\"load 1\"]\nregularization = 1",
    );
    refusals.expect_of_scene(
        &edited(&plate, "plane = \"strain\"", "plane = \"stress\"\nlaw = \"stable-neo-hookean\""),
        "fit[0].unknowns",
        "not linear in them, found plane stress",
    );
    let lost = edited(
        BRICK,
        "poisson = 0.3",
        "poisson = 0.3\nlaw = \"neo-hookean\"\n[newton]\niterations = 1\n[reference]\nrefine = 1",
    );
    refusals.expect_of_scene(
        &lost,
        "reference",
        "loads under which the finer body has an equilibrium, found \"load 1\", lost at",
    );
    let free = edited(&whole, "[[fix]]\ngroup = \"zmin\"\n", "");
    let held = "[[load]]\nwhere = \"z < 0.1\"\ndisplacement = [0, 0, 0]";
    let by_load = edited(&free, "[[load]]\ngroup = \"zmax\"\ntraction = [0, 0, 1]", held);
    refusals.expect_of_scene(&by_load, "fit[0].loads", "6 rigid motions");
    let still = edited(&whole, "traction = [0, 0, 1]", "traction = [0, 0, 0]");
    refusals.expect_of_scene(
        &edited(&still, WHOLE, "objective = \"whole\"\nloads = [\"load 1\"]"),
        "fit[0].loads",
        "found \"load 1\"",
    );
    refusals.expect_of_scene(
        &edited(&whole, "traction = [0, 0, 1]", "traction = [0, 0, 1]\nname = \"made\""),
        "load[0].name",
        "found \"made\"",
    );
    let counted = edited(&whole, "poisson = 0.3", "poisson = 0.3\ndensity = 1000");
    refusals.expect_of_scene(
        &edited(&counted, WHOLE, "objective = \"whole\"\nfrequencies = 13"),
        "fit[0].frequencies",
        "at most 12, the free degrees of freedom, found 13",
    );
    refusals.finish();
}
