//! Fits of single elements.

use super::inputs::BRICK;
use super::refusals::{refuses_edits, refuses_values};

#[test]
fn fits() {
    refuses_values(
        BRICK,
        "\"modal\"",
        "…",
        "fit[0].…",
        &[
            ("\"modular\"", "objective", "found \"modular\""),
            ("\"modal\"\nhigher = 0", "higher", "found 0"),
            ("\"modal\"\nhigher = 1.5", "higher", "found 1.5"),
            ("\"modal\"\nhigher = nan", "higher", "found NaN"),
            ("\"spectral\"\nweight = \"offdiag\"", "weight", "found \"offdiag\""),
            ("\"spectral\"\nweight = \"heavy\"", "weight", "found \"heavy\""),
            ("\"modal\"\nweight = \"none\"", "weight", "found \"none\" with \"modal\""),
            ("\"divergence\"\nweight = \"modal\"", "weight", "\"divergence\""),
            ("\"divergence\"\nbalance = 2", "balance", "found 2"),
            ("\"spectral\"\nbalance = 0.5", "balance", "found with \"spectral\""),
            ("\"frobenius\"\nhigher = 0.1", "higher", "found with \"frobenius\""),
            ("\"offdiag\"\nhigher = 0.1", "higher", "found with \"offdiag\""),
            ("\"modal\"\nrest = \"none\"", "rest", "mesh, free, zero, found \"none\""),
            ("\"spectral\"\nrest = \"free\"", "rest", "\"offdiag\" and \"modal\", found \"free\""),
            ("\"divergence\"\nrest = \"zero\"", "rest", "found \"zero\""),
            ("\"modal\"\nrest = \"free\"\nsolver = \"particle-swarm\"", "rest", "\"particle-swarm\""),
            ("\"whole\"\nrest = \"free\"", "rest", "the objective \"whole\""),
            ("\"baudet\"\nrest = \"free\"", "rest", "the objective \"baudet\""),
            ("\"sampled\"\nrest = \"free\"", "rest", "the objective \"sampled\""),
            ("\"modal\"\nrest = \"zero\"", "tet4 cell 1", "such as one on the content"),
            ("\"modal\"\ntopology = true", "topology", "found with \"native\""),
            ("\"modal\"\niterations = 10\ntopology = true", "iterations", "found with \"native\""),
            ("\"modal\"\nsolver = \"nelder-mead\"\ntopology = true", "topology", "\"nelder-mead\""),
            ("\"modal\"\nsprings = [\"edge\", \"diagonal\"]", "springs", "\"edge\", \"bulk\", found \"diagonal\""),
        ],
    );
    let modal = "\"modal\"";
    let topology = "\"modal\"\nsolver = \"particle-swarm\"\n";
    refuses_edits(
        BRICK,
        &[
            (modal, "\"modal\"\nrest = 0", "8: fit[0].rest", "expected a string"),
            (modal, &format!("{topology}sparsity = 0.1"), "fit[0].sparsity", "topology = true"),
            (modal, &format!("{topology}topology = true\nsparsity = 2"), "fit[0].sparsity", "found 2"),
            (modal, "\"modal\"\nsprings = 3", "8: fit[0].springs", "expected a list"),
            ("[[fix]]", "[[fit]]\nobjective = \"modal\"\n[[fix]]", "fit[1].name", "found \"modal 0.316\" again"),
            (
                "[[fix]]",
                "[[fit]]\nname = \"modal 0.316\"\nobjective = \"offdiag\"\n[[fix]]",
                "fit[1].name",
                "found \"modal 0.316\" again",
            ),
        ],
    );
}
