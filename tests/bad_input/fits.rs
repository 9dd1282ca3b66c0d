//! Fits of single elements.

use super::inputs::BRICK;
use super::refusals::refuses_edits;

#[test]
fn fits() {
    let modal = "\"modal\"";
    let topology = "\"modal\"\nsolver = \"particle-swarm\"\n";
    refuses_edits(
        BRICK,
        &[
            (modal, "\"modular\"", "scene.toml: fit[0].objective", "found \"modular\""),
            (modal, "\"modal\"\nhigher = 0", "scene.toml: fit[0].higher", "found 0"),
            (modal, "\"modal\"\nhigher = 1.5", "scene.toml: fit[0].higher", "found 1.5"),
            (modal, "\"modal\"\nhigher = nan", "scene.toml: fit[0].higher", "found NaN"),
            (modal, "\"spectral\"\nweight = \"offdiag\"", "scene.toml: fit[0].weight", "found \"offdiag\""),
            (modal, "\"spectral\"\nweight = \"heavy\"", "scene.toml: fit[0].weight", "found \"heavy\""),
            (modal, "\"modal\"\nweight = \"none\"", "scene.toml: fit[0].weight", "found \"none\" with \"modal\""),
            (modal, "\"divergence\"\nweight = \"modal\"", "scene.toml: fit[0].weight", "\"divergence\""),
            (modal, "\"divergence\"\nbalance = 2", "scene.toml: fit[0].balance", "found 2"),
            (modal, "\"spectral\"\nbalance = 0.5", "scene.toml: fit[0].balance", "found with \"spectral\""),
            (modal, "\"frobenius\"\nhigher = 0.1", "scene.toml: fit[0].higher", "found with \"frobenius\""),
            (modal, "\"offdiag\"\nhigher = 0.1", "scene.toml: fit[0].higher", "found with \"offdiag\""),
            (modal, "\"modal\"\nrest = \"none\"", "scene.toml: fit[0].rest", "mesh, free, zero, found \"none\""),
            (modal, "\"modal\"\nrest = 0", "scene.toml:8: fit[0].rest", "expected a string"),
            (
                modal,
                "\"spectral\"\nrest = \"free\"",
                "scene.toml: fit[0].rest",
                "\"offdiag\" and \"modal\", found \"free\"",
            ),
            (modal, "\"divergence\"\nrest = \"zero\"", "scene.toml: fit[0].rest", "found \"zero\""),
            (
                modal,
                "\"modal\"\nrest = \"free\"\nsolver = \"particle-swarm\"",
                "scene.toml: fit[0].rest",
                "\"particle-swarm\"",
            ),
            (modal, "\"whole\"\nrest = \"free\"", "scene.toml: fit[0].rest", "the objective \"whole\""),
            (modal, "\"baudet\"\nrest = \"free\"", "scene.toml: fit[0].rest", "the objective \"baudet\""),
            (modal, "\"sampled\"\nrest = \"free\"", "scene.toml: fit[0].rest", "the objective \"sampled\""),
            (modal, "\"modal\"\nrest = \"zero\"", "scene.toml: fit[0].tet4 cell 1", "such as one on the content"),
            (modal, "\"modal\"\ntopology = true", "scene.toml: fit[0].topology", "found with \"native\""),
            (
                modal,
                "\"modal\"\niterations = 10\ntopology = true",
                "scene.toml: fit[0].iterations",
                "found with \"native\"",
            ),
            (
                modal,
                "\"modal\"\nsolver = \"nelder-mead\"\ntopology = true",
                "scene.toml: fit[0].topology",
                "\"nelder-mead\"",
            ),
            (modal, &format!("{topology}sparsity = 0.1"), "scene.toml: fit[0].sparsity", "topology = true"),
            (modal, &format!("{topology}topology = true\nsparsity = 2"), "scene.toml: fit[0].sparsity", "found 2"),
            (
                modal,
                "\"modal\"\nsprings = [\"edge\", \"diagonal\"]",
                "scene.toml: fit[0].springs",
                "\"edge\", \"bulk\", found \"diagonal\"",
            ),
            (modal, "\"modal\"\nsprings = 3", "scene.toml:8: fit[0].springs", "expected a list"),
            (
                "[[fix]]",
                "[[fit]]\nobjective = \"modal\"\n[[fix]]",
                "scene.toml: fit[1].name",
                "found \"modal 0.316\" again",
            ),
            (
                "[[fix]]",
                "[[fit]]\nname = \"modal 0.316\"\nobjective = \"offdiag\"\n[[fix]]",
                "scene.toml: fit[1].name",
                "found \"modal 0.316\" again",
            ),
        ],
    );
}
